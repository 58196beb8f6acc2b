#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""--like: the record in a file makes the same file again, to the bit, and is not trusted."""
import json

from cli import (CHANNELS, INPUT, USAGE, case, cases, check, equal, matches, main, np, read_parts,
                 write_exr)
from exr_raw import read_raw
from scene import FOV, Scene, camera, write_camera

SCENE = Scene(96, 54)
VIEW = ('--fov', FOV)


def gbuffer(scratch, name='in.exr', **options):
    channels = {'Z': SCENE.depth(), **SCENE.normals(), **SCENE.color()}
    for layer, distance in (('back', 0.05), ('second', 0.2)):
        z = np.where(SCENE.sky, 1e10, SCENE.z + distance).astype(np.float32)
        channels[f'{layer}.V'] = z
    # One thickness for all would be said.
    channels['thick.V'] = np.where(SCENE.x < 0, 0.05, 0.08).astype(np.float32)
    write_exr(scratch.path(name), channels, **options)


def record(scratch, name, part=0):
    return json.loads(read_raw(scratch.bytes(name))[part].text('vkao/params'))


def same_pixels(scratch, a, b):
    one, two = read_parts(scratch.path(a)), read_parts(scratch.path(b))
    equal([sorted(p.channels) for p in one], [sorted(p.channels) for p in two], 'channels')
    for p, q in zip(one, two):
        for name, plane in p.channels.items():
            bits = f'u{plane.itemsize}'
            check(np.array_equal(plane.view(bits), q[name].view(bits)),
                  f'{name} of {a} and {b} differ')


SETTINGS = [
    ('fast', '--quality', 'fast'),
    ('default', '--quality', 'default'),
    ('high', '--quality', 'high'),
    ('best', '--quality', 'best'),
    ('bent normals', '--bent-normals', '--pixel-type', 'float'),
    ('comp', '--mode', 'comp', '--strength', '.7', '--tint', '.1,.2,.3', '--compression', 'piz'),
    ('append', '--mode', 'append', '--part-name', 'occlusion'),
    ('sphere', '-m', 'sphere', '--sphere-form', 'literal', '--blocking-scale', '17.3', '-s', '7'),
    ('odd', '-m', 'gtao', '--slices', '3', '--steps', '7', '--falloff', 'threshold', '--radius',
     '.4711', '--bias', '.0123', '--intensity', '1.37', '--power', '.77', '--blur', '5',
     '--blur-sharpness', '33', '--blur-normal-power', '3.5', '--noise-index', '3', '--bent-normals',
     '--pixel-type', 'float'),
    ('raymarch', '-m', 'raymarch', '-s', '5', '--steps', '9', '--thickness', '.31', '--quality',
     'fast'),
    ('thickness', '--thickness-channel', 'thick.V', '--bent-normals', '--pixel-type', 'float'),
    ('layers', '--back-depth', 'back.V', '--layer2', 'second.V', '-m', 'raymarch', '--quality',
     'fast'),
    ('no normals', '--normal', 'none', '--depth', 'Z', '--depth-type', 'radial'),
]


@cases([(name, options) for name, *options in SETTINGS])
def record_makes_the_same_file_again(scratch, name, options):
    gbuffer(scratch)
    scratch.render('in.exr', '-o', 'a.exr', *VIEW, *options)
    named = ('--part-name', 'occlusion') if name == 'append' else ()
    run = scratch.render('--like', 'a.exr', 'in.exr', '-o', 'b.exr', *named)
    check('warning' not in run.stderr, run.stderr)
    same_pixels(scratch, 'a.exr', 'b.exr')
    if name != 'append':
        equal(scratch.bytes('a.exr'), scratch.bytes('b.exr'), 'the file')


@case
def orthographic_camera_is_in_it(scratch):
    gbuffer(scratch)
    scratch.render('in.exr', '-o', 'a.exr', '--ortho', 7.3)
    scratch.render('--like', 'a.exr', 'in.exr', '-o', 'b.exr')
    equal(scratch.bytes('a.exr'), scratch.bytes('b.exr'), 'the file')
    equal(record(scratch, 'b.exr')['parameters']['projection'], 'orthographic', 'projection')


@case
def camera_file_with_world_normals_is_in_it(scratch):
    write_exr(scratch.path('in.exr'), {'Z': SCENE.depth('device'), **SCENE.normals(space='world')})
    write_camera(scratch.path('camera.json'), camera(shift_x=0.01))
    scratch.render('in.exr', '-o', 'a.exr', '--camera', 'camera.json', '--depth-type', 'device')
    scratch.render('--like', 'a.exr', 'in.exr', '-o', 'b.exr')
    equal(scratch.bytes('a.exr'), scratch.bytes('b.exr'), 'the file')


