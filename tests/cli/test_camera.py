#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""The camera where nobody tells it: from depth and normals, or plainly not."""
import json
import re

import numpy as np

from cli import (CHANNELS, case, cases, check, check_close, equal, main, matches, read_ao,
                 read_parts, write_exr)
from evidence import inspect_and_hear as inspect
from scene import (CORNER, FOV, NEAR, RADIUS, TURN, Scene, boards, boxes_along_axes, camera,
                   write_camera)

BASE = ('--radius', RADIUS, '--pixel-type', 'float', '--overwrite', 'always')


def half_width(fov):
    return np.tan(np.radians(fov) / 2)


def check_same_ao(scratch, explicit, what):
    """AO by what is found against AO by what is so: RMSE as a person would see it."""
    results = []
    for options in ((), explicit):
        scratch.render('in.exr', '-o', 'ao.exr', *BASE, *options)
        results.append(read_ao(scratch.path('ao.exr')).astype(np.float64))
    rmse = np.sqrt(np.mean((results[0] - results[1]) ** 2))
    check(rmse < 0.01, f'{what}: RMSE {rmse} between the AO of the estimate and that of the truth')


# --- Found ---

# Name, channel, kind of depth, size, field of view, space of the normals, pixel aspect.
FOUND = [
    ('usual', 'Z', 'planar', (160, 90), 60, 'world', 1),
    ('narrow', 'Z', 'planar', (200, 120), 33, 'world', 1),
    ('wide', 'Z', 'planar', (160, 100), 94, 'world', 1),
    ('square and small', 'Z', 'planar', (96, 96), 50, 'world', 1),
    ('pixels not square', 'Z', 'planar', (160, 120), 47, 'world', 1.5),
    ('camera normals', 'Z', 'planar', (160, 90), 71, 'camera', 1),
    ('radial', 'Z', 'radial', (160, 90), 65, 'world', 1),
    ('inverse', 'Z', 'inverse', (160, 90), 55, 'world', 1),
    ('Mitsuba', 'dd.y.T', 'radial-near', (160, 90), 62, 'world', 1),
]


@cases(FOUND)
def camera_is_found(scratch, name, channel, kind, size, fov, space, aspect):
    scene = Scene(*size, fov, aspect)
    write_exr(scratch.path('in.exr'), {channel: scene.depth(kind), **scene.normals(space=space)},
              attributes=[('PixelAspectRatio', float(aspect))])
    view, said = inspect(scratch)
    camera = view['camera']
    matches(r'^estimated, \+-0?\.?\d+ %$', camera['source'], 'the source')
    error = half_width(camera['fov_x_deg']) / half_width(fov) - 1
    check(abs(error) < 0.01, f'{name}: {camera["fov_x_deg"]} degrees, want {fov}')
    equal(view['conventions']['depth_type'], kind, 'depth type')
    equal(view['conventions']['normal_space'], space, 'normal space')
    equal(camera['rotation'], 'estimated' if space == 'world' else 'unknown', 'rotation')
    matches(r'warning: in\.exr: no camera in the header; by depth and normals it is \d', said,
            'the warning')
    near = ('--near', NEAR) if kind == 'radial-near' else ()
    if near:
        check(abs(camera['near'] / NEAR - 1) < 0.05, f'near is {camera["near"]}, want {NEAR}')
    write_camera(scratch.path('c.json'), {
        'fov_x_deg': fov, 'world_to_view': [[*row, 0] for row in TURN] + [[0, 0, 0, 1]]})
    check_same_ao(scratch, ('--camera', 'c.json', '--depth-type', kind, *near), name)


