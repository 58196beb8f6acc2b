#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Images of parallel cameras: told, found by depth and normals, and taken for no others."""
import numpy as np

from cli import case, cases, check, equal, main, matches, read_ao, write_exr
from evidence import inspect_and_hear as inspect
from scene import RADIUS, TURN, Scene, boxes_along_axes

BASE = ('--radius', RADIUS, '--pixel-type', 'float', '--overwrite', 'always')

# z = a x + b y + c: few, and those that touch a dome.
CORNERS = ((0.7, 0.1, 5), (-0.6, 0.3, 5), (0.1, -0.9, 4.6), (0.2, 0.8, 5.2))
DOME = tuple((-0.5 * x, -0.5 * y, 5 + 0.25 * (x * x + y * y)) for x in (-2, -0.7, 0.6, 1.9)
             for y in (-1.2, 0.1, 1.3))


def corners(width, height, half, space, planes=CORNERS):
    """Boxes' corners seen by a parallel camera: z is the nearest of planes."""
    x = ((np.arange(width) + 0.5) / width * 2 - 1) * half
    y = (1 - (np.arange(height) + 0.5) / height * 2) * half * height / width
    x, y = np.meshgrid(x, y)
    z, normals = np.full_like(x, np.inf), np.zeros((height, width, 3))
    for a, b, c in planes:
        plane = a * x + b * y + c
        normal = np.array([a, b, 1]) / np.sqrt(a * a + b * b + 1)
        nearer = plane < z
        z = np.where(nearer, plane, z)
        normals = np.where(nearer[..., None], normal, normals)
    if space == 'world':
        normals = normals @ TURN
    return {'Z': z.astype(np.float32),
            **{f'N.{c}': normals[..., i].astype(np.float32) for i, c in enumerate('XYZ')}}


@cases([('world',), ('camera',)])
def parallel_camera_is_found(scratch, space):
    write_exr(scratch.path('in.exr'), corners(160, 100, 2.4, space))
    view, said = inspect(scratch)
    equal(view['camera']['type'], 'orthographic', 'type')
    check(abs(view['camera']['ortho_width'] / 4.8 - 1) < 0.01,
          f'width {view["camera"]["ortho_width"]}, want 4.8')
    matches('orthographic, width 4.8', said, 'the warning')


@cases([('fraction', lambda z: 15 * z / (15 + z), r'a z / \(a \+ z\)'),
        ('exponential', lambda z: 15 * (1 - np.exp(-z / 15)), r'a \(1 - exp\(-z / a\)\)')])
def squeezed_depth_of_a_parallel_camera_is_said(scratch, _, squeeze, name):
    # All of it only looks narrower.
    channels = corners(320, 200, 2.4, 'world')
    channels['Z'] = squeeze(channels['Z'])
    write_exr(scratch.path('in.exr'), channels)
    matches(rf"depth 'Z' looks squeezed, as {name} with a = 1[3-7]", inspect(scratch)[1],
            'the warning')


@cases([('perspective', ('--ortho', 7), True), ('parallel', ('--ortho', 4.8), False)])
def parallel_camera_of_another_image_is_said(scratch, kind, options, is_said):
    channels = {'Z': Scene().depth()} if kind == 'perspective' else corners(160, 100, 2.4, 'world')
    write_exr(scratch.path('in.exr'), {'Z': channels['Z']})
    said = inspect(scratch, *options)[1]
    equal("flat things of depth 'Z' are flat only as 1/z" in said, is_said, said)
    equal('if the image is in perspective after all, --fov DEGREES' in said, is_said, said)


NUKE = [('nuke/version', '15.1v2')]


@cases([('told', ('--ortho', 4.8), False, []), ('told, normals', ('--ortho', 4.8), True, []),
        ('Nuke, told', ('--ortho', 4.8), False, NUKE),
        ('Nuke, told, normals', ('--ortho', 4.8), True, NUKE),
        ('Nuke, a dome', (), True, NUKE), ('a dome', (), True, [])])
