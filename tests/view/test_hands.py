#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""vkao-view under keys and mouse, in windows that change their size."""
import os
import re
import shlex
import shutil
import subprocess
import time

import view  # first: it knows where cli.py lies
from cli import (case, cases, check, check_close, equal, np, read_ao, read_parts, skip,
                 write_exr)
from drop import clipboard, drop_files
from scene import FOV, HEIGHT, RADIUS, WIDTH, Scene
from view import LINE, PANEL_WIDTH, Viewer, more_channels, preview, read_png, same_picture

SCENE = Scene()
READ = ('--fov', FOV, '--radius', RADIUS)
WHOLE = ('--no-panel',)
VBAO, HBAO = r'- A vbao -', r'- B hbao -'


def gbuffer(color=True, more=False):
    channels = {'Z': SCENE.depth(), **SCENE.normals(), **(more_channels(SCENE) if more else {})}
    return {**channels, **SCENE.color()} if color else channels


def opened(scratch, *arguments, more=False, **settings):
    write_exr(scratch.path('in.exr'), gbuffer(more=more))
    viewer = Viewer(scratch, 'in.exr', *READ, *arguments, **settings)
    viewer.wait_title('^in.exr - ')
    return viewer


def line_column(picture):
    columns = np.nonzero((picture == LINE).all(axis=(0, 2)))[0]
    equal(len(columns), 1, 'columns with the colour of the line')
    return int(columns[0])


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


def until(holds, what):
    end = time.monotonic() + view.TIMEOUT
    while not holds():
        check(time.monotonic() < end, f'no {what}')
        time.sleep(0.2)


# --- Keys ---

@case
def number_keys_choose_the_view(scratch):
    titles = ['AO before the blur', 'AO', 'Composite', 'Depth', 'Normals', 'Bent normals',
              'Difference']
    with opened(scratch, *WHOLE) as viewer:
        for number, title in enumerate(titles, 1):
            viewer.key(number)
            viewer.wait_title(f'^in.exr - {title} - ')
        viewer.key(3)
        viewer.wait_title('- Composite -')
        shown = viewer.finish()
    same_picture(shown, preview(scratch, 'in.exr', *READ, mode='comp'), 'composite')


@case
def tab_goes_from_a_to_b(scratch):
    with opened(scratch, *WHOLE, '--versus', '--method hbao') as viewer:
        viewer.wait_title(VBAO)
        viewer.key('Tab')
        viewer.wait_title(HBAO)
        shown = viewer.finish()
    same_picture(shown, preview(scratch, 'in.exr', *READ, '--method', 'hbao'), 'B')


@case
def arrow_keys_go_through_a_sequence(scratch):
    for number in (1, 2, 3):
        channels = gbuffer(False)
        channels['Z'] = channels['Z'] * np.float32(number)
        write_exr(scratch.path(f'in.{number:04}.exr'), channels)
    with Viewer(scratch, 'in.####.exr', *READ, *WHOLE) as viewer:
        viewer.wait_title(r'^in.0001.exr \[1/3\]')
        viewer.key('Left')
        viewer.key('Right')
        viewer.wait_title(r'^in.0002.exr \[2/3\]')
        viewer.key('Right', 'Right')
        viewer.wait_title(r'^in.0003.exr \[3/3\]')
        viewer.key('Left')
        viewer.wait_title(r'^in.0002.exr \[2/3\]')
        shown = viewer.finish()
    same_picture(shown, preview(scratch, 'in.0002.exr', *READ), 'second frame')


@case
def frame_that_cannot_be_read_leaves_the_last_one(scratch):
    write_exr(scratch.path('in.0001.exr'), gbuffer(False))
    scratch.write('in.0002.exr', 'damaged')
    with Viewer(scratch, 'in.####.exr', *READ, *WHOLE) as viewer:
        viewer.wait_title(r'^in.0001.exr \[1/2\]')
        viewer.key('Right')
        time.sleep(0.5)
        viewer.wait_title(r'^in.0001.exr \[1/2\]')
        shown = viewer.finish()
        check('in.0002.exr' in viewer.err, f'nothing is said:\n{viewer.err}')
    same_picture(shown, preview(scratch, 'in.0001.exr', *READ), 'first frame')