def smooth_things_on_a_floor(width, height, fov):
    """Depth and world normals of balls on a floor, seen from above. Of the balls the normals are
    shaded smooth: off by a degree or so, where those of the floor are exact."""
    scene, random = Scene(width, height, fov), np.random.default_rng(3)
    up = np.array([0, np.cos(0.6), np.sin(0.6)])
    across, away = np.array([1.0, 0, 0]), np.array([0, np.sin(0.6), -np.cos(0.6)])
    ray = np.stack([scene.x, scene.y, -np.ones_like(scene.x)], axis=-1)
    z, normal = -4 / (ray @ up), np.broadcast_to(up, ray.shape)
    for _ in range(12):
        x, y, radius = random.uniform([-2.5, 4, 0.3], [2.5, 8, 0.8])
        ball = across * x + away * y + up * (radius - 4)
        along, square = ray @ ball, scene.stretch ** 2
        with np.errstate(invalid='ignore'):
            at = (along - np.sqrt(along ** 2 - square * (ball @ ball - radius ** 2))) / square
        is_hit = (at > 0) & (at < z)
        round_one = (ray * at[..., None] - ball) / radius
        shaded = round_one + 0.03 * np.sin(20 * round_one[..., [1, 2, 0]])
        z = np.where(is_hit, at, z)
        normal = np.where(is_hit[..., None],
                          shaded / np.linalg.norm(shaded, axis=-1, keepdims=True), normal)
    return {'Z': z.astype(np.float32), **{f'N.{c}': (normal @ TURN)[..., i].astype(np.float32)
                                          for i, c in enumerate('XYZ')}}


@cases([(320, 200, 39.6), (240, 240, 55.0), (400, 225, 73.7)])
def floor_beneath_smooth_things_does_not_decide_alone(scratch, width, height, fov):
    write_exr(scratch.path('in.exr'), smooth_things_on_a_floor(width, height, fov))
    view, _ = inspect(scratch)
    camera = view['camera']
    matches(r'^estimated, \+-0?\.?\d+ %$', camera['source'], 'the source')
    error = half_width(camera['fov_x_deg']) / half_width(fov) - 1
    check(abs(error) < 0.01, f'{camera["fov_x_deg"]} degrees, want {fov}')
    equal(camera['rotation'], 'estimated', 'rotation')


@case
def cut_data_window_is_seen_in_its_display(scratch):
    scene, cut = Scene(200, 120, 66), (slice(30, 120), slice(20, 170))
    channels = {'Z': scene.depth(), **scene.normals(space='world')}
    write_exr(scratch.path('in.exr'), {k: v[cut] for k, v in channels.items()}, x=20, y=30,
              display=(0, 0, 199, 119))
    camera = inspect(scratch)[0]['camera']
    check(abs(half_width(camera['fov_x_deg']) / half_width(66) - 1) < 0.01,
          f'{camera["fov_x_deg"]} degrees, want 66')


@cases([('half', np.float16), ('halves in float', np.float32)])
def half_floats_are_enough(scratch, _, stored):
    scene = Scene(240, 160, 52)
    channels = {'Z': scene.depth(), **scene.normals(space='world')}
    channels = {k: np.where(np.isfinite(v), np.minimum(v, 65504), v).astype(np.float16)
                for k, v in channels.items()}
    write_exr(scratch.path('in.exr'), {k: v.astype(stored) for k, v in channels.items()})
    camera = inspect(scratch)[0]['camera']
    matches('^estimated', camera['source'], 'the source')
    check(abs(half_width(camera['fov_x_deg']) / half_width(52) - 1) < 0.02,
          f'{camera["fov_x_deg"]} degrees, want 52')


@case
def rotation_is_found_for_a_given_field_of_view(scratch):
    scene = Scene()
    write_exr(scratch.path('in.exr'), {'Z': scene.depth(), **scene.normals(space='world')})
    view, _ = inspect(scratch, '--fov', FOV)
    equal((view['camera']['source'], view['camera']['rotation'],
           view['conventions']['normal_space']), ('--fov', 'estimated', 'world'), 'what is used')
    write_camera(scratch.path('c.json'))
    results = []
    for options in (('--fov', FOV), ('--camera', 'c.json')):
        scratch.render('in.exr', '-o', 'ao.exr', *BASE, *options)
        results.append(read_ao(scratch.path('ao.exr')))
    check_close(results[0], results[1], 0.07, 1e-3, 'AO')


# --- Told ---

