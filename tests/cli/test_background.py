#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Where nothing is: background of any value, in any unit, over any share of the image, is found and
is open, and what only looks like it is none."""
import numpy as np

from cli import CHANNELS, case, cases, check, equal, main, matches, read_ao, write_exr
from evidence import OPTIONS, check_same, clean, depth_of, hidden, inspect, run
from scene import FOV, TURN, Scene

BACKGROUNDS = [('1000', 1000), ('100', 100), ('1e6', 1e6), ('1e20', 1e20), ('inf', np.inf),
               ('0', 0), ('-1', -1), ('nan', np.nan), ('10000007168', 10000007168.0),
               ('65504', 65504)]


@cases(BACKGROUNDS)
def background_is_found_whatever_it_is(scratch, _, value):
    for share, normals in ((0.72, True), (0.3, False)):
        scene = hidden(share)
        wanted, said = clean(scratch, scene, normals=normals)
        channels = {'Z': depth_of(scene, value), **(scene.normals() if normals else {})}
        ao, told = run(scratch, channels, '--fov', FOV, '--normal-space', 'camera')
        radius = [line.split('radius=')[1].split()[0] for line in (said + told).splitlines()
                  if 'radius=' in line]
        equal(radius[0], radius[1], 'automatic radius')
        check_same(ao, wanted, f'{value} over {share} of the image')
        check((ao[scene.sky] == 1).all(), 'the sky is not 1')


@cases([('cm', 100.0), ('mm', 1000.0), ('km', 0.001)])
def background_does_not_depend_on_the_unit(scratch, _, unit):
    scene = hidden(0.5, fov=90)
    wanted, _ = clean(scratch, scene, fov=90, unit=unit)
    channels = {'Z': depth_of(scene, 1000 * unit, unit), **scene.normals()}
    check_same(run(scratch, channels, '--fov', 90)[0], wanted, f'unit {unit}')


@cases(BACKGROUNDS)
def much_background_does_not_hide_the_camera(scratch, _, value):
    # Pyramids without perspective: seen from behind they are hollows.
    y, x = np.mgrid[:180, :320] / 20
    u, v = (x + 0.3 * y) % 2 - 1, (y - 0.2 * x) % 1.6 - 0.8
    is_u, sky = np.abs(u) > np.abs(v), x > 5
    across, down = np.where(is_u, np.sign(u), -0.2 * np.sign(v)) * 0.6, \
        np.where(is_u, 0.3 * np.sign(u), np.sign(v)) * 0.6
    normal = np.stack([across, -down, np.ones_like(x)], axis=-1)
    normal = np.where(sky[..., None], 0, normal / np.linalg.norm(normal, axis=-1, keepdims=True))
    normal = normal @ TURN
    depth = np.where(sky, value, 8 + 0.6 * np.maximum(np.abs(u), np.abs(v)))
    normals = {f'N.{c}': normal[..., i].astype(np.float32) for i, c in enumerate('XYZ')}
    write_exr(scratch.path('in.exr'), {'Z': depth.astype(np.float32), **normals})
    view = inspect(scratch)
    matches('by depth and normals it is orthographic, width 16', str(view['warnings']), 'warnings')
    check('do not agree' not in str(view['warnings']), str(view['warnings']))
    check(view['conventions']['normal_agreement'] > 0.95, str(view['conventions']))


@case
def saturated_halves_are_background(scratch):
    scene = hidden(0.7)
    wanted, _ = clean(scratch, scene, unit=100, normals=False)
    depth = depth_of(scene, 1e10, 100)
    with np.errstate(over='ignore'):
        ao, said = run(scratch, {'WorldDepth.R': np.minimum(depth, 65504).astype(np.float16)},
                       '--fov', FOV)
    check((ao[scene.sky] == 1).all(), 'the sky is not 1')
    matches(r'radius=\d+ \(auto\)', said, 'the summary')
    check(abs(ao.mean() - wanted.mean()) < 0.02, f'mean {ao.mean()}, want {wanted.mean()}')


@case
def transparent_texels_are_background(scratch):
    scene = hidden(0.4)
    alpha = np.where(scene.sky, 0, 1).astype(np.float32)
    color = {c: alpha for c in 'RGBA'}
    wanted, _ = clean(scratch, scene, normals=False)
    noise = np.random.default_rng(3).uniform(1, 9, alpha.shape)
    for name, value in (('always the same', 5.0), ('noise', noise)):
        ao, _ = run(scratch, {'Z': depth_of(scene, value), **color}, '--fov', FOV)
        check_same(ao, wanted, f'{name} where alpha is 0')
    # In a part of its own, alpha is found as well.
    write_exr(scratch.path('in.exr'), (color, {'name': 'rgba'}),
              ({'Z': depth_of(scene, 5.0)}, {'name': 'depth'}))
    scratch.render('in.exr', '-o', 'ao.exr', *OPTIONS, '--fov', FOV)
    check_same(read_ao(scratch.path('ao.exr')), wanted, 'alpha in another part')


@case
def surfaces_without_alpha_are_surfaces(scratch):
    scene = Scene()
    wanted, _ = clean(scratch, scene, normals=False)
    floor = scene.normal[..., 1] > 0.99
    color = {c: np.where(floor | scene.sky, 0, 1).astype(np.float32) for c in 'RGBA'}
    ao, _ = run(scratch, {'Z': depth_of(scene, 1e10), **color}, '--fov', FOV)
    check_same(ao, wanted, 'a shadow catcher')
    # Sky that depth tells by itself is no reason to take what stands before it for sky.
    scene = hidden(0.6)
    wanted, _ = clean(scratch, scene, normals=False)
    floor = scene.normal[..., 1] > 0.99
    color = {c: np.where(floor | scene.sky, 0, 1).astype(np.float32) for c in 'RGBA'}
    ao, _ = run(scratch, {'Z': depth_of(scene, 1000), **color}, '--fov', FOV)
    check_same(ao, wanted, 'a shadow catcher before much sky')


@case
def sky_behind_things_that_are_near_is_no_slope(scratch):
    # Bumps end in a jump to ten times their depth, as round things do: no floor goes on so.
    x, y = np.meshgrid(np.arange(160) % 20 - 9.5, np.arange(90) % 18 - 8.5)
    bumps = 2.0 + 0.01 * (x ** 2 + y ** 2)
    sky = bumps > 2.6
    depth = np.where(sky, 24.0, bumps).astype(np.float32)
    normals = {'N.X': 0 * depth, 'N.Y': 0 * depth, 'N.Z': 0 * depth + 1}
    write_exr(scratch.path('in.exr'), {'Z': depth, **normals})
    matches('of the depth are at 24', str(inspect(scratch, '--fov', FOV)['warnings']), 'the sky')


@case
def wall_seen_straight_on_is_no_background(scratch):
    # The wall of the scene, always at 6, behind a floor; then all of the image but a ball.
    scene = Scene()
    behind = np.where(scene.sky, 6.0, scene.z).astype(np.float32)
    write_exr(scratch.path('in.exr'), {'Z': behind})
    equal(inspect(scratch, '--fov', FOV)['conventions']['background_share'], 0, 'with a floor')
    wall = np.full_like(behind, 30)
    wall[30:50, 60:90] = 3 + np.linspace(0, 0.5, 30)
    normals = {'N.X': 0 * wall, 'N.Y': 0 * wall, 'N.Z': 0 * wall + 1}
    write_exr(scratch.path('in.exr'), {'Z': wall, **normals})
    equal(inspect(scratch, '--fov', FOV)['conventions']['background_share'], 0, 'with normals')
    # Nothing but the gap tells now: it is said.
    write_exr(scratch.path('in.exr'), {'Z': wall})
    matches('taken for background .--background off', str(inspect(scratch)['warnings']), 'a gap')
    near = np.minimum(wall, 8)
    write_exr(scratch.path('in.exr'), {'Z': near})
    view = inspect(scratch)
    matches('taken for a wall .--background 8', str(view['warnings']), 'a small gap')
    equal(view['conventions']['background_share'], 0, 'with a small gap')
    for option, share in (('8', 0.9), ('7.99', 0.9), ('off', 0), ('auto', 0)):
        found = inspect(scratch, '--background', option)['conventions']['background_share']
        check(abs(found - share) < 0.1, f'--background {option}: {found}')


@cases([('floor', 3.6, True), ('half', 4.6, True), ('before the wall', 5.2, True),
        ('behind the wall', 7.5, False), ('far', 500, False), ('at the sky', 1000, False)])
def background_amid_surfaces_is_said(scratch, _, distance, is_said):
    scene = Scene(320, 180)
    for background in 1000, 1e10, np.inf:
        for normals in scene.normals(), {}:
            for kind, options in (('planar', ('--depth-type', 'planar')), ('planar', ()),
                                  ('radial', ('--depth-type', 'radial'))):
                depth = np.where(scene.sky, background, scene.depth(kind)).astype(np.float32)
                write_exr(scratch.path('in.exr'), {'Z': depth, **normals})
                said = str(inspect(scratch, '--fov', FOV, '--background', distance,
                                   *options)['warnings'])
                equal(f'--background {distance:g} lies amid surfaces, and ' in said, is_said,
                      f'{background}, {kind}, {len(normals)} normals: whether it is in {said}')
                check('--background' not in said or is_said, said)


@case
def horizon_may_be_cut_off(scratch):
    # Three rows of a level floor before a sky that has a distance, and then fourteen.
    scene = Scene(320, 180)
    is_floor = scene.y < 0
    depth = np.where(is_floor, -1 / scene.y, 1e5).astype(np.float32)
    normals = {f'N.{c}': (is_floor * n).astype(np.float32) for c, n in zip('XYZ', (0, 1, 0))}
    for shown in normals, {}:
        write_exr(scratch.path('in.exr'), {'Z': depth, **shown})
        for distance, is_said in (79, False), (20, True):
            said = str(inspect(scratch, '--fov', FOV, '--background', distance)['warnings'])
            equal('lies amid surfaces, and 16 % of what' in said, is_said,
                  f'{distance}: whether it is in {said}')
            equal('--background' in said, is_said, f'{distance}: whether it is in {said}')


@case
def background_before_all_things_is_said(scratch):
    scene = Scene()
    write_exr(scratch.path('in.exr'), {'Z': scene.depth(), **scene.normals()})
    scratch.fails(CHANNELS, "depth 'Z' is all background", 'in.exr', '-o', 'ao.exr', '--fov', FOV,
                  '--background', 0.04, hint='as far as --background 0.04 or farther')


@case
def background_is_behind_a_gap(scratch):
    # A backdrop with normals, right behind things of one plane each; a dome around all.
    scene = Scene(320, 180)
    to_eye = -np.stack([scene.x, scene.y, -np.ones_like(scene.x)], -1) / scene.stretch[..., None]
    for name, z, normal, distance in (('a backdrop', 9 + scene.x, (0.6, 0, 0.8), 7),
                                      ('a dome', 300 / scene.stretch, to_eye, 100)):
        scene.normal = np.where(scene.sky[..., None], normal, scene.normal)
        depth = np.where(scene.sky, z, scene.z).astype(np.float32)
        write_exr(scratch.path('in.exr'), {'Z': depth, **scene.normals()})
        view = inspect(scratch, '--fov', FOV, '--background', distance)
        share = view['conventions']['background_share']
        check(abs(share - scene.sky.mean()) < 0.01, f'{name}: {share} is background')
        check('--background' not in str(view['warnings']), f"{name}: {view['warnings']}")


@cases([('perspective', 50), ('to the horizon', 45), ('parallel', 20)])
def rows_of_a_level_floor_are_no_background(scratch, kind, first_row):
    # All along a row a floor is as far, and the last row is the farthest of all.
    row, column = np.mgrid[:90, :160]
    if kind == 'parallel':
        camera, slopes = ('--ortho', 5), (-1.6, 3.0)  # per scene unit, of a ramp and of the floor
        floor = 11 - slopes[1] * row / 32
        z = floor + slopes[0] * np.maximum(column - 140, 0) / 32
        normal = np.where(column > 140, slopes[0], 0), slopes[1] + 0 * row, 1 + 0 * row
    else:
        camera, texel = ('--fov', FOV), np.tan(np.radians(FOV / 2)) / 80
        with np.errstate(divide='ignore'):
            floor, wall = 1 / (row - 44.5) / texel, 2 / (column - 79.5) / texel
        is_wall = (wall > 0) & (wall < floor)
        normal = np.where(is_wall, -1, 0), np.where(is_wall, 0, 1), 0 * row
        z = np.where(is_wall, wall, floor)
    sky, length = row < first_row, np.sqrt(sum(n * n for n in normal))
    depth = np.where(sky, np.inf, z).astype(np.float32)
    normals = {f'N.{c}': np.where(sky, 0, n / length).astype(np.float32)
               for c, n in zip('XYZ', normal)}
    write_exr(scratch.path('in.exr'), {'Z': depth, **normals})
    view = inspect(scratch, *camera)
    equal(round(view['conventions']['background_share'], 4), round(sky.mean(), 4), 'background')


@case
def far_plane_of_the_camera_is_background(scratch):
    scene = hidden(0.6)
    write_exr(scratch.path('in.exr'), {'Z': depth_of(scene, 12.0)},
              attributes=[('far', 12.0), ('near', 0.1)])
    found = inspect(scratch, '--fov', FOV)['conventions']
    check(abs(found['background_share'] - scene.sky.mean()) < 0.001, str(found))
    equal(found['background']['why'], 'far plane', 'why')


if __name__ == '__main__':
    main()
