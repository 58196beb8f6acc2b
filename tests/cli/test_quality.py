#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""vkao-bench quality: what it says of half resolution, of images apart and of another program,
recomputed from files of the tool. Sequences: test_flicker.py."""
import json
import os
import shutil

import numpy as np

from cli import (INPUT, OK, USAGE, beside_vkao, case, cases, check, equal, main, matches, read_ao,
                 read_parts, write_exr)

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..')
NAME, RADIUS = 'courtyard', 0.5
# The preset 'fast' by hand: all but its resolution.
FAST_AT_FULL = ('--quality', 'default', '--slices', 1, '--steps', 10, '--blur', 3,
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


# --- Images apart ---

# Each with a truth of its own, so that no mean is that of another group by chance.
NAMES = 'courtyard', 'courtyard_b', 'other'
CHOICE = '--methods', 'vbao-fast', '--falloff', 'smooth'


def three_images(scratch):
    folder(scratch)
    for name in NAMES[1:]:
        for suffix in ('exr', 'gt.exr', 'camera.json'):
            shutil.copy(scratch.path('corpus', f'{NAME}.{suffix}'),
                        scratch.path('corpus', f'{name}.{suffix}'))
    depth = read_parts(scratch.path('corpus', f'{NAME}.exr'))[0]['Z']
    for name, value in (('courtyard_b', 0.6), ('other', 0.3)):
        write_exr(scratch.path('corpus', f'{name}.gt.exr'),
                  {'AO_falloff': np.full(depth.shape, value, np.float32)},
                  attributes=[('aoRadius', 'float', RADIUS)])


def measure(scratch, *options):
    result = scratch.run('quality', 'corpus', '--no-raymarch', '--runs', 1, '--quiet', '--text',
                         '--markdown', '--json', 'x.json', *CHOICE, *options,
                         program=beside_vkao('..', 'bench', 'vkao-bench'))
    equal(result.code, OK, str(result))
    results = json.loads(scratch.bytes('x.json'))
    errors = {image['name']: image['results'][0]['rmse'] for image in results['images']}
    equal(tuple(errors), NAMES, 'images')
    return result.stdout, results, errors


def geometric(values):
    return np.exp(np.mean(np.log(list(values))))


def refuse(scratch, code, message, *options):
    scratch.fails(code, message, 'quality', 'corpus', '--quiet', *CHOICE, *options,
                  program=beside_vkao('..', 'bench', 'vkao-bench'))


@case
def fitted_images_have_means_of_their_own(scratch):
    three_images(scratch)
    text, results, _ = measure(scratch, '--fitted', 'court*,other')
    equal([image['fitted'] for image in results['images']], [True, True, True], 'fitted')
    check('means_others' not in results and ' others ' not in text, 'a mean of no images')
    text, results, errors = measure(scratch, '--fitted', 'courtyard,*_b')
    equal([image['fitted'] for image in results['images']], [True, True, False], 'fitted')
    for key, group, names in (('means', 'all', NAMES), ('means_fitted', 'fitted', NAMES[:2]),
                              ('means_others', 'others', NAMES[2:])):
        wanted, count = geometric(errors[name] for name in names), len(names)
        found = results[key][0]['rmse']
        check(abs(found / wanted - 1) < 1e-5, f'{key}: RMSE {found}, want {wanted}')
        matches(rf'vbao-fast .* {group} +{count} +{found:.4f} ', text, 'the table')
        matches(rf'\| vbao-fast \|.*\| {group} {count} \| {found:.4f} \|', text, 'the Markdown')


@case
def without_patterns_nothing_is_apart(scratch):
    three_images(scratch)
    text, results, _ = measure(scratch)
    check(not {'means_fitted', 'means_others'} & set(results), 'groups that nobody asked for')
    check('fitted' not in text and 'to ref.' not in text, text)
    equal(results['means'][0]['rmse_to_reference'], None, 'without a reference')


@case
def errors_are_divided_by_those_of_another_program(scratch):
    three_images(scratch)
    reference = {'courtyard': 0.02, 'other': 0.5, 'elsewhere': 0.1}
    scratch.write('other.json', json.dumps(reference))
    text, results, errors = measure(scratch, '--against', 'other.json', '--fitted', 'courtyard*')
    ratios = {name: errors[name] / reference[name] for name in ('courtyard', 'other')}
    for image in results['images']:
        found, wanted = image['results'][0]['rmse_to_reference'], ratios.get(image['name'])
        check(found == wanted or abs(found / wanted - 1) < 1e-4, f'{found}, want {wanted}')
    for key, wanted in (('means', geometric(ratios.values())),
                        ('means_fitted', ratios['courtyard']), ('means_others', ratios['other'])):
        found = results[key][0]['rmse_to_reference']
        check(abs(found / wanted - 1) < 1e-4, f'{key}: {found}, want {wanted}')
        matches(f' {found:.3f} ', text, 'the tables')
    matches('it names 2 of the images', text, 'the note')


@case
def patterns_and_references_are_checked_first(scratch):
    three_images(scratch)
    refuse(scratch, USAGE, "--fitted: 'cort\\*' fits no G-buffer of corpus", '--fitted',
           'court*,cort*')
    refuse(scratch, USAGE, '--against .* one falloff', '--against', 'x.json', '--falloff', 'both')
    refuse(scratch, INPUT, r'^vkao: none\.json: ', '--against', 'none.json')
    for text, message in (('{', 'not JSON'), ('[]', 'want {"scene": RMSE, ...}'),
                          ('{"a": 0}', "'a' must be a number > 0"),
                          ('{"b": "1"}', "'b' must be a number > 0")):
        scratch.write('bad.json', text)
        refuse(scratch, INPUT, rf'^vkao: bad\.json: {message}$', '--against', 'bad.json')


if __name__ == '__main__':
    main()
