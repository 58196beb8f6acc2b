#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""vkao-view --scene: a live scene under keys, mouse and windows that change their size."""
import shlex

import view  # first: it knows where cli.py lies
from cli import case, cases, check, np, read_ao
from view import PANEL_WIDTH, Viewer, same_picture, shoot

SIZE = ('--size', '240x150')
STILL = ('--time', 1, *SIZE)


def difference(a, b):
    return np.abs(a.astype(int) - b.astype(int)).mean()


def live(scratch, *arguments, size=(240, 150)):
    viewer = Viewer(scratch, '--scene', 'room', '--time', 1, '--no-panel', *arguments, size=size)
    viewer.wait_title('^room - ')
    return viewer


@cases(['cubes', 'room'])
def same_time_gives_the_same_picture(scratch, scene):
    first = shoot(scratch, '--scene', scene, *STILL)
    check(first.std() > 10, f'a picture of nothing: {first.std()}')
    same_picture(first, shoot(scratch, '--scene', scene, *STILL, frames=6), scene, 0)


@cases(['cubes', 'room'])
def something_moves(scratch, scene):
    shots = [shoot(scratch, '--scene', scene, '--show', 'normals', '--time', t, *SIZE)
             for t in (1, 2)]
    check(difference(*shots) > 0.05, f'nothing moves: {difference(*shots)}')


@cases(['raw', 'ao', 'composite', 'depth', 'normals', 'bent'])
def every_view_has_a_picture(scratch, name):
    shown = shoot(scratch, '--scene', 'room', '--show', name, *STILL)
    check(shown.std() > 5, f'a picture of nothing: {shown.std()}')


@cases(['sphere', 'hemisphere', 'hbao', 'gtao', 'vbao', 'raymarch'])
def walls_are_open_and_corners_are_not(scratch, method):
    ao = shoot(scratch, '--scene', 'room', '--method', method, *STILL)[..., 0]
    check((ao > 240).mean() > 0.3 and ao.min() < 200,
          f'{(ao > 240).mean()} is open, the darkest is {ao.min()}')


@case
def half_of_the_frames_in_flight_is_not_all(scratch):
    """Frames alternate between two sets of images: both must show the scene."""
    shots = [shoot(scratch, '--scene', 'cubes', *STILL, frames=n) for n in (3, 4)]
    same_picture(*shots, 'frames in flight', 0)


@case
def drag_turns_the_scene_and_wheel_nears_it(scratch):
    still = shoot(scratch, '--scene', 'room', *STILL)
    with live(scratch) as viewer:
        viewer.drag((100, 60), (160, 60))
        turned = viewer.finish()
    with live(scratch) as viewer:
        viewer.click(100, 60, button=4)
        viewer.click(100, 60, button=4)
        nearer = viewer.finish()
    with live(scratch) as viewer:
        viewer.drag((100, 60), (160, 60), button=3)
        moved = viewer.finish()
    for picture, what in ((turned, 'drag'), (nearer, 'wheel'), (moved, 'right drag')):
        check(difference(picture, still) > 1, f'{what} changes nothing')


@case
def o_makes_it_orthographic(scratch):
    still = shoot(scratch, '--scene', 'room', *STILL)
    with live(scratch) as viewer:
        viewer.key('o')
        orthographic = viewer.finish()
    check(difference(orthographic, still) > 1, 'the projection is the same')
    with live(scratch) as viewer:
        viewer.key('o', 'o')
        again = viewer.finish()
    same_picture(again, still, 'back in perspective', 0)


@case
def wipe_compares_methods_live(scratch):
    still = shoot(scratch, '--scene', 'room', *STILL)
    other = shoot(scratch, '--scene', 'room', '--method', 'hbao', *STILL)
    with live(scratch, '--versus', '--method hbao', '--wipe', 0.5) as viewer:
        viewer.drag((120, 60), (83, 60))
        shown = viewer.finish()
    same_picture(shown[:, :83], still[:, :83], 'A')
    same_picture(shown[:, 84:], other[:, 84:], 'B')


@case
def scene_follows_the_size_of_the_window(scratch):
    with live(scratch, size=(400, 300)) as viewer:
        for size in ((90, 260), (1, 1), (240, 150)):
            viewer.resize(*size)
        shown = viewer.finish()
    same_picture(shown, shoot(scratch, '--scene', 'room', *STILL), 'resized', 0)


@case
def first_frame_of_another_size_fits_the_window(scratch):
    with live(scratch, size=(40, 30)) as viewer:
        shown = viewer.finish('windowsize', viewer.window, 240, 150)
    same_picture(shown, shoot(scratch, '--scene', 'room', *STILL), 'resized', 0)


@case
def clock_runs_until_space_stops_it(scratch):
    with Viewer(scratch, '--scene', 'cubes', '--no-panel', size=(120, 80)) as viewer:
        viewer.wait_title('^cubes - ')
        viewer.key('space')
        viewer.finish()


@case
def less_resolution_needs_no_other_images(scratch):
    with Viewer(scratch, '--scene', 'room', '--time', 1, size=(PANEL_WIDTH + 240, 600)) as viewer:
        # The slider 'resolution'.
        viewer.drag((166, 35), (40, 35), hold=0.5, until='- [234][0-9]{2}[0-9.]* %')
        shown = viewer.finish()[:, PANEL_WIDTH:]
    check(shown.std() > 10, f'a picture of nothing: {shown.std()}')


@cases([('perspective', ('2',)), ('orthographic', ('o', '2')), ('composite', ('3',)),
        ('raw', ('1',))])
def saved_frame_has_the_same_ao_for_vkao(scratch, _, keys):
    """The same scene once as an engine hands it to the library, and once through files."""
    with live(scratch, '--save', 'saved') as viewer:
        viewer.key(*keys)
        viewer.key('s')
        shown = viewer.finish()
    same_picture(view.read_png(scratch.path('saved.png')), shown, 'PNG')
    ao = read_ao(scratch.path('saved.exr'))
    lines = scratch.bytes('saved.sh').decode().splitlines()
    scratch.render(*shlex.split(lines[-1])[1:], '--device', 'cpu')
    error = np.abs(read_ao(scratch.path('saved.exr')) - ao)
    # Depth went through another encoding: a few samples fall on the other side of an edge.
    check(error.mean() < 2e-3 and np.percentile(error, 99) < 0.03,
          f'AO differs by {error.mean()}, 99 % are below {np.percentile(error, 99)}')
    check((error == 0).mean() > 0.3, f'{(error == 0).mean()} is equal')


if __name__ == '__main__':
    view.main()
