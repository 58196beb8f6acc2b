#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""vkao-view without a person: pictures that equal those of vkao, errors that say what is wrong."""
import re
import subprocess

import view  # first: it knows where cli.py lies
from cli import case, cases, check, check_message, equal, matches, np, write_exr
from scene import FOV, HEIGHT, RADIUS, WIDTH
from view import (BACKGROUND, LINE, READ, SCENE, Viewer, gbuffer, more_channels, preview,
                  same_picture, shoot)

# --- Pictures ---

@cases(['sphere', 'hemisphere', 'hbao', 'gtao', 'vbao', 'raymarch'])
def ao_shown_is_that_of_vkao(scratch, method):
    write_exr(scratch.path('in.exr'), gbuffer())
    options = (*READ, '--method', method)
    same_picture(shoot(scratch, 'in.exr', *options), preview(scratch, 'in.exr', *options), method)


PARAMETERS = {
    'half resolution': ('--quality', 'fast'),
    'best': ('--quality', 'best'),
    'automatic radius': ('--fov', FOV, '--radius', 'auto'),
    'no normals': ('--normal', 'none'),
    'wide blur': ('--blur', 12, '--blur-sharpness', 20, '--blur-normal-power', 1),
    'strong': ('--intensity', 2, '--power', 1.5, '--falloff', 'threshold', '--noise-index', 5),
    'literal sphere': ('--method', 'sphere', '--sphere-form', 'literal', '--blocking-scale', 4),
}


@cases(PARAMETERS.items())
def parameters_mean_what_they_mean_to_vkao(scratch, _, options):
    write_exr(scratch.path('in.exr'), gbuffer())
    options = (*READ, *options)
    same_picture(shoot(scratch, 'in.exr', *options), preview(scratch, 'in.exr', *options), 'AO')


@case
def coarse_depth_raises_the_bias_as_in_vkao(scratch):
    write_exr(scratch.path('in.exr'), {'Z': np.minimum(SCENE.depth(), 6e4).astype(np.float16)})
    options = ('--fov', FOV, '--radius', 0.05)
    same_picture(shoot(scratch, 'in.exr', *options), preview(scratch, 'in.exr', *options), 'AO')


@case
def raw_ao_is_that_of_vkao_without_blur(scratch):
    write_exr(scratch.path('in.exr'), gbuffer())
    shown = shoot(scratch, 'in.exr', *READ, '--show', 'raw', '--intensity', 3)
    same_picture(shown, preview(scratch, 'in.exr', *READ, '--blur', 'off'), 'raw AO')


MORE = more_channels(SCENE)
READERS = {
    'light': ('composite', ('--indirect', 'gi', '--albedo', 'albedo', '--specular', 'spec',
                            '--roughness', 'rough', '--holdout', 'matte', '--strength', '0.7')),
    'bent specular': ('composite', ('--specular', 'spec', '--bent-normals')),
    'thickness': ('ao', ('--holdout', 'matte', '--thickness-channel', 'thick')),
    'back': ('raw', ('--back-depth', 'back', '--layer2', 'behind')),
    'no cast': ('ao', ('--no-cast', 'matte', '--background', '5', '--depth-type', 'radial')),
}


@cases(READERS.items())
def options_that_read_a_file_are_those_of_vkao(scratch, name, row):
    shows, options = row
    write_exr(scratch.path('in.exr'), {**gbuffer(), **MORE})
    mode = 'comp' if shows == 'composite' else 'ao'
    raw = ('--blur', 'off') if shows == 'raw' else ()
    wanted = preview(scratch, 'in.exr', *READ, *options, *raw, mode=mode)
    same_picture(shoot(scratch, 'in.exr', *READ, *options, '--show', shows), wanted, name)


@case
def elements_in_files_of_their_own_are_read(scratch):
    for kind, planes in (('z', {'R': (SCENE.depth() - 1) / 20}), ('n', SCENE.normals()),
                         ('c', SCENE.color())):
        write_exr(scratch.path(f'{kind}.0001.exr'), planes)
    write_exr(scratch.path('in.0001.exr'), {'matte': MORE['matte']})
    options = (*READ, '--depth-file', 'z.####.exr', '--normal-file', 'n.####.exr', '--color-file',
               'c.####.exr', '--depth-type', 'normalized', '--depth-range', '1,21')
    scratch.render('in.####.exr', '-o', 'ao.####.exr', '--preview', 'ao.####.png', '--mode', 'comp',
                   '--device', 'cpu', *options)
    same_picture(shoot(scratch, 'in.####.exr', *options, '--show', 'composite'),
                 view.read_png(scratch.path('ao.0001.png')), 'composite')


