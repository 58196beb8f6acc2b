#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Many frames and several views."""
import os
import re

import numpy as np

from cli import (CHANNELS, INPUT, OK, OUTPUT, SOME_FRAMES, USAGE, case, cases, check, check_close,
                 equal, main, matches, oiio, read_ao, read_parts, write_exr)
from exr_raw import read_raw
from scene import FOV, RADIUS, Scene, camera, write_camera

VIEW = ('--fov', FOV, '--radius', RADIUS)
SIZE = (64, 36)


def frame(number):
    """The eye moves, so that every frame has another result."""
    scene = Scene(*SIZE, eye=0.2 * number)
    return {'Z': scene.depth(), **scene.normals()}


def sequence(scratch, numbers=(1, 2, 3), pattern='in.{:04d}.exr'):
    for n in numbers:
        write_exr(scratch.path(pattern.format(n)), frame(n))


def outputs(scratch, prefix='ao.'):
    return [f for f in scratch.files() if f.startswith(prefix)]


# --- Frames ---

@cases([('####', 'in.{:04d}.exr'), ('%04d', 'in.{:04d}.exr'), ('#', 'in.{:04d}.exr'),
        ('$F4', 'in.{:04d}.exr'), ('@@@@', 'in.{:04d}.exr'), ('##', 'in.{:02d}.exr'),
        ('%d', 'in.{:d}.exr')])
def every_token_finds_all_frames(scratch, token, name):
    sequence(scratch, pattern=name)
    scratch.render(f'in.{token}.exr', '-o', f'ao.{token}.exr', *VIEW)
    equal(outputs(scratch), [name.replace('in', 'ao').format(n) for n in (1, 2, 3)], 'outputs')


@case
def frames_equal_single_runs(scratch):
    sequence(scratch)
    scratch.render('in.####.exr', '-o', 'ao.####.exr', '--preview', 'ao.####.png', *VIEW)
    os.mkdir(scratch.path('one'))
    seen = []
    for n in (1, 2, 3):
        exr, png = f'ao.000{n}.exr', f'ao.000{n}.png'
        scratch.render(f'in.000{n}.exr', '-o', f'one/{exr}', '--preview', f'one/{png}', *VIEW)
        equal(scratch.bytes(exr), scratch.bytes(f'one/{exr}'), f'frame {n}')
        equal(scratch.bytes(png), scratch.bytes(f'one/{png}'), f'preview {n}')
        seen.append(scratch.bytes(f'one/{exr}'))
    check(len(set(seen)) == 3, 'frames do not differ')


@cases([('1-3', [1, 2, 3]), ('2', [2]), ('1-5x2', [1, 3, 5]), ('5,1-2', [1, 2, 5]),
        ('3-1', [1, 2, 3]), ('1-2,2-3', [1, 2, 3])])
def frames_are_chosen(scratch, spec, wanted):
    sequence(scratch, range(1, 6))
    scratch.render('in.####.exr', '-o', 'ao.####.exr', '--frames', spec, *VIEW)
    equal(outputs(scratch), [f'ao.{n:04d}.exr' for n in wanted], 'outputs')


@case
def openjd_steps_with_a_colon(scratch):
    sequence(scratch, range(1, 6))
    scratch.render('in.####.exr', '-o', 'ao.####.exr', '--frames', '1-5:2', '--frames-syntax',
                   'openjd', *VIEW)
    equal(outputs(scratch), ['ao.0001.exr', 'ao.0003.exr', 'ao.0005.exr'], 'outputs')


@case
def camera_file_may_be_a_sequence(scratch):
    sequence(scratch)
    for n in (1, 2, 3):
        write_camera(scratch.path(f'camera.{n:04d}.json'), camera(fov=50 + 5 * n))
    options = ('--normal-space', 'camera', '--radius', RADIUS)
    scratch.render('in.####.exr', '-o', 'ao.####.exr', '--camera', 'camera.####.json', *options)
    for n in (1, 2, 3):
        scratch.render(f'in.000{n}.exr', '-o', 'one.exr', '--overwrite', 'always', '--camera',
                       f'camera.000{n}.json', *options)
        equal(scratch.bytes(f'ao.000{n}.exr'), scratch.bytes('one.exr'), f'frame {n}')
    scratch.fails(INPUT, r'camera\.0004\.json: cannot open', 'in.0001.exr', '-o', 'x.exr',
                  '--camera', 'camera.0004.json')