@case
def panoramas_are_refused_and_headers_contradicted(scratch):
    scene = Scene()
    channels = {'Z': scene.depth(), **scene.normals()}
    write_exr(scratch.path('in.exr'), channels,
              attributes=[('cameraFov', 360.0), ('cameraProjection', 4)])
    scratch.fails(CHANNELS, 'in.exr: cameraProjection is 4 in the header', 'in.exr', '-o', 'a.exr',
                  hint='--fov, --ortho or --camera')
    camera = inspect(scratch, code=CHANNELS)[0]['camera']
    equal(camera, {'unsupported': 'cameraProjection is 4'}, 'the camera')
    equal(inspect(scratch, '--fov', 60)[0]['camera']['source'], '--fov', 'source with --fov')
    write_exr(scratch.path('in.exr'), channels,
              attributes=[('cameraFov', 60.0), ('cameraAperture', 36.0),
                          ('cameraFocalLength', 18.0)])
    view, said = inspect(scratch)
    for text in (view['camera']['remark'], said):
        matches('cameraFocalLength says 90 degrees, cameraFov 60: cameraFov is taken', text, 'it')


@cases([('a little', 0.1), ('much', 0.2)])
def uncertain_estimate_is_better_than_none(scratch, _, amount):
    # Bumps as fine as texels: how far off it may be is said, and so it is.
    scene = Scene()
    n = scene.normal + np.random.default_rng(1).normal(0, amount, scene.normal.shape)
    n = np.where(scene.sky[..., None], 0, n / np.linalg.norm(n, axis=-1, keepdims=True)) @ TURN
    normals = {f'N.{c}': n[..., i].astype(np.float32) for i, c in enumerate('XYZ')}
    write_exr(scratch.path('in.exr'), {'Z': scene.depth(), **normals})
    view, said = inspect(scratch)
    bound = float(re.fullmatch(r'estimated, \+-(\d+) %', view['camera']['source'])[1]) / 100
    check(bound > 0.02, f'{bound} is called uncertain')
    error = half_width(view['camera']['fov_x_deg']) / half_width(FOV) - 1
    check(abs(error) < bound + 0.005, f'{view["camera"]["fov_x_deg"]} degrees +-{bound}')
    matches(r'by depth and normals it is perhaps \d.*: the field of view is uncertain by', said,
            'the warning')
    matches('uncertain: the field of view', view['camera']['remark'], 'the remark')


def what_is_doubted(scratch, fov, scene, cut=None, **layout):
    channels = {'Z': scene.depth(), **scene.normals(space='world')}
    write_exr(scratch.path('in.exr'), {k: v[cut] if cut else v for k, v in channels.items()},
              attributes=[('cameraFov', 'float', fov)], **layout)
    view, said = inspect(scratch)
    equal(view['camera']['source'], 'cameraFov', 'source')
    return [line for line in said.splitlines() if 'cameraFov says' in line]


@cases([('right', 60, 60, False), ('too narrow', 48, 60, True), ('too wide', 75, 60, True),
        ('wide', 105, 90, True), ('nearly right', 60.5, 60, False)])
def header_that_the_image_contradicts_is_said(scratch, _, told, true, is_said):
    said = what_is_doubted(scratch, told, Scene(fov=true))
    equal(len(said), is_said, f'number of doubts: {said}')
    for line in said:
        matches(rf'says {told} degrees .*, but depth and normals ({true}|{true - 1}\.9\d*|'
                rf'{true}\.\d+) degrees .*that of cameraFov is taken \(--fov', line, 'the doubt')


@cases([('right', 60, False), ('nearly right', 61, False), ('too narrow', 48, True),
        ('too wide', 75, True)])
def view_is_named_by_the_rotation_that_is_told(scratch, _, told, is_said):
    # Of boards with rough shading the floor alone has the normals of depth: it fits any view that
    # may be turned.
    depth, channels = boards(320, 180)
    normals = np.stack(list(channels.values()), axis=-1)
    rough = normals + np.random.default_rng(3).normal(size=normals.shape) * 0.4
    rough /= np.linalg.norm(rough, axis=-1, keepdims=True)
    is_floor = normals @ normals[0, 0] > 0.999
    normals = np.where(is_floor[..., None], normals, rough) @ TURN
    write_exr(scratch.path('in.exr'), {'Z': depth, **{
        f'N.{c}': normals[..., i].astype(np.float32) for i, c in enumerate('XYZ')}})
    write_camera(scratch.path('c.json'), camera(told))
    said = str(inspect(scratch, '--camera', 'c.json')[0]['warnings'])
    equal(f'camera file says {told} degrees' in said, is_said, said)
    if is_said:
        matches(r'turned as they are normals fit perhaps (59|60)\.\d+ degrees', said, 'the doubt')


