#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Names that somebody chose to harm: none steers the terminal, and what is JSON stays JSON."""
import json
import os
import re
import shutil
import subprocess

from cli import (CHANNELS, INPUT, OK, OUTPUT, TIMEOUT, beside_vkao, cases, check, equal,
                 loaded_driver, main, write_exr)
from exr_raw import read_raw
from scene import FOV, Scene

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.normpath(os.path.join(HERE, '..', '..'))
SCENE = Scene(48, 27)

# Eight bytes each, since they replace eight bytes of a file; and how a person sees them.
NAMES = [
    ('escape', b'\x1b[31mAB\x07', r'\x1b[31mAB\x07'),
    ('c1', b'\xc2\x9b31mABC', r'\xc2\x9b31mABC'),
    ('bidi', b'\xe2\x80\xaegpj.x', r'\xe2\x80\xaegpj.x'),
    ('isolate', b'\xe2\x81\xa6gpj.x', r'\xe2\x81\xa6gpj.x'),
    ('separator', b'\xe2\x80\xa9line2', r'\xe2\x80\xa9line2'),
    ('latin1', b'caf\xe9\xe8\xff\xfeB', r'caf\xe9\xe8\xff\xfeB'),
    ('overlong', b'\xc0\xaf\xed\xa0\x80ABC', r'\xc0\xaf\xed\xa0\x80ABC'),
    ('beyond', b'\xf4\x90\x80\x80ABCD', r'\xf4\x90\x80\x80ABCD'),
    ('newline', b'a\nvkao:b', r'a\x0avkao:b'),
    ('return', b'abcd\rxyz', r'abcd\x0dxyz'),
    ('delete', b'ab\x7f\x7f\x08\x08cd', r'ab\x7f\x7f\x08\x08cd'),
    ('forged', rb'A\x1b[2J', r'A\x5cx1b[2J'),
    ('legal', 'Läng≈'.encode(), 'Läng≈'),
]
STEERS = re.compile('[\x00-\x08\x0b-\x1f\x7f-\x9f\u2028\u2029\u202a-\u202e\u2066-\u2069]')


def run(scratch, code, *arguments, program='vkao'):
    """Both streams, in bytes as they came, checked and decoded."""
    command = [beside_vkao(program), *map(os.fsencode, map(str_or_bytes, arguments))]
    done = subprocess.run(command, cwd=scratch.directory, stdin=subprocess.DEVNULL,
                          capture_output=True, timeout=TIMEOUT,
                          env={**os.environ, **loaded_driver(command[0])})
    equal(done.returncode, code, f'exit code of {command}\n{done.stderr}\n')
    for stream in (done.stdout, done.stderr):
        text = stream.decode()  # strict: invalid UTF-8 fails the case
        check(not STEERS.search(text), f'{command} writes to the terminal: {stream}')
        check('--json' in arguments or '\t' not in text, f'{command} writes a tab: {stream}')
    return done.stdout.decode(), done.stderr.decode()


def str_or_bytes(argument):
    return argument if isinstance(argument, bytes) else str(argument)


def gbuffer(scratch, path, name):
    """Two parts, whose names, view, layers and text are the hostile one."""
    at = scratch.path('clean.exr')
    layer = {f'QQQQQQQQ.{c}': v for c, v in SCENE.color().items()}
    depth = {'QQQQQQQQ.Z': SCENE.depth()}
    write_exr(at, (depth, {'name': 'QQQQQQQQ-z', 'view': 'QQQQQQQQ',
                           'attributes': [('comments', 'QQQQQQQQ'), ('QQQQQQQQ', 'QQQQQQQQ')]}),
              (layer, {'name': 'QQQQQQQQ-rgb', 'view': 'QQQQQQQQ'}))
    data = scratch.bytes('clean.exr')
    check(data.count(b'QQQQQQQQ') >= 8, 'the names are not in the file')
    equal(len(name), 8, 'bytes of a name')
    with open(os.path.join(os.fsencode(scratch.directory), path), 'wb') as file:
        file.write(data.replace(b'QQQQQQQQ', name))
    os.remove(at)


def hostile_path(name):
    return b'in-' + name + b'.exr'


def in_json(name, seen):
    try:
        return name.decode() if rb'\x' not in name else seen
    except UnicodeDecodeError:
        return seen  # JSON has no way to say the bytes


@cases(NAMES)
def inspect_escapes_names(scratch, _, name, seen):
    gbuffer(scratch, hostile_path(name), name)
    for more in ((), ('-v',)):
        out, _ = run(scratch, CHANNELS, 'inspect', hostile_path(name), *more)
        lines = out.splitlines()
        equal(lines[0], f'in-{seen}.exr', 'the file')
        check(f" '{seen}-z' view {seen}: " in lines[1], f'the part is not told: {lines[1]!r}')
        check(any(line.endswith(f' {seen}.Z') for line in lines), f'no channel {seen}.Z in\n{out}')


@cases(NAMES)
def inspect_json_keeps_names(scratch, _, name, seen):
    gbuffer(scratch, hostile_path(name), name)
    out, _ = run(scratch, CHANNELS, 'inspect', hostile_path(name), '--json')
    facts = json.loads(out)
    wanted = in_json(name, seen)
    equal(facts['file'], f'in-{wanted}.exr', 'file')
    for part in facts['parts']:
        equal(part['view'], wanted, 'view of a part')
        check(all(c['name'].startswith(wanted + '.') for c in part['channels']), 'channels')
    equal(facts['parts'][0]['name'], f'{wanted}-z', 'name of a part')