# --- Cameras beside the frames ---

BESIDE = ('--normal-space', 'camera', '--radius', RADIUS)


def with_cameras(scratch, numbers):
    sequence(scratch)
    for n in numbers:
        write_camera(scratch.path(f'in.{n:04d}.camera.json'), camera(fov=50 + 5 * n))


@case
def camera_beside_a_frame_is_its_camera(scratch):
    with_cameras(scratch, (1, 2))
    run = scratch.render('in.####.exr', '-o', 'ao.####.exr', '--frames', '1-2', *BESIDE)
    equal(run.stderr.count('camera: in.0001.camera.json, beside the input, and so for each frame'),
          1, 'lines that say so')
    for n in (1, 2):
        scratch.render(f'in.000{n}.exr', '-o', 'one.exr', '--overwrite', 'always', '--camera',
                       f'in.000{n}.camera.json', *BESIDE)
        equal(scratch.bytes(f'ao.000{n}.exr'), scratch.bytes('one.exr'), f'frame {n}')


@case
def camera_option_comes_before_the_camera_beside(scratch):
    with_cameras(scratch, (1,))
    write_camera(scratch.path('other.json'), camera(fov=90))
    frame_1 = ('in.0001.exr', '--overwrite', 'always', *BESIDE)
    scratch.render(*frame_1, '-o', 'beside.exr')
    other = scratch.render(*frame_1, '-o', 'other.exr', '--camera', 'other.json')
    none = scratch.render(*frame_1, '-o', 'none.exr', '--camera', 'none', '--fov', 90)
    for run in (other, none):
        check('camera: in.0001' not in run.stderr, f'it is said to be taken:\n{run.stderr}')
    equal(scratch.bytes('other.exr') == scratch.bytes('beside.exr'), False, 'the camera is taken')
    equal(read_ao(scratch.path('none.exr')).tolist(), read_ao(scratch.path('other.exr')).tolist(),
          'AO with 90 degrees')
    # What AO was made with is what --like makes it with.
    like = scratch.render(*frame_1, '-o', 'like.exr', '--like', 'other.exr')
    check('camera: in.0001' not in like.stderr, f'it is said to be taken:\n{like.stderr}')
    equal(scratch.bytes('like.exr'), scratch.bytes('other.exr'), 'the camera of the record')


@case
def camera_beside_some_frames_is_an_error(scratch):
    with_cameras(scratch, (1, 3))
    sequence_ = ('in.####.exr', '-o', 'ao.####.exr', *BESIDE)
    scratch.fails(INPUT, r'in\.0002\.camera\.json: cannot open', *sequence_, hint='--camera none')
    equal(outputs(scratch), [], 'outputs')
    run = scratch.run(*sequence_, '--continue-on-error')
    equal(run.code, SOME_FRAMES, f'exit code of {run}')
    matches(r'vkao: in\.0002\.camera\.json: cannot open', run.stderr, 'the message')
    equal(outputs(scratch), ['ao.0001.exr', 'ao.0003.exr'], 'outputs')
    scratch.render(*sequence_, '--overwrite', 'always', '--camera', 'none', '--frames', '2')
    equal(len(outputs(scratch)), 3, 'outputs without them')


@case
def damaged_camera_beside_the_input_is_an_error(scratch):
    sequence(scratch, (1,))
    scratch.write('in.0001.camera.json', '{')
    scratch.fails(INPUT, r'in\.0001\.camera\.json: ', 'in.0001.exr', '-o', 'ao.exr', *BESIDE)


@case
def output_over_the_camera_beside_is_refused(scratch):
    with_cameras(scratch, (1,))
    scratch.fails(USAGE, 'are the same file', 'in.0001.exr', '-o', 'ao.exr', '--preview',
                  'in.0001.camera.json', '--overwrite', 'always', *BESIDE)


