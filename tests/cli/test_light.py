#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""What --mode comp does with light that is known apart, and what mattes leave out."""
import numpy as np

from cli import (CHANNELS, USAGE, case, cases, check, check_close, equal, main, matches, read_ao,
                 read_parts, write_exr)
from exr_raw import read_raw
from scene import FOV, RADIUS, Scene

SCENE = Scene(96, 54)
VIEW = ('--fov', FOV, '--radius', RADIUS, '--normal-space', 'camera', '--pixel-type', 'float',
        '--overwrite', 'always')
COLOR = SCENE.color()


def layer(name, value):
    plane = np.broadcast_to(np.float32(value), SCENE.z.shape) * np.float32(1)
    return {f'{name}.{c}': plane * np.float32(k) for c, k in zip('RGB', (1, 0.5, 0.25))}


def scene_file(scratch, **more):
    planes = {**COLOR, 'Z': SCENE.depth(), **SCENE.normals()}
    for name, plane in more.items():
        planes |= plane if isinstance(plane, dict) else {name: plane}
    write_exr(scratch.path('in.exr'), planes)
    scratch.render('in.exr', '-o', 'ao.exr', *VIEW)
    return read_ao(scratch.path('ao.exr'))


def composite(scratch, *options):
    scratch.render('in.exr', '-o', 'comp.exr', '--mode', 'comp', *VIEW, *options)
    return read_parts(scratch.path('comp.exr'))[0]


@case
def indirect_light_alone_is_darkened(scratch):
    ao = scene_file(scratch, indirect=layer('gi', 0.1))
    comp = composite(scratch, '--indirect', 'gi')
    for c, k in zip('RGB', (1, 0.5, 0.25)):
        check_close(comp[c], COLOR[c] - 0.1 * k * (1 - ao), 1e-6, 1e-6, c)
    check_close(comp['A'], COLOR['A'], 0, 0, 'alpha')
    tinted = composite(scratch, '--indirect', 'gi', '--tint', '0.5,0,0', '--strength', 0.5)
    check_close(tinted['R'], COLOR['R'] - 0.1 * (1 - ao) * 0.25, 1e-6, 1e-6, 'tinted')


@case
def albedo_brightens_by_what_bounces(scratch):
    """Jimenez et al. 2016, by their polynomial."""
    ao = scene_file(scratch, albedo=layer('albedo', 0.8)).astype(np.float64)
    comp = composite(scratch, '--albedo', 'albedo')
    for c, k in zip('RGB', (0.8, 0.4, 0.2)):
        a, b, d = 2.0404 * k - 0.3324, -4.7951 * k + 0.6417, 2.7552 * k + 0.6903
        wanted = np.clip(np.maximum(ao, ((ao * a + b) * ao + d) * ao), 0, 1)
        check_close(comp[c], (COLOR[c] * wanted).astype(np.float32), 1e-4, 1e-5, c)


@case
def specular_light_has_a_factor_of_its_own(scratch):
    ao = scene_file(scratch, specular=layer('spec', 0.1), rough=np.full_like(SCENE.depth(), 1),
                    gloss=np.full_like(SCENE.depth(), 0.05))
    comp = composite(scratch, '--specular', 'spec', '--roughness', 'rough')
    open_texels, dark = (ao == 1), (ao < 0.8) & ~SCENE.sky
    check(dark.any(), 'nothing is dark')
    rest = (COLOR['R'] - 0.1) * ao
    factor = (comp['R'] - rest) / 0.1
    check_close(factor[open_texels], np.ones_like(factor)[open_texels], 1e-4, 1e-5, 'open')
    check((factor[dark] < 1 - 0.02).mean() > 0.9 and factor.min() > -1e-4,
          'specular light is not darkened')
    smooth = composite(scratch, '--specular', 'spec', '--roughness', 'gloss')
    check(np.abs(smooth['R'] - comp['R'])[dark].max() > 1e-3, 'roughness changes nothing')
    default = composite(scratch, '--specular', 'spec')
    check_close(default['R'], comp['R'], 1e-3, 1e-3, 'half rough')
    bent = composite(scratch, '--specular', 'spec', '--roughness', 'gloss', '--bent-normals')
    check(np.abs(bent['R'] - smooth['R'])[dark].max() > 1e-3, 'bent normals change nothing')


