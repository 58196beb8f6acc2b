# SPDX-License-Identifier: MIT
"""What tests of evidence share: a scene as a program writes it, its AO with nothing left to guess,
and what inspect says of it."""
import json

import numpy as np

from cli import OK, check, compute_ao, equal, oiio
from scene import FOV, MOVE, TURN, Scene

ENOUGH = 0.012  # root mean square difference of AO that is nobody's business
OPTIONS = ('--pixel-type', 'float', '--overwrite', 'always')


def hidden(share, fov=FOV, **more):
    """The scene with sky to the right, so that it takes this share of the image."""
    scene = Scene(fov=fov, **more)
    for column in reversed(range(scene.z.shape[1])):
        if scene.sky.mean() >= share:
            break
        scene.z[:, column] = np.inf
        scene.normal[:, column] = 0
        scene.sky[:, column] = True
    return scene


def depth_of(scene, background, unit=1.0):
    return np.where(scene.sky, background, scene.z * unit).astype(np.float32)


def run(scratch, channels, *options, **layout):
    return compute_ao(scratch, channels, *OPTIONS, *options, **layout)


def clean(scratch, scene, *options, fov=FOV, unit=1.0, normals=True):
    """AO of the same G-buffer with nothing left to guess."""
    channels = {'Z': depth_of(scene, 1e10, unit), **(scene.normals() if normals else {})}
    return run(scratch, channels, '--depth-type', 'planar', '--normal-space', 'camera', '--fov',
               fov, *options)


def check_same(ao, wanted, what):
    error = np.sqrt(np.mean((ao.astype(np.float64) - wanted) ** 2))
    check(error <= ENOUGH, f'{what}: RMSE {error:.4f}')


def inspect(scratch, *options, code=OK):
    result = scratch.run('inspect', 'in.exr', '--json', *options)
    equal(result.code, code, f'exit code of {result}')
    return json.loads(result.stdout)['views'][0]


def inspect_and_hear(scratch, *options, code=OK):
    """Also what it says."""
    result = scratch.run('inspect', 'in.exr', '--json', '-v', *options)
    equal(result.code, code, str(result))
    return json.loads(result.stdout)['views'][0], result.stderr


def rotation_header():
    """worldToCamera for row vectors, looking along +z."""
    to_camera = np.eye(4)
    to_camera[:3, :3] = np.diag([1, 1, -1]) @ TURN
    to_camera[:3, 3] = np.diag([1, 1, -1]) @ MOVE
    return [('worldToCamera', oiio.TypeDesc('matrix'),
             tuple(float(v) for v in to_camera.T.flatten()))]
