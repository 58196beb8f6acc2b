#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""What fails says why in one line, with the documented exit code, and leaves nothing behind."""
import json
import os
import shutil
import re
import socket
import subprocess

import numpy as np

from cli import (CHANNELS, DEVICE, INPUT, OK, OUTPUT, USAGE, case, cases, check, corpus, equal,
                 limit_file_size, main, matches, skip, write_exr)
from exr_raw import patched
from scene import FOV, Scene, camera, write_camera

SCENE = Scene(64, 36)
RUN = ('in.exr', '-o', 'out.exr', '--fov', FOV)


def gbuffer(scratch, name='in.exr', **layout):
    return write_exr(scratch.path(name), {'Z': SCENE.depth(), **SCENE.normals()}, **layout)


def unprivileged(scratch):
    """For preexec_fn: root may read and write everything, so become nobody."""
    if os.geteuid() != 0:
        return None
    os.chmod(scratch.directory, 0o755)

    def become_nobody():
        os.setgid(65534)
        os.setuid(65534)
    try:
        code = scratch.run('--version', preexec_fn=become_nobody).code
    except (OSError, subprocess.SubprocessError):
        code = None
    if code != OK:
        skip('running as root, and nobody may not run vkao')
    return become_nobody


# --- Input ---

PNG = b'\x89PNG\r\n\x1a\n' + bytes(64)
CONTENTS = [
    ('png', PNG, r'in\.exr: not an OpenEXR file \(first bytes 89 50 4E 47 = PNG\)'),
    ('text', b'#include <stdio.h>', r'in\.exr: not an OpenEXR file \(first bytes 23 69 6E 63'),
    ('empty', b'', r'in\.exr: (empty|truncated|not an OpenEXR)'),
    ('one byte', b'v', r'in\.exr: '),
    ('magic alone', b'v/1\x01', r'in\.exr: truncated'),
    ('zeros', bytes(1000), r'in\.exr: not an OpenEXR file'),
]


@cases(CONTENTS)
def other_files_are_refused(scratch, _, content, message):
    scratch.write('in.exr', content)
    scratch.fails(INPUT, message, *RUN)
    equal(scratch.run('inspect', 'in.exr').code, INPUT, 'exit code of inspect')


@case
def missing_input(scratch):
    scratch.fails(INPUT, r'in\.exr: cannot open: No such file', *RUN)
    scratch.fails(INPUT, r'a/b/in\.exr: cannot open: No such file', 'a/b/in.exr', '-o', 'x.exr')


@case
def directory_as_input(scratch):
    os.mkdir(scratch.path('in.exr'))
    scratch.fails(INPUT, r'in\.exr: cannot open: Is a directory', *RUN)


@case
def pipe_as_input_does_not_hang(scratch):
    os.mkfifo(scratch.path('in.exr'))
    scratch.fails(INPUT, r'in\.exr: cannot open: not a regular file', *RUN, timeout=20)


def not_a_file(scratch, kind):
    """A path that is none, and what is said of it."""
    path = scratch.path('camera')
    if kind == 'pipe':
        os.mkfifo(path)
    elif kind == 'directory':
        os.mkdir(path)
        return 'camera', r'camera: cannot open: Is a directory'
    elif kind == 'socket':
        server = socket.socket(socket.AF_UNIX)
        server.bind(path)
        server.close()
        return 'camera', r'camera: cannot open: No such device'
    elif kind == 'link to a pipe':
        os.mkfifo(scratch.path('pipe'))
        os.symlink('pipe', path)
    elif kind == 'loop':
        os.symlink('camera', path)
        return 'camera', r'camera: cannot open: Too many levels'
    elif kind == 'huge':
        with open(path, 'wb') as file:
            file.truncate(1 << 40)
        return 'camera', r'camera: larger than \d+ bytes'
    elif kind == 'a little large':
        scratch.write('camera', b'{}' + b' ' * (1 << 20))
        return 'camera', r'camera: larger than \d+ bytes'
    elif kind == 'proc':
        return '/proc/self/mem', r'/proc/self/mem: '
    else:
        return kind, rf'{kind}: cannot open: not a regular file'
    return 'camera', r'camera: cannot open: not a regular file'


