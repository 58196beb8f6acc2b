#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""tools/bench/on-device: a pack runs by itself, and says what it measured and what went wrong. How
fast a device is is nobody's promise."""
import json
import os
import subprocess
import sys

from cli import (beside_vkao, case, check, equal, main, matches, skip, vkao_is_sanitized)

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..')
SCRIPT = os.path.join(ROOT, 'tools', 'bench', 'on-device')
SMALL = ('--device', 'cpu', '--size', '32x18', '--runs', '1')
OK, FAILED, USAGE, NO_DEVICE = 0, 1, 2, 5


def on_device(scratch, *arguments, script=SCRIPT, env=None):
    return subprocess.run([sys.executable, script, *arguments], cwd=scratch.directory, text=True,
                          capture_output=True, timeout=300, env={**os.environ, **(env or {})},
                          check=False)


def results(scratch):
    return json.loads(scratch.bytes('report.json')), scratch.bytes('report.txt').decode()


@case
def a_pack_runs_by_itself(scratch):
    if vkao_is_sanitized():
        skip('a pack of programs that need a sanitizer runs nowhere else')
    run = on_device(scratch, '--pack', 'pack', beside_vkao('..', '..'))
    equal(run.returncode, OK, f'exit code of --pack: {run.stderr}')
    packed = scratch.bytes(os.path.join('pack', 'bin', 'vkao'))
    check(b'.symtab' not in packed and b'.debug_' not in packed, 'vkao is not stripped')
    check(os.path.exists(scratch.path('pack', 'lib', 'libvkao.so.0.2')), 'no library is packed')
    check(not os.path.exists(scratch.path('pack', 'lib', 'libc.so.6')), 'the C library is packed')
    # One picture that lavapipe did not make, and one program that fails.
    stored = scratch.path('pack', 'data', 'lavapipe')
    os.replace(os.path.join(stored, 'sphere.exr'), os.path.join(stored, 'hbao.exr'))
    scratch.write(os.path.join('pack', 'bin', 'test_none'),
                  '#!/bin/sh\necho "[  PASSED  ] 2 test(s)."\n'
                  'echo "[  FAILED  ] tests: 1 test(s), listed below:"\nexit 1\n')
    os.chmod(scratch.path('pack', 'bin', 'test_none'), 0o755)
    run = on_device(scratch, 'pack', '-o', 'report', '--tests', 'none', *SMALL,
                    script=scratch.path('pack', 'on-device'))
    equal(run.returncode, FAILED, f'exit code: {run.stderr}')
    found, text = results(scratch)
    check('llvmpipe' in found['device'] and 'Mesa' in found['driver'], f'{found["device"]}')
    equal({row['config'] for row in found['speed']},
          {'vbao-fast', 'vbao-default', 'vbao-high', 'vbao-best'}, 'presets')
    equal({row['texels'] for row in found['radii']}, {10, 100, 400}, 'radii')
    check(found['copy'][0]['gb_per_s'] > 0, f'{found["copy"]}')
    differ = [row['picture'] for row in found['pictures'] if not row['equal']]
    equal(differ, ['hbao'], 'pictures that differ')
    check(os.path.exists(scratch.path('report.hbao.exr')), 'the picture that differs is not kept')
    equal([(row['program'], row['passed'], row['failed']) for row in found['tests']],
          [('test_none', 2, 1)], 'tests')
    for what in ('hbao differs', 'No such file', 'test_none: exit code 1'):
        check(any(what in trouble for trouble in found['troubles']) and what in text,
              f'"{what}" is not in: {found["troubles"]}')


@case
def without_a_device_the_report_says_why(scratch):
    run = on_device(scratch, beside_vkao('..', '..'), '-o', 'report', *SMALL,
                    env={'VK_ICD_FILENAMES': '/nowhere.json', 'VK_DRIVER_FILES': '/nowhere.json'})
    equal(run.returncode, NO_DEVICE, f'exit code: {run.stderr}')
    _, text = results(scratch)
    matches('no Vulkan device:', text, 'the text')


@case
def wrong_trees_are_refused(scratch):
    os.mkdir(scratch.path('empty'))
    for arguments in (('empty',), ('--pack', 'pack', 'empty'), ('--pack', 'empty', 'empty')):
        run = on_device(scratch, *arguments)
        equal(run.returncode, USAGE, f'exit code of {arguments}: {run.stderr}')
        matches('(no vkao; want a build directory|exists already)', run.stderr, 'stderr')
    equal(scratch.files(), ['empty'], 'files')


if __name__ == '__main__':
    main()
