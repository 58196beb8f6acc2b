#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Position passes: they give the camera and depth without any other image."""
import json

import numpy as np

from cli import (CHANNELS, case, cases, check, check_close, corpus, equal, main, matches, read_ao,
                 read_parts, write_exr)
from evidence import hidden, inspect
from scene import MOVE, NEAR, RADIUS, TURN, Scene, camera, write_camera

BASE = ('--radius', RADIUS, '--pixel-type', 'float', '--overwrite', 'always')


def positions(scene, space='world', z=-1, parallel=0):
    """Of every texel: in the world, or in camera space with z against (-1) or along the view."""
    depth = np.where(scene.sky, 0, scene.z)
    scale = parallel if parallel else depth
    p = np.stack([scene.x * scale, scene.y * scale, -depth], axis=-1)
    p = (p - MOVE) @ TURN if space == 'world' else p * [1, 1, -z]
    p = np.where(scene.sky[..., None], 0, p)
    return {f'P.{c}': p[..., i].astype(np.float32) for i, c in enumerate('XYZ')}


def scene_normals(scene, space, z):
    normals = scene.normals(space=space)
    if space == 'camera' and z > 0:
        normals['N.Z'] = -normals['N.Z']
    return normals


@cases([('world', 'world', -1), ('OpenGL', 'camera', -1), ('pbrt and RenderMan', 'camera', 1)])
def positions_give_depth_and_camera(scratch, name, space, z):
    scene = Scene(168, 96, 44, 1.25)
    layout = {'attributes': [('PixelAspectRatio', 1.25)]}
    write_camera(scratch.path('c.json'), camera(44))
    write_exr(scratch.path('in.exr'), {'Z': scene.depth(), **scene.normals(space='world')},
              **layout)
    scratch.render('in.exr', '-o', 'wanted.exr', *BASE, '--camera', 'c.json')
    write_exr(scratch.path('in.exr'),
              {**positions(scene, space, z), **scene_normals(scene, space, z)}, **layout)
    view = inspect(scratch)
    equal(view['camera']['source'], 'positions', 'source')
    equal(view['conventions']['normal_space'], space, 'normal space')
    check(abs(view['camera']['fov_x_deg'] - 44) < 1e-3, f'{view["camera"]["fov_x_deg"]} degrees')
    scratch.render('in.exr', '-o', 'ao.exr', *BASE)
    ao = read_ao(scratch.path('ao.exr'))
    check_close(ao, read_ao(scratch.path('wanted.exr')), 0.07, 2e-4, name)
    check((ao[scene.sky] == 1).all(), 'the background is not 1')
    scratch.render('in.exr', '-o', 'again.exr', '--like', 'ao.exr')
    check_close(read_ao(scratch.path('again.exr')), ao, 0, 0, '--like')


@cases([('0', 0), ('inf', np.inf), ('nan', np.nan), ('1e10', 1e10), ('-1', -1), ('the eye', None)])
def positions_may_have_any_background(scratch, _, value):
    scene = hidden(0.4)
    value = [value] * 3 if value is not None else -MOVE @ TURN
    normals = scene.normals(space='world')
    write_camera(scratch.path('c.json'))
    write_exr(scratch.path('in.exr'), {'Z': scene.depth(), **normals})
    scratch.render('in.exr', '-o', 'wanted.exr', *BASE, '--camera', 'c.json')
    planes = {n: np.where(scene.sky, v, plane).astype(np.float32)
              for (n, plane), v in zip(positions(scene).items(), value)}
    for depth in {}, {'Z': scene.depth()}:
        write_exr(scratch.path('in.exr'), {**planes, **depth, **normals})
        scratch.render('in.exr', '-o', 'ao.exr', *BASE)
        ao = read_ao(scratch.path('ao.exr'))
        check_close(ao, read_ao(scratch.path('wanted.exr')), 0.07, 2e-4, 'AO')
        check((ao[scene.sky] == 1).all(), 'the background is not 1')


@case
def positions_that_all_repeat_are_no_background(scratch):
    # Enlarged without interpolation: each position is that of 16 texels.
    scene = Scene(64, 36)
    blocks = {n: p[1::4, 1::4].repeat(4, 0).repeat(4, 1) for n, p in positions(scene).items()}
    write_camera(scratch.path('c.json'))
    write_exr(scratch.path('in.exr'), blocks)
    share = inspect(scratch, '--camera', 'c.json')['conventions']['background_share']
    check(np.isclose(share, scene.sky[1::4, 1::4].mean()), f'{share} is background')


@case
def positions_give_the_camera_of_another_depth(scratch):
    scene = Scene(160, 90, 73)
    write_exr(scratch.path('in.exr'), {'Z': scene.depth(), **positions(scene)})
    camera = inspect(scratch)['camera']
    equal((camera['source'], camera['rotation']), ('positions', 'positions'), 'the camera')
    check(abs(camera['fov_x_deg'] - 73) < 1e-3, f'{camera["fov_x_deg"]} degrees, want 73')


