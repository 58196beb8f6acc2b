#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""vkao-bench speed: what it measures and prints. How long things take is nobody's promise."""
import json
import math
import re

import numpy as np

from cli import (DEVICE, INPUT, OK, OUTPUT, USAGE, case, cases, check, equal, main, matches)

STAGES = ('prepare', 'ssao', 'blur', 'total')
SMALL = ('--size', '64x36', '--runs', '1', '--device', 'cpu', '--threads', '1', '--quiet')


def speed(scratch, *arguments):
    run = scratch.run('speed', *SMALL, *arguments)
    equal(run.code, OK, f'exit code of {run}')
    scratch.check_no_litter()
    return run.stdout


def measure(scratch, *arguments):
    return json.loads(speed(scratch, *arguments, '--json', '-'))


def fails(scratch, code, message, *arguments, hint=None):
    return scratch.fails(code, message, 'speed', *SMALL, *arguments, hint=hint)


def stages_of(rows, config):
    return [row['stage'] for row in rows if row['config'] == config]


# --- Results ---

@case
def json_has_every_stage(scratch):
    rows = measure(scratch, '--configs', 'fast,gtao-3x6,hemisphere-16', '--composite')
    equal(stages_of(rows, 'vbao-fast'),
          ['prepare', 'ssao', 'blur', 'upsample', 'composite', 'total'], 'stages of vbao-fast')
    for config in ('gtao-3x6', 'hemisphere-16'):
        equal(stages_of(rows, config), ['prepare', 'ssao', 'blur', 'composite', 'total'],
              f'stages of {config}')
    for row in rows:
        check(math.isfinite(row['median_ms']) and row['median_ms'] > 0, f'{row}')
        check(row['least_ms'] <= row['median_ms'], f'{row}')
        equal((row['runs'], row['width'], row['height'], row['radius']), (1, 64, 36, 0.5), row)


@case
def stages_add_up_to_no_more_than_the_total(scratch):
    rows = measure(scratch)
    configs = list(dict.fromkeys(row['config'] for row in rows))
    equal(len(configs), 10, 'number of default settings')
    for config in configs:
        ms = {row['stage']: row['median_ms'] for row in rows if row['config'] == config}
        total = ms.pop('total')
        check(sum(ms.values()) <= total * 1.0001, f'{config}: {ms} in {total}')


@case
def runs_are_counted(scratch):
    rows = measure(scratch, '--configs', 'gtao-1x2', '--runs', '4')
    equal({row['runs'] for row in rows}, {4}, 'runs')


@case
def every_size_has_its_rows(scratch):
    rows = measure(scratch, '--preset', 'default', '--size', '33x17,64x1,1x1')
    equal([(row['width'], row['height']) for row in rows if row['stage'] == 'total'],
          [(33, 17), (64, 1), (1, 1)], 'sizes')


@case
def sizes_beyond_the_device_are_left_out(scratch):
    run = scratch.run('speed', '--device', 'cpu', '--runs', '1', '--configs', 'default',
                      '--size', '64x36,65535x1', '--json', '-')
    equal(run.code, OK, f'exit code of {run}')
    equal({row['width'] for row in json.loads(run.stdout)}, {64}, 'widths')
    matches(r'65535 x 1 left out: .*maxImageDimension2D', run.stderr, 'stderr')


@cases([(name, *rest) for name, *rest in [
    ('method', ('--method', 'gtao', '--slices', '3', '--steps', '6'), ['gtao-3x6']),
    ('methods', ('--method', 'vbao,hemisphere,raymarch', '--steps', '2', '--samples', '3'),
     ['vbao-1x2', 'hemisphere-3', 'raymarch-3x2']),
    ('defaults', ('--method', 'hbao,sphere'), ['hbao-1x9', 'sphere-16']),
    ('presets', ('--preset', 'best,fast'), ['vbao-best', 'vbao-fast']),
    ('all', ('--configs', 'gtao-1x8,high', '--preset', 'default', '--method', 'hbao'),
     ['gtao-1x8', 'vbao-high', 'vbao-default', 'hbao-1x9']),
]])
def settings_are_chosen_by(scratch, _, arguments, wanted):
    rows = measure(scratch, *arguments)
    equal(list(dict.fromkeys(row['config'] for row in rows)), wanted, 'settings')


