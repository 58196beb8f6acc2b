# SPDX-License-Identifier: MIT
"""Runs vkao from the outside: cases, temporary directories, and EXR files through a second reader.

A test program is `test_NAME.py VKAO [--corpus DIR] [CASE...]`. It prints one line as each case
starts and one as it ends, and exits 0, 1 (a case failed) or 77 (all cases were skipped).
"""
import argparse
import hashlib
import itertools
import os
import pickle
import re
import resource
import subprocess
import sys
import tempfile
import time
import traceback

try:
    import numpy as np
    import OpenImageIO as oiio
except ImportError as missing:
    print(f'[  SKIPPED ] everything: {missing} (python3-numpy, python3-openimageio)')
    sys.exit(77)

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'support'))
from sanitizer import is_sanitized, loaded_driver  # noqa: E402, after its directory is known

OK, SOME_FRAMES, USAGE, INPUT, CHANNELS, DEVICE, OUTPUT = range(7)
MEMORY = 33
INTERRUPTED, TERMINATED = 130, 143

# Of one run; generous, because sanitizers and loaded machines are slow, but a hang must end.
TIMEOUT = 120

_cases = []
_settings = argparse.Namespace(vkao=None, corpus=None)


class Failed(Exception):
    """A check did not hold."""


class Skipped(Exception):
    """What the case needs is not here."""


# --- Cases ---

def case(function):
    """A case is a function of one Scratch directory."""
    _cases.append((function.__name__, lambda scratch: function(scratch)))
    return function


def cases(rows, name=lambda row: row if isinstance(row, str) else row[0]):
    """One case for every row: function(scratch, *row)."""
    def register(function):
        for row in rows:
            arguments = (row,) if isinstance(row, str) else tuple(row)
            _cases.append((f'{function.__name__}({name(row)})',
                           lambda scratch, a=arguments: function(scratch, *a)))
        return function
    return register


def check(condition, message):
    if not condition:
        raise Failed(message)


def equal(actual, wanted, what):
    check(actual == wanted, f'{what} is {actual!r}, want {wanted!r}')


def matches(pattern, text, what):
    check(re.search(pattern, text), f'{what} does not match /{pattern}/:\n{text}')


def skip(reason):
    raise Skipped(reason)


def corpus(*names):
    """A file of the corpus; skips the case if it is not there."""
    if not _settings.corpus:
        skip('no corpus: neither --corpus nor ../shared/gbuffers beside the repository')
    path = os.path.join(_settings.corpus, *names)
    if not os.path.exists(path):
        skip(f'{path} is not there')
    return path


def find_corpus():
    """../shared/gbuffers beside the repository, or None. Known before main() makes the cases."""
    if '--corpus' in sys.argv[:-1]:
        return sys.argv[sys.argv.index('--corpus') + 1]
    root = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..')
    beside = os.path.normpath(os.path.join(root, '..', 'shared', 'gbuffers'))
    return beside if os.path.isdir(beside) else None


def run_case(name, function):
    print(f'[ RUN      ] {name}', flush=True)
    try:
        with tempfile.TemporaryDirectory(prefix='vkao-test-') as directory:
            function(Scratch(directory))
    except Skipped as reason:
        print(f'[  SKIPPED ] {name}: {reason}', flush=True)
        return 'skipped'
    except Failed as failure:
        print(f'  {failure}\n[  FAILED  ] {name}', flush=True)
        return 'failed'
    except Exception:  # a broken case is a failed one, and the others still run
        traceback.print_exc(file=sys.stdout)
        print(f'[  FAILED  ] {name}', flush=True)
        return 'failed'
    print(f'[       OK ] {name}', flush=True)
    return 'ok'


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('vkao')
    parser.add_argument('--corpus')
    parser.add_argument('case', nargs='*', help='run those whose name contains this')
    arguments = parser.parse_args()
    _settings.vkao = os.path.abspath(arguments.vkao)
    _settings.corpus = find_corpus()
    for word in arguments.case:
        if not any(word in c[0] for c in _cases):
            parser.error(f'no case is called {word}')
    chosen = [c for c in _cases if not arguments.case or any(w in c[0] for w in arguments.case)]
    start = time.monotonic()
    results = [run_case(name, function) for name, function in chosen]
    count = {r: results.count(r) for r in ('ok', 'failed', 'skipped')}
    print(f'[==========] {len(results)} cases in {time.monotonic() - start:.1f} s: '
          f'{count["ok"]} ok, {count["failed"]} failed, {count["skipped"]} skipped')
    if not results or count['failed']:
        sys.exit(1)
    sys.exit(77 if count['skipped'] == len(results) else 0)


