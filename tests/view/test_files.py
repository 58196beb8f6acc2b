#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Files that are opened in a running vkao-view: from its list, and dropped on it."""
import os
import time

import view  # first: it knows where cli.py lies
from cli import case, check, equal, np, read_ao, write_exr
from drop import drop_files
from scene import FOV, HEIGHT, RADIUS, WIDTH
from view import (PANEL_WIDTH, READ, SCENE, WHOLE, Viewer, gbuffer, opened, preview, read_png,
                  same_picture, screen, until)

# --- From the list ---

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


@case
def camera_dropped_on_a_sequence_is_that_of_all_frames(scratch):
    for number in (1, 2):
        write_exr(scratch.path(f'in.{number}.exr'), gbuffer())
    scratch.write('wide.json', '{"fov_x_deg": 90}')
    with Viewer(scratch, 'in.%d.exr', '--radius', RADIUS, *WHOLE) as viewer:
        viewer.key('Right')
        viewer.wait_title(r'^in.2.exr \[2/2\]')
        drop_files(viewer, scratch.path('wide.json'))
        time.sleep(0.5)
        viewer.wait_title(r'^in.2.exr \[2/2\]')
        viewer.key('Left')
        viewer.wait_title(r'^in.1.exr \[1/2\]')
        shown = viewer.finish()
    wanted = preview(scratch, 'in.1.exr', '--radius', RADIUS, '--fov', 90)
    same_picture(shown, wanted, 'AO')


@case
def reference_dropped_on_a_sequence_leaves_it_one(scratch):
    for number in (1, 2):
        write_exr(scratch.path(f'in.{number}.exr'), gbuffer())
    write_exr(scratch.path('truth.exr'), {'AO': SCENE.depth() * 0 + np.float32(2)})
    with Viewer(scratch, 'in.%d.exr', *READ, *WHOLE, '--show', 'difference') as viewer:
        viewer.wait_title(r'^in.1.exr \[1/2\]')
        drop_files(viewer, scratch.path('truth.exr'))
        viewer.key('Right')
        viewer.wait_title(r'^in.2.exr \[2/2\]')
        shown = viewer.finish()
    check((shown[..., 0] > 250).all(), 'the second frame is compared to nothing')


@case
def file_is_dropped_with_what_belongs_to_it(scratch):
    write_exr(scratch.path('other.exr'), gbuffer())
    write_exr(scratch.path('other.gt.exr'), {'AO': SCENE.depth() * 0 + np.float32(2)})
    scratch.write('other.camera.json', '{"fov_x_deg": %g}' % FOV)
    scratch.write('wide.json', '{"fov_x_deg": 90}')
    scratch.write('long.json', '{"fov_x_deg": 20}')
    with opened(scratch, *WHOLE, '--camera', 'none') as viewer:
        drop_files(viewer, *map(scratch.path, ('other.camera.json', 'other.exr', 'other.gt.exr')))
        viewer.wait_title('^other.exr - ')
        viewer.key('7')
        viewer.wait_title('^other.exr - Difference')
        until(lambda: (screen(scratch, viewer, (WIDTH, HEIGHT))[..., 0] > 250).all(), 'reference')
        viewer.key('2')
        drop_files(viewer, scratch.path('wide.json'), scratch.path('long.json'))
        time.sleep(0.5)
        viewer.wait_title('^other.exr - AO - ')
        drop_files(viewer, scratch.path('other.exr'), scratch.path('wide.json'))
        time.sleep(0.5)
        viewer.wait_title('^other.exr - AO - ')
        shown = viewer.finish()
        check('one camera file at a time' in viewer.err, f'nothing is said:\n{viewer.err}')
    wanted = preview(scratch, 'other.exr', '--radius', RADIUS, '--camera', 'wide.json', '--fov',
                     FOV)
    same_picture(shown, wanted, 'AO')


@case
def setting_b_keeps_its_radius_in_another_file(scratch):
    write_exr(scratch.path('in.exr'), gbuffer())
    write_exr(scratch.path('other.exr'), gbuffer())
    with Viewer(scratch, 'in.exr', '--fov', FOV, '--versus', '--radius 0.8', *WHOLE) as viewer:
        viewer.wait_title('^in.exr - ')
        drop_files(viewer, scratch.path('other.exr'))
        viewer.key('Tab')
        viewer.wait_title('^other.exr - AO - B ')
        shown = viewer.finish()
    same_picture(shown, preview(scratch, 'other.exr', '--fov', FOV, '--radius', 0.8), 'B')


# --- Sequences ---