KINDS = ['pipe', 'link to a pipe', 'directory', 'socket', 'loop', 'huge', 'a little large', 'proc',
         '/dev/zero', '/dev/null', '/dev/tty0', '/dev/ptmx']


@cases(KINDS)
def camera_that_is_no_file_is_refused_at_once(scratch, kind):
    if kind.startswith('/dev') and not os.path.exists(kind):
        skip(f'no {kind}')
    gbuffer(scratch)
    path, message = not_a_file(scratch, kind)
    for arguments in (('in.exr', '-o', 'out.exr'), ('inspect', 'in.exr')):
        scratch.fails(INPUT, message, *arguments, '--camera', path, timeout=20)


@cases(KINDS)
def input_that_is_no_file_is_refused_at_once(scratch, kind):
    if kind.startswith('/dev') and not os.path.exists(kind):
        skip(f'no {kind}')
    path, message = not_a_file(scratch, kind)
    message = message.split(': larger')[0]
    for arguments in ((path, '-o', 'out.exr'), ('inspect', path)):
        scratch.fails(INPUT, message, *arguments, timeout=20)


@case
def unreadable_input(scratch):
    gbuffer(scratch)
    os.chmod(scratch.path('in.exr'), 0)
    scratch.fails(INPUT, r'in\.exr: cannot open: Permission denied', *RUN,
                  preexec_fn=unprivileged(scratch))


@cases([('header', 0.02), ('table', 0.06), ('middle', 0.5), ('end', 0.99), ('last byte', None)])
def truncated_files_are_refused(scratch, _, share):
    gbuffer(scratch, compression='none')
    whole = scratch.bytes('in.exr')
    scratch.write('in.exr', whole[:-1] if share is None else whole[:int(len(whole) * share)])
    scratch.fails(INPUT, r'in\.exr: .*(truncated|damaged|ends early)', *RUN)


@case
def every_prefix_is_refused(scratch):
    write_exr(scratch.path('in.exr'), {'Z': np.full((4, 4), 3, np.float32)})
    whole = scratch.bytes('in.exr')
    for length in range(0, len(whole), 23):
        scratch.write('in.exr', whole[:length])
        scratch.fails(INPUT, r'in\.exr: ', *RUN)


@cases([('htj2k256', 10), ('htj2k32', 11), (r'\(99\)', 99)])
def unknown_compression_is_named(scratch, name, number):
    gbuffer(scratch)
    scratch.write('in.exr', patched(scratch.bytes('in.exr'), 'compression', bytes([number])))
    scratch.fails(INPUT, rf'in\.exr: compression .*{name}.*needs a newer OpenEXR', *RUN,
                  hint='oiiotool')


@case
def absurd_windows_are_refused(scratch):
    gbuffer(scratch)
    box = np.array([0, 0, 2 ** 31 - 2, 2 ** 31 - 2], '<i4').tobytes()
    scratch.write('in.exr', patched(scratch.bytes('in.exr'), 'dataWindow', box))
    scratch.fails(INPUT, r'in\.exr: .*(limit|damaged)', *RUN)


@case
def deep_files_are_refused(scratch):
    with open(corpus('awkward', 'v2__LowResLeftView__Trunks.exr'), 'rb') as file:
        scratch.write('in.exr', file.read())
    scratch.fails(INPUT, r'in\.exr: deep data is not supported', *RUN, hint='oiiotool .*--flatten')


# --- Channels ---

@case
def missing_depth_lists_the_channels(scratch):
    write_exr(scratch.path('in.exr'), {**SCENE.color(), **SCENE.normals()})
    scratch.fails(CHANNELS, r'in\.exr: no depth channel found; channels: .*\bR\b.*', *RUN,
                  hint='--depth NAME')
    run = scratch.run(*RUN)
    for name in ('R', 'G', 'B', 'A', 'N.X', 'N.Y', 'N.Z'):
        matches(rf'channels:.* {re.escape(name)}\b', run.stderr, 'the message')


@case
def two_depths_list_the_arguments(scratch):
    write_exr(scratch.path('in.exr'), {'a.Depth.Z': SCENE.depth(), 'b.Depth.Z': SCENE.depth()})
    scratch.fails(CHANNELS, r"in\.exr: 2 depth candidates: 'a\.Depth\.Z', 'b\.Depth\.Z'", *RUN,
                  hint=r"--depth 'a\.Depth\.Z' or --depth 'b\.Depth\.Z'")
    for name in ('a.Depth.Z', 'b.Depth.Z'):
        scratch.render(*RUN, '--overwrite', 'always', '--depth', name)