@cases([('Z', 'planar'), ('Z', 'radial'), ('Z', 'inverse'), ('dd.T', 'radial-near')],
       name=lambda row: row[1])
def positions_tell_what_depth_is(scratch, channel, kind):
    scene = Scene()
    write_exr(scratch.path('in.exr'), {channel: scene.depth(kind), **positions(scene)})
    view = inspect(scratch)
    equal((view['camera']['source'], view['conventions']['depth_type']), ('positions', kind),
          'camera and depth type')
    if kind == 'radial-near':
        check(abs(view['camera']['near'] / NEAR - 1) < 1e-3, f'near {view["camera"]["near"]}')


@cases([('metres', 1), ('centimetres', 100), ('feet', 3.28)])
def another_unit_than_that_of_positions_is_said(scratch, _, times):
    scene = Scene()
    for kind in ('planar', 'radial'):
        write_exr(scratch.path('in.exr'), {'Z': scene.depth(kind) * np.float32(times),
                                           **positions(scene)})
        said = str(inspect(scratch)['warnings'])
        if times == 1:
            check('times what' not in said, said)
        else:
            matches(f"depth 'Z' is {times} times what the positions 'P' say: another unit.*"
                    "--depth 'P'", said, kind)


@case
def positions_of_a_parallel_camera(scratch):
    scene = Scene(160, 90, 2 * np.degrees(np.arctan(2.0)))
    write_exr(scratch.path('in.exr'), {**positions(scene, parallel=1.5)})
    camera = inspect(scratch)['camera']
    equal(camera['type'], 'orthographic', 'type')
    check(abs(camera['ortho_width'] - 6) < 1e-3, f'width {camera["ortho_width"]}, want 6')


@cases([('OpenGL', -1), ('pbrt and RenderMan', 1)])
def positions_of_a_parallel_camera_lie_ahead(scratch, _, z):
    # Nearer things are nearer, whichever way camera space looks.
    scene = Scene(160, 90, 2 * np.degrees(np.arctan(2.0)))
    write_exr(scratch.path('in.exr'), positions(scene, 'camera', z, parallel=1.5))
    scratch.render('in.exr', '-o', 'ao.exr', '-r', '.5', '--pixel-type', 'float')
    ao = read_ao(scratch.path('ao.exr'))
    write_exr(scratch.path('in.exr'), {'Z': scene.depth()})
    scratch.render('in.exr', '-o', 'z.exr', '-r', '.5', '--pixel-type', 'float', '--ortho', '6',
                   '--depth-type', 'planar')
    error = np.sqrt(np.mean((ao - read_ao(scratch.path('z.exr'))) ** 2))
    check(error < 0.012, f'RMSE {error:.4f} to the AO of depth')


@case
def positions_contradict_the_header(scratch):
    write_exr(scratch.path('in.exr'), positions(Scene(160, 90, 60)),
              attributes=[('cameraFov', 50.0)])
    view = inspect(scratch)
    equal(view['camera']['source'], 'positions', 'source')
    matches('0.4663 by cameraFov and 0.5774 by the positions: that of the positions',
            str(view['warnings']), 'words')
    equal(inspect(scratch, '--fov', 50)['camera']['source'], '--fov', 'source with --fov')


@cases([('none', None, True), ('the same', NEAR, True), ('another', 2 * NEAR, False)])
def depth_beside_positions_may_begin_at_a_near_plane(scratch, _, told, is_known):
    scene = Scene()
    write_exr(scratch.path('in.exr'), {'Z': scene.depth('radial-near'), **positions(scene)})
    options = ()
    if told:
        options = '--camera', write_camera(scratch.path('c.json'), camera(near=told))
    view = inspect(scratch, *options)
    said = str(view['warnings'])
    equal('is not that of the positions' in said, not is_known, f'what is in {said}')
    if is_known:
        equal(view['conventions']['depth_type'], 'radial-near', 'type of depth')


@case
def positions_in_half_floats_tell_the_pixels_width(scratch):
    """Far off, their steps turn the depth's own normals; the camera is exact all the same."""
    planes = read_parts(corpus('m3_city_a.exr'))[0].channels
    with open(corpus('m3_city_a.camera.json'), encoding='utf-8') as file:
        camera = json.load(file)
    height, width = planes['dd.y.T'].shape
    rows, columns = np.mgrid[:height, :width]
    half = np.tan(np.radians(camera['fov_x_deg'] / 2))
    ray = half * np.stack([(columns + 0.5) / width * 2 - 1,
                           (height / 2 - rows - 0.5) * 2 / width], -1)
    length = np.sqrt(1 + (ray ** 2).sum(-1))
    z = np.where(planes['dd.y.T'] > 0, planes['dd.y.T'] / length + camera['near'], 0)
    place = np.stack([ray[..., 0] * z, ray[..., 1] * z, z], -1)[1::3, 1::3]
    turn = np.diag([1, 1, -1]) @ np.array(camera['world_to_view'])[:3, :3]
    normal = np.stack([planes[f'nn.{c}'] for c in 'XYZ'], -1)[1::3, 1::3] @ turn.T
    write_exr(scratch.path('in.exr'), {
        f'{layer}.{c}': vector[..., i].astype(np.float16)
        for layer, vector in (('P', place), ('Ns', normal)) for i, c in enumerate('XYZ')})
    said = str(inspect(scratch)['warnings'])
    check('times as wide' not in said, said)


