#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""vkao-bench quality: what it says of half resolution, recomputed from files of the tool."""
import json
import os
import shutil

import numpy as np

from cli import OK, beside_vkao, case, cases, check, equal, main, matches, read_ao, read_parts

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..')
NAME, RADIUS = 'courtyard', 0.5
# The preset 'fast' by hand: all but its resolution.
FAST_AT_FULL = ('--quality', 'default', '--slices', 1, '--steps', 8, '--blur', 3,
                '--blur-normal-power', 0)


def folder(scratch):
    os.mkdir(scratch.path('corpus'))
    for source, suffix in (('tests/golden/courtyard_small.exr', 'exr'),
                           ('tests/golden/courtyard_small.gt.exr', 'gt.exr'),
                           ('tools/demo/courtyard.camera.json', 'camera.json')):
        shutil.copy(os.path.join(ROOT, source), scratch.path('corpus', f'{NAME}.{suffix}'))


def quality(scratch, *options):
    """Its output, and what it wrote as JSON."""
    folder(scratch)
    result = scratch.run('quality', 'corpus', '--no-raymarch', '--runs', 1, '--quiet', '--json',
                         'x.json', *options, program=beside_vkao('..', 'bench', 'vkao-bench'))
    equal(result.code, OK, str(result))
    return result.stdout, json.loads(scratch.bytes('x.json'))


def by_hand(scratch, falloff, *options):
    scratch.render(f'corpus/{NAME}.exr', '-o', 'ao.exr', '--camera', f'corpus/{NAME}.camera.json',
                   '--radius', RADIUS, '--falloff', falloff, '--pixel-type', 'float',
                   '--overwrite', 'always', *options)
    return read_ao(scratch.path('ao.exr')).astype(np.float64)


def rmse(a, b, foreground):
    return np.sqrt(np.mean((a - b)[foreground] ** 2))


@cases(['smooth', 'threshold'])
def half_resolution_is_compared_with_full(scratch, falloff):
    methods = 'vbao-fast,vbao-default'
    text, results = quality(scratch, '--methods', methods, '--falloff', falloff, '--text',
                            '--markdown')
    depth = read_parts(scratch.path('corpus', f'{NAME}.exr'))[0]['Z']
    foreground = np.isfinite(depth) & (depth > 0) & (depth < 1e9)
    half = by_hand(scratch, falloff, '--quality', 'fast')
    wanted = rmse(half, by_hand(scratch, falloff, *FAST_AT_FULL), foreground)
    check(0.003 < wanted < 0.2, f'half resolution is {wanted} off')
    for cells in (results['images'][0]['results'], results['means']):
        equal([c['setting'] for c in cells], methods.split(','), 'settings')
        found, absent = (c['rmse_against_full_resolution'] for c in cells)
        check(abs(found - wanted) < 1e-5, f'{found} against full resolution, want {wanted}')
        equal(absent, None, 'of a setting at full resolution')
    figure = f'{results["means"][0]["rmse_against_full_resolution"]:.4f}'
    matches(rf'vbao-fast .* {figure} +[0-9.e+]+\n', text, 'the table')
    matches(r'vbao-default .* - +[0-9.e+]+\n', text, 'the table')
    matches(rf'\| vbao-fast \|.*\| {figure} \| [0-9.e+]+ \|\n', text, 'the Markdown')
    matches(r'\| vbao-default \|.*\| - \| [0-9.e+]+ \|\n', text, 'the Markdown')


@case
def errors_are_those_against_the_truth(scratch):
    _, results = quality(scratch, '--methods', 'vbao-default', '--falloff', 'smooth')
    depth = read_parts(scratch.path('corpus', f'{NAME}.exr'))[0]['Z']
    foreground = np.isfinite(depth) & (depth > 0) & (depth < 1e9)
    truth = read_parts(scratch.path('corpus', f'{NAME}.gt.exr'))[0]['AO_falloff']
    ao, cell = by_hand(scratch, 'smooth'), results['means'][0]
    wanted = rmse(ao, truth, foreground)
    check(abs(cell['rmse'] - wanted) < 1e-5, f'RMSE {cell["rmse"]}, want {wanted}')
    wanted = (ao - truth)[foreground].mean()
    check(abs(cell['bias'] - wanted) < 1e-5, f'bias {cell["bias"]}, want {wanted}')
    equal(results['images'][0]['foreground'], int(foreground.sum()), 'texels that count')


@case
def json_on_standard_output_stands_alone(scratch):
    folder(scratch)
    result = scratch.run('quality', 'corpus', '--no-raymarch', '--runs', 1, '--quiet', '--methods',
                         'vbao-fast', '--json', '-',
                         program=beside_vkao('..', 'bench', 'vkao-bench'))
    equal(result.code, OK, str(result))
    results = json.loads(result.stdout)
    equal([(s['name'], s['method'], s['yardstick']) for s in results['settings']],
          [('vbao-fast', 'vbao', False)], 'settings')


if __name__ == '__main__':
    main()
