#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""How large vkao-view's panel is, by monitor and window.

`test_panel.py VKAO VKAO-VIEW SHIM [CASE...]`: SHIM is scale_shim.c, preloaded."""
import os
import sys

import view  # first: it knows where cli.py lies
from cli import case, check, is_sanitized, skip
from scene import HEIGHT, WIDTH
from view import BACKGROUND, PANEL_WIDTH, READ, opened, preview, same_picture

SHIM = os.path.abspath(sys.argv.pop(3))


def on_monitor(scratch, scale, *arguments, lags=False, **more):
    if is_sanitized(view.VIEWER):
        skip('sanitizers want to be loaded first')
    scratch.write('scale', str(scale))
    env = {'LD_PRELOAD': SHIM, 'VKAO_SCALE': scratch.path('scale'),
           **({'VKAO_SIZE_LAGS': '1'} if lags else {})}
    return opened(scratch, *arguments, env=env, **more)


@case
def panel_follows_the_monitor(scratch):
    width = 2 * PANEL_WIDTH
    with on_monitor(scratch, 2, size=(width + WIDTH, 1000)) as viewer:
        viewer.wait_title('- 100 % -')
        scratch.write('scale', '1')
        viewer.wait_title('- 300 % -')
        scratch.write('scale', '2')
        viewer.wait_title('- 100 % -')
        shown = viewer.finish()
    top = (1000 - HEIGHT) // 2
    same_picture(shown[top:top + HEIGHT, width:], preview(scratch, 'in.exr', *READ), 'AO')
    check((shown[:top, width:] == BACKGROUND).all(), 'the panel is wider than that')
    check((shown[:, width - 8] != BACKGROUND).any(axis=-1).all(), 'the panel is narrower than that')


@case
def window_on_a_dense_monitor_is_as_large_as_its_panel(scratch):
    with on_monitor(scratch, 1.5) as viewer:
        viewer.wait_title('- 100 % -')
        shown = viewer.finish()
    scale = 20 / 13  # of the letters
    check(shown.shape[:2] == (int(640 * scale), round(PANEL_WIDTH * scale) + WIDTH),
          f'the window is {shown.shape}')


@case
def panel_grows_in_a_large_window(scratch):
    with opened(scratch, size=(3200, 2000)) as viewer:
        viewer.wait_title('- 1500 % -')  # (3200 - 660) / 160
        viewer.finish()


@case
def window_that_grows_while_it_is_asked_for_its_sizes_survives(scratch):
    with on_monitor(scratch, 1, lags=True) as viewer:
        viewer.key('2', '1', 'z')
        viewer.wait_title('- 100 % -')
        viewer.finish()


@case
def panel_is_as_large_as_asked_for(scratch):
    with opened(scratch, '--panel-scale', 3, size=(3 * PANEL_WIDTH + WIDTH, 200)) as viewer:
        viewer.wait_title('- 100 % -')
        viewer.finish()


if __name__ == '__main__':
    view.main()
