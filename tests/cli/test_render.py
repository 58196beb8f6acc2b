#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""vkao render: the ways that files come in and go out, and what must not change the result."""
import json
import os
import struct

import numpy as np

from cli import (CHANNELS, TIMEOUT, case, cases, check, check_ao, check_close, compute_ao, equal,
                 main, oiio, read_ao, read_parts, run_tool, write_exr)
from exr_raw import COMPRESSIONS, read_raw
from scene import BALL, BALL_RADIUS, FOV, HEIGHT, RADIUS, WIDTH, Scene

SCENE = Scene()
# One view of all cases: what is compared must not differ in anything else.
VIEW = ('--fov', FOV, '--radius', RADIUS)
COMPRESSED = [c for c in COMPRESSIONS if c != 'none']


def gbuffer(color=False):
    channels = {'Z': SCENE.depth(), **SCENE.normals()}
    return {**channels, **SCENE.color()} if color else channels


def reference(scratch, *options):
    """The result that other ways must reproduce."""
    return compute_ao(scratch, gbuffer(), '--pixel-type', 'float', '--overwrite', 'always', *VIEW,
                      *options, source='reference.exr', target='reference.ao.exr')[0]


def result(scratch, name, *options, **more):
    scratch.render(name, '-o', 'result.exr', '--pixel-type', 'float', '--overwrite', 'always',
                   *(options or VIEW), **more)
    return read_ao(scratch.path('result.exr'))


# --- What the result is ---

# The most that AO may be where the ball touches the floor. Horizons alone see least of it.
METHODS = {'sphere': 0.75, 'hemisphere': 0.75, 'hbao': 0.85, 'gtao': 0.75, 'vbao': 0.75,
           'raymarch': 0.75}


@case
def contact_is_dark_and_open_floor_is_not(scratch):
    place = np.stack([SCENE.x, SCENE.y, -np.ones_like(SCENE.x)], axis=-1) * SCENE.z[..., None]
    floor = SCENE.normal[..., 1] == 1
    touch = np.linalg.norm(place - (BALL - [0, BALL_RADIUS, 0]), axis=-1)
    contact, bare = floor & (touch < 0.25), floor & (touch > 1.5) & (SCENE.z < 4.5)
    check(contact.sum() > 20 and bare.sum() > 500, f'{contact.sum()} and {bare.sum()} texels')
    for method, limit in METHODS.items():
        ao = reference(scratch, '--method', method, '--samples', 64)
        check_ao(ao, method)
        check(ao[bare].mean() > 0.97, f'{method}: open floor is {ao[bare].mean()}')
        check(ao[contact].mean() < limit, f'{method}: contact is {ao[contact].mean()}')


@case
def images_as_large_as_buffers_can_be(scratch):
    """8192 x 4076 view z with its padding is just over 128 MiB, which is what lavapipe allows."""
    depth = np.full((4076, 8192), 3.0, np.float32)
    depth[:2000] = 1e10
    # Compression is checked elsewhere, and takes seconds here.
    write_exr(scratch.path('large.exr'), {'Z': depth}, compression='none')
    ao = result(scratch, 'large.exr', '--compression', 'none', '--fov', 50, '--normal', 'none',
                '--radius', 0.1, '--steps', 1, '--blur', 0, timeout=5 * TIMEOUT)
    equal(ao.shape, depth.shape, 'size')
    check(np.all(ao[:1990] == 1) and abs(ao[2100:].mean() - 1) < 0.01,
          'a wall under the sky is open')


@case
def sky_is_exactly_one_for_all_methods_and_pixel_types(scratch):
    write_exr(scratch.path('in.exr'), gbuffer())
    for method in METHODS:
        # The widest blur takes seconds to compile, and does not know the method.
        blur = 16 if method == 'sphere' else 4
        for pixel in ('half', 'float'):
            scratch.render('in.exr', '-o', 'ao.exr', '--overwrite', 'always', '--method', method,
                           '--pixel-type', pixel, '--power', 3, '--blur', blur, *VIEW)
            sky = read_ao(scratch.path('ao.exr'))[SCENE.sky]
            check(sky.size > 500 and (sky == 1).all(), f'{method} {pixel}: {np.unique(sky)[:5]}')


