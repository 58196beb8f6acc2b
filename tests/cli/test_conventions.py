#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""One scene in every convention that renderers have gives one result; and every option does
something."""
import re

import numpy as np

from cli import (case, cases, check, check_close, compute_ao, equal, main, matches, oiio, read_ao,
                 write_exr)
from scene import (FAR, FOV, HEIGHT, MOVE, NEAR, RADIUS, TURN, WIDTH, Scene, camera, write_camera)

SCENE = Scene()
BASE = ('--radius', RADIUS, '--pixel-type', 'float', '--overwrite', 'always')


def ao_of(scratch, channels, *options, **layout):
    return compute_ao(scratch, channels, *BASE, *options, **layout)[0]


def planar(scratch, *options):
    return ao_of(scratch, {'Z': SCENE.depth(), **SCENE.normals()}, *(options or ('--fov', FOV)))


# --- Depth ---

DEPTH_TYPES = [
    ('radial', 'radial', ()),
    ('radial-near', 'radial-near', ('--near', NEAR)),
    ('inverse', 'inverse', ()),
    ('device', 'device', ('--near', NEAR, '--far', FAR)),
    ('reversed', 'device', ('--near', FAR, '--far', NEAR)),
]


@cases(DEPTH_TYPES)
def depth_type_gives_the_result_of_planar(scratch, kind, name, planes):
    wanted = planar(scratch)
    channels = {'Z': SCENE.depth(kind), **SCENE.normals()}
    ao = ao_of(scratch, channels, '--fov', FOV, '--depth-type', name, *planes)
    # Rounding of the stored value may turn single samples from free to blocked: 1/16 before the
    # blur. Device depth has the fewest digits far away.
    check_close(ao, wanted, 0.07, 2e-4, kind)
    check((ao[SCENE.sky] == 1).all(), f'{kind}: the background is not 1')
    if kind != 'reversed':
        wrong = ao_of(scratch, channels, '--fov', FOV, '--depth-type', 'planar')
        check(np.abs(wrong - wanted).mean() > 1e-3, f'--depth-type {name} makes no difference')


@cases(DEPTH_TYPES)
def depth_alone_of_every_type_gives_the_result_of_planar(scratch, kind, name, planes):
    wanted = ao_of(scratch, {'Z': SCENE.depth()}, '--fov', FOV)
    ao = ao_of(scratch, {'Z': SCENE.depth(kind)}, '--fov', FOV, '--depth-type', name, *planes)
    # Normals come from differences of the depth here, which magnify its rounding.
    check_close(ao, wanted, 0.25, 2e-3, kind)


@cases(DEPTH_TYPES)
def depth_type_in_a_cut_data_window_gives_the_result_of_planar(scratch, kind, name, planes):
    # Rays belong to the display window: distances along them are wrong if taken for the cut's.
    cut, results = (slice(20, 80), slice(60, 150)), []
    for depth, options in (('planar', ()), (kind, ('--depth-type', name, *planes))):
        channels = {'Z': SCENE.depth(depth), **SCENE.normals()}
        results.append(ao_of(scratch, {k: v[cut] for k, v in channels.items()}, '--fov', FOV,
                             *options, x=60, y=20, display=(0, 0, WIDTH - 1, HEIGHT - 1)))
    check_close(results[1], results[0], 0.07, 2e-4, kind)


@case
def infinite_far_plane_is_a_limit(scratch):
    wanted = planar(scratch)
    with np.errstate(invalid='ignore'):
        depth = np.where(SCENE.sky, 1, 1 - NEAR / SCENE.z).astype(np.float32)
    for z, planes in ((depth, (NEAR, 'inf')), (1 - depth, ('inf', NEAR))):
        ao = ao_of(scratch, {'Z': z, **SCENE.normals()}, '--fov', FOV, '--depth-type', 'device',
                   '--near', planes[0], '--far', planes[1])
        check_close(ao, wanted, 0.07, 2e-4, f'planes {planes}')


@case
def mitsuba_depth_is_known_by_its_name(scratch):
    wanted = planar(scratch)
    ao = ao_of(scratch, {'dd.y.T': SCENE.depth('radial-near'), **SCENE.normals('nn')},
               '--fov', FOV, '--near', NEAR, '--normal-space', 'camera')
    check_close(ao, wanted, 0.07, 2e-4, 'dd.y.T')


@cases([('Z',), ('depth',), ('depth.Z',), ('ViewLayer.Depth.Z',), ('Depth.V',), ('z.Y',),
        ('VRayZDepth.R',)])
def depth_is_found_by_name(scratch, name):
    wanted = planar(scratch)
    ao = ao_of(scratch, {name: SCENE.depth(), **SCENE.normals()}, '--fov', FOV)
    check_close(ao, wanted, 0, 0, name)


@case
def depth_can_be_named(scratch):
    wanted = planar(scratch)
    channels = {'odd.name': SCENE.depth(), 'Z': SCENE.depth() * 3, **SCENE.normals()}
    check_close(ao_of(scratch, channels, '--fov', FOV, '--depth', 'odd.name'), wanted, 0, 0,
                '--depth odd.name')
    check(np.abs(ao_of(scratch, channels, '--fov', FOV) - wanted).mean() > 0.01,
          'Z and odd.name give the same')


# --- Normals ---

@case
def world_normals_equal_camera_normals(scratch):
    write_camera(scratch.path('camera.json'))
    options = ('--camera', 'camera.json')
    wanted = planar(scratch, '--normal-space', 'camera', *options)
    channels = {'Z': SCENE.depth(), **SCENE.normals(space='world')}
    for space in ('world', 'auto'):
        ao = ao_of(scratch, channels, '--normal-space', space, *options)
        check_close(ao, wanted, 0.07, 1e-4, f'--normal-space {space}')
    wrong = ao_of(scratch, channels, '--normal-space', 'camera', *options)
    check(np.abs(wrong - wanted).mean() > 0.01, '--normal-space camera makes no difference')


@cases([('N', 'XYZ'), ('normal', 'RGB'), ('ViewLayer.Normal', 'XYZ'), ('nn', 'xyz')])
def normals_are_found_by_name(scratch, layer, letters):
    wanted = planar(scratch)
    channels = {'Z': SCENE.depth(), **SCENE.normals(layer, letters=letters)}
    ao = ao_of(scratch, channels, '--fov', FOV, '--normal-space', 'camera')
    check_close(ao, wanted, 0, 0, layer)


@case
def unsigned_normals_equal_signed_ones(scratch):
    wanted = planar(scratch)
    channels = {'Z': SCENE.depth(), **SCENE.normals(encoding='unsigned')}
    ao = ao_of(scratch, channels, '--fov', FOV, '--normal-encoding', 'unsigned')
    check_close(ao, wanted, 0.07, 1e-4, 'unsigned')
    found = scratch.render('in.exr', '-o', 'auto.exr', *BASE, '--fov', FOV)
    check_close(read_ao(scratch.path('auto.exr')), ao, 0, 0, 'auto')
    matches(r'warning: in\.exr: normals .N. look 0\.\.1 encoded', found.stderr, 'the warning')
    wrong = ao_of(scratch, channels, '--fov', FOV, '--normal-encoding', 'signed',
                  '--normal-space', 'camera')
    check(np.abs(wrong - wanted).mean() > 0.01, '--normal-encoding makes no difference')


@case
def normals_from_depth_are_close(scratch):
    wanted = planar(scratch)
    ao = ao_of(scratch, {'Z': SCENE.depth()}, '--fov', FOV)
    check_close(ao, wanted, 0.8, 0.01, 'depth alone')
    check(not np.array_equal(ao, wanted), 'normals make no difference')
    ignored = ao_of(scratch, {'Z': SCENE.depth(), **SCENE.normals()}, '--fov', FOV, '--normal',
                    'none')
    check_close(ignored, ao, 0, 0, '--normal none')


@case
def long_normals_are_normalised(scratch):
    wanted = planar(scratch)
    normals = {k: v * np.float32(0.97) for k, v in SCENE.normals().items()}
    ao = ao_of(scratch, {'Z': SCENE.depth(), **normals}, '--fov', FOV)
    check_close(ao, wanted, 0.07, 1e-4, 'normals of length 0.97')


# --- Camera ---

def standard_attributes():
    """worldToCamera and worldToNDC as OpenEXR defines them: row vectors, z forwards, y of NDC
    downwards."""
    half = np.tan(np.radians(FOV / 2))
    to_camera, to_ndc = np.eye(4), np.zeros((4, 4))
    to_camera[:3, :3] = np.diag([1, 1, -1]) @ TURN
    to_camera[:3, 3] = np.diag([1, 1, -1]) @ MOVE
    to_ndc[0] = [0.5 / half, 0, 0.5, 0]
    to_ndc[1] = [0, -0.5 / half * WIDTH / HEIGHT, 0.5, 0]
    to_ndc[2], to_ndc[3] = [0, 0, 1, -NEAR], [0, 0, 1, 0]
    kind = oiio.TypeDesc('matrix')
    return [(name, kind, tuple(float(v) for v in m.T.flatten()))
            for name, m in (('worldToCamera', to_camera), ('worldToNDC', to_ndc @ to_camera))]


@case
def camera_comes_from_the_standard_attributes(scratch):
    write_camera(scratch.path('camera.json'))
    channels = {'Z': SCENE.depth(), **SCENE.normals(space='world')}
    wanted = ao_of(scratch, channels, '--camera', 'camera.json')
    ao = ao_of(scratch, channels, attributes=standard_attributes())
    check_close(ao, wanted, 0.07, 1e-4, 'worldToCamera and worldToNDC')


@cases([
    ('fov', ('--fov', FOV)),
    ('horizontal', ('--fov', f'{FOV}:h')),
    ('vertical', ('--fov', f'{2 * np.degrees(np.arctan(np.tan(np.radians(FOV / 2)) * 9 / 16))}:v')),
])
def field_of_view(scratch, _, options):
    write_camera(scratch.path('camera.json'))
    wanted = planar(scratch, '--camera', 'camera.json', '--normal-space', 'camera')
    ao = planar(scratch, *options, '--normal-space', 'camera')
    check_close(ao, wanted, 0.07, 1e-5, 'AO')
    wider = planar(scratch, '--fov', 90)
    check(np.abs(wider - wanted).mean() > 0.005, 'the field of view makes no difference')


@case
def fields_of_view_of_renderers_are_read(scratch):
    wanted = planar(scratch)
    channels = {'Z': SCENE.depth(), **SCENE.normals()}
    focal = 36 / 2 / np.tan(np.radians(FOV / 2))
    for attributes in ([('cameraFov', float(FOV))], [('arnold/camera/fov', float(FOV))],
                       [('cameraFocalLength', float(focal)), ('cameraAperture', 36.0)]):
        ao = ao_of(scratch, channels, attributes=attributes)
        check_close(ao, wanted, 0.07, 1e-5, attributes[0][0])


@case
def orthographic_camera(scratch):
    i = np.arange(64, dtype=np.float32)
    step = np.where(i < 32, 5, 4.7) + 0 * i[:, None]
    channels = {'Z': step.astype(np.float32)}
    ao = ao_of(scratch, channels, '--ortho', 4)
    check(ao[:, 29:32].mean() < 0.88, f'beside the step: {ao[:, 29:32].mean()}')
    check((ao[:, :20] > 0.99).all() and (ao[:, 40:] > 0.97).all(), 'flat parts are not open')
    write_camera(scratch.path('ortho.json'), {'type': 'orthographic', 'ortho_width': 4})
    check_close(ao_of(scratch, channels, '--camera', 'ortho.json'), ao, 0, 0, 'camera file')


@cases([('y',), ('x',)])
def lens_shift_moves_the_view(scratch, axis):
    """The lower half of a view twice as high, whose floor needs the shift to be where its normals
    say; and the same lying on its side. The hemisphere's points follow the normals, whatever plane
    depth has."""
    tall = Scene(WIDTH, 2 * HEIGHT)
    half = {k: v[HEIGHT:] for k, v in {'Z': tall.depth(), **tall.normals()}.items()}
    lens, fov = {'shift_y': -0.5}, FOV
    if axis == 'x':
        half = {'Z': half['Z'].T, 'N.X': -half['N.Y'].T, 'N.Y': -half['N.X'].T,
                'N.Z': half['N.Z'].T}
        lens = {'shift_x': 0.5}
        fov = 2 * np.degrees(np.arctan(np.tan(np.radians(FOV / 2)) * HEIGHT / WIDTH))
    floor = slice(40, 70), slice(0, 30)
    results = []
    for more in (lens, {}):
        write_camera(scratch.path('camera.json'), camera(fov, **more))
        ao = ao_of(scratch, half, '--camera', 'camera.json', '--normal-space', 'camera',
                   '--method', 'hemisphere')
        results.append((ao.T if axis == 'x' else ao)[floor].mean())
    check(results[0] > 0.98, f'open floor is {results[0]}')
    check(results[1] < 0.9, f'open floor without the shift is {results[1]}')


# --- Every option does something ---

OPTIONS = [
    ('--samples', ('--samples', 8), ('--method', 'hemisphere')),
    ('--samples of raymarch', ('--samples', 8), ('--method', 'raymarch')),
    ('--quality', ('--quality', 'fast'), ()),
    ('--slices', ('--slices', 2), ()),
    ('--steps', ('--steps', 5), ()),
    ('--thickness', ('--thickness', 0.5), ()),
    ('--thickness of raymarch', ('--thickness', 0.5), ('--method', 'raymarch')),
    ('--radius', ('--radius', 0.3), ()),
    ('--radius auto', ('--radius', 'auto'), ()),
    ('--falloff', ('--falloff', 'threshold'), ()),
    ('--method', ('--method', 'sphere'), ()),
    ('--sphere-form', ('--sphere-form', 'literal'), ('--method', 'sphere')),
    ('--blocking-scale', ('--blocking-scale', 5), ('--method', 'sphere', '--sphere-form',
                                                   'literal')),
    ('--bias', ('--bias', 0.2), ()),
    ('--noise-index', ('--noise-index', 1), ()),
    ('--intensity', ('--intensity', 2), ()),
    ('--power', ('--power', 2), ()),
    ('--blur', ('--blur', 2), ()),
    ('--blur off', ('--blur', 'off'), ()),
    ('--blur-sharpness', ('--blur-sharpness', 0), ()),
    ('--blur-normal-power', ('--blur-normal-power', 8), ()),
    ('--normal none', ('--normal', 'none'), ()),
    ('--normal', ('--normal', 'Other'), ()),
    ('--depth', ('--depth', 'Other.Y'), ()),
    ('--depth-type', ('--depth-type', 'radial'), ()),
    ('--thickness-channel', ('--thickness-channel', 'Thin.Y'), ()),
    ('--thickness-channel of raymarch', ('--thickness-channel', 'Thin.Y'), ('-m', 'raymarch')),
    ('--back-depth', ('--back-depth', 'Back.Y'), ()),
    ('--layer2', ('--layer2', 'Second.Y'), ()),
    ('--layer2 of raymarch', ('--layer2', 'Second.Y'), ('-m', 'raymarch')),
    ('--fov', ('--fov', 50), ()),
    ('--ortho', ('--ortho', 6), None),
    ('--pixel-type', ('--pixel-type', 'half'), ()),
]


@cases(OPTIONS)
def option_changes_the_result(scratch, _, option, base):
    start = () if base is None else ('--fov', FOV)
    other = SCENE.normals('Other', space='world')
    other['Other.Y'] = np.where(SCENE.sky, 0, SCENE.z * 2).astype(np.float32)
    for name, z in (('Thin', 0.03), ('Back', SCENE.z + 0.03), ('Second', SCENE.z + 0.1)):
        other[f'{name}.Y'] = np.where(SCENE.sky, 0, z).astype(np.float32)
    channels = {'Z': SCENE.depth(), **SCENE.normals(), **other}
    before = ao_of(scratch, channels, *start, *(base or ()))
    after = ao_of(scratch, channels, *start, *(base or ()), *option)
    check(not np.array_equal(before, after), f'{option} changes nothing')
    check((after[SCENE.sky] == 1).all(), f'{option}: the background is not 1')


@cases([('--intensity', -1), ('--power', -1)])
def more_is_darker(scratch, option, _):
    once, twice = planar(scratch), planar(scratch, '--fov', FOV, option, 2)
    check((twice <= once + 1e-6).all() and twice.mean() < once.mean() - 0.005,
          f'{option} 2: mean {once.mean()} -> {twice.mean()}')
    if option == '--power':
        check_close(twice, once ** 2, 1e-5, 1e-6, 'the square')
    else:
        check_close(twice, np.clip(1 - 2 * (1 - once), 0, 1), 0.3, 0.02, 'twice the occlusion')


@case
def options_for_the_other_method_change_nothing(scratch):
    wanted = planar(scratch)
    for option in (('--sphere-form', 'literal'), ('--blocking-scale', 3), ('--device', 'cpu'),
                   ('--device', '0'), ('--verbose',), ('--quiet',)):
        check_close(planar(scratch, '--fov', FOV, *option), wanted, 0, 0, option[0])


@case
def auto_radius_is_five_percent_of_the_median_distance(scratch):
    write_exr(scratch.path('in.exr'), {'Z': np.full((16, 16), 3.3, np.float32)})
    got = scratch.render('in.exr', '-o', 'ao.exr', '--depth-type', 'planar')
    matches(r'radius=0\.1[67] \(auto\)', got.stderr, 'the summary')
    equal(got.stderr.count('vkao: using: '), 1, 'number of summaries')


def summary_radius(run):
    return re.search(r'radius=(\S+)', run.stderr).group(1)


@case
def radius_in_percent_is_of_the_median_distance(scratch):
    write_exr(scratch.path('in.exr'), {'Z': np.full((16, 16), 3.3, np.float32)})
    for option, wanted in (('5%', '0.165'), ('12.5%', '0.412'), ('200%', '6.6')):
        run = scratch.render('in.exr', '-o', 'ao.exr', '--overwrite', 'always', '-r', option,
                             '--depth-type', 'planar')
        equal(summary_radius(run), wanted, option)


@case
def radius_in_pixels_is_rows_at_the_median_distance(scratch):
    # 90 degrees over 32 columns: at a distance of 8 a texel is half a unit wide.
    planes = {'Z': np.full((16, 32), 8, np.float32)}
    for aspect, wanted in ((1.0, '1.5'), (2.0, '0.75')):
        write_exr(scratch.path('in.exr'), planes, attributes=(('PixelAspectRatio', aspect),))
        run = scratch.render('in.exr', '-o', 'ao.exr', '--overwrite', 'always', '-r', '3px',
                             '--fov', 90, '--depth-type', 'planar')
        equal(summary_radius(run), wanted, f'pixel aspect {aspect}')
    run = scratch.render('in.exr', '-o', 'ao.exr', '--overwrite', 'always', '-r', '3px',
                         '--ortho', 64, '--depth-type', 'planar')
    equal(summary_radius(run), '3', 'orthographic')


@cases([('1e-4', 'pixels at the median distance of 5: nothing so near is seen'),
        ('40', 'times as long as the image at the median distance of 5'), ('0.3', None),
        ('9', None)])
def radius_that_the_image_cannot_show(scratch, radius, wanted):
    """Depth in another unit than the radius gives white, or nearly."""
    write_exr(scratch.path('in.exr'), {'Z': np.full((16, 32), 5, np.float32)})
    run = scratch.render('in.exr', '-o', 'ao.exr', '-r', radius, '--fov', 90, '--depth-type',
                         'planar')
    if wanted:
        matches(f'radius {float(radius):.3g} is .*{wanted}', run.stderr, 'the warning')
    else:
        check('radius' not in run.stderr.replace('radius=', ''), run.stderr)


@cases(['auto', '25px', '7.77%'])
def printed_radius_makes_the_same_of_other_frames(scratch, radius):
    for frame, eye in ((1, 0.0), (2, 0.4)):
        scene = Scene(96, 54, eye=eye)
        planes = {'Z': scene.depth() * np.float32(frame), **scene.normals()}
        write_exr(scratch.path(f'in.{frame}.exr'), planes)
    run = scratch.render('in.@.exr', '-o', 'whole.@.exr', '-r', radius, '--fov', FOV)
    printed = re.search(r'--radius (\S+)$', run.stderr, re.M).group(1)
    scratch.render('in.2.exr', '-o', 'chunk.exr', '--radius', printed, '--fov', FOV)
    check_close(read_ao(scratch.path('chunk.exr')), read_ao(scratch.path('whole.2.exr')), 0, 0,
                radius)
    scratch.render('in.2.exr', '-o', 'own.exr', '--radius', radius, '--fov', FOV)
    check(np.abs(read_ao(scratch.path('own.exr')) - read_ao(scratch.path('chunk.exr'))).max() > 0,
          'the frame alone has the radius of the first')


@case
def quiet_says_nothing_and_verbose_more(scratch):
    write_exr(scratch.path('in.exr'), {'Z': SCENE.depth()})
    run = ('in.exr', '-o', 'ao.exr', '--overwrite', 'always')
    equal(scratch.render(*run, '--quiet').stderr, '', 'stderr with --quiet')
    plain, verbose = scratch.render(*run).stderr, scratch.render(*run, '-v').stderr
    matches('vkao: using: depth=Z', plain, 'stderr')
    matches(r'read \d+ ms, compute \d+ ms, write \d+ ms', verbose, 'stderr with -v')
    matches('no camera in the header', plain, 'the warning')


if __name__ == '__main__':
    main()
