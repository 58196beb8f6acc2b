#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""What other programs show of what vkao writes: ImageMagick, ffmpeg and Blender, where they are
installed. Of Blender either the program is taken, or a Python with its module bpy, which
VKAO_BPY_PYTHON may name."""
import json
import os
import shutil
import subprocess
import sys

import numpy as np

from cli import (TIMEOUT, USAGE, case, cases, check, check_close, equal, main, read_ao, read_parts,
                 run_tool, skip, write_exr)
from scene import FOV, RADIUS, Scene

SCENE = Scene(96, 54)
VIEW = ('--fov', FOV, '--radius', RADIUS, '--normal-space', 'camera')
BLENDER = (('BlenderMultiChannel', 'Blender V2.55.1 and newer'),)
# Prints what a compositor's image node offers, by layer, or the pixels of a plain image.
LIST_PASSES = r'''
import bpy, json, sys
image = bpy.data.images.load(sys.argv[-1])
tree = bpy.data.node_groups.new('tree', 'CompositorNodeTree') \
    if hasattr(bpy.types, 'NodesModifier') and bpy.app.version >= (5, 0) else None
if tree is None:
    bpy.context.scene.use_nodes = True
    tree = bpy.context.scene.node_tree
node = tree.nodes.new('CompositorNodeImage')
node.image = image
found = {'type': image.type, 'layers': {}}
if node.has_layers:
    try:
        node.layer = '?'
    except TypeError as error:
        names = eval(str(error).split('not found in', 1)[1])
    for name in (names,) if isinstance(names, str) else names:
        node.layer = name
        found['layers'][name] = [o.name for o in node.outputs if o.enabled]
else:
    found['layers'][''] = [o.name for o in node.outputs if o.enabled]
    found['pixels'] = list(image.pixels)[::image.channels or 1]
print('FOUND ' + json.dumps(found))
'''


def blender_command():
    """What runs a Python script in Blender; the script follows."""
    if shutil.which('blender'):
        return ['blender', '--background', '--factory-startup', '--python']
    for python in (os.environ.get('VKAO_BPY_PYTHON'), sys.executable, shutil.which('python3')):
        if python and subprocess.run([python, '-c', 'import bpy'], capture_output=True,
                                     timeout=TIMEOUT, check=False).returncode == 0:
            return [python]
    return None


def blender_finds(scratch, name):
    command = blender_command()
    if not command:
        skip('no Blender, nor a Python with its module bpy (VKAO_BPY_PYTHON may name one)')
    scratch.write('list.py', LIST_PASSES)
    end = [] if 'blender' not in command[0] else ['--']
    done = subprocess.run([*command, scratch.path('list.py'), *end, scratch.path(name)],
                          capture_output=True, text=True, timeout=TIMEOUT, check=False)
    lines = [line for line in done.stdout.splitlines() if line.startswith('FOUND ')]
    check(lines, f'{command}: {done.stdout}{done.stderr}')
    return json.loads(lines[0][6:])


def write_ao(scratch, *options):
    write_exr(scratch.path('in.exr'), {'Z': SCENE.depth(), **SCENE.normals()})
    scratch.render('in.exr', '-o', 'ao.exr', *VIEW, *options)
    return read_ao(scratch.path('ao.exr'))


@case
def imagemagick_shows_ao_alone(scratch):
    wanted = write_ao(scratch)
    # By Debian's own name first: 'convert' may be of another program.
    names = ('magick', 'convert-im6.q16', 'convert')
    tool = next(filter(shutil.which, names), names[-1])
    if 'EXR' not in run_tool(tool, '-list', 'format'):
        skip('ImageMagick is not installed, or was built without OpenEXR')
    run_tool(tool, 'ao.exr', '-set', 'colorspace', 'sRGB', '-depth', '16', 'gray:ao.raw',
             cwd=scratch.directory)
    shown = np.frombuffer(scratch.bytes('ao.raw'), np.uint16).reshape(wanted.shape) / 65535
    check_close(shown, wanted, 1e-3, 1e-3, 'picture')


@case
def ffmpeg_shows_ao_alone(scratch):
    wanted = write_ao(scratch)
    run_tool('ffmpeg', '-v', 'error', '-i', 'ao.exr', '-f', 'rawvideo', '-pix_fmt', 'gray16le',
             'ao.raw', cwd=scratch.directory)
    shown = np.frombuffer(scratch.bytes('ao.raw'), '<u2').reshape(wanted.shape) / 65535
    check_close(shown, wanted, 1e-3, 1e-3, 'picture')


@case
def blender_shows_ao_alone(scratch):
    wanted = write_ao(scratch)
    found = blender_finds(scratch, 'ao.exr')
    equal(found['type'], 'IMAGE', 'type')
    shown = np.array(found['pixels']).reshape(wanted.shape)[::-1]
    check_close(shown, wanted, 1e-3, 1e-3, 'picture')


@case
def channel_takes_another_name(scratch):
    wanted = write_ao(scratch)
    scratch.render('in.exr', '-o', 'named.exr', '--channel', 'occlusion.R', *VIEW)
    equal(list(read_parts(scratch.path('named.exr'))[0].channels), ['occlusion.R'], 'channels')
    check_close(read_ao(scratch.path('named.exr'), 'occlusion.R'), wanted, 0, 0, 'AO')
    scratch.render('in.exr', '-o', 'more.exr', '--mode', 'append', '--channel', 'R', *VIEW)
    equal(list(read_parts(scratch.path('more.exr'))[1].channels), ['R'], 'channels')
    scratch.fails(USAGE, '--channel names the channel of AO, which --mode comp does not write',
                  'in.exr', '-o', 'x.exr', '--mode', 'comp', '--channel', 'R', *VIEW)
    scratch.fails(USAGE, "--channel is 'bent.X', which --bent-normals writes", 'in.exr', '-o',
                  'x.exr', '--bent-normals', '--channel', 'bent.X', *VIEW)


# --- Appended to a file of Blender's ---

def layer(name, **planes):
    return {f'{name}.{key.replace("_", ".")}': plane for key, plane in planes.items()}


def blender_planes(name='ViewLayer', scene=SCENE):
    colors, normals = scene.color(), scene.normals()
    return layer(name, **{f'Combined_{c}': colors[c] for c in 'RGBA'}, Depth_Z=scene.depth(),
                 **{f'Normal_{c}': normals[f'N.{c}'] for c in 'XYZ'})


def append(scratch, *parts):
    write_exr(scratch.path('in.exr'), *parts, attributes=BLENDER)
    scratch.render('in.exr', '-o', 'out.exr', '--mode', 'append', *VIEW)
    return read_parts(scratch.path('out.exr'))


@cases([('one view layer', 'ViewLayer'), ('dots', 'View.Layer.001'), ('spaces', 'Render Layer')])
def appended_layer_is_called_as_blender_calls_it(scratch, _, name):
    parts = append(scratch, blender_planes(name))
    equal([(p.name, list(p.channels)) for p in parts[1:]], [(f'{name}.AO', [f'{name}.AO.V'])],
          'the new part')
    equal(parts[0].name, '', 'name of the old part')


@case
def pass_of_the_same_name_is_avoided(scratch):
    planes = {**blender_planes(), **layer('ViewLayer', **{f'AO_{c}': SCENE.depth() for c in 'RGB'})}
    parts = append(scratch, planes)
    equal([(p.name, list(p.channels)) for p in parts[1:]],
          [('ViewLayer.SSAO', ['ViewLayer.SSAO.V'])], 'the new part')


@case
def parts_of_passes_and_views_are_followed(scratch):
    other, parts = Scene(96, 54, eye=0.3), []
    for view, scene in (('left', SCENE), ('right', other)):
        planes = blender_planes(scene=scene)
        for name in ('Combined', 'Depth', 'Normal'):
            own = {k: v for k, v in planes.items() if f'.{name}.' in k}
            parts.append((own, {'name': f'ViewLayer.{name}-{view}', 'view': view}))
    write_exr(scratch.path('in.exr'), *parts, attributes=BLENDER)
    scratch.render('in.exr', '-o', 'out.exr', '--mode', 'append', '--view', 'all', *VIEW)
    added = read_parts(scratch.path('out.exr'))[6:]
    equal([(p.name, p.attributes['view'], list(p.channels)) for p in added],
          [(f'ViewLayer.AO-{v}', v, ['ViewLayer.AO.V']) for v in ('left', 'right')], 'new parts')


@case
def others_keep_the_plain_names(scratch):
    """A layer alone does not make a file Blender's."""
    write_exr(scratch.path('in.exr'), blender_planes())
    scratch.render('in.exr', '-o', 'out.exr', '--mode', 'append', *VIEW)
    part = read_parts(scratch.path('out.exr'))[1]
    equal((part.name, list(part.channels)), ('ao', ['AO']), 'the new part')
    write_exr(scratch.path('in.exr'), blender_planes(), attributes=BLENDER)
    scratch.render('in.exr', '-o', 'named.exr', '--mode', 'append', '--part-name', 'mine', *VIEW)
    equal(read_parts(scratch.path('named.exr'))[1].name, 'mine', 'the new part')


@case
def blender_lists_the_appended_pass(scratch):
    append(scratch, blender_planes())
    before, after = (blender_finds(scratch, f)['layers'] for f in ('in.exr', 'out.exr'))
    equal(sorted(after), ['ViewLayer'], 'layers')
    equal(sorted(after['ViewLayer']), sorted([*before['ViewLayer'], 'AO']), 'passes')


@case
def blender_keeps_the_layers_of_others(scratch):
    write_exr(scratch.path('in.exr'), {**SCENE.color(), 'Z': SCENE.depth(), **SCENE.normals()})
    scratch.render('in.exr', '-o', 'out.exr', '--mode', 'append', *VIEW)
    before, after = (blender_finds(scratch, f)['layers'] for f in ('in.exr', 'out.exr'))
    equal(sorted(after['']), sorted([*before[''], 'ao']), 'passes')


if __name__ == '__main__':
    main()