@cases([('INPUT', 'in', ()), ('--depth-file', 'd', ('--depth-file', 'd.####.exr'))])
def output_must_not_be_a_file_of_another_frame(scratch, what, name, options):
    """By a link, and by a name that is the input of another frame."""
    sequence(scratch, (1, 2))
    sequence(scratch, (1, 2), 'd.{:04d}.exr')
    sequence(scratch, (1, 11), 'a1{:d}.exr')
    os.symlink(f'{name}.0001.exr', scratch.path('ao.0002.exr'))
    before = {name: scratch.bytes(name) for name in scratch.files()}
    for when in ('always', 'skip'):
        scratch.fails(USAGE, r'ao\.0002\.exr: --output of frame 2 and '
                      f'{what} of frame 1 are the same file', 'in.####.exr', '-o', 'ao.####.exr',
                      *options, '--overwrite', when, *VIEW, hint='remove links among them')
    scratch.fails(USAGE, r'a11\.exr: --output of frame 11 and INPUT of frame 1 are the same file',
                  'a1@.exr', '-o', 'a@.exr', '-f', '11,1', '--overwrite', 'always', *VIEW)
    equal({name: scratch.bytes(name) for name in scratch.files()}, before, 'files')


@case
def outputs_of_two_frames_must_not_be_one_file(scratch):
    sequence(scratch, (1, 2))
    scratch.write('ao.0001.exr', 'old')
    os.symlink('ao.0001.exr', scratch.path('ao.0002.exr'))
    scratch.fails(USAGE, r'--output of frame 1 and --output of frame 2 are the same file',
                  'in.####.exr', '-o', 'ao.####.exr', '--overwrite', 'always', *VIEW)


@case
def progress_names_every_frame(scratch):
    sequence(scratch)
    text = scratch.render('in.####.exr', '-o', 'ao.####.exr', *VIEW).stderr
    for n in (1, 2, 3):
        matches(rf'(?m)^vkao: frame {n}/3 \({n}\): ao\.000{n}\.exr$', text, 'progress')
    equal(text.count('using:'), 1, 'number of summaries')


@case
def auto_radius_is_that_of_the_first_frame(scratch):
    for n, distance in ((1, 2.0), (2, 4.0)):
        write_exr(scratch.path(f'in.{n}.exr'), {'Z': np.full((8, 8), distance, np.float32)})
    scratch.render('in.%d.exr', '-o', 'ao.%d.exr', '--depth-type', 'planar')
    for n in (1, 2):
        raw = read_raw(scratch.bytes(f'ao.{n}.exr'))[0]
        matches(r'"radius":0\.1,', raw.text('vkao/params'), 'parameters')


@case
def missing_frame_tells_those_found(scratch):
    sequence(scratch, (1, 2, 3, 7))
    run = scratch.run('in.####.exr', '-o', 'ao.####.exr', '--frames', '2-5', *VIEW)
    equal(run.code, INPUT, 'exit code')
    matches(r'vkao: in\.0004\.exr: cannot open: No such file', run.stderr, 'stderr')
    matches(r'(?m)^ +frames found: 1-3, 7 \(pattern in\.####\.exr\)', run.stderr, 'the hint')
    equal(outputs(scratch), ['ao.0002.exr', 'ao.0003.exr'], 'outputs')


@case
def continue_on_error_does_the_rest(scratch):
    sequence(scratch, (1, 2, 4))
    run = scratch.run('in.####.exr', '-o', 'ao.####.exr', '--frames', '1-4',
                      '--continue-on-error', *VIEW)
    equal(run.code, SOME_FRAMES, 'exit code')
    matches('1 of 4 frames failed', run.stderr, 'stderr')
    equal(outputs(scratch), ['ao.0001.exr', 'ao.0002.exr', 'ao.0004.exr'], 'outputs')


@case
def existing_output_stops_before_any_work(scratch):
    sequence(scratch)
    scratch.write('ao.0003.exr', 'mine')
    scratch.fails(OUTPUT, r'ao\.0003\.exr: exists', 'in.####.exr', '-o', 'ao.####.exr', *VIEW,
                  hint='--overwrite always')


# --- --overwrite skip ---

SKIP = ('in.####.exr', '-o', 'ao.####.exr', '--fov', FOV, '--overwrite', 'skip')


def growing(scratch, numbers=(1, 2, 3)):
    """Each frame alone has another automatic radius."""
    for n in numbers:
        channels = frame(n)
        channels['Z'] = np.where(channels['Z'] < 1e9, n * channels['Z'], 1e10).astype(np.float32)
        write_exr(scratch.path(f'in.{n:04d}.exr'), channels)