@case
def lens_shift_that_the_header_lacks_is_said(scratch):
    # A crop that lost its display window looks to the side.
    scene, cut = Scene(200, 120, 66), (slice(30, 120), slice(50, 200))
    said = what_is_doubted(scratch, 66, scene, cut)
    equal(len(said), 1, f'number of doubts: {said}')
    matches(r'depth and normals 5[12].* degrees .*, shift 0\.1[67]', said[0], 'the doubt')
    equal(what_is_doubted(scratch, 66, scene, cut, x=50, y=30, display=(0, 0, 199, 119)), [],
          'doubts with its display window')


@cases([('to the side', (0.1, 0)), ('upwards', (0, 0.2))])
def lens_shift_that_the_image_contradicts_is_named(scratch, _, shift):
    scene = Scene(200, 120, 66)
    write_exr(scratch.path('in.exr'), {'Z': scene.depth(), **scene.normals(space='world')})
    write_camera(scratch.path('c.json'), camera(66, shift_x=shift[0], shift_y=shift[1]))
    said = str(inspect(scratch, '--camera', 'c.json')[0]['warnings'])
    matches(rf'says 66 degrees .*, shift {shift[0]:g} {shift[1]:g}, but depth and normals '
            r'6[56].* degrees .*, shift \S+ \S+ .* is taken \("shift_x" and "shift_y" in a camera',
            said, 'the warnings')


@cases([('alone', '0.2', {}, 72.7), ('as per cent', '20', {}, 72.7),
        ('outside of the display', '0.2', {'display': (10, 5, 149, 84)}, 63.0)])
def overscan_of_unreal_widens_the_view(scratch, _, percentage, layout, fov):
    write_exr(scratch.path('in.exr'), {'Z': Scene().depth()},
              attributes=[('unreal/camera/Cam/fov', '63.0'),
                          ('unreal/camera/overscanPercentage', percentage)], **layout)
    view, said = inspect(scratch)
    check(abs(view['camera']['fov_x_deg'] - fov) < 0.05, f'{view["camera"]["fov_x_deg"]}')
    equal('with an overscan of 20 %' in said, fov > 63, f'whether it is said in {said}')


@case
def radial_depth_from_a_near_plane_needs_no_name_for_it(scratch):
    scene = Scene(fov=100)
    write_exr(scratch.path('in.exr'), {'Z': scene.depth('radial-near'), **scene.normals()},
              attributes=[('cameraFov', 'float', 100)])
    view, _ = inspect(scratch)
    equal(view['conventions']['depth_type'], 'radial-near', 'depth type')
    check(abs(view['camera']['near'] / NEAR - 1) < 0.05, f'near is {view["camera"]["near"]}')


@cases([('right', NEAR, NEAR, False), ('too far', NEAR, 2 * NEAR, True),
        ('too near', NEAR, 0.1, True), ('of another file', 0.0, NEAR, True),
        ('nearly right', NEAR, 1.02 * NEAR, False)])
def near_plane_that_the_image_contradicts_is_said(scratch, _, true, told, is_said):
    scene = Scene()
    for channel in ('dd.y.T', 'Z'):
        if channel == 'Z' and not true > 0:
            continue  # radial then, whatever is told
        write_exr(scratch.path('in.exr'), {channel: scene.depth('radial-near', near=true),
                                           **scene.normals(space='world')})
        write_camera(scratch.path('camera.json'), camera(near=told))
        view, said = inspect(scratch, '--camera', 'camera.json')
        equal((view['conventions']['depth_type'], view['camera']['near']), ('radial-near', told),
              'depth type and near plane')
        doubts = re.findall(r'said to be at (\S+), but depth and normals are those of one at '
                            r'(\S+): \1 is taken \(--near, or a camera file without', said)
        equal([float(by_told) for by_told, _ in doubts], [told] if is_said else [],
              f'doubts in {said}')
        check(all(abs(float(by_seen) - true) < 0.02 for _, by_seen in doubts), said)