@case
def two_depths_in_parts_list_the_arguments(scratch):
    write_exr(scratch.path('in.exr'), ({'Z': SCENE.depth()}, {'name': 'one'}),
              ({'Z': SCENE.depth()}, {'name': 'two'}))
    result = scratch.fails(CHANNELS, r'in\.exr: 2 depth candidates', *RUN, hint='--depth')
    names = re.findall(r"--depth '([^']+)'", result.stderr)
    equal(len(names), 2, f'arguments in {result.stderr}')
    for name in names:
        scratch.render(*RUN, '--overwrite', 'always', '--depth', name)


@cases([('depth', '--depth', 'nothing'), ('normal', '--normal', 'nothing'),
        ('color', '--color', 'nothing')])
def named_channels_must_exist(scratch, kind, option, name):
    gbuffer(scratch)
    scratch.fails(CHANNELS, rf"in\.exr: no channel or layer '{name}'; channels: .*Z", *RUN, option,
                  name, '--mode', 'comp', hint=f'--{kind} takes')


@case
def radial_near_needs_near(scratch):
    write_exr(scratch.path('in.exr'), {'dd.T': SCENE.depth('radial-near')})
    scratch.fails(CHANNELS, r"in\.exr: depth 'dd\.T' is measured from the near plane", *RUN,
                  hint='--near DISTANCE')
    scratch.render(*RUN, '--near', 0.5)


@cases([('neither', ()), ('near', ('--near', 1)), ('far', ('--far', 10))])
def device_depth_needs_both_planes(scratch, _, planes):
    gbuffer(scratch)
    scratch.fails(CHANNELS, r'in\.exr: device depth needs both planes', *RUN, '--depth-type',
                  'device', *planes, hint='--near and --far')


@case
def equal_planes_are_no_projection(scratch):
    gbuffer(scratch)
    scratch.fails(CHANNELS, r'planes at 2 and 2 give no projection', *RUN, '--depth-type',
                  'device', '--near', 2, '--far', 2)


@case
def normals_of_no_encoding_are_refused(scratch):
    normals = {k: np.abs(v) * np.float32(40) + 3 for k, v in SCENE.normals().items()}
    write_exr(scratch.path('in.exr'), {'Z': SCENE.depth(), **normals})
    scratch.fails(CHANNELS, r"in\.exr: normals 'N' are neither signed nor 0\.\.1", *RUN,
                  hint='--normal-encoding')


@case
def world_normals_need_a_rotation(scratch):
    gbuffer(scratch)
    scratch.fails(CHANNELS, r'in\.exr: world-space normals need the rotation', *RUN,
                  '--normal-space', 'world', hint='world_to_view')


# --- Camera files ---

TURN = camera()['world_to_view']
CAMERAS = [
    ('not JSON', '{"type": \n oops', r'camera\.json: not JSON \(line 2\)'),
    ('empty', '', r'camera\.json: not JSON'),
    ('list', '[1, 2]', r'camera\.json: a camera must be an object'),
    ('no fov', {'type': 'perspective'}, "'fov_x_deg' must be given"),
    ('no width', {'type': 'orthographic'}, "'ortho_width' must be given"),
    ('fov text', {'fov_x_deg': 'wide'}, "'fov_x_deg' must be a number"),
    ('fov 180', {'fov_x_deg': 180}, "'fov_x_deg' must be a number between"),
    ('type', {'type': 'fisheye', 'fov_x_deg': 50}, "'type' must be \"perspective\""),
    ('near', {'fov_x_deg': 50, 'near': -1}, "'near' must be a number > 0"),
    ('shift', {'fov_x_deg': 50, 'shift_x': 99}, "'shift_x' must be"),
    ('three rows', {'fov_x_deg': 50, 'world_to_view': TURN[:3]}, '4 rows of 4 numbers'),
    ('short row', {'fov_x_deg': 50, 'world_to_view': [[1, 2, 3]] * 4}, '4 rows of 4 numbers'),
    ('transposed', {'fov_x_deg': 50, 'world_to_view': [list(r) for r in zip(*TURN)]},
     'column vectors'),
    ('zero', {'fov_x_deg': 50, 'world_to_view': [[0] * 4] * 3 + [[0, 0, 0, 1]]}, 'a rotation'),
    ('shear', {'fov_x_deg': 50, 'world_to_view': [[1, 1, 0, 0], *np.eye(4).tolist()[1:]]},
     'without shear'),
    ('views', {'views': 3}, "'views' must be"),
    ('view', {'views': {'left': {}}}, "left: 'fov_x_deg' must be given"),
    ('one key twice', '{"fov_x_deg": 50, "_": 1, "_": 2, "near": 1, "fov_x_deg": 30}',
     r"camera\.json: key 'fov_x_deg' is given twice"),
    ('one view twice', '{"views": {"left": {"fov_x_deg": 50}, "left": {"fov_x_deg": 30}}}',
     r"camera\.json: view 'left' is given twice"),
    ('views twice', '{"views": {"left": {"fov_x_deg": 50}}, "views": {}}',
     r"camera\.json: key 'views' is given twice"),
]


