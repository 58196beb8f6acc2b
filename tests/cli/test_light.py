#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""What --mode comp does with light that is known apart, and what mattes leave out."""
import json

import numpy as np

from cli import (CHANNELS, OK, USAGE, case, cases, check, check_close, equal, main, matches,
                 read_ao, read_parts, write_exr)
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


@cases([('--holdout', 'A'), ('--no-cast', 'A'), ('--holdout', 'mask')], name='.'.join)
def the_only_channel_of_a_layer_is_the_matte(scratch, option, component):
    matte = (SCENE.z < 5).astype(np.float32)
    scene_file(scratch, **{f'logo.{component}': matte})
    results = []
    for name in (f'logo.{component}', 'logo'):
        said = scratch.render('in.exr', '-o', 'x.exr', *VIEW, option, name).stderr
        check('matte' not in said, said)
        results.append(read_ao(scratch.path('x.exr')))
    check_close(*results, 0, 0, 'AO by its layer')


@case
def the_channel_of_a_coloured_matte_is_said(scratch):
    scene_file(scratch, matte=layer('id', SCENE.z < 5))
    for name, is_said in (('id', True), ('id.R', False)):
        said = scratch.render('in.exr', '-o', 'x.exr', *VIEW, '--holdout', name).stderr
        equal("--holdout 'id' is a layer of several channels: 'id.R' is taken" in said, is_said,
              f'whether it is in {said}')


@cases([('8 bits', 255 * (SCENE.z < 5), r'is above 1 at \d+ % of the image, up to 255'),
        ('depth', np.where(SCENE.sky, 1e10, SCENE.z), 'is above 1 at .*: a depth'),
        ('NaN', np.full_like(SCENE.z, np.nan), 'has no number anywhere'),
        ('normals', -SCENE.normal[..., 2], 'is negative at .*: a component of normals')],
       name=lambda row: row[0])
def what_is_no_matte_is_said(scratch, _, values, warning):
    scene_file(scratch, odd=values.astype(np.float32))
    for option in ('--holdout', '--no-cast'):
        said = scratch.render('in.exr', '-o', 'x.exr', *VIEW, option, 'odd').stderr
        matches(f"warning: in.exr: {option} 'odd' {warning}", said, 'stderr')
    matches(f"warning .*'odd' {warning}",
            scratch.run('inspect', 'in.exr', *VIEW[:2], '--holdout', 'odd').stdout, 'inspect')


SURFACE = ~SCENE.sky
# Outlines, two texels wide, of an alpha that is filtered.
OUTLINE = SURFACE & (np.roll(SCENE.sky, 1, 0) | np.roll(SCENE.sky, 2, 0))
NEAR = SCENE.z < 5
BALL = NEAR & (np.abs(SCENE.normal[..., 1]) < 0.99)
ALL, NOTHING = r'covers 100 % of the surface.*: an alpha\? Name the matte', \
    'covers nothing of the surface.*: it changes nothing'
# Values, and what is said of --holdout and of --no-cast.
COVERAGES = [('alpha', SURFACE, ALL, ALL),
             ('filtered alpha', np.where(OUTLINE, 0.3, SURFACE), *(2 * (r'covers 9\d % of the',))),
             ('nothing', 0 * SURFACE, NOTHING, NOTHING), ('the sky', SCENE.sky, NOTHING, NOTHING),
             ('less than half', 0.4 * SURFACE, None, 'covers nothing .* by half or more: it'),
             ('near things', NEAR, None, None), ('far things', SURFACE & ~NEAR, None, None),
             ('all but the ball', SURFACE & ~BALL, None, None)]


def told_of_surface(scratch, *options):
    said = scratch.run('inspect', 'in.exr', '--fov', FOV, *options)
    equal(said.code, OK, str(said))
    return [line for line in said.stdout.splitlines() if 'of the surface' in line]


@cases(COVERAGES)
def mattes_of_all_or_nothing_are_said(scratch, _, values, of_holdout, of_no_cast):
    write_exr(scratch.path('in.exr'), {'Z': SCENE.depth(), **SCENE.normals(),
                                       'matte': values.astype(np.float32)})
    for option, wanted in ('--holdout', of_holdout), ('--no-cast', of_no_cast):
        said = told_of_surface(scratch, option, 'matte')
        equal(len(said), 1 if wanted else 0, f'warnings in {said}')
        if wanted:
            matches(f"warning +in.exr: {option} 'matte' {wanted}", said[0], 'the warning')
    both = told_of_surface(scratch, '--holdout', 'matte', '--no-cast', 'matte')
    equal(len(both), (of_holdout is not None) + (of_no_cast is not None), f'warnings in {both}')


