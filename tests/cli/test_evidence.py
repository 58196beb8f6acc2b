#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""What depth means is decided by what it shows: files of one scene as programs write them, in any
unit and with any background, give its AO, or are refused or warned of with the option that
helps."""
import re

import numpy as np

from cli import CHANNELS, case, cases, check, equal, main, matches, read_ao, write_exr
from evidence import (OPTIONS, check_same, clean, depth_of, hidden, inspect, rotation_header,
                      run)
from scene import CORNER, FAR, FOV, MOVE, NEAR, TURN, Scene, boxes_along_axes, write_camera

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


@cases([('told', ('--depth-type', 'inverse'), []), ('of Nuke', (), [('nuke/version', '15.1v2')])])
def inverse_of_the_distance_from_the_eye_is_said(scratch, _, options, attributes):
    scene = Scene(320, 180, fov=95)
    for stretch, is_wrong in (scene.stretch, True), (1, False):
        depth = np.where(scene.sky, 0, 1 / (scene.z * stretch)).astype(np.float32)
        write_exr(scratch.path('in.exr'), {'depth.Z': depth, **scene.normals()},
                  attributes=attributes)
        said = str(inspect(scratch, '--fov', 95, *options)['warnings'])
        equal('by normals \'N\' it is 1 over distances from the eye' in said, is_wrong, said)


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


KINDS = [('radial', 'radial', 1.0, 'is taken as radial, and as planar in the frames before'),
         ('inverse', 'inverse', 10.0, 'is taken as inverse, and as planar in the frames before'),
         ('cm', 'planar', 100.0, 'all distances .* are about 100 times those of the frames before'),
         ('km', 'planar', 1e-3, 'all distances .* are about 0.001 times')]


@cases(KINDS)
def frame_of_another_kind_is_said_where_it_begins(scratch, _, kind, unit, message):
    for i in range(6):
        scene, is_odd = Scene(eye=0.02 * i), i in (2, 3, 5)
        depth = scene.depth(kind) * unit if is_odd else scene.depth()
        write_exr(scratch.path(f'in.{i + 1}.exr'),
                  {'Z': depth.astype(np.float32), **scene.normals()})
    said = scratch.render('in.%d.exr', '-o', 'ao.%d.exr', *OPTIONS, '--fov', FOV).stderr
    equal(re.findall(rf"in\.(\d)\.exr: (?:depth 'Z' )?{message}", said), ['3', '6'],
          f'odd frames in {said}')


@case
def frames_of_one_kind_are_not_odd(scratch):
    # From a metre before the ball to far away, and nothing at all between.
    for i, unit in enumerate((1.0, 2.0, 0, 4.0, 7.0)):
        scene = Scene()
        depth = scene.depth() * unit if unit else np.full_like(scene.depth(), 1e10)
        write_exr(scratch.path(f'in.{i + 1}.exr'),
                  {'Z': depth.astype(np.float32), **scene.normals()})
    said = scratch.render('in.%d.exr', '-o', 'ao.%d.exr', *OPTIONS, '--fov', FOV, '--depth-type',
                          'planar').stderr
    check('frames before' not in said, said)


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


@cases([('-1e30', -1e30), ('-inf', -np.inf), ('1e10', 1e10), ('0', 0), ('65504', 65504),
        ('-65504', -65504), ('far plane', 40)])
def negative_z_is_turned(scratch, _, background):
    scene = Scene()
    wanted, _ = clean(scratch, scene)
    depth = np.where(scene.sky, background, -scene.z).astype(np.float32)
    ao, said = run(scratch, {'Z': depth, **scene.normals()}, '--fov', FOV, '--normal-space',
                   'camera')
    check_same(ao, wanted, 'negative z')
    matches('its sign is turned', said, 'stderr')
    check((ao[scene.sky] == 1).all(), 'the sky is not 1')


# What depth is, what it is said to be, and the type that helps.
TOLD_TYPES = [('radial', 'planar', 'radial'), ('planar', 'radial', 'planar'),
              ('planar', 'radial-near', 'planar'), ('planar', 'inverse', 'planar'),
              ('inverse', 'planar', 'inverse'), ('inverse', 'radial', 'device with --near and'),
              ('planar', 'device', 'planar'),
              *[(k, k, None) for k in ('planar', 'radial', 'radial-near', 'inverse', 'device')]]


@cases(TOLD_TYPES, name=lambda row: f'{row[0]} as {row[1]}')
def flat_things_contradict_a_type_that_is_told(scratch, kind, told, remedy):
    write_exr(scratch.path('in.exr'), {'Z': Scene(320, 180).depth(kind)})
    said = str(inspect(scratch, '--fov', FOV, '--near', NEAR, '--far', FAR, '--depth-type',
                       told)['warnings'])
    if remedy:
        matches(f"--depth-type says that depth 'Z' is {told}, but flat things are flat only .*: "
                f'{told} is taken .--depth-type .*{remedy}', said, 'the warnings')
    else:
        check('flat things' not in said, said)


@case
def flat_things_contradict_a_name(scratch):
    for name, kind, is_said in (('distance.Z', 'planar', True), ('distance.Z', 'radial', False),
                                ('distance_to_image_plane.Z', 'radial', True)):
        write_exr(scratch.path('in.exr'), {name: Scene(320, 180).depth(kind)})
        said = str(inspect(scratch, '--fov', FOV)['warnings'])
        equal(f"its name says that depth '{name}' is" in said, is_said, f'whether it is in {said}')


@cases([('a third', 1 / 3, True), ('nothing', 0, False)])
def depth_from_a_near_plane_is_said(scratch, _, share, is_said):
    scene = Scene()
    depth = depth_of(scene, 1e10) - np.float32(share * scene.z.min())
    write_exr(scratch.path('in.exr'), {'Z': depth, **scene.normals(space='world')})
    said = str(inspect(scratch)['warnings'])
    equal('looks measured from a near plane' in said, is_said, f'whether it is in {said}')


CURVES = [('square root', np.sqrt, 'to the power of about 0.5:'),
          ('square', np.square, 'power of about (1.9|2):'),
          ('of a picture', lambda z: 9 * (z / 9) ** (1 / 2.2), 'power of about 0.4[56]:'),
          ('logarithm', lambda z: np.log(z * 10), 'the logarithm'), ('none', lambda z: z, '')]


@cases(CURVES)
def bent_depth_is_said(scratch, _, bend, said):
    scene = Scene()
    depth = bend(np.where(scene.sky, 1e10, scene.z)).astype(np.float32)
    for channels, options in (({}, ('--fov', FOV)), (scene.normals(space='world'), ()),
                              (scene.normals(), ('--fov', FOV))):
        write_exr(scratch.path('in.exr'), {'Z': depth, **channels})
        warnings = str(inspect(scratch, *options)['warnings'])
        if said:
            matches(f"depth 'Z' looks like .*{said}", warnings, 'the warnings')
        else:
            check('looks like' not in warnings, warnings)


@case
def bent_depth_of_a_type_that_is_told_is_said(scratch):
    scene = Scene()
    for bend, is_said in (np.sqrt, True), (lambda z: z, False):
        depth = bend(np.where(scene.sky, 1e10, scene.z)).astype(np.float32)
        write_exr(scratch.path('in.exr'), {'Z': depth})
        said = str(inspect(scratch, '--fov', FOV, '--depth-type', 'planar')['warnings'])
        equal('power of about 0.5:' in said, is_said, f'whether it is in {said}')


# Boxes in a corner, and the size of the image.
HALVES = [('one box', [((-2.2, -1.7, -6.7), (-0.3, 0.5, -4.6))], (640, 360)),
          ('two boxes', [((1.8, -2.4, -6.3), (4, -1.1, -4.9)),
                         ((-1.3, -3.1, -7), (-0.2, -2, -6.1))], (320, 180))]


@cases(HALVES)
def steps_of_halves_bend_nothing(scratch, _, boxes, size):
    # Only what bends most is more than they are.
    depth = boxes_along_axes(CORNER + boxes, *size, turn=np.eye(3))['Z'].astype(np.float16)
    write_exr(scratch.path('in.exr'), {'Z': depth})
    for options in (), ('--depth-type', 'planar'):
        said = str(inspect(scratch, '--fov', FOV, *options)['warnings'])
        check('looks like' not in said and 'flat only' not in said, said)


TONES = [('reinhard', lambda z: 6 * z / (6 + z), True), ('strong', lambda z: 2 * z / (2 + z), True),
         ('exponential', lambda z: 9 * (1 - np.exp(-z / 9)), True), ('none', lambda z: z, False)]


@cases(TONES)
def toned_depth_is_said(scratch, _, squeeze, is_said):
    # Its planes are flat, and not those of the normals.
    for size in ((160, 90), (400, 225)):
        scene = Scene(*size)
        depth = squeeze(np.where(scene.sky, 1, scene.z))
        depth = np.where(scene.sky, 1e10, depth).astype(np.float32)
        for options in (('--fov', FOV), ()):
            write_exr(scratch.path('in.exr'), {'Z': depth, **scene.normals(space='world')})
            said = str(inspect(scratch, *options)['warnings'])
            equal("depth 'Z' looks squeezed" in said, is_said, f'whether it is in {said}')


@cases([('exponential', lambda z: 16 * (1 - np.exp(-z / 16)), True), ('none', lambda z: z, False)])
def toned_depth_beside_waves_of_normals_is_said(scratch, _, squeeze, is_said):
    # What is not flat keeps its own error.
    scene = Scene(400, 225)
    row, column = np.mgrid[:225, :400] * (2 * np.pi / 60)
    waves = np.stack([np.sin(column + row * 0.19), np.sin(row + 1), np.cos(row + column)], -1)
    waves *= 0.03 * (scene.x > np.quantile(scene.x, 0.6))[..., None]
    scene.normal = np.where(scene.sky[..., None], 0, scene.normal + waves)
    scene.normal /= np.maximum(np.linalg.norm(scene.normal, axis=-1, keepdims=True), 1e-9)
    depth = np.where(scene.sky, 1e10, squeeze(np.where(scene.sky, 1, scene.z))).astype(np.float32)
    write_exr(scratch.path('in.exr'), {'Z': depth, **scene.normals()})
    said = str(inspect(scratch)['warnings'])
    equal("depth 'Z' looks squeezed" in said, is_said, f'whether it is in {said}')


@case
def another_field_of_view_is_no_tone(scratch):
    write_exr(scratch.path('in.exr'), {'Z': Scene().depth(), **Scene().normals(space='world')})
    for fov in (FOV * 0.7, FOV * 1.4):
        said = str(inspect(scratch, '--fov', fov)['warnings'])
        check('depth and normals' in said and 'squeezed' not in said, said)


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


@cases([('with a name', 'dd.T', False), ('without', 'Z', True)])
def near_plane_that_nobody_tells_is_said(scratch, _, name, is_said):
    scene = Scene(320, 180)
    write_exr(scratch.path('in.exr'), {name: scene.depth('radial-near'), **scene.normals()})
    said = str(inspect(scratch, '--fov', FOV)['warnings'])
    equal(re.search('near plane at 0.5[0-9]*, which normals alone tell', said) is not None, is_said,
          f'whether it is in {said}')
    said = str(inspect(scratch, '--fov', FOV, '--near', NEAR)['warnings'])
    check('which normals alone tell' not in said, said)


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


@cases([('all of them', 0, False), ('a few', 0.005, False), ('a third', 0.3, True)])
def surface_without_normals_is_said(scratch, _, share, is_said):
    scene = Scene()
    wanted = scene.normals()
    there = np.arange(160) >= round(160 * share)
    left = {n: np.where(there, v, 0).astype(np.float32) for n, v in wanted.items()}
    write_exr(scratch.path('in.exr'), {'Z': depth_of(scene, 1e10), **left})
    said = str(inspect(scratch, '--fov', FOV)['warnings'])
    equal("of the surface has no normals 'N': they are 0" in said, is_said, f'whether in {said}')
    # In a part or a file that is cut to some box.
    begin = int(160 * share)
    layout = {'x': begin, 'display': (0, 0, 159, 89)}
    cut = {n: np.ascontiguousarray(v[:, begin:]) for n, v in wanted.items()}
    write_exr(scratch.path('in.exr'), ({'Z': depth_of(scene, 1e10)}, {'name': 'depth'}),
              (cut, {'name': 'N', **layout}))
    write_exr(scratch.path('n.exr'), cut, **layout)
    for path, options in ('in.exr', ()), ('n.exr', ('--normal-file', 'n.exr')):
        said = [w for w in inspect(scratch, '--fov', FOV, *options)['warnings']
                if f'data window ({begin} 0) - (159 89) covers a part only' in w]
        equal([w.split(':')[0] for w in said], [path] * is_said, 'the file that is named')


@cases([('beyond it', 5.0, True), ('before it', 60.0, True), ('opaque', 5.0, False)])
def sky_of_one_value_without_normals(scratch, name, value, is_sky):
    # Things lie beyond what stands for the sky.
    scene = hidden(0.3)
    wanted, _ = clean(scratch, scene)
    channels = {'Z': depth_of(scene, value), **scene.normals()}
    if not is_sky:
        channels.update({c: np.ones_like(channels['Z']) for c in 'RGBA'})
    ao, said = run(scratch, channels, '--fov', FOV)
    equal('has no normals' in said, not is_sky, f'{name}: {said}')
    if is_sky:
        check_same(ao, wanted, f'{name}: {said}')


@cases([('-1', -1, 'areas', False), ('nan', np.nan, 'areas', False), ('-inf', -np.inf, 'areas',
                                                                       False),
        ('nan, alone', np.nan, 'depth alone', False), ('specks', np.nan, 'specks', True),
        ('-1 in surfaces', -1, 'surfaces', True), ('several', None, 'areas', True)])
def what_stands_for_nothing_is_no_fault(scratch, _, value, where, is_said):
    scene = hidden(0.3)
    depth = depth_of(scene, value if value is not None else -1)
    normals = scene.normals() if where != 'depth alone' else {}
    if value is None:
        depth[:20][scene.sky[:20]] = np.nan
    if where == 'specks':
        depth = depth_of(scene, 1e10)
        depth[::7, ::5] = value
    if where == 'surfaces':
        depth = depth_of(scene, 1e10)
        depth[60:70, 20:40] = value
    write_exr(scratch.path('in.exr'), {'Z': depth, **normals})
    said = str(inspect(scratch, '--fov', FOV)['warnings'])
    equal('are NaN, negative' in said, is_said, said)


@cases([('millimetres', 0.001), ('16 bits', 12 / 65535), ('none', 0)])
def steps_of_depth_are_no_blur(scratch, _, step):
    scene = Scene(320, 180)
    depth = depth_of(scene, 1e10)
    if step:
        depth = np.where(scene.sky, 1e10, np.round(scene.z / step) * step).astype(np.float32)
    write_exr(scratch.path('in.exr'), {'Z': depth, **scene.normals()})
    said = str(inspect(scratch, '--fov', FOV)['warnings'])
    check('blurred' not in said and 'noisy' not in said, said)


@cases([('0', 0), ('inf', np.inf), ('nan', np.nan)])
def holes_in_surfaces_are_said(scratch, _, value):
    scene, random = Scene(), np.random.default_rng(3)
    channels = {'Z': depth_of(scene, 1e10), **scene.normals()}
    write_exr(scratch.path('in.exr'), channels)
    said = str(inspect(scratch, '--fov', FOV)['warnings'])
    check('has nothing' not in said, said)
    channels['Z'][(random.random(scene.z.shape) < 0.02) & ~scene.sky] = value
    write_exr(scratch.path('in.exr'), channels)
    said = str(inspect(scratch, '--fov', FOV)['warnings'])
    matches('are NaN, negative' if np.isnan(value) else
            "has nothing at .* in the middle of surfaces that normals 'N' show", said, 'warnings')
    equal('has nothing' in said, not np.isnan(value), f'whether it is said once in {said}')
    # What lies behind a given distance is meant to be nothing.
    said = str(inspect(scratch, '--fov', FOV, '--background', 9)['warnings'])
    check('has nothing' not in said, said)


@case
def normals_do_not_tell_reversed_depth_from_inverse(scratch):
    scene = Scene()
    write_exr(scratch.path('in.exr'), {'Z': scene.depth('reversed', far=1e9), **scene.normals()})
    matches('a reversed depth buffer differs in scale alone .*--depth-type device',
            str(inspect(scratch)['warnings']), 'the warnings')


@cases([('35', 35), ('1000', 1000)])
def scale_of_inverse_depth_is_not_in_the_file(scratch, _, k):
    scene = Scene()
    wanted, _ = clean(scratch, scene, '--radius', 0.5)
    channels = {'Z': (scene.depth('inverse') * k).astype(np.float32), **scene.normals()}
    ao, said = run(scratch, channels, '--fov', FOV, '--radius', 0.5 / k)
    check_same(ao, wanted, 'AO with the radius divided by k')
    matches("depth 'Z' is up to .*, taken as 1/z; k/z looks the same .*divide --radius by k", said,
            'stderr')


@cases([('0', 0), ('1', 1), ('inf', np.inf), ('nan', np.nan), ('5', 5.0), ('1e10', 1e10)])
def depth_without_shape_is_an_error(scratch, _, value):
    write_exr(scratch.path('in.exr'), {'Z': np.full((20, 30), value, np.float32)})
    result = scratch.fails(CHANNELS, "in.exr: depth 'Z' is .*no picture of anything", 'in.exr',
                           '-o', 'x.exr', hint='--depth NAME')
    check('normalised?' not in result.stderr, result.stderr)
    equal('is nan everywhere' in result.stderr, bool(np.isnan(value)), result.stderr)
    said = scratch.render('in.exr', '-o', 'x.exr', '--depth-type', 'planar').stderr
    matches("warning: in.exr: depth 'Z' is .*AO is 1 everywhere", said, 'stderr')


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
