#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""What vkao-view's Save writes, and that vkao makes the same by the command in it."""
import shlex
import signal

import view  # first: it knows where cli.py lies
from cli import (case, cases, check, check_close, equal, is_sanitized, np, read_parts, rename_shim,
                 skip, wait_for_stop, write_exr)
from scene import HEIGHT, WIDTH
from view import READ, WHOLE, Viewer, gbuffer, opened, read_png, same_picture, script

SAVES = {
    'default': ('2', ()),
    'raw': ('1', ('--intensity', '2')),
    'composite': ('3', ('--tint', '0.1,0.2,0.3', '--strength', '0.7')),
    'gtao': ('2', ('--method', 'gtao', '--slices', '3', '--steps', '7', '--blur', '7',
                   '--falloff', 'threshold', '--noise-index', '3')),
    'half': ('2', ('--quality', 'fast', '--thickness', '0.3', '--bias', '0.01', '--power', '1.3')),
    'sphere': ('2', ('--method', 'sphere', '--sphere-form', 'literal', '--blocking-scale', '7',
                     '--samples', '9')),
    'sharp': ('2', ('--method', 'hemisphere', '--blur-sharpness', '33', '--blur-normal-power',
                    '0', '--samples', '33')),
    'no normals': ('2', ('--normal', 'none', '--depth', 'Z')),
    'bent': ('6', ()),
    'light': ('3', ('--indirect', 'gi', '--specular', 'spec', '--holdout', 'matte', '--back-depth',
                    'back')),
    'light unseen': ('2', ('--indirect', 'gi', '--albedo', 'albedo', '--holdout', 'matte',
                           '--layer2', 'behind')),
}


# The tool compiles its pipelines for the settings at hand, the viewer for all: the same operations,
# but other instructions, so that the last bit differs, and once in a while a sample at the edge of
# a texel or sector.
LARGEST, MEAN = 5e-3, 1e-6


@cases(SAVES.items())
def saved_command_makes_the_saved_files(scratch, _, row):
    key, options = row
    with opened(scratch, *WHOLE, *options, more='--holdout' in options) as viewer:
        viewer.key(key, 's')
        shown = viewer.finish()
    equal(scratch.files(), ['in.exr', 'in.view.exr', 'in.view.png', 'in.view.sh', 'last.png'],
          'files')
    command = script(scratch, 'in.view.sh')
    check(shlex.split(viewer.out)[1:] == command, f'not printed: {viewer.out}')
    saved = read_parts(scratch.path('in.view.exr'))[0]
    same_picture(read_png(scratch.path('in.view.png')), shown, 'PNG')
    scratch.render(*command, '--device', 'cpu')
    made = read_parts(scratch.path('in.view.exr'))[0]
    equal(sorted(saved.channels), sorted(made.channels), 'channels')
    for name, channel in saved.channels.items():
        check_close(channel, made[name], LARGEST, MEAN, name)
    equal(saved.attributes['vkao/params'], made.attributes['vkao/params'], 'vkao/params')
    if key in '123':
        same_picture(read_png(scratch.path('in.view.png')), shown, 'PNG of vkao')


@cases(['2', '3', '6'])
def save_of_a_cropped_window_is_what_vkao_makes(scratch, key):
    part = {k: np.ascontiguousarray(c[21:, 17:]) for k, c in gbuffer().items()}
    write_exr(scratch.path('in.exr'), part, x=17, y=21, display=(0, 0, WIDTH - 1, HEIGHT - 1))
    with Viewer(scratch, 'in.exr', *READ, *WHOLE) as viewer:
        viewer.key(key, 's')
        shown = viewer.finish()
    same_picture(read_png(scratch.path('in.view.png')), shown, 'PNG')
    saved = read_parts(scratch.path('in.view.exr'))[0]
    scratch.render(*script(scratch, 'in.view.sh'), '--device', 'cpu')
    made = read_parts(scratch.path('in.view.exr'))[0]
    equal(saved.data_window, made.data_window, 'data window')
    for name, channel in made.channels.items():
        check_close(saved[name], channel, LARGEST, MEAN, name)


@case
def saving_again_overwrites_nothing(scratch):
    with opened(scratch, *WHOLE, '--save', 'a b') as viewer:
        viewer.key('s')
        viewer.key('4')
        viewer.wait_title('- Depth -')
        viewer.key('s')
        shown = viewer.finish()
    check({'a b.sh', 'a b.exr', 'a b.png', 'a b.2.sh', 'a b.2.exr', 'a b.2.png'} <=
          set(scratch.files()), f'{scratch.files()}')
    same_picture(read_png(scratch.path('a b.2.png')), shown, 'depth')
    check('vkao writes no picture' in scratch.bytes('a b.2.sh').decode(), 'it is not said')
    scratch.render(*script(scratch, 'a b.2.sh'), '--device', 'cpu')


@case
def save_that_fails_is_said_and_leaves_nothing(scratch):
    with opened(scratch, *WHOLE, '--save', 'nowhere/x') as viewer:
        viewer.key('s')
        viewer.finish()
        check('vkao: nowhere/x.' in viewer.err, f'nothing is said:\n{viewer.err}')
    equal(scratch.files(), ['in.exr', 'last.png'], 'files')


@cases([('AO', '2', 'in'), ('depth', '4', 'in'), ('live', '2', 'room')])
def save_that_fails_at_the_last_file_leaves_nothing(scratch, kind, key, name):
    """Somebody else makes a file of its name meanwhile."""
    if is_sanitized(view.VIEWER):
        skip('sanitizers want to be loaded first')
    files, line = (3, ('in.exr', *READ)) if name == 'in' else (5, ('--scene', name, '--time', 1))
    env = {**rename_shim(), 'VKAO_STOP_AT': str(files)}
    write_exr(scratch.path('in.exr'), gbuffer())
    with Viewer(scratch, *line, *WHOLE, env=env) as viewer:
        viewer.key(key, 's')
        wait_for_stop(viewer.process)
        scratch.write(f'{name}.view.sh', 'of somebody else')
        viewer.process.send_signal(signal.SIGCONT)
        viewer.finish()
        check(f'vkao: {name}.view.sh: exists' in viewer.err, f'nothing is said:\n{viewer.err}')
    equal(scratch.files(), sorted(['in.exr', f'{name}.view.sh', 'last.png']), 'files')


if __name__ == '__main__':
    view.main()
