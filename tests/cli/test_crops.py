#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Crops of real renders that were written without the display window of the whole: nothing but
depth and normals tells their lens shift. The corpus lies outside the repository: without it all
cases are skipped."""
import json
from functools import lru_cache

import numpy as np

from cli import cases, check, corpus, equal, main, read_parts, write_exr
from evidence import inspect


@lru_cache
def load(name, step=3):
    """Planar depth, normals, and the camera; every so-maniest texel."""
    planes = {channel: plane for part in read_parts(corpus(f'{name}.exr'))
              for channel, plane in part.channels.items()}
    with open(corpus(f'{name}.camera.json'), encoding='utf-8') as file:
        camera = json.load(file)
    is_mitsuba = 'dd.y.T' in planes
    depth = planes['dd.y.T' if is_mitsuba else 'ViewLayer.Depth.Z'].astype(np.float64)
    normal = np.stack([planes[('nn.' if is_mitsuba else 'ViewLayer.Normal.') + c] for c in 'XYZ'],
                      axis=-1)
    rows, columns = (size // step * step for size in depth.shape)
    across = np.tan(np.radians(camera['fov_x_deg'] / 2))
    x = ((np.arange(depth.shape[1]) + 0.5) / depth.shape[1] * 2 - 1) * across
    y = ((np.arange(depth.shape[0]) + 0.5) * 2 - depth.shape[0]) / depth.shape[1] * across
    stretch = np.sqrt(1 + x ** 2 + y[:, None] ** 2)
    if is_mitsuba:
        depth = np.where(depth == 0, 1e10, depth / stretch + camera['near'])
    # As much is left out at either side.
    left, top = (depth.shape[1] - columns) // 2, (depth.shape[0] - rows) // 2
    cut = (slice(top + step // 2, top + rows, step), slice(left + step // 2, left + columns, step))
    camera['half_width'] = across * columns / depth.shape[1]
    return depth[cut], normal[cut], stretch[cut], camera


def write_crop(scratch, image, window, kind='planar'):
    """And its camera, which is returned: field of view and lens shift."""
    depth, normal, stretch, camera = image
    (x, y, width, height), (rows, columns) = window, depth.shape
    if kind == 'radial':
        depth = np.where(depth < 1e9, depth * stretch, depth)
    cut = slice(y, y + height), slice(x, x + width)
    write_exr(scratch.path('in.exr'),
              {'Z': depth[cut].astype(np.float32),
               **{f'N.{c}': normal[cut][..., i].astype(np.float16) for i, c in enumerate('XYZ')}})
    fov = 2 * np.degrees(np.arctan(camera['half_width'] * width / columns))
    return fov, (x + (width - columns) / 2) / width, ((rows - height) / 2 - y) / height


# What was said to be sure to .5 % of each was off by 2 to 37 %, or lacked the shift.
CROPS = [('m3_statues_a', 'planar', (142, 0, 284, 160)),
         ('m3_statues_a', 'planar', (7, 90, 236, 150)),
         ('m3_statues_a', 'planar', (90, 40, 240, 170)),
         ('m3_statues_a', 'radial', (60, 10, 250, 170)),
         ('m3_cornell_a', 'planar', (142, 0, 284, 160)),
         ('m3_city_a', 'planar', (90, 60, 300, 150))]


@cases(CROPS, name=lambda row: f'{row[0]}, {row[1]}, {row[2]}')
def lens_shift_of_a_crop_is_found(scratch, name, kind, window):
    fov, shift_x, shift_y = write_crop(scratch, load(name), window, kind)
    view = inspect(scratch)
    found, said = view['camera'], str(view['warnings'])
    check('perhaps' not in said and 'looks squeezed' not in said, said)
    check(abs(found['fov_x_deg'] / fov - 1) < 0.01, f'{found["fov_x_deg"]} degrees, want {fov}')
    check(abs(found['shift_x'] - shift_x) < 0.01 and abs(found['shift_y'] - shift_y) < 0.01,
          f'shift {found["shift_x"]} {found["shift_y"]}, want {shift_x} {shift_y}')


# Fur, whose normals hardly follow it: no shift is found, and the field of view is off by 4 %.
@cases([((10, 0, 231, 130),), ((160, 90, 240, 150),), ((60, 0, 240, 140),)])
def what_a_shift_may_explain_is_not_sure(scratch, window):
    fov = write_crop(scratch, load('t2_fur'), window, 'radial')[0]
    view = inspect(scratch)
    said = str(view['warnings'])
    is_sure = 'by depth and normals it is' in said and 'perhaps' not in said
    check(not is_sure or abs(view['camera']['fov_x_deg'] / fov - 1) < 0.02,
          f'{view["camera"]["fov_x_deg"]} degrees, want {fov}: {said}')


@cases([('m3_sponza_a', (7, 79, 388, 132))])
def ends_of_things_are_no_bucket(scratch, name, window):
    fov = write_crop(scratch, load(name), window)[0]
    for options in (), ('--fov', fov):
        said = str(inspect(scratch, *options)['warnings'])
        check('a bucket of' not in said, said)


@cases([('t2_terrain_r10',)])
def rough_ground_with_normals_of_bytes_is_not_noisy(scratch, name):
    depth, normal, _, camera = load(name)
    write_exr(scratch.path('in.exr'),
              {'Z': depth.astype(np.float32),
               **{f'N.{c}': (np.round((normal[..., i] * 0.5 + 0.5) * 255) / 255).astype(np.float16)
                  for i, c in enumerate('XYZ')}})
    with open(scratch.path('c.json'), 'w', encoding='utf-8') as file:
        json.dump({key: camera[key] for key in ('type', 'fov_x_deg', 'world_to_view')}, file)
    said = str(inspect(scratch, '--camera', 'c.json')['warnings'])
    equal('depth is noisy' in said, False, said)


@cases([('b5_suzannes_a', 55)])
def wrong_field_of_view_is_no_near_plane(scratch, name, fov):
    depth, normal, _, camera = load(name)
    write_crop(scratch, (depth, normal, None, camera), (0, 0, *reversed(depth.shape)))
    with open(scratch.path('c.json'), 'w', encoding='utf-8') as file:
        json.dump({'fov_x_deg': fov, 'world_to_view': camera['world_to_view']}, file)
    said = str(inspect(scratch, '--camera', 'c.json')['warnings'])
    check('but depth and normals' in said and 'near plane' not in said, said)


if __name__ == '__main__':
    main()