@case
def features_are_measured(scratch):
    rows = measure(scratch, '--preset', 'fast,default', '--bent-normals',
                   '--composite')
    check('composite' in stages_of(rows, 'vbao-default'), f'{rows}')


@case
def text_and_markdown_name_every_setting(scratch):
    text = speed(scratch, '--configs', 'fast,gtao-3x6', '--text')
    table = speed(scratch, '--configs', 'fast,gtao-3x6', '--markdown')
    for stage in STAGES:
        matches(rf'(?m)^ms .*\b{stage}\b', text, 'the text')
        matches(rf'(?m)^\|.*\b{stage} \|', table, 'the table')
    for config in ('vbao-fast', 'gtao-3x6'):
        matches(rf'(?m)^{config} +[0-9]', text, 'the text')
        matches(rf'(?m)^\| {config} \|.*64 × 36', table, 'the table')


@case
def json_goes_to_a_file(scratch):
    out = speed(scratch, '--preset', 'default', '--json', 'out.json')
    equal(stages_of(json.loads(scratch.bytes('out.json')), 'vbao-default'), list(STAGES), 'stages')
    matches('vbao-default', out, 'the text')


# --- The room ---

def read_room(scratch, width, height, *arguments):
    speed(scratch, '--method', 'sphere', '--samples', '1', '--size', f'{width}x{height}',
          '--dump', 'room', *arguments)
    return np.load(scratch.path('room_z32.npy')), np.load(scratch.path('room_n8.npy'))


@case
def dump_is_the_room(scratch):
    z, packed = read_room(scratch, 320, 180)
    equal((z.dtype, z.shape), (np.dtype('<f4'), (180, 320)), 'view z')
    equal((packed.dtype, packed.shape), (np.dtype('<u4'), (180, 320)), 'normals')
    check(z.min() >= 2 and z.max() <= 9, f'view z from {z.min()} to {z.max()}')
    check(z.min() < 2.5 and z.max() > 8.9, f'view z from {z.min()} to {z.max()}')
    check((packed >> 24 == 0).all(), 'the fourth byte is not 0')
    n = packed.view(np.int8).reshape(180, 320, 4)[..., :3] / 127
    length = np.linalg.norm(n, axis=-1)
    check(np.abs(length - 1).max() < 0.01, f'normals from {length.min()} to {length.max()} long')
    half = np.tan(np.radians(30))
    x = ((np.arange(320) + 0.5) / 160 - 1) * half
    y = (1 - (np.arange(180) + 0.5) / 90) * half * 180 / 320
    towards = n[..., 0] * x + n[..., 1] * y[:, None] + n[..., 2]
    check(towards.max() < 0.01, f'normals turn away from the eye by {towards.max()}')


def shifted(image, axis, by):
    """All but the borders, as seen from the neighbour -1, 0 or 1 along the axis."""
    image = np.moveaxis(image, axis, 0)
    return image[1 + by:len(image) - 1 + by]


@case
def normals_are_those_of_the_depth(scratch):
    z, packed = read_room(scratch, 320, 180)
    n = packed.view(np.int8).reshape(180, 320, 4)[..., :3] / 127
    half = np.tan(np.radians(30))
    x = ((np.arange(320) + 0.5) / 160 - 1) * half
    y = (1 - (np.arange(180) + 0.5) / 90) * half * 180 / 320
    p = np.stack([x * z, y[:, None] * z, z], axis=-1)
    # 1 / z is linear in the image of a plane. Where it is, the way from one side to the other is
    # in the plane, and the normal perpendicular to it.
    for axis in (0, 1):
        inverse = np.float64(1) / z
        bend = (shifted(inverse, axis, -1) + shifted(inverse, axis, 1)
                - 2 * shifted(inverse, axis, 0))
        plane = np.abs(bend) < 2e-7
        for by in (-1, 1):
            plane &= shifted(packed, axis, by) == shifted(packed, axis, 0)
        way = shifted(p, axis, 1) - shifted(p, axis, -1)
        off = np.abs((way * shifted(n, axis, 0)).sum(-1)) / np.linalg.norm(way, axis=-1)
        check(plane.mean() > 0.7, f'{plane.mean():.3f} of the texels lie in planes')
        check(off[plane].max() < 0.02, f'normals are off by {off[plane].max()}')