@case
def assumed_camera_stays_one_with_its_warning(scratch):
    write_exr(scratch.path('in.exr'), {'Z': SCENE.depth()})
    scratch.render('in.exr', '-o', 'a.exr')
    gbuffer(scratch)  # whose normals would tell the camera now
    run = scratch.render('--like', 'a.exr', 'in.exr', '-o', 'b.exr')
    matches('assuming 40 degrees', run.stderr, 'stderr')


@case
def estimated_camera_is_in_it(scratch):
    gbuffer(scratch)
    scratch.render('in.exr', '-o', 'a.exr')
    run = scratch.render('--like', 'a.exr', 'in.exr', '-o', 'b.exr')
    matches(r'fov=60.* \(estimated', run.stderr, 'stderr')
    equal(scratch.bytes('a.exr'), scratch.bytes('b.exr'), 'the file')


@case
def half_depth_keeps_the_raised_bias(scratch):
    depth = np.minimum(SCENE.depth(), 65504).astype(np.float16)
    write_exr(scratch.path('in.exr'), {'Z': depth, **SCENE.normals()})
    scratch.render('in.exr', '-o', 'a.exr', *VIEW, '--radius', '.05')
    check(record(scratch, 'a.exr')['parameters']['bias'] > 0.005, 'the bias was not raised')
    scratch.render('--like', 'a.exr', 'in.exr', '-o', 'b.exr')
    equal(scratch.bytes('a.exr'), scratch.bytes('b.exr'), 'the file')


@case
def cropped_window_gets_the_same_noise(scratch):
    gbuffer(scratch, x=5, y=3, display=(0, 0, 127, 71))
    scratch.render('in.exr', '-o', 'a.exr', *VIEW, '--blur', 'off')
    scratch.render('--like', 'a.exr', 'in.exr', '-o', 'b.exr')
    equal(scratch.bytes('a.exr'), scratch.bytes('b.exr'), 'the file')


@case
def stereo_has_a_record_for_each_view(scratch):
    eyes = {'left': -0.1, 'right': 0.1}
    parts = []
    for name, eye in eyes.items():
        scene = Scene(96, 54, eye=eye)
        parts.append(({'Z': scene.depth(), **scene.normals()},
                      {'name': f'gbuffer.{name}', 'view': name}))
    write_exr(scratch.path('in.exr'), *parts)
    cameras = {'views': {'left': camera(shift_x=0.01), 'right': camera(shift_x=-0.01)}}
    write_camera(scratch.path('camera.json'), cameras)
    scratch.render('in.exr', '-o', 'a.exr', '--camera', 'camera.json', '--normal-space', 'camera')
    scratch.render('--like', 'a.exr', 'in.exr', '-o', 'b.exr')
    equal(scratch.bytes('a.exr'), scratch.bytes('b.exr'), 'the file')
    equal([record(scratch, 'b.exr', i)['camera']['shift_x'] for i in (0, 1)], [0.01, -0.01],
          'shifts')
    scratch.render('in.exr', '-o', 'c.exr', '--camera', 'camera.json', '--view', 'right',
                   '--normal-space', 'camera')
    scratch.render('--like', 'c.exr', 'in.exr', '-o', 'd.exr')
    equal(scratch.bytes('c.exr'), scratch.bytes('d.exr'), 'the file of one view')
    scratch.fails(CHANNELS, 'no record of view', '--like', 'c.exr', 'in.exr', '-o', 'e.exr',
                  '--view', 'left', hint='--view')


@case
def sequence_takes_one_record_or_one_for_each_frame(scratch):
    for n, fov in ((1, 50), (2, 60)):
        gbuffer(scratch, f'in.{n}.exr')
        scratch.render(f'in.{n}.exr', '-o', f'a.{n}.exr', '--fov', fov)
    scratch.render('--like', 'a.%d.exr', 'in.%d.exr', '-o', 'b.%d.exr')
    for n in (1, 2):
        equal(scratch.bytes(f'a.{n}.exr'), scratch.bytes(f'b.{n}.exr'), f'frame {n}')
    scratch.render('--like', 'a.1.exr', 'in.%d.exr', '-o', 'c.%d.exr')
    equal([record(scratch, f'c.{n}.exr')['camera']['fov_x_deg'] for n in (1, 2)], [50, 50], 'fov')


