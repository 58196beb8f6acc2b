#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Depth, normals and colour in files of their own, as renderers write them that put each element
into one."""
import json
import os

import numpy as np

from cli import (CHANNELS, INPUT, MEMORY, OK, SOME_FRAMES, USAGE, case, cases, check, check_close,
                 equal, main, matches, read_ao, read_parts, write_exr)
from scene import FOV, RADIUS, Scene, write_camera

SCENE = Scene(96, 54)
BASE = ('--fov', FOV, '--radius', RADIUS, '--normal-space', 'camera', '--pixel-type', 'float')
GREY = tuple('RGB')


def grey(plane):
    return {c: plane for c in GREY}


def as_colors(planes):
    return dict(zip(GREY, planes.values()))


# Depth and normals as this and that program writes them into files of their own.
DEPTHS = [
    ('grey', lambda: grey(SCENE.depth())),
    ('luminance', lambda: {'Y': SCENE.depth()}),
    ('one channel', lambda: {'Z': SCENE.depth()}),
    ('layer', lambda: {'any name.V': SCENE.depth()}),
]
NORMALS = [
    ('colours', lambda: as_colors(SCENE.normals())),
    ('vector', lambda: SCENE.normals()),
    ('layer', lambda: SCENE.normals(layer='what.ever', letters='RGB')),
]


def write_elements(scratch, depth=None, normals=None, suffix='', **layout):
    write_exr(scratch.path(f'beauty{suffix}.exr'), SCENE.color(), **layout)
    write_exr(scratch.path(f'z{suffix}.exr'), depth or grey(SCENE.depth()), **layout)
    write_exr(scratch.path(f'n{suffix}.exr'), normals or as_colors(SCENE.normals()), **layout)


def whole(scratch, *options):
    write_exr(scratch.path('whole.exr'),
              {**SCENE.color(), 'Z': SCENE.depth(), **SCENE.normals()})
    scratch.render('whole.exr', '-o', 'wanted.exr', *BASE, *options)
    return read_parts(scratch.path('wanted.exr'))[0]


@cases(DEPTHS)
def depth_alone_needs_no_name(scratch, name, make):
    wanted = whole(scratch)['R']
    write_elements(scratch, depth=make())
    scratch.render('beauty.exr', '--depth-file', 'z.exr', '--normal-file', 'n.exr', '-o', 'ao.exr',
                   *BASE)
    check_close(read_ao(scratch.path('ao.exr')), wanted, 0, 0, name)


@cases(NORMALS)
def normals_alone_need_no_name(scratch, name, make):
    wanted = whole(scratch)['R']
    write_elements(scratch, depth={'Z': SCENE.depth()}, normals=make())
    scratch.render('z.exr', '--normal-file', 'n.exr', '-o', 'ao.exr', *BASE)
    check_close(read_ao(scratch.path('ao.exr')), wanted, 0, 0, name)


@case
def color_may_be_in_a_file_of_its_own(scratch):
    wanted = whole(scratch, '--mode', 'comp')
    write_elements(scratch, depth={'Z': SCENE.depth()})
    scratch.render('z.exr', '--normal-file', 'n.exr', '--color-file', 'beauty.exr', '-o', 'c.exr',
                   '--mode', 'comp', *BASE)
    part = read_parts(scratch.path('c.exr'))[0]
    for channel in 'RGBA':
        check_close(part[channel], wanted[channel], 0, 0, channel)


@case
def colours_are_no_depth(scratch):
    write_elements(scratch, depth={c: p for c, p in SCENE.color().items() if c != 'A'})
    line = ('beauty.exr', '--depth-file', 'z.exr', '-o', 'ao.exr', *BASE)
    scratch.fails(CHANNELS, r"z\.exr: 'R' and 'G' differ: a picture in colours", *line,
                  hint='--depth R')
    scratch.render(*line, '--depth', 'R')


@case
def names_are_those_of_the_file(scratch):
    wanted = whole(scratch)['R']
    planes = {'a.Z': SCENE.depth(), 'b.Z': SCENE.depth() * 2}
    write_elements(scratch, depth=planes)
    line = ('beauty.exr', '--depth-file', 'z.exr', '--normal-file', 'n.exr', '-o', 'ao.exr', *BASE)
    scratch.fails(CHANNELS, r"z\.exr: 2 depth candidates: 'a\.Z', 'b\.Z'", *line,
                  hint='--depth \'a.Z\'')
    scratch.fails(CHANNELS, r"z\.exr: no channel or layer 'c'", *line, '--depth', 'c')
    scratch.render(*line, '--depth', 'a.Z')
    check_close(read_ao(scratch.path('ao.exr')), wanted, 0, 0, 'a.Z')


@case
def windows_are_placed(scratch):
    """A renderer that crops each element to what is in it."""
    wanted = whole(scratch)['R']
    rows, columns = np.flatnonzero(~SCENE.sky.all(1)), np.flatnonzero(~SCENE.sky.all(0))
    cut = slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)
    write_elements(scratch, depth={'Z': SCENE.depth()})
    write_exr(scratch.path('n.exr'), {k: v[cut] for k, v in SCENE.normals().items()},
              x=int(columns[0]), y=int(rows[0]), display=(0, 0, 95, 53))
    scratch.render('beauty.exr', '--depth-file', 'z.exr', '--normal-file', 'n.exr', '-o', 'ao.exr',
                   *BASE)
    check_close(read_ao(scratch.path('ao.exr')), wanted, 0, 0, 'AO')


@case
def sequences_have_a_token_in_each(scratch):
    wanted = whole(scratch)['R']
    for frame in (7, 8):
        depth = {'Z': SCENE.depth() * np.float32(1 if frame == 8 else 3)}
        write_elements(scratch, depth=depth, suffix=f'.{frame:04d}')
    files = ('--depth-file', 'z.%04d.exr', '--normal-file', 'n.$F4.exr')
    scratch.render('beauty.####.exr', *files, '-o', 'ao.####.exr', *BASE)
    check_close(read_ao(scratch.path('ao.0008.exr')), wanted, 0, 0, 'frame 8')
    check(np.abs(read_ao(scratch.path('ao.0007.exr')) - wanted).max() > 0.1, 'frame 7 is another')
    scratch.fails(USAGE, r"--depth-file 'z\.0007\.exr' has no frame token, but there are 2 frames",
                  'beauty.####.exr', '--depth-file', 'z.0007.exr', '-o', 'x.####.exr',
                  hint='put ####')
    scratch.fails(USAGE, r"--normal-file 'n\.#\.exr' has a frame token, but INPUT 'beauty",
                  'beauty.0007.exr', '--normal-file', 'n.#.exr', '-o', 'x.exr')


@cases([('--camera', 'c.{}.json'), ('--depth-file', 'z.{}.exr'), ('--like', 'l.{}.exr')])
def files_of_later_frames_are_missed_at_once(scratch, option, pattern):
    for frame in (1, 2):
        write_elements(scratch, depth={'Z': SCENE.depth()}, suffix=f'.{frame}')
    whole(scratch)
    write_camera(scratch.path('c.1.json'))
    scratch.write('l.1.exr', scratch.bytes('wanted.exr'))
    files = ('--depth-file', 'z.@.exr') if option != '--depth-file' else ()
    second = scratch.path(pattern.format(2))
    if os.path.exists(second):
        os.unlink(second)
    line = ('beauty.@.exr', *files, option, pattern.format('@'), '-o', 'ao.@.exr',
            '--normal', 'none')
    message = pattern.format(2).replace('.', r'\.') + ': cannot open: No such file'
    scratch.fails(INPUT, message, *line, hint=f'{option} of frame 2, input beauty.2.exr')
    run = scratch.run(*line, '--continue-on-error')
    equal(run.code, SOME_FRAMES, f'exit code of {run}')
    check('ao.1.exr' in scratch.files(), f'frame 1 is not there: {run}')


@cases([('depth', '--depth-file', 'z.exr'), ('normals', '--normal-file', 'n.exr'),
        ('color', '--color-file', 'c.exr')])
def sizes_must_be_equal(scratch, _, option, name):
    write_exr(scratch.path('in.exr'),
              {**SCENE.color(), 'Z': SCENE.depth(), **SCENE.normals()})
    small = Scene(48, 27)
    write_exr(scratch.path(name), grey(small.depth()))
    depth, other = ('in.exr', name) if option != '--depth-file' else (name, '(in|z).exr')
    scratch.fails(INPUT, rf'{other}: display window .* but the depth in {depth} has', 'in.exr',
                  option, name, '-o', 'ao.exr', '--mode', 'comp', *BASE,
                  hint='one frame and size')


@cases([('depth', '--depth-file'), ('normals', '--normal-file'), ('color', '--color-file')])
def each_is_checked_as_the_input_is(scratch, _, option):
    write_exr(scratch.path('in.exr'),
              {**SCENE.color(), 'Z': SCENE.depth(), **SCENE.normals()})
    line = ('in.exr', option, 'x.exr', '-o', 'ao.exr', '--mode', 'comp', *BASE)
    scratch.fails(INPUT, r'x\.exr: cannot open', *line)
    scratch.write('x.exr', b'\x89PNG\r\n\x1a\n' + bytes(64))
    scratch.fails(INPUT, r'x\.exr: not an OpenEXR file', *line)
    data = scratch.bytes('in.exr')
    scratch.write('x.exr', data[:len(data) * 2 // 3])
    scratch.fails(INPUT, r'^vkao: x\.exr: ', *line)
    write_exr(scratch.path('x.exr'), {'id': np.ones((54, 96), np.uint32)})
    if option != '--depth-file':
        scratch.fails(CHANNELS, r'x\.exr: no (normal|color) channel found; channels: id', *line)


@case
def output_is_none_of_them(scratch):
    write_elements(scratch)
    scratch.fails(USAGE, r'z\.exr: --output and --depth-file are the same file', 'beauty.exr',
                  '--depth-file', 'z.exr', '-o', 'z.exr', '--overwrite', 'always')


@case
def camera_is_that_of_the_depth_or_else_of_the_input(scratch):
    field = (('cameraFov', float(FOV)),)
    for name, planes, attributes in (('z', grey(SCENE.depth()), field),
                                     ('bare', grey(SCENE.depth()), ()),
                                     ('beauty', SCENE.color(), (('cameraFov', 20.0),))):
        write_exr(scratch.path(f'{name}.exr'), planes, attributes=attributes)
    for name, wanted in (('z', 'fov=60h'), ('bare', 'fov=20h')):
        run = scratch.render('beauty.exr', '--depth-file', f'{name}.exr', '-o', f'ao.{name}.exr')
        matches(wanted, run.stderr, name)


@case
def append_adds_to_the_input(scratch):
    wanted = whole(scratch)['R']
    write_elements(scratch)
    scratch.render('beauty.exr', '--depth-file', 'z.exr', '--normal-file', 'n.exr', '-o', 'all.exr',
                   '--mode', 'append', *BASE)
    parts = read_parts(scratch.path('all.exr'))
    equal(sorted(parts[0].channels), ['A', 'B', 'G', 'R'], 'channels of the input')
    check_close(parts[-1]['AO'], wanted, 0, 0, 'AO')


@case
def memory_of_them_is_counted(scratch):
    write_elements(scratch)
    scratch.fails(MEMORY, r'need \d+', 'beauty.exr', '--depth-file', 'z.exr', '--normal-file',
                  'n.exr', '-o', 'ao.exr', '--max-memory', '100K')


@case
def inspect_reads_them(scratch):
    write_elements(scratch)
    write_camera(scratch.path('c.json'))
    run = scratch.run('inspect', 'beauty.exr', '--depth-file', 'z.exr', '--normal-file', 'n.exr',
                      '--camera', 'c.json', '--json')
    equal(run.code, OK, f'exit code of {run}')
    roles = json.loads(run.stdout)['views'][0]['roles']
    equal([roles[k]['file'] for k in ('depth', 'normal', 'color')],
          ['z.exr', 'n.exr', 'beauty.exr'], 'files')


if __name__ == '__main__':
    main()
