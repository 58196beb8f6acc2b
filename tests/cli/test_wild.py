#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Files as renderers write them, and files that other people's programs wrote: each gives the AO of
its clean G-buffer, or is refused or warned of with what helps. They lie outside the repository:
without them all cases are skipped."""
import json

import numpy as np

from cli import (CHANNELS, INPUT, OK, case, cases, check, corpus, equal, main, matches, read_ao,
                 read_parts, write_exr)

ENOUGH = 0.012
OPTIONS = ('--pixel-type', 'float', '--overwrite', 'always')
VIEW = ('--camera', 'CAM', '-r', 0.5)
WIDE = ('--camera', 'CAM90')


def path(name):
    return corpus('wild' if name[0].islower() or name[0] == '3' else 'defects', f'{name}.exr')


def with_cameras(options):
    names = {'CAM': 'cam.json', 'CAM90': 'cam90.json'}
    return [corpus('defects', names[o]) if o in names else o for o in options]


def ao_of(scratch, name, *options):
    result = scratch.render(path(name), '-o', 'ao.exr', *OPTIONS, *with_cameras(options))
    return read_ao(scratch.path('ao.exr')), result.stderr


def clean(scratch, source, background, normals, *options):
    """AO of the same scene with clean depth, and with normals where the file has them."""
    channels = read_parts(path(source))[0].channels
    z = next(v for k, v in channels.items() if k.endswith('Z') and 'N' not in k)
    z = np.where(z >= background, 1e10, z).astype(np.float32)
    planes = {f'N.{c}': next(v for k, v in channels.items() if k.endswith(f'.{c}') and 'N' in k)
              for c in 'XYZ'} if normals else {}
    write_exr(scratch.path('clean.exr'), {'Z': z, **planes})
    scratch.render('clean.exr', '-o', 'clean.ao.exr', *OPTIONS, '--depth-type', 'planar',
                   *with_cameras(options))
    return read_ao(scratch.path('clean.ao.exr'))


# File, options, whether it has normals, what is said.
SAME = [
    ('D01_karma_header', ('-r', 0.5), True, 'worldToNDC is no projection'),
    ('D02_arnold7_header', ('-r', 0.5), True, 'fov=50h'),
    ('D07_nuke_inverse', ('-r', 0.5), False, 'taken as 1/z, as Nuke writes it'),
    ('D06_vray_normalised', ('-r', 0.5, '--depth-type', 'normalized', '--depth-range', '5,13'),
     None, ''),
    ('D09_pbrt_world', ('-r', 0.5), True, ''),
    ('D10_negative_z', ('-r', 0.5), True, 'its sign is turned'),
    ('D11_blender4', VIEW, True, ''),
    ('D11_blender4', ('-r', 0.5), True, 'by depth and normals it is 50'),
    ('D15_nuke_normals', ('-r', 0.5), True, 'normal=N'),
    ('D16_position_only', ('-r', 0.5), True, 'depth=P'),
    ('D17_blender_fileoutput', VIEW, False, ''),
    ('D18_karma_hitPz', ('--fov', 50, '-r', 0.5), False, ''),
    ('D18_mitsuba2_dd_y', ('--fov', 50, '-r', 0.5), False, 'radial'),
    ('D18_octane', ('--fov', 50, '-r', 0.5), False, ''),
    ('D18_unreal_ImageDepth', ('--fov', 50, '-r', 0.5), False, ''),
    ('D21_zero_chunk_table', ('--fov', 50, '-r', 0.5), True, 'chunk table is empty'),
    ('D06_device_depth', ('-r', 0.5, '--depth-type', 'device'), False, ''),
]


@cases(SAME, name=lambda row: f'{row[0]} {row[1][0]}')
def ao_is_that_of_the_clean_scene(scratch, name, options, normals, said):
    ao, stderr = ao_of(scratch, name, *options)
    matches(said, stderr, 'stderr')
    if normals is None:
        return
    wanted = clean(scratch, 'D11_blender4', 1e9, normals, *VIEW)
    error = float(np.sqrt(np.mean((ao.astype(np.float64) - wanted) ** 2)))
    print(f'  {name}: RMSE {error:.4f}')
    check(error <= ENOUGH, f'{name}: RMSE {error:.4f}')


@cases(['D03_pxr24_background', 'D05_far_background_1000'])
def far_background_is_background(scratch, name):
    ao, stderr = ao_of(scratch, name, *WIDE)
    matches(r'radius=0\.3 \(auto\)', stderr, 'stderr')
    wanted = clean(scratch, name, 900, True, *WIDE)
    error = float(np.sqrt(np.mean((ao.astype(np.float64) - wanted) ** 2)))
    check(error <= ENOUGH, f'{name}: RMSE {error:.4f}')


@case
def half_sky_is_background(scratch):
    ao, stderr = ao_of(scratch, 'D04_half_sky_65504')
    matches(r'bias raised to 0\.017.*\n.*radius=30 \(auto\)', stderr, 'stderr')
    z = read_parts(path('D04_half_sky_65504'))[0].channels
    sky = next(iter(z.values())) >= 65504
    check((ao[sky] == 1).all() and ao[~sky].mean() < 0.995, f'{ao[~sky].mean()}')


@case
def camera_normals_are_known(scratch):
    ao, stderr = ao_of(scratch, 'D08_camera_normals', '-r', 0.5)
    matches("normals 'N' are in camera space", stderr, 'stderr')
    explicit, _ = ao_of(scratch, 'D08_camera_normals', '-r', 0.5, '--normal-space', 'camera')
    check((ao == explicit).all(), 'not the AO of --normal-space camera')


# What refuses: code, message, hint.
REFUSED = [
    ('D06_vray_normalised', CHANNELS, 'normalised', '--depth-range'),
    ('D06_vray_white_near', CHANNELS, 'normalised', '--depth-range'),
    ('D06_device_depth', CHANNELS, 'not in scene units', 'device with --near'),
    ('D19_spherical', CHANNELS, 'cameraProjection is 4', '--fov'),
    ('arnold_1306_Z', INPUT, 'deep data', 'flatten'),
    ('3delight_primitives_Z', INPUT, 'deep data', 'flatten'),
    ('arnold_1321_normals', CHANNELS, 'no depth channel', '--depth'),
    ('bispectral_864ch', CHANNELS, 'no depth channel', '--depth'),
    ('blender_depth_Y_a', CHANNELS, 'no depth channel', '--depth Y'),
    ('crypto_special_chars', CHANNELS, 'no depth channel', '--depth'),
    ('mitsuba_spot_multi', CHANNELS, 'no depth channel', '--depth'),
    ('blender_fileoutput_normal_dwaa', CHANNELS, 'no depth channel', '--depth'),
]


@cases(REFUSED)
def refused_with_a_remedy(scratch, name, code, message, hint):
    source = path(name)
    run = scratch.fails(code, message, source, '-o', 'x.exr', hint=hint)
    check(source in run.stderr, f'the file is not named: {run}')
    equal(scratch.run('inspect', source).code, code, 'exit code of inspect')


@cases([('D14_b44a_half_depth', 'compressed with b44a, which is lossy'),
        ('mv_invalid_attribute', 'attribute multiView is of type string'),
        ('blender_depth_Y_a', 'normalised'), ('nuke_singlepart', '1/z')])
def warned_of(scratch, name, message):
    options = ('--depth', 'Y') if name == 'blender_depth_Y_a' else ()
    found = json.loads(scratch.run('inspect', path(name), '--json', *options).stdout)['views']
    matches(message, json.dumps(found), 'inspect')


# File, roles that must be found.
ROLES = [
    ('arnold_1232_P_N', ('normal', 'color', 'position')), ('arnold_1321_normals', ('normal',)),
    ('crypto_special_chars', ('color',)), ('oiio_RGBA_Depth', ('depth', 'color')),
    ('blender_fileoutput_normal_dwaa', ('normal', 'color')), ('mv_singlepart', ('depth', 'color')),
    ('mv_partperlayer', ('depth',)), ('mv_partperview', ('depth',)),
    ('nuke_mv_compat', ('depth',)), ('nuke_mv_partperview', ('depth',)),
    ('nuke_partperlayer', ('depth',)), ('nuke_singlepart', ('depth',)),
    ('prod_rgba_main_depth_main', ('depth',)), ('multipart_customDepth', ('depth',)),
    ('multipart_rgb_RGBA_depth', ('depth',)),
]


@cases(ROLES)
def roles_are_found_each_on_its_own(scratch, name, roles):
    run = scratch.run('inspect', path(name), '--json')
    check(run.code in (OK, CHANNELS), str(run))
    for view in json.loads(run.stdout)['views']:
        for role in roles:
            check(view['roles'][role], f'{name}: {role} is not found in view {view["name"]!r}')


@cases(['blender_depth_RGBA', 'blender_scene_depth_RGBA', 'dibr_depth.0000', 'depth_BGR'])
def grey_depth_is_taken_by_its_name_or_that_of_its_file(scratch, name):
    for options, is_guessed in (((), True), (('--depth', 'R'), False)):
        found = json.loads(scratch.run('inspect', path(name), *options, '--fov', 40,
                                       '--json').stdout)['views'][0]
        check(found['verdict']['can_be_processed'], str(found))
        check(found['conventions']['max_z'] < 1000, 'the background counts')
        equal("'R' of its grey image" in str(found['warnings']), is_guessed, 'whether it is said')


if __name__ == '__main__':
    main()
