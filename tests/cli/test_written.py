#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Cameras that inspect --write-camera keeps, and files of cameras that a run takes."""
import json

import numpy as np

from cli import (CHANNELS, INPUT, OUTPUT, USAGE, case, cases, check, check_close, equal, main,
                 matches, read_ao, write_exr)
from evidence import inspect_and_hear as inspect
from scene import RADIUS, Scene

BASE = ('--radius', RADIUS, '--pixel-type', 'float', '--overwrite', 'always')


@case
def written_camera_is_read_again(scratch):
    scene = Scene(160, 90, 57)
    write_exr(scratch.path('in.exr'), {'Z': scene.depth(), **scene.normals(space='world')})
    view, _ = inspect(scratch, '--write-camera', 'found.json')
    again, _ = inspect(scratch, '--camera', 'found.json')
    equal((again['camera']['source'], again['camera']['rotation']), ('camera file',) * 2, 'source')
    check(abs(again['camera']['fov_x_deg'] - view['camera']['fov_x_deg']) < 1e-9, 'another camera')
    scratch.fails(OUTPUT, 'found.json: exists', 'inspect', 'in.exr', '-q', '--write-camera',
                  'found.json')
    scratch.render('inspect', 'in.exr', '--write-camera', 'found.json', '--overwrite', 'always')
    results = []
    for options in ((), ('--camera', 'found.json')):
        scratch.render('in.exr', '-o', 'ao.exr', *BASE, *options)
        results.append(read_ao(scratch.path('ao.exr')))
    check_close(results[0], results[1], 0.07, 1e-4, 'AO')


def bumped(scene, size):
    """Normals with bumps, which depth has not: they tell a camera, but not surely."""
    turned = scene.normal + np.random.default_rng(3).normal(0, size, scene.normal.shape)
    turned /= np.linalg.norm(turned, axis=-1, keepdims=True)
    turned[scene.sky] = 0
    return {f'N.{c}': turned[..., i].astype(np.float32) for i, c in enumerate('XYZ')}


@cases([('radial', 'Z', 'radial', 0), ('inverse', 'Z', 'inverse', 0), ('planar', 'Z', 'planar', 0),
        ('bumps', 'Z', 'radial', 0.2), ('Mitsuba', 'dd.T', 'radial-near', 0),
        ('no near plane', 'dd.T', 'radial', 0), ('no near plane, bumps', 'dd.T', 'radial', 0.2)])
def written_camera_keeps_the_type_of_depth(scratch, _, channel, kind, bumps):
    scene = Scene(320, 180)
    normals = bumped(scene, bumps) if bumps else scene.normals()
    write_exr(scratch.path('in.exr'), {channel: scene.depth(kind), **normals})
    view, _ = inspect(scratch, '--write-camera', 'found.json')
    again, said = inspect(scratch, '--camera', 'found.json')
    with open(scratch.path('found.json'), encoding='utf-8') as file:
        written = json.load(file)
    named = 'radial-near' if channel == 'dd.T' else 'planar'
    equal(written.get('depth_type'), None if kind == named else kind, 'type in the file')
    equal((view['conventions']['depth_type'], again['conventions']['depth_type']), (kind, kind),
          f'types: {said}')
    if kind != named:
        equal(again['conventions']['depth_source'], 'camera file', 'source')
        forced = inspect(scratch, '--camera', 'found.json', '--depth-type', 'planar')[0]
        equal(forced['conventions']['depth_type'], 'planar', 'an option')
    if bumps:
        return  # which leave open how they are turned
    results = []
    for options in ((), ('--camera', 'found.json')):
        scratch.render('in.exr', '-o', 'ao.exr', *BASE, *options)
        results.append(read_ao(scratch.path('ao.exr')))
    check_close(results[0], results[1], 0.07, 1e-4, 'AO')


@cases(['"Radial"', '"device"', '3', 'null'])
def a_type_of_depth_in_a_camera_file_is_a_known_one(scratch, value):
    write_exr(scratch.path('in.exr'), {'Z': Scene().depth()})
    scratch.write('c.json', f'{{"fov_x_deg": 50, "depth_type": {value}}}')
    scratch.fails(INPUT, "c.json: 'depth_type' must be \"planar\", \"radial\", ", 'in.exr', '-o',
                  'x.exr', '--camera', 'c.json')