@cases(CAMERAS)
def camera_files_are_checked(scratch, _, content, message):
    gbuffer(scratch)
    text = content if isinstance(content, str) else json.dumps(content)
    scratch.write('camera.json', text)
    scratch.fails(INPUT, message, 'in.exr', '-o', 'out.exr', '--camera', 'camera.json')


@cases([('fov', 'fov_x_deg'), ('fovX', 'fov_x_deg'), ('hfov', 'fov_x_deg'), ('fr', 'far'),
        ('near_plane', 'near'), ('shift', 'shift_x'), ('shiftY', 'shift_y'), ('tpye', 'type'),
        ('orthoWidth', 'ortho_width'), ('worldToView', 'world_to_view'), ('focal', None)])
def key_that_was_meant_is_hinted_at(scratch, wrong, right):
    gbuffer(scratch)
    write_camera(scratch.path('c.json'), {wrong: 1})
    scratch.fails(INPUT, f"c.json: unknown key '{wrong}'", 'in.exr', '-o', 'out.exr', '--camera',
                  'c.json', hint=f'did you mean "{right}"' if right else 'lists the keys')


@case
def missing_camera_file(scratch):
    gbuffer(scratch)
    scratch.fails(INPUT, r'none\.json: cannot open: No such file', 'in.exr', '-o', 'out.exr',
                  '--camera', 'none.json')
    os.mkdir(scratch.path('dir.json'))
    scratch.fails(INPUT, r'dir\.json: cannot (open|read)', 'in.exr', '-o', 'out.exr', '--camera',
                  'dir.json')


@case
def cameras_of_views_need_views(scratch):
    gbuffer(scratch)
    write_camera(scratch.path('camera.json'), {'views': {'left': camera()}})
    scratch.fails(CHANNELS, 'cameras for the views left, but in.exr has no views', 'in.exr', '-o',
                  'out.exr', '--camera', 'camera.json', hint='--view NAME')


# --- Output ---

@case
def existing_outputs_are_kept(scratch):
    gbuffer(scratch)
    scratch.write('out.exr', 'mine')
    scratch.write('out.png', 'mine')
    scratch.fails(OUTPUT, r'out\.exr: exists', *RUN, hint='--overwrite always')
    scratch.fails(OUTPUT, r'out\.png: exists', 'in.exr', '-o', 'new.exr', '--preview', 'out.png',
                  hint='--overwrite always')
    scratch.render(*RUN, '--overwrite', 'always')


@case
def existing_previews_of_views_are_kept(scratch):
    write_exr(scratch.path('in.exr'), ({'Z': SCENE.depth()}, {'name': 'Z.l', 'view': 'l'}),
              ({'Z': SCENE.depth()}, {'name': 'Z.r', 'view': 'r'}))
    scratch.write('p.r.png', 'mine')
    scratch.fails(OUTPUT, r'p\.r\.png: exists', *RUN, '--view', 'all', '--preview', 'p.png')


