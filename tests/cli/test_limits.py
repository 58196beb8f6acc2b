#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""What one file may cost, what no device holds, and that the failure of a frame is its own."""
import os
import re
import struct

import numpy as np

from cli import (CHANNELS, DEVICE, INPUT, MEMORY, OK, OUTPUT, SOME_FRAMES, USAGE, case, cases,
                 check, check_ao, check_close, corpus, equal, limit_file_size, main, matches,
                 read_ao, read_parts, vkao_is_sanitized, write_exr)
from exr_raw import patched
from scene import FOV, RADIUS, Scene

VIEW = ('--fov', FOV, '--radius', RADIUS)
MEGA = 1 << 20
# Of a run that computes next to nothing: the driver and its compiler. What this interpreter has
# counts as the program's from before it was one. Sanitizers keep what was freed.
BASE, BASE_SANITIZED = 400 * MEGA, 800 * MEGA
# Beyond what lavapipe's maxImageDimension2D allows, 16384.
TOO_LONG = 20000


def peak_memory(scratch, *arguments):
    """Exit code, stderr and the largest resident size of a run, in bytes."""
    process = scratch.start(*[str(a) for a in arguments])
    stderr = process.stderr.read()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    return process.returncode, stderr, usage.ru_maxrss * 1024


def base():
    return BASE_SANITIZED if vkao_is_sanitized() else BASE


def grey(width, height, value=5.0, **options):
    depth = np.full((height, width), value, np.float32)
    depth[0, 0] *= 1.001  # the same everywhere would be no depth
    return ({'Z': depth}, options)


# --- Budgets ---

@cases([('16384 square', 16384), ('65536 square', 65536), ('10001 square', 10001)])
def display_window_costs_nothing(scratch, _, size):
    write_exr(scratch.path('in.exr'), grey(1, 1, x=size, y=size, display=(0, 0, size, size)))
    code, stderr, peak = peak_memory(scratch, 'in.exr', '-o', 'ao.exr')
    equal(code, OK, f'exit code ({stderr})')
    check(peak < base(), f'{peak / MEGA:.0f} MB for one pixel')
    equal(read_parts(scratch.path('ao.exr'))[0].data_window, (size, size, size, size), 'window')


@case
def wide_crop_far_below_costs_what_is_there(scratch):
    write_exr(scratch.path('in.exr'), grey(4096, 4, y=16000, display=(0, 0, 16383, 16383)))
    code, stderr, peak = peak_memory(scratch, 'in.exr', '-o', 'ao.exr')
    equal(code, OK, f'exit code ({stderr})')
    check(peak < base() + 200 * MEGA, f'{peak / MEGA:.0f} MB for 16384 pixels')


@cases([('depth', ()), ('bent', ('--bent-normals',)), ('fast', ('--quality', 'fast')),
        ('comp', ('--mode', 'comp'))])
def memory_refused_is_memory_needed(scratch, _, options):
    """The hint names a budget that suffices, the run stays inside it, and a refusal is cheap."""
    ramp = np.linspace(4, 5, 1024 * 1024, dtype=np.float32).reshape(1024, 1024)
    channels = {'Z': ramp}
    if 'comp' in options:
        channels.update({c: ramp for c in 'RGB'})
    write_exr(scratch.path('in.exr'), channels)
    command = ('in.exr', '-o', 'ao.exr', *VIEW, *options)
    result = scratch.fails(MEMORY, r'in\.exr: 1024x1024 pixels need \d+ MB of memory, more than '
                           r'the 8 MB allowed', *command, '--max-memory', '8M',
                           hint=r'--max-memory \d+M')
    needed = re.search(r'--max-memory (\d+)M', result.stderr).group(1)
    code, stderr, peak = peak_memory(scratch, *command, '--max-memory', f'{needed}M')
    equal(code, OK, f'exit code ({stderr})')
    check(peak < base() + int(needed) * MEGA, f'{peak / MEGA:.0f} MB, asked for {needed}')
    less = int(needed) - 1
    scratch.fails(MEMORY, 'need', *command, '--overwrite', 'always', '--max-memory', f'{less}M')


@cases(['inspect', 'render'])
def pixels_over_the_budget_are_refused(scratch, command):
    write_exr(scratch.path('in.exr'), grey(64, 32))
    if command == 'inspect':
        result = scratch.run('inspect', 'in.exr', '--max-pixels', 2047)
        equal(result.code, INPUT, str(result))
        matches('2048 pixels, more than the 2047 allowed', result.stdout, 'the problem')
        return
    scratch.fails(INPUT, r'in\.exr: 64x32 are 2048 pixels, more than the 2047 allowed', 'in.exr',
                  '-o', 'ao.exr', '--max-pixels', 2047, hint='--max-pixels 2048')
    scratch.render('in.exr', '-o', 'ao.exr', '--max-pixels', 2048)


