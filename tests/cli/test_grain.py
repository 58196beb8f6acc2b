#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""How fine depth is: that it was filtered, blurred, enlarged, rounded or compressed with loss is
said."""
import numpy as np

from cli import CHANNELS, case, cases, check, equal, main, matches, write_exr
from evidence import depth_of, inspect
from scene import FOV, Scene


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


if __name__ == '__main__':
    main()
