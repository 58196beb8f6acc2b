#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Normals, their space and their encoding are known by their agreement with depth, and what is none
is left out."""
import re

import numpy as np

from cli import CHANNELS, case, cases, check, equal, main, matches, write_exr
from evidence import check_same, clean, depth_of, hidden, inspect, rotation_header, run
from scene import CORNER, FOV, TURN, Scene, boxes_along_axes, write_camera


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


# What is seen straight on has one normal through any field of view.
PLANES = [('world', 5, True), ('camera', 5, True), ('world', 40, True), ('camera', 88, False)]


def floor(degrees, space):
    """A floor, and sky, of a camera that looks so much down; through a field of view of 90."""
    scene, turn = Scene(fov=90), np.radians(degrees)
    up = np.array([0, np.cos(turn), np.sin(turn)])
    w = -(scene.x * up[0] + scene.y * up[1] - up[2])
    z = np.where(w > 0.005, 1.5 / np.maximum(w, 0.005), 1e10)
    normal = (z < 1e9)[..., None] * (up if space != 'world' else np.array([0, 1, 0]))
    return {'Z': z.astype(np.float32),
            **{f'N.{c}': normal[..., i].astype(np.float32) for i, c in enumerate('XYZ')}}


@cases(PLANES, name=lambda row: f'{row[0]}, {row[1]} degrees')
def one_plane_tells_no_space(scratch, space, degrees, is_said):
    channels = floor(degrees, space)
    write_exr(scratch.path('in.exr'), channels)
    said = str(inspect(scratch)['warnings'])
    for word in 'of no plane', 'in camera space':
        check(word not in said, said)
    equal('depth is of one plane: without a field of view nothing tells' in said, is_said, said)
    ao, _ = run(scratch, channels, '--radius', 0.5)
    check(ao.min() > 0.99, f'AO of {ao.min()} on a plane')
    # What somebody tells is taken.
    said = str(inspect(scratch, '--fov', 90, '--normal-space', 'camera')['warnings'])
    check(space == 'world' or 'the same everywhere' not in said, said)


@cases([('camera',), ('world',)])
def one_plane_of_a_known_view(scratch, space):
    write_exr(scratch.path('in.exr'), floor(9, space))
    view = inspect(scratch, '--fov', 90)
    said = str(view['warnings'])
    check('the same everywhere' not in said, said)
    equal('in camera space' in said, space == 'camera', said)
    if space == 'world':
        matches('need the rotation of the camera', said, 'the warnings')


ACES_CG = np.array([[.6131, .3395, .0474], [.0702, .9164, .0134], [.0206, .1096, .8698]])
SHORTER = np.random.default_rng(2).uniform(0.7, 1, (180, 320, 1))


@cases([('a matrix of colours', 'signed', lambda n: n @ ACES_CG.T, True),
        ('the same of 0..1', 'unsigned', lambda n: n @ ACES_CG.T, True),
        ('a gain', 'signed', lambda n: n * [1.1, 0.95, 0.85], True),
        ('as it is', 'signed', lambda n: n, False), ('0..1', 'unsigned', lambda n: n, False),
        ('all longer', 'signed', lambda n: n * 1.07, False),
        ('of filters', 'signed', lambda n: n * SHORTER, False),
        ('bytes', 'signed', lambda n: np.round(n * 127) / 127, False)], name=lambda row: row[0])
def a_colour_transform_of_normals_is_said(scratch, _, encoding, change, is_said):
    scene = Scene(320, 180)
    channels = {'Z': scene.depth(), **scene.normals(space='world', encoding=encoding)}
    names = [f'N.{c}' for c in 'XYZ']
    values = change(np.stack([channels[n] for n in names], -1))
    channels.update({n: values[..., i].astype(np.float32) for i, n in enumerate(names)})
    write_exr(scratch.path('in.exr'), channels)
    for options in (), ('--fov', FOV):
        said = str(inspect(scratch, '--normal-encoding', encoding, *options)['warnings'])
        equal("normals 'N' look as if a colour transform" in said, is_said, said)


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
def normals_that_point_inwards_are_said(scratch):
    scene = Scene()
    inwards = {n: -v for n, v in scene.normals(space='world').items()}
    write_camera(scratch.path('camera.json'))
    write_exr(scratch.path('in.exr'), {'Z': scene.depth(), **inwards})
    said = str(inspect(scratch, '--camera', 'camera.json', '--normal-space', 'world')['warnings'])
    matches(r"in\.exr: the normals 'N' face away from the camera, 100 % of them, .*: they point "
            'inwards and are turned round', said, 'warnings')
    check('is --normal-space or the camera wrong' not in said, said)
    options = ('--camera', 'camera.json', '--normal-space', 'world')
    ao, _ = run(scratch, {'Z': scene.depth(), **inwards}, *options)
    wanted, _ = run(scratch, {'Z': scene.depth(), **scene.normals(space='world')}, *options)
    check_same(ao, wanted, 'AO of both')


def to_srgb(v):
    return np.where(v <= 0.0031308, v * 12.92, 1.055 * np.maximum(v, 0) ** (1 / 2.4) - 0.055)


def to_linear(v):
    return np.where(v <= 0.04045, v / 12.92, ((np.maximum(v, 0) + 0.055) / 1.055) ** 2.4)


def curved(normals, curve):
    return np.sign(normals) * curve(np.abs(normals))


@cases([('put on', to_srgb), ('taken off', to_linear)])
def curve_of_colours_is_undone(scratch, name, curve):
    scene = Scene()
    wanted, _ = clean(scratch, scene)
    normals = scene.normals(space='world')
    for below, through in (('foot', curve), ('mirror', lambda v: curved(v, curve))):
        parts = {c: through(v).astype(np.float32) for c, v in normals.items()}
        parts['Z'] = scene.depth()
        for options in (), ('--normal-encoding', 'signed'):
            ao, said = run(scratch, parts, '--fov', FOV, *options, attributes=rotation_header())
            check_same(ao, wanted, f'{name}, below zero its {below}')
            matches(f'curve of sRGB had been {name} them: .* 100 % with that undone', said,
                    'stderr')


def crowd():
    """Posts on a floor before a wall, whose edges are in a quarter of the texels: depth, and
    normals that a filter averaged."""
    random = np.random.default_rng(7)
    boxes = [((-50, -50, -12), (50, -3, 50)), ((-50, -50, -14), (50, 50, -12))]
    for _ in range(350):
        x, z = random.uniform((-8, -11), (8, -4))
        height, side = random.uniform((0.3, 0.1), (3, 0.4))
        boxes.append(((x, -3, z), (x + side, height - 3, z + side)))
    fine = boxes_along_axes(boxes, 640, 360, turn=np.eye(3))
    normals = np.stack([fine[f'N.{c}'] for c in 'XYZ'], -1).astype(np.float64)
    return fine['Z'][4::8, 4::8], normals.reshape(45, 8, 80, 8, 3).mean((1, 3))


@case
def curve_is_told_from_a_filter(scratch):
    """Means of two axes are shorter than 1, as some curves make them. Of hair no two texels are
    alike, and of a few on a wall nothing is known of that."""
    depth, posts = crowd()
    random = np.random.default_rng(7)
    hair = random.normal(size=posts.shape)
    hair /= np.linalg.norm(hair, axis=-1, keepdims=True)
    some = (random.random(depth.shape) < 0.01)[..., None]
    for n, wanted in ((posts, None), (posts @ TURN, None),
                      (curved(posts @ TURN, to_srgb), 'put on'),
                      (curved(posts @ TURN, to_linear), 'taken off'),
                      (hair, None), (np.where(some, curved(hair, to_srgb), (0, 0, 1)), None),
                      (curved(hair, to_srgb), 'put on')):
        write_exr(scratch.path('in.exr'), {'Z': depth, **{
            f'N.{c}': n[..., i].astype(np.float32) for i, c in enumerate('XYZ')}})
        said = str(inspect(scratch, '--fov', FOV)['warnings'])
        equal(re.findall('curve of sRGB had been (put on|taken off)', said),
              [wanted] if wanted else [], said)


@case
def normals_that_were_made_linear_are_refused(scratch):
    scene = Scene()
    colors = {n: ((v * 0.5 + 0.5) ** 2.2).astype(np.float32)
              for n, v in scene.normals('normal', letters='RGB').items()}
    write_exr(scratch.path('in.exr'), {'Z': scene.depth(), **colors})
    scratch.fails(CHANNELS, "normals 'normal' look like a picture .* made linear", 'in.exr', '-o',
                  'x.exr', '--fov', FOV, hint='as data')
    scratch.render('in.exr', '-o', 'x.exr', '--fov', FOV, '--normal', 'none')


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


@cases([('mirrored', (-1, 1, 1), True), ('any way round', None, False),
        ('as they are', (1, 1, 1), False)])
def mirrored_worlds_are_found(scratch, _, flip, is_said):
    # Of faces along the axes the mirrored ones are parallel to the right ones: agreement is blind.
    boxes = [((i - 6, 2.8 - i * 0.3, -5 - i * 0.7), (i - 5.2, 9, -4.2 - i * 0.5)) for i in range(5)]
    channels = boxes_along_axes(CORNER + boxes, 320, 180)
    wanted = run(scratch, channels, '--fov', FOV, attributes=rotation_header())[0]
    signs = np.random.default_rng(6).choice([-1, 1], (9, 16)).repeat(20, axis=0).repeat(20, axis=1)
    for i, c in enumerate('XYZ'):
        channels[f'N.{c}'] = (channels[f'N.{c}'] * (flip[i] if flip else signs)).astype(np.float32)
    ao, said = run(scratch, channels, '--fov', FOV, attributes=rotation_header())
    check_same(ao, wanted, 'with other signs')
    equal('face it once their x is turned round: mirrored' in said, is_said, f'what is in {said}')


@case
def normals_inside_out_are_turned(scratch):
    scene = Scene()
    wanted, _ = clean(scratch, scene)
    outside = scene.normals(space='world')
    channels = {'Z': scene.depth(), **{name: -plane for name, plane in outside.items()}}
    ao, said = run(scratch, channels, '--camera', write_camera(scratch.path('c.json')))
    check_same(ao, wanted, 'inside out')
    matches("the normals 'N' face away from the camera, 100 % of them, .*: they point inwards and "
            'are turned round', said, 'stderr')


@cases([('upside down', np.s_[::-1]), ('mirrored, left to right,', np.s_[:, ::-1]),
        ('turned by 180 degrees', np.s_[::-1, ::-1])])
def depth_that_is_turned_against_normals_is_said(scratch, how, turned):
    scene = Scene()
    channels = {'Z': np.ascontiguousarray(scene.depth()[turned]), **scene.normals(space='world')}
    message = rf"in\.exr: depth 'Z' is {how} against normals 'N' \(100 % of them agree .* derived"
    wanted, _ = clean(scratch, scene, normals=False)
    for options, attributes in (((), []), (('--fov', FOV), []), (('--fov', FOV), rotation_header()),
                                (('--fov', FOV, '--normal-space', 'world'), rotation_header())):
        ao, said = run(scratch, channels, *options, attributes=attributes)
        matches(message, said, f'{options}, header with {len(attributes)} matrices')
        check('no normals;' not in said, said)
        check_same(ao, wanted[turned], f'{options}, header with {len(attributes)} matrices')
    write_exr(scratch.path('depth.exr'), {'Z': channels.pop('Z')})
    write_exr(scratch.path('normals.exr'), channels)
    said = scratch.render('depth.exr', '--normal-file', 'normals.exr', '-o',
                          'both.exr').stderr
    matches(rf"depth 'Z' is {how} against normals 'N' of normals\.exr", said, 'two files')


@case
def depth_and_normals_turned_together_are_no_mistake(scratch):
    scene = Scene()
    for name, turned in (('upright', np.s_[:]), ('both', np.s_[::-1])):
        for noise in (0, 0.3):
            normal = scene.normal + noise * np.random.default_rng(5).normal(size=scene.normal.shape)
            normal /= np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-9)
            normal[scene.sky] = 0
            channels = {f'N.{c}': normal[turned][..., i] for i, c in enumerate('XYZ')}
            write_exr(scratch.path('in.exr'),
                      {n: np.ascontiguousarray(v, np.float32)
                       for n, v in {'Z': scene.depth()[turned], **channels}.items()})
            for options in ((), ('--fov', FOV)):
                said = str(inspect(scratch, *options)['warnings'])
                check(' against normals ' not in said, f'{name}, noise of {noise}: {said}')


@case
def frames_whose_depth_is_turned_say_it_once(scratch):
    scene = Scene()
    for frame in range(1, 4):
        write_exr(scratch.path(f'in.{frame:04}.exr'),
                  {'Z': np.ascontiguousarray(scene.depth()[::-1]), **scene.normals(space='world')})
    said = scratch.render('in.####.exr', '-o', 'ao.####.exr').stderr
    equal(said.count('upside down against normals'), 1, said)
    equal(said.count('normal=from depth'), said.count('using:'), said)


@cases([('signed', 'unsigned'), ('unsigned', 'signed')])
def another_encoding_than_told_is_said(scratch, stored, told):
    write_exr(scratch.path('in.exr'),
              {'Z': Scene().depth(), **Scene().normals(space='world', encoding=stored)})
    for space in (), ('--fov', FOV, '--normal-space', 'camera'):
        said = str(inspect(scratch, '--normal-encoding', told, *space)['warnings'])
        matches(rf"--normal-encoding says that normals 'N' are {told}, but (9\d|100) % are of "
                rf'length 1 as {stored}, .*: {told} is taken \(--normal-encoding {stored} over',
                said, 'the warnings')
        said = str(inspect(scratch, '--normal-encoding', stored)['warnings'])
        check('--normal-encoding says' not in said, said)


@cases([('twice',), ('half',), ('a hundred times',), ('a little more',), ('any length above 1',)])
def lengths_of_normals_do_not_matter(scratch, name):
    scene = Scene()
    wanted, _ = clean(scratch, scene)
    # A little longer than 1, the floor's is what a picture that was made linear would have.
    times = {'twice': 2, 'half': 0.5, 'a hundred times': 100, 'a little more': 1.07,
             'any length above 1': 1 + 4 * np.random.default_rng(6).random(scene.z.shape)}[name]
    normals = {n: (v * times).astype(np.float32) for n, v in scene.normals(space='world').items()}
    for attributes in ([], rotation_header()):
        ao, said = run(scratch, {'Z': scene.depth(), **normals}, attributes=attributes)
        check('the image does not tell it' not in said, said)
        check_same(ao, wanted, f'{name}, header with {len(attributes)} matrices')


SIGNS = [(x, y, z) for x in (1, -1) for y in (1, -1) for z in (1, -1)]


@cases([(f'{slope}, {"".join("-+"[s > 0] for s in signs)}', slope, signs)
        for slope in (0.0, 1.2) for signs in SIGNS])
def a_floor_does_not_hide_a_mirror(scratch, _, slope, signs):
    # Without perspective: a floor and balls on it, of which hardly a normal faces away mirrored.
    y, x = np.mgrid[:120, :200] / 50 - np.array([1.2, 2])[:, None, None]
    up = np.array([0, slope, 1]) / np.hypot(slope, 1)
    z, normal = 9 + slope * y, np.broadcast_to(up, (120, 200, 3))
    for u, v, radius in ((-0.9, 0.3, 0.15), (0.6, -0.4, 0.2), (1.2, 0.6, 0.1)):
        square = radius ** 2 - (x - u) ** 2 - (y - v) ** 2
        rise = np.sqrt(np.maximum(square, 0))
        ball = 9 + slope * v - radius * np.hypot(slope, 1) - rise
        is_ball = square > 0
        side = np.stack([x - u, y - v, rise], axis=-1) / radius
        z, normal = np.where(is_ball, ball, z), np.where(is_ball[..., None], side, normal)
    channels = {'Z': z[::-1].astype(np.float32), **{
        f'N.{c}': normal[::-1, :, i].astype(np.float32) for i, c in enumerate('XYZ')}}
    wanted, said = run(scratch, channels, '--ortho', 4)
    check('mirrored' not in said, said)
    mirrored = {f'N.{c}': channels[f'N.{c}'] * np.float32(s) for c, s in zip('XYZ', signs)}
    ao, said = run(scratch, {**channels, **mirrored}, '--ortho', 4)
    check_same(ao, wanted, f'signs {signs}')


def leaves():
    """Discs any way round before a wall, without perspective, and whose backs are seen."""
    random = np.random.default_rng(3)
    y, x = np.mgrid[:120, :200] / 50 - np.array([1.2, 2])[:, None, None]
    z, normal, is_back = 5 + 0 * x, np.broadcast_to([0.0, 0, 1], (120, 200, 3)), x > 9
    for _ in range(600):
        u, v, depth = random.uniform([-2, -1.2, 4.6], [2, 1.2, 4.95])
        n = random.normal(size=3)
        n /= np.linalg.norm(n) * (-1 if n[2] < 0 else 1)
        back = random.random() < 0.5
        rise = -((x - u) * n[0] + (y - v) * n[1]) / n[2]
        square = (x - u) ** 2 + (y - v) ** 2 + rise ** 2
        is_leaf = (square < 0.08 ** 2) & (depth - rise < z)
        z = np.where(is_leaf, depth - rise, z)
        normal = np.where(is_leaf[..., None], n, normal)
        is_back = np.where(is_leaf, back, is_back)
    channels = {'Z': z[::-1].astype(np.float32), **{
        f'N.{c}': normal[::-1, :, i].astype(np.float32) for i, c in enumerate('XYZ')}}
    return channels, is_back[::-1]


@case
def leaves_seen_from_behind_are_turned(scratch):
    # Mitsuba writes normals of two-sided surfaces as they are.
    channels, is_back = leaves()
    wanted, said = run(scratch, channels, '--ortho', 4)
    check('away' not in said, said)
    turned = {n: np.where(is_back, -v, v) if n != 'Z' else v for n, v in channels.items()}
    ao, said = run(scratch, turned, '--ortho', 4)
    check_same(ao, wanted, 'some turned')
    matches(r"\d+ % of the normals 'N' face away from the camera, as those of leaves .* turned",
            said, 'stderr')


def octahedra():
    """Before a wall, without perspective; every second is shaded as a ball: at its rims normals
    face away, and depth does not."""
    random = np.random.default_rng(4)
    faces = np.array(SIGNS) / np.sqrt(3)
    y, x = np.mgrid[:120, :200] / 50 - np.array([1.2, 2])[:, None, None]
    z, normal = 6 + 0 * x, np.broadcast_to([0.0, 0, 1], (120, 200, 3))
    for k, (u, v) in enumerate((u, v) for u in np.arange(-1.75, 2, 0.5) for v in (-0.8, 0, 0.8)):
        n = faces @ np.linalg.qr(random.normal(size=(3, 3)))[0]
        # Heights over the middle, towards the eye, where each face's plane is.
        at = (0.15 - (x - u)[..., None] * n[:, 0] - (y - v)[..., None] * n[:, 1]) / n[:, 2]
        front = np.where(n[:, 2] > 0, at, np.inf)
        top = front.min(axis=-1)
        is_there = top > np.where(n[:, 2] < 0, at, -np.inf).max(axis=-1)
        shaded = np.stack([x - u, y - v, top], axis=-1) if k % 2 else n[front.argmin(axis=-1)]
        shaded = shaded / np.linalg.norm(shaded, axis=-1, keepdims=True)
        z = np.where(is_there, 5.5 - top, z)
        normal = np.where(is_there[..., None], shaded, normal)
    return {'Z': z[::-1].astype(np.float32), **{
        f'N.{c}': normal[::-1, :, i].astype(np.float32) for i, c in enumerate('XYZ')}}


@case
def rims_of_coarse_things_are_not_turned(scratch):
    channels = octahedra()
    away = np.mean(channels['N.Z'] < 0)
    check(away > 0.01, f'{away} of the normals face away: too few to be said')
    _, said = run(scratch, channels, '--ortho', 4)
    check('turned to it' not in said, said)


@cases([('96 x 64', (96, 64)), ('128 x 72', (128, 72))])
def few_texels_tell_a_mirror(scratch, _, size):
    # Ceiling and wall fit either hand; of small things alone some sides would face away.
    boxes = CORNER[:2] + [((-2, 2.3, -8), (-1.6, 3.6, -7.5)), ((1, 2.3, -7), (1.2, 3.6, -6)),
                          ((3, 3, -8.2), (3.3, 3.6, -8))]
    channels = boxes_along_axes(boxes, *size)
    wanted, said = run(scratch, channels)
    check('mirrored' not in said, said)
    for name, signs in (('inwards', (-1, -1, -1)), ('left-handed', (1, 1, -1))):
        mirrored = {f'N.{c}': channels[f'N.{c}'] * np.float32(s) for c, s in zip('XYZ', signs)}
        ao, said = run(scratch, {**channels, **mirrored})
        matches(r"in\.exr: 0\.\d+ % of the normals 'N' face away from the camera, and all face it "
                'once their x is turned round: mirrored', said, name)
        check_same(ao, wanted, name)


@case
def clamped_normals_are_said_of_small_images(scratch):
    scene = Scene(96, 54)
    turned = scene.normals(space='world')
    for name, change in (('lost', np.abs), ('clamped', lambda n: np.maximum(n, 0))):
        for attributes in ([], rotation_header()):
            write_exr(scratch.path('in.exr'), {'Z': scene.depth(),
                                               **{n: change(v) for n, v in turned.items()}},
                      attributes=attributes)
            matches("normals 'N' have no negative component anywhere",
                    str(inspect(scratch, '--fov', FOV)['warnings']), name)


@case
def few_signs_that_are_lost_are_said(scratch):
    """Three in four normals agree all the same."""
    scene = Scene(320, 180)
    negative = (scene.normal < -0.01).any(axis=-1)
    kept = np.cumsum(negative.sum(axis=0)) < 0.05 * (~negative & ~scene.sky).sum()
    scene.z[negative & ~kept] = np.inf
    scene.sky = np.isinf(scene.z)
    scene.normal[scene.sky] = 0
    channels = {'Z': scene.depth(), **scene.normals()}
    lost = {n: np.abs(v) if n != 'Z' else v for n, v in channels.items()}
    for name, planes, is_said in (('lost', lost, True), ('whole', channels, False)):
        write_exr(scratch.path('in.exr'), planes)
        view = inspect(scratch, '--fov', FOV)
        check(view['conventions']['normal_agreement'] > 0.75, f'{name}: {view["conventions"]}')
        equal('no negative component anywhere' in str(view['warnings']), is_said,
              f'{name}: {view["warnings"]}')


@case
def bumps_that_happen_to_be_positive_are_no_mistake(scratch):
    scene = Scene(320, 180)
    is_round = (scene.normal > 0.01).sum(axis=-1) > 1
    scene.z[is_round], scene.normal[is_round] = np.inf, 0
    scene.z[(scene.normal < 0).any(axis=-1)] = np.inf
    scene.sky = np.isinf(scene.z)
    bumps = 0.05 * np.random.default_rng(8).normal(size=scene.normal.shape)
    normal = np.abs(scene.normal + bumps)
    normal[scene.sky] = 0
    normal /= np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-9)
    write_exr(scratch.path('in.exr'), {'Z': scene.depth(), **{
        f'N.{c}': normal[..., i].astype(np.float32) for i, c in enumerate('XYZ')}})
    said = inspect(scratch, '--fov', FOV)
    check('no negative component' not in str(said['warnings']), str(said['warnings']))


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


def blurred(values, reach=2):
    """Means over a square: what a filter makes of coverage."""
    size = 2 * reach + 1
    wide = np.pad(values, [(reach, reach), (reach, reach)] + [(0, 0)] * (values.ndim - 2), 'edge')
    return sum(wide[y:y + values.shape[0], x:x + values.shape[1]]
               for y in range(size) for x in range(size)) / size ** 2


@cases([('a thing', 'is perhaps too'), ('what fades', 'is too'), ('normals alone', None),
        ('nothing', None), ('silhouettes', None), ('edges of a board', None)])
def normals_multiplied_by_alpha_are_said(scratch, name, message):
    scene = Scene(320, 180)
    ball, whole = scene.normal[..., 1] % 1 > 0, (~scene.sky).astype(float)
    fades = 0.55 + 0.35 * np.sin(scene.x * 9) * np.cos(scene.y * 7)
    normal, z, sky = scene.normal, scene.z, scene.sky
    alpha = np.where(ball, 0.4, whole) if name in ('a thing', 'nothing') else fades * whole
    if name == 'silhouettes':
        sphere = ball[..., None] * normal
        alpha, normal = blurred(ball.astype(float)), blurred(sphere)
    elif name == 'edges of a board':  # a filter makes all of them as long as alpha, depth as well
        board = np.zeros_like(whole)
        board[40:120, 60:200] = 1
        alpha = blurred(board)
        normal, z, sky = alpha[..., None] * np.array([0, 0, 1]), 2.5 * alpha, alpha == 0
    elif name != 'nothing':
        normal = normal * alpha[..., None]
        z = z if name == 'normals alone' else z * np.where(scene.sky, 1, alpha)
    channels = {'Z': np.where(sky, 1e10, z), 'A': alpha,
                **{f'N.{c}': normal[..., i] for i, c in enumerate('XYZ')},
                **{c: 0.5 * alpha for c in 'RGB'}}
    write_exr(scratch.path('in.exr'), {n: v.astype(np.float32) for n, v in channels.items()})
    said = str(inspect(scratch, '--fov', FOV, '--depth-type', 'planar', '--normal-space',
                       'camera')['warnings'])
    if message:
        matches(f"normals 'N' are multiplied by alpha, on .* %.*depth 'Z' {message}", said, name)
    else:
        check('multiplied by alpha' not in said, said)


def column(scene, sides=7, middle=(-1.1, 0.0, -3.2), radius=0.8):
    """A column of flat sides before all else, shaded as a round one: depth and normals."""
    ray = np.stack([scene.x, scene.y, -np.ones_like(scene.x)], axis=-1)
    turns = (np.arange(sides) + 0.3) / sides * 2 * np.pi
    out = np.stack([np.sin(turns), 0 * turns, np.cos(turns)], axis=-1)
    toward = ray @ out.T
    z = (out @ np.array(middle) + radius * np.cos(np.pi / sides)) / toward
    enter = np.where(toward < 0, z, -np.inf).max(axis=-1)
    leave = np.where(toward > 0, z, np.inf).min(axis=-1)
    is_hit = (enter < leave) & (enter < scene.z)
    round_ = (ray * enter[..., None] - np.array(middle)) * np.array([1, 0, 1])
    round_ /= np.linalg.norm(round_, axis=-1, keepdims=True)
    return (np.where(is_hit, enter, scene.z), np.where(is_hit[..., None], round_, scene.normal))


def turned_by(angle):
    return np.array([[np.cos(angle), 0, -np.sin(angle)], [0, 1, 0],
                     [np.sin(angle), 0, np.cos(angle)]])


@cases([('a ball', True), ('a ball, a little', True), ('a pane', True), ('nothing', False),
        ('coarse', False), ('bumps', False), ('a panel', False), ('a strip', False),
        ('all', False)])
def things_with_other_normals_are_said(scratch, name, is_said):
    scene = Scene(320, 180)
    z, normal = scene.z, scene.normal
    ball = (normal[..., 1] % 1 > 0)[..., None]
    if name.startswith('a ball'):
        normal = np.where(ball, normal @ turned_by(0.25 if 'little' in name else 0.6), normal)
    elif name == 'a pane':  # of glass, of which depth knows nothing
        normal = normal.copy()
        normal[130:175, 20:100] = [0.1, 0, np.sqrt(0.99)]
    elif name == 'a panel':  # of a normal map on the floor, which goes on around it
        normal = normal.copy()
        normal[130:175, 20:100] = [np.sin(0.4), np.cos(0.4), 0]
    elif name == 'a strip':  # as a bevel is, narrow
        normal = normal.copy()
        normal[150:154, 5:300] = [0.1, 0, np.sqrt(0.99)]
    elif name == 'coarse':
        z, normal = column(scene)
    elif name == 'bumps':
        waves = np.stack([np.sin(scene.x * 40), np.cos(scene.y * 50), 0 * scene.x], axis=-1)
        normal = normal + 0.3 * waves * (normal != 0).any(axis=-1, keepdims=True)
        normal /= np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-9)
    elif name == 'all':
        normal = normal @ turned_by(0.3)
    channels = {'Z': np.where(np.isinf(z), 1e10, z),
                **{f'N.{c}': normal[..., i] for i, c in enumerate('XYZ')}}
    write_exr(scratch.path('in.exr'), {n: v.astype(np.float32) for n, v in channels.items()})
    said = str(inspect(scratch, '--fov', FOV, '--depth-type', 'planar', '--normal-space',
                       'camera')['warnings'])
    if is_said:
        matches(r"normals 'N' and depth disagree on .* % of the image by \d+ degrees, .* around "
                r'\(\d+ \d+\), and agree elsewhere', said, name)
    else:
        check('agree elsewhere' not in said, said)


if __name__ == '__main__':
    main()