@cases([(option, name) for option in ('--holdout', '--no-cast') for name in ('Z', 'N.Y')],
       name=' '.join)
def depth_and_normals_are_no_mattes(scratch, option, name):
    scene_file(scratch)
    what = 'the depth itself' if name == 'Z' else 'a component of the normals'
    scratch.fails(CHANNELS, f"{option} '{name}' is {what}", 'in.exr', '-o', 'x.exr', option, name)


# --- Cryptomatte ---

def murmur3(name):
    """MurmurHash3_x86_32 of the UTF-8 name."""
    def mix(word):
        word = word * 0xcc9e2d51 & 0xffffffff
        return (word << 15 | word >> 17) * 0x1b873593 & 0xffffffff
    data, h = name.encode(), 0
    whole = len(data) // 4 * 4
    for i in range(0, whole, 4):
        h ^= mix(int.from_bytes(data[i:i + 4], 'little'))
        h = ((h << 13 | h >> 19) & 0xffffffff) * 5 + 0xe6546b64 & 0xffffffff
    h ^= mix(int.from_bytes(data[whole:], 'little')) ^ len(data)
    for shift, factor in ((16, 0x85ebca6b), (13, 0xc2b2ae35), (16, 1)):
        h = (h ^ h >> shift) * factor & 0xffffffff
    return h


def identifier(name):
    bits = murmur3(name)
    if bits >> 23 & 255 in (0, 255):
        bits ^= 1 << 23
    return np.uint32(bits).view(np.float32)


OBJECTS = {'ball': BALL * np.float32(0.75), 'küche/floor': (~BALL & ~SCENE.sky) * np.float32(1),
           'dust': BALL * np.float32(0.25)}


def crypto(layer='CryptoObject', letters='RGBA'):
    """Two ranks in one layer: ball or floor first, what is left behind it."""
    ball, floor, dust = (np.where(OBJECTS[n] > 0, identifier(n), 0) for n in OBJECTS)
    planes = (ball + floor, OBJECTS['ball'] + OBJECTS['küche/floor'], dust, OBJECTS['dust'])
    return {f'{layer}00.{c}': p.astype(np.float32) for c, p in zip(letters, planes)}


def crypto_attributes(layer='CryptoObject', manifest=True):
    rows = [('name', layer), ('hash', 'MurmurHash3_32'), ('conversion', 'uint32_to_float32')]
    if manifest:
        rows.append(('manifest', json.dumps({n: f'{murmur3(n):08x}' for n in OBJECTS})))
    return [(f'cryptomatte/6b4a1c2/{key}', value) for key, value in rows]


@case
def hash_is_murmur3(_):
    equal(f'{murmur3("hello"):08x}', '248bfa47', 'hash of hello')


@cases([('RGBA', 'RGBA', 'CryptoObject', True), ('words', ('red', 'green', 'blue', 'alpha'),
                                                 'ViewLayer.CryptoAsset', True),
        ('small, no manifest', 'rgba', 'crypto_material', False)])
def objects_are_named_by_cryptomatte(scratch, _, letters, layer, manifest):
    planes = {**COLOR, 'Z': SCENE.depth(), **SCENE.normals(), **crypto(layer, letters)}
    write_exr(scratch.path('in.exr'), planes, attributes=crypto_attributes(layer, manifest))
    scratch.render('in.exr', '-o', 'ao.exr', *VIEW)
    ao = read_ao(scratch.path('ao.exr'))
    check((ao[BALL] < 0.9).any(), 'nothing to hold out')
    for names in (('ball',), ('küche/floor',), ('ball', 'dust'), ('küche/floor', 'ball')):
        scratch.render('in.exr', '-o', 'held.exr', *VIEW, '--holdout', f'crypto:{",".join(names)}')
        matte = sum(OBJECTS[n] for n in names)
        check_close(read_ao(scratch.path('held.exr')), 1 - (1 - ao) * (1 - matte), 1e-6, 1e-7,
                    f'{names}')


