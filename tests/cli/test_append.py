#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""vkao --mode append: everything that was in the file is still in it, bit for bit."""
import re

import numpy as np

from cli import (OUTPUT, case, cases, check, check_close, corpus, equal, main, oiio, read_ao,
                 read_parts, run_tool, write_exr)
from exr_raw import COMPRESSIONS, read_raw
from scene import FOV, RADIUS, Scene

SCENE = Scene(96, 54)
VIEW = ('--fov', FOV, '--radius', RADIUS)
# A part of a multi-part file has these; a lone part need not.
BY_PARTS = {'name', 'type', 'chunkCount'}


def beauty():
    return {**SCENE.color(), 'Z': SCENE.depth(), **SCENE.normals()}


def ids(shape=(54, 96)):
    """Identifiers that no float holds: 2^24 + 1 and beyond."""
    count = np.arange(shape[0] * shape[1], dtype=np.uint32).reshape(shape)
    return {'id': count + np.uint32(2 ** 24 + 1), 'mask': count * np.uint32(2654435761)}


def attributes():
    kind = oiio.TypeDesc
    return [('owner', 'A. Gaffer'), ('comments', 'naïve — ünïcode'), ('shot/take', 7),
            ('exposure', 0.125), ('cryptomatte/3ab/manifest', '{"ball":"0x3f"}'),
            ('worldToCamera', kind('matrix'), tuple(float(i) for i in range(16))),
            ('framesPerSecond', kind('rational'), (24000, 1001)),
            ('chromaticities', kind('float[8]'),
             (0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329))]


def append(scratch, *options):
    scratch.render('in.exr', '-o', 'out.exr', '--mode', 'append', '--normal-space', 'camera',
                   *(options or VIEW))


def check_raw(before, after, what):
    """Attributes and compressed chunks of one part, byte for byte."""
    for name, value in before.attributes.items():
        if name not in BY_PARTS or name in after.attributes and name == 'type':
            equal(after.attributes.get(name), value, f'{what}: attribute {name}')
    more = set(after.attributes) - set(before.attributes) - BY_PARTS
    equal(more, set(), f'{what}: attributes that came from nowhere')
    equal(len(after.chunks), len(before.chunks), f'{what}: number of chunks')
    check(after.chunks == before.chunks, f'{what}: chunks differ')


def check_pixels(before, after, what):
    """The same through another library, as integers, so that NaN equals NaN."""
    equal(sorted(after.channels), sorted(before.channels), f'{what}: channels')
    for name, plane in before.channels.items():
        equal(after[name].dtype, plane.dtype, f'{what}: type of {name}')
        check(plane.tobytes() == after[name].tobytes(), f'{what}: pixels of {name} differ')
    equal(after.data_window, before.data_window, f'{what}: dataWindow')
    equal(after.display_window, before.display_window, f'{what}: displayWindow')
    # What OpenImageIO makes up itself for single-part or for multi-part files.
    own = ('oiio:subimagename', 'name', 'oiio:subimages', 'openexr:chunkCount')
    for key, value in before.attributes.items():
        if key not in own:
            equal(str(after.attributes.get(key)), str(value), f'{what}: attribute {key}')


def header_lines(text):
    """What exrheader prints for every part, without the lines that parts have and files have
    not."""
    parts = re.split(r'(?m)^ part \d+:?$', text)
    parts = parts[1:] if len(parts) > 1 else parts
    skipped = re.compile(r'^(file |$|(name|type|chunkCount|version) \(type)')
    return [[line for line in part.splitlines() if not skipped.match(line)] for part in parts]


def check_append(scratch, added=('ao',), channel='AO'):
    before, after = (read_parts(scratch.path(f)) for f in ('in.exr', 'out.exr'))
    raw_before, raw_after = (read_raw(scratch.bytes(f)) for f in ('in.exr', 'out.exr'))
    equal(len(after), len(before) + len(added), 'number of parts')
    equal(tuple(p.name for p in after[len(before):]), tuple(added), 'new parts')
    for i, part in enumerate(before):
        check_raw(raw_before[i], raw_after[i], f'part {i}')
        check_pixels(part, after[i], f'part {i}')
        equal(after[i].name, part.name, 'name of a part')
    for part in after[len(before):]:
        equal(list(part.channels), [channel], 'channels of the new part')
    printed = [header_lines(run_tool('exrheader', f, cwd=scratch.directory))
               for f in ('in.exr', 'out.exr')]
    for i, lines in enumerate(printed[0]):
        missing = [line for line in lines if line not in printed[1][i]]
        check(not missing, f'part {i}: exrheader lacks {missing}')
    return after


@cases(COMPRESSIONS)
def every_compression_is_copied(scratch, compression):
    write_exr(scratch.path('in.exr'), beauty(), compression=compression, attributes=attributes())
    append(scratch)
    check_append(scratch)


@cases([('zip', 'zip'), ('piz', 'piz'), ('dwab', 'dwab'), ('none', 'none')])
def half_and_tiles_are_copied(scratch, _, compression):
    channels = {k: v.astype(np.float16) for k, v in beauty().items() if k != 'Z'}
    channels['Z'] = np.where(SCENE.sky, 0, SCENE.z).astype(np.float16)
    channels['R'][3, 3], channels['G'][4, 4] = np.nan, -np.inf
    write_exr(scratch.path('in.exr'), channels, tile=32, compression=compression,
              attributes=attributes())
    append(scratch)
    check_append(scratch)