# --- Running ---

class Result:
    def __init__(self, arguments, process, seconds):
        self.command = ' '.join(['vkao', *arguments])
        self.code = process.returncode
        self.stdout, self.stderr = process.stdout, process.stderr
        self.seconds = seconds

    def __str__(self):
        return f'{self.command}\nexit {self.code}, stderr:\n{self.stderr}'


def vkao_is_sanitized():
    return is_sanitized(_settings.vkao)


def limit_file_size(size):
    """For preexec_fn: 'ulimit -f', here in bytes. Writing beyond would kill a careless process."""
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))


def beside_vkao(*names):
    """Another program of the same build, from the folder of vkao."""
    return os.path.join(os.path.dirname(_settings.vkao), *names)


def rename_shim():
    """For the environment: stops or kills a run before a rename, as rename_shim.c says."""
    shim = beside_vkao('..', '..', 'tests', 'cli', 'libvkao_rename_shim.so')
    if not os.path.exists(shim):
        skip(f'{shim} is not built')
    return {'LD_PRELOAD': os.path.abspath(shim)}


def wait_for_stop(process):
    end = time.monotonic() + TIMEOUT
    while process.poll() is None and time.monotonic() < end:
        with open(f'/proc/{process.pid}/stat', encoding='ascii') as file:
            if file.read().rsplit(')', 1)[1].split()[0] == 'T':
                return
        time.sleep(0.001)
    check(False, f'it has not stopped: {process.returncode}')


class Scratch:
    """A directory of one case; commands run in it."""

    def __init__(self, directory):
        self.directory = directory

    def path(self, *names):
        return os.path.join(self.directory, *names)

    def files(self, directory='.'):
        return sorted(os.listdir(self.path(directory)))

    def bytes(self, name):
        with open(self.path(name), 'rb') as file:
            return file.read()

    def write(self, name, data):
        with open(self.path(name), 'wb') as file:
            file.write(data if isinstance(data, bytes) else data.encode())
        return self.path(name)

    def start(self, *arguments, env=None, program=None, **more):
        more = {'stdout': subprocess.PIPE, **more}
        return subprocess.Popen([program or _settings.vkao, *arguments], cwd=self.directory,
                                text=True, stdin=subprocess.DEVNULL, stderr=subprocess.PIPE,
                                env={**os.environ, **loaded_driver(_settings.vkao), **(env or {})},
                                **more)

    def run(self, *arguments, timeout=TIMEOUT, **more):
        arguments = [str(a) for a in arguments]
        begin = time.monotonic()
        process = self.start(*arguments, **more)
        try:
            process.stdout, process.stderr = process.communicate(timeout=timeout)
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()
            raise Failed(f'{" ".join(arguments)}: still running after {timeout} s')
        return Result(arguments, process, time.monotonic() - begin)

    def render(self, *arguments, **more):
        """A run that must succeed and leave no temporary file."""
        result = self.run(*arguments, **more)
        check(result.code == OK, str(result))
        self.check_no_litter()
        return result

    def check_no_litter(self):
        litter = [f for f in self.files() if f.endswith('.tmp')]
        check(not litter, f'left behind: {litter}')

    def fails(self, code, message, *arguments, hint=None, **more):
        """A run that must fail with one line and a hint, and leave the directory as it was."""
        before = {f: _state(self.path(f)) for f in self.files()}
        result = self.run(*arguments, **more)
        equal(result.code, code, f'exit code of: {result}\n')
        after = {f: _state(self.path(f)) for f in self.files()}
        check(after == before, f'{result}the directory changed: {before} -> {after}')
        check_message(result, message, hint)
        return result