def rough_crop(scratch, bumps, window):
    """Of an image whose normals have bumps, with the right camera."""
    (x, y, width, height), (columns, rows), fov = window, (400, 225), 66
    scene = Scene(columns, rows, fov)
    n = scene.normal + np.random.default_rng(0).normal(0, bumps, scene.normal.shape)
    n = np.where(scene.sky[..., None], 0, n / np.linalg.norm(n, axis=-1, keepdims=True))
    channels = {'Z': scene.depth(),
                **{f'N.{c}': n[..., i].astype(np.float32) for i, c in enumerate('XYZ')}}
    cut = slice(y, y + height), slice(x, x + width)
    write_exr(scratch.path('in.exr'),
              {k: np.ascontiguousarray(v[cut]) for k, v in channels.items()})
    across = half_width(fov) * width / columns
    write_camera(scratch.path('c.json'), {
        'fov_x_deg': 2 * np.degrees(np.arctan(across)),
        'shift_x': (x + (width - columns) / 2) / width,
        'shift_y': ((rows - height) / 2 - y) / height})
    return str(inspect(scratch, '--camera', 'c.json')[0]['warnings'])


@case
def patches_of_normals_do_not_outvote_single_ones(scratch):
    # Bumps cancel out in patches, whichever camera they are held against.
    said = rough_crop(scratch, 0.1, (100, 30, 200, 112))
    check('depth and normals' not in said, said)


@case
def curve_that_betters_a_wrong_camera_alone_is_none(scratch):
    said = rough_crop(scratch, 0.03, (120, 100, 200, 112))
    check('looks squeezed' not in said, said)


# Channel, what it holds, what --depth-type says or None: its name says it; what overrides it.
TYPES = [
    ('Z', 'radial', 'planar', 'radial'),
    ('Z', 'radial-near', 'planar', 'radial-near'),
    ('Z', 'inverse', 'planar', 'inverse'),
    ('Z', 'device', 'planar', 'device with --near and --far'),
    ('Z', 'planar', 'radial', 'planar'),
    ('Z', 'planar', 'radial-near', 'planar'),
    ('Z', 'radial', 'inverse', 'radial'),
    ('Z', 'planar', 'device', 'planar'),
    ('distance', 'planar', None, 'planar'),
    ('dd.y.T', 'planar', None, 'planar'),
    ('linearZ.R', 'radial', None, 'radial'),
]


@cases(TYPES, name=lambda row: ' '.join(str(x) for x in row[:3]))
def depth_type_that_the_image_contradicts_is_said(scratch, channel, true, told, remedy):
    scene = Scene()
    write_exr(scratch.path('in.exr'), {channel: scene.depth(true), **scene.normals(space='world')})
    write_camera(scratch.path('c.json'))
    options = ('--depth-type', told) if told else ()
    said = scratch.run('inspect', 'in.exr', '--camera', 'c.json', *options).stdout
    by, name = ('--depth-type', told) if told else ('its name', r'\S+')
    matches(rf"in\.exr: {by} says that depth '{channel}' is {name}, but by normals 'N' it is "
            rf'{remedy.split()[0]} \((9\d|100) % of them agree then, and \d+ % as it says\): '
            rf'{name} is taken \(--depth-type {remedy} overrides\)', said, 'the warnings')
    for other in ('as wide as high', 'that of camera file is taken', 'looks squeezed'):
        check(other not in said, f'{other}: {said}')
    said = scratch.run('inspect', 'in.exr', '--camera', 'c.json', '--depth-type', true).stdout
    check('says that' not in said, f'the right type is doubted: {said}')


@case
def near_plane_that_radial_leaves_out_is_said(scratch):
    scene = Scene()
    for kind, is_said in (('radial-near', True), ('radial', False)):
        write_exr(scratch.path('in.exr'),
                  {'Z': scene.depth(kind), **scene.normals(space='world')})
        write_camera(scratch.path('c.json'))
        said = inspect(scratch, '--camera', 'c.json', '--depth-type', 'radial')[1]
        matched = re.search(r"depth 'Z' is said to be radial, but depth and normals are those of "
                            r'distances from a near plane at 0\.(5|49)\d*: radial is taken '
                            r'\(--depth-type radial-near with --near 0\.', said)
        equal(matched is not None, is_said, f'{kind}: {said}')


@cases([('planar', 'planar', 0.6), ('planar', 'planar', 1.6), ('planar', None, 1.6),
        ('radial', 'radial', 0.6), ('radial', 'radial', 1.6), ('radial', 'radial', 1.25)])
