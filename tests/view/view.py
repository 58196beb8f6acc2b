# SPDX-License-Identifier: MIT
"""Drives vkao-view in a display of its own, Xvfb, with keys and a mouse (xdotool).

A test program is `test_NAME.py VKAO VKAO-VIEW [CASE...]`; the cases and the comparison with vkao
are those of tests/cli. Every run has the validation layers on: one message makes the viewer fail,
and with it the case.
"""
import contextlib
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
import time

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.normpath(os.path.join(HERE, '..', '..'))
sys.path.insert(0, os.path.join(HERE, '..', 'cli'))

import cli  # noqa: E402, after its directory is known
from cli import Failed, check, equal, np, oiio, skip, write_exr  # noqa: E402
from scene import FOV, RADIUS, Scene  # noqa: E402

VIEWER = None
TIMEOUT = 120
PANEL_WIDTH = 330  # of tools/view/viewer.h
BACKGROUND = (23, 26, 28)  # of shaders/display.frag
LINE = (255, 153, 26)

SCENE = Scene()
READ = ('--fov', FOV, '--radius', RADIUS)
WHOLE = ('--no-panel',)


def main():
    global VIEWER
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    VIEWER = os.path.abspath(sys.argv.pop(2))
    for tool in ('Xvfb', 'xdotool'):
        if not shutil.which(tool):
            print(f'[  SKIPPED ] everything: {tool} is not installed')
            sys.exit(77)
    try:
        cli.main()
    finally:
        Display.stop_all()


# --- Display ---

class Display:
    """An X server with a screen in memory; one serves all cases of a program."""
    running = None

    @classmethod
    def get(cls):
        if not cls.running:
            cls.running = cls()
        return cls.running

    @classmethod
    def stop_all(cls):
        if cls.running:
            cls.running.server.terminate()
            cls.running.server.wait()
            cls.running = None

    def __init__(self):
        read, write = os.pipe()
        self.server = subprocess.Popen(
            ['Xvfb', '-displayfd', str(write), '-screen', '0', '1600x1000x24', '-nolisten', 'tcp',
             '-noreset'],
            pass_fds=[write], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL)
        os.close(write)
        with os.fdopen(read) as pipe:
            number = pipe.readline().strip()
        check(number, 'Xvfb did not start')
        self.name = f':{number}'

    def environment(self):
        return {'DISPLAY': self.name, 'XDG_SESSION_TYPE': 'x11', **sanitizer_options()}

    def xdotool(self, *arguments):
        done = subprocess.run(['xdotool', *map(str, arguments)], capture_output=True, text=True,
                              env={**os.environ, 'DISPLAY': self.name}, timeout=TIMEOUT)
        return done.stdout.strip()


def sanitizer_options():
    """Leaks of libraries that are not ours are left out, by name; they must stay loaded."""
    suppressions = os.path.join(HERE, 'leaks.supp')
    return {'LSAN_OPTIONS': f'suppressions={suppressions}:print_suppressions=0',
            **cli.loaded_driver(VIEWER)}


# --- The viewer ---

