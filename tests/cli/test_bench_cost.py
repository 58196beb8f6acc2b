#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""vkao-bench cost, and that no pass has become longer than tools/bench/cost.txt says.

A change that is worth its instructions comes with a new table:

    build/tools/bench/vkao-bench cost > tools/bench/cost.txt
"""
import json
import os

from cli import (DEVICE, OK, USAGE, case, cases, check, equal, main, matches, skip,
                 vkao_is_sanitized)

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..')
TABLE = os.path.join(ROOT, 'tools', 'bench', 'cost.txt')
UPDATE = 'is it worth that? then: vkao-bench cost > tools/bench/cost.txt'
MOST = 1.03


def cost(scratch, *arguments):
    if vkao_is_sanitized():
        skip('counts are those of the other run, and the driver is not built for sanitizers')
    run = scratch.run('cost', *arguments)
    if run.code == DEVICE and 'RADV' in run.stderr:
        skip('no RADV that compiles without a GPU (mesa-vulkan-drivers)')
    equal(run.code, OK, f'exit code of {run}')
    return run.stdout


def passes(scratch, *arguments):
    return json.loads(cost(scratch, *arguments, '--json', '-'))['passes']


def read_table(text):
    """(driver, {(family, setting): {pass: figures}}); figures of a total: instructions and cycles,
    of several passes of one name: their sum."""
    lines = text.splitlines()
    found = {}
    for line in lines[6:]:
        family, setting, name, *numbers = line.split()
        is_total = name == 'total'
        figures = [float(numbers[0 if is_total else 1]), float(numbers[-1])]
        so_far = found.setdefault((family, setting), {}).setdefault(name, [0, 0])
        found[family, setting][name] = [a + b for a, b in zip(so_far, figures)]
    return lines[0].split(',')[0], found


@case
def no_pass_is_longer_than_the_table_says(scratch):
    with open(TABLE, encoding='utf-8') as file:
        driver, wanted = read_table(file.read())
    here, now = read_table(cost(scratch))
    if here != driver:
        skip(f'the table is that of {driver}, this is {here}')
    equal(sorted(now), sorted(wanted), f'what the table has ({UPDATE})')
    longer = []
    for key, names in now.items():
        for name, (instructions, cycles) in names.items():
            old = wanted[key].get(name)
            if old and (instructions > MOST * old[0] or cycles > MOST * old[1] + 1):
                longer.append(f'{" ".join(key)} {name}: {old[0]:.0f} -> {instructions:.0f} '
                              f'instructions, {old[1]:.0f} -> {cycles:.0f} cycles')
    check(not longer, '\n  '.join([f'longer by more than 3 %; {UPDATE}', *longer]))


@case
def figures_are_of_the_setting(scratch):
    rows = passes(scratch, '--family', 'navi21', '--configs', 'vbao-1x4,vbao-1x8,fast')
    totals = {row['config']: row for row in rows if row['pass'] == 'total'}
    ssao = {row['config']: row for row in rows if row['pass'].startswith('ssao')}
    for name in ('image', 'valu', 'transcendental', 'cycles'):
        check(ssao['vbao-1x8'][name] > 1.4 * ssao['vbao-1x4'][name], f'{name}: {ssao}')
    equal(ssao['vbao-1x8']['image'] - ssao['vbao-1x4']['image'], 8, 'loads of 4 steps both ways')
    # A quarter of the texels, and groups that reach over the border.
    check(0.25 <= ssao['vbao-fast']['threads_per_texel'] < 0.26, f'{ssao["vbao-fast"]}')
    check(totals['vbao-fast']['cycles'] < 0.5 * totals['vbao-1x8']['cycles'], f'{totals}')
    for config, total in totals.items():
        parts = sum(row['cycles'] for row in rows
                    if row['config'] == config and row['pass'] != 'total')
        check(abs(parts - total['cycles']) < 1e-4 * parts, f'{config}: {parts}, total {total}')


@case
def loops_of_ssao_count_as_often_as_they_run(scratch):
    few, many = (next(row for row in passes(scratch, '--family', 'vega10', '--configs', config)
                      if row['pass'].startswith('ssao')) for config in ('sphere-60', 'sphere-120'))
    equal((few['loops'], many['loops']), (1, 1), 'loops')
    for row in few, many:
        check(row['instructions'] < 500 and row['image'] > 60, f'nothing is unrolled in {row}')
    check(1.9 < many['valu'] / few['valu'] < 2.1, f'{few["valu"]} and {many["valu"]}')


@case
def bent_normals_cost_more(scratch):
    plain, bent = (passes(scratch, '--family', 'navi21', '--configs', 'default', *more)[-1]
                   for more in ([], ['--bent-normals']))
    check(bent['cycles'] > plain['cycles'], f'{bent} and {plain}')


@case
def shared_memory_is_what_every_device_has(scratch):
    rows = [row for more in ([], ['--bent-normals'])
            for row in passes(scratch, '--family', 'navi21', '--configs', 'fast,default,high,best',
                              *more) if row['pass'] != 'total']
    most = max(rows, key=lambda row: row['shared_bytes'])
    check(0 < most['shared_bytes'] <= 16384, f'{most}')


@cases([('family', ('--family', 'navi99'), "'navi99', want navi21"),
        ('families', ('--family', ''), '--family'),
        ('bent', ('--bent-normals', '--configs', 'sphere-16'), 'sphere-16 has none')])
def wrong_use_is_refused(scratch, _, arguments, message):
    scratch.fails(USAGE, message, 'cost', *arguments, hint='vkao-bench cost --help')


@case
def other_drivers_do_not_compile_for_it(scratch):
    icds = '/usr/share/vulkan/icd.d/lvp_icd.x86_64.json'
    if not os.path.exists(icds):
        skip(f'{icds} is not there')
    run = scratch.run('cost', '--family', 'navi21', env={'VK_ICD_FILENAMES': icds})
    equal(run.code, DEVICE, f'exit code of {run}')
    matches('RADV does not compile for navi21 here', run.stderr, 'stderr')
    matches('install mesa-vulkan-drivers', run.stderr, 'stderr')


if __name__ == '__main__':
    main()