@cases([('memory', ('', '0', '-1', 'x', '4Q', 'inf', '1e30', '0.5', 'M')),
        ('pixels', ('', '0', '-1', 'x', '1.5', '1073741825'))])
def budgets_that_are_none_are_usage_errors(scratch, name, values):
    write_exr(scratch.path('in.exr'), grey(8, 8))
    for value in values:
        scratch.fails(USAGE, f'--max-{name}', 'in.exr', '-o', 'ao.exr', f'--max-{name}={value}')
    scratch.render('in.exr', '-o', 'ao.exr', '--max-memory', '0.5g', '--max-pixels', 64)


@case
def large_tiles_of_a_small_image_are_refused(scratch):
    """One pixel in a tile that OpenEXR would allocate a gigabyte for, several times."""
    write_exr(scratch.path('in.exr'), grey(16, 16, tile=16))
    data = scratch.bytes('in.exr')
    for side in (16384, 65536, 4096):
        scratch.write('x.exr', patched(data, 'tiles', struct.pack('<IIB', side, side, 0)))
        code, stderr, peak = peak_memory(scratch, 'x.exr', '-o', 'ao.exr')
        equal(code, INPUT, f'exit code ({stderr})')
        check(peak < base(), f'{peak / MEGA:.0f} MB for tiles of {side}')


@cases([('wide', (TOO_LONG, 2)), ('tall', (2, TOO_LONG))])
def images_that_no_device_holds_are_refused_by_name(scratch, _, size):
    write_exr(scratch.path('in.exr'), grey(*size))
    scratch.fails(DEVICE, r'in\.exr: maxImageDimension2D of .* is 16384, less than the 20000',
                  'in.exr', '-o', 'ao.exr', '--device', 'cpu', hint='crop or scale')


@case
def a_gpu_wants_room_for_a_border_and_a_cpu_does_not(scratch):
    write_exr(scratch.path('in.exr'), grey(16384, 2))
    on_gpu = scratch.run('in.exr', '-o', 'ao.exr', *VIEW, env={'VKAO_PATH': 'images'})
    equal(on_gpu.code, DEVICE, f'exit code of: {on_gpu}\n')
    matches(r'16384x2, for which view z takes 16392x4; the limit is 16384', on_gpu.stderr, 'limit')
    matches(r'crop or scale the image, or take --device cpu', on_gpu.stderr, 'the hint')
    equal(scratch.files(), ['in.exr'], 'files')
    scratch.render('in.exr', '-o', 'ao.exr', *VIEW)


# --- Frames ---

@case
def failed_frames_end_no_sequence(scratch):
    ramp = np.linspace(4, 5, 1024 * 1024, dtype=np.float32).reshape(1024, 1024)
    write_exr(scratch.path('in.1.exr'), grey(32, 32))
    write_exr(scratch.path('in.2.exr'), {'Z': ramp})
    write_exr(scratch.path('in.3.exr'), grey(TOO_LONG, 2))
    scratch.write('in.4.exr', scratch.bytes('in.1.exr')[:-9])
    write_exr(scratch.path('in.5.exr'), {'R': ramp, 'G': ramp, 'B': ramp})
    write_exr(scratch.path('in.6.exr'), grey(32, 32))
    result = scratch.run('in.%d.exr', '-o', 'ao.%d.exr', *VIEW, '--continue-on-error', '--device',
                         'cpu', '--max-memory', '16M')
    equal(result.code, SOME_FRAMES, str(result))
    equal([f for f in scratch.files() if f.startswith('ao')], ['ao.1.exr', 'ao.6.exr'], 'outputs')
    errors = [line for line in result.stderr.splitlines() if re.match(r'vkao: in\.\d\.exr: ', line)]
    for number, message in ((2, '--max-memory|MB of memory'), (3, 'maxImageDimension2D'),
                            (4, 'truncated'), (5, 'no depth')):
        of_frame = [e for e in errors if f'in.{number}.exr: ' in e]
        matches(message, '\n'.join(of_frame), f'frame {number}')
    matches('4 of 6 frames failed', result.stderr, 'the summary')
    check((read_ao(scratch.path('ao.1.exr')) == read_ao(scratch.path('ao.6.exr'))).all(),
          'frames around the failed ones differ')


@cases([('5', DEVICE, TOO_LONG), ('3', INPUT, None)])
def first_failed_frame_ends_a_strict_sequence(scratch, _, code, width):
    write_exr(scratch.path('in.1.exr'), grey(width or 8, 2))
    if not width:
        scratch.write('in.1.exr', scratch.bytes('in.1.exr')[:-3])
    write_exr(scratch.path('in.2.exr'), grey(32, 32))
    scratch.fails(code, r'in\.1\.exr: ', 'in.#.exr', '-o', 'ao.#.exr', *VIEW, '--device', 'cpu')