@cases([('zero', 0), ('far', 1e10), ('infinite', np.inf), ('nan', np.nan), ('negative', -1)])
def image_of_background_alone_is_one(scratch, _, value):
    write_exr(scratch.path('in.exr'), {'Z': np.full((20, 30), value, np.float32)})
    ao = result(scratch, 'in.exr', '--depth-type', 'planar')
    check((ao == 1).all(), f'{np.unique(ao)[:5]}')


@case
def one_texel_is_open(scratch):
    write_exr(scratch.path('in.exr'), {'Z': np.full((1, 1), 3, np.float32)})
    equal(result(scratch, 'in.exr').tolist(), [[1.0]], 'AO')


@case
def damaged_depth_is_background_and_spreads_nowhere(scratch):
    whole = reference(scratch)
    channels, bad = gbuffer(), np.zeros((HEIGHT, WIDTH), bool)
    values = (np.nan, np.inf, -np.inf, -5, 1e30, 0)
    for i, value in enumerate(values):
        rows, columns = slice(70, 74), slice(10 + 20 * i, 14 + 20 * i)
        channels['Z'][rows, columns] = value
        bad[rows, columns] = True
    channels['N.Y'][60:64, 10:14] = np.nan
    channels['N.X'][60:64, 30:34] = np.inf
    write_exr(scratch.path('in.exr'), channels)
    ao = result(scratch, 'in.exr')
    check_ao(ao, 'AO')
    check((ao[bad] == 1).all(), 'damaged depth is not background')
    # RADIUS covers at most this many texels, the nearest floor being 2 away; the blur adds 4.
    reach = int(RADIUS / 1.9 * WIDTH / 2 / np.tan(np.radians(FOV / 2))) + 4
    near = np.zeros_like(bad)
    for y, x in zip(*np.nonzero(bad)):
        near[max(0, y - reach):y + reach + 1, max(0, x - reach):x + reach + 1] = True
    near[52:72, 2:42] = True  # the damaged normals
    check((~near).sum() > 4000, 'nothing left to compare')
    check_close(ao[~near], whole[~near], 0, 0, 'far from the damage')


@case
def same_input_gives_the_same_bytes(scratch):
    write_exr(scratch.path('in.exr'), gbuffer(color=True))
    for mode in ('ao', 'append', 'comp'):
        outputs = []
        for i in range(3):  # of the same name, which previews name
            exr, png = f'{mode}{i}/out.exr', f'{mode}{i}/out.png'
            os.mkdir(scratch.path(f'{mode}{i}'))
            scratch.render('in.exr', '-o', exr, '--mode', mode, '--preview', png, '--threads', i,
                           *VIEW)
            outputs.append(scratch.bytes(exr) + scratch.bytes(png))
        check(outputs[0] == outputs[1] == outputs[2], f'--mode {mode} differs from run to run')


# --- Modes and formats ---

@case
def mode_ao_writes_one_half_channel_with_zip(scratch):
    write_exr(scratch.path('in.exr'), gbuffer(color=True))
    scratch.render('in.exr', '-o', 'ao.exr', *VIEW)
    parts = read_parts(scratch.path('ao.exr'))
    equal(len(parts), 1, 'number of parts')
    equal([(k, str(v.dtype)) for k, v in parts[0].channels.items()],
          [(c, 'float16') for c in 'RGB'], 'channels')
    raw = read_raw(scratch.bytes('ao.exr'))[0]
    equal(COMPRESSIONS[raw.attributes['compression'][1][0]], 'zip', 'compression')
    equal(raw.text('vkao/source'), 'in.exr', 'vkao/source')
    record = json.loads(raw.text('vkao/params'))
    used = record['parameters']
    equal((used['method'], used['radius'], record['camera']['fov_x_deg']),
          ('vbao', RADIUS, FOV), 'vkao/params')