@case
def escape_ends_it(scratch):
    with opened(scratch) as viewer:
        viewer.key('Escape')
        viewer.process.communicate(timeout=view.TIMEOUT)
        equal(viewer.process.returncode, 0, 'exit code')


# --- Wipe ---

@case
def wipe_line_is_where_the_mouse_put_it(scratch):
    with opened(scratch, *WHOLE, '--versus', '--method hbao') as viewer:
        viewer.key('w')
        viewer.wait_title(r'A vbao \| B hbao')
        viewer.drag((WIDTH // 2, 40), (37, 50))
        shown = viewer.finish()
    equal(line_column(shown), 37, 'the line')
    a = preview(scratch, 'in.exr', *READ)
    b = preview(scratch, 'in.exr', *READ, '--method', 'hbao')
    same_picture(shown[:, :37], a[:, :37], 'A')
    same_picture(shown[:, 38:], b[:, 38:], 'B')


@case
def wipe_line_stays_in_the_window(scratch):
    with opened(scratch, *WHOLE, '--wipe', 0.5) as viewer:
        viewer.drag((WIDTH // 2, 40), (WIDTH + 300, 40))
        shown = viewer.finish()
    equal(line_column(shown), WIDTH - 1, 'the line')


@case
def second_w_takes_the_line_away(scratch):
    with opened(scratch, *WHOLE) as viewer:
        viewer.key('w')
        viewer.wait_title(r'A vbao \| B vbao')
        viewer.key('w')
        viewer.wait_title(VBAO)
        shown = viewer.finish()
    same_picture(shown, preview(scratch, 'in.exr', *READ), 'AO')


# --- Zoom and pan ---

@case
def wheel_zooms_at_the_mouse(scratch):
    with opened(scratch, *WHOLE) as viewer:
        viewer.click(60, 40, button=4)
        viewer.wait_title('- 200 % -')
        viewer.click(60, 40, button=4)
        viewer.wait_title('- 300 % -')
        viewer.click(60, 40, button=5)
        viewer.wait_title('- 200 % -')
        shown = viewer.finish()
    wanted = preview(scratch, 'in.exr', *READ).repeat(2, axis=0).repeat(2, axis=1)
    # Texel 60, 40 stays under the mouse; its squares begin there or a texel of the screen before.
    places = [wanted[40 + y:40 + y + HEIGHT, 60 + x:60 + x + WIDTH] for y in (0, 1) for x in (0, 1)]
    least = min(np.abs(p.astype(int) - shown).max() for p in places)
    check(least <= 1, f'the picture is not at the mouse: off by {least}')


@case
def drag_moves_the_picture(scratch):
    with opened(scratch, *WHOLE) as viewer:
        viewer.drag((80, 45), (93, 66))
        shown = viewer.finish()
    ao = preview(scratch, 'in.exr', *READ)
    same_picture(shown[21:, 13:], ao[:-21, :-13], 'moved')
    check((shown[:21] == view.BACKGROUND).all(), 'there is something above the picture')


@case
def keys_zoom_and_fit(scratch):
    with opened(scratch, *WHOLE, size=(WIDTH * 2, HEIGHT * 2)) as viewer:
        viewer.wait_title('- 200 % -')
        viewer.key('plus')
        viewer.wait_title('- 300 % -')
        viewer.key('minus', 'minus', 'minus')
        viewer.wait_title('- 50 % -')
        viewer.key('z')
        viewer.wait_title('- 100 % -')
        viewer.key('0')
        viewer.wait_title('- 200 % -')
        viewer.key('z')
        viewer.wait_title('- 100 % -')
        viewer.key('f')
        viewer.wait_title('- 200 % -')
        shown = viewer.finish()
    wanted = preview(scratch, 'in.exr', *READ).repeat(2, axis=0).repeat(2, axis=1)
    same_picture(shown, wanted, 'fitted')


# --- Window ---

@case
def picture_follows_the_size_of_the_window(scratch):
    with opened(scratch, *WHOLE) as viewer:
        for width, height in ((500, 300), (90, 60), (WIDTH * 3, HEIGHT * 3)):
            viewer.resize(width, height)
        viewer.wait_title('- 300 % -')
        shown = viewer.finish()
    wanted = preview(scratch, 'in.exr', *READ).repeat(3, axis=0).repeat(3, axis=1)
    same_picture(shown, wanted, 'after resizing')


@case
def window_survives_being_tiny_and_hidden(scratch):
    with opened(scratch) as viewer:
        viewer.resize(1, 1)
        viewer.display.xdotool('windowunmap', viewer.window)
        time.sleep(0.3)
        viewer.display.xdotool('windowmap', viewer.window)
        viewer.display.xdotool('windowfocus', viewer.window)
        viewer.resize(WIDTH + PANEL_WIDTH, HEIGHT * 2)
        viewer.key('z', 'p')
        viewer.wait_title('- 100 % -')
        shown = viewer.finish()
    equal(shown.shape, (HEIGHT * 2, WIDTH + PANEL_WIDTH, 3), 'picture')


@case
def p_hides_the_panel(scratch):
    with opened(scratch, size=(WIDTH + PANEL_WIDTH, 600)) as viewer:
        viewer.key('p')
        time.sleep(0.3)
        viewer.resize(WIDTH, HEIGHT)
        viewer.wait_title('- 100 % -')
        shown = viewer.finish()
    same_picture(shown, preview(scratch, 'in.exr', *READ), 'AO')


@case
def window_on_the_screen_has_the_picture(scratch):
    """What the screen shows, taken by another program, is what the viewer says it shows."""
    if not shutil.which('import'):
        skip('ImageMagick is not installed')
    with opened(scratch, *WHOLE) as viewer:
        time.sleep(0.5)
        seen = screen(scratch, viewer, (WIDTH, HEIGHT))
        shown = viewer.finish()
    same_picture(seen, shown, 'the screen', 0)


# --- Panel ---

@case
def buttons_of_the_panel_change_the_setting(scratch):
    with opened(scratch, size=(WIDTH + PANEL_WIDTH, 700)) as viewer:
        viewer.click(26, 129)  # 'fast'
        viewer.wait_title('A vbao half')
        viewer.click(84, 56)  # '2 AO'
        viewer.click(84 - 66, 56)  # '1 raw'
        viewer.wait_title('- AO before the blur -')
        viewer.click(80, 129)  # 'default'
        viewer.wait_title('A vbao -')
        viewer.finish()


@case
def slider_changes_the_picture(scratch):
    with opened(scratch, '--save', 'saved', size=(WIDTH + PANEL_WIDTH, 700)) as viewer:
        viewer.drag((85, 198), (110, 198), hold=1)  # radius
        viewer.key('s')
        shown = viewer.finish()
    command = script(scratch, 'saved.sh')
    radius = float(command[command.index('--radius') + 1])
    check(radius > RADIUS * 1.5, f'the radius is {radius}')
    wanted = preview(scratch, 'in.exr', '--fov', FOV, '--radius', radius)
    top = (700 - HEIGHT) // 2
    same_picture(shown[top:top + HEIGHT, PANEL_WIDTH:], wanted, 'AO')


@case
def tab_after_a_drag_in_the_panel_opens_no_text_field(scratch):
    with opened(scratch, '--versus', '--method hbao', size=(WIDTH + PANEL_WIDTH, 700)) as viewer:
        viewer.drag((85, 198), (110, 198), hold=1)  # radius
        viewer.key('Tab')
        viewer.wait_title(HBAO)
        time.sleep(1.5)
        viewer.key('Tab')
        viewer.wait_title(VBAO)
        viewer.key('3')
        viewer.wait_title('- Composite -')
        viewer.finish()


@case
def escape_closes_a_list_before_the_window(scratch):
    with opened(scratch, size=(WIDTH + PANEL_WIDTH, 700)) as viewer:
        def below_method():
            return screen(scratch, viewer, (WIDTH, 300))[190:290, 10:90].astype(int)
        before = below_method()
        viewer.click(80, 175)  # method
        until(lambda: (below_method() != before).any(axis=-1).mean() > 0.3, 'list')
        viewer.key('Escape')
        until(lambda: (below_method() == before).all(), 'end of the list')
        viewer.click(26, 129)  # 'fast', which an open list would cover or close instead
        viewer.wait_title('A vbao half')
        viewer.key('F1', 'Escape')
        viewer.key('2')
        time.sleep(0.5)
        equal(viewer.process.poll(), None, 'the window is there')
        viewer.finish()


@case
def what_was_changed_is_undone_and_redone(scratch):
    with opened(scratch, *WHOLE, size=(WIDTH + PANEL_WIDTH, 700)) as viewer:
        viewer.key('ctrl+z', 'p')  # nothing to undo yet
        time.sleep(0.5)
        viewer.click(26, 129)  # 'fast'
        viewer.wait_title('A vbao half')
        viewer.key('ctrl+z')
        viewer.wait_title('A vbao -')
        viewer.key('ctrl+y')
        viewer.wait_title('A vbao half')
        viewer.key('ctrl+z')
        viewer.wait_title('A vbao -')
        viewer.key('ctrl+shift+z')
        viewer.wait_title('A vbao half')
        viewer.finish()


def yellow(picture):
    """Texels in the colour of warnings."""
    return int(((picture[..., 0] > 200) & (picture[..., 2] < 120)).sum())


@case
def warnings_show_in_the_panel(scratch):
    size = (WIDTH + PANEL_WIDTH, 700)
    with opened(scratch, size=size) as viewer:
        equal(yellow(viewer.finish()), 0, 'texels of warnings of a file without')
    depth = SCENE.depth()
    write_exr(scratch.path('in.exr'), {'Z': np.minimum(depth, 60000).astype(np.float16)})
    with Viewer(scratch, 'in.exr', *READ, '--quiet', size=size) as viewer:
        viewer.wait_title('^in.exr')
        shown = viewer.finish()
        equal(viewer.err, '', 'stderr')
    check(yellow(shown[:, :PANEL_WIDTH]) > 100, 'no warning that depth is HALF')


@case
def radius_of_the_reference_is_shown_and_taken(scratch):
    ao = {'AO': SCENE.depth() * 0 + 0.5}
    write_exr(scratch.path('in.gt.exr'), ao, attributes=[('aoRadius', 'float', 0.8)])
    with opened(scratch, '--show', 'difference', size=(WIDTH + PANEL_WIDTH, 700)) as viewer:
        viewer.wait_title('- Difference -')
        time.sleep(1)
        viewer.click(60, 165)  # 'take 0.8 for A'
        time.sleep(1)
        viewer.key('s')
        shown = viewer.finish()
    equal(yellow(shown[:, :PANEL_WIDTH]), 0, 'texels of a warning after that')
    command = script(scratch, 'in.view.sh')
    equal(float(command[command.index('--radius') + 1]), 0.8, 'the radius')


@case
def exposure_and_range_follow_the_panel(scratch):
    with opened(scratch, '--show', 'composite', '--save', 'saved',
                size=(WIDTH + PANEL_WIDTH, 700)) as viewer:
        def light():
            return screen(scratch, viewer, (WIDTH + PANEL_WIDTH, 700))[350, PANEL_WIDTH:].mean()
        before = light()
        viewer.drag((90, 102), (60, 102), hold=1)  # exposure
        until(lambda: light() < before * 0.7, 'darker picture')
        viewer.key('s')
        until(lambda: 'saved.sh' in scratch.files(), 'saved picture')
        viewer.key('4')
        viewer.wait_title('- Depth -')
        viewer.drag((30, 102), (60, 102), hold=1)  # near
        viewer.key('s')
        shown = viewer.finish()[:, PANEL_WIDTH:]
    lines = scratch.bytes('saved.sh').decode().splitlines()
    stops = float(re.search('exposed by (-[0-9.]+) stops', lines[1]).group(1))
    planes = {k: c * 2 ** stops if k in 'RGB' else c for k, c in SCENE.color().items()}
    write_exr(scratch.path('in.exr'), {**gbuffer(False), **planes})
    wanted = preview(scratch, 'in.exr', *READ, mode='comp')
    same_picture(read_png(scratch.path('saved.png')), wanted, 'exposed')
    depth = read_png(scratch.path('saved.2.png'))
    top = (700 - HEIGHT) // 2
    same_picture(depth, shown[top:top + HEIGHT], 'depth')
    whole = (depth[~SCENE.sky] == 0).mean()
    check(0.05 < whole < 0.9, f'{whole} of the foreground is nearer than the range')


@case
def histogram_counts_what_is_shown(scratch):
    size = (WIDTH + PANEL_WIDTH, 700)
    with opened(scratch, '--show', 'composite', size=size) as viewer:
        viewer.drag((18, 613), (18, 613), hold=0.5)  # 'Histogram'

        def curve(is_red):
            below = screen(scratch, viewer, size)[530:620, :PANEL_WIDTH].astype(int)
            red = (below[..., 0] - below[..., 1] > 60).sum()
            grey = ((np.ptp(below, axis=-1) < 4) & (np.abs(below[..., 0] - 157) < 4)).sum()
            return red > 100 if is_red else red == 0 and grey > 50
        until(lambda: curve(True), 'curve of red')
        viewer.key('2')
        until(lambda: curve(False), 'curve of grey')
        viewer.finish()


# --- The list of files, and the clipboard ---

@case
def file_is_opened_from_the_list(scratch):
    os.mkdir(scratch.path('more'))
    write_exr(scratch.path('more', 'q1.exr'), gbuffer(False))
    scratch.write('more/q2.exr', 'rubbish')
    with opened(scratch, *WHOLE, size=(500, 300)) as viewer:
        viewer.key('ctrl+o')
        viewer.key('q', 'Tab', '3', 'Escape', 'ctrl+o')  # the list's, all of them
        viewer.wait_title('^in.exr - AO - ')
        viewer.key('m', 'o', 'Return', 'q', '2', 'Return')
        time.sleep(1)
        viewer.wait_title('^in.exr - AO - ')
        viewer.key('BackSpace', '1', 'Return')
        viewer.wait_title('^q1.exr - AO - ')
        viewer.key('ctrl+o', 'BackSpace', 'Home', 'Down', 'Down', 'Return')
        viewer.wait_title('^in.exr - AO - ')
        viewer.key('ctrl+o', 'ctrl+o', '3')
        viewer.wait_title('^in.exr - Composite - ')
        viewer.finish()
        check('more/q2.exr' in viewer.err, f'nothing is said:\n{viewer.err}')


@case
def probe_is_copied(scratch):
    with opened(scratch, *WHOLE, '--versus', '--intensity 0', '--wipe', 0.9) as viewer:
        viewer.move(80, 70)
        time.sleep(0.5)
        viewer.key('ctrl+c')
        time.sleep(0.5)
        text = clipboard(viewer)
        viewer.finish()
    number = r'(-?[0-9.e-]+)'
    found = re.fullmatch(f'texel 80 70 AO {number} B 1 position {number} {number} {number} '
                         f'normal {number} {number} {number}', text)
    check(found, f'the clipboard has {text!r}')
    values = [float(v) for v in found.groups()]
    preview(scratch, 'in.exr', *READ)
    z = SCENE.z[70, 80]
    wanted = [read_ao(scratch.path('vkao.exr'))[70, 80], SCENE.x[70, 80] * z, SCENE.y[70, 80] * z,
              -z, *SCENE.normal[70, 80]]
    check(np.abs(np.array(values) - wanted).max() < 1e-4, f'{values}, want {wanted}')


# --- Save ---

def script(scratch, name):
    """The command that Save wrote."""
    lines = scratch.bytes(name).decode().splitlines()
    equal(lines[0], '#!/bin/sh', 'first line')
    command = [line for line in lines if not line.startswith('#')]
    equal(len(command), 1, 'commands')
    words = shlex.split(command[0])
    equal(words[0], 'vkao', 'the command')
    return words[1:]


SAVES = {
    'default': ('2', ()),
    'raw': ('1', ('--intensity', '2')),
    'composite': ('3', ('--tint', '0.1,0.2,0.3', '--strength', '0.7')),
    'gtao': ('2', ('--method', 'gtao', '--slices', '3', '--steps', '7', '--blur', '7',
                   '--falloff', 'threshold', '--noise-index', '3')),
    'half': ('2', ('--quality', 'fast', '--thickness', '0.3', '--bias', '0.01', '--power', '1.3')),
    'sphere': ('2', ('--method', 'sphere', '--sphere-form', 'literal', '--blocking-scale', '7',
                     '--samples', '9')),
    'sharp': ('2', ('--method', 'hemisphere', '--blur-sharpness', '33', '--blur-normal-power',
                    '0', '--samples', '33')),
    'no normals': ('2', ('--normal', 'none', '--depth', 'Z')),
    'bent': ('6', ()),
    'light': ('3', ('--indirect', 'gi', '--specular', 'spec', '--holdout', 'matte', '--back-depth',
                    'back')),
    'light unseen': ('2', ('--indirect', 'gi', '--albedo', 'albedo', '--holdout', 'matte',
                           '--layer2', 'behind')),
}


# The tool compiles its pipelines for the settings at hand, the viewer for all: the same operations,
# but other instructions, so that the last bit differs, and once in a while a sample at the edge of
# a texel or sector.
LARGEST, MEAN = 5e-3, 1e-6


@cases(SAVES.items())
def saved_command_makes_the_saved_files(scratch, _, row):
    key, options = row
    with opened(scratch, *WHOLE, *options, more='--holdout' in options) as viewer:
        viewer.key(key, 's')
        shown = viewer.finish()
    equal(scratch.files(), ['in.exr', 'in.view.exr', 'in.view.png', 'in.view.sh', 'last.png'],
          'files')
    command = script(scratch, 'in.view.sh')
    check(shlex.split(viewer.out)[1:] == command, f'not printed: {viewer.out}')
    saved = read_parts(scratch.path('in.view.exr'))[0]
    same_picture(read_png(scratch.path('in.view.png')), shown, 'PNG')
    scratch.render(*command, '--device', 'cpu')
    made = read_parts(scratch.path('in.view.exr'))[0]
    equal(sorted(saved.channels), sorted(made.channels), 'channels')
    for name, channel in saved.channels.items():
        check_close(channel, made[name], LARGEST, MEAN, name)
    equal(saved.attributes['vkao/params'], made.attributes['vkao/params'], 'vkao/params')
    if key in '123':
        same_picture(read_png(scratch.path('in.view.png')), shown, 'PNG of vkao')


@cases(['2', '3', '6'])
def save_of_a_cropped_window_is_what_vkao_makes(scratch, key):
    part = {k: np.ascontiguousarray(c[21:, 17:]) for k, c in gbuffer().items()}
    write_exr(scratch.path('in.exr'), part, x=17, y=21, display=(0, 0, WIDTH - 1, HEIGHT - 1))
    with Viewer(scratch, 'in.exr', *READ, *WHOLE) as viewer:
        viewer.key(key, 's')
        shown = viewer.finish()
    same_picture(read_png(scratch.path('in.view.png')), shown, 'PNG')
    saved = read_parts(scratch.path('in.view.exr'))[0]
    scratch.render(*script(scratch, 'in.view.sh'), '--device', 'cpu')
    made = read_parts(scratch.path('in.view.exr'))[0]
    equal(saved.data_window, made.data_window, 'data window')
    for name, channel in made.channels.items():
        check_close(saved[name], channel, LARGEST, MEAN, name)


@case
def saving_again_overwrites_nothing(scratch):
    with opened(scratch, *WHOLE, '--save', 'a b') as viewer:
        viewer.key('s')
        viewer.key('4')
        viewer.wait_title('- Depth -')
        viewer.key('s')
        shown = viewer.finish()
    check({'a b.sh', 'a b.exr', 'a b.png', 'a b.2.sh', 'a b.2.exr', 'a b.2.png'} <=
          set(scratch.files()), f'{scratch.files()}')
    same_picture(read_png(scratch.path('a b.2.png')), shown, 'depth')
    check('vkao writes no picture' in scratch.bytes('a b.2.sh').decode(), 'it is not said')
    scratch.render(*script(scratch, 'a b.2.sh'), '--device', 'cpu')


@case
def save_that_fails_is_said_and_leaves_nothing(scratch):
    with opened(scratch, *WHOLE, '--save', 'nowhere/x') as viewer:
        viewer.key('s')
        viewer.finish()
        check('vkao: nowhere/x.' in viewer.err, f'nothing is said:\n{viewer.err}')
    equal(scratch.files(), ['in.exr', 'last.png'], 'files')


# --- Dropped files ---

@case
def dropped_file_is_opened(scratch):
    write_exr(scratch.path('other one.exr'), gbuffer(False))
    with opened(scratch, *WHOLE) as viewer:
        drop_files(viewer, scratch.path('other one.exr'))
        viewer.wait_title('^other one.exr - ')
        viewer.finish()


@case
def window_without_a_file_waits_for_one(scratch):
    write_exr(scratch.path('in.exr'), gbuffer())
    with Viewer(scratch, *READ, *WHOLE, size=(WIDTH, HEIGHT)) as viewer:
        viewer.wait_title('^no file - ')
        drop_files(viewer, scratch.path('in.exr'))
        viewer.wait_title('^in.exr - .* 100 %')
        shown = viewer.finish()
    same_picture(shown, preview(scratch, 'in.exr', *READ), 'AO')


@case
def dropped_files_become_a_sequence(scratch):
    for name in ('a.exr', 'b.exr'):
        write_exr(scratch.path(name), gbuffer(False))
    with opened(scratch, *WHOLE) as viewer:
        drop_files(viewer, scratch.path('a.exr'), scratch.path('b.exr'))
        viewer.wait_title(r'^a.exr \[1/2\]')
        viewer.key('Right')
        viewer.wait_title(r'^b.exr \[2/2\]')
        viewer.finish()


@case
def dropped_reference_is_compared_to(scratch):
    with opened(scratch, *WHOLE, '--show', 'difference') as viewer:
        preview(scratch, 'in.exr', *READ)
        ao = read_ao(scratch.path('vkao.exr'))
        write_exr(scratch.path('truth.exr'), {'AO': (ao - 0.1).astype(np.float32)})
        drop_files(viewer, scratch.path('truth.exr'))
        time.sleep(1)
        viewer.wait_title('^in.exr - Difference')
        shown = viewer.finish()
    wanted = np.floor(np.array([0.15, 0.6, 1]) * 0.4 * 255 + 0.5)
    check(np.abs(shown - wanted).max() <= 1, f'{shown[0, 0]}, want {wanted}')


@case
def dropped_rubbish_is_refused(scratch):
    scratch.write('rubbish.exr', 'rubbish')
    for number in (1, 2):
        write_exr(scratch.path(f'in.{number}.exr'), gbuffer())
    with Viewer(scratch, 'in.%d.exr', *READ, *WHOLE) as viewer:
        drop_files(viewer, scratch.path('rubbish.exr'))
        time.sleep(0.5)
        viewer.wait_title(r'^in.1.exr \[1/2\] - ')
        viewer.key('Right')
        viewer.wait_title(r'^in.2.exr \[2/2\] - ')
        shown = viewer.finish()
        check('rubbish.exr' in viewer.err, f'nothing is said:\n{viewer.err}')
    same_picture(shown, preview(scratch, 'in.2.exr', *READ), 'AO')


@case
def dropped_rubbish_is_told_in_a_window_without_the_panel(scratch):
    scratch.write('rubbish.exr', 'rubbish')
    size = (500, 300)
    with opened(scratch, *WHOLE, size=size) as viewer:
        before = screen(scratch, viewer, size)

        def changed():
            return (screen(scratch, viewer, size) != before).any(axis=-1)
        drop_files(viewer, scratch.path('rubbish.exr'))
        until(lambda: changed()[-50:].sum() > 1000, 'word of it')
        check(not changed()[:-50].any(), 'the picture above it is another')
        viewer.key('2')
        until(lambda: not changed().any(), 'picture as before after a key')
        viewer.finish()


@case
def dropped_camera_is_taken(scratch):
    write_exr(scratch.path('in.exr'), gbuffer())
    scratch.write('wide.json', '{"fov_x_deg": 90}')
    with Viewer(scratch, 'in.exr', '--radius', RADIUS, *WHOLE) as viewer:
        drop_files(viewer, scratch.path('wide.json'))
        time.sleep(0.5)
        viewer.wait_title('^in.exr - ')
        shown = viewer.finish()
    wanted = preview(scratch, 'in.exr', '--radius', RADIUS, '--fov', 90)
    same_picture(shown, wanted, 'AO')


if __name__ == '__main__':
    view.main()