def inverse_depth_of_a_parallel_camera(scratch, name, options, has_normals, attributes):
    # What few planes show may be a view in perspective as well.
    planes = DOME if 'dome' in name else CORNERS
    channels = corners(160, 100, 2.4, 'camera', planes)
    channels = channels if has_normals else {'Z': channels['Z']}
    write_exr(scratch.path('true.exr'), channels)
    scratch.render('true.exr', '-o', 'true_ao.exr', *BASE, '--ortho', 4.8, '--depth-type', 'planar')
    channels['depth.Z'] = 1 / channels.pop('Z')
    write_exr(scratch.path('in.exr'), channels, attributes=attributes)
    view, said = inspect(scratch, *options)
    equal(view['conventions']['depth_type'], 'inverse', said)
    check('not as 1/z' not in said, said)
    scratch.render('in.exr', '-o', 'ao.exr', *BASE, *options)
    rmse = np.sqrt(np.mean((read_ao(scratch.path('ao.exr')).astype(np.float64) -
                            read_ao(scratch.path('true_ao.exr'))) ** 2))
    check(rmse < 0.01, f'RMSE {rmse}: {said}')


@case
def distances_of_a_parallel_camera_through_nuke(scratch):
    write_exr(scratch.path('in.exr'), {'depth.Z': corners(160, 100, 2.4, 'camera')['Z']},
              attributes=NUKE)
    view, said = inspect(scratch, '--ortho', 4.8)
    equal(view['conventions']['depth_type'], 'planar', said)
    matches('is taken as distances, not as 1/z', said, 'what is said')


@case
def perspective_is_no_inverse_depth_of_a_parallel_camera(scratch):
    write_exr(scratch.path('in.exr'), {'Z': Scene().depth(), **Scene().normals()})
    view, said = inspect(scratch, '--ortho', 7)
    matches(r'--ortho says orthographic, width 7, but depth and normals 60\.?\d* degrees.* '
            r'\(--fov 60\.?\d* or '
            '--camera overrides', said, 'what is said')
    equal(view['conventions']['depth_type'], 'planar', said)
    view, said = inspect(scratch)
    equal((view['camera']['type'], view['conventions']['depth_type']), ('perspective', 'planar'),
          said)


def tilted_boxes(background):
    """Boxes on a floor, and sky. All normals but those upwards are turned by 10 degrees: no camera
    has them, and 1/z without perspective fits best."""
    random, boxes = np.random.default_rng(0), [((-60, -3, -60), (60, -2, 60))]
    for _ in range(18):
        middle = random.uniform([-4, -2, -14], [5, 0, -3])
        size = random.uniform(0.15, 0.6, 3)
        boxes.append((middle - size, middle + size))
    channels = boxes_along_axes(boxes, 320, 180, turn=np.eye(3))
    channels['Z'] = np.where(channels['Z'] > 1e9, background, channels['Z']).astype(np.float32)
    y, z, floor = channels['N.Y'], channels['N.Z'], channels['N.Y'] > 0.9
    cosine, sine = np.cos(np.radians(10)), np.sin(np.radians(10))
    channels['N.Y'] = np.where(floor, y, cosine * y + sine * z).astype(np.float32)
    channels['N.Z'] = np.where(floor, z, cosine * z - sine * y).astype(np.float32)
    return channels


@cases([('1e10', 1e10), ('infinity', np.inf), ('a far plane', 5000)])
def nothing_is_at_the_largest_of_inverse_depth(scratch, _, background):
    write_exr(scratch.path('in.exr'), tilted_boxes(background))
    view, said = inspect(scratch)
    check(view['conventions']['depth_type'] != 'inverse', said)
    check('orthographic' not in view['camera']['type'], said)


@case
def inverse_depth_of_a_parallel_camera_before_a_sky(scratch):
    channels = corners(160, 100, 2.4, 'camera', DOME)
    sky = np.arange(100)[:, None] < 25
    channels = {name: np.where(sky, 0, plane).astype(np.float32)
                for name, plane in {**channels, 'Z': 1 / channels['Z']}.items()}
    write_exr(scratch.path('in.exr'), channels)
    view, said = inspect(scratch)
    equal((view['camera']['type'], view['conventions']['depth_type']), ('orthographic', 'inverse'),
          said)


@case
def parallel_image_whose_header_tells_a_field_of_view(scratch):
    # With normals that see it depth is no 1/z, which it would be through that.
    write_exr(scratch.path('in.exr'), corners(160, 100, 2.4, 'camera'),
              attributes=[('CameraFov', 50.0)])
    view, said = inspect(scratch)
    equal(view['conventions']['depth_type'], 'planar', said)
    matches(r'depth and normals orthographic, width 4\.8.*\(--ortho 4\.8 or --camera', said,
            'what is said')


if __name__ == '__main__':
    main()