@case
def mode_comp_is_colour_times_ao_and_keeps_alpha(scratch):
    write_exr(scratch.path('in.exr'), gbuffer(color=True))
    scratch.render('in.exr', '-o', 'ao.exr', '--pixel-type', 'float', *VIEW)
    scratch.render('in.exr', '-o', 'comp.exr', '--mode', 'comp', '--pixel-type', 'float', *VIEW)
    ao, comp = read_ao(scratch.path('ao.exr')), read_parts(scratch.path('comp.exr'))[0]
    equal(sorted(comp.channels), ['A', 'B', 'G', 'R'], 'channels')
    for name, plane in SCENE.color().items():
        wanted = plane if name == 'A' else plane * ao
        check_close(comp[name], wanted, 0 if name == 'A' else 1e-6, 1e-6, name)


@case
def comp_takes_strength_and_tint(scratch):
    write_exr(scratch.path('in.exr'), gbuffer(color=True))
    ao = reference(scratch)
    scratch.render('in.exr', '-o', 'comp.exr', '--mode', 'comp', '--pixel-type', 'float',
                   '--strength', 0.75, '--tint', '0.5,0.25,0', *VIEW)
    comp = read_parts(scratch.path('comp.exr'))[0]
    shown = 1 + 0.75 * (ao - 1)
    for name, tint in (('R', 0.5), ('G', 0.25), ('B', 0)):
        wanted = SCENE.color()[name].astype(np.float32) * (tint + shown * (1 - tint))
        check_close(comp[name], wanted, 1e-6, 1e-6, name)


@case
def comp_without_alpha_writes_none(scratch):
    write_exr(scratch.path('in.exr'), {**gbuffer(), **SCENE.color(alpha=False)})
    scratch.render('in.exr', '-o', 'comp.exr', '--mode', 'comp', *VIEW)
    equal(sorted(read_parts(scratch.path('comp.exr'))[0].channels), ['B', 'G', 'R'], 'channels')


