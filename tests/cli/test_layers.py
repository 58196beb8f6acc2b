#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Thickness, back depth and a second layer as channels: a card before a wall, whose layers are
known."""
import re

import numpy as np

from cli import (CHANNELS, INPUT, MEMORY, OK, USAGE, case, cases, check, check_close, compute_ao,
                 equal, main, matches, read_ao, write_exr)
from exr_raw import read_raw

WIDTH, HEIGHT, FOV = 128, 96, 60.0
NEAR, FAR = 0.5, 40.0
CARD, WALL, THICK = 3.5, 4.0, 0.02
BASE = ('--fov', FOV, '--radius', 1, '--pixel-type', 'float', '--overwrite', 'always')


def rays():
    half = np.tan(np.radians(FOV / 2))
    x = ((np.arange(WIDTH) + 0.5) / WIDTH * 2 - 1) * half
    y = (1 - (np.arange(HEIGHT) + 0.5) / HEIGHT * 2) * half * HEIGHT / WIDTH
    return np.meshgrid(x, y)


X, Y = rays()
STRETCH = np.sqrt(1 + X ** 2 + Y ** 2)
SKY = Y > 0.38
ON_CARD = (abs(X * CARD) < 0.15) & (Y * CARD < 0.9)
FRONT = np.where(SKY, np.inf, np.where(ON_CARD, CARD, WALL))
# What is behind the wall nobody has seen.
BACK = np.where(ON_CARD & ~SKY, CARD + THICK, np.inf)
SECOND = np.where(ON_CARD & ~SKY, WALL, np.inf)
THICKNESS = np.where(ON_CARD & ~SKY, THICK, 0).astype(np.float32)
# Wall beside the card.
BESIDE = ~ON_CARD & ~SKY & (abs(X * CARD) < 0.5) & (abs(Y) < 0.2)

DEPTH_TYPES = [
    ('planar', 'planar', ()),
    ('radial', 'radial', ()),
    ('radial-near', 'radial-near', ('--near', NEAR)),
    ('inverse', 'inverse', ()),
    ('device', 'device', ('--near', NEAR, '--far', FAR)),
    ('reversed', 'device', ('--near', FAR, '--far', NEAR)),
]


def encoded(z, kind='planar', background=None):
    with np.errstate(invalid='ignore'):
        values, nothing = {
            'planar': (z, 1e10),
            'radial': (z * STRETCH, np.inf),
            'radial-near': ((z - NEAR) * STRETCH, 0),
            'inverse': (1 / z, 0),
            'device': (FAR / (FAR - NEAR) - FAR * NEAR / ((FAR - NEAR) * z), 1),
            'reversed': (NEAR * FAR / ((FAR - NEAR) * z) - NEAR / (FAR - NEAR), 0),
        }[kind]
    nothing = nothing if background is None else background
    return np.where(np.isinf(z), nothing, values).astype(np.float32)


def facing():
    return {'N.X': np.zeros_like(THICKNESS), 'N.Y': np.zeros_like(THICKNESS),
            'N.Z': (~SKY).astype(np.float32)}


def channels(kind='planar', background=None):
    return {'Z': encoded(FRONT, kind), **facing(), 'thick.V': THICKNESS,
            'back.V': encoded(BACK, kind, background),
            'second.V': encoded(SECOND, kind, background)}


def ao_of(scratch, *options, planes=None, **layout):
    return compute_ao(scratch, planes or channels(), *BASE, *options, **layout)[0]


def ao_and_words(scratch, *options, planes):
    return compute_ao(scratch, planes, *BASE, *options)[1]


METHODS = [('vbao',), ('raymarch',)]


@cases(METHODS)
def thickness_and_back_depth_give_the_same(scratch, method):
    given = ao_of(scratch, '-m', method, '--thickness-channel', 'thick.V')
    back = ao_of(scratch, '-m', method, '--back-depth', 'back.V')
    check_close(back, given, 1e-3, 1e-4, method)


@cases(METHODS)
def wall_behind_a_thin_card_is_lighter_with_its_thickness(scratch, method):
    seen = ao_of(scratch, '-m', method)
    given = ao_of(scratch, '-m', method, '--thickness-channel', 'thick.V')
    check(given[BESIDE].mean() > seen[BESIDE].mean() + 0.01,
          f'{method}: {seen[BESIDE].mean()} as seen, {given[BESIDE].mean()} with thickness')
    check((given[SKY] == 1).all(), f'{method}: the background is not 1')


@cases(DEPTH_TYPES)
def every_depth_type_gives_the_same(scratch, kind, name, planes):
    for options in (('--back-depth', 'back.V'), ('--layer2', 'second.V'),
                    ('--back-depth', 'back.V', '--layer2', 'second.V')):
        wanted = ao_of(scratch, *options)
        ao = ao_of(scratch, *options, '--depth-type', name, *planes, planes=channels(kind))
        # Rounding of what is stored turns single samples.
        check_close(ao, wanted, 0.07, 1e-3, f'{kind} {options}')


@cases([('1e10', 1e10), ('0', 0), ('inf', np.inf), ('NaN', np.nan)])
def background_of_the_layers_may_be_written_so(scratch, _, background):
    for options in (('--back-depth', 'back.V'), ('--layer2', 'second.V')):
        wanted = ao_of(scratch, *options)
        ao = ao_of(scratch, *options, planes=channels(background=background))
        check_close(ao, wanted, 0, 0, f'{options}')


@case
def unknown_thickness_may_be_written_in_any_way(scratch):
    wanted = ao_of(scratch, '--thickness-channel', 'thick.V')
    for unknown in (-1, np.inf, np.nan, 1e10):
        planes = channels()
        planes['thick.V'] = np.where(THICKNESS > 0, THICKNESS, unknown).astype(np.float32)
        check_close(ao_of(scratch, '--thickness-channel', 'thick.V', planes=planes), wanted, 0, 0,
                    f'{unknown}')


@cases(METHODS)
def second_layer_changes_ao(scratch, method):
    without = ao_of(scratch, '-m', method)
    # The wall goes on behind the card as it does beside it, and hides nothing. A second card does.
    same = ao_of(scratch, '-m', method, '--layer2', 'second.V')
    check_close(same, without, 0.01, 2e-4, f'{method}: the wall goes on')
    hidden = np.where(ON_CARD & ~SKY, (CARD + WALL) / 2, np.inf)
    other = ao_of(scratch, '-m', method, '--layer2', 'second.V',
                  planes=dict(channels(), **{'second.V': encoded(hidden)}))
    check(np.abs(without - other).mean() > 1e-3, f'{method}: --layer2 changes nothing')
    nothing = dict(channels(), **{'second.V': encoded(np.full_like(FRONT, np.inf))})
    empty = ao_of(scratch, '-m', method, '--layer2', 'second.V', planes=nothing)
    check_close(empty, without, 0.07, 2e-3, f'{method}: an empty layer')


@case
def half_floats_are_read(scratch):
    halves = {k: np.minimum(v, 65504).astype(np.float16) for k, v in channels().items()}
    options = ('--thickness-channel', 'thick.V', '--layer2', 'second.V', '--bias', 0.01)
    check_close(ao_of(scratch, *options, planes=halves), ao_of(scratch, *options), 0.07, 2e-3,
                'half')


@case
def channels_of_another_part_and_window_are_placed(scratch):
    names = ('back.V', 'second.V')
    options = ('--back-depth', 'back', '--layer2', 'layers/second.V')
    display = (0, 0, WIDTH - 1, HEIGHT - 1)
    window = ON_CARD & ~SKY
    rows, columns = np.flatnonzero(window.any(1)), np.flatnonzero(window.any(0))
    cut = slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)
    for kind, name, planes in DEPTH_TYPES:
        whole = channels(kind)
        how = ('--depth-type', name, *planes)
        wanted = ao_of(scratch, '--back-depth', 'back.V', '--layer2', 'second.V', *how,
                       planes=whole)
        first = {k: v for k, v in whole.items() if k not in names}
        second = {k: whole[k][cut] for k in names}
        write_exr(scratch.path('in.exr'), (first, {'name': 'front'}),
                  (second, {'name': 'layers', 'x': int(columns[0]), 'y': int(rows[0]),
                            'display': display}))
        scratch.render('in.exr', '-o', 'ao.exr', *BASE, *how, *options)
        check_close(read_ao(scratch.path('ao.exr')), wanted, 0, 0, kind)


@case
def cropped_window_gets_the_same(scratch):
    cut, options = (slice(8, 88), slice(24, 104)), ('--back-depth', 'back.V', '--layer2',
                                                    'second.V')
    parts = {k: v[cut] for k, v in channels().items()}
    ao = ao_of(scratch, *options, planes=parts, x=24, y=8, display=(0, 0, WIDTH - 1, HEIGHT - 1))
    whole = ao_of(scratch, *options)[cut]
    check_close(ao[30:60, 30:50], whole[30:60, 30:50], 0.07, 1e-3, 'the middle')


@cases([('--thickness-channel',), ('--back-depth',), ('--layer2',)])
def missing_channels_are_named(scratch, option):
    write_exr(scratch.path('in.exr'), channels())
    message = r"in\.exr: no channel or layer 'nothing'; channels: .*back\.V.* thick\.V"
    scratch.fails(CHANNELS, message, 'in.exr', '-o', 'ao.exr', option, 'nothing',
                  hint=f'{option} takes a channel')


@case
def wrong_uses_are_refused(scratch):
    write_exr(scratch.path('in.exr'), channels())
    run = ('in.exr', '-o', 'ao.exr')
    scratch.fails(USAGE, '--thickness-channel and --back-depth exclude each other', *run,
                  '--thickness-channel', 'thick.V', '--back-depth', 'back.V')
    for method in ('sphere', 'hemisphere', 'hbao', 'gtao'):
        for option in ('--thickness-channel', '--back-depth', '--layer2'):
            scratch.fails(USAGE, f'{option} needs --method vbao or raymarch', *run, '-m', method,
                          option, 'back.V')


@case
def memory_of_the_layers_is_counted(scratch):
    plane = np.full((1024, 1024), 1, np.float32)
    plane[0, 0] = 2
    write_exr(scratch.path('in.exr'), {name: plane for name in ('Z', 'thick.V', 'second.V')})
    needs = []
    for options in ((), ('--thickness-channel', 'thick.V'), ('--layer2', 'second.V')):
        run = scratch.run('in.exr', '-o', 'ao.exr', '--max-memory', 1, *options)
        equal(run.code, MEMORY, f'exit code with {options}')
        needs.append(int(re.search(r'need (\d+) MB', run.stderr).group(1)))
    # In host memory and on the device, and of the second layer a copy beside it.
    for need, texel_bytes in zip(needs[1:], (8, 12)):
        check(abs(need - needs[0] - texel_bytes * 1.05) <= 1.1, f'MB needed: {needs}')


SURFACE = ~SKY
WRONG_DEPTHS = [
    ('in front', np.where(SURFACE, FRONT * 0.5, np.inf), None, 'nearer than depth .* at 100 %'),
    ('metres', np.where(SURFACE, (FRONT + 1) / 1000, np.inf), None, 'nearer than depth'),
    ('in part', np.where(ON_CARD, CARD + 1, FRONT * 0.9), 'nearer than depth', None),
    ('the same', FRONT, 'nowhere behind depth .*, but the same', None),
    ('negative', -(FRONT + 1), 'has the other sign than depth', None),
    ('empty', np.full_like(FRONT, np.nan), 'has no value wherever depth', None),
    ('elsewhere', np.where(SURFACE, np.inf, 9), 'has no value wherever depth', None),
    ('millimetres', (FRONT + 1) * 1000, 'more than 4 times as far', None)]


@cases([(option, *row) for option in ('back-depth', 'layer2') for row in WRONG_DEPTHS],
       name=lambda row: ', '.join(row[:2]))
def what_is_not_behind_is_said(scratch, option, what, z, warning, refusal):
    planes = {**channels(), 'other.V': np.where(np.isinf(z), 1e10, z).astype(np.float32)}
    write_exr(scratch.path('in.exr'), planes)
    named = (f'--{option}', 'other')
    told = scratch.run('inspect', 'in.exr', '--fov', FOV, *named)
    if refusal:
        message = rf"in\.exr: --{option} 'other\.V' is {refusal}"
        scratch.fails(CHANNELS, message, 'in.exr', '-o', 'ao.exr', '--fov', FOV, *named,
                      hint='exchanged, in other units')
        equal(told.code, CHANNELS, 'exit code of inspect')
        matches(f'problem .*{refusal}', told.stdout, 'what is told')
        return
    said = scratch.render('in.exr', '-o', 'ao.exr', *BASE, *named).stderr
    matches(rf"warning: in\.exr: --{option} 'other\.V' .*{warning}", said, 'stderr')
    matches(f'warning .*{warning}', told.stdout, 'what is told')


@case
def second_layer_beyond_the_radius_is_said(scratch):
    planes = {**channels(), 'second.V': encoded(np.where(ON_CARD & SURFACE, WALL + 2, np.inf))}
    for radius, is_said in ((1, True), (3, False)):
        said = ao_and_words(scratch, '--layer2', 'second', '--radius', radius, planes=planes)
        equal("begins at 6, more than the radius of 1 behind all" in said, is_said, f'it in {said}')


@cases([('0', 0 * Y, 'nowhere above 0'), ('negative', 0 * Y - 1, 'nowhere above 0'),
        ('NaN', np.nan * Y, 'nowhere above 0'), ('normal', Y, 'is negative at .* %'),
        ('alpha', np.where(SURFACE, 1, 0), 'is 1 on nearly all of the surface: an alpha'),
        ('lossy', np.where(SURFACE, 0.5 + 0.002 * np.sin(99 * X), 9),
         r'is 0\.(5|49)\d* on nearly all')],
       name=lambda row: row[0])
def what_is_no_thickness_is_said(scratch, _, values, warning):
    planes = {**channels(), 'thick.V': values.astype(np.float32)}
    said = ao_and_words(scratch, '--thickness-channel', 'thick', planes=planes)
    matches(rf"warning: in\.exr: --thickness-channel 'thick\.V' .*{warning}", said, 'stderr')


@case
def an_alpha_is_no_thickness(scratch):
    # Less than 1 on a shadow catcher, so that its values alone do not tell.
    alpha = np.where(ON_CARD & SURFACE, 1, 0.2).astype(np.float32)
    for names, named, is_said in ((('R', 'G', 'B', 'A'), 'A', True), (('A',), 'A', True),
                                  (('rgba.R', 'rgba.G', 'rgba.B', 'rgba.A'), 'rgba.A', True),
                                  (('thick.A',), 'thick.A', False)):
        planes = {'Z': encoded(FRONT), **facing(), **{name: alpha for name in names}}
        write_exr(scratch.path('in.exr'), planes)
        told = scratch.run('inspect', 'in.exr', '--fov', FOV, '--thickness-channel', named)
        equal(f"--thickness-channel '{named}' is an alpha by its name" in told.stdout, is_said,
              f'whether it is in {told.stdout}')
    # A part that is called so has one channel, whatever that is called.
    write_exr(scratch.path('in.exr'), ({'Z': encoded(FRONT), **facing()}, {'name': 'front'}),
              ({'A': alpha}, {'name': 'thick'}))
    told = scratch.run('inspect', 'in.exr', '--fov', FOV, '--thickness-channel', 'thick/A')
    check('thick/A' in told.stdout and '--thickness-channel' not in told.stdout, told.stdout)


@case
def thickness_that_things_have_is_passed_in_silence(scratch):
    # The same where it is known, different all around, and alike on seven eighths.
    wide = np.where(SURFACE, 0.1 + 0.2 * (X - X.min()), 0)
    for name, values in (('where known', THICKNESS), ('different', wide),
                         ('walls', np.where(X < X[0, WIDTH // 8], wide + 1, 0.3))):
        write_exr(scratch.path('in.exr'), {**channels(), 'thick.V': values.astype(np.float32)})
        told = scratch.run('inspect', 'in.exr', '--fov', FOV, '--thickness-channel', 'thick')
        equal(told.code, OK, name)
        check('--thickness-channel' not in told.stdout, f'{name}: {told.stdout}')


@cases([(option, name) for option in ('thickness-channel', 'back-depth', 'layer2')
        for name in ('Z', 'N.Y')], name=', '.join)
def depth_and_normals_are_no_layers(scratch, option, name):
    write_exr(scratch.path('in.exr'), channels())
    what = 'the depth itself' if name == 'Z' else 'a component of the normals'
    scratch.fails(CHANNELS, f"--{option} '{name}' is {what}", 'in.exr', '-o', 'ao.exr',
                  f'--{option}', name, hint='name another channel')


@cases(DEPTH_TYPES)
def right_layers_are_passed_in_silence(scratch, kind, name, planes):
    for options in (('--back-depth', 'back.V'), ('--layer2', 'second.V'),
                    ('--thickness-channel', 'thick.V')):
        said = ao_and_words(scratch, *options, '--depth-type', name, *planes,
                            planes=channels(kind))
        check(options[0] not in said, said)


@case
def inspect_tells_what_was_named(scratch):
    write_exr(scratch.path('in.exr'), channels())
    run = scratch.run('inspect', 'in.exr', '--back-depth', 'back', '--layer2', 'second.V')
    equal(run.code, OK, 'exit code')
    matches(r'back_depth back\.V \(float', run.stdout, 'stdout')
    matches(r'layer2 +second\.V \(float', run.stdout, 'stdout')
    check('thickness' not in run.stdout, run.stdout)


@case
def record_names_the_channels(scratch):
    ao_of(scratch, '--back-depth', 'back', '--layer2', 'second.V')
    text = read_raw(scratch.bytes('ao.exr'))[0].text('vkao/params')
    for part in ('"thickness_input":"back-depth"', '"second_layer":true', '"back_depth":"back.V"',
                 '"layer2":"second.V"'):
        check(part in text, f'{part} is not in {text}')
    write_exr(scratch.path('forged.exr'), {'AO': THICKNESS},
              attributes=(('vkao/params', text.replace('"layer2"', '"layer3"')),))
    scratch.fails(INPUT, "'layer2' is missing", '--like', 'forged.exr', 'in.exr', '-o', 'c.exr',
                  hint='damaged')


if __name__ == '__main__':
    main()