@case
def options_come_before_the_record(scratch):
    gbuffer(scratch)
    scratch.render('in.exr', '-o', 'a.exr', *VIEW, '--radius', 2, '--power', 2, '-m', 'gtao')
    scratch.render('--like', 'a.exr', 'in.exr', '-o', 'b.exr', '--power', 1, '--quality', 'fast')
    scratch.render('in.exr', '-o', 'c.exr', *VIEW, '--radius', 2, '-m', 'gtao', '--quality', 'fast')
    equal(scratch.bytes('b.exr'), scratch.bytes('c.exr'), 'the file')
    scratch.render('in.exr', '--radius', 'auto', '--fov', 50, '-o', 'd.exr', '--like', 'a.exr')
    scratch.render('in.exr', '-o', 'e.exr', '--fov', 50, '--power', 2, '-m', 'gtao')
    equal(scratch.bytes('d.exr'), scratch.bytes('e.exr'), 'the file with a radius found anew')
    scratch.render('in.exr', '-o', 'f.exr', *VIEW, '-m', 'hbao')
    scratch.render('in.exr', '-o', 'h.exr', *VIEW, '--back-depth', 'back.V', '--layer2', 'second.V')
    scratch.render('--like', 'h.exr', 'in.exr', '-o', 'i.exr', '--thickness-channel', 'thick.V',
                   '--layer2', 'none')
    scratch.render('in.exr', '-o', 'j.exr', *VIEW, '--thickness-channel', 'thick.V')
    equal(scratch.bytes('i.exr'), scratch.bytes('j.exr'), 'the file of another thickness')
    scratch.fails(USAGE, '--back-depth needs --method vbao or raymarch', '--like', 'h.exr',
                  'in.exr', '-o', 'k.exr', '-m', 'gtao')
    scratch.fails(USAGE, '--bent-normals needs --method gtao, vbao or raymarch', '--like', 'f.exr',
                  'in.exr', '-o', 'g.exr', '--bent-normals')


@case
def files_without_a_record_are_named(scratch):
    gbuffer(scratch)
    scratch.fails(INPUT, 'in.exr: no record of vkao in it', '--like', 'in.exr', 'in.exr', '-o',
                  'out.exr', hint='--like')
    scratch.fails(INPUT, 'none.exr: cannot open', '--like', 'none.exr', 'in.exr', '-o', 'out.exr')
    scratch.fails(USAGE, '--like is empty', '--like', '', 'in.exr', '-o', 'out.exr')
    scratch.write('text.exr', 'no EXR')
    scratch.fails(INPUT, 'text.exr', '--like', 'text.exr', 'in.exr', '-o', 'out.exr')


def forged(scratch, change):
    """A file whose record went through change(text)."""
    gbuffer(scratch)
    scratch.render('in.exr', '-o', 'a.exr', *VIEW)
    text = change(read_raw(scratch.bytes('a.exr'))[0].text('vkao/params'))
    write_exr(scratch.path('forged.exr'), {'AO': SCENE.depth()},
              attributes=(('vkao/params', text),))


@cases([
    ('version', '"record":1', '"record":99', "forged.exr: vkao/params: 'record' is 99, want 1",
     'which wrote it'),
    ('old', '"record":1,', '', "forged.exr: vkao/params: 'record' is missing, want 1",
     'which wrote it'),
    ('value', '"radius":', '"radius":-',
     "forged.exr: vkao/params: 'parameters.radius' is -", 'damaged'),
    ('word', '"vbao"', '"\\u001b[31mvbao"',
     r"'parameters.method' is '\\x1b\[31mvbao', want sphere,",
     'damaged'),
    ('cut', '"camera":{', '"kamera":{', "'camera' is missing, want an object", 'damaged'),
    ('text', '{', '', 'not the record of vkao', '--like'),
])
def damaged_records_are_refused(scratch, _, old, new, message, hint):
    forged(scratch, lambda text: text.replace(old, new, 1))
    scratch.fails(INPUT, message, '--like', 'forged.exr', 'in.exr', '-o', 'out.exr', hint=hint)


@case
def absurd_but_legal_values_are_refused_by_name(scratch):
    forged(scratch, lambda text: text.replace('"half_width":', '"half_width":1e300,"x":', 1))
    scratch.fails(CHANNELS, 'no usable projection', '--like', 'forged.exr', 'in.exr', '-o',
                  'out.exr', hint='--fov')


@case
def another_version_or_device_is_warned_about(scratch):
    forged(scratch, lambda text: text.replace('"device":"', '"device":"another ', 1))
    run = scratch.render('--like', 'forged.exr', 'in.exr', '-o', 'out.exr')
    matches('made by vkao .* on another .*: AO may differ in its last bits', run.stderr, 'stderr')


if __name__ == '__main__':
    main()