def wrong_field_of_view_is_no_squeeze_and_no_type(scratch, kind, told, times):
    scene = Scene(320, 180)
    write_exr(scratch.path('in.exr'), {'Z': scene.depth(kind), **scene.normals(space='world')})
    fov = np.degrees(2 * np.arctan(half_width(FOV) * times))
    said = inspect(scratch, '--fov', fov, *(('--depth-type', told) if told else ()))[1]
    matches(r'--fov says .*, but depth and normals (60|59\.9)\S* degrees', said, 'the warnings')
    check('as wide as high' not in said and 'says that depth' not in said, said)


@cases([('a half', (320, 180), True), ('a third', (480, 270), True), ('a cut', (320, 200), False),
        ('all of it', (160, 90), False)])
def proxy_in_the_display_of_the_whole_is_said(scratch, _, size, is_said):
    write_exr(scratch.path('in.exr'), {'Z': Scene().depth()},
              display=(0, 0, size[0] - 1, size[1] - 1))
    said = inspect(scratch, '--fov', FOV)[1]
    equal('as in a proxy, camera and AO are wrong' in said, is_said, said)


# --- Sequences ---

def frames_of(scratch, fovs):
    """A ball moves a little from frame to frame; None: a frame that tells nothing."""
    for i, fov in enumerate(fovs):
        scene = Scene(160, 90, fov or 60, eye=0.02 * i)
        channels = one_plane() if fov is None \
            else {'Z': scene.depth(), **scene.normals(space='world')}
        write_exr(scratch.path(f'in.{i + 1:04}.exr'), channels)
    got = scratch.render('in.####.exr', '-o', 'ao.####.exr', '--radius', RADIUS)
    used = []
    for i in range(len(fovs)):
        part = read_parts(scratch.path(f'ao.{i + 1:04}.exr'))[0]
        used.append(json.loads(part.attributes['vkao/params'])['camera']['half_width'])
    return used, got.stderr


@case
def frames_keep_the_camera_of_the_first(scratch):
    used, said = frames_of(scratch, (60, 60, None, 60))
    equal(used, [used[0]] * 4, 'half widths')
    matches(r'in\.0003\.exr: this frame does not tell the camera', said, 'the warning')


@case
def a_zoom_is_followed(scratch):
    used, said = frames_of(scratch, (60, 64, 40))
    for half, fov in zip(used, (60, 64, 40)):
        check(abs(half / half_width(fov) - 1) < 0.01, f'{half}, want {half_width(fov)}')
    matches('another camera than that of the frames before', said, 'the warning')


@cases([('header', (), [('cameraFov', 'float', 60.0)]), ('option', ('--fov', 60), []),
        ('file', ('--camera', 'camera.json'), [])])
def a_zoom_that_nobody_tells_is_said_where_it_begins(scratch, _, options, attributes):
    write_camera(scratch.path('camera.json'), camera(fov=60))
    for i, fov in enumerate((60, 60, 40, 40, 60, 40)):
        scene = Scene(160, 90, fov, eye=0.02 * i)
        write_exr(scratch.path(f'in.{i + 1:04}.exr'),
                  {'Z': scene.depth(), **scene.normals(space='world')}, attributes=attributes)
    said = scratch.render('in.####.exr', '-o', 'ao.####.exr', *BASE, *options).stderr
    equal(re.findall(r'in\.(\d+)\.exr: .* says 60 degrees .*, but depth and normals (?:40|39\.9)',
                     said), ['0003', '0006'], f'doubted frames in {said}')


@case
def another_depth_than_told_is_said_where_it_begins(scratch):
    write_camera(scratch.path('camera.json'))
    for i, kind in enumerate(('planar', 'planar', 'radial', 'radial', 'planar', 'radial')):
        scene = Scene(eye=0.02 * i)
        write_exr(scratch.path(f'in.{i + 1:04}.exr'),
                  {'Z': scene.depth(kind), **scene.normals(space='world')})
    said = scratch.render('in.####.exr', '-o', 'ao.####.exr', *BASE, '--camera', 'camera.json',
                          '--depth-type', 'planar').stderr
    equal(re.findall(r"in\.(\d+)\.exr: --depth-type says that depth 'Z' is planar, but", said),
          ['0003', '0006'], f'doubted frames in {said}')


