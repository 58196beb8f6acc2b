# SPDX-License-Identifier: MIT
"""An analytic G-buffer: a sphere on a floor before a low wall, with sky above.

View space as in OpenGL: x right, y up, the camera at the origin looking along -z."""
import json

import numpy as np

WIDTH, HEIGHT, FOV = 160, 90, 60.0
NEAR, FAR = 0.5, 40.0
FLOOR, WALL, WALL_TOP = -1.0, -6.0, 0.4
BALL, BALL_RADIUS = np.array([0.2, -0.5, -3.5]), 0.5
RADIUS = 0.5  # that occlusion is computed with

# Some camera: 30 degrees to the side, 20 degrees down, away from the origin.
_A, _B = np.radians(30.0), np.radians(-20.0)
TURN = np.array([[1, 0, 0], [0, np.cos(_B), -np.sin(_B)], [0, np.sin(_B), np.cos(_B)]]) @ \
    np.array([[np.cos(_A), 0, -np.sin(_A)], [0, 1, 0], [np.sin(_A), 0, np.cos(_A)]])
MOVE = np.array([1.0, -2.0, 3.0])


class Scene:
    """z: distance along the view axis, infinite in the sky; normal: view space, 0 in the sky;
    stretch: length of the ray whose z is 1."""

    def __init__(self, width=WIDTH, height=HEIGHT, fov=FOV, pixel_aspect=1.0, eye=0.0):
        half = np.tan(np.radians(fov) / 2)
        x = ((np.arange(width) + 0.5) / width * 2 - 1) * half
        y = (1 - (np.arange(height) + 0.5) / height * 2) * half * height / (width * pixel_aspect)
        self.x, self.y = np.meshgrid(x, y)
        self.stretch = np.sqrt(1 + self.x ** 2 + self.y ** 2)
        self.z = np.full((height, width), np.inf)
        self.normal = np.zeros((height, width, 3))
        with np.errstate(divide='ignore', invalid='ignore'):
            self._trace(BALL - np.array([eye, 0, 0]))
        self.sky = np.isinf(self.z)

    def _take(self, z, normal, where):
        nearer = where & (z > 0) & (z < self.z)
        self.z = np.where(nearer, z, self.z)
        self.normal = np.where(nearer[..., None], normal, self.normal)

    def _trace(self, ball):
        up = np.array([0.0, 1.0, 0.0])
        floor = FLOOR / self.y
        self._take(floor, up, (self.y < 0) & (floor < -WALL))
        wall = np.full_like(self.x, -WALL)
        self._take(wall, np.array([0.0, 0.0, 1.0]), -WALL * self.y < WALL_TOP)
        ray = np.stack([self.x, self.y, -np.ones_like(self.x)], axis=-1)
        along = ray @ ball
        root = along ** 2 - self.stretch ** 2 * (ball @ ball - BALL_RADIUS ** 2)
        z = (along - np.sqrt(root)) / self.stretch ** 2
        self._take(z, (ray * z[..., None] - ball) / BALL_RADIUS, root > 0)

    def depth(self, kind='planar', near=NEAR, far=FAR):
        """What a renderer of this convention writes, with its background."""
        with np.errstate(invalid='ignore'):
            values = {
                'planar': (self.z, 1e10),
                'radial': (self.z * self.stretch, np.inf),
                'radial-near': ((self.z - near) * self.stretch, 0),
                'inverse': (1 / self.z, 0),
                'device': (far / (far - near) - far * near / ((far - near) * self.z), 1),
                'reversed': (near * far / ((far - near) * self.z) - near / (far - near), 0),
                'ortho': (self.z, 1e10),
            }[kind]
        return np.where(self.sky, values[1], values[0]).astype(np.float32)

    def normals(self, layer='N', space='camera', encoding='signed', letters='XYZ'):
        n = self.normal @ TURN if space == 'world' else self.normal  # TURN's inverse, row vectors
        if encoding == 'unsigned':
            n = np.where(self.sky[..., None], 0, n * 0.5 + 0.5)
        return {f'{layer}.{c}': n[..., i].astype(np.float32) for i, c in enumerate(letters)}

    def color(self, alpha=True):
        """Above one, since images of renderers are, and with alpha between 0 and 1."""
        i, j = np.meshgrid(np.arange(self.z.shape[1]), np.arange(self.z.shape[0]))
        planes = {'R': 0.2 + i / 100, 'G': 0.3 + j / 100, 'B': 0.1 + (i + j) / 300,
                  'A': np.where(self.sky, 0.0, 0.25 + 0.5 * (i % 7 == 0))}
        return {k: v.astype(np.float32) for k, v in planes.items() if alpha or k != 'A'}