@case
def holdout_gets_none(scratch):
    matte = np.zeros_like(SCENE.depth())
    matte[:, 30:60], matte[:, 60:70] = 1, 0.5
    matte[0, 0], matte[0, 1] = np.nan, 7
    ao = scene_file(scratch, matte=matte)
    scratch.render('in.exr', '-o', 'held.exr', *VIEW, '--holdout', 'matte')
    held = read_ao(scratch.path('held.exr'))
    wanted = 1 - (1 - ao) * (1 - np.nan_to_num(matte).clip(0, 1))
    check((ao[:, 30:60] < 0.9).any(), 'nothing to hold out')
    check_close(held, wanted, 1e-6, 1e-7, 'AO')
    comp = composite(scratch, '--holdout', 'matte')
    check_close(comp['G'], COLOR['G'] * wanted, 1e-6, 1e-6, 'composite')


@case
def what_does_not_cast_is_background(scratch):
    matte = ((SCENE.z < 5) & (np.abs(SCENE.normal[..., 1]) < 0.99)).astype(np.float32)  # the ball
    ao = scene_file(scratch, matte=matte)
    scratch.render('in.exr', '-o', 'without.exr', *VIEW, '--no-cast', 'matte')
    without = read_ao(scratch.path('without.exr'))
    check((without[matte > 0] == 1).all(), 'AO of what is taken out is not 1')
    wanted = np.where(matte > 0, 1e10, SCENE.depth()).astype(np.float32)
    write_exr(scratch.path('hole.exr'), {**COLOR, 'Z': wanted, **SCENE.normals()})
    scratch.render('hole.exr', '-o', 'hole.ao.exr', *VIEW)
    check_close(without, read_ao(scratch.path('hole.ao.exr')), 0, 0, 'AO')
    check(np.abs(without - ao)[matte == 0].max() > 0.05, 'the ball still casts')


@case
def record_brings_them_back(scratch):
    scene_file(scratch, indirect=layer('gi', 0.1), albedo=layer('albedo', 0.8),
               matte=SCENE.depth() * 0 + np.float32(0.25))
    comp = composite(scratch, '--indirect', 'gi', '--albedo', 'albedo', '--holdout', 'matte')
    text = read_raw(scratch.bytes('comp.exr'))[0].text('vkao/params')
    for part in ('"indirect":"gi"', '"albedo":"albedo"', '"holdout":"matte"'):
        check(part in text, f'{part} is not in {text}')
    scratch.render('--like', 'comp.exr', 'in.exr', '-o', 'again.exr')
    for c in 'RGBA':
        check_close(read_parts(scratch.path('again.exr'))[0][c], comp[c], 0, 0, c)


@cases([('--indirect',), ('--albedo',), ('--specular',), ('--holdout',), ('--no-cast',)])
def missing_layers_are_named(scratch, option):
    scene_file(scratch)
    scratch.fails(CHANNELS, r"in\.exr: no (channel or )?layer 'nothing'", 'in.exr', '-o', 'x.exr',
                  '--mode', 'comp', option, 'nothing', '--fov', FOV)


@case
def wrong_uses_are_refused(scratch):
    scene_file(scratch, specular=layer('spec', 0.1))
    for option in ('--indirect', '--albedo', '--specular', '--roughness'):
        scratch.fails(USAGE, f'{option} needs --mode comp', 'in.exr', '-o', 'x.exr', option, 'spec')
    scratch.fails(USAGE, '--roughness needs --specular', 'in.exr', '-o', 'x.exr', '--mode', 'comp',
                  '--roughness', 'spec.R')
    scratch.fails(CHANNELS, '--specular needs normals', 'in.exr', '-o', 'x.exr', '--mode', 'comp',
                  '--specular', 'spec', '--normal', 'none', '--fov', FOV, hint='--normal')


@case
def inspect_tells_what_was_named(scratch):
    scene_file(scratch, indirect=layer('gi', 0.1))
    run = scratch.run('inspect', 'in.exr', '--indirect', 'gi', '--fov', FOV)
    equal(run.code, 0, 'exit code')
    matches(r'indirect +gi', run.stdout, 'stdout')


if __name__ == '__main__':
    main()