@case
def dump_can_be_read_without_numpy(scratch):
    read_room(scratch, 64, 36)
    for name in ('room_z32.npy', 'room_n8.npy'):
        data = scratch.bytes(name)
        equal(data[:8], b'\x93NUMPY\x01\x00', f'{name}: magic and version')
        begin = 10 + int.from_bytes(data[8:10], 'little')
        equal((begin % 64, data[begin - 1:begin]), (0, b'\n'), f'{name}: header')
        equal(len(data) - begin, 64 * 36 * 4, f'{name}: bytes of data')


@case
def same_size_gives_the_same_room(scratch):
    read_room(scratch, 100, 50)
    first = scratch.bytes('room_z32.npy'), scratch.bytes('room_n8.npy')
    read_room(scratch, 100, 50)
    check(first == (scratch.bytes('room_z32.npy'), scratch.bytes('room_n8.npy')), 'they differ')


@cases([('0', 0), ('50', 18), ('100', 36)])
def sky_fills_rows_from_the_top(scratch, percent, rows):
    z, packed = read_room(scratch, 64, 36, '--sky', percent)
    check((z[:rows] == 1000).all() and (packed[:rows] == 0).all(), 'the sky is not all sky')
    check((z[rows:] <= 9).all() and (packed[rows:] != 0).all(), 'there is sky below')


# --- Another program ---

@case
def vs_takes_the_figures_of_lines(scratch):
    command = "echo hello; echo 'fast_v   med    2.000 ms min 1.0 ms'; echo 'slow_v med 4e1 ms'"
    rows = measure(scratch, '--preset', 'default', '--vs', command)
    theirs = {row['config']: row['median_ms'] for row in rows if row['config'].startswith('vs ')}
    equal((theirs['vs fast_v'], theirs['vs slow_v']), (2, 40), 'figures')
    check(theirs['vs process'] > 0, f'{theirs}')
    for row in rows:
        if 'ratios' in row:
            ratio = row['ratios']['fast_v'] * 2 / row['median_ms']
            check(abs(ratio - 1) < 1e-4, f'{row}')
    check('ratios' in rows[0], f'{rows[0]}')
    text = speed(scratch, '--preset', 'default', '--vs', command)
    matches(r'(?m)^ours / theirs .*fast_v +slow_v', text, 'the text')
    matches(r'(?m)^vbao-default +ssao ', text, 'the text')


@case
def vs_compares_what_has_the_same_name(scratch):
    speed(scratch, '--preset', 'default', '--json', 'theirs.json')
    text = speed(scratch, '--preset', 'default', '--vs', 'cat theirs.json')
    for stage in STAGES:
        matches(rf'(?m)^vbao-default +{stage} +[0-9.]+ +[0-9.]+ +[0-9.]+$', text, 'the text')
    check('ours / theirs' not in text, text)


@case
def vs_runs_in_turn(scratch):
    rows = measure(scratch, '--preset', 'default', '--runs', '5', '--vs',
                   "echo x >> times; n=$(wc -l < times); echo \"a med $n ms\"")
    equal(scratch.bytes('times').count(b'x'), 5, 'runs of the command')
    equal([row['median_ms'] for row in rows if row['config'] == 'vs a'], [3], 'median of 1 to 5')


@case
def vs_figures_may_be_missing(scratch):
    rows = measure(scratch, '--preset', 'default', '--runs', '3', '--vs',
                   "echo x >> times; test $(wc -l < times) = 2 && echo 'a med 7 ms'; true")
    equal([row['median_ms'] for row in rows if row['config'] == 'vs a'], [7], 'the one figure')