@case
def what_is_wrong_with_a_file_is_said_in_the_words_of_vkao(scratch):
    write_exr(scratch.path('in.exr'), gbuffer())
    for options in (('--indirect', 'gi'), ('--depth', 'deep'), ('--holdout', 'crypto:ball'),
                    ('--depth-file', 'none.exr'), ('--max-memory', '1M')):
        done = scratch.run('in.exr', '-o', 'x.exr', '--mode', 'comp', '--device', 'cpu', *READ,
                           *options)
        said = shoot(scratch, 'in.exr', *READ, *options, code=done.code)
        check(done.code and done.stderr, f'{options}: vkao took it')
        equal(said.splitlines()[:1], done.stderr.splitlines()[:1], f'what is said of {options}')


@case
def files_are_read_as_vkao_says_it(scratch):
    write_exr(scratch.path('in.exr'), gbuffer())
    said = scratch.render('in.exr', '-o', 'x.exr', '--device', 'cpu', *READ).stderr
    with Viewer(scratch, 'in.exr', *READ, size=(WIDTH, HEIGHT)) as viewer:
        viewer.finish()
    using = re.search(r'using: (.*?) radius=', said).group(1)
    check(f'vkao: using: {using}\n' in viewer.err, f'{viewer.err}, want {using}')


@case
def colour_that_cannot_be_read_leaves_the_ao(scratch):
    write_exr(scratch.path('in.exr'), (gbuffer(False), {'name': 'a'}),
              (SCENE.color(), {'name': 'b'}))
    data = scratch.bytes('in.exr')
    scratch.write('in.exr', data[:-200] + bytes(200))
    said = scratch.run('in.exr', '-o', 'x.exr', '--mode', 'comp', '--device', 'cpu', *READ)
    equal(said.code, 3, 'exit code of a composite')
    same_picture(shoot(scratch, 'in.exr', *READ), preview(scratch, 'in.exr', *READ), 'AO')


@case
def composite_is_that_of_vkao(scratch):
    write_exr(scratch.path('in.exr'), gbuffer())
    options = (*READ, '--strength', 0.8, '--tint', '0.2,0.1,0.4')
    shown = shoot(scratch, 'in.exr', *options, '--show', 'composite')
    same_picture(shown, preview(scratch, 'in.exr', *options, mode='comp'), 'composite')


@case
def cropped_data_window_shows_its_own_texels(scratch):
    part = {k: np.ascontiguousarray(c[21:, 17:]) for k, c in gbuffer().items()}
    write_exr(scratch.path('in.exr'), part, x=17, y=21, display=(0, 0, WIDTH - 1, HEIGHT - 1))
    shown = shoot(scratch, 'in.exr', *READ)
    equal(shown.shape, (HEIGHT - 21, WIDTH - 17, 3), 'picture')
    same_picture(shown, preview(scratch, 'in.exr', *READ), 'cropped')


@case
def normals_and_depth_show_what_is_in_the_file(scratch):
    write_exr(scratch.path('in.exr'), gbuffer())
    normals = shoot(scratch, 'in.exr', *READ, '--show', 'normals')
    there = ~SCENE.sky
    stored = np.stack([SCENE.normals()[f'N.{c}'] for c in 'XYZ'], axis=-1)
    wanted = np.floor(np.clip(stored * 0.5 + 0.5, 0, 1) * 255 + 0.5)
    # Both signs of z are right for the sign of the axis; x and y are what the file says.
    difference = np.abs(normals[there][:, :2].astype(int) - wanted[there][:, :2])
    check(np.percentile(difference, 99) <= 1, f'normals differ by {difference.max()}')
    depth = SCENE.depth()
    # A few texels far off do not count. They differ: one far value that repeats is background.
    depth[-1, :60] = np.linspace(40, 60, 60)
    write_exr(scratch.path('in.exr'), {**gbuffer(), 'Z': depth})
    z = depth[there]
    ends = np.percentile(z, (1, 99))
    check(ends[1] < 7, f'the far end is {ends[1]}')
    for options, (near, far) in (((), ends), (('--show-range', '2,5.5'), (2, 5.5))):
        depth = shoot(scratch, 'in.exr', *READ, '--show', 'depth', *options)[..., 0].astype(float)
        difference = np.abs(depth[there] - np.clip((z - near) / (far - near), 0, 1) * 255)
        check(difference.max() <= 1.5, f'{options}: depth is off by {difference.max()} of 255')
        check((depth[SCENE.sky] == 0).all(), 'background has a depth')


@case
def exposure_is_in_stops(scratch):
    write_exr(scratch.path('in.exr'), gbuffer())
    planes = {k: c / 4 if k in 'RGB' else c for k, c in SCENE.color().items()}
    write_exr(scratch.path('darker.exr'), {**gbuffer(False), **planes})
    shown = shoot(scratch, 'in.exr', *READ, '--show', 'composite', '--exposure', '-2')
    same_picture(shown, preview(scratch, 'darker.exr', *READ, mode='comp'), 'two stops less')


