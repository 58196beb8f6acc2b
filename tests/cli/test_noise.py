#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""What the blur leaves of the noise's pattern on G-buffers of real renderers: spectra of flat,
shaded windows. The corpus lies outside the repository: without it the cases on it are skipped.

Slices turn with interleaved gradient noise, whose values climb by 53 steps over each period of a
phase, and steps are jittered by the R2 sequence. Whatever the scene makes of the two, a flat wall
shows it as waves k f1 + l f2: of the gradient for l = 0, of the sequence for k = 0, beats of both
otherwise. The scene goes out of the spectrum with the mean over several noise patterns; what that
takes of a wave is known."""
import numpy as np

from cli import case, cases, check, check_ao, corpus, main, read_ao, read_parts

GRADIENT = np.array((0.06711056, 0.00583715)) * 53  # f1, cycles per texel
SEQUENCE = np.array((0.7548776662, 0.5698402910))  # f2
WAVES = [(k, l) for k in range(9) for l in range(-8, 9)
         if (k > 0 or l > 0) and k + abs(l) <= 8]
# Their phases lie such that their mean takes at most .37 of the power of a wave along.
PATTERNS = (0, 8, 19, 35, 45, 52)

SIZE, STRIDE, WINDOWS = 64, 32, 16
RAISED_COSINE = np.sin(np.pi * (np.arange(SIZE) + 0.5) / SIZE) ** 2
WEIGHT = np.outer(RAISED_COSINE, RAISED_COSINE)

# What may be left of a wave, as its root mean square in units of AO. The steps of an 8-bit image
# hide half a step; beats may be slower than the blur is wide, and get a step. Against its
# surroundings a wave still stands out then, because the blur has weakened both alike: the ratio is
# printed, and not asked for.
STEP = 1 / 255
OWN_LIMIT, BEAT_LIMIT = 0.5 * STEP, 1 * STEP
QUALITIES = 'default', 'fast'

MITSUBA = 'dd.y.T', 'nn.'
BLENDER = 'ViewLayer.Depth.Z', 'ViewLayer.Normal.'
IMAGES = {'m3_statues_a': MITSUBA, 'b5_suzannes_a': BLENDER, 'm3_sponza_a': MITSUBA,
          'b5_furniture_ao256': BLENDER}


# --- Waves ---

def wrap(frequency):
    return (np.asarray(frequency) + 0.5) % 1 - 0.5


def frequencies(k, l, half):
    """Of a wave; upsampling mirrors those of half resolution."""
    once = wrap(k * GRADIENT + l * SEQUENCE)
    return [wrap((once + (i, j)) / 2) for i in (0, 1) for j in (0, 1)] if half else [once]


def left_by_mean(k, l):
    """Share of a wave's power that stays when the mean over the patterns is taken out: a pattern is
    the same noise at another phase, as in shaders/noise.glsl."""
    phases = [k * 52.9829189 * (n * 1750839832 / 2**32 % 1) + l * (n * 2654435769 / 2**32)
              for n in PATTERNS]
    return 1 - abs(np.exp(2j * np.pi * np.array(phases)).mean()) ** 2


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
    """The largest of the noise's own waves and of the beats, and by how much a wave stands out."""

    def __init__(self, spectrum, half):
        self.own = self.beat = self.ratio = 0.0
        for k, l in WAVES:
            for frequency in frequencies(k, l, half):
                top, median = peak(spectrum, frequency)
                size = rms(max(0, top - median) / left_by_mean(k, l))
                if k == 0 or l == 0:
                    self.own = max(self.own, size)
                else:
                    self.beat = max(self.beat, size)
                self.ratio = max(self.ratio, top / median)

    def __str__(self):
        return (f'own {self.own / STEP:.2f}/255, beats {self.beat / STEP:.2f}/255, '
                f'peak to surroundings {self.ratio:.0f}')


# --- Windows ---

def is_flat(depth, normals):
    mean = normals.mean((0, 1))
    if not (depth > 0).all() or not (depth < 1e9).all() or not mean.any():
        return False
    inverse = 1 / depth
    bend = max(np.abs(np.diff(inverse, 2, axis)).max() for axis in (0, 1)) / inverse.mean()
    return (normals @ (mean / np.linalg.norm(mean))).min() > 0.99 and bend < 1e-3


