#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Depth from 0 to 1, and whole numbers: parts of a range or of a depth buffer are refused without
their ends, and ends that are told are held against what depth shows."""
import re

import numpy as np

from cli import CHANNELS, case, cases, check, equal, main, matches, read_ao, write_exr
from evidence import check_same, clean, depth_of, inspect, run
from scene import FAR, FOV, NEAR, Scene

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
def another_depth_is_named_where_one_is_refused(scratch):
    scene = Scene()
    grey = np.where(scene.sky, 1, (scene.z - 1.5) / 7.5).astype(np.float32)
    write_exr(scratch.path('in.exr'), {'depth.R': grey, 'Z': scene.depth('device')})
    scratch.fails(CHANNELS, "in.exr: depth 'depth.R' is from .* normalised", 'in.exr', '-o',
                  'x.exr', '--fov', FOV, hint="--depth 'Z', which is called depth too")


@cases([('a range', lambda z: (z - 1.5) / 7.5), ('fog', lambda z: 1 - np.exp(-z / 6))])
def depth_in_a_unit_is_taken_before_that_from_0_to_1(scratch, _, grey_of):
    scene = Scene()
    wanted, _ = clean(scratch, scene)
    grey = np.where(scene.sky, 1, grey_of(np.where(scene.sky, 1, scene.z))).astype(np.float32)
    parts = {'Z': scene.depth(), **scene.normals()}
    ao, said = run(scratch, {**parts, **{f'ZDepth.{c}': grey for c in 'RGB'}}, '--fov', FOV)
    check_same(ao, wanted, said)
    matches("'Z' and 'ZDepth.R' differ: 'Z' is taken, since the other is from 0 to 1", said,
            'stderr')
    # Of two in units, and for who says the type or the range, the order of the names decides.
    for other, options in ((scene.depth() * 100, ()), (grey, ('--depth-type', 'planar')),
                           (grey, ('--depth-range', '1.5,9'))):
        said = run(scratch, {**parts, 'ZDepth.R': other}, '--fov', FOV, *options)[1]
        matches("'ZDepth.R' and 'Z' differ: 'ZDepth.R' is taken .--depth 'Z'", said, 'stderr')


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


# Where depth begins, the range that is told, the power of depth that is stored.
TOLD_RANGES = [('right', 1.5, '1.5,9', 1, None), ('right, rounded', 1.5, '1.52,9.05', 1, None),
               ('other near', 1.5, '0,9', 1, r'0,9 is not that of .* as if NEAR were 1\.[45]'),
               ('nearer', 1.5, '2.5,9', 1, r'2\.5,9 is not that of .* as if NEAR were 1\.[45]'),
               ('other way', 1.5, '1.5,9,inverted', 1,
                r'counts the other way .*--depth-range 1\.5,9\)'),
               ('of a picture', 1.5, '1.5,9', 1 / 2.2, 'flat only as its power of about 2.2'),
               ('a root from the eye', 0, '0,9', 0.5, 'flat only as its power of about 2.2'),
               ('made linear', 1.5, '1.5,9', 2.2, 'flat only as its power of about 0.45')]


@cases(TOLD_RANGES)
def flat_things_contradict_a_range(scratch, _, near, told, gamma, message):
    scene = Scene(320, 180)
    depth = np.where(scene.sky, 1, ((scene.z - near) / (9 - near)) ** gamma).astype(np.float32)
    for normals in {}, scene.normals():
        write_exr(scratch.path('in.exr'), {'Z': depth, **normals})
        said = str(inspect(scratch, '--fov', FOV, '--depth-type', 'normalized', '--depth-range',
                           told)['warnings'])
        if message:
            matches(message, said, 'the warnings')
        else:
            check('flat things' not in said, said)


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
    for options in (('--depth-type', 'device'), ()):
        ao, said = run(scratch, {'depth': scene.depth(kind)}, '--fov', FOV, *options, *planes)
        check_same(ao, wanted, kind)
        equal('taken for a depth buffer (--depth-type' in said, not options, said)


@case
def told_ends_say_the_type_of_depth_from_0_to_1(scratch):
    scene, ends = Scene(), ('--depth-range', '0,20')
    wanted, _ = clean(scratch, scene)
    parts = {'Z': depth_of(scene, 1, 1 / 20), **scene.normals(space='world')}
    ao, said = run(scratch, parts, '--fov', FOV, *ends)
    check_same(ao, wanted, said)
    matches('--depth-range is given: taken for parts of that range', said, 'stderr')
    # Of other depth planes are told as well, and a range is a mistake.
    for unit, sky, options, want in (
            (1, 1e10, ('--near', 0.1, '--far', 100), ''),
            (0.01, 0, ('--near', 0.001, '--far', 1), ''),
            (1, 1e10, ends, "--depth-range is left aside: depth 'Z' is taken for ")):
        write_exr(scratch.path('in.exr'),
                  {'Z': depth_of(scene, sky, unit), **scene.normals(space='world')})
        view = inspect(scratch, '--fov', FOV, *options)
        said = str(view['warnings'])
        equal(view['conventions']['depth_type'], 'planar', said)
        equal('left aside' in said, bool(want), said)
        matches(want, said, 'what is said')
    # Normals may know better.
    write_exr(scratch.path('in.exr'), {'Z': scene.depth('device'), **scene.normals()})
    matches("--depth-range says that depth 'Z' is normalized, but by normals 'N' it is device",
            str(inspect(scratch, '--fov', FOV, *ends)['warnings']), 'what is said')


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


def as_parts(scene, near, far, most):
    return (np.where(scene.sky, 1, (scene.z - near) / (far - near)) * most).round()


@cases([('16 bits', 2 ** 16 - 1), ('12 bits', 2 ** 12 - 1), ('10 bits', 1023), ('8 bits', 255)])
def whole_numbers_that_show_no_distances_are_refused(scratch, _, most):
    scene = Scene()
    depth = as_parts(scene, 1.5, 9.0, most).astype('uint32')
    write_exr(scratch.path('in.exr'), {'Z': depth})
    for options in (), ('--fov', FOV):
        scratch.fails(CHANNELS, f"in.exr: depth 'Z' is whole numbers up to {most}, and nothing "
                      'shows distances', 'in.exr', '-o', 'x.exr', *options,
                      hint=f'take {255 if most == 255 else 65535} for 1')


@cases([('as it is', ''), ('inverted', ',inverted')])
def bits_that_are_no_bytes_are_said(scratch, _, inverted):
    scene, near, far, most = Scene(), 1.5, 9.0, 2 ** 14 - 1
    options = ('--fov', FOV, '--radius', 0.5, '--depth-type', 'normalized', '--depth-range')
    if inverted:
        near, far = far, near
    depth = as_parts(scene, near, far, most).astype('uint32')
    _, said = run(scratch, {'Z': depth}, *options, f'1.5,9{inverted}')
    warned = f'whole numbers up to {most}, and parts of 65535 are read: if {most} is 1, distances'
    check(warned in said, said)
    remedy = re.findall(r'or --depth-range (\S+)', said)
    if inverted:
        equal(remedy, [], 'a range that ends behind the eye')
        return
    wanted, _ = clean(scratch, scene, *options[:4], normals=False)
    scene_only = np.where(scene.sky, 0, depth).astype('uint32')
    ao, _ = run(scratch, {'Z': scene_only}, *options, remedy[0])
    check_same(ao, wanted, 'with the range that is said')
    for bits in (8, 16, 24):
        _, said = run(scratch, {'Z': as_parts(scene, near, far, 2 ** bits - 1).astype('uint32')},
                      *options, '1.5,9')
        check('parts of' not in said, said)


if __name__ == '__main__':
    main()
