#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""vkao inspect and vkao devices: what they print, as text and as JSON."""
import json
import os

import numpy as np

from cli import (CHANNELS, INPUT, OK, case, cases, check, corpus, equal, main, matches, oiio,
                 write_exr)
from scene import FAR, FOV, NEAR, Scene, camera, write_camera

SCENE = Scene(64, 36)


def inspect(scratch, *arguments):
    run = scratch.run('inspect', *arguments)
    equal(run.code, OK, f'exit code of {run}')
    return run.stdout


def inspect_json(scratch, *arguments):
    return json.loads(inspect(scratch, *arguments, '--json'))


def stereo(scratch):
    other = Scene(64, 36, eye=0.3)
    write_exr(scratch.path('in.exr'), *[
        (channels, {'name': f'{name}.{view}', 'view': view})
        for view, scene in (('left', SCENE), ('right', other))
        for name, channels in (('depth', {'Z': scene.depth()}), ('N', scene.normals()))])


@case
def json_tells_parts_and_channels(scratch):
    write_exr(scratch.path('in.exr'),
              (SCENE.color(), {'name': 'beauty', 'compression': 'piz', 'tile': 32}),
              ({'Z': SCENE.depth()}, {'name': 'depth', 'compression': 'zips', 'tile': 16}),
              x=-4, y=2, display=(-8, -8, 99, 49))
    facts = inspect_json(scratch, 'in.exr')
    equal(facts['file'], 'in.exr', 'file')
    first, second = facts['parts']
    equal((first['index'], first['name'], first['type'], first['compression']),
          (0, 'beauty', 'tiledimage', 'piz'), 'first part')
    equal((second['name'], second['compression']), ('depth', 'zips'), 'second part')
    equal(first['data_window'], [-4, 2, 59, 37], 'data_window')
    equal(first['display_window'], [-8, -8, 99, 49], 'display_window')
    equal([c['name'] for c in first['channels']], ['A', 'B', 'G', 'R'], 'channels')
    equal(second['channels'],
          [{'name': 'Z', 'type': 'float', 'x_sampling': 1, 'y_sampling': 1}], 'channels')


@case
def json_tells_roles_camera_and_conventions(scratch):
    write_exr(scratch.path('in.exr'),
              {'Z': SCENE.depth(), **SCENE.normals(space='world'), **SCENE.color()})
    write_camera(scratch.path('camera.json'))
    view, = inspect_json(scratch, 'in.exr', '--camera', 'camera.json')['views']
    roles = view['roles']
    equal({k: v and v['channels'] for k, v in roles.items()},
          {'depth': ['Z'], 'normal': ['N.X', 'N.Y', 'N.Z'], 'color': ['R', 'G', 'B'],
           'position': None, 'ao': None}, 'roles')
    lens = view['camera']
    equal((lens['type'], lens['source'], lens['near'], lens['far'], lens['rotation']),
          ('perspective', 'camera file', NEAR, FAR, 'camera file'), 'camera')
    check(abs(lens['fov_x_deg'] - FOV) < 1e-6, f'fov_x_deg is {lens["fov_x_deg"]}')
    found = view['conventions']
    equal((found['depth_type'], found['normal_space'], found['normal_encoding']),
          ('planar', 'world', 'signed'), 'conventions')
    seen = SCENE.z[~SCENE.sky]
    for key, value in (('min_z', seen.min()), ('max_z', seen.max()),
                       ('median_z', np.median(seen)), ('background_share', SCENE.sky.mean())):
        check(abs(found[key] - value) <= 0.01 * value, f'{key} is {found[key]}, want {value}')
    check('problem' not in view, str(view.get('problem')))


@case
def text_tells_the_same(scratch):
    write_exr(scratch.path('in.exr'), {'Z': SCENE.depth(), **SCENE.normals(), **SCENE.color()},
              attributes=[('PixelAspectRatio', 2.0)])
    text = inspect(scratch, 'in.exr', '--fov', FOV)
    for pattern in (r'^in\.exr\n', r'(?m)^part 0: scanlineimage zip, data \(0,0\)-\(63,35\), '
                    r'display \(0,0\)-\(63,35\), pixel aspect 2$', r'(?m)^  float N\.X$',
                    r'(?m)^  depth +Z \(float, part 0\)$', r'(?m)^  normal +N \(float, part 0\)$',
                    r'(?m)^  color ', r'(?m)^  position +-$',
                    r'(?m)^  camera +perspective, 60 degrees horizontal \(--fov\)',
                    r'(?m)^  depth is +planar \(.*\): z .* background \d+ %',
                    r'(?m)^  normals +camera space, signed; agreement with depth \d'):
        matches(pattern, text, 'text')