def bent(scene, by):
    """Positions and normals of a scene seen through a lens: what stood elsewhere."""
    height, width = scene.z.shape
    j, i = np.mgrid[0:height, 0:width]
    x, y = (i + 0.5) / width * 2 - 1, (0.5 - (j + 0.5) / height) * 2 * height / width
    less = 1 + by * (x * x + y * y)
    at = (np.clip(np.round((0.5 - y * less * width / height / 2) * height - 0.5), 0,
                  height - 1).astype(int),
          np.clip(np.round((x * less + 1) / 2 * width - 0.5), 0, width - 1).astype(int))
    planes = {**positions(scene), **scene_normals(scene, 'world', -1)}
    return {n: p[at] for n, p in planes.items()}, scene.depth()[at]


@cases([('a barrel', -0.08), ('a cushion', 0.08)])
def positions_through_a_lens_need_the_camera(scratch, _, by):
    planes, depth = bent(Scene(320, 180), by)
    write_exr(scratch.path('in.exr'), planes)
    scratch.fails(CHANNELS, "positions 'P' do not give it: they fit no camera", 'in.exr', '-o',
                  'ao.exr', hint='--camera FILE.json with .world_to_view')
    write_camera(scratch.path('c.json'))
    said = scratch.render('in.exr', '-o', 'ao.exr', *BASE, '--camera', 'c.json').stderr
    matches("positions 'P' are seen by no camera without a lens that distorts.*(camera file)", said,
            'stderr')
    del planes['P.X'], planes['P.Y'], planes['P.Z']
    write_exr(scratch.path('in.exr'), {'Z': depth, **planes})
    scratch.render('in.exr', '-o', 'wanted.exr', *BASE, '--camera', 'c.json', '--depth-type',
                   'planar', '--normal-space', 'world')
    check_close(read_ao(scratch.path('ao.exr')), read_ao(scratch.path('wanted.exr')), 0.25, 2e-3,
                'AO')
    turned = camera()
    turned['world_to_view'][0], turned['world_to_view'][2] = (
        turned['world_to_view'][2], [-v for v in turned['world_to_view'][0]])
    write_camera(scratch.path('c.json'), turned)
    write_exr(scratch.path('in.exr'), bent(Scene(320, 180), by)[0])
    scratch.fails(CHANNELS, r'the camera that is known \(camera file\) sees them .* pixels from',
                  'in.exr', '-o', 'x.exr', '--camera', 'c.json', hint='--depth NAME')


def around(eye):
    """Half of them before and half of them behind it."""
    p = np.empty((90, 160, 3), np.float32)
    p[:, :80], p[:, 80:] = eye + [1, 2, 3], eye - [1, 2, 3]
    return p


@cases([('one point', np.full((90, 160, 3), 3, np.float32), 'they are background'),
        ('no numbers', np.full((90, 160, 3), np.nan, np.float32), 'they are background'),
        ('around the eye', around(-MOVE @ TURN), 'they lie in a plane')])
def positions_that_the_camera_does_not_see_are_said(scratch, _, p, why):
    write_exr(scratch.path('in.exr'), {f'P.{c}': p[..., i] for i, c in enumerate('XYZ')})
    write_camera(scratch.path('c.json'))
    scratch.fails(CHANNELS, rf'{why}, and the camera that is known \(camera file\) does not see '
                  'them$', 'in.exr', '-o', 'x.exr', '--camera', 'c.json', hint='--depth NAME')


@case
def positions_of_a_plane_need_a_camera(scratch):
    scene = Scene()
    floor = scene.normal[..., 1] > 0.999
    scene.sky = ~floor
    scene.z = np.where(floor, scene.z, np.inf)
    write_exr(scratch.path('in.exr'), positions(scene))
    scratch.fails(CHANNELS, "no depth, and positions 'P' do not give it: they lie in a plane",
                  'in.exr', '-o', 'ao.exr', hint='--camera FILE.json with .world_to_view')
    write_camera(scratch.path('c.json'))
    scratch.render('in.exr', '-o', 'ao.exr', *BASE, '--camera', 'c.json')
    write_exr(scratch.path('in.exr'), {'Z': scene.depth()})
    scratch.render('in.exr', '-o', 'wanted.exr', *BASE, '--camera', 'c.json')
    check_close(read_ao(scratch.path('ao.exr')), read_ao(scratch.path('wanted.exr')), 0.25, 2e-3,
                'AO')


if __name__ == '__main__':
    main()