@case
def result_is_that_of_mode_ao(scratch):
    write_exr(scratch.path('in.exr'), beauty())
    for kind in ('half', 'float'):
        for mode in ('ao', 'append'):
            scratch.render('in.exr', '-o', f'{mode}.exr', '--mode', mode, '--pixel-type', kind,
                           '--overwrite', 'always', *VIEW)
        appended = read_parts(scratch.path('append.exr'))[1]
        equal(str(appended['AO'].dtype), {'half': 'float16', 'float': 'float32'}[kind], 'type')
        check_close(appended['AO'].astype(np.float32), read_ao(scratch.path('ao.exr')), 0, 0, kind)


def write_parts(scratch, **more):
    write_exr(scratch.path('in.exr'), (SCENE.color(), {'name': 'beauty'}),
              ({'Z': SCENE.depth()}, {'name': 'depth', 'compression': 'piz'}),
              (SCENE.normals(), {'name': 'N', 'compression': 'none'}),
              (ids(), {'name': 'ids', 'compression': 'zips'}), **more)


@case
def parts_are_copied_with_their_identifiers(scratch):
    write_parts(scratch, attributes=attributes())
    append(scratch)
    after = check_append(scratch)
    equal(str(after[3]['id'].dtype), 'uint32', 'type of the identifiers')


@case
def parts_of_other_windows_are_copied(scratch):
    small = {k: v[10:30, 20:60] for k, v in SCENE.color().items()}
    display = (0, 0, 95, 53)
    write_exr(scratch.path('in.exr'), (small, {'name': 'beauty', 'x': 20, 'y': 10}),
              ({'Z': SCENE.depth()}, {'name': 'depth'}), display=display)
    append(scratch)
    after = check_append(scratch)
    equal(after[2].data_window, (0, 0, 95, 53), 'dataWindow of the new part: that of the depth')


@case
def tiled_parts_are_copied(scratch):
    write_exr(scratch.path('in.exr'), (SCENE.color(), {'name': 'beauty'}),
              ({'Z': SCENE.depth()}, {'name': 'depth'}), tile=16)
    append(scratch)
    check_append(scratch)


@case
def stereo_parts_are_copied(scratch):
    other = Scene(96, 54, eye=0.3)
    parts = [(s.color(), {'name': f'rgba.{v}', 'view': v}) for s, v in
             ((SCENE, 'left'), (other, 'right'))]
    parts += [({'Z': s.depth()}, {'name': f'depth.{v}', 'view': v}) for s, v in
              ((SCENE, 'left'), (other, 'right'))]
    write_exr(scratch.path('in.exr'), *parts, attributes=attributes())
    append(scratch, '--view', 'all', *VIEW)
    after = check_append(scratch, ('ao.left', 'ao.right'))
    equal([p.attributes.get('view') for p in after[4:]], ['left', 'right'], 'views')


@case
def stereo_channels_are_copied(scratch):
    other = Scene(96, 54, eye=0.3)
    channels = {**SCENE.color(), 'Z': SCENE.depth(), 'right.Z': other.depth()}
    views = ('multiView', oiio.TypeDesc('string[2]'), ('left', 'right'))
    write_exr(scratch.path('in.exr'), channels, attributes=[views])
    append(scratch, '--view', 'all', *VIEW)
    check_append(scratch, ('ao.left', 'ao.right'))
    scratch.render('in.exr', '-o', 'ao.exr', '--view', 'all', *VIEW)
    scratch.render('out.exr', '-o', 'again.exr', '--view', 'all', *VIEW)
    for before, after in zip(*(read_parts(scratch.path(f)) for f in ('ao.exr', 'again.exr'))):
        check_close(after['R'], before['R'], 0, 0, f'{before.name} of what was appended to')


@case
def appending_twice_needs_another_name(scratch):
    write_exr(scratch.path('in.exr'), beauty())
    append(scratch)
    scratch.fails(OUTPUT, r"out\.exr: has a part 'ao' already", 'out.exr', '-o', 'again.exr',
                  '--mode', 'append', *VIEW, hint='--part-name NAME')
    scratch.render('out.exr', '-o', 'again.exr', '--mode', 'append', '--part-name', 'second',
                   *VIEW)
    equal([p.name for p in read_parts(scratch.path('again.exr'))], ['', 'ao', 'second'], 'parts')


@case
def result_can_be_read_again(scratch):
    write_exr(scratch.path('in.exr'), beauty())
    append(scratch)
    scratch.render('out.exr', '-o', 'again.exr', '--normal-space', 'camera', *VIEW)
    check_close(read_ao(scratch.path('again.exr')),
                read_parts(scratch.path('out.exr'))[1]['AO'].astype(np.float32), 0, 0, 'AO')


@cases(['b5_suzannes_seq.0001', 'b5_suzannes_stereo', 'b5_suzannes_tiled', 'm3_cornell_native',
        'm3_cornell_half'])
def renderers_files_are_copied(scratch, name):
    source = corpus(f'{name}.exr')
    with open(source, 'rb') as file:
        scratch.write('in.exr', file.read())
    scratch.render('in.exr', '-o', 'out.exr', '--mode', 'append', '--camera',
                   corpus(f'{name}.camera.json'))
    if not name.startswith('b5'):
        check_append(scratch)
    elif 'stereo' in name:
        check_append(scratch, ('ViewLayer.AO-left', 'ViewLayer.AO-right'), 'ViewLayer.AO.V')
    else:
        check_append(scratch, ('ViewLayer.AO',), 'ViewLayer.AO.V')


if __name__ == '__main__':
    main()