@case
def bent_normals_of_an_open_floor_are_its_normals(scratch):
    write_exr(scratch.path('in.exr'), gbuffer())
    bent = shoot(scratch, 'in.exr', *READ, '--show', 'bent').astype(int)
    normals = shoot(scratch, 'in.exr', *READ, '--show', 'normals').astype(int)
    ao = shoot(scratch, 'in.exr', *READ)[..., 0]
    open_floor = (ao == 255) & ~SCENE.sky
    check(open_floor.sum() > 500, f'{open_floor.sum()} open texels')
    difference = np.abs(bent - normals).max(axis=-1)[open_floor]
    check(np.median(difference) <= 12, f'bent normals are off by {np.median(difference)}')


@case
def bent_normals_without_a_method_for_them_show_nothing(scratch):
    write_exr(scratch.path('in.exr'), gbuffer())
    shown = shoot(scratch, 'in.exr', *READ, '--show', 'bent', '--method', 'hbao')
    check((shown[0] == BACKGROUND).all(), 'something is shown')


@case
def difference_to_a_reference(scratch):
    write_exr(scratch.path('in.exr'), gbuffer())
    ao = preview(scratch, 'in.exr', *READ)[..., 0] / 255
    reference = np.clip(ao + 0.25 * np.sin(np.arange(WIDTH) / 9), 0, 1).astype(np.float32)
    write_exr(scratch.path('in.gt.exr'), {'AO': reference})
    shown = shoot(scratch, 'in.exr', *READ, '--show', 'difference').astype(float) / 255
    d = (ao - reference) * 4
    wanted = np.where((d < 0)[..., None], -d[..., None] * [1, 0.35, 0.1],
                      d[..., None] * [0.15, 0.6, 1])
    error = np.abs(shown - np.clip(wanted, 0, 1))
    check(error.max() < 4.5 / 255 and np.abs(d).max() > 0.5, f'off by {error.max() * 255}')


@case
def zoom_makes_squares_of_texels(scratch):
    write_exr(scratch.path('in.exr'), gbuffer())
    shown = shoot(scratch, 'in.exr', *READ, '--zoom', 3, '--size', f'{WIDTH * 3}x{HEIGHT * 3}')
    wanted = preview(scratch, 'in.exr', *READ).repeat(3, axis=0).repeat(3, axis=1)
    same_picture(shown, wanted, 'zoomed')