class Viewer:
    """A running vkao-view, its window in the corner of the screen."""

    def __init__(self, scratch, *arguments, size=None, env=None):
        self.scratch, self.display = scratch, Display.get()
        arguments = [str(a) for a in arguments]
        if size:
            arguments += ['--size', f'{size[0]}x{size[1]}']
        self.command = [VIEWER, '--validation', '--device', 'cpu', '--screenshot', 'last.png',
                        *arguments]
        self.process = subprocess.Popen(
            self.command, cwd=scratch.directory, text=True, stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE, stderr=subprocess.PIPE,
            env={**os.environ, **self.display.environment(), **(env or {})})
        self.window = self.find_window()

    def __enter__(self):
        return self

    def __exit__(self, kind, value, trace):
        if self.process.poll() is None:
            self.process.kill()
        self.process.communicate()

    def find_window(self):
        end = time.monotonic() + TIMEOUT
        while time.monotonic() < end:
            # The title is complete once the first frame was shown.
            found = self.display.xdotool('search', '--name', ' - vkao-view$').split()
            if found:
                self.display.xdotool('windowmove', found[-1], 0, 0)
                self.display.xdotool('windowfocus', found[-1])
                self.move(5, 5)  # over the window, so that every case probes
                return found[-1]
            if self.process.poll() is not None:
                raise self.ended()
            time.sleep(0.05)
        raise Failed('no window appeared')

    def ended(self):
        _, err = self.process.communicate()
        return Failed(f'{" ".join(self.command)}: exit {self.process.returncode}\n{err}')

    def title(self):
        return self.display.xdotool('getwindowname', self.window)

    def wait_title(self, pattern):
        """Until the window says that what was asked for is shown."""
        end = time.monotonic() + TIMEOUT
        while time.monotonic() < end:
            if re.search(pattern, self.title()):
                return
            if self.process.poll() is not None:
                raise self.ended()
            time.sleep(0.05)
        raise Failed(f'the title is {self.title()!r}, want /{pattern}/')

    def key(self, *keys):
        for key in keys:
            self.display.xdotool('key', key)
            time.sleep(0.05)

    def move(self, x, y):
        self.display.xdotool('mousemove', x, y)
        time.sleep(0.1)

    def click(self, x, y, button=1):
        self.move(x, y)
        self.display.xdotool('click', button)
        time.sleep(0.1)

    @contextlib.contextmanager
    def stopped(self):
        """The program, while others go on."""
        self.process.send_signal(signal.SIGSTOP)
        try:
            yield
        finally:
            self.process.send_signal(signal.SIGCONT)

    def drag(self, start, end, button=1, hold=0.1, until=None):
        """The panel sees the mouse once a frame only: hold it, or wait for what it brings about."""
        self.move(*start)
        self.display.xdotool('mousedown', button)
        time.sleep(hold)
        self.move((start[0] + end[0]) // 2, (start[1] + end[1]) // 2)
        self.move(*end)
        time.sleep(hold)
        if until:
            self.wait_title(until)
        self.display.xdotool('mouseup', button)
        time.sleep(0.1)

    def resize(self, width, height):
        self.display.xdotool('windowsize', '--sync', self.window, width, height)
        time.sleep(0.3)

    def finish(self, *before):
        """Quits; the picture that was shown last. What xdotool is to do before happens in the same
        moment, as the viewer sees it."""
        with self.stopped():
            self.display.xdotool(*before, 'key', 'q')
        try:
            self.out, self.err = self.process.communicate(timeout=TIMEOUT)
        except subprocess.TimeoutExpired:
            raise Failed('the viewer does not quit')
        equal(self.process.returncode, 0, f'exit code of {" ".join(self.command)}\n{self.err}')
        return read_png(self.scratch.path('last.png'))


def shoot(scratch, *arguments, frames=3, code=0, env=None, display=True):
    """A run without a person. The picture, or the messages if it is to fail."""
    arguments = [str(a) for a in arguments]
    environment = {**os.environ, **sanitizer_options(), **(env or {})}
    if display:
        environment.update(Display.get().environment())
    done = subprocess.run(
        [VIEWER, '--validation', '--device', 'cpu', '--no-panel', '--screenshot', 'shot.png',
         '--frames', str(frames), *arguments],
        cwd=scratch.directory, capture_output=True, text=True, stdin=subprocess.DEVNULL,
        timeout=TIMEOUT, env=environment)
    equal(done.returncode, code, f'exit code of {" ".join(arguments)}\n{done.stderr}')
    return read_png(scratch.path('shot.png')) if code == 0 else done.stderr


def read_png(path):
    """Bytes: height x width x 3."""
    image = oiio.ImageInput.open(path)
    check(image, f'{path}: {oiio.geterror()}')
    pixels = np.asarray(image.read_image('uint8'))
    image.close()
    if pixels.ndim == 2:
        pixels = pixels[..., None]
    return np.repeat(pixels, 3, axis=-1) if pixels.shape[-1] == 1 else pixels[..., :3]


def preview(scratch, name, *options, mode='ao'):
    """What vkao draws."""
    scratch.render(name, '-o', 'vkao.exr', '--overwrite', 'always', '--preview', 'vkao.png',
                   '--mode', mode, '--device', 'cpu', '--pixel-type', 'float', *options)
    return read_png(scratch.path('vkao.png'))


def same_picture(a, b, what, most=1):
    equal(a.shape, b.shape, f'{what}: size')
    difference = np.abs(a.astype(int) - b.astype(int))
    check(difference.max() <= most,
          f'{what}: differs by up to {difference.max()}, in {(difference > most).sum()} values')


def more_channels(scene):
    """What options name beside depth, normals and colour: light, mattes, what lies behind."""
    def plane(value):
        return np.broadcast_to(np.float32(value), scene.z.shape) * np.float32(1)

    def layer(name, value):
        return {f'{name}.{c}': plane(value * k) for c, k in zip('RGB', (1, 0.5, 0.25))}

    ball = (scene.z < 5) & (np.abs(scene.normal[..., 1]) < 0.99)
    behind = np.where(ball, scene.depth() + 2, 1e10).astype(np.float32)
    return {**layer('gi', 0.15), **layer('albedo', 0.8), **layer('spec', 0.1), 'rough': plane(0.2),
            'matte': ball.astype(np.float32), 'thick': plane(0.3),
            'back': scene.depth() + plane(0.4), 'behind': behind}


# --- What most cases begin and end with ---

def gbuffer(color=True, more=False):
    channels = {'Z': SCENE.depth(), **SCENE.normals(), **(more_channels(SCENE) if more else {})}
    return {**channels, **SCENE.color()} if color else channels


def opened(scratch, *arguments, more=False, **settings):
    write_exr(scratch.path('in.exr'), gbuffer(more=more))
    viewer = Viewer(scratch, 'in.exr', *READ, *arguments, **settings)
    viewer.wait_title('^in.exr - ')
    return viewer


def screen(scratch, viewer, size):
    """What is on the screen, without a key that ends it."""
    done = subprocess.run(
        ['import', '-silent', '-window', 'root', '-crop', f'{size[0]}x{size[1]}+0+0', '+repage',
         '-depth', '8', 'png24:screen.png'],
        cwd=scratch.directory, capture_output=True, text=True,
        env={**os.environ, 'DISPLAY': viewer.display.name})
    if done.returncode:
        skip(f'ImageMagick cannot take pictures: {done.stderr}')
    return read_png(scratch.path('screen.png'))


def yellow(picture):
    """Texels in the colour of warnings."""
    return int(((picture[..., 0] > 200) & (picture[..., 2] < 120)).sum())


def until(holds, what):
    end = time.monotonic() + TIMEOUT
    while not holds():
        check(time.monotonic() < end, f'no {what}')
        time.sleep(0.2)


def script(scratch, name):
    """The command that Save wrote."""
    lines = scratch.bytes(name).decode().splitlines()
    equal(lines[0], '#!/bin/sh', 'first line')
    command = [line for line in lines if not line.startswith('#')]
    equal(len(command), 1, 'commands')
    words = shlex.split(command[0])
    equal(words[0], 'vkao', 'the command')
    return words[1:]