@cases([('exit 3', r"ended with exit code 3"), ('kill -9 $$', r'ended by signal 9'),
        ('no-such-command-at-all 2>/dev/null', r'ended with exit code 127')])
def vs_failures_end_it(scratch, command, message):
    fails(scratch, INPUT, message, '--preset', 'default', '--vs', command)


# --- Instead ---

@case
def start_is_cold_and_warm(scratch):
    rows = json.loads(speed(scratch, '--preset', 'fast,default', '--start', '--json', '-'))
    equal([row['config'] for row in rows],
          ['vbao-fast start-cold', 'vbao-fast start-warm', 'vbao-default start-cold',
           'vbao-default start-warm'], 'rows')
    for row in rows:
        equal((row['stage'], row['runs']), ('total', 1), row)
        check(abs(row['context_ms'] + row['first_ms'] - row['median_ms']) < 1e-3 * row['median_ms'],
              f'{row}')
        check(0 < row['device_ms'] < 1e4, f'{row}')


@case
def start_leaves_no_cache_behind(scratch):
    scratch.write('note', 'x')
    run = scratch.run('speed', *SMALL, '--preset', 'default', '--start',
                      env={'TMPDIR': scratch.directory})
    equal(run.code, OK, f'exit code of {run}')
    equal(scratch.files(), ['note'], 'files')
    columns = '  '.join(['device', 'context', 'first frame', 'second frame', 'overhead'])
    check(columns in re.sub('  +', '  ', run.stdout), run.stdout)
    five = r'( +-?\d+\.\d){5}'
    matches(rf'(?m)^vbao-default +cold{five}\nvbao-default +warm{five}$', run.stdout, 'the text')


@case
def scaling_covers_pixels_samples_and_radius(scratch):
    rows = measure(scratch, '--scaling')
    totals = [row for row in rows if row['stage'] == 'total']
    pixels = [row['width'] * row['height'] for row in totals if row['series'] == 'pixels']
    samples = [row['config'] for row in totals if row['series'] == 'samples']
    radii = [row['radius'] for row in totals if row['series'] == 'radius']
    equal(pixels, [8 * 4, 16 * 9, 32 * 18, 64 * 36], 'pixels')
    equal(samples, ['vbao-1x4', 'vbao-1x8', 'vbao-1x16', 'vbao-1x32'], 'samples')
    equal(radii, [0.125, 0.25, 0.5, 1, 2], 'radii')
    values = {series: [row['value'] for row in totals if row['series'] == series]
              for series in ('pixels', 'samples', 'radius')}
    equal(values, {'pixels': pixels, 'samples': [4, 8, 16, 32], 'radius': radii}, 'values')


@cases(['gtao-3x6', 'hemisphere-16', 'raymarch-2x4'])
def scaling_takes_any_setting(scratch, config):
    for form in ('--text', '--markdown'):
        out = speed(scratch, '--scaling', '--configs', config, form)
        for head in ('pixels by', 'samples by', 'radius by'):
            check(head in out, f'"{head}" is not in: {out}')


def memory(scratch, *arguments):
    """The table as {row: [MB for each size]}."""
    lines = speed(scratch, '--memory', '--markdown', *arguments).splitlines()
    check(lines[0].startswith('| scratch, MB |') and lines[1].startswith('|---|'), lines[0])
    cells = [[cell.strip() for cell in line.strip('|').split('|')] for line in lines[2:]]
    return {row[0]: [float(cell) for cell in row[1:]] for row in cells}


@case
def memory_grows_with_the_image_and_shrinks_with_half_resolution(scratch):
    table = memory(scratch, '--size', '1080p,2160p')
    check({'AO', 'AO, half resolution', 'bent normals', 'composite, no AO image'} <= set(table),
          f'{table}')
    for name, (small, large) in table.items():
        # Not quite 4: the ring between the blur's directions grows with the width alone.
        check(3.4 < large / small < 4.1, f'{name}: {small} and {large} MB')
    check(0.24 < table['AO, half resolution'][1] / table['AO'][1] < 0.4, f'{table}')


