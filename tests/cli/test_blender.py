#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""The man page's snippet for Blender writes the camera that Blender has, and what Blender renders
is understood as it comes. Needs a Python with the module bpy (pip install bpy): this one, or the
one that VKAO_BPY_PYTHON names."""
import json
import os
import subprocess
import sys

import numpy as np

from cli import cases, check, equal, main, matches, skip

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..')

# Cubes, or heads that are shaded smooth, and a floor; a camera of SETTINGS; renders FILE.exr if
# asked; prints where points of the world stand in the image, by Blender.
SCENE = '''
import json, sys
import bpy, mathutils
from bpy_extras.object_utils import world_to_camera_view
settings = json.loads(sys.argv[1])
for thing in list(bpy.data.objects):
    bpy.data.objects.remove(thing)
bpy.ops.mesh.primitive_plane_add(size=20)
for x, y, turn in ((0, 0, .3), (1.5, 1, .9), (-2, 1.5, 2.)):
    if not settings['heads']:
        bpy.ops.mesh.primitive_cube_add(location=(x, y, .8), rotation=(.4, turn, turn))
        continue
    bpy.ops.mesh.primitive_monkey_add(location=(x, y, .8), rotation=(-.4, 0, .3 - turn / 3))
    bpy.context.object.modifiers.new('smooth', 'SUBSURF').render_levels = 2
    for face in bpy.context.object.data.polygons:
        face.use_smooth = True
data = bpy.data.cameras.new('camera')
camera = bpy.data.objects.new('camera', data)
bpy.context.collection.objects.link(camera)
camera.location, camera.rotation_euler = (1, -6, 3), (1.2, .05, .15)
scene = bpy.context.scene
scene.camera, scene.frame_start, scene.frame_end = camera, 1, 2
for name, value in settings['camera'].items():
    setattr(data, name, value)
for name, value in settings['render'].items():
    setattr(scene.render, name, value)
bpy.ops.wm.save_as_mainfile(filepath=settings['blend'])
exec(open(settings['snippet']).read())
scene.frame_set(1)
points = [(0, 0, 1), (2, 3, 0), (-3, 4, .5), (.3, -1, 2)]
seen = [list(world_to_camera_view(scene, camera, mathutils.Vector(p))) for p in points]
if settings['exr']:
    scene.render.engine, scene.cycles.samples, scene.cycles.device = 'CYCLES', 8, 'CPU'
    layer = bpy.context.view_layer
    layer.use_pass_z = layer.use_pass_normal = True
    image = scene.render.image_settings
    if hasattr(image, 'media_type'):
        image.media_type = 'MULTI_LAYER_IMAGE'
    image.file_format, image.color_depth = 'OPEN_EXR_MULTILAYER', '32'
    scene.render.filepath = settings['exr']
    bpy.ops.render.render(write_still=True)
print('SEEN', json.dumps([points, seen]))
'''


def snippet():
    with open(os.path.join(ROOT, 'tools', 'vkao', 'vkao.1.scd.in'), encoding='utf-8') as file:
        page = file.read()
    return page.split('*Blender*, one file', 1)[1].split('```')[1]


def run_blender(scratch, camera, render, exr='', heads=False):
    python = os.environ.get('VKAO_BPY_PYTHON', sys.executable)
    probe = subprocess.run([python, '-c', 'import bpy'], capture_output=True, check=False)
    if probe.returncode != 0:
        skip(f'{python} has no module bpy')
    settings = {'camera': camera, 'render': render, 'blend': scratch.path('scene.blend'),
                'snippet': scratch.write('snippet.py', snippet()), 'exr': exr, 'heads': heads}
    done = subprocess.run([python, scratch.write('scene.py', SCENE), json.dumps(settings)],
                          capture_output=True, text=True, check=False)
    check(done.returncode == 0, done.stdout + done.stderr)
    line = [line for line in done.stdout.splitlines() if line.startswith('SEEN')][0]
    return json.loads(line[5:])


SIZE = {'resolution_x': 160, 'resolution_y': 90, 'resolution_percentage': 100}
CAMERAS = [
    ('usual', {'lens': 35}, SIZE),
    ('shifted', {'lens': 28, 'shift_x': 0.1, 'shift_y': -0.15}, SIZE),
    ('upright', {'lens': 40, 'shift_x': 0.05, 'shift_y': 0.1},
     {**SIZE, 'resolution_x': 90, 'resolution_y': 160}),
    ('by its height', {'lens': 30, 'sensor_fit': 'VERTICAL'}, SIZE),
    ('pixels not square', {'lens': 35, 'shift_x': 0.1}, {**SIZE, 'pixel_aspect_x': 2.0}),
    ('half size', {'lens': 50}, {**SIZE, 'resolution_percentage': 50}),
    ('parallel', {'type': 'ORTHO', 'ortho_scale': 7, 'shift_x': 0.1, 'shift_y': 0.05}, SIZE),
]


@cases(CAMERAS)
def camera_file_is_blenders_camera(scratch, _, camera, render):
    points, seen = run_blender(scratch, camera, render)
    with open(scratch.path('camera.0001.json'), encoding='utf-8') as file:
        found = json.load(file)
    check(os.path.exists(scratch.path('camera.0002.json')), 'frame 2 has no file')
    aspect = render['resolution_x'] * render.get('pixel_aspect_x', 1) / render['resolution_y']
    parallel = found.get('type') == 'orthographic'
    half = found['ortho_width'] / 2 if parallel \
        else np.tan(np.radians(found['fov_x_deg']) / 2)
    for point, wanted in zip(points, seen):
        x, y, z, _ = np.array(found['world_to_view']) @ [*point, 1]
        scale = 1 if parallel else -z
        ndc = np.array([x / scale / half, y / scale / (half / aspect)])
        ndc -= 2 * np.array([found['shift_x'], found['shift_y']])
        check(np.abs(ndc * 0.5 + 0.5 - wanted[:2]).max() < 1e-5 and abs(-z - wanted[2]) < 1e-4,
              f'{point} stands at {ndc * 0.5 + 0.5}, {-z}; Blender says {wanted}')


@cases([('cubes', False), ('heads', True)])
def render_is_understood_as_it_comes(scratch, _, heads):
    run_blender(scratch, {'lens': 31}, {**SIZE, 'resolution_x': 320, 'resolution_y': 180},
                scratch.path('shot.exr'), heads)
    views = []
    for options in ((), ('--camera', 'camera.0001.json')):
        got = scratch.render('inspect', 'shot.exr', '--json', *options)
        views.append(json.loads(got.stdout)['views'][0])
    matches('^estimated', views[0]['camera']['source'], 'source')
    half = [np.tan(np.radians(v['camera']['fov_x_deg']) / 2) for v in views]
    check(abs(half[0] / half[1] - 1) < 0.01, f'half widths {half}')
    for view in views:
        equal((view['conventions']['depth_type'], view['conventions']['normal_space']),
              ('planar', 'world'), 'conventions')


if __name__ == '__main__':
    main()