# --- Not found, and not asked ---

def one_plane():
    scene = Scene()
    floor = scene.normal[..., 1] > 0.999
    depth = np.where(floor, scene.depth(), np.float32(1e10))
    return {'Z': depth, **scene.normals(space='world')}


def noisy_normals():
    scene = Scene()
    noise = np.random.default_rng(5).normal(0, 1, scene.normal.shape)
    noise /= np.linalg.norm(noise, axis=-1, keepdims=True)
    return {'Z': scene.depth(),
            **{f'N.{c}': noise[..., i].astype(np.float32) for i, c in enumerate('XYZ')}}


def corridor():
    """Seen along its axis: floor and walls look the same through any lens."""
    scene = Scene()
    ways = [(1 / np.abs(scene.x), 0), (0.7 / np.abs(scene.y), 1), (np.full_like(scene.x, 9.0), 2)]
    z = np.min([w for w, _ in ways], axis=0)
    normal = np.zeros((*z.shape, 3))
    for way, axis in ways:
        towards = [-np.sign(scene.x), -np.sign(scene.y), np.ones_like(z)][axis]
        normal[..., axis] = np.where(way <= z, towards, 0)
    return {'Z': z.astype(np.float32),
            **{f'N.{c}': normal[..., i].astype(np.float32) for i, c in enumerate('XYZ')}}


@cases([('one plane', one_plane), ('normals of something else', noisy_normals),
        ('a corridor seen straight on', corridor)])
def cannot_tell_is_said(scratch, _, make):
    write_exr(scratch.path('in.exr'), make())
    view, said = inspect(scratch)
    equal((view['camera']['source'], view['camera']['fov_x_deg']), ('assumed', 40), 'the camera')
    matches(r'no camera in the header, and the image does not tell it: .+; assuming 40 degrees.*'
            r'--fov or --camera', said, 'the warning')


@cases([('field of view', 35.0), ('wide', 88.0)])
def nothing_else_follows_from_a_wrong_field_of_view(scratch, _, fov):
    write_exr(scratch.path('in.exr'), {'Z': Scene().depth(), **Scene().normals(space='world')},
              attributes=[('cameraFov', fov)])
    said = inspect(scratch)[1]
    matches(r'cameraFov says .* but depth and normals 60\.?\d* degrees.*\(--fov 60\.?\d* or --cam',
            said, 'what is said')
    for word in 'need the rotation of the camera', 'nothing checks', 'is added':
        check(word not in said, f"'{word}' in {said}")


@cases([('less', -0.6, 'only if 0.6.* is added, which no option does'),
        ('more', 0.6, 'are not quite those that are stored.*does a lens distort')])
def offset_of_distances_is_said(scratch, _, by, wanted):
    channels = boxes_along_axes(CORNER, 320, 180)
    channels['Z'] = (channels['Z'] + by).astype(np.float32)
    write_exr(scratch.path('in.exr'), channels)
    said = inspect(scratch, '--fov', FOV)[1]
    matches(wanted, said, 'what is said')
    check('if -' not in said, said)


@case
def what_normals_do_not_check_is_said(scratch):
    for fov, make, wants in ((90, corridor, True), (FOV, lambda: {
            'Z': Scene().depth(), **Scene().normals()}, False)):
        write_exr(scratch.path('in.exr'), make(), attributes=[('cameraFov', float(fov))])
        said = inspect(scratch)[1]
        equal('nothing checks that of cameraFov' in said, wants, said)
        said = inspect(scratch, '--fov', fov)[1]
        equal('nothing checks' in said, False, said)


@cases([('twice as wide', 2, 1, '2'), ('twice as high', 1, 2, '0.(49|5)')])
def forgotten_shape_of_pixels_is_said(scratch, _, across, down, ratio):
    scene = Scene(320, 180)
    channels = {'Z': scene.depth(), **scene.normals(space='world')}
    channels = {n: np.ascontiguousarray(v[::down, ::across]) for n, v in channels.items()}
    for options in ((), ('--fov', FOV)):
        write_exr(scratch.path('in.exr'), channels)
        matches(f'a pixel is {ratio}[0-9.]* times as wide as high, and the header says 1:',
                inspect(scratch, *options)[1], 'what is said')
        write_exr(scratch.path('in.exr'), channels,
                  attributes=[('PixelAspectRatio', across / down)])
        said = inspect(scratch, *options)[1]
        check('as wide as high' not in said, said)