@case
def comp_keeps_the_window_of_the_colour(scratch):
    """The depth part is cropped, or moved: colour that it does not reach is as it was."""
    scene = Scene(WIDTH, HEIGHT)
    color = scene.color()
    for x, y, width, height in ((30, 20, 90, 50), (-10, -7, WIDTH - 20, HEIGHT + 30)):
        row, column = np.mgrid[:height, :width]
        depth = (4 + (row // 8 + column // 8) % 2 * 0.5).astype(np.float32)
        display = (0, 0, WIDTH - 1, HEIGHT - 1)
        write_exr(scratch.path('in.exr'), (color, {'name': 'rgba', 'display': display}),
                  ({'Z': depth}, {'name': 'depth', 'x': x, 'y': y, 'display': display}))
        line = ('in.exr', '--fov', FOV, '-r', 1, '--pixel-type', 'float', '--overwrite', 'always')
        scratch.render(*line, '-o', 'ao.exr')
        scratch.render(*line, '-o', 'comp.exr', '--mode', 'comp', '--preview', 'comp.png')
        comp, ao = read_parts(scratch.path('comp.exr'))[0], read_ao(scratch.path('ao.exr'))
        equal(comp.data_window, display, 'data window')
        whole = np.ones((HEIGHT, WIDTH), np.float32)
        rows = slice(max(y, 0), min(y + height, HEIGHT))
        columns = slice(max(x, 0), min(x + width, WIDTH))
        whole[rows, columns] = ao[rows.start - y:rows.stop - y, columns.start - x:columns.stop - x]
        check(whole.min() < 0.95, f'AO is {whole.min()} at least: nothing to see')
        for name in 'RGBA':
            wanted = color[name] * (1 if name == 'A' else whole)
            check_close(comp[name], wanted, 0 if name == 'A' else 1e-6, 1e-6, name)
        size = struct.unpack('>II', scratch.bytes('comp.png')[16:24])
        equal(size, (WIDTH, HEIGHT), 'size of the preview')


@case
def comp_without_colour_is_an_error(scratch):
    write_exr(scratch.path('in.exr'), gbuffer())
    scratch.fails(CHANNELS, r'in\.exr: no colou?r', 'in.exr', '-o', 'x.exr', '--mode', 'comp',
                  *VIEW, hint='--color NAME')


@case
def half_is_float_rounded(scratch):
    wanted = reference(scratch).astype(np.float16)
    scratch.render('reference.exr', '-o', 'half.exr', '--pixel-type', 'half', *VIEW)
    got = read_parts(scratch.path('half.exr'))[0]['R']
    equal(str(got.dtype), 'float16', 'pixel type')
    check_close(got, wanted, 0, 0, 'half')


@cases(COMPRESSIONS)
def output_compression(scratch, compression):
    lossy = {'pxr24': 1e-4, 'b44': 0.06, 'b44a': 0.06, 'dwaa': 0.03, 'dwab': 0.03}
    wanted = reference(scratch).astype(np.float16)
    scratch.render('reference.exr', '-o', 'out.exr', '--compression', compression, *VIEW)
    raw = read_raw(scratch.bytes('out.exr'))[0]
    equal(COMPRESSIONS[raw.attributes['compression'][1][0]], compression, 'compression')
    most = lossy.get(compression, 0)
    ao = read_ao(scratch.path('out.exr'))
    check_close(ao, wanted, most, most / 4, compression)
    run_tool('exrheader', 'out.exr', cwd=scratch.directory)


@case
def output_keeps_windows_and_attributes(scratch):
    write_exr(scratch.path('in.exr'), gbuffer(), x=-20, y=7, display=(-30, -3, 200, 150),
              attributes=[('owner', 'A. Gaffer'), ('shot', 'sh0010'), ('PixelAspectRatio', 1.5)])
    scratch.render('in.exr', '-o', 'ao.exr', *VIEW)
    part = read_parts(scratch.path('ao.exr'))[0]
    equal(part.data_window, (-20, 7, -20 + WIDTH - 1, 7 + HEIGHT - 1), 'dataWindow')
    equal(part.display_window, (-30, -3, 200, 150), 'displayWindow')
    raw = read_raw(scratch.bytes('ao.exr'))[0]
    equal(np.frombuffer(raw.attributes['pixelAspectRatio'][1], '<f4')[0], 1.5, 'pixel aspect')
    equal(raw.text('owner'), 'A. Gaffer', 'owner')
    equal(raw.text('shot'), 'sh0010', 'shot')


def read_png(path):
    file = oiio.ImageInput.open(path)
    check(file and file.format_name() == 'png', f'{path} is no PNG')
    spec = file.spec()
    equal(str(spec.format), 'uint8', 'type of the preview')
    pixels = np.asarray(file.read_image('uint8')).reshape(spec.height, spec.width, -1)
    file.close()
    return pixels


@case
def preview_is_255_times_ao(scratch):
    write_exr(scratch.path('in.exr'), gbuffer())
    scratch.render('in.exr', '-o', 'ao.exr', '--pixel-type', 'float', '--preview', 'ao.png', *VIEW)
    ao, png = read_ao(scratch.path('ao.exr')), read_png(scratch.path('ao.png'))
    equal(png.shape, (HEIGHT, WIDTH, 1), 'size of the preview')
    wanted = np.floor(ao * np.float32(255) + np.float32(0.5))
    check_close(png[..., 0], wanted, 0, 0, 'preview')


@case
def preview_of_a_composite_is_srgb(scratch):
    write_exr(scratch.path('in.exr'), gbuffer(color=True))
    scratch.render('in.exr', '-o', 'comp.exr', '--mode', 'comp', '--pixel-type', 'float',
                   '--preview', 'comp.png', *VIEW)
    comp, png = read_parts(scratch.path('comp.exr'))[0], read_png(scratch.path('comp.png'))
    equal(png.shape, (HEIGHT, WIDTH, 3), 'size of the preview')
    linear = np.clip(np.stack([comp[c] for c in 'RGB'], axis=-1), 0, 1)
    srgb = np.where(linear <= 0.0031308, linear * 12.92, 1.055 * linear ** (1 / 2.4) - 0.055)
    check_close(png, np.round(srgb * 255), 1, 0.02, 'preview')


# --- Ways to store a G-buffer ---

@cases(COMPRESSED)
def input_compression(scratch, compression):
    # PXR24 cuts floats to 24 bits, and DWA takes the Y of N.Y for luminance.
    wanted = reference(scratch)
    write_exr(scratch.path('in.exr'), gbuffer(), compression=compression)
    raw = read_raw(scratch.bytes('in.exr'))[0]
    equal(COMPRESSIONS[raw.attributes['compression'][1][0]], compression, 'compression of INPUT')
    most = {'pxr24': 0.15, 'dwaa': 0.1, 'dwab': 0.1}.get(compression, 0)
    check_close(result(scratch, 'in.exr'), wanted, most, most / 500, compression)


@cases([('tiled', 64, {}), ('odd tiles', 17, {}), ('tiled piz', 32, {'compression': 'piz'}),
        ('uncompressed', 0, {'compression': 'none'}),
        ('upwards', 0, {'attributes': [('openexr:lineOrder', 'decreasingY')]})])
def layout_of_input_does_not_matter(scratch, _, tile, options):
    wanted = reference(scratch)
    write_exr(scratch.path('in.exr'), gbuffer(), tile=tile, **options)
    check_close(result(scratch, 'in.exr'), wanted, 0, 0, 'AO')


@case
def mipmaps_are_read_at_full_size(scratch):
    wanted = reference(scratch)
    run_tool('oiiotool', 'reference.exr', '-otex:forcefloat=1:fileformatname=openexr', 'in.exr',
             cwd=scratch.directory)
    check(b'tiledesc' in scratch.bytes('in.exr'), 'oiiotool wrote no mipmaps')
    ao = result(scratch, 'in.exr')
    check_close(ao, wanted, 1e-5, 1e-6, 'AO')


@case
def parts_of_their_own_give_the_same(scratch):
    wanted = reference(scratch)
    write_exr(scratch.path('in.exr'), (SCENE.color(), {'name': 'beauty'}),
              (SCENE.normals(), {'name': 'normal', 'compression': 'none'}),
              ({'Z': SCENE.depth()}, {'name': 'depth', 'compression': 'piz'}))
    check_close(result(scratch, 'in.exr'), wanted, 0, 0, 'AO')


@case
def half_normals_are_nearly_the_same(scratch):
    wanted = reference(scratch)
    normals = {k: v.astype(np.float16) for k, v in SCENE.normals().items()}
    write_exr(scratch.path('in.exr'), ({'Z': SCENE.depth()}, {'name': 'depth'}),
              (normals, {'name': 'N'}))
    check_close(result(scratch, 'in.exr'), wanted, 0.2, 0.002, 'AO')


@case
def half_depth_is_close_and_warned_of(scratch):
    wanted = reference(scratch)
    channels = gbuffer()
    channels['Z'][SCENE.sky] = np.inf
    channels = {k: v.astype(np.float16) for k, v in channels.items()}
    write_exr(scratch.path('in.exr'), channels)
    got = scratch.render('in.exr', '-o', 'ao.exr', *VIEW)
    check('depth is HALF' in got.stderr, f'no warning: {got}')
    check_close(read_ao(scratch.path('ao.exr')), wanted, 0.5, 0.02, 'AO')


@case
def oiiotool_writes_what_vkao_reads(scratch):
    wanted = reference(scratch)
    run_tool('oiiotool', 'reference.exr', '--tile', '32', '32', '--compression', 'zips', '-o',
             'in.exr', cwd=scratch.directory)
    check_close(result(scratch, 'in.exr'), wanted, 0, 0, 'AO')
    run_tool('idiff', '-fail', '0', 'reference.ao.exr', 'result.exr', cwd=scratch.directory)


# --- Windows ---

CUTS = [
    ('right and bottom', (0, 0, 139, 79), (0, 0)),
    # The noise pattern begins at the corner of the data window: another one, of the same strength.
    ('all sides', (24, 20, 139, 79), (0.02, 1e-3)),
]


@cases(CUTS)
def cut_data_window_gives_the_full_result_away_from_the_cut(scratch, _, window, tolerance):
    whole = reference(scratch)
    left, top, right, bottom = window
    cut = {k: v[top:bottom + 1, left:right + 1] for k, v in gbuffer().items()}
    write_exr(scratch.path('in.exr'), cut, x=left, y=top, display=(0, 0, WIDTH - 1, HEIGHT - 1))
    ao = result(scratch, 'in.exr')
    equal(ao.shape, (bottom - top + 1, right - left + 1), 'size')
    # A radius of 0.5 at distance d, and the blur: what is so far from the cut cannot know of it.
    focal = WIDTH / 2 / np.tan(np.radians(FOV / 2))
    reach = np.ceil(RADIUS / np.where(SCENE.sky, 6, SCENE.z - 0.5) * focal) + 8
    y, x = np.mgrid[:HEIGHT, :WIDTH]
    from_left = np.where(left > 0, x - left, WIDTH)
    from_top = np.where(top > 0, y - top, HEIGHT)
    inside = (np.minimum(from_left, right - x) > reach) & (np.minimum(from_top, bottom - y) > reach)
    check(inside.sum() > 700, f'{inside.sum()} texels to compare')
    far = inside[top:bottom + 1, left:right + 1]
    check_close(ao[far], whole[inside], *tolerance, 'away from the cut')


@case
def overscan_takes_part(scratch):
    wide = Scene(WIDTH + 40, HEIGHT + 20, pixel_aspect=1.0,
                 fov=2 * np.degrees(np.arctan(np.tan(np.radians(FOV / 2)) * 200 / 160)))
    write_exr(scratch.path('in.exr'), {'Z': wide.depth(), **wide.normals()}, x=-20, y=-10,
              display=(0, 0, WIDTH - 1, HEIGHT - 1))
    ao = result(scratch, 'in.exr')
    equal(ao.shape, (HEIGHT + 20, WIDTH + 40), 'size')
    inner, plain = ao[10:-10, 20:-20], reference(scratch)
    check_close(inner[20:70, 40:120], plain[20:70, 40:120], 0.3, 0.02, 'the middle')
    check(inner[-1].mean() != plain[-1].mean(), 'the border of the image does not see beyond')


@cases([('2', 2.0), ('0.5', 0.5)])
def wide_pixels_see_the_same_scene(scratch, _, aspect):
    # Twice as wide pixels, half as many of them: the same picture, sampled more coarsely.
    width = int(WIDTH / aspect)
    scene = Scene(width, HEIGHT, pixel_aspect=aspect)
    write_exr(scratch.path('in.exr'), {'Z': scene.depth(), **scene.normals()},
              attributes=[('PixelAspectRatio', aspect)])
    options = ('--samples', 64, '--blur', 'off', *VIEW)
    ao, plain = result(scratch, 'in.exr', *options), reference(scratch, *options)
    fine, coarse = (plain, ao) if aspect > 1 else (ao, plain)
    pairs = fine.reshape(HEIGHT, -1, 2).mean(axis=2)
    difference = np.abs(pairs - coarse).mean()
    check(difference < 0.02, f'mean difference {difference}')
    write_exr(scratch.path('square.exr'), {'Z': scene.depth(), **scene.normals()})
    wrong = result(scratch, 'square.exr', *options)
    other = np.abs(wrong - ao).mean()
    check(other > 0.004, f'pixelAspectRatio changes nothing: {other}')


if __name__ == '__main__':
    main()