@case
def left_handed_camera_is_written_as_one(scratch):
    scene = Scene()
    normals = scene.normals(space='world')
    normals['N.X'] = -normals['N.X']  # of a world whose x points the other way
    rotation = [('unreal/camera/curRot/' + k, '0') for k in ('pitch', 'yaw', 'roll')]
    write_exr(scratch.path('in.exr'), {'Z': scene.depth(), **normals},
              attributes=[('cameraFov', 60.0), *rotation])
    inspect(scratch, '--write-camera', 'found.json')
    with open(scratch.path('found.json'), encoding='utf-8') as file:
        check(json.load(file)['left_handed'] is True, 'no left-handed world')
    equal(inspect(scratch, '--camera', 'found.json')[0]['camera']['rotation'], 'camera file',
          'rotation')


@case
def cameras_of_a_stereo_file_are_written_by_view(scratch):
    scenes = {'left': Scene(160, 90, 60), 'right': Scene(160, 90, 60, eye=0.1)}
    write_exr(scratch.path('in.exr'), *(
        ({'Z': s.depth(), **s.normals(space='world')}, {'view': v, 'name': v})
        for v, s in scenes.items()))
    scratch.render('inspect', 'in.exr', '--view', 'all', '--write-camera', 'found.json')
    with open(scratch.path('found.json'), encoding='utf-8') as file:
        equal(sorted(json.load(file)['views']), ['left', 'right'], 'views')
    equal(scratch.run('inspect', 'in.exr', '--write-camera', 'again.json').code, CHANNELS,
          'exit code without --view')
    equal(scratch.bytes('again.json'), scratch.bytes('found.json'), 'what is written')


@cases(['in.exr.bak', 'found', 'found.exr', '/dev/stdout'])
def a_camera_is_written_to_json_alone(scratch, name):
    write_exr(scratch.path('in.exr'), {'Z': Scene().depth()})
    scratch.write('found.exr', 'mine')
    scratch.fails(USAGE, f"--write-camera is '{name}', want a name that ends in .json", 'inspect',
                  'in.exr', '--fov', 50, '--overwrite', 'always', '--write-camera', name,
                  hint=f'--write-camera {name}.json')


@case
def cameras_of_frames_are_written_each(scratch):
    for n, fov in ((1, 50), (2, None), (3, 60)):
        scene = Scene(160, 90, fov or 50)
        depth = scene.depth() if fov else np.full_like(scene.depth(), np.inf)
        write_exr(scratch.path(f'in.000{n}.exr'), {'Z': depth, **scene.normals()})
    run = scratch.render('inspect', 'in.####.exr', '--write-camera', 'c.####.json')
    equal([f for f in scratch.files() if f.startswith('c.')], ['c.0001.json', 'c.0003.json'],
          'cameras')
    matches('in.0002.exr: .* no camera is written for it', run.stderr, 'stderr')
    for n, fov in ((1, 50), (3, 60)):
        with open(scratch.path(f'c.000{n}.json'), encoding='utf-8') as file:
            check(abs(json.load(file)['fov_x_deg'] - fov) < 0.5, f'camera {n}')
    scratch.fails(USAGE, "--write-camera 'd.####.json' has a frame token, but INPUT", 'inspect',
                  'in.0001.exr', '--write-camera', 'd.####.json', hint="'####' stands for")


@case
def an_unknown_camera_is_not_written(scratch):
    write_exr(scratch.path('in.exr'), {'Z': Scene().depth()})
    scratch.fails(CHANNELS, 'in.exr: no camera was found: nothing to write', 'inspect', 'in.exr',
                  '--write-camera', 'found.json', hint='--fov')
    got = scratch.fails(USAGE, 'are the same file', 'inspect', 'in.exr', '--fov', '50',
                        '--overwrite', 'always', '--write-camera', 'in.exr')
    check(got.stderr, 'nothing is said')


@cases([('missing', None, 'c.0003.json: cannot open|c.0003.json: .*No such file'),
        ('wrong', '{"fov_x_deg": 50, "focal": 3}', "c.0003.json: unknown key 'focal'")])
def cameras_of_later_frames_are_checked_first(scratch, _, third, message):
    for frame in (1, 2, 3):
        write_exr(scratch.path(f'in.{frame:04}.exr'), {'Z': Scene().depth()})
        if frame < 3:
            scratch.write(f'c.{frame:04}.json', '{"fov_x_deg": 50}')
    if third:
        scratch.write('c.0003.json', third)
    scratch.fails(INPUT, message, 'in.####.exr', '-o', 'ao.####.exr', '--camera', 'c.####.json')


if __name__ == '__main__':
    main()
