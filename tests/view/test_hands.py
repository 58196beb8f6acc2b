#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""vkao-view under keys and mouse, in windows that change their size."""
import re
import shutil
import signal
import time

import view  # first: it knows where cli.py lies
from cli import case, check, equal, np, read_ao, skip, write_exr
from drop import clipboard
from scene import FOV, HEIGHT, RADIUS, WIDTH
from view import (LINE, PANEL_WIDTH, READ, SCENE, WHOLE, Viewer, gbuffer, opened, preview,
                  read_png, same_picture, screen, script, until, yellow)

VBAO, HBAO = r'- A vbao -', r'- B hbao -'


def line_column(picture):
    columns = np.nonzero((picture == LINE).all(axis=(0, 2)))[0]
    equal(len(columns), 1, 'columns with the colour of the line')
    return int(columns[0])


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
def click_between_two_frames_is_where_it_was_made(scratch):
    """As on a slow machine: what happens while a frame is computed comes all at once."""
    with opened(scratch, size=(WIDTH + PANEL_WIDTH, 700)) as viewer:
        viewer.move(84, 56)  # '2 AO'
        viewer.display.xdotool('mousedown', 1)
        time.sleep(1)
        with viewer.stopped():
            viewer.display.xdotool('mouseup', 1, 'mousemove', 18, 56, 'click', 1)  # '1 raw'
        viewer.wait_title('- AO before the blur -')
        viewer.move(26, 129)  # 'fast'
        with viewer.stopped():
            viewer.display.xdotool('click', 1, 'mousemove', 80, 129)  # 'default'
        viewer.wait_title('A vbao half')
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

        def changed(before):
            return (below_method() != before).any(axis=-1).mean()

        # The first pictures of a slow machine may still lack what is computed.
        before = below_method()
        time.sleep(0.5)
        while changed(before):
            before = below_method()
            time.sleep(0.5)
        viewer.click(80, 175)  # method
        until(lambda: changed(before) > 0.3, 'list')
        viewer.key('Escape')
        until(lambda: changed(before) < 0.05, 'end of the list')
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


@case
def ao_alone_is_shown_without_its_specular_light(scratch):
    """What the library has to say of light that it is given and leaves out would be on stderr."""
    size = (WIDTH + PANEL_WIDTH, 1000)
    with opened(scratch, '--specular', 'spec', '--show', 'composite', '--quiet', more=True,
                size=size) as viewer:
        def colours():
            shown = screen(scratch, viewer, size)[:, PANEL_WIDTH:].astype(int)
            return (np.ptp(shown, axis=-1) > 30).mean()

        def below_mode():
            return screen(scratch, viewer, size)[650:700, 10:170]

        until(lambda: colours() > 0.05, 'colour')
        before = below_mode()
        viewer.click(80, 635)  # composite mode
        until(lambda: (below_mode() != before).any(axis=-1).mean() > 0.3, 'list')
        viewer.click(40, 693)  # 'ao-only'
        until(lambda: colours() < 0.01, 'AO alone')
        viewer.finish()
        equal(viewer.err, '', 'stderr')


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
def wheel_is_of_what_it_turns_over_though_nothing_was_drawn_since(scratch):
    with opened(scratch, size=(WIDTH + PANEL_WIDTH, 700)) as viewer:
        def wheel(x):
            """The viewer sees the mouse go there and the wheel turn in one moment."""
            viewer.process.send_signal(signal.SIGSTOP)
            viewer.display.xdotool('mousemove', x, 350, 'click', 4)
            viewer.process.send_signal(signal.SIGCONT)
        for _ in range(2):
            viewer.move(PANEL_WIDTH + 80, 350)
            time.sleep(1)
            wheel(80)
            time.sleep(1)
            viewer.wait_title('- 100 % -')
        wheel(PANEL_WIDTH + 80)
        viewer.wait_title('- 200 % -')
        viewer.finish()


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


@case
def probe_is_copied(scratch):
    with opened(scratch, *WHOLE, '--versus', '--intensity 0', '--wipe', 0.9) as viewer:
        viewer.move(80, 70)

        def copied():
            viewer.key('ctrl+c')
            time.sleep(0.5)
            return clipboard(viewer)
        until(lambda: copied().startswith('texel 80 70 '), 'copy of the probe')
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


if __name__ == '__main__':
    view.main()