@case
def missing_device_ends_the_run(scratch):
    write_exr(scratch.path('in.1.exr'), grey(8, 8))
    write_exr(scratch.path('in.2.exr'), grey(8, 8))
    result = scratch.fails(DEVICE, 'no Vulkan', 'in.#.exr', '-o', 'ao.#.exr', *VIEW,
                           '--continue-on-error', env={'VK_ICD_FILENAMES': '/nowhere.json'})
    check('in.2' not in result.stderr, f'the second frame was tried: {result}')


# --- Values ---

HOSTILE = [('denormal', 1e-45), ('tiny', 1e-38), ('small', 1e-19), ('near', 1e-17), ('far', 9e17),
           ('huge', 1e19), ('largest', 3.4e38), ('sentinel', 1e10), ('infinite', np.inf),
           ('nan', np.nan), ('negative', -5.0), ('zero', 0.0)]


def write_hostile(scratch):
    """Frames of a scene in which one texel is hostile. Returns the depth without it."""
    clean = Scene(48, 32).depth()
    for frame, (_, value) in enumerate(HOSTILE, 1):
        depth = clean.copy()
        depth[20, 30] = value
        write_exr(scratch.path(f'in.{frame}.exr'), {'Z': depth})
    return clean


def of_hostile(scratch):
    """The results by the names of the values."""
    return {name: read_parts(scratch.path(f'ao.{frame}.exr'))[0]
            for frame, (name, _) in enumerate(HOSTILE, 1)}


@cases([('planar', VIEW), ('inverse', (*VIEW, '--depth-type', 'inverse')),
        ('radial', (*VIEW, '--depth-type', 'radial')),
        ('radial-near', (*VIEW, '--depth-type', 'radial-near', '--near', 0.1)),
        ('device', (*VIEW, '--depth-type', 'device', '--near', 1e-3, '--far', 'inf')),
        ('parallel', ('--ortho', 3, '--normal', 'none', '--radius', RADIUS))])
def one_texel_of_any_depth_is_computed(scratch, _, options):
    write_hostile(scratch)
    for method in ('vbao', 'raymarch'):
        scratch.render('in.%d.exr', '-o', 'ao.%d.exr', '--pixel-type', 'float', '--bent-normals',
                       '--method', method, '--overwrite', 'always', *options)
        for value, part in of_hostile(scratch).items():
            for name, values in part.channels.items():
                check(np.isfinite(values).all(), f'{name} of {value}, {method}, is not finite')
            check_ao(part['R'], f'{value}, {method}')


@case
def one_texel_changes_neither_the_sky_nor_what_is_far(scratch):
    write_exr(scratch.path('clean.exr'), {'Z': write_hostile(scratch)})
    scratch.render('clean.exr', '-o', 'clean.ao.exr', *VIEW, '--pixel-type', 'float')
    scratch.render('in.%d.exr', '-o', 'ao.%d.exr', *VIEW, '--pixel-type', 'float')
    clean = read_ao(scratch.path('clean.ao.exr'))
    for value, part in of_hostile(scratch).items():
        check(np.abs(part['R'] - clean)[:8].max() < 1e-6, f'{value} changes it')


@cases([('zeros', 0.0), ('denormals', 1e-45), ('huge', 1e30), ('infinite', np.inf)])
def images_of_nothing_but_background_are_open(scratch, _, value):
    write_exr(scratch.path('in.exr'), {'Z': np.full((8, 8), value, np.float32)})
    scratch.fails(CHANNELS, "depth 'Z' is .*: no picture of anything", 'in.exr', '-o', 'ao.exr',
                  hint='--depth-type planar')
    scratch.render('in.exr', '-o', 'ao.exr', '--bent-normals', '--depth-type', 'planar')
    for name, values in read_parts(scratch.path('ao.exr'))[0].channels.items():
        check((values == (1 if name in 'RGB' else 0)).all(), f'{name} is {values}')


@cases([('odd column', 3, 4), ('odd row', 4, 3), ('both', 13, 5), ('even', 6, 8)])
def crops_at_half_resolution_are_those_of_the_whole(scratch, _, x, y):
    scene = Scene(96, 64)
    whole, size = {'Z': scene.depth()}, (40, 30)
    write_exr(scratch.path('whole.exr'), whole)
    window = np.s_[y:y + size[1], x:x + size[0]]
    write_exr(scratch.path('crop.exr'), ({'Z': whole['Z'][window].copy()},
                                         {'x': x, 'y': y, 'display': (0, 0, 95, 63)}))
    for name in ('whole', 'crop'):
        scratch.render(f'{name}.exr', '-o', f'{name}.ao.exr', '--quality', 'fast', *VIEW,
                       '--radius', 0.1, '--pixel-type', 'float')
    a, b = read_ao(scratch.path('whole.ao.exr'))[window], read_ao(scratch.path('crop.ao.exr'))
    inside = np.s_[12:-12, 12:-12]
    check_close(a[inside], b[inside], 0.1, 0.004, 'crop against whole')