@case
def each_frame_has_its_own_warnings_and_bias(scratch):
    write_exr(scratch.path('in.1.exr'), {'Z': SCENE.depth()})
    coarse = np.minimum(SCENE.depth(), 6e4).astype(np.float16)
    write_exr(scratch.path('in.2.exr'), {'Z': coarse})
    options = ('--fov', FOV, '--radius', 0.05)
    size = (WIDTH + PANEL_WIDTH, 700)
    with Viewer(scratch, 'in.%d.exr', *options, size=size) as viewer:
        def lines():
            panel = screen(scratch, viewer, size)[:300, :PANEL_WIDTH]
            is_yellow = ((panel[..., 0] > 200) & (panel[..., 2] < 120)).any(axis=1)
            return int(is_yellow.sum())
        viewer.wait_title(r'^in.1.exr \[1/2\]')
        time.sleep(1)
        first = lines()
        viewer.key('Right')
        viewer.wait_title(r'^in.2.exr \[2/2\]')
        until(lambda: lines() > first + 20, 'warning of the second frame')
        viewer.key('Left')
        viewer.wait_title(r'^in.1.exr \[1/2\]')
        until(lambda: lines() == first, 'warnings of the first frame alone')
        viewer.key('Right')
        viewer.wait_title(r'^in.2.exr \[2/2\]')
        shown = viewer.finish()
        equal(viewer.err.count('depth is HALF'), 1, 'times that it is printed')
    scratch.render('in.%d.exr', '-o', 'ao.%d.exr', '--preview', 'ao.%d.png', '--device', 'cpu',
                   '--frames', '1-2', *options)
    top = (700 - HEIGHT) // 2
    same_picture(shown[top:top + HEIGHT, PANEL_WIDTH:], read_png(scratch.path('ao.2.png')), 'AO')


@case
def empty_frame_tells_no_radius(scratch):
    write_exr(scratch.path('in.1.exr'), {**gbuffer(), 'Z': SCENE.depth() * 0 + np.float32(1e10)})
    write_exr(scratch.path('in.2.exr'), gbuffer())
    options = ('--fov', FOV, '--depth-type', 'planar')
    with Viewer(scratch, 'in.%d.exr', *options, *WHOLE) as viewer:
        viewer.wait_title(r'^in.1.exr \[1/2\]')
        viewer.key('Right')
        viewer.wait_title(r'^in.2.exr \[2/2\]')
        shown = viewer.finish()
    same_picture(shown, preview(scratch, 'in.2.exr', *options), 'AO')


def below_gain(picture):
    """Of the panel in the view of the difference."""
    panel = picture[:, :PANEL_WIDTH].astype(int)
    is_yellow = ((panel[..., 0] > 200) & (panel[..., 2] < 120)).any(axis=1)
    lower = int(np.nonzero(is_yellow)[0].max(initial=37)) - 37  # than without a warning
    return panel[112 + lower:130 + lower, 8:30]


def tells_an_error(picture):
    """White letters, where the blue mark of side A stands if there is no error to tell."""
    rows = below_gain(picture)
    return (rows.min(axis=-1) > 200).any() and (rows[..., 2] - rows[..., 0]).max() < 100


@case
def reference_with_holes_is_measured_where_it_is_known(scratch):
    truth = SCENE.depth() * 0 + np.float32(0.5)
    truth[:9] = np.nan
    write_exr(scratch.path('in.gt.exr'), {'AO': truth})
    size = (WIDTH + PANEL_WIDTH, 700)
    with opened(scratch, '--show', 'difference', size=size) as viewer:
        viewer.wait_title('- Difference -')
        until(lambda: tells_an_error(screen(scratch, viewer, size)), 'error')
        viewer.finish()
        check('are not finite' in viewer.err, f'nothing is said:\n{viewer.err}')


@case
def damaged_reference_is_said_and_not_measured(scratch):
    write_exr(scratch.path('in.gt.exr'), {'AO': SCENE.depth()})
    whole = scratch.bytes('in.gt.exr')
    scratch.write('in.gt.exr', whole[:-200] + bytes(200))
    size = (WIDTH + PANEL_WIDTH, 700)
    with opened(scratch, '--show', 'difference', size=size) as viewer:
        viewer.wait_title('- Difference -')
        time.sleep(1)
        shown = viewer.finish()
        check('in.gt.exr' in viewer.err, f'nothing is said:\n{viewer.err}')
    blue = below_gain(shown)
    check((blue[..., 2] - blue[..., 0]).max() >= 100, 'an error is told')


if __name__ == '__main__':
    view.main()