def flat_windows(name, ao):
    """The darkest ones: an open wall has nothing to show a pattern in."""
    channels = {c: v for part in read_parts(corpus(f'{name}.exr')) for c, v in
                part.channels.items()}
    depth, normal = IMAGES[name]
    depth = channels[depth].astype(np.float64)
    normals = np.stack([channels[normal + axis] for axis in 'XYZ'], -1).astype(np.float64)
    windows = [(slice(y, y + SIZE), slice(x, x + SIZE))
               for y in range(0, depth.shape[0] - SIZE + 1, STRIDE)
               for x in range(0, depth.shape[1] - SIZE + 1, STRIDE)]
    flat = [w for w in windows if is_flat(depth[w], normals[w])]
    check(len(flat) >= WINDOWS, f'{name}: {len(flat)} flat windows')
    return sorted(flat, key=lambda w: ao[w].mean())[:WINDOWS]


def render(scratch, name, radius, *options):
    images = []
    for pattern in PATTERNS:
        scratch.render(corpus(f'{name}.exr'), '-o', 'ao.exr', '--camera',
                       corpus(f'{name}.camera.json'), '--radius', radius, '--pixel-type', 'float',
                       '--compression', 'none', '--overwrite', 'always', '--noise-index', pattern,
                       *options)
        images.append(read_ao(scratch.path('ao.exr')).astype(np.float64))
        check_ao(images[-1], name)
    return np.stack(images)


def spectrum_of(images, windows):
    residual = images - images.mean(0)
    parts = [residual[(slice(None), *w)] for w in windows]
    # The level of a window would pass for a slow wave.
    levels = [(p * WEIGHT).sum((1, 2), keepdims=True) / WEIGHT.sum() for p in parts]
    return np.mean([power(p - level).mean(0) for p, level in zip(parts, levels)], axis=0)


# --- Cases ---

@case
def the_noise_is_where_it_is_looked_for(_):
    """Its own spectrum, from the definition: the highest peaks are the first waves."""
    x, y = np.arange(SIZE, dtype=np.uint64)[None, :], np.arange(SIZE, dtype=np.uint64)[:, None]
    for words, factor, first in (((288237660, 25070368), 52.9829189, GRADIENT),
                                 ((3242174889, 2447445414), 1, SEQUENCE)):
        phase = (x * words[0] + y * words[1]) % 2**32 / 2**32
        noise = factor * phase % 1
        spectrum = power(noise - noise.mean())
        for n in (1, 2, 3):
            top, median = peak(spectrum, wrap(n * first))
            print(f'  wave {n}: {np.round(wrap(n * first), 3)} RMS {rms(top):.3f}, '
                  f'{top / median:.0f} times its surroundings')
            # A sawtooth's n-th harmonic has the amplitude 1 / (n pi); bins cost up to 15 % of it.
            check(0.8 < rms(top) * np.sqrt(2) * np.pi * n < 1.05, f'wave {n} of the noise')
        check(spectrum.max() == peak(spectrum, wrap(first))[0], 'the highest peak is elsewhere')


@cases([(f'{name} {quality}', name, quality) for name in IMAGES for quality in QUALITIES])
def no_pattern_of_the_noise_is_left(scratch, _, name, quality):
    radius = f'{read_parts(corpus(f"{name}.gt.exr"))[0].attributes["aoRadius"]:.6g}'
    options = '--quality', quality
    blurred, noisy = render(scratch, name, radius, *options), \
        render(scratch, name, radius, *options, '--blur', 0)
    windows = flat_windows(name, blurred.mean(0))
    before = Waves(spectrum_of(noisy, windows), quality == 'fast')
    after = Waves(spectrum_of(blurred, windows), quality == 'fast')
    print(f'  {name} {quality}: noisy: {before}; blurred: {after}')
    check(before.ratio > 20, 'the noise shows no pattern before the blur: it is looked for amiss')
    check(after.own <= OWN_LIMIT, f'{after.own:.5f} is left of a wave of the noise, '
          f'want <= {OWN_LIMIT:.5f}')
    check(after.beat <= BEAT_LIMIT, f'{after.beat:.5f} is left of a beat, want <= {BEAT_LIMIT:.5f}')


if __name__ == '__main__':
    main()