MODES = [('ao', ()), ('append', ('--mode', 'append')), ('comp', ('--mode', 'comp'))]


@cases([(f'{name} {mode}', data, seen, more) for name, data, seen in NAMES
        for mode, more in MODES])
def rendering_escapes_names(scratch, _, name, seen, more):
    gbuffer(scratch, hostile_path(name), name)
    output = b'out-' + name + b'.exr'
    _, err = run(scratch, OK, hostile_path(name), '-o', output, '-v', '--fov', FOV, '--depth',
                 name + b'.Z', *(('--color', name) if more[-1:] == ('comp',) else ()), *more)
    check(f'depth={seen}.Z' in err, f'the summary does not tell {seen}.Z:\n{err}')
    with open(os.path.join(os.fsencode(scratch.directory), output), 'rb') as file:
        part = read_raw(file.read())[-1]
    parameters = part.attributes['vkao/params'][1]
    facts = json.loads(parameters.decode())
    check(facts['depth'].endswith('.Z'), f'{facts}')
    check(not STEERS.search(parameters.decode()), f'{parameters}')


@cases(NAMES)
def errors_escape_names(scratch, _, name, seen):
    path = hostile_path(name)
    gbuffer(scratch, path, name)
    told = f'vkao: in-{seen}.exr: '
    failures = [
        (INPUT, f'vkao: no-{seen}.exr: cannot open', (b'no-' + name + b'.exr', '-o', 'x.exr')),
        (CHANNELS, told, (path, '-o', 'x.exr', '--depth', name)),
        (CHANNELS, told, (path, '-o', 'x.exr', '--normal', name + b'x')),
        (CHANNELS, told, (path, '-o', 'x.exr', '--view', name + b'x')),
        (OUTPUT, f'vkao: {seen}/x.exr: ', (path, '-o', name + b'/x.exr')),
        (INPUT, f'vkao: {seen}: cannot open', (path, '-o', 'x.exr', '--camera', name)),
        (2, seen, (path, '-o', 'x.exr', '--samples', name)),
        (2, seen, (path, '-o', 'x.exr', b'--' + name)),
        (5, seen, (path, '-o', 'x.exr', '--device', name)),
    ]
    for code, wanted, arguments in failures:
        arguments = list(arguments)
        if code in (OUTPUT, 5):
            arguments += ['--depth', name + b'.Z', '--quiet']
        _, err = run(scratch, code, *arguments)
        check(wanted in err, f'{arguments}: no {wanted!r} in\n{err}')
        check(len(err.splitlines()) <= 2, f'more than a line and a hint: {err}')


@cases(NAMES)
def damaged_files_escape_names(scratch, _, name, seen):
    """Cut, and with the size of an attribute blown up: messages that quote what OpenEXR found."""
    path = hostile_path(name)
    gbuffer(scratch, path, name)
    at = os.path.join(os.fsencode(scratch.directory), path)
    with open(at, 'rb') as file:
        whole = file.read()
    value = whole.index(name + b'\0string\0') + len(name) + 8
    for data in (whole[:-9], whole[:value + 2],
                 whole[:value] + b'\xff\xff\xff\x7f' + whole[value + 4:]):
        with open(at, 'wb') as file:
            file.write(data)
        for command in ((path, '-o', 'x.exr'), ('inspect', path), ('inspect', path, '--json')):
            out, err = run(scratch, INPUT, *command)
            equal(out, '', 'stdout')
            check(err.startswith(f'vkao: in-{seen}.exr: '), err)


@cases(NAMES)
def sequences_escape_names(scratch, _, name, seen):
    for number in (1, 2):
        gbuffer(scratch, b'%s.%04d.exr' % (name, number), name)
    _, err = run(scratch, 1, name + b'.####.exr', '-o', b'o' + name + b'.####.exr', '--frames',
                 '1-3', '--depth', name + b'.Z', '--fov', FOV, '--continue-on-error', '-v')
    for wanted in (f'frame 1/3 (1): o{seen}.0001.exr', f'{seen}.0003.exr: cannot open',
                   'frames found: 1-2'):
        check(wanted in err, f'no {wanted!r} in\n{err}')


@cases(NAMES)
def bench_escapes_names(scratch, _, name, seen):
    golden = os.path.join(ROOT, 'tests', 'golden', 'courtyard_small')
    folder = os.path.join(os.fsencode(scratch.directory), name)
    os.mkdir(folder)
    camera = os.path.join(ROOT, 'tools', 'demo', 'courtyard.camera.json')
    for suffix, source in (('.exr', golden + '.exr'), ('.gt.exr', golden + '.gt.exr'),
                           ('.camera.json', camera)):
        shutil.copy(source, os.path.join(folder, name + os.fsencode(suffix)))
    run(scratch, OK, 'quality', name, '--methods', 'hbao-2x2', '--no-raymarch', '--runs', 1,
        '--json', 'all.json', program='../bench/vkao-bench')
    facts = json.loads(scratch.bytes('all.json').decode())
    equal([image['name'] for image in facts['images']], [in_json(name, seen)], 'images')
    _, err = run(scratch, INPUT, 'quality', name + b'x', program='../bench/vkao-bench')
    check(f'vkao: {seen}x: ' in err, err)


if __name__ == '__main__':
    main()
