/* SPDX-License-Identifier: MIT
 *
 * Noise from texel coordinates: no textures, no uploads. All of it starts in 32-bit integers, so
 * that any machine gets the same bits however large the image is. */
#ifndef VKAO_NOISE_GLSL_
#define VKAO_NOISE_GLSL_

#include "real.glsl"

const float GOLDEN_ANGLE = 2.39996322972865332;
const float TWO_PI = 6.28318530717958648;

/* The upper 24 bits as a number in [0,1). */
float unit_float(uint bits)
{
    return float(int(bits >> 8)) * (1.0 / 16777216.0);
}

/* The turn of a texel's directions, x, and what its samples are moved by, y, both in [0,1). Their
 * first digits in base 4 are w x + y and w^2 x + y in the field of 4 elements, {0, 1, w, w^2}:
 * Latin squares, tiles of 4 by 4 texels, every row and every column of which has each digit, so
 * that the few texels of something thin turn far as well. What follows climbs by 1/g from row to
 * row in turns, g being the plastic number, and is the other's digit in moves, which count down.
 * Blurs take the mean of a tile (see blur_weight): nothing of the pattern is left where a surface
 * goes on.
 *
 * With 4 slices a block of 2 by 2 texels has 16 directions, and a smaller blur will do; an eighth
 * of a share off the axes they still hit the middle of most texels in a row, and do not follow an
 * edge along it.
 *
 * Frames step along the R2 sequence (Roberts 2018): 1/g and 1/g^2 in fixed point. */
vec2 tile_noise(uvec2 texel, uint slices, uint index)
{
    uvec2 at = slices < 4u ? texel : texel & 1u;
    /* w x, of x = 0 to 3, is 0, 2, 3, 1, and so on. Of all these the last two bits count. */
    uint first = 0x78787878u >> (2u * at.x & 31u) ^ at.y, second = first ^ at.x;
    uint turn = index * 3242174889u, jitter = index * 2447445414u;
    if (slices < 4u) {
        turn += (first << 30) + (texel.y * 3242174889u >> 2);
        jitter += 0xf8000000u;
        jitter -= second << 30 | (first & 3u) << 28;
    } else {
        turn += first << 30 | 1u << 27;
        jitter += 0xe0000000u - (second << 30);
    }
    return vec2(unit_float(turn), unit_float(jitter));
}

/* cos and sin of pi u, u in [0,1). The exact ones cost a driver in software ten times that. The
 * polynomials fit sin(pi v) and cos(pi v) over [-.5, .5] for the least largest error: 5.9e-7, with
 * the rounding of floats 7.5e-7, and 6.8e-6. */
real half_turn_x(real u)
{
    real v = u - 0.5, v2 = v * v;
    return -v * (3.14158202 + v2 * (-5.16714276 + v2 * (2.54189872 - 0.55463536 * v2)));
}

real half_turn_y(real u)
{
    real v = u - 0.5, v2 = v * v;
    return 0.99999329 + v2 * (-4.93393798 + v2 * (4.04128334 - 1.22212545 * v2));
}

/* The golden ratio sequence, in fixed point. */
float golden_sequence(uint i)
{
    return unit_float(i * 2654435769u);
}

#endif