@case
def smaller_window_shows_all_of_the_image(scratch):
    write_exr(scratch.path('in.exr'), gbuffer())
    shown = shoot(scratch, 'in.exr', *READ, '--size', f'{WIDTH // 2}x{HEIGHT // 2}')
    whole = preview(scratch, 'in.exr', *READ).astype(float)
    means = whole[:HEIGHT // 2 * 2, :WIDTH // 2 * 2].reshape(HEIGHT // 2, 2, WIDTH // 2, 2, 3)
    same_picture(shown, means.mean(axis=(1, 3)), 'reduced', 2)


@case
def wipe_shows_two_settings_at_once(scratch):
    write_exr(scratch.path('in.exr'), gbuffer())
    shown = shoot(scratch, 'in.exr', *READ, '--wipe', 0.25, '--versus', '--method hbao --blur 0')
    a = preview(scratch, 'in.exr', *READ)
    b = preview(scratch, 'in.exr', *READ, '--method', 'hbao', '--blur', 0)
    line = WIDTH // 4
    same_picture(shown[:, :line], a[:, :line], 'A')
    same_picture(shown[:, line + 1:], b[:, line + 1:], 'B')
    check((shown[:, line] == LINE).all(), 'no line')


@case
def stereo_file_shows_the_eye_asked_for(scratch):
    left, right = gbuffer(False), gbuffer(False)
    right['Z'] = np.ascontiguousarray(right['Z'][:, ::-1])
    for c in 'XYZ':
        right[f'N.{c}'] = np.ascontiguousarray(right[f'N.{c}'][:, ::-1])
    write_exr(scratch.path('in.exr'), (left, {'name': 'l', 'view': 'left'}),
              (right, {'name': 'r', 'view': 'right'}))
    for eye in ('left', 'right'):
        options = (*READ, '--view', eye)
        same_picture(shoot(scratch, 'in.exr', *options), preview(scratch, 'in.exr', *options), eye)


@case
def camera_beside_the_file_is_taken(scratch):
    write_exr(scratch.path('in.exr'), gbuffer())
    scratch.write('in.camera.json', '{"fov_x_deg": %g}' % FOV)
    wanted = preview(scratch, 'in.exr', *READ, '--camera', 'none')
    same_picture(shoot(scratch, 'in.exr', '--radius', RADIUS), wanted, 'AO of the viewer')
    same_picture(preview(scratch, 'in.exr', '--radius', RADIUS), wanted, 'AO of the tool')
    wide = ('--radius', RADIUS, '--camera', 'none', '--fov', 90)
    same_picture(shoot(scratch, 'in.exr', *wide), preview(scratch, 'in.exr', *wide), 'AO without')


@case
def sequence_keeps_the_radius_of_its_first_frame(scratch):
    for number in (1, 2):
        channels = gbuffer(False)
        channels['Z'] = channels['Z'] * np.float32(number)
        write_exr(scratch.path(f'in.{number:04}.exr'), channels)
    shown = shoot(scratch, 'in.####.exr', '--fov', FOV)
    scratch.render('in.####.exr', '-o', 'ao.####.exr', '--preview', 'ao.####.png', '--fov', FOV)
    same_picture(shown, view.read_png(scratch.path('ao.0001.png')), 'first frame')


# --- Errors ---

@case
def help_fits_a_screen(scratch):
    del scratch
    done = subprocess.run([view.VIEWER, '--help'], capture_output=True, text=True, check=True)
    lines = done.stdout.splitlines()
    check(len(lines) <= 24 and max(map(len, lines)) <= 80,
          f'{len(lines)} lines of up to {max(map(len, lines))} columns')


@case
def no_display_is_said(scratch):
    write_exr(scratch.path('in.exr'), gbuffer())
    said = shoot(scratch, 'in.exr', code=5, display=False,
                 env={'DISPLAY': '', 'WAYLAND_DISPLAY': ''})
    matches('^vkao: no display: ', said, 'the message')
    matches('\n +vkao computes without', said, 'the hint')
    said = shoot(scratch, 'in.exr', code=5, display=False, env={'DISPLAY': ':987654'})
    matches('^vkao: no display: ', said, 'the message')


@case
def no_vulkan_driver_is_said(scratch):
    write_exr(scratch.path('in.exr'), gbuffer())
    nowhere = {'VK_ICD_FILENAMES': '/nonexistent', 'VK_DRIVER_FILES': '/nonexistent'}
    said = shoot(scratch, 'in.exr', code=5, env=nowhere)
    matches('^vkao: no Vulkan', said, 'the message')
    matches('\n +(install|vkao computes)', said, 'the hint')


USAGE = {
    'unknown option': (('--radios', '1'), 'unknown option'),
    'two files': (('a.exr', 'b.exr'), 'one FILE at a time'),
    'scene and file': (('--scene', 'room', 'a.exr'), 'exclude each other'),
    'unknown scene': (('--scene', 'attic'), "--scene is 'attic', want cubes or room"),
    'unknown view': (('--show', 'shadow'), '--show is'),
    'zoom': (('--zoom', '0'), '--zoom is'),
    'wipe': (('--wipe', '2'), '--wipe is'),
    'size': (('--size', '100'), '--size is'),
    'frames': (('--frames', '0'), '--frames is'),
    'range': (('in.exr', '--radius', '-1'), '--radius is -1, want'),
    'versus': (('in.exr', '--versus', '--method crease'), '--method is'),
    'no argument': (('in.exr', '--scene'), 'needs an argument'),
    'output': (('in.exr', '-o', 'x.exr'), 'no meaning for vkao-view'),
    'exposure': (('in.exr', '--exposure', '11'), '--exposure is'),
    'depth shown': (('in.exr', '--show-range', '5,5'), '--show-range is'),
}


@cases(USAGE.items())
def command_lines_are_checked(scratch, _, row):
    arguments, message = row
    done = subprocess.run([view.VIEWER, *arguments], cwd=scratch.directory, capture_output=True,
                          text=True)
    equal(done.returncode, 2, f'exit code\n{done.stderr}')
    check_message(done, message, 'vkao-view --help|quote')


@case
def files_that_cannot_be_shown_are_refused(scratch):
    scratch.write('text.exr', 'not an image')
    write_exr(scratch.path('color.exr'), SCENE.color())
    for name, code in (('missing.exr', 3), ('text.exr', 3), ('color.exr', 4)):
        matches(f'^vkao: {name}: ', shoot(scratch, name, code=code), 'the message')


@case
def reference_that_does_not_fit_is_refused(scratch):
    write_exr(scratch.path('in.exr'), gbuffer())
    write_exr(scratch.path('small.exr'), {'AO': np.ones((4, 4), np.float32)})
    matches('small.exr: the reference is not',
            shoot(scratch, 'in.exr', *READ, '--reference', 'small.exr', code=3), 'the message')


if __name__ == '__main__':
    view.main()