def hanging(*size, **view):
    boxes = [((i - 6, 2.8 - i * 0.3, -5 - i * 0.7), (i - 5.2, 9, -4.2 - i * 0.5))
             for i in range(5)]
    return boxes_along_axes(CORNER + boxes, *size, **view)


@cases([('four thirds', (240, 180), 4 / 3, '1.3'), ('three halves', (240, 203), 1.5, '1.(5|49)'),
        ('square', (320, 180), 1, '')])
def squeeze_that_looks_like_a_lens_shift_is_said(scratch, _, size, aspect, ratio):
    # Three directions of faces are as well those of a shift along one side.
    write_exr(scratch.path('in.exr'), hanging(*size, aspect=aspect))
    view, said = inspect(scratch)
    if ratio:
        matches(r'those of a lens shift of \S+ -?\d\S*, which is taken, and as well of pixels '
                f'that are {ratio}[0-9.]* times as wide as high, where the header says 1:.*'
                'pixelAspectRatio.*--camera', said, 'what is said')
    else:
        check('as wide as high' not in said, said)
    write_exr(scratch.path('in.exr'), hanging(*size, aspect=aspect),
              attributes=[('PixelAspectRatio', float(aspect))])
    view, said = inspect(scratch)
    check('as wide as high' not in said and 'lens shift' not in said, said)
    check(abs(view['camera']['fov_x_deg'] - FOV) < 0.5, f'{view["camera"]["fov_x_deg"]} degrees')


@case
def shift_of_both_sides_is_no_squeeze(scratch):
    write_exr(scratch.path('in.exr'), hanging(320, 180, shift=(0.12, 0.2)))
    said = inspect(scratch)[1]
    matches(r'field of view, shift 0\.12\S* 0\.2', said, 'the warning')
    check('as wide as high' not in said and 'lens shift' not in said, said)


@cases([('whole', 0, False), ('cut', 24, True)])
def cut_of_a_wall_with_many_boards_is_said(scratch, _, cut, is_said):
    # Seen nearly straight on, normals hardly turn, and patches of them mix those of boards.
    high = np.random.default_rng(1).random((12, 12)) * 0.4
    boards = [((x - 5.8, y - 2, -9.1), (x - 5.5, y - 1.7, -8.9 + high[i, j]))
              for i, x in enumerate(np.arange(12) * 0.5) for j, y in enumerate(np.arange(12) * 0.5)]
    a, b = np.radians(20), np.radians(-3)
    turn = np.array([[1, 0, 0], [0, np.cos(b), -np.sin(b)], [0, np.sin(b), np.cos(b)]]) @ \
        np.array([[np.cos(a), 0, -np.sin(a)], [0, 1, 0], [np.sin(a), 0, np.cos(a)]])
    channels = boxes_along_axes(CORNER + boards, 400, 225, turn=turn)
    write_exr(scratch.path('in.exr'),
              {n: np.ascontiguousarray(v[:, cut:]) for n, v in channels.items()})
    said = inspect(scratch, '--fov', FOV)[1]
    equal('but depth and normals' in said and ', shift 0.0319 ' in said, is_said, said)


@case
def depth_alone_assumes_a_camera(scratch):
    write_exr(scratch.path('in.exr'), {'Z': Scene().depth()})
    view, said = inspect(scratch)
    equal(view['camera']['source'], 'assumed', 'source')
    matches('no camera in the header; assuming 40 degrees', said, 'the warning')


@case
def explicit_cameras_and_headers_come_first(scratch):
    scene = Scene()
    channels = {'Z': scene.depth(), **scene.normals(space='world')}
    write_exr(scratch.path('in.exr'), channels, attributes=[('cameraFov', 50.0)])
    for options, source, fov in (((), 'cameraFov', 50), (('--fov', 70), '--fov', 70)):
        camera = inspect(scratch, *options)[0]['camera']
        equal(camera['source'], source, 'source')
        check(abs(camera['fov_x_deg'] - fov) < 1e-4, f'{camera["fov_x_deg"]}, want {fov}')


if __name__ == '__main__':
    main()