def radius_in(scratch, n):
    text = read_raw(scratch.bytes(f'ao.{n:04d}.exr'))[0].text('vkao/params')
    return float(re.search(r'"radius":([\d.]+),', text)[1])


@case
def a_second_run_makes_what_is_missing(scratch):
    growing(scratch)
    options = (*SKIP, '--preview', 'ao.####.png')
    scratch.render(*options)
    made = {name: scratch.bytes(name) for name in outputs(scratch)}
    os.remove(scratch.path('ao.0002.exr'))
    os.remove(scratch.path('ao.0002.png'))
    scratch.write('ao.0003.exr', 'mine')
    run = scratch.render(*options)
    matches(r'ao\.0001\.exr: exists, computed again', run.stderr, 'first frame')
    for n in (1, 3):
        matches(rf'ao\.000{n}\.exr: exists, left as it is\n', run.stderr, 'what is left')
    check('other settings' not in run.stderr, f'the same settings are others: {run}')
    equal(scratch.bytes('ao.0003.exr'), b'mine', 'what was there')
    for name in ('ao.0001.exr', 'ao.0002.exr'):
        equal(scratch.bytes(name), made[name], name)  # the radius is that of all frames, too
    again = scratch.render(*options)
    equal(again.stderr.count('left as it is\n'), 3, 'frames left')
    check('computed again' not in again.stderr, f'nothing is to be made: {again}')
    os.remove(scratch.path('ao.0001.exr'))
    scratch.write('ao.0001.png', 'mine')
    scratch.fails(OUTPUT, r'ao\.0001\.png: exists', *options, hint='remove it')


@case
def frames_that_exist_tell_the_radius(scratch):
    """Also one that the first frame asked for would not have."""
    growing(scratch)
    scratch.render(*SKIP, '--frames', '2-3')
    scratch.render(*SKIP)
    equal([radius_in(scratch, n) for n in (1, 2, 3)], [0.6] * 3, 'radii')
    os.remove(scratch.path('ao.0001.exr'))
    os.remove(scratch.path('in.0002.exr'))
    run = scratch.render(*SKIP, '--frames', '1-2')
    matches(r'in\.0002\.exr: cannot open.*: it is not known what all frames share', run.stderr,
            'the input that is gone')
    equal(radius_in(scratch, 1), 0.6, 'radius')


@case
def other_settings_than_those_of_frames_that_exist_are_said(scratch):
    growing(scratch)
    scratch.render(*SKIP, '--frames', '1-2')
    run = scratch.render(*SKIP, '--method', 'gtao', '--radius', '9')
    matches(r'other settings than the rest will be, in .*method.*radius.*--like', run.stderr,
            'the warning')
    run = scratch.render('in.####.exr', '-o', 'none.####.exr', '--frames', '1-2')
    os.remove(scratch.path('none.0001.exr'))
    scratch.write('none.0002.exr', 'mine')
    run = scratch.render('in.####.exr', '-o', 'none.####.exr', '--fov', FOV, '--overwrite', 'skip')
    matches(r'none\.0002\.exr: .*: left as it is, whatever made it', run.stderr, 'no record')


@case
def frames_that_exist_and_show_nothing_tell_nothing(scratch):
    growing(scratch, (2, 3))
    write_exr(scratch.path('in.0001.exr'), empty())
    scratch.render(*SKIP)
    made = scratch.bytes('ao.0003.exr')
    os.remove(scratch.path('ao.0003.exr'))
    scratch.render(*SKIP)
    equal(scratch.bytes('ao.0003.exr'), made, 'frame 3')


@case
def previews_of_both_eyes_are_left_with_their_frame(scratch):
    for n in (1, 2):
        write_multi_part(scratch, f'in.{n:04d}.exr')
    options = (*SKIP, '--view', 'all', '--preview', 'ao.####.png')
    scratch.render(*options)
    made = {name: scratch.bytes(name) for name in outputs(scratch)}
    equal(len(made), 6, 'outputs')
    for name in [name for name in made if '0002' in name]:
        os.remove(scratch.path(name))
    run = scratch.render(*options)
    check('not known' not in run.stderr, f'frame 1 is not computed again: {run}')
    equal({name: scratch.bytes(name) for name in outputs(scratch)}, made, 'outputs')
    os.remove(scratch.path('ao.0001.exr'))
    scratch.write('ao.0001.left.png', 'mine')
    run = scratch.run(*options)
    equal(run.code, OUTPUT, 'exit code')
    matches(r'ao\.0001\.left\.png: exists, not overwritten\n +remove it', run.stderr, 'stderr')