@case
def assumed_camera_is_called_so(scratch):
    write_exr(scratch.path('in.exr'), {'Z': SCENE.depth()})
    view, = inspect_json(scratch, 'in.exr')['views']
    equal(view['camera']['source'], 'assumed', 'source of the camera')
    equal(view['conventions']['normal_space'], 'none', 'normal_space')
    matches(r'\(assumed\)', inspect(scratch, 'in.exr'), 'text')


@case
def orthographic_camera_has_a_width(scratch):
    write_exr(scratch.path('in.exr'), {'Z': SCENE.depth()})
    view, = inspect_json(scratch, 'in.exr', '--ortho', 7.5)['views']
    equal((view['camera']['type'], view['camera']['ortho_width']), ('orthographic', 7.5), 'camera')
    check('fov_x_deg' not in view['camera'], 'an orthographic camera with a field of view')


@case
def every_view_is_told(scratch):
    stereo(scratch)
    views = inspect_json(scratch, 'in.exr', '--view', 'all')['views']
    equal([v['name'] for v in views], ['left', 'right'], 'views')
    equal([v['roles']['depth']['part'] for v in views], [0, 2], 'parts of the depths')
    matches(r'(?ms)^view left$.*^view right$', inspect(scratch, 'in.exr', '--view', 'all'), 'text')
    # Without --view all the same, but a run would end.
    told = scratch.run('inspect', 'in.exr', '--json')
    equal(told.code, scratch.run('in.exr', '-o', 'ao.exr').code, 'exit code: that of a run')
    facts = json.loads(told.stdout)
    equal([v['name'] for v in facts['views']], ['left', 'right'], 'views')
    matches('in.exr: several views: left, right', facts['problem'], 'problem')
    matches('--view NAME, --view all', facts['hint'], 'hint')
    text = scratch.run('inspect', 'in.exr').stdout
    matches(r'(?ms)can process it, with --view left .*can process it, with --view right ', text,
            'text')
    matches(r'(?m)^  problem +in.exr: several views: left, right\n +add --view NAME', text, 'text')
    one = inspect_json(scratch, 'in.exr', '--view', 'right')['views']
    equal([v['name'] for v in one], ['right'], 'views')


@case
def cameras_of_views_are_told_apart(scratch):
    stereo(scratch)
    write_camera(scratch.path('camera.json'),
                 {'views': {'left': camera(50), 'right': camera(70)}})
    views = inspect_json(scratch, 'in.exr', '--camera', 'camera.json')['views']
    equal([round(v['camera']['fov_x_deg']) for v in views], [50, 70], 'fields of view')


@case
def unusable_files_are_told_all_the_same(scratch):
    write_exr(scratch.path('in.exr'), {**SCENE.color(), **SCENE.normals()})
    run = scratch.run('inspect', 'in.exr', '--json')
    equal(run.code, CHANNELS, 'exit code: that of a run')
    facts = json.loads(run.stdout)
    equal(len(facts['parts'][0]['channels']), 7, 'number of channels')
    matches('no depth channel found', facts['views'][0]['problem'], 'problem')
    matches('--depth', facts['views'][0]['hint'], 'hint')
    matches(r'(?m)^  problem +.*no depth channel found', scratch.run('inspect', 'in.exr').stdout,
            'text')


@cases([('name', 'problem with "quotes", ünïcode\\and\ttab'), ('plain', 'plain')])
def json_survives_any_name(scratch, _, name):
    write_exr(scratch.path('in.exr'), ({'Z': SCENE.depth()}, {'name': name}),
              ({'A': SCENE.depth()}, {'name': 'other'}))
    facts = inspect_json(scratch, 'in.exr')
    equal(facts['parts'][0]['name'], name, 'name of the part')


@case
def multi_view_channels_are_told(scratch):
    views = ('multiView', oiio.TypeDesc('string[2]'), ('left', 'right'))
    write_exr(scratch.path('in.exr'), {'Z': SCENE.depth(), 'right.Z': SCENE.depth()},
              attributes=[views])
    equal(scratch.run('inspect', 'in.exr').code, CHANNELS, 'exit code: that of a run')
    found = inspect_json(scratch, 'in.exr', '--view', 'all')['views']
    equal([(v['name'], v['roles']['depth']['channels']) for v in found],
          [('left', ['Z']), ('right', ['right.Z'])], 'views')


@case
def inspect_needs_no_device(scratch):
    write_exr(scratch.path('in.exr'), {'Z': SCENE.depth()})
    env = {'VK_ICD_FILENAMES': 'none.json', 'VK_DRIVER_FILES': 'none.json'}
    equal(scratch.run('inspect', 'in.exr', env=env).code, OK, 'exit code')