@case
def memory_has_a_text(scratch):
    text = speed(scratch, '--memory')
    matches(r'(?m)^scratch, MB +64 x 36', text, 'the text')
    matches(r'(?m)^AO +[0-9.]+ *$', text, 'the text')


# --- Wrong use ---

@cases([('--size', ('0x5', '64', '64x', 'x64', '64x36x2', '70000x1', '4k', '-1x5'), 'want WxH'),
        ('--configs', ('vbao-fastest', 'gtao-0x6', 'gtao-65x6', 'gtao-3x257', 'sphere-1025',
                       'fast,gtao-3'), 'no setting'),
        ('--preset', ('ultra', 'slow,fast'), 'no setting'),
        ('--method', ('ssao', 'default', 'gtao-3x6'), 'no method'),
        ('--runs', ('0', '1001', '2.5', 'many'), 'whole number from 1 to 1000'),
        ('--sky', ('-1', '101', 'all'), 'whole number from 0 to 100'),
        ('--threads', ('-1', '257', 'x'), 'whole number from 0 to 256'),
        ('--radius', ('0', '-1', 'nan', 'inf', 'x'), 'finite number > 0')])
def values_are_checked(scratch, option, values, message):
    for value in values:
        fails(scratch, USAGE, message, option, value)


@cases([(' '.join(a), a, m) for a, m in [
    (('--slices', '2'), 'belong to --method'),
    (('--vs', 'true', '--size', '8x8,9x9'), '--vs compares at one --size'),
    (('--dump', 'x', '--size', '8x8,9x9'), '--dump writes one --size'),
    (('--start', '--memory'), 'exclude one another'),
    (('--start', '--vs', 'true'), 'do not go with'),
    (('--memory', '--json', 'x.json'), 'does not go with'),
    (('--start', '--composite'), '--composite does not go with --start'),
    (('--start', '--bent-normals', '--method', 'vbao'), '--bent-normals does not go with --start'),
    (('--start', '--radius', '1'), '--radius does not go with --start'),
    (('--start', '--sky', '30'), '--sky does not go with --start'),
    (('--memory', '--configs', 'gtao'), '--configs does not go with --memory'),
    (('--memory', '--preset', 'fast'), '--preset does not go with --memory'),
    (('--memory', '--method', 'gtao'), '--method does not go with --memory'),
    (('--memory', '--composite'), '--composite does not go with --memory'),
    (('--scaling', '--configs', 'fast,best'), 'takes one setting'),
    (('--bent-normals', '--configs', 'sphere-16'), 'sphere-16 has none'),
    (('--size', ''), '--size is empty'),
    (('--size', ','), 'names nothing'),
    (('folder',), "'folder' is no option"),
    (('--fast',), "unknown option '--fast'"),
    (('--text=1',), "option '--text=1' takes no argument"),
    (('--text', '-zq'), "unknown option '-z'"),
]])
def wrong_use_is_refused(scratch, _, arguments, message):
    fails(scratch, USAGE, message, *arguments, hint='vkao-bench speed --help')


@case
def outputs_that_cannot_be_written(scratch):
    for option, name in (('--json', 'no/out.json'), ('--dump', 'no/x')):
        run = scratch.run('speed', *SMALL, '--preset', 'default', option, name)
        equal(run.code, OUTPUT, f'exit code of {run}')
        equal(scratch.files(), [], 'files')


@case
def devices_that_are_not_there(scratch):
    fails(scratch, DEVICE, 'no Vulkan 1.1 device fits', '--device', 'no such device')


@case
def one_size_beyond_the_device(scratch):
    fails(scratch, DEVICE, 'maxImageDimension2D', '--size', '65535x65535')


@case
def help_names_every_option(scratch):
    text = scratch.render('speed', '--help').stdout
    for option in ('--size', '--configs', '--preset', '--method', '--vs', '--threads', '--start',
                   '--scaling', '--memory', '--dump', '--json', '--markdown'):
        check(f'  {option} ' in text or f'  {option}\n' in text, f'{option} is not in: {text}')


if __name__ == '__main__':
    main()