@cases(['an empty file', 'a directory', 'a link to nothing'])
def what_no_run_leaves_is_not_left_alone(scratch, what):
    sequence(scratch)
    path = scratch.path('ao.0003.exr')
    if what == 'a directory':
        os.mkdir(path)
    elif what == 'a link to nothing':
        os.symlink('nothing.exr', path)
    else:
        scratch.write('ao.0003.exr', '')
    said = 'cannot create: it is a symbolic link to nothing.exr, which is not there' \
        if what == 'a link to nothing' else 'exists, not overwritten'
    scratch.fails(OUTPUT, rf'ao\.0003\.exr: {said}', 'in.####.exr', '-o', 'ao.####.exr',
                  '--overwrite', 'skip', *VIEW, hint='remove')
    equal(outputs(scratch), ['ao.0003.exr'], 'outputs')


@case
def one_file_that_exists_is_left(scratch):
    sequence(scratch, (1,))
    scratch.write('ao.exr', 'mine')
    run = scratch.render('in.0001.exr', '-o', 'ao.exr', '--overwrite', 'skip', *VIEW)
    matches(r'ao\.exr: exists, left as it is\n', run.stderr, 'stderr')
    equal(scratch.bytes('ao.exr'), b'mine', 'what was there')
    scratch.write('cam.json', 'mine')
    run = scratch.run('inspect', 'in.0001.exr', '--write-camera', 'cam.json', '--overwrite', 'skip',
                      '--fov', FOV)
    matches(r'cam\.json: exists, left as it is\n', run.stderr, 'stderr')
    equal(scratch.bytes('cam.json'), b'mine', 'what was there')


@cases([
    ('colon', ('in.####.exr', '-o', 'ao.####.exr', '-f', '1-3:2'), "':' means step", 'openjd'),
    ('one name', ('in.####.exr', '-o', 'ao.exr'), "--output 'ao.exr' has no frame token", '####'),
    ('one preview', ('in.####.exr', '-o', 'ao.####.exr', '--preview', 'a.png'),
     '--preview .* no frame token', '####'),
    ('one input', ('in.0001.exr', '-o', 'ao.exr', '-f', '1-3'), 'INPUT .* no frame token', '####'),
    ('output alone', ('in.0001.exr', '-o', 'ao.####.exr'), 'has a frame token, but INPUT', None),
    ('two tokens', ('in.####.%d.exr', '-o', 'ao.####.exr'), 'more than one frame token', None),
    ('mixed', ('in.##@@.exr', '-o', 'ao.####.exr'), 'mixes # and @', '####'),
    ('not a number', ('in.####.exr', '-o', 'ao.####.exr', '-f', 'a'), 'frames .a.: expected', None),
    ('no end', ('in.####.exr', '-o', 'ao.####.exr', '-f', '1-'), 'frames .1-.: expected', None),
    ('step 0', ('in.####.exr', '-o', 'ao.####.exr', '-f', '1-3x0'), 'step must be', None),
    ('too many', ('in.####.exr', '-o', 'ao.####.exr', '-f', '1-99999999'), 'more than', None),
])
def frame_options_are_checked(scratch, _, arguments, message, hint):
    sequence(scratch)
    scratch.fails(USAGE, message, *arguments, hint=hint)


@cases(['shot@2x', 'a#b_ao', '100%done', 'x$FF'])
def letters_that_are_no_token_stay(scratch, name):
    sequence(scratch, (1,))
    scratch.render('in.0001.exr', '-o', f'{name}.exr', '--preview', f'{name}.png', *VIEW)
    equal(scratch.files(), sorted([f'{name}.exr', 'in.0001.exr', f'{name}.png']), 'files')


