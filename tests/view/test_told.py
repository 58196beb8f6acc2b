#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""What vkao-view's panel and the words on its picture tell, how they are laid out, and what sliders
reach and bring back."""
import time

import view  # first: it knows where cli.py lies
from cli import case, check, equal, np, write_exr
from scene import FOV, WIDTH
from view import (PANEL_WIDTH, SCENE, WHOLE, Viewer, gbuffer, opened, screen, script, until, yellow)

# --- Values ---

@case
def warning_of_the_radius_follows_the_panel(scratch):
    size = (WIDTH + PANEL_WIDTH, 700)
    with opened(scratch, size=size) as viewer:
        def warned():
            return yellow(screen(scratch, viewer, size)[:, :PANEL_WIDTH]) > 100
        check(not warned(), 'a warning at the radius asked for')
        viewer.drag((85, 198), (9, 198), hold=1)  # radius
        until(warned, 'warning that the radius is less than a texel')
        viewer.key('ctrl+z')
        until(lambda: not warned(), 'end of the warning')
        viewer.finish()


@case
def right_click_brings_back_the_radius_of_the_file(scratch):
    write_exr(scratch.path('in.exr'), gbuffer())
    size = (WIDTH + PANEL_WIDTH, 700)
    with Viewer(scratch, 'in.exr', '--fov', FOV, '--save', 'saved', size=size) as viewer:
        viewer.wait_title('^in.exr')
        viewer.key('s')
        until(lambda: 'saved.sh' in scratch.files(), 'saved picture')
        viewer.drag((85, 175 + 23), (110, 175 + 23), hold=1)  # radius
        viewer.key('s')
        until(lambda: 'saved.2.sh' in scratch.files(), 'saved picture')
        # Above the saved command, which takes room of what scrolls.
        viewer.drag((85, 175 + 23), (85, 175 + 23), button=3, hold=1)
        viewer.key('s')
        viewer.finish()
    first, changed, last = (script(scratch, name) for name in
                            ('saved.sh', 'saved.2.sh', 'saved.3.sh'))

    def radius(command):
        return float(command[command.index('--radius') + 1])
    check(radius(changed) > radius(first) * 1.2, f'the radius is {radius(changed)}')
    equal(radius(last), radius(first), 'the radius after a right click')


@case
def slider_reaches_a_radius_in_millimetres(scratch):
    planes = {**gbuffer(), 'Z': np.where(SCENE.sky, 1e10, SCENE.depth() * 5e4).astype(np.float32)}
    write_exr(scratch.path('in.exr'), planes)
    with Viewer(scratch, 'in.exr', '--fov', FOV, '--save', 'saved',
                size=(WIDTH + PANEL_WIDTH, 700)) as viewer:
        viewer.wait_title('^in.exr')
        viewer.drag((80, 198), (90, 198), hold=1)  # radius
        viewer.key('s')
        viewer.finish()
    command = script(scratch, 'saved.sh')
    radius = float(command[command.index('--radius') + 1])
    check(radius > 1000, f'the radius is {radius}')


@case
def exposure_is_undone_too(scratch):
    size = (WIDTH + PANEL_WIDTH, 700)
    with opened(scratch, '--show', 'composite', size=size) as viewer:
        def light():
            return screen(scratch, viewer, size)[350, PANEL_WIDTH:].mean()
        before = light()
        viewer.drag((90, 102), (60, 102), hold=1)  # exposure
        until(lambda: light() < before * 0.7, 'darker picture')
        viewer.key('ctrl+z')
        until(lambda: abs(light() - before) < 1e-6, 'picture as it was')
        viewer.key('ctrl+y')
        until(lambda: light() < before * 0.7, 'darker picture again')
        viewer.finish()


# --- Layout ---

@case
def two_long_names_leave_room_for_what_is_beside(scratch):
    names = ('--method', 'hemisphere', '--quality', 'fast', '--versus', '--method raymarch')
    with opened(scratch, *names, size=(WIDTH + PANEL_WIDTH, 700)) as viewer:
        viewer.wait_title('- A hemisphere half -')
        viewer.click(176, 106)  # 'B'
        viewer.wait_title('- B raymarch half -')
        viewer.click(258, 129)  # 'wipe'
        viewer.wait_title(r'A hemisphere half \| B raymarch half')
        viewer.finish()


@case
def end_of_the_panel_stays_in_the_window(scratch):
    size = (WIDTH + PANEL_WIDTH, 640)
    with opened(scratch, size=size) as viewer:
        def edges():
            shown = screen(scratch, viewer, size)[:, :PANEL_WIDTH]
            return np.concatenate([shown[-4:].reshape(-1, 3), shown[:, -12:-2].reshape(-1, 3)])

        def check_edges(what):
            time.sleep(0.7)
            check(edges().max() < 100, f'{what}: a bar, or a button that is cut off')
        for view_key in '2437':
            viewer.move(100, 5)
            check_edges('the mouse left')
            viewer.move(PANEL_WIDTH + 80, 320)
            check_edges('the mouse came')
            viewer.key(view_key)
            check_edges(f'view {view_key}')
        viewer.finish()


@case
def word_on_the_picture_is_whole_in_a_narrow_window(scratch):
    size = (PANEL_WIDTH + 100, 500)
    with Viewer(scratch, size=size) as viewer:
        viewer.wait_title('^no file - ')
        shown = viewer.finish()[:, PANEL_WIDTH:]
    check((shown[200:300] > 200).any(), 'no word')
    for column in (1, -2):
        check((shown[:, column] == shown[0, column]).all(), f'it reaches column {column}')


@case
def what_was_done_is_told_while_the_panel_is_hidden(scratch):
    size = (500, 300)
    with opened(scratch, *WHOLE, size=size) as viewer:
        viewer.move(250, 150)
        time.sleep(1)
        before = screen(scratch, viewer, size)

        def told():
            return (screen(scratch, viewer, size) != before).any(axis=-1)[-30:].sum() > 500
        for key in ('s', 'ctrl+c'):
            viewer.key(key)
            until(told, f'word of {key}')
            viewer.key('2')
            until(lambda: not told(), 'picture as before after a key')
        viewer.move(3, 3)  # beside the image
        time.sleep(1)
        viewer.key('ctrl+c')
        until(told, 'word that nothing was copied')
        viewer.finish()


if __name__ == '__main__':
    view.main()
