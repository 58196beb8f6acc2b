#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""What depth and normals of a file mean is decided by what they show: files of one scene as
programs write them, in any unit and with any background, give its AO, or are refused or warned of
with the option that helps."""
import json

import numpy as np

from cli import (CHANNELS, OK, case, cases, check, compute_ao, equal, main, matches, oiio, read_ao,
                 write_exr)
from scene import FAR, FOV, MOVE, NEAR, TURN, Scene, write_camera

ENOUGH = 0.012  # root mean square difference of AO that is nobody's business
OPTIONS = ('--pixel-type', 'float', '--overwrite', 'always')


def hidden(share, fov=FOV, **more):
    """The scene with sky to the right, so that it takes this share of the image."""
    scene = Scene(fov=fov, **more)
    for column in reversed(range(scene.z.shape[1])):
        if scene.sky.mean() >= share:
            break
        scene.z[:, column] = np.inf
        scene.normal[:, column] = 0
        scene.sky[:, column] = True
    return scene


def depth_of(scene, background, unit=1.0):
    return np.where(scene.sky, background, scene.z * unit).astype(np.float32)


def run(scratch, channels, *options, **layout):
    return compute_ao(scratch, channels, *OPTIONS, *options, **layout)


def clean(scratch, scene, *options, fov=FOV, unit=1.0, normals=True):
    """AO of the same G-buffer with nothing left to guess."""
    channels = {'Z': depth_of(scene, 1e10, unit), **(scene.normals() if normals else {})}
    return run(scratch, channels, '--depth-type', 'planar', '--normal-space', 'camera', '--fov',
               fov, *options)


def check_same(ao, wanted, what):
    error = np.sqrt(np.mean((ao.astype(np.float64) - wanted) ** 2))
    check(error <= ENOUGH, f'{what}: RMSE {error:.4f}')


def inspect(scratch, *options, code=OK):
    result = scratch.run('inspect', 'in.exr', '--json', *options)
    equal(result.code, code, f'exit code of {result}')
    return json.loads(result.stdout)['views'][0]


# --- Background ---

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


# --- Kinds of depth ---

@cases([('metres', 1.0, {}), ('kilometres', 0.001, {}), ('centimetres', 100.0, {}),
        ('wide', 1.0, {'fov': 100})])
def inverse_depth_of_nuke_is_taken_as_such(scratch, _, unit, more):
    scene, fov = Scene(**more), more.get('fov', FOV)
    options = ('--radius', 0.5 * unit)
    wanted, _ = clean(scratch, scene, *options, fov=fov, unit=unit, normals=False)
    depth = {'depth.Z': (scene.depth('inverse') / unit).astype(np.float32)}
    ao, said = run(scratch, depth, '--fov', fov, *options,
                   attributes=[('nuke/version', '15.1v2')])
    check_same(ao, wanted, 'depth.Z of Nuke')
    matches("warning: .*depth 'depth.Z' is taken as 1/z, as Nuke writes it", said, 'stderr')


@case
def depth_that_passed_through_nuke_stays_what_it_is(scratch):
    scene = Scene()
    wanted, _ = clean(scratch, scene, normals=False)
    ao, said = run(scratch, {'depth.Z': scene.depth()}, '--fov', FOV,
                   attributes=[('nuke/version', '15.1v2')])
    check_same(ao, wanted, 'planar depth.Z')
    matches('taken as distances, not as 1/z', said, 'stderr')


@cases(['radial', 'inverse'])
def flat_things_tell_the_kind_of_depth(scratch, kind):
    for fov in (FOV, 95):
        scene = Scene(fov=fov)
        # A tenth of a unit is 1 here, so that 1/z is not within 0..1.
        wanted, _ = clean(scratch, scene, fov=fov, unit=0.1, normals=False)
        depth = scene.depth(kind) * (10 if kind == 'inverse' else 0.1)
        ao, _ = run(scratch, {'Z': depth.astype(np.float32)}, '--fov', fov)
        check_same(ao, wanted, f'{kind} at {fov} degrees')
        found = inspect(scratch, '--fov', fov)['conventions']
        equal((found['depth_type'], found['depth_source']), (kind, 'flat things are flat so'),
              'kind')


@case
def what_nothing_tells_is_said(scratch):
    # A ball alone has nothing flat; with normals that agree there is no doubt.
    scene = Scene(fov=20)
    ball = np.abs(scene.normal[..., 2]) < 0.999
    ball &= scene.normal[..., 1] < 0.999
    depth = np.where(ball & ~scene.sky, scene.z, 1e10).astype(np.float32)
    write_exr(scratch.path('in.exr'), {'Z': depth})
    matches('nothing shows what it measures', str(inspect(scratch, '--fov', 20)['warnings']), 'one')
    write_exr(scratch.path('in.exr'), {'Z': depth, **scene.normals()})
    said = str(inspect(scratch, '--fov', 20)['warnings'])
    check('nothing shows' not in said, said)


@cases([('-1e30', -1e30), ('-inf', -np.inf), ('1e10', 1e10), ('0', 0)])
def negative_z_is_turned(scratch, _, background):
    scene = Scene()
    wanted, _ = clean(scratch, scene)
    depth = np.where(scene.sky, background, -scene.z).astype(np.float32)
    ao, said = run(scratch, {'Z': depth, **scene.normals()}, '--fov', FOV, '--normal-space',
                   'camera')
    check_same(ao, wanted, 'negative z')
    matches('its sign is turned', said, 'stderr')
    check((ao[scene.sky] == 1).all(), 'the sky is not 1')


RANGES = [('black near', 1.5, 9.0, ''), ('white near', 1.5, 9.0, ',inverted'),
          ('from the eye', 0.0, 40.0, ''), ('in cm', 150.0, 900.0, ',inverted')]


@cases(RANGES)
def normalised_depth_needs_its_range(scratch, _, near, far, inverted):
    scene, unit = Scene(), 100.0 if near > 100 else 1.0
    options = ('--radius', 0.5 * unit)
    wanted, _ = clean(scratch, scene, *options, unit=unit, normals=False)
    depth = np.where(scene.sky, 1, (scene.z * unit - near) / (far - near))
    depth = (1 - depth if inverted else depth).astype(np.float32)
    write_exr(scratch.path('in.exr'), {'ZDepth.R': depth})
    scratch.fails(CHANNELS, "in.exr: depth 'ZDepth.R' is from .* normalised.* not in scene units",
                  'in.exr', '-o', 'x.exr', '--fov', FOV, hint='--depth-range NEAR,FAR')
    scratch.fails(CHANNELS, 'normalised depth .* needs its range', 'in.exr', '-o', 'x.exr',
                  '--depth-type', 'normalized', hint='--depth-range NEAR,FAR')
    ao, _ = run(scratch, {'ZDepth.R': depth}, '--fov', FOV, '--depth-type', 'normalized',
                '--depth-range', f'{near},{far}{inverted}', *options)
    check_same(ao, wanted, 'normalised')
    # The record holds the range.
    scratch.render('in.exr', '-o', 'again.exr', '--like', 'ao.exr')
    check((read_ao(scratch.path('again.exr')) == ao).all(), '--like gives other AO')


@case
def normalised_depth_may_be_radial(scratch):
    scene, far = Scene(fov=95), 20.0
    wanted, _ = clean(scratch, scene, fov=95, normals=False)
    depth = np.where(scene.sky, 1, scene.z * scene.stretch / far).astype(np.float32)
    options = ('--fov', 95, '--depth-type', 'normalized', '--depth-range', f'0,{far}')
    ao, said = run(scratch, {'Z': depth}, *options)
    check_same(ao, wanted, 'normalised distances from the eye')
    matches('taken for distances from the eye', said, 'stderr')
    planar = np.where(scene.sky, 1, scene.z / far).astype(np.float32)
    check('from the eye' not in run(scratch, {'Z': planar}, *options)[1], 'planar is called radial')


@cases([('a third', 1 / 3, True), ('nothing', 0, False)])
def depth_from_a_near_plane_is_said(scratch, _, share, is_said):
    scene = Scene()
    depth = depth_of(scene, 1e10) - np.float32(share * scene.z.min())
    write_exr(scratch.path('in.exr'), {'Z': depth, **scene.normals(space='world')})
    said = str(inspect(scratch)['warnings'])
    equal('looks measured from a near plane' in said, is_said, f'whether it is in {said}')


@case
def steps_of_a_wall_are_no_offset(scratch):
    # Every edge of a relief in two depths bends as much: not as planes do.
    rows, columns = np.mgrid[:90, :160]
    depth = np.where((rows % 24 < 12) & (columns % 30 < 15), 6.2, 7.0).astype(np.float32)
    write_exr(scratch.path('in.exr'), {'Z': depth}, attributes=[('cameraFov', 50.0)])
    said = str(inspect(scratch)['warnings'])
    check('only if' not in said, said)
    # Nor does a bend tell of depth that is more than the distance, or counted down in some units.
    plane = 2 / (1 + rows / 90 + columns / 300)
    for depth in (plane + 6, 9 - plane):
        write_exr(scratch.path('in.exr'), {'Z': depth.astype(np.float32)},
                  attributes=[('cameraFov', 50.0)])
        said = str(inspect(scratch)['warnings'])
        check('only if' not in said, said)


@case
def positions_come_before_parts_of_a_range(scratch):
    scene = Scene()
    wanted, _ = clean(scratch, scene)
    z = np.where(scene.sky, 0, scene.z)
    p = np.where(scene.sky[..., None], 0,
                 (np.stack([scene.x * z, scene.y * z, -z], axis=-1) - MOVE) @ TURN)
    channels = {'Z': depth_of(scene, 1, 1 / 20), **scene.normals(space='world'),
                **{f'P.{c}': p[..., i].astype(np.float32) for i, c in enumerate('XYZ')}}
    for attributes in ([], [('cameraFov', 'float', FOV), *rotation_header()]):
        ao, said = run(scratch, channels, attributes=attributes)
        check_same(ao, wanted, f'P beside normalised Z, {len(attributes)} attributes')
        matches("depth 'Z' is not that of the positions 'P'.*: depth is taken from them", said,
                'stderr')
    scratch.fails(CHANNELS, "depth 'Z' is from .* normalised", 'in.exr', '-o', 'x.exr', '--depth',
                  'Z', hint="or --depth 'P', which are positions")


@cases(['1', '1,', '5,1', '-1,5', '1,5,upside', '1,5,', 'a,b', '1,inf'])
def bad_ranges_are_refused(scratch, argument):
    write_exr(scratch.path('in.exr'), {'Z': Scene().depth()})
    scratch.fails(2, '--depth-range is .*, want NEAR,FAR', 'in.exr', '-o', 'x.exr',
                  '--depth-range', argument)


@cases([('device', ('--near', NEAR, '--far', FAR)), ('reversed', ('--near', FAR, '--far', NEAR))])
def device_depth_is_not_taken_for_distances(scratch, kind, planes):
    scene = Scene()
    wanted, _ = clean(scratch, scene, normals=False)
    write_exr(scratch.path('in.exr'), {'depth': scene.depth(kind)})
    scratch.fails(CHANNELS, "in.exr: depth 'depth' is from ", 'in.exr', '-o', 'x.exr', '--fov',
                  FOV, hint='--near')
    ao, _ = run(scratch, {'depth': scene.depth(kind)}, '--fov', FOV, '--depth-type', 'device',
                *planes)
    check_same(ao, wanted, kind)


@case
def small_scenes_are_scenes(scratch):
    # All of it within one unit, and nothing behind: flat things say that it is no normalised one.
    scene = Scene()
    wanted, _ = clean(scratch, scene, unit=0.01, normals=False)
    ao, _ = run(scratch, {'Z': depth_of(scene, 0, 0.01)}, '--fov', FOV)
    check_same(ao, wanted, 'a scene of 8 cm in metres')


@cases([('white sky', 1, True), ('black sky', 0, False)])
def normals_do_not_tell_the_unit_of_depth(scratch, _, background, is_clamped):
    # Parts of a far plane have the shape of distances: no field of view makes scene units of them.
    scene = Scene()
    channels = {'Z': depth_of(scene, background, 1 / 20), **scene.normals(space='world')}
    write_exr(scratch.path('in.exr'), channels)
    if is_clamped:
        scratch.fails(CHANNELS, "in.exr: depth 'Z' is from .* normalised", 'in.exr', '-o', 'x.exr',
                      hint='--depth-type normalized --depth-range')
    else:
        matches('taken for scene units .*--depth-type normalized',
                str(inspect(scratch)['warnings']), 'the warnings')
    wanted, _ = clean(scratch, scene)
    ao, _ = run(scratch, channels, '--depth-type', 'normalized', '--depth-range', '0,20', '--fov',
                FOV)
    check_same(ao, wanted, 'with its range')


@case
def normals_do_not_tell_reversed_depth_from_inverse(scratch):
    scene = Scene()
    write_exr(scratch.path('in.exr'), {'Z': scene.depth('reversed', far=1e9), **scene.normals()})
    matches('a reversed depth buffer differs in scale alone .*--depth-type device',
            str(inspect(scratch)['warnings']), 'the warnings')


@cases([('0', 0), ('1', 1), ('inf', np.inf), ('nan', np.nan), ('5', 5.0), ('1e10', 1e10)])
def depth_without_shape_is_an_error(scratch, _, value):
    write_exr(scratch.path('in.exr'), {'Z': np.full((20, 30), value, np.float32)})
    scratch.fails(CHANNELS, "in.exr: depth 'Z' is .*no picture of anything", 'in.exr', '-o',
                  'x.exr', hint='--depth NAME')
    said = scratch.render('in.exr', '-o', 'x.exr', '--depth-type', 'planar').stderr
    matches("warning: in.exr: depth 'Z' is .*AO is 1 everywhere", said, 'stderr')


@cases([('whole numbers', 1 / 16, True), ('floats', 0, False)])
def depth_in_steps_is_said(scratch, _, step, is_said):
    scene = Scene()
    # A floor seen level has rows of one depth each, whose differences no ball hides then.
    ball = (np.abs(scene.normal[..., 2]) < 0.999) & (scene.normal[..., 1] < 0.999)
    scene.z = np.where(ball & ~scene.sky & (step == 0), 6.0, scene.z)
    depth = depth_of(scene, 1e10)
    if step:
        depth = np.where(scene.sky, depth, np.round(depth / step) * step).astype(np.float32)
    write_exr(scratch.path('in.exr'), {'Z': depth, **scene.normals()})
    said = str(inspect(scratch, '--fov', FOV)['warnings'])
    equal('in steps; at the median' in said, is_said, f'whether it is in {said}')


@case
def filtered_depth_is_said(scratch):
    scene = Scene(640, 360)
    fine = depth_of(scene, 50)
    write_exr(scratch.path('in.exr'), {'Z': fine.reshape(90, 4, 160, 4).mean(axis=(1, 3))})
    matches(r'filtered over edges \(antialiased\)', str(inspect(scratch)['warnings']), 'warnings')
    write_exr(scratch.path('in.exr'), {'Z': fine[1::4, 1::4].copy()})
    check('filtered' not in str(inspect(scratch)['warnings']), 'sharp depth is called filtered')


def blurred(depth, weights, axes):
    """The mean of neighbours along the axes, with the weights of half a kernel from its middle."""
    for axis in axes:
        depth = sum(w * np.roll(depth, k, axis) for i, w in enumerate(weights)
                    for k in {i, -i}) / (weights[0] + 2 * sum(weights[1:]))
    return depth.astype(np.float32)


BLURS = [('of a lens', [1.0, 0.7, 0.25, 0.04], (0, 1)), ('wide', np.exp(-np.arange(9) ** 2 / 18.0),
         (0, 1)), ('of motion', [1.0, 0.8, 0.4, 0.1], (1,))]


@cases(BLURS)
def blurred_depth_is_said(scratch, _, weights, axes):
    scene = Scene(240, 135)
    for normals in ({}, scene.normals()):
        write_exr(scratch.path('in.exr'), {'Z': blurred(depth_of(scene, 20), weights, axes),
                                           **normals})
        matches('depth is filtered over edges .* or blurred', str(inspect(scratch)['warnings']),
                'warnings')


def enlarged(plane, times):
    small = plane[::times, ::times]
    return small.repeat(times, 0).repeat(times, 1)[:plane.shape[0], :plane.shape[1]].copy()


@cases([('twice', 2), ('three times', 3), ('not', 1)])
def enlarged_depth_is_said(scratch, _, times):
    scene = Scene()
    planes = {'Z': depth_of(scene, 1e10), **scene.normals()}
    for channels in ({n: enlarged(p, times) for n, p in planes.items()},
                     {'Z': enlarged(planes['Z'], times)}):
        write_exr(scratch.path('in.exr'), channels)
        said = str(inspect(scratch, '--fov', FOV)['warnings'])
        equal(f'enlarged {times} times' in said, times > 1, f'whether it is in {said}')
        check('noisy' not in said, said)


@cases([('much', 1e-3, True), ('less than AO shows', 3e-5, False), ('none', 0, False)])
def noisy_depth_is_said(scratch, _, amount, is_said):
    scene = Scene()
    noise = 1 + amount * np.random.default_rng(4).normal(size=scene.z.shape)
    for options in (('--fov', FOV), ()):
        write_exr(scratch.path('in.exr'), {'Z': (depth_of(scene, 1e10) * noise).astype(np.float32),
                                           **scene.normals('N', 'world')})
        said = str(inspect(scratch, *options)['warnings'])
        equal('depth is noisy' in said, is_said, f'whether it is in {said}')


@case
def depth_in_steps_is_no_inverse(scratch):
    # Steps are equal where they are all that is seen of a slope, as those of 1/z are.
    scene = Scene()
    depth = np.where(scene.sky, 20, np.round(scene.z / 20 * 255) / 255 * 20).astype(np.float32)
    write_exr(scratch.path('in.exr'), {'Z': depth})
    view = inspect(scratch, '--fov', FOV)
    equal(view['conventions']['depth_type'], 'planar', 'type')
    matches('in steps; at the median', str(view['warnings']), 'warnings')
    write_exr(scratch.path('in.exr'), {'Z': depth / 20})
    scratch.fails(CHANNELS, "in.exr: depth 'Z' is from .*: normalised", 'in.exr', '-o', 'x.exr',
                  '--fov', FOV, hint='--depth-range NEAR,FAR')


@case
def narrow_faces_are_no_filter(scratch):
    # Posts of one texel before a wall, with another in half the gap: things, and not a mean of two.
    depth, along = np.full((90, 160), 9.0, np.float32), np.arange(160) % 8
    depth[:, along < 3], depth[:, along == 3] = 4.0, 6.5
    x = np.where(along == 3, 1.0, 0.0).astype(np.float32) * np.ones((90, 1), np.float32)
    write_exr(scratch.path('in.exr'), {'Z': depth, 'N.X': x, 'N.Y': 0 * x, 'N.Z': 1 - x})
    check('filtered' not in str(inspect(scratch, '--fov', FOV)['warnings']), 'a third is a mean')


@cases([('b44', 'Z', np.float16, True), ('b44a', 'Z', np.float16, True),
        ('dwaa', 'Depth.R', np.float16, True), ('dwaa', 'Z', np.float16, False),
        ('b44a', 'Z', np.float32, False), ('piz', 'Z', np.float16, False)],
       name=lambda row: f'{row[0]} {row[1]} {row[2].__name__}')
def lossy_compression_is_named(scratch, compression, name, kind, is_lossy):
    depth = np.minimum(Scene().depth(), 60000).astype(kind)
    # OpenImageIO compresses single channels with zip instead.
    channels = {name: depth, **{c: depth for c in 'RGB'}}
    write_exr(scratch.path('in.exr'), channels, compression=compression)
    said = str(inspect(scratch)['warnings'])
    equal(f'compressed with {compression}, which is lossy' in said, is_lossy, 'warned')


UINTS = [('32 bits', 2 ** 32 - 1, 'uint32'), ('24 bits', 2 ** 24 - 1, 'uint32')]


@cases(UINTS)
def whole_numbers_of_a_range_are_refused(scratch, _, most, kind):
    scene, near, far = Scene(), 1.5, 9.0
    options = ('--fov', FOV, '--radius', 0.5)
    wanted, _ = clean(scratch, scene, *options, normals=False)
    depth = np.where(scene.sky, 1, (scene.z - near) / (far - near)) * most
    write_exr(scratch.path('in.exr'), {'Z': depth.astype(kind)})
    scratch.fails(CHANNELS, "in.exr: depth 'Z' is whole numbers up to .*: parts of a range",
                  'in.exr', '-o', 'x.exr', '--fov', FOV, hint='--depth-type normalized')
    ao, _ = run(scratch, {'Z': depth.astype(kind)}, '--depth-type', 'normalized', '--depth-range',
                f'{near},{far}', *options)
    check_same(ao, wanted, 'with its range')
    device = (scene.depth('device').astype(np.float64) * most).astype(kind)
    ao, _ = run(scratch, {'Z': device}, '--depth-type', 'device', '--near', NEAR, '--far', FAR,
                *options)
    check_same(ao, wanted, 'a depth buffer')


@case
def whole_millimetres_are_distances(scratch):
    scene = Scene()
    wanted, _ = clean(scratch, scene, unit=1000, normals=False)
    depth = np.where(scene.sky, 0, np.round(scene.z * 1000)).astype('uint32')
    ao, said = run(scratch, {'Z': depth}, '--fov', FOV)
    check_same(ao, wanted, 'millimetres')
    matches("depth 'Z' is whole numbers up to .*, taken for scene units", said, 'stderr')


# --- Pictures without a view plane ---

def all_directions(width, height, fisheye):
    """Distances to the floor and the walls of a room from a point in it, infinite outside."""
    x, y = np.meshgrid((np.arange(width) + 0.5) / width * 2 - 1,
                       1 - (np.arange(height) + 0.5) / height * 2)
    if fisheye:
        r = np.hypot(x, y)
        ray = np.stack([np.sin(r * np.pi / 2) * x / r, np.sin(r * np.pi / 2) * y / r,
                        -np.cos(r * np.pi / 2)], -1)
    else:
        lon, lat = x * np.pi, y * np.pi / 2
        ray = np.stack([np.sin(lon) * np.cos(lat), np.sin(lat), -np.cos(lon) * np.cos(lat)], -1)
    low, high = np.array([-2.0, -1.2, -3.0]), np.array([3.0, 1.4, 2.0])
    with np.errstate(divide='ignore'):
        z = np.min(np.where(ray > 0, high / ray, low / ray), axis=-1)
    return np.where(r <= 1, z, np.inf).astype(np.float32) if fisheye else z.astype(np.float32)


@cases([('latlong', (160, 80), False, 'looks like a panorama'),
        ('fisheye', (120, 120), True, 'looks like a fisheye')])
def pictures_of_all_directions_are_said(scratch, _, size, is_fisheye, message):
    write_exr(scratch.path('in.exr'), {'Z': all_directions(*size, is_fisheye)})
    for header in ([], [('cameraFov', 'float', 50.0)]):
        write_exr(scratch.path('in.exr'), {'Z': all_directions(*size, is_fisheye)},
                  attributes=header)
        matches(message, str(inspect(scratch)['warnings']), 'warnings')
    # Not of a perspective of this shape, even one that is the same on both sides.
    scene = Scene(*size, fov=90)
    x, z = scene.x, np.where(scene.sky, np.inf, scene.z)
    with np.errstate(divide='ignore'):
        corridor = np.minimum(np.minimum(1 / np.abs(scene.y), 1.5 / np.abs(x)), 9)
    wall = np.where(np.hypot(x, scene.y) < 0.3, 2 + x, 5)
    for depth in (z, corridor, wall):
        write_exr(scratch.path('in.exr'), {'Z': depth.astype(np.float32)})
        said = str(inspect(scratch)['warnings'])
        check('looks like a' not in said, said)


# --- Normals ---

def no_normals_at_all(scene):
    n = scene.normal
    middle = np.zeros_like(n) + np.array([0, 0, 1])
    octahedral = n / np.maximum(np.abs(n).sum(axis=-1, keepdims=True), 1e-9) * np.array([1, 1, 0])
    return [('empty', 0 * n, 'are zero or no numbers'), ('nan', n * np.nan, 'are zero or no numb'),
            ('octahedral', octahedral, 'have two components and a third that is 0'),
            ('without z', n * np.array([1, 1, 0]), 'have two components and a third that is 0'),
            ('of tangent space', middle, 'are the same everywhere, and the depth is of no plane')]


@cases([('empty',), ('nan',), ('octahedral',), ('without z',), ('of tangent space',)])
def what_is_no_normal_is_left_out(scratch, name):
    scene = Scene()
    wanted, _ = clean(scratch, scene, normals=False)
    values, message = {n: (v, m) for n, v, m in no_normals_at_all(scene)}[name]
    channels = {'Z': scene.depth(),
                **{f'N.{c}': values[..., i].astype(np.float32) for i, c in enumerate('XYZ')}}
    for attributes in ([], rotation_header()):
        ao, said = run(scratch, channels, '--fov', FOV, attributes=attributes)
        check_same(ao, wanted, f'{name}, header with {len(attributes)} matrices')
        matches(f"normals 'N' {message}", said, 'stderr')


@case
def a_wall_has_one_normal(scratch):
    scene = Scene()
    wall = {'Z': np.full_like(scene.x, 5) / (1 - 0.2 * scene.x), 'N.X': 0 * scene.x,
            'N.Y': 0 * scene.x, 'N.Z': 0 * scene.x}
    wall['N.X'] += -0.2 / np.hypot(0.2, 1)
    wall['N.Z'] += 1 / np.hypot(0.2, 1)
    write_exr(scratch.path('in.exr'), {n: v.astype(np.float32) for n, v in wall.items()})
    said = str(inspect(scratch, '--fov', FOV)['warnings'])
    check('everywhere' not in said, said)


@case
def normals_without_signs_are_said(scratch):
    scene = Scene()
    turned = scene.normals(space='world')
    for name, change in (('lost', np.abs), ('clamped', lambda n: np.maximum(n, 0))):
        write_exr(scratch.path('in.exr'), {'Z': scene.depth(),
                                           **{n: change(v) for n, v in turned.items()}})
        matches("normals 'N' have no negative component anywhere",
                str(inspect(scratch, '--fov', FOV)['warnings']), name)


@case
def normals_that_were_made_linear_are_refused(scratch):
    scene = Scene()
    colors = {n: ((v * 0.5 + 0.5) ** 2.2).astype(np.float32)
              for n, v in scene.normals('normal', letters='RGB').items()}
    write_exr(scratch.path('in.exr'), {'Z': scene.depth(), **colors})
    scratch.fails(CHANNELS, "normals 'normal' look like a picture .* made linear", 'in.exr', '-o',
                  'x.exr', '--fov', FOV, hint='as data')
    scratch.render('in.exr', '-o', 'x.exr', '--fov', FOV, '--normal', 'none')


def rotation_header():
    """worldToCamera for row vectors, looking along +z."""
    to_camera = np.eye(4)
    to_camera[:3, :3] = np.diag([1, 1, -1]) @ TURN
    to_camera[:3, 3] = np.diag([1, 1, -1]) @ MOVE
    return [('worldToCamera', oiio.TypeDesc('matrix'),
             tuple(float(v) for v in to_camera.T.flatten()))]


@cases([('+x+y+z', (1, 1, 1)), ('+x+y-z', (1, 1, -1)), ('+x-y+z', (1, -1, 1)),
        ('-x+y+z', (-1, 1, 1)), ('-x-y-z', (-1, -1, -1))])
def camera_normals_are_known_by_agreement(scratch, _, flip):
    scene = Scene(fov=75)
    wanted, _ = clean(scratch, scene, fov=75)
    planes = scene.normals()
    normals = {n: (planes[n] * f).astype(np.float32) for n, f in zip(sorted(planes), flip)}
    for encoded in (False, True):
        if encoded:
            normals = {n: (v * 0.5 + 0.5).astype(np.float32) for n, v in normals.items()}
        for attributes in (rotation_header(), []):
            ao, said = run(scratch, {'Z': scene.depth(), **normals}, '--fov', 75,
                           attributes=attributes)
            check_same(ao, wanted, f'camera normals, header with {len(attributes)} matrices')
            if attributes:
                matches(r"normals 'N' are in camera space .* by agreement", said, 'stderr')


@case
def world_normals_are_known_by_agreement(scratch):
    scene = Scene()
    wanted, _ = clean(scratch, scene)
    for name in ('N', 'CameraNormal'):
        channels = {'Z': scene.depth(), **scene.normals(name, space='world')}
        ao, _ = run(scratch, channels, '--fov', FOV, attributes=rotation_header())
        check_same(ao, wanted, f'world normals called {name}')


@case
def normals_that_agree_with_nothing_are_left_out(scratch):
    scene = Scene()
    wanted, _ = clean(scratch, scene, normals=False)
    blocks = np.random.default_rng(2).normal(size=(9, 16, 3)).repeat(10, axis=0).repeat(10, axis=1)
    blocks /= np.linalg.norm(blocks, axis=-1, keepdims=True)
    odd = {f'N.{c}': blocks[..., i].astype(np.float32) for i, c in enumerate('XYZ')}
    ao, said = run(scratch, {'Z': scene.depth(), **odd}, '--fov', FOV,
                   attributes=rotation_header())
    check_same(ao, wanted, 'normals of another scene')
    matches('do not agree with the depth in any space: deriving', said, 'stderr')


@cases([('its own', 0, False), ('a little off', 15, True), ('of another camera', 40, True)])
def rotation_that_depth_contradicts_is_said(scratch, _, degrees, is_said):
    # Turned round the upright of the floor, whose normals stay; the ball and the wall disagree.
    scene = Scene()
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    n = scene.normal @ np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]) @ TURN
    normals = {f'N.{k}': n[..., i].astype(np.float32) for i, k in enumerate('XYZ')}
    write_exr(scratch.path('in.exr'), {'Z': scene.depth(), **normals},
              attributes=[('cameraFov', 'float', FOV), *rotation_header()])
    said = str(inspect(scratch)['warnings'])
    equal('hardly agree with the depth' in said, is_said, f'whether it is doubted in {said}')


@case
def axes_of_another_world_are_found(scratch):
    # z up where the header has y up: the rotation that the image shows is taken.
    scene = Scene()
    wanted, _ = clean(scratch, scene)
    n = scene.normals(space='world')
    turned = {'N.X': n['N.X'], 'N.Y': -n['N.Z'], 'N.Z': n['N.Y']}
    ao, said = run(scratch, {'Z': scene.depth(), **turned}, '--fov', FOV,
                   attributes=rotation_header())
    check_same(ao, wanted, 'with other axes')
    matches('by the rotation of worldToCamera: that of the image is taken', said, 'stderr')


@cases([('40', 40), ('8', 8)])
def background_with_normals_is_doubted(scratch, _, value):
    # Colours of normals are (.5, .5, 1) where there is nothing, which faces the camera.
    scene = hidden(0.6)
    normals = scene.normals()
    normals['N.Z'] = np.where(scene.sky, 1, normals['N.Z']).astype(np.float32)
    write_exr(scratch.path('in.exr'), {'Z': depth_of(scene, value), **normals})
    matches(f'taken for a wall .*--background {value}',
            str(inspect(scratch, '--fov', FOV)['warnings']), 'the warnings')


@cases([('noise', None), ('sideways', (1, 0, 0))])
def no_wall_has_such_normals(scratch, _, normal):
    # Behind all else by a little, always as far, and normals that no wall has.
    scene = hidden(0.6)
    planes = scene.normal.copy()
    noise = np.random.default_rng(4).normal(size=planes.shape)
    noise /= np.linalg.norm(noise, axis=-1, keepdims=True)
    planes[scene.sky] = noise[scene.sky] if normal is None else normal
    normals = {f'N.{c}': planes[..., i].astype(np.float32) for i, c in enumerate('XYZ')}
    wanted, _ = clean(scratch, scene)
    ao, _ = run(scratch, {'Z': depth_of(scene, 7), **normals}, '--fov', FOV)
    check_same(ao, wanted, 'a near background')
    check((ao[scene.sky] == 1).all(), 'the sky is not 1')


NORMAL_NAMES = [
    ('N.red', ('N.red', 'N.green', 'N.blue')), ('NX', ('NX', 'NY', 'NZ')),
    ('Nx', ('Nx', 'Ny', 'Nz')), ('Nsx', ('Nsx', 'Nsy', 'Nsz')),
    ('bumpNormals', ('bumpNormals.R', 'bumpNormals.G', 'bumpNormals.B')),
    ('NormalWS', ('NormalWS.X', 'NormalWS.Y', 'NormalWS.Z')),
    ('CameraNormal', ('FinalImageCameraNormal.R', 'FinalImageCameraNormal.G',
                      'FinalImageCameraNormal.B')),
    ('normal_x', ('normal_x', 'normal_y', 'normal_z')),
    ('shadingNormals', ('shadingNormals.x', 'shadingNormals.y', 'shadingNormals.z'))]


@cases(NORMAL_NAMES)
def normals_are_found_by_all_their_names(scratch, _, names):
    scene = Scene(48, 27)
    planes = dict(zip(names, scene.normals().values()))
    write_exr(scratch.path('in.exr'), {'Z': scene.depth(), **planes})
    view = inspect(scratch, '--fov', FOV)
    equal(view['roles']['normal'] and view['roles']['normal']['channels'], list(names), 'normals')


@cases([('Octane', ('Normal (geometric)', 'Normal (shading)', 'Normal (tangent)'), 1),
        ('Corona', ('Normals - Geometric', 'Normals - Shading'), 1),
        ('without shading', ('Geo Normal', 'My Normal'), 1)])
def one_of_several_normals_is_taken_by_rule(scratch, _, layers, wanted):
    scene = Scene(48, 27)
    channels = {'Z': scene.depth()}
    for layer in layers:
        channels.update(scene.normals(layer, letters='RGB'))
    write_exr(scratch.path('in.exr'), channels)
    view = inspect(scratch, '--fov', FOV)
    equal(view['roles']['normal']['name'], layers[wanted], 'normals')
    check({'role': 'normal', 'name': layers[0], 'why': f"'{layers[wanted]}' comes first"} in
          view['passed_over'], str(view['passed_over']))


@cases([('hitPz',), ('ImageDepth.R',), ('Z-depth.R',), ('dd.y',), ('Depth.V',), ('Depth',),
        ('SceneDepthCm.R',), ('linear_depth',), ('Distance.R',)])
def depth_is_found_by_all_its_names(scratch, name):
    scene = Scene(48, 27)
    write_exr(scratch.path('in.exr'), {name: scene.depth(), 'Mist.Z': scene.depth()})
    view = inspect(scratch, '--fov', FOV)
    equal(view['roles']['depth'] and view['roles']['depth']['channels'], [name], 'depth')
    check({'role': 'depth', 'name': 'Mist.Z', 'why': 'no distance by its name'} in
          view['passed_over'], str(view['passed_over']))
    if name in ('dd.y', 'Distance.R'):
        equal(view['conventions']['depth_type'], 'radial', 'type')


@case
def component_stands_for_its_layer(scratch):
    scene = Scene(48, 27)
    write_exr(scratch.path('in.exr'), {'Z': scene.depth(), **scene.normals('A'),
                                       **scene.normals('B')})
    for name in ('A', 'A.X', 'A.Y'):
        view = inspect(scratch, '--normal', name, '--fov', FOV)
        equal(view['roles']['normal']['channels'], ['A.X', 'A.Y', 'A.Z'], f'--normal {name}')
    scratch.fails(CHANNELS, "no channel or layer 'Z'; channels: A.X", 'in.exr', '-o', 'x.exr',
                  '--normal', 'Z', hint='takes a layer with three components')


@case
def colours_that_might_be_meant_are_listed(scratch):
    scene = Scene(48, 27)
    write_exr(scratch.path('in.exr'), {'Z': scene.depth(),
                                       **scene.normals('diffuse', letters='RGB'),
                                       **scene.normals('glow', letters='RGB')})
    scratch.fails(CHANNELS, "no colour found.*; layers with colours: 'diffuse', 'glow'", 'in.exr',
                  '-o', 'x.exr', '--mode', 'comp', hint='--color NAME')
    scratch.render('in.exr', '-o', 'x.exr', '--mode', 'comp', '--color', 'glow.R')


@case
def grey_images_are_hinted_at(scratch):
    depth = Scene(48, 27).depth()
    for channels, hint in (({c: depth for c in 'RGB'}, '--depth R if'),
                           ({'Y': depth}, '--depth Y')):
        write_exr(scratch.path('in.exr'), channels)
        scratch.fails(CHANNELS, 'no depth channel found', 'in.exr', '-o', 'x.exr', hint=hint)


@case
def grey_files_called_depth_are_depth(scratch):
    scene = Scene()
    wanted, _ = clean(scratch, scene, normals=False)
    write_exr(scratch.path('shot_depth.0001.exr'), {c: scene.depth() for c in 'RGB'})
    options = ('-o', 'ao.exr', *OPTIONS, '--fov', FOV)
    said = scratch.render('shot_depth.0001.exr', *options).stderr
    check_same(read_ao(scratch.path('ao.exr')), wanted, 'a grey image')
    matches("no channel is called depth, but the file is: 'R' of its grey image", said, 'stderr')
    write_exr(scratch.path('depth.exr'), {c: v for c, v in scene.color().items()})
    scratch.fails(CHANNELS, "'R' and 'G' differ: a picture in colours", 'depth.exr', *options,
                  hint='--depth R')
    write_exr(scratch.path('depth_of_field.exr'), {c: scene.depth() for c in 'RGB'})
    scratch.fails(CHANNELS, 'no depth channel found', 'depth_of_field.exr', *options)


@case
def colours_in_a_layer_called_depth_are_refused(scratch):
    scene = Scene()
    colors = {f'depth.{c}': v for c, v in scene.color(alpha=False).items()}
    write_exr(scratch.path('in.exr'), colors)
    scratch.fails(CHANNELS, "'depth.R' and 'depth.G' differ: a picture in colours", 'in.exr', '-o',
                  'x.exr', '--fov', FOV)
    nothing = np.zeros_like(scene.depth())
    channels = {'depth.R': scene.depth(), 'depth.G': nothing, 'depth.B': nothing}
    run(scratch, channels, '--fov', FOV)


# --- Files ---

@case
def empty_chunk_table_is_rebuilt(scratch):
    scene = Scene(48, 27)
    write_exr(scratch.path('in.exr'), {'Z': scene.depth()}, compression='zips')
    whole = scratch.bytes('in.exr')
    raw = bytearray(whole)
    wanted, _ = run(scratch, {'Z': scene.depth()}, '--fov', FOV, compression='zips')
    table = chunk_table(whole, 27)
    raw[table:table + 27 * 8] = bytes(27 * 8)
    scratch.write('in.exr', bytes(raw))
    said = scratch.render('in.exr', '-o', 'ao.exr', *OPTIONS, '--fov', FOV).stderr
    matches('warning: in.exr: the chunk table is empty', said, 'stderr')
    check((read_ao(scratch.path('ao.exr')) == wanted).all(), 'AO differs')
    scratch.render('in.exr', '-o', 'all.exr', '--mode', 'append', '--fov', FOV)
    # Cut short as well, it is truncated.
    scratch.write('in.exr', bytes(raw[:-10]))
    scratch.fails(3, 'truncated', 'in.exr', '-o', 'x.exr')


def chunk_table(data, count):
    """Where the table of so many chunks begins: its first entry names the byte behind it."""
    for at in range(8, len(data) - 8 * count):
        if int.from_bytes(data[at:at + 8], 'little') == at + 8 * count:
            return at
    return check(False, 'no chunk table')


@case
def views_of_another_type_are_said(scratch):
    write_exr(scratch.path('in.exr'), {'Z': Scene(48, 27).depth()},
              attributes=[('multiView', 'left right')])
    matches('attribute multiView is of type string', str(inspect(scratch)['warnings']), 'warnings')


# --- What inspect tells ---

@case
def inspect_ends_as_a_run_would(scratch):
    write_exr(scratch.path('in.exr'), {'N.X': Scene(48, 27).depth()})
    view = inspect(scratch, code=CHANNELS)
    equal(view['verdict'], {'can_be_processed': False}, 'verdict')
    matches('--depth NAME', view['missing']['depth'], 'missing')
    scene = hidden(0.3)
    write_camera(scratch.path('camera.json'))
    write_exr(scratch.path('in.exr'), {'Z': depth_of(scene, 1000), **scene.normals(space='world')})
    view = inspect(scratch, '--camera', 'camera.json')
    check(view['verdict']['can_be_processed'] and view['verdict']['radius_is_auto'], str(view))
    check(view['conventions']['normal_agreement'] > 0.95, str(view['conventions']))
    text = scratch.run('inspect', 'in.exr', '--camera', 'camera.json').stdout
    matches(r'background \d+ % \(', text, 'text')
    matches(r'(?m)^  vkao +can process it, with --radius [0-9.]+ \(auto\) --bias', text, 'text')
    matches(r'agreement with depth \d\d(\.\d\d)? %', text, 'text')


if __name__ == '__main__':
    main()