@cases(['ao.#.exr', 'ao####.exr', 'ao%04d.exr', 'ao.%d.exr', 'ao_@.exr', '$F4.exr'])
def tokens_need_one_in_the_input(scratch, name):
    sequence(scratch, (1,))
    scratch.fails(USAGE, 'has a frame token, but INPUT', 'in.0001.exr', '-o', name,
                  hint='stands for the number of a frame')


@case
def no_frames_is_an_error(scratch):
    scratch.fails(INPUT, r'in\.####\.exr: no file matches', 'in.####.exr', '-o', 'ao.####.exr')


# --- Frames that show nothing ---

NOTHING = [('1e10', 1e10), ('inf', np.inf), ('0', 0), ('65504', 65504), ('NaN', np.nan)]


def empty(value=1e10):
    like = Scene(*SIZE).depth()
    return {'Z': np.full_like(like, value), **{f'N.{c}': np.zeros_like(like) for c in 'XYZ'}}


def with_empty(scratch, numbers, count=3, value=1e10):
    sequence(scratch, [n for n in range(1, count + 1) if n not in numbers])
    for n in numbers:
        write_exr(scratch.path(f'in.{n:04d}.exr'), empty(value))


def check_as_single(scratch, numbers, *options):
    for n in numbers:
        scratch.render(f'in.{n:04d}.exr', '-o', 'one.exr', '--overwrite', 'always', *options)
        equal(read_ao(scratch.path(f'ao.{n:04d}.exr')).tolist(),
              read_ao(scratch.path('one.exr')).tolist(), f'AO of frame {n}')


@cases(NOTHING)
def a_frame_that_shows_nothing_is_open(scratch, _, value):
    with_empty(scratch, [2], value=value)
    run = scratch.render('in.####.exr', '-o', 'ao.####.exr', *VIEW)
    matches(r"warning: in\.0002\.exr: depth 'Z' is all background: .* AO is 1", run.stderr, 'it')
    check((read_ao(scratch.path('ao.0002.exr')) == 1).all(), 'AO of nothing is not 1')
    check_as_single(scratch, (1, 3), *VIEW)


@cases([('auto', (), 'auto'), ('percent', ('--radius', '5%'), 'by --radius'),
        ('typed', ('--depth-type', 'planar'), 'auto')])
def first_frame_that_shows_something_decides(scratch, _, options, said):
    with_empty(scratch, [1, 2], count=4)
    run = scratch.render('in.####.exr', '-o', 'ao.####.exr', '--camera', 'none', *options)
    equal(outputs(scratch), [f'ao.000{n}.exr' for n in (1, 2, 3, 4)], 'outputs')
    matches(r'in\.0001\.exr: .*: it is made after the first frame that shows', run.stderr, 'note')
    for n in (1, 2):
        check((read_ao(scratch.path(f'ao.000{n}.exr')) == 1).all(), f'AO of frame {n} is not 1')
    alone = scratch.render('in.0003.exr', '-o', 'one.exr', '--camera', 'none', *options)
    used = [line for line in alone.stderr.splitlines() if 'using:' in line]
    check(used[0] in run.stderr.splitlines(), f'not {used} but {run.stderr}')
    radius, = re.findall(rf'radius=(\S+) \({said}\)', run.stderr)
    matches(f'the same with --radius {radius}\n', run.stderr, 'the hint')
    equal(read_ao(scratch.path('ao.0003.exr')).tolist(), read_ao(scratch.path('one.exr')).tolist(),
          'AO of frame 3')
    check_as_single(scratch, [4], '--camera', 'none', '--radius', radius, *options[2:])


@case
def a_sequence_of_nothing_is_an_error(scratch):
    with_empty(scratch, [1, 2])
    os.remove(scratch.path('in.0003.exr'))
    run = scratch.run('in.####.exr', '-o', 'ao.####.exr', *VIEW)
    equal(run.code, CHANNELS, f'exit code of {run}')
    matches(r"vkao: in\.0001\.exr: depth 'Z' is .*: no picture of anything", run.stderr, 'it')
    equal(outputs(scratch), [], 'outputs')
    told = scratch.run('inspect', 'in.####.exr')
    equal(told.code, CHANNELS, 'exit code of inspect')
    matches('problem .*no picture of anything', told.stdout, 'what is told')


