#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""The fits in the shaders are as close as their comments say. All numbers come from there."""
import math
import os
import re
import sys

SHADERS = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..', 'shaders')
STEPS = 4000
failures = 0


def text_of(name):
    with open(os.path.join(SHADERS, name), encoding='utf-8') as file:
        return re.sub(r'\n \* ', ' ', file.read())


def numbers(pattern, text, name):
    match = re.search(pattern, text)
    if not match:
        sys.exit(f'{name}: nothing like /{pattern}/: has the fit moved?')
    return [float(group) for group in match.groups()]


def span(low, high, steps=STEPS):
    return [low + (high - low) * i / steps for i in range(steps + 1)]


def check(what, error, stated):
    """No larger than stated, and not so much smaller that the comment misleads."""
    global failures
    holds = 0.9 * stated <= error <= stated
    failures += not holds
    print(f'{what}: largest error {error:.3g}, stated {stated:g}{"" if holds else ": FAILED"}')


def half_turn():
    text, number = text_of('noise.glsl'), r'(\d+\.\d+)'
    four = rf'{number} \+ v2 \* \(-{number} \+ v2 \* \({number} - {number}'
    s1, s3, s5, s7 = numbers(rf'return -v \* \({four}', text, 'noise.glsl')
    c0, c2, c4, c6 = numbers(rf'return {four}', text, 'noise.glsl')
    error = r'least largest error: (\S+), with the rounding of floats \S+, and (\S+)\. '
    of_sine, of_cosine = numbers(error, text, 'noise.glsl')

    def sine(v):
        return v * (s1 + v * v * (-s3 + v * v * (s5 - s7 * v * v)))

    def cosine(v):
        return c0 + v * v * (-c2 + v * v * (c4 - c6 * v * v))

    range_of_fit = span(-0.5, 0.5)
    check('half_turn, sine',
          max(abs(sine(v) - math.sin(math.pi * v)) for v in range_of_fit), of_sine)
    check('half_turn, cosine',
          max(abs(cosine(v) - math.cos(math.pi * v)) for v in range_of_fit), of_cosine)
    stated, = numbers(r'2 pi u, off by less than (\S+)\. ',
                      text_of('cpu/ssao_hemisphere.comp'), 'cpu/ssao_hemisphere.comp')
    turned = [(cosine(v), -sine(v), 2 * math.pi * (v + 0.5)) for v in range_of_fit]
    check('full_turn', max(max(abs(x * x - y * y - math.cos(a)), abs(2 * x * y - math.sin(a)))
                           for y, x, a in turned), stated)


def density_integral():
    text = text_of('sectors.glsl')
    g1, g3 = numbers(r'G1 = (\S+), G3 = (\S+);', text, 'sectors.glsl')
    stated, = numbers(r'largest error is (\S+)\. ', text, 'sectors.glsl')
    of_sector, = numbers(r'sector bound by (\S+) of a sector', text, 'sectors.glsl')

    def fitted(c):
        return c * (g1 + g3 * c * c)

    def exact(c):
        c = min(1, max(-1, c))
        return (c * math.sqrt(1 - c * c) + math.asin(c)) / 2

    check('g', max(abs(fitted(c) - exact(c)) for c in span(-1, 1)), stated)

    def bound(g, n, c):
        """In sectors, from the tangent plane on."""
        def mass(to):
            return math.cos(n) * to * to / 2 + math.sin(n) * g(to) - low
        low = math.cos(n) * math.sin(n) ** 2 / 2 + math.sin(n) * g(-math.sin(n))
        return 31 * mass(c) / mass(1)

    check('sector bounds',
          max(abs(bound(fitted, n, c) - bound(exact, n, c))
              for n in span(0, math.pi / 2, 60) for c in span(-math.sin(n), 1, 100)), of_sector)


def multi_bounce():
    text = text_of('composite.comp')
    a1, a0, b1, b0, c1, c0 = numbers(
        r'vec3 a = (\S+) \* albedo - (\S+), b = -(\S+) \* albedo \+ (\S+), '
        r'c = (\S+) \* albedo \+ (\S+);', text, 'composite.comp')
    stated, = numbers(r'within (\S+) of 1\. ', text, 'composite.comp')
    check('multi_bounce at 1',
          max(abs(a1 * p - a0 - b1 * p + b0 + c1 * p + c0 - 1) for p in span(0, 1)), stated)


half_turn()
density_integral()
multi_bounce()
sys.exit(failures > 0)