@case
def views_that_would_share_a_preview_are_refused(scratch):
    # A path has no slash in a name.
    write_exr(scratch.path('in.exr'), ({'Z': SCENE.depth()}, {'name': 'Z.l', 'view': 'a/b'}),
              ({'Z': SCENE.depth()}, {'name': 'Z.r', 'view': 'a_b'}))
    for when in 'never', 'always':
        scratch.fails(OUTPUT, r"p\.a_b\.png: the preview of both views 'a/b' and 'a_b'", *RUN,
                      '--view', 'all', '--preview', 'p.png', '--overwrite', when, hint='--view')
    scratch.render(*RUN, '--view', 'a/b', '--preview', 'p.png')


@case
def names_too_long_for_files_are_refused_before_any_frame(scratch):
    gbuffer(scratch)
    shutil.copy(scratch.path('in.exr'), scratch.path('in.1.exr'))
    shutil.copy(scratch.path('in.exr'), scratch.path('in.10.exr'))
    name = 'o' * (255 - len('1.exr')) + '@.exr'  # of frame 10 a byte too long
    scratch.fails(OUTPUT, 'cannot create: File name too long', 'in.@.exr', '-o', name, '--fov', FOV)
    equal(scratch.files(), ['in.1.exr', 'in.10.exr', 'in.exr'], 'files')


@cases([(f'{mode}: {link} to {target}', mode, link, target)
        for mode in ('never', 'always', 'skip')
        for link in ('out.2.exr', 'out.2.png', 'cam.2.json', 'out.2.l.png')
        for target in ('nowhere', 'no/such/directory', 'in a circle')])
def link_to_nothing_as_output_is_refused_before_any_frame(scratch, _, mode, link, target):
    target = link if target == 'in a circle' else target
    for n in (1, 2):
        views = ({'Z': SCENE.depth()}, {'name': 'Z.l', 'view': 'l'}), \
                ({'Z': SCENE.depth()}, {'name': 'Z.r', 'view': 'r'})
        write_exr(scratch.path(f'in.{n}.exr'), *views)
    os.symlink(target, scratch.path('link'))
    os.symlink('link', scratch.path(link))
    line = ('in.@.exr', '--overwrite', mode, '--fov', FOV)
    said = r': cannot create: it is a symbolic link ' + (
        'that leads in a circle' if target == link else rf'to {target}, which is not there')
    if link.startswith('cam'):
        line = ('inspect', *line, '--write-camera', 'cam.@.json')
    elif link == 'out.2.l.png':  # known once the views are
        line = ('in.2.exr', *line[1:], '-o', 'out.2.exr', '--view', 'all', '--preview', 'out.2.png')
    else:
        line += ('-o', 'out.@.exr', '--view', 'l', '--preview', 'out.@.png')
    scratch.fails(OUTPUT, rf'{link}{said}', *line, hint='remove the link, or name the file itself')


@case
def link_to_no_directory_is_told(scratch):
    gbuffer(scratch)
    os.symlink('not mounted', scratch.path('disk'))
    for line in (('in.exr', '-o', 'disk/out.exr', '--fov', FOV),
                 ('inspect', 'in.exr', '--write-camera', 'disk/cam.json', '--fov', FOV)):
        scratch.fails(OUTPUT, r'there is no directory disk$', *line,
                      hint="a symbolic link to 'not mounted': make that first")


@cases(['out.2.exr', 'out.2.png', 'cam.2.json'])
def what_is_no_file_is_refused_before_any_frame(scratch, name):
    for n in (1, 2):
        gbuffer(scratch, f'in.{n}.exr')
    os.mkfifo(scratch.path(name))
    line = ('in.@.exr', '--overwrite', 'always', '--fov', FOV)
    scratch.fails(OUTPUT, rf'{name}: cannot create: not a regular file',
                  *(('inspect', *line, '--write-camera', 'cam.@.json') if name[0] == 'c' else
                    (*line, '-o', 'out.@.exr', '--preview', 'out.@.png')))


@case
def output_must_not_be_the_input(scratch):
    gbuffer(scratch)
    os.symlink('in.exr', scratch.path('link.exr'))
    os.link(scratch.path('in.exr'), scratch.path('hard.exr'))
    os.mkdir(scratch.path('d'))
    for name in ('in.exr', './in.exr', 'd/../in.exr', 'link.exr', 'hard.exr',
                 scratch.path('in.exr')):
        for options in (('-o', name), ('-o', 'new.exr', '--preview', name)):
            scratch.fails(USAGE, 'are the same file', 'in.exr', *options, '--fov', FOV,
                          '--overwrite', 'always')
    scratch.fails(USAGE, 'are the same file', 'link.exr', '-o', 'hard.exr', '--overwrite',
                  'always')