@case
def a_frame_of_any_other_value_is_an_error(scratch):
    with_empty(scratch, [2], value=7.3)
    run = scratch.run('in.####.exr', '-o', 'ao.####.exr', *VIEW)
    equal(run.code, CHANNELS, f'exit code of {run}')
    matches(r"in\.0002\.exr: depth 'Z' is 7\.3 everywhere: no picture", run.stderr, 'it')
    scratch.render('in.####.exr', '-o', 'ao.####.exr', '--overwrite', 'always', '--background', 7,
                   *VIEW)


@case
def background_of_the_frames_before_is_nothing(scratch):
    """A far plane that nobody tells: only beside things it is one."""
    for n in (1, 3):
        channels = frame(n)
        channels['Z'] = np.where(channels['Z'] > 1e9, 1000, channels['Z']).astype(np.float32)
        write_exr(scratch.path(f'in.{n:04d}.exr'), channels)
    write_exr(scratch.path('in.0002.exr'), empty(1000))
    scratch.render('in.####.exr', '-o', 'ao.####.exr', *VIEW)
    check((read_ao(scratch.path('ao.0002.exr')) == 1).all(), 'AO of nothing is not 1')


@case
def transparent_frames_show_nothing(scratch):
    sequence(scratch, (1, 3))
    plane = np.full_like(Scene(*SIZE).depth(), 7.3)
    write_exr(scratch.path('in.0002.exr'), {'Z': plane, **{c: plane * 0 for c in 'RGBA'}})
    run = scratch.render('in.####.exr', '-o', 'ao.####.exr', *VIEW)
    matches('in.0002.exr: .* is all background', run.stderr, 'it')


@case
def positions_that_show_nothing_are_open(scratch):
    for n in (1, 2, 3):
        scene = Scene(*SIZE, eye=0.2 * n)
        place = np.stack([scene.x, scene.y, -np.ones_like(scene.x)]) * \
            np.where(scene.sky | (n == 1), 0, scene.z)
        write_exr(scratch.path(f'in.{n:04d}.exr'),
                  {f'P.{c}': p.astype(np.float32) for c, p in zip('XYZ', place)})
    run = scratch.render('in.####.exr', '-o', 'ao.####.exr', '--radius', RADIUS)
    matches("in.0001.exr: positions 'P' is all background", run.stderr, 'it')
    check((read_ao(scratch.path('ao.0001.exr')) == 1).all(), 'AO of nothing is not 1')
    check((read_ao(scratch.path('ao.0002.exr')) < 0.9).any(), 'AO of something is 1')


@case
def the_first_frame_that_shows_something_is_told(scratch):
    with_empty(scratch, [1])
    run = scratch.run('inspect', 'in.####.exr', '--write-camera', 'found.json', *VIEW[:2])
    equal(run.code, OK, f'exit code of {run}')
    matches(r'^in\.0002\.exr\n', run.stdout, 'what is told')
    matches(r'in\.0001\.exr: .* all background', run.stderr, 'what is not')


@case
def one_eye_may_show_nothing(scratch):
    parts = [({'Z': Scene(*SIZE).depth() if view == 'left' else empty()['Z']},
              {'name': f'z.{view}', 'view': view}) for view in EYES]
    for n in (1, 2):
        write_exr(scratch.path(f'in.{n:04d}.exr'), *parts)
    run = scratch.render('in.####.exr', '-o', 'ao.####.exr', '--view', 'all', *VIEW)
    equal(run.stderr.count('all background'), 2, 'warnings')
    equal(scratch.run('inspect', 'in.####.exr', '--view', 'all').code, OK, 'inspect')


# --- Views ---

EYES = {'left': 0.0, 'right': 0.3}


def eye(view):
    scene = Scene(*SIZE, eye=EYES[view])
    return {'Z': scene.depth(), **scene.normals()}


def write_multi_part(scratch, file='in.exr'):
    parts = [({k: v for k, v in eye(view).items() if k.startswith(letter)},
              {'name': f'{name}.{view}', 'view': view})
             for view in EYES for name, letter in (('depth', 'Z'), ('normal', 'N'))]
    write_exr(scratch.path(file), *parts)