@case
def first_frame_of_a_sequence_is_told(scratch):
    for n in (3, 4):
        write_exr(scratch.path(f'in.000{n}.exr'), {'Z': SCENE.depth()})
    equal(inspect_json(scratch, 'in.####.exr')['file'], 'in.0003.exr', 'file')


@case
def damaged_files_are_errors(scratch):
    scratch.write('in.exr', 'no')
    run = scratch.run('inspect', 'in.exr', '--json')
    equal((run.code, run.stdout), (INPUT, ''), 'exit code and stdout')


@case
def damaged_file_of_depth_is_an_error(scratch):
    """Sanitizers find what was read of the other file and not freed."""
    write_exr(scratch.path('in.exr'), {'Z': SCENE.depth()})
    scratch.write('z.exr', 'no')
    run = scratch.run('inspect', 'in.exr', '--depth-file', 'z.exr')
    equal((run.code, run.stdout), (INPUT, ''), 'exit code and stdout')
    matches(r'vkao: z\.exr: ', run.stderr, 'stderr')


@cases(['b5_suzannes_stereo', 'm3_statues_tiny', 'b5_suzannes_ortho'])
def files_of_renderers_are_understood(scratch, name):
    facts = inspect_json(scratch, corpus(f'{name}.exr'), '--camera',
                         corpus(f'{name}.camera.json'))
    for view in facts['views']:
        check('problem' not in view, str(view.get('problem')))
        check(view['roles']['depth'] and view['roles']['normal'], 'roles are missing')
        mitsuba = name.startswith('m3')
        equal(view['conventions']['depth_type'], 'radial-near' if mitsuba else 'planar', 'depth')
        equal(view['conventions']['normal_space'], 'world', 'space of the normals')


# --- Devices ---

@case
def devices_are_listed(scratch):
    run = scratch.run('devices')
    equal((run.code, run.stderr), (OK, ''), 'exit code and stderr')
    matches(r'(?m)^0  .+ \(.+, Vulkan 1\.\d+\.\d+(, too old)?\)$', run.stdout, 'text')
    facts = json.loads(scratch.run('devices', '--json').stdout)
    equal([d['index'] for d in facts['devices']], list(range(len(facts['devices']))), 'indices')
    equal(len(run.stdout.splitlines()), len(facts['devices']), 'number of lines')
    for device in facts['devices']:
        equal(sorted(device), ['api_version', 'index', 'name', 'type', 'usable'], 'keys')
        check(device['name'] in run.stdout, f'{device["name"]} is not in the text')


@case
def every_usable_device_can_be_chosen(scratch):
    write_exr(scratch.path('in.exr'), {'Z': SCENE.depth()})
    for device in json.loads(scratch.run('devices', '--json').stdout)['devices']:
        if not device['usable']:
            continue
        for choice in (str(device['index']), device['name'].split(' (')[0]):
            scratch.render('in.exr', '-o', 'ao.exr', '--overwrite', 'always', '--device', choice)


@cases(['tools/demo/courtyard.exr', 'tests/golden/courtyard_small.exr'])
def scenes_of_the_project_are_right(scratch, name):
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..', name)
    for options in (), ('--camera', 'none', '--fov', 56):
        result = json.loads(scratch.run('inspect', path, '--json', *options).stdout)
        equal([w for w in result['views'][0]['warnings'] if 'AO is wrong' in str(w)], [], name)


@cases([('named radial', 'dd.y', 'radial', ['camera', 'depth type']),
        ('flat', 'Z', 'planar', ['camera']), ('with normals', 'Z', 'planar', None),
        ('with positions', 'Z', 'planar', None)],
       name=lambda row: row[0])
def what_nothing_confirms_is_told(scratch, what, name, kind, unconfirmed):
    scene = Scene(320, 180)
    place = np.stack([scene.x, scene.y, -np.ones_like(scene.x)]) * scene.z
    more = {'with normals': scene.normals(),
            'with positions': {f'P.{c}': np.where(scene.sky, 0, p).astype(np.float32)
                               for c, p in zip('XYZ', place)}}
    write_exr(scratch.path('in.exr'), {name: scene.depth(kind), **more.get(what, {})})
    options = () if what == 'with positions' else ('--fov', FOV)
    said = scratch.run('inspect', 'in.exr', *options).stdout
    result = json.loads(scratch.run('inspect', 'in.exr', '--json', *options).stdout)
    equal(result['views'][0]['conventions'].get('unconfirmed'), unconfirmed, 'unconfirmed')
    words = ' and '.join(unconfirmed or [])
    equal(f'from depth; nothing in the file can confirm {words}\n' in said,
          unconfirmed is not None, f'whether it is in {said}')


if __name__ == '__main__':
    main()