@cases([('tiny', 1e-9), ('wide', 179.9999)])
def cameras_at_the_limits_are_computed_or_refused(scratch, _, fov):
    write_exr(scratch.path('in.exr'), {'Z': Scene(32, 32).depth()})
    result = scratch.run('in.exr', '-o', 'ao.exr', '--fov', fov, '--bent-normals')
    check(result.code in (OK, USAGE, CHANNELS), str(result))
    parts = [] if result.code else read_parts(scratch.path('ao.exr'))[:1]
    for values in (v for part in parts for v in part.channels.values()):
        check(np.isfinite(values).all(), f'not finite at {fov} degrees')


@cases([('zeros', [0.0] * 16), ('nan', [np.nan] * 16), ('huge', [1e38] * 16),
        ('tiny', [1e-40] * 16)])
def matrices_that_are_no_projection_never_end_in_a_bug(scratch, _, values):
    scene = Scene(32, 32)
    attributes = [('worldToNDC', 'matrix44', tuple(float(v) for v in values)),
                  ('worldToCamera', 'matrix44', tuple(float(v) for v in values))]
    write_exr(scratch.path('in.exr'), ({'Z': scene.depth(), **scene.normals()},
                                       {'attributes': attributes}))
    result = scratch.run('in.exr', '-o', 'ao.exr')
    check(result.code in (OK, CHANNELS), str(result))


# --- Outputs ---

@case
def failed_preview_leaves_nothing(scratch):
    """The picture is larger than the EXR, whose pixels are lossy: a limit lies between."""
    rng = np.random.default_rng(3)
    channels = {c: rng.random((200, 300)).astype(np.float32) for c in 'RGB'}
    write_exr(scratch.path('in.exr'), {'Z': 4 + channels['R'], **channels})
    command = ('in.exr', '-o', 'ao.exr', '--mode', 'comp', '--preview', 'ao.png', '--compression',
               'b44', *VIEW)
    scratch.render(*command)
    exr, png = len(scratch.bytes('ao.exr')), len(scratch.bytes('ao.png'))
    check(exr + 1000 < png, f'{exr} bytes of EXR, {png} of PNG')
    os.remove(scratch.path('ao.exr'))
    os.remove(scratch.path('ao.png'))
    scratch.fails(OUTPUT, r'ao\.png: ', *command,
                  preexec_fn=lambda: limit_file_size((exr + png) // 2))
    scratch.render(*command)


# --- Files that once did harm ---

FLAT = ('--depth-type', 'planar')  # the same depth everywhere is meant
CORPUS = [
    ('poc_heap_write', INPUT, ()), ('poc_heap_read', INPUT, ()),
    ('fuzz_opaque_attr_1.7GB', INPUT, ()), ('disp_10000', OK, ()), ('disp_16384', OK, ()),
    ('dwab_8k', MEMORY, ('--max-memory', '900M')),
    ('tall65536_zip', DEVICE, ('--device', 'cpu', *FLAT)),
    ('denormal_pixel', OK, ()), ('odd_crop', OK, ('--quality', 'fast', *FLAT)),
    ('mip_dup_tile', INPUT, ('--mode', 'append', *FLAT)),
    ('fuzz_ripmap_append_unreadable', INPUT, ('--mode', 'append', '--depth', 'R')),
    ('nan_bent_planar_raymarch', OK, ('--fov', 179.9, '--method', 'raymarch', '--bent-normals')),
    ('nan_bent_inverse', OK, ('--depth-type', 'inverse', '--bent-normals')),
    ('uninit_wire64', OK, ('--normal', 'none', '--quality', 'fast', '--blur-sharpness', 0)),
    ('esc1', OK, ()), ('esc3', OK, ()),
]


@cases(CORPUS)
def hostile_files_are_answered(scratch, name, code, options):
    path = corpus('hostile', f'{name}.exr')
    got, stderr, peak = peak_memory(scratch, path, '-o', 'ao.exr', *options)
    equal(got, code, f'exit code ({stderr})')
    check(peak < base(), f'{peak / MEGA:.0f} MB')
    if code:
        equal(scratch.files(), [], 'what is left')
        return
    for name, values in read_parts(scratch.path('ao.exr'))[0].channels.items():
        check(np.isfinite(values.astype(np.float64)).all(), f'{name} is not finite')


if __name__ == '__main__':
    main()