def write_single_part(scratch):
    """The default view's channels have no view in their names."""
    left, right = eye('left'), eye('right')
    channels = dict(left)
    for name, plane in right.items():
        channels['.'.join(name.split('.')[:-1] + ['right'] + name.split('.')[-1:])] = plane
    names = ('multiView', oiio.TypeDesc('string[2]'), ('left', 'right'))
    write_exr(scratch.path('in.exr'), channels, attributes=[names])


WRITERS = [('parts', write_multi_part), ('channels', write_single_part)]


def mono(scratch, view):
    write_exr(scratch.path('mono.exr'), eye(view))
    scratch.render('mono.exr', '-o', 'mono.ao.exr', '--overwrite', 'always', *VIEW)
    return read_ao(scratch.path('mono.ao.exr'))


@cases(WRITERS)
def all_views_are_written_as_parts(scratch, _, write):
    write(scratch)
    scratch.render('in.exr', '-o', 'ao.exr', '--view', 'all', *VIEW)
    parts = read_parts(scratch.path('ao.exr'))
    equal([(p.name, p.attributes.get('view')) for p in parts],
          [('ao.left', 'left'), ('ao.right', 'right')], 'parts')
    for part, view in zip(parts, EYES):
        check_close(part['R'].astype(np.float32), mono(scratch, view), 0, 0, view)
    check(not np.array_equal(parts[0]['R'], parts[1]['R']), 'both views are the same')


@cases(WRITERS)
def one_view_is_chosen(scratch, _, write):
    write(scratch)
    for view in EYES:
        scratch.render('in.exr', '-o', f'{view}.exr', '--view', view, *VIEW)
        parts = read_parts(scratch.path(f'{view}.exr'))
        equal(len(parts), 1, 'number of parts')
        check_close(parts[0]['R'].astype(np.float32), mono(scratch, view), 0, 0, view)


@cases(WRITERS)
def views_must_be_chosen(scratch, _, write):
    write(scratch)
    scratch.fails(CHANNELS, r'in\.exr: several views: left, right', 'in.exr', '-o', 'x.exr', *VIEW,
                  hint='--view NAME')
    scratch.fails(CHANNELS, r"no view 'middle'; views: left, right", 'in.exr', '-o', 'x.exr',
                  '--view', 'middle', *VIEW)


@cases(WRITERS)
def camera_file_with_views_means_all(scratch, _, write):
    write(scratch)
    views = {'left': camera(), 'right': camera(fov=50)}
    write_camera(scratch.path('camera.json'), {'views': views})
    options = ('--camera', 'camera.json', '--normal-space', 'camera', '--radius', RADIUS)
    scratch.render('in.exr', '-o', 'ao.exr', *options)
    parts = read_parts(scratch.path('ao.exr'))
    check_close(parts[0]['R'].astype(np.float32), mono(scratch, 'left'), 0.02, 1e-4, 'left')
    check(np.abs(parts[1]['R'] - mono(scratch, 'right')).mean() > 0.002,
          'the camera of the right view is not used')
    write_camera(scratch.path('camera.json'), {'views': {'left': camera()}})
    scratch.fails(CHANNELS, "no camera for view 'right', only for left", 'in.exr', '-o', 'x.exr',
                  '--view', 'all', *options)


@case
def previews_of_views_stay_in_their_directory(scratch):
    """A view is called what the file says; a directory that fits is there."""
    os.makedirs(scratch.path('ao.'))
    parts = [({'Z': Scene(*SIZE).depth()}, {'name': f'z{n}', 'view': view})
             for n, view in enumerate(('left', '/../x'))]
    write_exr(scratch.path('in.exr'), *parts)
    scratch.render('in.exr', '-o', 'out.exr', '--view', 'all', '--preview', 'ao.png', *VIEW)
    equal(scratch.files(), ['ao.', 'ao._.._x.png', 'ao.left.png', 'in.exr', 'out.exr'], 'files')


@case
def previews_of_views_have_their_names(scratch):
    write_multi_part(scratch)
    scratch.render('in.exr', '-o', 'ao.exr', '--view', 'all', '--preview', 'ao.png', *VIEW)
    pngs = [f for f in scratch.files() if f.endswith('.png')]
    equal(len(pngs), 2, f'number of previews ({pngs})')
    check(all(any(view in png for png in pngs) for view in EYES), f'names of previews: {pngs}')


if __name__ == '__main__':
    main()
