#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""tools/bench/plot: pictures of what vkao-bench measured."""
import json
import os
import shutil
import subprocess
import sys

import numpy as np

from cli import OK, case, cases, check, equal, main, matches, oiio, skip

try:
    import matplotlib  # noqa: F401, only whether it is there
    HAS_MATPLOTLIB = True
except ImportError:
    HAS_MATPLOTLIB = False

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..')
PLOT = os.path.join(ROOT, 'tools', 'bench', 'plot')
BLUE, ORANGE, RED = (0, 114, 178), (230, 159, 0), (213, 94, 0)


def plot(scratch, *arguments, **more):
    return subprocess.run([sys.executable, PLOT, *arguments], cwd=scratch.directory, text=True,
                          capture_output=True, timeout=120, **more)


def check_picture(scratch, wanted):
    """What the bench left in x.json becomes a picture that has these colours."""
    if not HAS_MATPLOTLIB:
        skip('no matplotlib (python3-matplotlib)')
    done = plot(scratch, 'x.json', 'x.png')
    equal((done.returncode, done.stdout, done.stderr), (0, '', ''), 'exit code and output')
    file = oiio.ImageInput.open(scratch.path('x.png'))
    check(file, f'x.png: {oiio.geterror()}')
    pixels = np.asarray(file.read_image('uint8'))[..., :3]
    file.close()
    check(pixels.shape[0] > 150 and pixels.shape[1] > 500, f'the size is {pixels.shape}')
    colors = {tuple(c) for c in np.unique(pixels.reshape(-1, 3), axis=0)}
    check({(255, 255, 255), *wanted} <= colors, f'white and {wanted} are not all there')


def measure(scratch, *arguments):
    run = scratch.run(*arguments, '--device', 'cpu', '--runs', 1, '--quiet', '--json', 'x.json')
    equal(run.code, OK, f'exit code of {run}')


@cases([
    ('one_size', {BLUE, ORANGE}, ('--size', '64x36', '--preset', 'fast,default', '--composite')),
    ('two_sizes', {BLUE, ORANGE}, ('--size', '64x36,32x18', '--method', 'gtao')),
    ('scaling', {BLUE, RED}, ('--size', '64x36', '--scaling')),
])
def speed_is_drawn(scratch, _, colors, arguments):
    measure(scratch, 'speed', *arguments)
    check_picture(scratch, colors)


@case
def quality_is_drawn(scratch):
    os.mkdir(scratch.path('corpus'))
    for source, suffix in (('tests/golden/courtyard_small.exr', 'exr'),
                           ('tests/golden/courtyard_small.gt.exr', 'gt.exr'),
                           ('tools/demo/courtyard.camera.json', 'camera.json')):
        shutil.copy(os.path.join(ROOT, source), scratch.path('corpus', f'courtyard.{suffix}'))
    measure(scratch, 'quality', 'corpus', '--methods', 'vbao-fast,gtao-1x8,hemisphere-16',
            '--raymarch-passes', 1)
    check_picture(scratch, {BLUE, ORANGE, RED})


def refused(done, message):
    equal(done.returncode, 1, f'exit code of: {done}')
    matches(message, done.stderr, 'the message')
    equal(done.stderr.count('\n'), 1, f'lines of: {done.stderr}')


@cases([
    ('absent', None, r'x\.json: .*No such file'),
    ('no_json', 'hello', r'x\.json: '),
    ('other_json', '{"a": 1}', r'x\.json: want what .*--json'),
    ('start', json.dumps([{'config': 'a start-cold', 'stage': 'total', 'median_ms': 1}]),
     r'x\.json: .*without --start'),
])
def wrong_files_are_refused(scratch, _, content, message):
    if not HAS_MATPLOTLIB:
        skip('no matplotlib (python3-matplotlib)')
    if content is not None:
        scratch.write('x.json', content)
    refused(plot(scratch, 'x.json', 'x.png'), message)
    check('x.png' not in scratch.files(), 'there is a picture')


@case
def pictures_that_cannot_be_written(scratch):
    if not HAS_MATPLOTLIB:
        skip('no matplotlib (python3-matplotlib)')
    row = {'config': 'a', 'stage': 'total', 'median_ms': 1, 'width': 8, 'height': 8}
    scratch.write('x.json', json.dumps([row]))
    refused(plot(scratch, 'x.json', 'no/x.png'), r'no/x\.png: .*No such file')
    refused(plot(scratch, 'x.json', 'x.what'), r'x\.what: ')


@case
def missing_matplotlib_is_named(scratch):
    scratch.write('matplotlib.py', 'raise ImportError')
    scratch.write('x.json', '[]')
    refused(plot(scratch, 'x.json', 'x.png', env={**os.environ, 'PYTHONPATH': scratch.directory}),
            'install python3-matplotlib')


if __name__ == '__main__':
    main()
