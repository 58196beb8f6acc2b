#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""How fine depth is: that it was filtered, blurred, enlarged, rounded or compressed with loss is
said."""
from functools import lru_cache

import numpy as np

from cli import CHANNELS, case, cases, check, equal, main, matches, write_exr
from evidence import depth_of, inspect
from scene import CORNER, FOV, NEAR, Scene, boards, boxes_along_axes


def texels_of(fine, size, pick):
    """Of each square of samples what pick makes of it."""
    height, width = fine.shape[0] // size, fine.shape[1] // size
    squares = fine.reshape(height, size, width, size).transpose(0, 2, 1, 3)
    return pick(squares.reshape(height, width, size * size)).astype(np.float32)


def centres_of(fine, size):
    return np.ascontiguousarray(fine[size // 2::size, size // 2::size].astype(np.float32))


def neighbours(depth, pick):
    padded = np.pad(depth, 1, mode='edge')
    height, width = depth.shape
    return pick(np.stack([padded[y:y + height, x:x + width] for y in range(3) for x in range(3)],
                         axis=-1))


def corridor(fov=100, width=320, height=180):
    """Pillars along both walls of a corridor: narrow things between near and far ones."""
    scene = Scene(width, height, fov=fov)
    x, y = np.abs(scene.x), scene.y
    with np.errstate(divide='ignore'):
        z = np.minimum.reduce([1.5 / x, 1.4 / np.maximum(-y, 1e-9), 1.3 / np.maximum(y, 1e-9),
                               np.full_like(x, 26.0)])
        for k in range(10):
            begin, end = 1.8 + 2.5 * k, 2.2 + 2.5 * k
            is_face, side = x * begin > 1.18, 1.18 / x
            z = np.where(is_face, np.minimum(z, begin), z)
            is_side = ~is_face & (side > begin) & (side < end)
            z = np.where(is_side, np.minimum(z, side), z)
    return z.astype(np.float32)


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


@cases(['planar', 'radial-near'])
def halves_in_floats_are_halves(scratch, kind):
    # As they are where half files were converted; nothing bends and nothing is noisy for that.
    scene = Scene(320, 180, fov=40)
    names = {'planar': 'Z', 'radial-near': 'dd.T'}
    depth = np.where(scene.sky, 0, scene.depth(kind)).astype(np.float16).astype(np.float32)
    write_exr(scratch.path('in.exr'), {names[kind]: depth, **scene.normals(space='world')})
    for options in ('--fov', 40, '--near', NEAR), ():
        said = str(inspect(scratch, *options)['warnings'])
        matches('depth is (HALF|in steps); at the median', said, 'the warnings')
        check('noisy' not in said and 'bend' not in said, said)


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


@lru_cache
def cards(width=320, height=180):
    """Squares of all tilts, standing before a wall: depth and normals, in camera space."""
    scene, random = Scene(width, height), np.random.default_rng(5)
    z, normal = np.full(scene.x.shape, np.inf), np.zeros(scene.x.shape + (3,))
    ray = np.stack([scene.x, scene.y, -np.ones_like(scene.x)], axis=-1)
    for k in range(25):
        n = np.append(random.uniform(-0.5, 0.5, 2), 1) if k else np.array([0.2, 0.1, 1])
        n /= np.linalg.norm(n)
        x, y, turn = *random.uniform(-0.5, 0.5, 2) * (1, 0.56), random.uniform(0, np.pi)
        distance = random.uniform(3, 6) if k else 9
        u = (scene.x - x) * np.cos(turn) + (scene.y - y) * np.sin(turn)
        v = (scene.y - y) * np.cos(turn) - (scene.x - x) * np.sin(turn)
        at = n @ np.array([x, y, -1]) * distance / (ray @ n)
        inside = ((np.maximum(np.abs(u), np.abs(v)) < 0.08) | (k == 0)) & (at < z)
        z, normal = np.where(inside, at, z), np.where(inside[..., None], n, normal)
    return z.astype(np.float32), {f'N.{c}': normal[..., i].astype(np.float32)
                                  for i, c in enumerate('XYZ')}


@cases([('with normals', True), ('without', False)])
def rubbish_where_alpha_is_0_is_not_filtered(scratch, _, has_normals):
    scene = Scene(400, 225)
    alpha = np.where(scene.sky, 0, 1).astype(np.float32)
    # Every fifth texel happens to lie between two runs of its row.
    runs = np.random.default_rng(2).uniform(0.1, 90, (225, 81)).repeat(5, axis=1)
    noise, place = runs[:, 3:403], np.arange(400) % 5
    noise = np.where(place == 2, (np.roll(noise, 1, 1) + np.roll(noise, -1, 1)) / 2, noise)
    depth = np.where(scene.sky, noise, scene.z).astype(np.float32)
    channels = {'Z': depth, **{c: alpha for c in 'RGBA'},
                **(scene.normals() if has_normals else {})}
    write_exr(scratch.path('in.exr'), channels)
    said = str(inspect(scratch, '--fov', FOV)['warnings'])
    check('filtered' not in said, said)


@case
def depth_of_a_corridor_is_not_filtered(scratch):
    for fov in (100, 70, 50):
        write_exr(scratch.path('in.exr'), {'Z': corridor(fov)})
        said = str(inspect(scratch, '--fov', fov)['warnings'])
        check('filtered' not in said, f'{fov} degrees: {said}')
    fine, _ = cards(1600, 900)
    write_exr(scratch.path('in.exr'), {'Z': texels_of(fine, 5, lambda s: s.mean(axis=-1))})
    matches('depth is filtered', str(inspect(scratch, '--fov', FOV)['warnings']), 'a mean')


PICKS = [('nearest', lambda s: s.min(axis=-1)), ('farthest', lambda s: s.max(axis=-1))]


@cases(PICKS)
def nearest_and_farthest_samples_are_said(scratch, which, pick):
    # Of a pixel's own samples, borders of depth are not those of normals.
    depth, normals = cards(1600, 900)
    normals = {n: centres_of(v, 5) for n, v in normals.items()}
    write_exr(scratch.path('in.exr'), {'Z': texels_of(depth, 5, pick), **normals})
    matches(f"that of the {which} of a pixel's samples", str(inspect(scratch)['warnings']), 'said')
    # Of neighbours too; and no ridge of a surface is a texel wide then.
    x, y = np.meshgrid(np.arange(320), np.arange(180))
    waves = (6 + 0.2 * np.sin(x / 7 + y / 31) * np.cos(y / 9)).astype(np.float32)
    for channels, depth in ((normals, centres_of(depth, 5)), ({}, waves)):
        write_exr(scratch.path('in.exr'), {'Z': neighbours(depth, pick), **channels})
        matches("depth is that of the nearest or the farthest of 3 x 3 pixels|of a pixel's samples",
                str(inspect(scratch, '--fov', FOV)['warnings']), 'neighbours')
        write_exr(scratch.path('in.exr'), {'Z': depth, **channels})
        said = str(inspect(scratch, '--fov', FOV)['warnings'])
        check('nearest' not in said and 'bend' not in said, said)


@case
def narrow_tops_before_a_floor_are_where_they_are(scratch):
    for width, height in (640, 360), (320, 180):
        depth, normals = boards(width, height)
        write_exr(scratch.path('in.exr'), {'Z': depth, **normals})
        said = str(inspect(scratch, '--fov', FOV)['warnings'])
        check('nearest' not in said and 'bend' not in said, said)
    depth, normals = boards(1600, 900)
    normals = {n: centres_of(v, 5) for n, v in normals.items()}
    write_exr(scratch.path('in.exr'),
              {'Z': texels_of(depth, 5, lambda s: s.min(axis=-1)), **normals})
    matches("that of the nearest of a pixel's samples",
            str(inspect(scratch, '--fov', FOV)['warnings']), 'said')


@cases([('a texel to the right', 0, 1), ('a texel to the left', 0, -1), ('a texel below', 1, 0),
        ('a texel above', -1, 0), ('6 texels to the right', 0, 6), ('8 texels above', -8, 0),
        ('3 texels to the left and 2 texels below', 2, -3),
        ('9 texels to the right and 7 texels below', 7, 9)])
def depth_and_normals_of_different_places_are_said(scratch, where, down, right):
    # Flat things, small and large, and round ones.
    scene = Scene(320, 180)
    for depth, normals in (cards(), cards(640, 360), (depth_of(scene, 1e10), scene.normals())):
        moved = np.roll(depth, (down, right), (0, 1))
        write_exr(scratch.path('in.exr'), {'Z': moved, **normals})
        said = str(inspect(scratch, '--fov', FOV, '--normal-space', 'camera')['warnings'])
        matches(f'of different places: depth lies about {where};', said, 'said')
        # What follows from it is not another fault.
        for other in 'nearest', 'bend', 'breaks', 'blurred', 'enlarged', 'strange':
            check(other not in said, f'{other}: {said}')
        write_exr(scratch.path('in.exr'), {'Z': depth, **normals})
        said = str(inspect(scratch, '--fov', FOV)['warnings'])
        check('places' not in said, said)


@cases([('5', 5), ('9', 9), ('20', 20)])
def depth_of_moving_things_is_said(scratch, _, length):
    # A shutter that is open evenly makes even ramps, as slanted faces are in 1/z.
    depth, normals = cards()
    mean = sum(np.roll(depth, k, 1) for k in range(length)) / np.float32(length)
    for channels in ({}, normals):
        write_exr(scratch.path('in.exr'), {'Z': mean.astype(np.float32), **channels})
        matches('depth is filtered|depth is blurred',
                str(inspect(scratch, '--fov', FOV)['warnings']), 'said')


def mean_of(*moves):
    return lambda plane: sum(np.roll(plane, move, (0, 1)) for move in moves) / len(moves)


def enlarged_evenly(plane, times=3):
    """With interpolation between the texels of a smaller image, each way."""
    for axis in (0, 1):
        count = plane.shape[axis] // times
        at = np.minimum(np.arange(plane.shape[axis]) / times, count - 1)
        first = np.minimum(at.astype(int), count - 2)
        part = np.expand_dims(at - first, list({0, 1} - {axis}))
        plane = np.take(plane, first * times, axis) * (1 - part) + \
            np.take(plane, (first + 1) * times, axis) * part
    return plane


@cases([('unchanged', mean_of((0, 0))), ('moving', mean_of((0, 0), (1, 1))),
        ('a lens', mean_of((0, 0), (0, 1), (1, 0), (0, -1), (-1, 0))),
        ('enlarged', enlarged_evenly)])
def ramps_that_normals_do_not_show_are_said(scratch, name, filtered):
    depth, normals = cards()
    for others in (lambda plane: plane, filtered):
        planes = {'Z': filtered(depth), **{n: others(p) for n, p in normals.items()}}
        write_exr(scratch.path('in.exr'), {n: p.astype(np.float32) for n, p in planes.items()})
        said = str(inspect(scratch, '--fov', FOV)['warnings'])
        equal('depth is filtered' in said, name != 'unchanged', f'whether it is in {said}')


@case
def wide_blur_is_seen_beside_borders_of_normals(scratch):
    depth, normals = cards()
    weights = np.exp(-np.arange(40) ** 2 / 200.0)
    write_exr(scratch.path('in.exr'), {'Z': blurred(depth, weights, (0, 1)), **normals})
    matches('depth is blurred, or filtered: flat things bend|depth is filtered',
            str(inspect(scratch, '--fov', FOV)['warnings']), 'said')


@cases([('as they are', 0), ('over pixels', 0.7), ('a texel', 1), ('two', 2), ('four', 4)])
def blurred_normals_are_said(scratch, _, deviation):
    depth, normals = cards()
    if deviation:
        weights = np.exp(-np.arange(4 * deviation) ** 2 / (2 * deviation ** 2))
        normals = {n: blurred(p, weights, (0, 1)) for n, p in normals.items()}
        length = np.sqrt(sum(p * p for p in normals.values()))
        normals = {n: p / np.maximum(length, 1e-6) for n, p in normals.items()}
    write_exr(scratch.path('in.exr'), {'Z': depth, **normals})
    said = str(inspect(scratch, '--fov', FOV)['warnings'])
    equal('are blurred (denoised, or enlarged)' in said, deviation >= 1, f'whether it is in {said}')
    equal('are averaged over pixels' in said, 0 < deviation < 1, f'whether it is in {said}')


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


@cases([('twice', 2, True), ('not at all', 1, False)])
def enlarged_normals_are_said(scratch, _, times, is_said):
    # Of round things, and of faces alone.
    scene = Scene(318, 180)
    boxes = [((i - 6, 2.8 - i * 0.3, -5 - i * 0.7), (i - 5.2, 9, -4.2 - i * 0.5)) for i in range(5)]
    for channels in ({'Z': depth_of(scene, 1e10), **scene.normals()},
                     boxes_along_axes(CORNER + boxes, 800, 450)):
        for name, plane in channels.items():
            if name != 'Z':
                small = plane[times // 2::times, times // 2::times]
                channels[name] = small.repeat(times, axis=0).repeat(times, axis=1)
        write_exr(scratch.path('in.exr'), channels)
        said = str(inspect(scratch, '--fov', FOV)['warnings'])
        equal(f"normals 'N' are enlarged {times} times" in said, is_said, f'whether in {said}')


def nearest_of(plane, rows, columns):
    """Of an image of so many rows and columns, enlarged to the size that it had."""
    for axis, count in enumerate((rows, columns)):
        size = plane.shape[axis]
        small = ((np.arange(count) + 0.5) * size / count).astype(int)
        plane = np.take(plane, small[np.arange(size) * count // size], axis)
    return plane


@cases([('two thirds', 2 / 3), ('three quarters', 3 / 4), ('two fifths', 2 / 5), ('all', 1)])
def normals_enlarged_by_no_whole_number_are_said(scratch, _, part):
    depth, normals = cards()
    depth, normals = depth[:-1, :-1], {n: p[:-1, :-1] for n, p in normals.items()}
    rows, columns = (int(size * part) for size in depth.shape)
    normals = {n: nearest_of(p, rows, columns) for n, p in normals.items()}
    write_exr(scratch.path('in.exr'), {'Z': depth, **normals})
    said = str(inspect(scratch, '--fov', FOV)['warnings'])
    equal('times without interpolation' in said, part < 1, f'whether it is in {said}')


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


@cases([('slanted faces', True), ('a mean', False)])
def coarse_mouldings_are_no_filter(scratch, _, are_faces):
    # Among posts a flight of faces, each of a texel, which slant away from the way across them.
    scene, along = Scene(), np.arange(160) % 40
    depth = np.full(scene.x.shape, 5.0)
    depth[:, (along < 27) & (along % 4 < 2)] = 3.5
    depth[:, along == 29], depth[:, along == 30] = 4.75, 4.5
    depth[:, along > 30] = 4.25
    place = np.stack([scene.x * depth, -depth], -1)
    way = np.roll(place, -1, 1) - np.roll(place, 1, 1)
    way /= np.linalg.norm(way, axis=-1, keepdims=True)
    normal = np.zeros(depth.shape + (3,))
    normal[..., 2] = 1
    is_face = (along == 29) | (along == 30)
    slant = np.stack([-way[..., 1], way[..., 0]], -1) * np.sqrt(1 - 0.33 ** 2) + way * 0.33
    if are_faces:
        normal[..., [0, 2]] = np.where(is_face[:, None], slant, normal[..., [0, 2]])
    write_exr(scratch.path('in.exr'), {'Z': depth.astype(np.float32), **{
        f'N.{c}': normal[..., i].astype(np.float32) for i, c in enumerate('XYZ')}})
    said = str(inspect(scratch, '--fov', FOV, '--normal-space', 'camera')['warnings'])
    equal('depth is filtered' in said, not are_faces, said)


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


if __name__ == '__main__':
    main()
