#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Channels are found by all the names that programs give them, by rule where several might be
meant."""
import numpy as np

from cli import CHANNELS, case, cases, check, equal, main, matches, read_ao, write_exr
from evidence import OPTIONS, check_same, clean, inspect, run
from scene import FOV, MOVE, TURN, Scene

NORMAL_NAMES = [
    ('N.red', ('N.red', 'N.green', 'N.blue')), ('NX', ('NX', 'NY', 'NZ')),
    ('Nx', ('Nx', 'Ny', 'Nz')), ('Nsx', ('Nsx', 'Nsy', 'Nsz')),
    ('bumpNormals', ('bumpNormals.R', 'bumpNormals.G', 'bumpNormals.B')),
    ('hitN', ('hitN.x', 'hitN.y', 'hitN.z')),
    ('NormalWS', ('NormalWS.X', 'NormalWS.Y', 'NormalWS.Z')),
    ('CameraNormal', ('FinalImageCameraNormal.R', 'FinalImageCameraNormal.G',
                      'FinalImageCameraNormal.B')),
    ('normal_x', ('normal_x', 'normal_y', 'normal_z')),
    ('N.world', ('N.world.X', 'N.world.Y', 'N.world.Z')),
    ('Normal.camera', ('Layer.Normal.camera.r', 'Layer.Normal.camera.g', 'Layer.Normal.camera.b')),
    ('N.filtered', ('N.filtered.X', 'N.filtered.Y', 'N.filtered.Z')),
    ('nrm', ('nrm.X', 'nrm.Y', 'nrm.Z')),
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


@cases([('N', 'XY'), ('ViewLayer.Normal', 'XY'), ('VRayNormals', 'RG')])
def normals_of_two_components_are_told(scratch, layer, letters):
    scene = Scene(48, 27)
    third = f'{layer}.{"Z" if letters == "XY" else "B"}'
    normals = scene.normals(layer, letters=letters + third[-1])
    first = next(iter(normals))
    channels = {'Z': scene.depth(), **normals}
    told = {'role': 'normal', 'name': first, 'why': 'two components: a third is missing'}
    write_exr(scratch.path('in.exr'), channels)
    check(told not in inspect(scratch, '--fov', FOV)['passed_over'], 'told of three')
    del channels[third]
    write_exr(scratch.path('in.exr'), channels)
    view = inspect(scratch, '--fov', FOV)
    equal(view['roles']['normal'], None, 'normals')
    check(told in view['passed_over'], str(view['passed_over']))


@cases([('two components', {'N.X', 'N.Y'}, "'N.X' (two components: a third is missing)"),
        ('a word of it', {f'rgba_N.{c}' for c in 'RGB'}, "'rgba_N'"),
        ('another', {f'beauty.N_left.{c}' for c in 'XYZ'}, "'beauty.N_left'"),
        ('a longer word', {f'rgba_Nose.{c}' for c in 'RGB'}, None),
        ('tangent space', {f'normal_tangent.{c}' for c in 'RGB'}, None)])
def what_may_be_normals_is_named(scratch, _, names, wanted):
    scene = Scene(48, 27)
    planes = [*scene.normals().values()]
    channels = dict(zip(sorted(names), planes))
    write_exr(scratch.path('in.exr'), {'Z': scene.depth(), **channels})
    view = inspect(scratch, '--fov', FOV)
    equal(view['roles']['normal'], None, 'normals')
    said = str(view['warnings'])
    check(('by their names these may be some: ' in said) == (wanted is not None), said)
    check(not wanted or f'{wanted} (--normal NAME)' in said.replace("\\'", "'"), said)
    said = str(inspect(scratch, '--fov', FOV, '--normal', 'none')['warnings'])
    check('by their names' not in said, f'none are wanted: {said}')


@cases([('world', 'P.world', 'N.world'), ('camera', 'P.camera', 'N.camera'),
        ('any layer', 'where', 'N'), ('in a layer', 'a.where', 'N'),
        ('Maya, world', 'pointWorld', 'N.world'), ('Maya, camera', 'pointCamera', 'N.camera')])
def layers_of_positions_are_positions(scratch, _, layer, normal):
    scene = Scene()
    space = 'world' if 'world' in layer.lower() else 'camera'
    wanted, _ = clean(scratch, scene)
    finite = np.where(scene.sky, 0, scene.z)
    points = np.stack([scene.x * finite, scene.y * finite, -finite], axis=-1)
    if space == 'world':
        points = np.where(scene.sky[..., None], 0, (points - MOVE) @ TURN)
    channels = {**{f'{layer}.{c}': points[..., i].astype(np.float32)
                   for i, c in enumerate('XYZ')}, **scene.normals(normal, space)}
    if normal != 'N':  # named so that no option is needed
        ao, said = run(scratch, channels)
        check_same(ao, wanted, f'no option: {said}')
    ao, said = run(scratch, channels, '--depth', layer)
    check_same(ao, wanted, f'--depth {layer}: {said}')
    view = inspect(scratch, '--depth', f'{layer}.Z', '--depth-type', 'planar')
    equal(view['roles']['depth']['channels'], [f'{layer}.Z'], 'a component that is named')


@case
def normals_of_the_camera_come_before_those_of_the_world(scratch):
    scene = Scene()
    write_exr(scratch.path('in.exr'), {'Z': scene.depth(), **scene.normals('N.world', 'world'),
                                       **scene.normals('N.camera')})
    equal(inspect(scratch, '--fov', FOV)['roles']['normal']['name'], 'N.camera', 'normals')


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


@cases([('__depth.r', ('__depth.g', '__depth.b'), None), ('linearZ.R', ('linearZ.G',), 'planar'),
        ('distance_to_camera.R', (), 'radial'), ('distance_to_image_plane.R', (), 'planar')])
def depth_may_lie_beside_other_measures(scratch, name, others, kind):
    # Height and facing, or a slope: no picture in colours.
    scene = Scene()
    rng = np.random.default_rng(2)
    channels = {name: scene.depth(kind or 'planar'), **scene.normals(),
                **{n: rng.random(scene.z.shape).astype(np.float32) for n in others}}
    write_exr(scratch.path('in.exr'), channels)
    view = inspect(scratch, '--fov', FOV)
    equal(view['roles']['depth'] and view['roles']['depth']['channels'], [name], 'depth')
    equal(view['conventions']['depth_type'], kind or 'planar', 'type')


@cases([('twice', 2, np.float32, True), ('negative', -1, np.float32, False),
        ('the same', 1, np.float32, False), ('halves', 1, np.float16, False),
        ('other halves', 1.5, np.float16, True)], name=lambda row: row[0])
def one_of_two_depths_is_said_if_they_differ(scratch, _, times, kind, is_said):
    scene = Scene()
    first = scene.depth()
    with np.errstate(over='ignore'):
        other = (np.where(scene.sky, np.inf, first * times)).astype(kind)
    for channels in ([{'depth.Z': first, 'Z': other}], [{'Z': first, 'VRayZDepth': other}],
                     [({'Z': other, **scene.color()}, {'name': 'rgba'}),
                      ({'Z': first}, {'name': 'depth'})]):
        write_exr(scratch.path('in.exr'), *channels)
        view = inspect(scratch, '--fov', FOV)
        taken, said = view['roles']['depth']['name'], str(view['warnings'])
        equal(f"depth '{taken}' and '" in said, is_said, f'whether two are in {said}')
        check(np.isclose(view['conventions']['min_z'], scene.z.min()), 'another is taken')
        said = str(inspect(scratch, '--fov', FOV, '--depth', taken)['warnings'])
        check(' differ: ' not in said, f'{taken} was named: {said}')


@case
def depth_of_another_part_is_its_own(scratch):
    scene = Scene()
    write_exr(scratch.path('in.exr'), (scene.color(), {'name': 'rgba'}),
              ({'Z': scene.depth()}, {'name': 'depth'}),
              ({'Z': scene.depth() * 2}, {'name': 'character'}))
    said = str(inspect(scratch, '--fov', FOV)['warnings'])
    check(' differ: ' not in said, said)


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
def results_of_vkao_are_no_depth(scratch):
    scene = Scene(48, 27)
    write_exr(scratch.path('shot.exr'), {'Z': scene.depth(), **scene.color()})
    for mode in 'ao', 'comp':
        scratch.render('shot.exr', '-o', f'{mode}.exr', '--fov', FOV, '--mode', mode)
        scratch.fails(CHANNELS, 'no depth channel found', f'{mode}.exr', '-o', 'x.exr',
                      hint="a result, which vkao made of 'shot.exr': give that")


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


if __name__ == '__main__':
    main()