def _state(path):
    s = os.lstat(path)
    return s.st_ino, s.st_size, s.st_mtime_ns


def check_message(result, message, hint=None):
    """`vkao: message`, then at most one indented hint; warnings may stand before it."""
    lines = [line for line in result.stderr.splitlines()
             if not re.match(r'vkao: (warning|using|frame \d)', line)]
    check(1 <= len(lines) <= 2 and lines[0].startswith('vkao: '),
          f'want one line and a hint: {result}')
    matches(message, lines[0], 'the message')
    check(len(lines) == 1 or re.match(r' +\S', lines[1]), f'the hint is not indented: {result}')
    if hint:
        check(len(lines) == 2, f'no hint: {result}')
        matches(hint, lines[1], 'the hint')
    equal(result.stdout, '', 'stdout')


# --- EXR files ---

class Part:
    """One part as OpenImageIO reads it: channels by name, in their own pixel type."""

    def __init__(self, spec, channels):
        self.spec, self.channels = spec, channels
        self.name = spec.get_string_attribute('oiio:subimagename')
        self.attributes = {a.name: a.value for a in spec.extra_attribs}
        self.data_window = (spec.x, spec.y, spec.x + spec.width - 1, spec.y + spec.height - 1)
        self.display_window = (spec.full_x, spec.full_y, spec.full_x + spec.full_width - 1,
                               spec.full_y + spec.full_height - 1)

    def __getitem__(self, channel):
        return self.channels[channel]


def _read_part(file, path, index, only):
    spec = file.spec(index)
    kinds = [str(kind) for kind in spec.channelformats or [spec.format] * spec.nchannels]
    wanted = [c for c, name in enumerate(spec.channelnames) if not only or name in only]
    channels = {}
    # What lies side by side in one type is read at once: each reading decompresses the part anew.
    for _, run in itertools.groupby(enumerate(wanted), lambda at: (at[1] - at[0], kinds[at[1]])):
        together = [c for _, c in run]
        begin, end = together[0], together[-1] + 1
        pixels = file.read_image(index, 0, begin, end, kinds[begin])
        check(pixels is not None, f'{path}: {file.geterror()}')
        pixels = np.asarray(pixels).reshape(spec.height, spec.width, end - begin)
        for c in together:
            channels[spec.channelnames[c]] = np.ascontiguousarray(pixels[..., c - begin])
    return Part(spec, channels)


def read_parts(path, only=()):
    """only: the names of the channels to read; all of them without it."""
    file = oiio.ImageInput.open(path)
    check(file, f'{path}: {oiio.geterror()}')
    parts = []
    while file.seek_subimage(len(parts), 0):
        parts.append(_read_part(file, path, len(parts), only))
    file.close()
    return parts


def read_ao(path, channel=None, part=0):
    """By its name in a file of its own, or else beside other things."""
    channels = read_parts(path, (channel,) if channel else ('R', 'AO'))[part].channels
    return channels[channel or ('R' if 'R' in channels else 'AO')].astype(np.float32)


def make_spec(channels, compression='zip', name='', view='', x=0, y=0, display=None, tile=0,
              attributes=()):
    """channels: {name: 2-D array}; the arrays' own types (float32, float16, uint32) are stored."""
    kinds = {'float32': 'float', 'float16': 'half', 'uint32': 'uint'}
    height, width = next(iter(channels.values())).shape
    spec = oiio.ImageSpec(width, height, len(channels), 'float')
    spec.channelnames = tuple(channels)
    spec.channelformats = tuple(oiio.TypeDesc(kinds[str(c.dtype)]) for c in channels.values())
    spec.x, spec.y = x, y
    display = display or (x, y, x + width - 1, y + height - 1)
    spec.full_x, spec.full_y = display[:2]
    spec.full_width, spec.full_height = display[2] - display[0] + 1, display[3] - display[1] + 1
    spec.tile_width = spec.tile_height = tile
    spec.attribute('compression', compression)
    for key, value in (('oiio:subimagename', name), ('view', view)):
        if value:
            spec.attribute(key, value)
    for attribute in attributes:
        spec.attribute(*attribute)
    return spec


