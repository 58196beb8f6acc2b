#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Whichever Vulkan call fails: memory is 33, the device 5, with one line, a remedy and nothing left
behind.

Without case names, the first and last call of every function; `... VKAO LAYER --sweep` fails every
call of a run by its number.
"""
import collections
import os
import re
import sys

from cli import DEVICE, MEMORY, OK, SOME_FRAMES, Failed, case, check, equal, main, write_exr
from scene import FOV, Scene

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'support'))
import faults  # noqa: E402, after its directory is known

LAYER = os.path.abspath(sys.argv.pop(2))
SWEEP = '--sweep' in sys.argv and not sys.argv.remove('--sweep')
SCENE = Scene(24, 16)
RUNS = {
    'render': ('in.exr', '-o', 'out.exr', '--fov', FOV, '--device', 'cpu', '--quiet', '--mode',
               'comp', '--bent-normals'),
    'devices': ('devices',),
}


def run(scratch, name, log=None, fault=None):
    env = {**os.environ, **faults.environment(LAYER, scratch.path('layer'), log, fault)}
    return scratch.run(*RUNS[name], env=faults.without_leaks(env), timeout=60)


def remove_outputs(scratch):
    left = [file for file in scratch.files() if file not in ('in.exr', 'layer')]
    for file in left:
        os.remove(scratch.path(file))
    return left


def calls_of(scratch, name):
    log = scratch.path('log')
    result = run(scratch, name, log)
    equal(result.code, OK, f'exit code without a fault of {result}\n')
    calls = faults.read_log(log)
    remove_outputs(scratch)
    return calls


def check_fault(scratch, name, fault, code):
    result = run(scratch, name, fault=fault)
    left = remove_outputs(scratch)
    equal(result.code, code, f'exit code after {fault} of {result}\n')
    check(faults.is_message(result.stderr), f'not a message: {result}')
    check(re.search(r'\n +\S', result.stderr), f'no remedy: {result}')
    check(not left, f'{left} left after {fault}')


def sweep(scratch, name):
    write_exr(scratch.path('in.exr'),
              {'Z': SCENE.depth(), **SCENE.normals(), **SCENE.color()})
    calls = calls_of(scratch, name)
    faulty = [('*', n) for n in range(1, len(calls) + 1)] if SWEEP else \
        faults.first_and_last_calls(calls)
    wrong, count = [], collections.Counter()
    for function, n in faulty:
        for result, code in faults.CODES.items():
            # One kind of memory each: there is no difference to those who ask.
            if not SWEEP and result == -1 - n % 2:
                continue
            count[code] += 1
            try:
                check_fault(scratch, name, (function, n, result), code)
            except Failed as failure:
                wrong.append(str(failure))
    print(f'  {len(calls)} calls of {len(set(calls))} functions, {sum(count.values())} faults: '
          f'{dict(count)}')
    check(count[DEVICE] > 0 and count[MEMORY] > 0, 'no fault fired')
    check(not wrong, f'{len(wrong)} wrong:\n' + '\n'.join(wrong))


@case
def failing_calls_of_a_render_have_their_code_and_leave_nothing(scratch):
    sweep(scratch, 'render')


@case
def failing_calls_of_devices_have_their_code(scratch):
    sweep(scratch, 'devices')


@case
def a_lost_device_ends_a_sequence_and_a_full_one_does_not(scratch):
    """With --continue-on-error: the next frame finds no device, but it may find memory."""
    for n in (1, 2):
        write_exr(scratch.path(f'in.{n}.exr'), {'Z': SCENE.depth()})
    command = ('in.%d.exr', '-o', 'out.%d.exr', '--fov', FOV, '--device', 'cpu',
               '--continue-on-error')
    for call, result, code, outputs in (
            ('vkQueueSubmit', faults.DEVICE_LOST, DEVICE, []),
            ('vkQueueWaitIdle', faults.DEVICE_LOST, DEVICE, []),
            ('vkCreateDescriptorPool', faults.DEVICE_LOST, DEVICE, []),
            ('vkAllocateMemory', faults.OUT_OF_DEVICE_MEMORY, SOME_FRAMES, ['out.2.exr']),
            ('vkCreateImage', faults.OUT_OF_HOST_MEMORY, SOME_FRAMES, ['out.2.exr'])):
        env = {**os.environ, **faults.environment(LAYER, scratch.path('layer'),
                                                  fault=(call, 1, result))}
        done = scratch.run(*command, env=faults.without_leaks(env), timeout=60)
        equal(done.code, code, f'exit code after {call} of {done}\n')
        check('vkao: in.1.exr: ' in done.stderr, f'the message does not name the file: {done}')
        equal('frame 2/2' in done.stderr, code != DEVICE, f'whether another is tried in {done}')
        equal([f for f in scratch.files() if f.startswith('out')], outputs, 'outputs')
        for name in outputs:
            os.remove(scratch.path(name))


if __name__ == '__main__':
    main()
