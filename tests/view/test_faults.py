#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""vkao-view when Vulkan fails: it ends with one line and 5, or 33 without memory.

`test_faults.py VKAO VKAO-VIEW LAYER [CASE...]` fails the first or last call of every function, of
live scenes every third, since most of them are the same; with --sweep, every call of a run.
"""
import collections
import concurrent.futures
import os
import signal
import subprocess
import sys

import view  # first: it knows where cli.py lies
from cli import Failed, case, check, write_exr
from scene import FOV, RADIUS, Scene
from view import Display

sys.path.insert(0, os.path.join(view.ROOT, 'tests', 'support'))
import faults  # noqa: E402, after its directory is known

LAYER = os.path.abspath(sys.argv.pop(3))
SWEEP = '--sweep' in sys.argv and not sys.argv.remove('--sweep')
SCENE = Scene(48, 27)
SECONDS = 60  # of one run; what hangs takes longer


def gbuffers(scratch):
    write_exr(scratch.path('in.exr'), {'Z': SCENE.depth(), **SCENE.normals(), **SCENE.color()})
    ao = {'AO': SCENE.depth() * 0 + 0.5}
    write_exr(scratch.path('in.gt.exr'), ao)


def shot_of(scratch, fault):
    return scratch.path('-'.join(map(str, fault or ('whole',))).replace('*', 'call') + '.png')


def run(scratch, arguments, log=None, fault=None):
    layer = faults.environment(LAYER, scratch.path('layer'), log, fault)
    command = [view.VIEWER, '--device', 'cpu', '--size', '480x320', '--frames', '3',
               '--screenshot', shot_of(scratch, fault), *map(str, arguments)]
    try:
        return subprocess.run(command, cwd=scratch.directory, capture_output=True, text=True,
                              stdin=subprocess.DEVNULL, timeout=SECONDS,
                              env=faults.without_leaks({**os.environ, **Display.get().environment(),
                                                 **layer}))
    except subprocess.TimeoutExpired as late:
        raise Failed(f'{fault}: still running after {SECONDS} s: {late.stderr}')


def check_fault(scratch, arguments, fault, code):
    done = run(scratch, arguments, fault=fault)
    how = f'exit code {done.returncode}'
    if done.returncode < 0:
        how = signal.Signals(-done.returncode).name
    check(done.returncode == code, f'{fault}: {how}, want {code}: {done.stderr}')
    check(faults.is_message(done.stderr), f'{fault}: not a message: {done.stderr}')
    check(not done.stdout, f'{fault}: says {done.stdout}')


def sweep(scratch, *arguments, each=1):
    gbuffers(scratch)
    log = scratch.path('log')
    done = run(scratch, arguments, log)
    check(done.returncode == 0, f'without a fault: exit code {done.returncode}\n{done.stderr}')
    calls = faults.read_log(log)
    results = list(faults.CODES)
    rows = [('*', n, results[n % len(results)]) for n in range(1, len(calls) + 1)] if SWEEP \
        else faults.taking_turns(calls)[::each]

    def failure_of(fault):
        try:
            check_fault(scratch, arguments, fault, faults.CODES[fault[2]])
        except Failed as failure:
            return str(failure)
        return None
    # The runs wait for the display more than they compute.
    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        wrong = [failure for failure in pool.map(failure_of, rows) if failure]
    count = collections.Counter(faults.CODES[fault[2]] for fault in rows)
    scratch.check_no_litter()
    print(f'  {len(calls)} calls of {len(set(calls))} functions, {len(rows)} faults: '
          f'{dict(count)}')
    check(not wrong, f'{len(wrong)} wrong:\n' + '\n'.join(wrong))


@case
def failing_calls_end_the_view_of_a_file(scratch):
    sweep(scratch, 'in.exr', '--quiet', '--fov', FOV, '--radius', RADIUS, '--show', 'difference',
          '--versus', '--method hbao', '--wipe', '0.5')


@case
def failing_calls_end_a_live_scene(scratch):
    sweep(scratch, '--scene', 'cubes', '--time', '1', each=3)


if __name__ == '__main__':
    view.main()