def _pixels(channels):
    """All channels behind one another in their own types, as write_native wants them."""
    kinds = {str(c.dtype) for c in channels.values()}
    check(len(kinds) == 1 or 'uint32' not in kinds, 'uint goes into a part of its own')
    kind = kinds.pop() if len(kinds) == 1 else 'float32'
    return np.ascontiguousarray(np.stack([c.astype(kind) for c in channels.values()], axis=-1))


def write_exr(path, *parts, **options):
    """Parts are channel dictionaries or (channel dictionary, options of make_spec)."""
    whole = [(p, {}) if isinstance(p, dict) else p for p in parts]
    specs = [make_spec(c, **{**options, **o}) for c, o in whole]
    file = oiio.ImageOutput.create(path)
    for index, (channels, _) in enumerate(whole):
        if index > 0:
            ok = file.open(path, specs[index], 'AppendSubimage')
        elif len(specs) == 1:
            ok = file.open(path, specs[0])
        else:
            ok = file.open(path, tuple(specs))
        check(ok, f'{path}: {file.geterror()}')
        pixels = _pixels(channels)
        tiled = specs[index].tile_width > 0
        ok = file.write_tiles(specs[index].x, specs[index].x + pixels.shape[1], specs[index].y,
                              specs[index].y + pixels.shape[0], 0, 1, pixels) \
            if tiled else file.write_image(pixels)
        check(ok, f'{path}: {file.geterror()}')
    file.close()
    return path


_computed = {}


def compute_ao(scratch, channels, *options, source='in.exr', target='ao.exr', **layout):
    """Writes both files: the AO, and what vkao says. The same of the same is computed once for all
    cases; an option that names a file stands for what the file holds."""
    write_exr(scratch.path(source), channels, **layout)
    options = [source, '-o', target, *map(str, options)]
    files = [scratch.bytes(o) for o in options[3:] if os.path.isfile(scratch.path(o))]
    what = pickle.dumps((list(channels.items()), repr(layout), options, files))
    key = hashlib.sha256(what).digest()
    if key not in _computed:
        said = scratch.render(*options).stderr
        _computed[key] = scratch.bytes(target), said
    data, said = _computed[key]
    scratch.write(target, data)
    return read_ao(scratch.path(target)), said


def run_tool(*command, cwd=None):
    """An independent tool, or a skip if it is not installed."""
    try:
        done = subprocess.run(command, cwd=cwd, capture_output=True, text=True, timeout=TIMEOUT)
    except FileNotFoundError:
        skip(f'{command[0]} is not installed')
    check(done.returncode == 0, f'{" ".join(command)}: {done.stdout}{done.stderr}')
    return done.stdout


# --- Comparing ---

def check_close(a, b, most, mean, what):
    """The largest and the mean difference, so that neither one texel nor a tint can hide."""
    equal(a.shape, b.shape, f'{what}: shape')
    difference = np.abs(a.astype(np.float64) - b.astype(np.float64))
    check(np.isfinite(difference).all(), f'{what}: not finite')
    check(difference.max() <= most and difference.mean() <= mean,
          f'{what}: largest difference {difference.max():.3g} (want <= {most:g}), '
          f'mean {difference.mean():.3g} (want <= {mean:g})')


def check_ao(ao, what):
    check(np.isfinite(ao).all(), f'{what}: NaN or infinity')
    check(ao.min() >= 0 and ao.max() <= 1, f'{what}: from {ao.min()} to {ao.max()}')