@case
def output_must_not_be_the_camera(scratch):
    gbuffer(scratch)
    write_camera(scratch.path('camera.exr'))
    scratch.fails(USAGE, 'are the same file', 'in.exr', '-o', 'camera.exr', '--camera',
                  'camera.exr', '--overwrite', 'always')


@case
def output_must_not_be_the_preview(scratch):
    gbuffer(scratch)
    for name in ('out.exr', './out.exr', scratch.path('out.exr')):
        scratch.fails(USAGE, 'are the same file', *RUN, '--preview', name)


@case
def output_directory_must_exist(scratch):
    gbuffer(scratch)
    scratch.fails(OUTPUT, r'no/out\.exr: cannot create: .*(No such|no directory)', 'in.exr',
                  '-o', 'no/out.exr')


@case
def directories_without_room_for_files_are_told(scratch):
    gbuffer(scratch)
    scratch.fails(OUTPUT, '/proc/out.exr: cannot create: No such file', 'in.exr', '-o',
                  '/proc/out.exr', hint='no file can be made in /proc/: name another directory')


@case
def failing_preview_leaves_no_output(scratch):
    gbuffer(scratch)
    scratch.fails(OUTPUT, r'no/out\.png: cannot create', *RUN, '--preview', 'no/out.png')


@case
def directory_as_output(scratch):
    gbuffer(scratch)
    os.mkdir(scratch.path('out.exr'))
    scratch.fails(OUTPUT, r'out\.exr: cannot create: Is a directory', *RUN, '--overwrite',
                  'always')


@case
def unwritable_directory(scratch):
    gbuffer(scratch)
    os.mkdir(scratch.path('locked'), 0o500)
    scratch.fails(OUTPUT, r'locked/out\.exr: cannot create: Permission denied', 'in.exr', '-o',
                  'locked/out.exr', preexec_fn=unprivileged(scratch))


def noise(scratch):
    rng = np.random.default_rng(1)
    depth = (5 + rng.random((200, 200))).astype(np.float32)
    write_exr(scratch.path('in.exr'), {'Z': depth})


WRITTEN = [('ao', ()), ('append', ('--mode', 'append')),
           ('float', ('--pixel-type', 'float', '--compression', 'none')),
           ('overwrite', ('--overwrite', 'always')), ('threads', ('--threads', '4'))]
# Within the first write, in a later one, and in what closes the file.
LIMITS = (0, 1, 500, 20000, 30000)


@cases([(f'{name} {limit}', options, limit) for name, options in WRITTEN for limit in LIMITS])
def file_size_limit_leaves_nothing(scratch, _, options, limit):
    noise(scratch)
    scratch.fails(OUTPUT, r'out\.exr: cannot write: File too large', *RUN, *options,
                  hint='ulimit -f', preexec_fn=lambda: limit_file_size(limit))


