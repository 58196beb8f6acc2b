#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""What the blur leaves of the noise's pattern on G-buffers of real renderers: spectra of flat,
shaded windows. The corpus lies outside the repository: without it the cases on it are skipped.

Digits of the noise repeat after four texels, and turns climb by a quarter of 1/g from row to row.
Whatever the scene makes of that, a flat wall shows as waves (i / 4, j / 4 + k / 4g); those along a
column, i = 0, are mixtures of turns and moves. The scene goes out of the spectrum with the mean
over several noise patterns."""
import json
import os
from functools import lru_cache

import numpy as np

from cli import cases, check, check_ao, corpus, main, read_ao, read_parts, write_exr

TILE, CLIMB = 4, 1 / 1.32471795724474602596 / 4
WAVES = [(i / TILE, j / TILE + k * CLIMB, i > 0 or k == 0) for k in range(-3, 4)
         for i in range(TILE) for j in range(TILE) if i or j or k]
# Before the blur they are plain to see in a few. Of a render that names none it is the first.
PATTERNS, NOISY_PATTERNS = range(8), range(3)

SIZE, STRIDE, WINDOWS = 64, 32, 16
RAISED_COSINE = np.sin(np.pi * (np.arange(SIZE) + 0.5) / SIZE) ** 2
WEIGHT = np.outer(RAISED_COSINE, RAISED_COSINE)

# What may be left of a wave, as its root mean square in units of AO: of the noise's own a part of
# what the steps of an 8-bit image hide; mixtures are weak from the start, but may be slower than
# the blur is wide.
STEP = 1 / 255
OWN_LIMIT, MIXED_LIMIT = 0.2 * STEP, 1 * STEP
QUALITIES = 'default', 'fast'

MITSUBA = 'dd.y.T', 'nn.'
BLENDER = 'ViewLayer.Depth.Z', 'ViewLayer.Normal.'
IMAGES = {'m3_statues_a': MITSUBA, 'b5_suzannes_a': BLENDER, 'm3_sponza_a': MITSUBA,
          'b5_furniture_ao256': BLENDER}


# --- Waves ---

def wrap(frequency):
    return (np.asarray(frequency) + 0.5) % 1 - 0.5


def frequencies(x, y, half):
    """Of a wave; upsampling mirrors those of half resolution."""
    wave = np.array((x, y))
    return [wrap((wave + (i, j)) / 2) for i in (0, 1) for j in (0, 1)] if half else [wrap(wave)]


def power(images):
    return np.abs(np.fft.fft2(images * WEIGHT)) ** 2


def rms(power_of_wave):
    """Of the wave whose power under the window this is."""
    return np.sqrt(2 * power_of_wave) / WEIGHT.sum()


def peak(spectrum, frequency):
    """Power at a frequency, give or take a bin, and the median around it."""
    x, y = (int(round(f * SIZE)) for f in frequency)
    there = np.roll(spectrum, (-y, -x), (0, 1))
    bins = np.fft.fftfreq(SIZE, 1 / SIZE)
    distance = np.hypot(*np.meshgrid(bins, bins))
    around = (distance > 3) & (distance <= 7)
    return there[distance < 1.5].max(), np.median(there[around])


class Waves:
    """The largest of the noise's own waves and of the mixtures, and by how much one of its own
    stands out."""

    def __init__(self, spectrum, half):
        self.own = self.mixed = self.ratio = 0.0
        for x, y, own in WAVES:
            for frequency in frequencies(x, y, half):
                top, median = peak(spectrum, frequency)
                size = rms(max(0, top - median))
                if own:
                    self.own = max(self.own, size)
                    self.ratio = max(self.ratio, top / median)
                else:
                    self.mixed = max(self.mixed, size)

    def __str__(self):
        return (f'own {self.own / STEP:.3f}/255, mixed {self.mixed / STEP:.2f}/255, '
                f'peak to surroundings {self.ratio:.1f}')


# --- Windows ---

def is_flat(depth, normals):
    mean = normals.mean((0, 1))
    if not (depth > 0).all() or not (depth < 1e9).all() or not mean.any():
        return False
    inverse = 1 / depth
    bend = max(np.abs(np.diff(inverse, 2, axis)).max() for axis in (0, 1)) / inverse.mean()
    return (normals @ (mean / np.linalg.norm(mean))).min() > 0.99 and bend < 1e-3


@lru_cache(1)
def planes_of(name):
    """Depth and normals, by their names in the file."""
    depth, normal = IMAGES[name]
    wanted = depth, *(normal + axis for axis in 'XYZ')
    parts = read_parts(corpus(f'{name}.exr'), wanted)
    return {c: v for part in parts for c, v in part.channels.items()}


@lru_cache(1)
def flat_windows(name):
    depth, *normals = (v.astype(np.float64) for v in planes_of(name).values())
    normals = np.stack(normals, -1)
    windows = [(slice(y, y + SIZE), slice(x, x + SIZE))
               for y in range(0, depth.shape[0] - SIZE + 1, STRIDE)
               for x in range(0, depth.shape[1] - SIZE + 1, STRIDE)]
    flat = [w for w in windows if is_flat(depth[w], normals[w])]
    check(len(flat) >= WINDOWS, f'{name}: {len(flat)} flat windows')
    return flat


def darkest(windows, ao):
    """An open wall has nothing to show a pattern in."""
    return sorted(windows, key=lambda w: ao[w].mean())[:WINDOWS]


def render_patterns(scratch, patterns, *options):
    """Frames of one run, which finds out about them and compiles once: what ao.exr was made with,
    but for the options. What frames do not share lies in records of their own."""
    record = json.loads(read_parts(scratch.path('ao.exr'))[0].attributes['vkao/params'])
    for pattern in patterns:
        record['parameters']['noise_index'] = pattern
        write_exr(scratch.path(f'like.{pattern}.exr'), {'R': np.zeros((1, 1), np.float32)},
                  attributes=[('vkao/params', json.dumps(record))])
        if not os.path.exists(scratch.path(f'in.{pattern}.exr')):
            os.link(scratch.path('in.exr'), scratch.path(f'in.{pattern}.exr'))
    scratch.render('in.@.exr', '-o', 'ao.@.exr', '--like', 'like.@.exr', '--overwrite', 'always',
                   '--frames', f'{patterns[0]}-{patterns[-1]}', *options)
    return [read_ao(scratch.path(f'ao.{pattern}.exr')) for pattern in patterns]


def stacked(images, name):
    for i, image in enumerate(images):
        check_ao(image, name)
        check(i == 0 or (image != images[0]).any(), f'{name}: patterns of frames are the same')
    return np.stack(images).astype(np.float64)


def spectrum_of(images, windows):
    residual = images - images.mean(0)
    parts = [residual[(slice(None), *w)] for w in windows]
    # The level of a window would pass for a slow wave.
    levels = [(p * WEIGHT).sum((1, 2), keepdims=True) / WEIGHT.sum() for p in parts]
    return np.mean([power(p - level).mean(0) for p, level in zip(parts, levels)], axis=0)


# --- Cases ---

@cases([(f'{name} {quality}', name, quality) for name in IMAGES for quality in QUALITIES])
def no_pattern_of_the_noise_is_left(scratch, _, name, quality):
    radius = f'{read_parts(corpus(f"{name}.gt.exr"))[0].attributes["aoRadius"]:.6g}'
    # Of many images of it, what is not needed need not be unpacked.
    write_exr(scratch.path('in.exr'), planes_of(name), compression='none')
    scratch.render('in.exr', '-o', 'ao.exr', '--camera', corpus(f'{name}.camera.json'), '--radius',
                   radius, '--pixel-type', 'float', '--compression', 'none', '--quality', quality)
    first = read_ao(scratch.path('ao.exr'))
    blurred = stacked([first, *render_patterns(scratch, PATTERNS[1:])], name)
    noisy = stacked(render_patterns(scratch, NOISY_PATTERNS, '--blur', 0), name)
    windows = darkest(flat_windows(name), blurred.mean(0))
    before = Waves(spectrum_of(noisy, windows), quality == 'fast')
    after = Waves(spectrum_of(blurred, windows), quality == 'fast')
    print(f'  {name} {quality}: noisy: {before}; blurred: {after}')
    check(before.own > 20 * after.own, 'it is looked for amiss, or not blurred away')
    check(after.own <= OWN_LIMIT, f'{after.own:.5f} is left of a wave, want <= {OWN_LIMIT:.5f}')
    check(after.mixed <= MIXED_LIMIT,
          f'{after.mixed:.5f} is left of a mixture, want <= {MIXED_LIMIT:.5f}')


if __name__ == '__main__':
    main()