# Corners of boxes: the ceiling and two walls of a room.
CORNER = [((-50, 3.5, -50), (50, 9, 50)), ((-50, -50, -12), (50, 50, -9)),
          ((-9, -50, -50), (-6, 50, 50))]


def with_box(ray, low, high, axes, z, normal):
    """Depth and normals with a box between two corners before them. ray: along the box's axes."""
    # Whole planes: numpy takes three times as long along rows of three.
    ray = np.moveaxis(ray, -1, 0).copy()
    low, high = low[:, None, None], high[:, None, None]
    with np.errstate(divide='ignore', invalid='ignore'):
        near, far = low / ray, high / ray
    enter, leave = np.minimum(near, far), np.maximum(near, far).min(axis=0)
    face, enter = enter.argmax(axis=0), enter.max(axis=0)
    is_hit = (enter < leave) & (enter > 0) & (enter < z)
    face = face[is_hit]
    side = -np.sign(ray[:, is_hit][face, np.arange(face.size)])
    z, normal = z.copy(), normal.copy()
    z[is_hit], normal[is_hit] = enter[is_hit], side[:, None] * axes[face]
    return z, normal


def boards(width=640, height=360):
    """Boards standing on a floor, turned all ways and seen from above: their tops, a texel or two
    wide, face as the floor behind them does. Depth and normals, in camera space."""
    scene, random = Scene(width, height), np.random.default_rng(7)
    up, eye = np.array([0, np.cos(0.7), np.sin(0.7)]), 4.0
    right, forward = np.array([1.0, 0, 0]), np.array([0, np.sin(0.7), -np.cos(0.7)])
    ray = np.stack([scene.x, scene.y, -np.ones_like(scene.x)], axis=-1)
    z, normal = -eye / (ray @ up), np.broadcast_to(up, ray.shape)
    half = np.array([0.3, 0.015, 0.25])
    for _ in range(40):
        turn, (x, y) = random.uniform(0, np.pi), random.uniform([-2.5, 2.5], [2.5, 7.5])
        axes = np.stack([right * np.cos(turn) + forward * np.sin(turn),
                         forward * np.cos(turn) - right * np.sin(turn), up])
        middle = axes @ (right * x + forward * y + up * (0.25 - eye))
        z, normal = with_box(ray @ axes.T, middle - half, middle + half, axes, z, normal)
    return z.astype(np.float32), {f'N.{c}': normal[..., i].astype(np.float32)
                                  for i, c in enumerate('XYZ')}


def boxes_along_axes(boxes, width, height, aspect=1.0, shift=(0, 0), turn=TURN):
    """Depth and normals of boxes, each two corners, that are parallel to the axes of the world."""
    half = np.tan(np.radians(FOV / 2))
    x = ((np.arange(width) + 0.5) / width * 2 - 1 + 2 * shift[0]) * half
    y = (1 - (np.arange(height) + 0.5) / height * 2 + 2 * shift[1]) * half * height / \
        (width * aspect)
    x, y = np.meshgrid(x, y)
    ray = np.stack([x, y, -np.ones_like(x)], axis=-1) @ turn
    z, normals = np.full_like(x, np.inf), np.zeros((height, width, 3))
    for low, high in boxes:
        z, normals = with_box(ray, np.array(low), np.array(high), np.eye(3), z, normals)
    return {'Z': np.where(np.isinf(z), 1e10, z).astype(np.float32),
            **{f'N.{c}': normals[..., i].astype(np.float32) for i, c in enumerate('XYZ')}}


def camera(fov=FOV, **more):
    """The camera of the scene as the object of a camera file."""
    rows = np.eye(4)
    rows[:3, :3], rows[:3, 3] = TURN, MOVE
    return {'type': 'perspective', 'fov_x_deg': fov, 'near': NEAR, 'far': FAR,
            'world_to_view': rows.tolist(), **more}


def write_camera(path, value=None):
    with open(path, 'w', encoding='utf-8') as file:
        json.dump(value if value is not None else camera(), file)
    return path