@case
def file_size_limit_at_every_byte_leaves_all_or_nothing(scratch):
    """The last limits are those that the file just fits."""
    gbuffer(scratch)
    scratch.render(*RUN, '--compression', 'none')
    size = os.path.getsize(scratch.path('out.exr'))
    for limit in (size - 1, size - 9, size // 2):
        os.remove(scratch.path('out.exr'))
        scratch.fails(OUTPUT, r'out\.exr: cannot write', *RUN, '--compression', 'none',
                      preexec_fn=lambda: limit_file_size(limit))
        scratch.render(*RUN, '--compression', 'none',
                       preexec_fn=lambda: limit_file_size(size))


@cases([('first byte', 0), ('middle', 0.5), ('last byte', 1)])
def file_size_limit_leaves_no_preview(scratch, _, share):
    grey = np.random.default_rng(1).random((200, 200)).astype(np.float32)
    write_exr(scratch.path('in.exr'),
              {'Z': 5 + grey, 'R': grey, 'G': grey, 'B': grey})
    run = ('in.exr', '--fov', FOV, '--mode', 'comp', '--compression', 'dwab')
    os.mkdir(scratch.path('whole'))
    scratch.render(*run, '-o', 'whole/out.exr', '--preview', 'whole/out.png')
    exr, png = (os.path.getsize(scratch.path('whole', 'out.' + f)) for f in ('exr', 'png'))
    check(exr < png, f'the picture to fail on is smaller than the EXR: {png} < {exr}')
    limit = int(exr + (png - 1 - exr) * share)
    failed = scratch.run(*run, '-o', 'out.exr', '--preview', 'out.png',
                         preexec_fn=lambda: limit_file_size(limit))
    equal(failed.code, OUTPUT, f'exit code of {failed}')
    matches(r'vkao: out\.png: cannot write: File too large', failed.stderr, 'stderr')
    check('out.png' not in scratch.files(), 'a partial picture')
    scratch.check_no_litter()


@case
def standard_output_may_have_a_size_limit(scratch):
    gbuffer(scratch)
    with open(scratch.path('text'), 'w', encoding='utf-8') as file:
        run = scratch.run('inspect', 'in.exr', stdout=file,
                          preexec_fn=lambda: limit_file_size(10))
    equal(run.code, OUTPUT, f'exit code of {run}')
    matches('vkao: standard output: cannot write', run.stderr, 'stderr')


@case
def full_disk_keeps_the_old_file(scratch):
    write_exr(scratch.path('in.exr'), {'Z': np.linspace(5, 6, 40000, dtype=np.float32)
                                       .reshape(200, 200)})
    scratch.write('out.exr', 'old')
    scratch.fails(OUTPUT, r'out\.exr: cannot write', *RUN, '--compression', 'none', '--overwrite',
                  'always', preexec_fn=lambda: limit_file_size(20000))
    equal(scratch.bytes('out.exr'), b'old', 'the old file')


@case
def standard_output_may_be_full(scratch):
    if not os.path.exists('/dev/full'):
        skip('no /dev/full')
    gbuffer(scratch)
    with open('/dev/full', 'w', encoding='utf-8') as full:
        for arguments in (('inspect', 'in.exr'), ('--help',), ('devices',)):
            run = scratch.run(*arguments, stdout=full)
            equal(run.code, OUTPUT, f'exit code of {arguments} > /dev/full')
            matches('vkao: standard output: cannot write', run.stderr, 'stderr')


# --- Device ---

NO_DRIVER = r'no Vulkan (device|driver)'


@case
def no_device_is_an_error_of_its_own(scratch):
    gbuffer(scratch)
    scratch.write('empty.json', '')
    for path in ('none.json', 'empty.json'):
        env = {'VK_ICD_FILENAMES': scratch.path(path), 'VK_DRIVER_FILES': scratch.path(path)}
        scratch.fails(DEVICE, NO_DRIVER, *RUN, env=env, hint='mesa-vulkan-drivers')
        run = scratch.run('devices', env=env)
        equal(run.code, DEVICE, 'exit code of devices')
        matches(NO_DRIVER, run.stderr, 'stderr of devices')


@case
def input_is_checked_before_the_device(scratch):
    env = {'VK_ICD_FILENAMES': 'none.json', 'VK_DRIVER_FILES': 'none.json'}
    scratch.fails(INPUT, 'cannot open', *RUN, env=env)


@case
def pixels_come_before_the_device(scratch):
    gbuffer(scratch)
    with open(scratch.path('in.exr'), 'rb') as file:
        whole = file.read()
    scratch.write('in.exr', whole[:len(whole) * 2 // 3])
    env = {'VK_ICD_FILENAMES': 'none.json', 'VK_DRIVER_FILES': 'none.json'}
    for more in ([], ['--validation']):
        scratch.fails(INPUT, r'in\.exr', *RUN, *more, env=env)


@case
def unknown_device_lists_those_there_are(scratch):
    gbuffer(scratch)
    for name in ('Voodoo2', '77'):
        scratch.fails(DEVICE, rf'fits --device {name}', *RUN, '--device', name, hint='.')


@case
def success_is_zero(scratch):
    gbuffer(scratch)
    equal(scratch.run(*RUN).code, OK, 'exit code')
    check(os.path.getsize(scratch.path('out.exr')) > 300, 'no output')


if __name__ == '__main__':
    main()
