#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Depth that ends or breaks where things go on, counts down, or was filled with one value, is
said."""
import numpy as np

from cli import case, cases, check, equal, main, matches, write_exr
from evidence import depth_of, inspect
from scene import CORNER, FOV, Scene, boxes_along_axes


def clamped(low, high):
    return lambda z: np.clip(z, low, high)


@cases([('as it is', clamped(0, np.inf), None),
        ('far, sky and all', clamped(0, 4.5), 'clamped: .* at its farthest value'),
        ('far, but for the sky', lambda z: np.where(z < 10, np.minimum(z, 4.5), 1e10),
         'clamped: .* at its farthest value'),
        ('near', clamped(3.2, np.inf), 'clamped: .* at its nearest value')],
       name=lambda row: row[0])
def depth_of_a_range_is_said(scratch, _, change, message):
    scene = Scene(320, 180)
    z = change(depth_of(scene, np.inf))
    for kind, depth in (('planar', z), ('inverse', 1 / z)):
        write_exr(scratch.path('in.exr'), {'Z': depth.astype(np.float32),
                                           **scene.normals(space='world')})
        said = str(inspect(scratch, '--fov', FOV, '--depth-type', kind)['warnings'])
        if message:
            matches(message, said, 'the warnings')
        else:
            check('clamped' not in said, said)


@cases([('slanted', 18, True), ('seen straight on', 0, False)])
def depth_of_a_clamped_wall_is_said(scratch, _, degrees, is_said):
    # All of what is clamped has one normal, as what faces the camera does.
    turn = np.radians(degrees)
    turn = np.array([[np.cos(turn), 0, -np.sin(turn)], [0, 1, 0], [np.sin(turn), 0, np.cos(turn)]])
    channels = boxes_along_axes([((-20, -20, -7), (20, 20, -6)), ((-2.5, -1.5, -5), (-1.5, 0, -4)),
                                 ((0.6, 0.4, -5), (1.6, 1, -4))], 320, 180, turn=turn)
    for depth in (channels['Z'], np.minimum(channels['Z'], np.percentile(channels['Z'], 80))):
        write_exr(scratch.path('in.exr'), {**channels, 'Z': depth})
        said = str(inspect(scratch, '--fov', FOV)['warnings'])
        equal('clamped: ' in said, is_said and depth is not channels['Z'], said)


@case
def things_where_depth_has_nothing_are_said(scratch):
    # A curtain hangs before the wall, which a far plane cuts off.
    scene = Scene(320, 180)
    fold = np.where(np.arange(320) // 8 % 2, 0.6, -0.6) * np.ones((180, 1))
    curtain = np.stack([fold, 0 * fold, 0 * fold + 0.8], axis=-1)
    is_cut = scene.z > 4.5
    depth = np.where(is_cut, 1e10, scene.z).astype(np.float32)
    for is_shown in (True, False):
        scene.normal = np.where(is_cut[..., None], curtain * is_shown, scene.normal)
        write_exr(scratch.path('in.exr'), {'Z': depth, **scene.normals()})
        said = str(inspect(scratch, '--fov', FOV)['warnings'])
        equal('has nothing at' in said, is_shown, f'whether it is in {said}')
    # What the user takes out is no fault of the depth.
    scene.normal = np.where(is_cut[..., None], curtain, scene.normal)
    texel = 10 * np.tan(np.radians(FOV / 2)) / 320
    folded = np.where(is_cut, 5 + np.cumsum(fold * 0.75 / 0.6 * texel, axis=1), scene.z)
    write_exr(scratch.path('in.exr'),
              {'Z': folded.astype(np.float32), 'matte': is_cut.astype(np.float32),
               **scene.normals()})
    for options, is_doubted in (('--no-cast', 'matte'), False), (('--background', 4.5), True):
        said = scratch.render('in.exr', '-o', f'out{options[0]}.exr', '--fov', FOV, *options).stderr
        check('has nothing at' not in said, f'{options}: {said}')
        # By a distance that may be wrong; nothing else tells, as the curtain hangs before a gap.
        equal('--background 4.5 leaves nothing at' in said, is_doubted, f'whether it is in {said}')


@cases([('a wall', 6.0, (0, 0, 1)), ('nothing', 1e10, (0, 0.8, 0.6)), ('a dome', 1e10, None)])
def normals_of_what_is_at_one_value_may_be_its_own(scratch, _, value, normal):
    # Walls seen straight on, and skies that are written with normals: of one way, or to the eye.
    scene = Scene(320, 180)
    to_eye = -np.stack([scene.x, scene.y, -np.ones_like(scene.x)], -1) / scene.stretch[..., None]
    scene.normal = np.where(scene.sky[..., None], to_eye if normal is None else normal,
                            scene.normal)
    depth = depth_of(scene, value)
    write_exr(scratch.path('in.exr'), {'Z': depth, **scene.normals()})
    said = str(inspect(scratch, '--fov', FOV)['warnings'])
    check('clamped' not in said and 'has nothing' not in said, said)


@cases([('a matte', 4.0, True), ('a card that faces the camera', 4.0, False)])
def depth_that_was_filled_is_said(scratch, _, value, is_said):
    # Neither nearest nor farthest: the box of a volume, before what normals show.
    scene = Scene(320, 180)
    filled = (np.abs(scene.x) < 0.35) & (np.abs(scene.y + 0.1) < 0.16)
    depth = np.where(filled, value, depth_of(scene, 1e10)).astype(np.float32)
    if not is_said:
        scene.normal = np.where(filled[..., None], [0, 0, 1], scene.normal)
    write_exr(scratch.path('in.exr'), {'Z': depth, **scene.normals()})
    said = str(inspect(scratch, '--fov', FOV)['warnings'])
    equal('of the depth are all at 4, where normals' in said, is_said, f'whether it is in {said}')


@cases([('counted down', 12.0, True), ('as it is', 0, False)])
def depth_that_counts_down_is_said(scratch, _, far, is_said):
    # White is near, in scene units: flat things tell without any normals.
    scene = Scene()
    depth = np.where(scene.sky, 0, far - scene.z if far else scene.z).astype(np.float32)
    write_exr(scratch.path('in.exr'), {'Z': depth})
    said = str(inspect(scratch, '--fov', FOV)['warnings'])
    if is_said:
        matches(r'counted down .*: flat things are flat only as distances of 12(\.[01]\d*)? less',
                said, 'the warnings')
    else:
        check('counted down' not in said, said)


@cases([('of tiles', slice(63, None, 64), True), ('of lost lines', slice(150, 154), True),
        ('none', slice(0), False)])
def lines_without_depth_are_said(scratch, _, lines, is_said):
    scene = Scene(320, 180)
    depth, normals = depth_of(scene, 1e10), scene.normals()
    depth[lines] = 1e10
    for plane in normals.values():
        plane[lines] = 0
    for channels in ({'Z': depth}, {'Z': depth, **normals}):
        write_exr(scratch.path('in.exr'), channels)
        said = str(inspect(scratch, '--fov', FOV)['warnings'])
        equal('seams of tiles, or lines that were lost' in said, is_said, f'whether in {said}')


@case
def gaps_of_a_fence_are_no_seams(scratch):
    # Boards from one side to the other, all as far away, and sky between them.
    depth = np.where(np.arange(180)[:, None] % 12 < 3, np.inf, 5) * np.ones((1, 320))
    depth[:9] = depth[-9:] = 8 + np.arange(320) / 100
    write_exr(scratch.path('in.exr'), {'Z': depth.astype(np.float32)})
    said = str(inspect(scratch, '--fov', FOV)['warnings'])
    check('seams of tiles' not in said, said)


# --- Breaks ---

def room(**more):
    """A corner of a room with boxes in it: edges of depth, and of normals, in all directions."""
    boxes = [((i - 6, 2.8 - i * 0.3, -5 - i * 0.7), (i - 5.2, 9, -4.2 - i * 0.5)) for i in range(5)]
    return boxes_along_axes(CORNER + boxes, 384, 216, **more)


def put(plane, other, rows, columns):
    plane = plane.copy()
    plane[rows, columns] = other[rows, columns]
    return plane


ALL, RIGHT, LOWER = slice(None), slice(192, None), slice(100, None)
BREAKS = [('as it is', lambda d: d, None),
          ('half in feet', lambda d: put(d, d * 3.28, ALL, RIGHT), 'before column 192,'),
          ('lower part nearer', lambda d: put(d, d * 0.95, LOWER, ALL), 'before row 100,'),
          ('a bad column', lambda d: put(d, d * 0 + 3, ALL, 100), 'before column 100,'),
          ('a bucket', lambda d: put(d, np.roll(d, (9, 14), (0, 1)), slice(64, 96),
                                     slice(192, 224)), 'a bucket of 32 x 32 pixels at .192 64.,'),
          ('things behind a line', None, None)]


@cases(BREAKS, name=lambda row: row[0])
def breaks_along_lines_are_said(scratch, _, change, message):
    scene = room()
    if change:
        scene['Z'] = change(scene['Z']).astype(np.float32)
    else:
        # The front of a wall before another, upright and as wide as half of the image.
        wall = [((-9, -9, -9), (9, 9, -5)), ((-9, -9, -9), (0, 9, -3))]
        scene = boxes_along_axes(wall, 384, 216, turn=np.eye(3))
    write_exr(scratch.path('in.exr'), scene)
    for options in ('--fov', FOV), ():
        said = str(inspect(scratch, *options)['warnings'])
        equal('depth breaks' in said, message is not None, f'whether it is in {said}')
        if message:
            matches(message + r".* where normals 'N' go on", said, 'the warnings')


@cases([('down to the eye', lambda d: d, None),
        ('lower part in feet', lambda d: put(d, d * 3.28, slice(105, None), ALL),
         'before row 105,'),
        ('lower part nearer', lambda d: put(d, d * 0.95, slice(108, None), ALL),
         'before row 108,')], name=lambda row: row[0])
def ledges_at_the_height_of_the_eye_are_no_seam(scratch, _, change, message):
    # Both sides of a street have them, and houses of other streets beyond do not.
    walls = [((-9, -2, -60), (-3, 9, 0)), ((4, -2, -60), (9, 9, 0)), ((-50, -9, -90), (50, -2, 0)),
             ((-50, -2, -80), (50, 3, -70))]
    ledges = [((-3, -0.5, -40), (-2.7, 0, -6)), ((3.7, -0.5, -40), (4, 0, -6))]
    scene = boxes_along_axes(walls + ledges, 384, 216, turn=np.eye(3))
    scene['Z'] = change(scene['Z']).astype(np.float32)
    write_exr(scratch.path('in.exr'), scene)
    said = str(inspect(scratch, '--fov', FOV)['warnings'])
    equal('depth breaks' in said, message is not None, f'whether it is in {said}')
    if message:
        matches(message, said, 'the warnings')


if __name__ == '__main__':
    main()
