#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""vkao-bench quality --sequence: flicker of a ball before a wall under a moving camera, recomputed
from files of vkao."""
import json

import numpy as np

from cli import INPUT, OK, USAGE, beside_vkao, case, cases, check, equal, main, read_ao, write_exr

WIDTH, HEIGHT, FRAMES, RADIUS = 96, 54, 8, 0.5
HALF = {'perspective': np.tan(np.radians(35)), 'orthographic': 2.5}  # half widths of the image
CROP = (5, 3, 80, 45)  # left, top, right, bottom of a data window
BALL, BALL_RADIUS, WALL = np.array([0.0, 0.6, 0.0]), 0.6, -0.9
PLAIN = '--sequence', '--no-raymarch', '--runs', 1, '--quiet', '--radius', RADIUS


class Frame:
    """What a camera sees that moves, turns and rolls; rays and positions are in the world."""

    def __init__(self, number, kind='perspective', width=WIDTH, height=HEIGHT):
        yaw, pitch, roll = 0.3 + 0.02 * number, 0.35 + 0.004 * number, 0.01 * number
        self.kind, self.shape = kind, (height, width)
        self.turn = turned(2, roll) @ turned(0, pitch) @ turned(1, yaw)
        self.eye = np.array([1.2 - 0.06 * number, 1.9, 3.6 - 0.05 * number])
        column, row = np.meshgrid(np.arange(width), np.arange(height))
        self.origin, self.ray = self.sight(column, row)
        self.trace()

    def sight(self, column, row):
        """Where rays start, and their directions, of which the view axis has length 1."""
        height, width = self.shape
        x = ((column + 0.5) / width * 2 - 1) * HALF[self.kind]
        y = (1 - (row + 0.5) / height * 2) * HALF[self.kind] * height / width
        none, one = np.zeros_like(x), np.ones_like(x)
        start, way = (none, none, none), (x, y, -one)
        if self.kind == 'orthographic':
            start, way = (x, y, none), (none, none, -one)
        return np.stack(start, -1) @ self.turn + self.eye, np.stack(way, -1) @ self.turn

    def trace(self):
        up, front = np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0])
        self.z = np.full(self.shape, np.inf)
        self.normal = np.zeros(self.shape + (3,))
        with np.errstate(divide='ignore', invalid='ignore'):
            self.meet(-self.origin[..., 1] / self.ray[..., 1], lambda at: up + 0 * at,
                      lambda at: np.abs(at[..., 0]) < 3)
            self.meet((WALL - self.origin[..., 2]) / self.ray[..., 2], lambda at: front + 0 * at,
                      lambda at: (at[..., 1] > 0) & (at[..., 1] < 1))
            square, from_ball = (self.ray ** 2).sum(-1), self.origin - BALL
            along = (self.ray * from_ball).sum(-1)
            root = along ** 2 - square * ((from_ball ** 2).sum(-1) - BALL_RADIUS ** 2)
            self.meet((-along - np.sqrt(root)) / square, lambda at: (at - BALL) / BALL_RADIUS,
                      lambda at: root > 0)
        self.sky = np.isinf(self.z)
        self.z = self.z.astype(np.float32).astype(float)
        self.normal = self.normal.astype(np.float32).astype(float)
        self.position = self.origin + self.ray * np.where(self.sky, 1, self.z)[..., None]
        # Any smooth image will do; one that is as bright as AO, and moves with the view.
        bright = 0.8 + 0.1 * np.sin(3 * self.position[..., 0] + self.turn[0, 2] * 20)
        self.truth = bright.astype(np.float32)

    def meet(self, z, normal, reaches):
        """A surface, where it is the nearest so far."""
        at = self.origin + self.ray * z[..., None]
        nearer = (z > 0) & (z < self.z) & reaches(at)
        self.z = np.where(nearer, z, self.z)
        self.normal = np.where(nearer[..., None], normal(at), self.normal)

    def camera(self):
        rows = np.eye(4)
        rows[:3, :3], rows[:3, 3] = self.turn, -self.turn @ self.eye
        size = {'perspective': ('fov_x_deg', 70.0), 'orthographic': ('ortho_width', 5.0)}[self.kind]
        return {'type': self.kind, size[0]: size[1], 'world_to_view': rows.tolist()}

    def crop(self):
        left, top, right, bottom = CROP
        for name in ('origin', 'ray', 'z', 'sky', 'position', 'normal', 'truth'):
            setattr(self, name, getattr(self, name)[top:bottom + 1, left:right + 1])
        return self


def turned(axis, angle):
    """About x, y or z."""
    a, b = [i for i in range(3) if i != axis]
    matrix = np.eye(3)
    matrix[a, a] = matrix[b, b] = np.cos(angle)
    matrix[a, b], matrix[b, a] = -np.sin(angle), np.sin(angle)
    return matrix


# --- Flicker by hand ---

def cosine(a, b):
    with np.errstate(divide='ignore', invalid='ignore'):
        return (a * b).sum(-1) / np.linalg.norm(a, axis=-1) / np.linalg.norm(b, axis=-1)


def find(points, normals, frame, corner):
    """Rows and columns in the arrays of the frame, and which of the points are seen there."""
    view = (points - frame.eye) @ frame.turn.T
    z = -view[:, 2]
    height, width = frame.shape
    scale = HALF[frame.kind] * (1 if frame.kind == 'orthographic' else z)
    column = np.rint((view[:, 0] / scale + 1) / 2 * width - 0.5).astype(int) - corner[0]
    row = np.rint((1 - view[:, 1] / scale * width / height) / 2 * height - 0.5).astype(int)
    row -= corner[1]
    rows, columns = frame.z.shape
    seen = (z > 0) & (column >= 0) & (column < columns) & (row >= 0) & (row < rows)
    at = np.clip(row, 0, rows - 1), np.clip(column, 0, columns - 1)
    there, ray = frame.z[at], frame.ray[at]
    plane = ((points - frame.origin[at]) * normals).sum(-1) / (ray * normals).sum(-1)
    deep = (np.abs(there - z) < 0.01 * z) | (np.abs(there - plane) < 0.01 * z)
    return at, seen & deep & (cosine(frame.normal[at], normals) > np.cos(np.radians(10)))


def flicker(frames, ao, corner=(0, 0)):
    """The figure, and the share of points that it counts."""
    world = ~frames[0].sky
    points, normals = frames[0].position[world], frames[0].normal[world]
    series = np.full((len(frames), len(points)), np.nan)
    for errors, frame, image in zip(series, frames, ao):
        at, seen = find(points, normals, frame, corner)
        errors[seen] = (image - frame.truth.astype(float))[at][seen]
    often = np.isfinite(series).sum(0) >= max(3, len(frames) / 2)
    check(0.3 < often.mean() < 0.98, f'{often.mean()} of the points are followed')
    return np.sqrt(np.nanvar(series[:, often], axis=0, ddof=1).mean()), often.mean()


# --- Files ---

def write(scratch, number, frame, name=None, **window):
    stem = scratch.path(name or f'f.{number:04d}')
    depth = np.where(frame.sky, 1e10, frame.z).astype(np.float32)
    normal = {f'N.{c}': frame.normal[..., i].astype(np.float32) for i, c in enumerate('XYZ')}
    write_exr(f'{stem}.exr', {'Z': depth, **normal}, **window)
    write_exr(f'{stem}.gt.exr', {'AO_falloff': frame.truth}, **window)
    with open(f'{stem}.camera.json', 'w', encoding='utf-8') as file:
        json.dump(frame.camera(), file)


def bench(*options):
    return 'quality', '.', *PLAIN, '--falloff', 'smooth', '--methods', 'vbao-fast', *options


def program():
    return beside_vkao('..', 'bench', 'vkao-bench')


def measure(scratch, *options):
    result = scratch.run(*bench('--json', 'x.json', *options), program=program())
    equal(result.code, OK, str(result))
    return json.loads(scratch.bytes('x.json'))


def refuse(scratch, code, message, *options, hint=None):
    scratch.fails(code, message, *bench(*options), hint=hint, program=program())


def write_all(scratch):
    for number in range(1, 4):
        write(scratch, number, Frame(number, width=48, height=27))


# --- Cases ---

@cases([('perspective', 'perspective', False), ('orthographic', 'orthographic', False),
        ('cropped', 'perspective', True)])
def flicker_is_that_of_points_of_the_world(scratch, _, kind, is_cropped):
    frames = [Frame(number, kind) for number in range(FRAMES)]
    window, corner = {}, (0, 0)
    if is_cropped:
        frames, corner = [frame.crop() for frame in frames], CROP[:2]
        window = {'x': CROP[0], 'y': CROP[1], 'display': (0, 0, WIDTH - 1, HEIGHT - 1)}
    for number, frame in enumerate(frames):
        write(scratch, number, frame, **window)
    results = measure(scratch)
    scratch.render('f.####.exr', '-o', 'ao.####.exr', '--camera', 'f.####.camera.json', '--radius',
                   RADIUS, '--quality', 'fast', '--pixel-type', 'float')
    ao = [read_ao(scratch.path(f'ao.{number:04d}.exr')).astype(float) for number in range(FRAMES)]
    wanted, share = flicker(frames, ao, corner)
    found = results['means'][0]['flicker']
    check(wanted > 0.005, f'{wanted} is no flicker')
    check(abs(found / wanted - 1) < 1e-4, f'flicker is {found}, want {wanted}')
    check(abs(results['tracked_share'] - share) < 2e-3,
          f'{results["tracked_share"]} of the points are tracked, want {share}')
    equal([image['results'][0]['flicker'] for image in results['images']], [None] * FRAMES,
          'flicker of a frame alone')


@case
def tables_have_the_column_of_a_sequence_alone(scratch):
    write_all(scratch)
    figure = f'{measure(scratch)["means"][0]["flicker"]:.4f}'
    for form in ('--text', '--markdown'):
        result = scratch.run(*bench(form), program=program())
        check(' flicker ' in result.stdout and f' {figure} ' in result.stdout, result.stdout)
    alone = [word for word in bench('--text') if word != '--sequence']
    result = scratch.run(*alone, program=program())
    equal((result.code, 'flicker' in result.stdout.lower()), (OK, False), str(result))


@case
def frames_go_by_their_numbers(scratch):
    for number in (9, 10, 11):
        write(scratch, number, Frame(number, width=48, height=27), f'f.{number}')
    names = [image['name'] for image in measure(scratch)['images']]
    equal(names, ['f.9', 'f.10', 'f.11'], 'order')


@case
def frames_are_of_one_size(scratch):
    write_all(scratch)
    write(scratch, 2, Frame(2, width=40, height=27))
    refuse(scratch, INPUT, r'f\.0002\.exr: 40 x 27 texels, want 48 x 27 as f\.0001\.exr has$')


@case
def cameras_have_a_place(scratch):
    write_all(scratch)
    camera = {k: v for k, v in Frame(3).camera().items() if k != 'world_to_view'}
    scratch.write('f.0003.camera.json', json.dumps(camera))
    refuse(scratch, INPUT, r"f\.0003\.camera\.json: no 'world_to_view', which a sequence needs$")


@case
def points_have_normals(scratch):
    write_all(scratch)
    write_exr(scratch.path('f.0002.exr'), {'Z': Frame(2, width=48, height=27).z.astype(np.float32)})
    refuse(scratch, INPUT, r'f\.0002\.exr: no normals, which a sequence needs$')


@case
def names_are_those_of_one_sequence(scratch):
    write_all(scratch)
    refuse(scratch, INPUT, 'a sequence of 1, want at least 3', '--files', '0001', hint='--files')
    write(scratch, 0, Frame(0, width=48, height=27), 'g.0001')
    refuse(scratch, INPUT, r'g\.0001\.exr: no frame of the sequence of f\.0001\.exr',
           hint='--files')
    write(scratch, 0, Frame(0, width=48, height=27), 'alone')
    refuse(scratch, INPUT, r'alone\.exr: no frame of a sequence', hint='STEM.NUMBER')
    equal(len(measure(scratch, '--files', 'f.')['images']), 3, 'frames chosen')


@case
def frames_are_not_fitted_apart(scratch):
    write_all(scratch)
    refuse(scratch, USAGE, '--fitted with --sequence', '--fitted', 'f.*')


if __name__ == '__main__':
    main()