@case
def commas_in_names_of_objects_are_escaped(scratch):
    names, covered = ('ball, red', 'a\\b'), (BALL, OBJECTS['küche/floor'] > 0)
    planes = {f'CryptoObject00.{c}': p.astype(np.float32) for c, p in
              zip('RG', (sum(np.where(c, identifier(n), 0) for n, c in zip(names, covered)),
                         sum(covered)))}
    manifest = json.dumps({n: f'{murmur3(n):08x}' for n in names})
    write_exr(scratch.path('in.exr'), {**COLOR, 'Z': SCENE.depth(), **planes},
              attributes=[*crypto_attributes(manifest=False),
                          ('cryptomatte/6b4a1c2/manifest', manifest)])
    for given, matte in ((r'ball\, red', covered[0]), (r'ball\, red,a\b', sum(covered))):
        scratch.render('in.exr', '-o', 'held.exr', *VIEW, '--holdout', f'crypto:{given}')
        check((read_ao(scratch.path('held.exr'))[matte > 0] == 1).all(), f'{given} has AO')
    scratch.fails(CHANNELS, "no object 'ball'", 'in.exr', '-o', 'x.exr', '--holdout',
                  'crypto:ball, red', hint=r'there are ball\\, red, ')
    scratch.fails(CHANNELS, "no object 'x{511}'", 'in.exr', '-o', 'x.exr', '--holdout',
                  'crypto:' + 'x' * 600)


@case
def cryptomatte_may_be_a_part_and_objects_need_not_cast(scratch):
    parts = ({**COLOR, 'Z': SCENE.depth(), **SCENE.normals()}, {'name': 'beauty'}), \
        ({k[-1]: v for k, v in crypto().items()}, {'name': 'CryptoObject00'})
    write_exr(scratch.path('in.exr'), *parts, attributes=crypto_attributes())
    scratch.render('in.exr', '-o', 'crypto.exr', *VIEW, '--no-cast', 'crypto:ball')
    write_exr(scratch.path('in.exr'), {**COLOR, 'Z': SCENE.depth(), **SCENE.normals(),
                                       'matte': OBJECTS['ball']})
    scratch.render('in.exr', '-o', 'matte.exr', *VIEW, '--no-cast', 'matte')
    check_close(read_ao(scratch.path('crypto.exr')), read_ao(scratch.path('matte.exr')), 0, 0, 'AO')


@case
def objects_that_are_not_there_are_said(scratch):
    planes = {**COLOR, 'Z': SCENE.depth()}
    line = ('in.exr', '-o', 'x.exr', '--fov', FOV, '--holdout')
    write_exr(scratch.path('in.exr'), planes)
    scratch.fails(CHANNELS, r"in\.exr: no Cryptomatte, which 'crypto:ball' needs", *line,
                  'crypto:ball')
    write_exr(scratch.path('in.exr'), {**planes, **crypto()}, attributes=crypto_attributes())
    scratch.fails(CHANNELS, r"in\.exr: no object 'bell' in its Cryptomatte", *line, 'crypto:bell',
                  hint='there are ball, ')
    scratch.fails(CHANNELS, r"names no object", *line, 'crypto:,')
    with np.errstate(over='ignore'):
        halves = {k: v.astype(np.float16) for k, v in crypto().items()}
    write_exr(scratch.path('in.exr'), {**planes, **halves}, attributes=crypto_attributes())
    scratch.fails(CHANNELS, r"'CryptoObject00\.[RB]' is not stored as 32-bit floats", *line,
                  'crypto:ball')


@case
def objects_without_a_manifest_may_cover_nothing(scratch):
    write_exr(scratch.path('in.exr'), {'Z': SCENE.depth(), **SCENE.normals(), **crypto()},
              attributes=crypto_attributes(manifest=False))
    run = scratch.render('in.exr', '-o', 'ao.exr', *VIEW, '--holdout', 'crypto:bell')
    matches(r"warning: in\.exr: --holdout 'crypto:bell' covers nothing", run.stderr, 'stderr')


@cases([('--holdout',), ('--no-cast',)])
def objects_that_are_all_there_is_are_said(scratch, option):
    write_exr(scratch.path('in.exr'), {'Z': SCENE.depth(), **SCENE.normals(), **crypto()},
              attributes=crypto_attributes())
    for names, is_said in (('ball,küche/floor,dust', True), ('ball,dust', False)):
        said = told_of_surface(scratch, option, f'crypto:{names}')
        equal(len(said), is_said, f'warnings in {said}')
        if is_said:
            matches(f"{option} 'crypto:{names}' covers 100 % .*: name fewer objects", said[0], 'it')


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
