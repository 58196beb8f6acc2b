/* SPDX-License-Identifier: MIT
 *
 * Noise from texel coordinates: no textures, no uploads. All of it starts in 32-bit integers, so that any machine
 * gets the same bits however large the image is. */
#ifndef VKAO_NOISE_GLSL_
#define VKAO_NOISE_GLSL_

const float GOLDEN_ANGLE = 2.39996322972865332;
const float TWO_PI = 6.28318530717958648;

/* The upper 24 bits as a number in [0,1). */
float unit_float(uint bits)
{
    return float(int(bits >> 8)) * (1.0 / 16777216.0);
}

/* Interleaved gradient noise (Jimenez 2014), 0.06711056 and 0.00583715 in 32-bit fixed point; the frame moves the
 * pattern by 5.588238 texels along both axes. */
float interleaved_gradient_noise(uvec2 texel, uint index)
{
    uint phase = texel.x * 288237660u + texel.y * 25070368u + index * 1750839832u;
    return fract(52.9829189 * unit_float(phase));
}

/* The R2 sequence (Roberts 2018) laid out as a plane: 1/g and 1/g^2 of the plastic number g in fixed point. */
float r2_noise(uvec2 texel, uint index)
{
    return unit_float(texel.x * 3242174889u + texel.y * 2447445414u + index * 2654435769u);
}

/* cos and sin of pi u, u in [0,1): off by less than 7e-6. The exact ones cost a driver in software ten times that. */
Real2 half_turn(real u)
{
    real v = u - 0.5, v2 = v * v;
    real s = v * (3.14158202 + v2 * (-5.16714276 + v2 * (2.54189872 - 0.55463536 * v2)));
    real c = 0.99999329 + v2 * (-4.93393798 + v2 * (4.04128334 - 1.22212545 * v2));
    return Real2(-s, c);
}

/* cos and sin of 2 pi u. */
Real2 full_turn(real u)
{
    Real2 half_way = half_turn(u);
    return Real2(half_way.x * half_way.x - half_way.y * half_way.y, 2.0 * half_way.x * half_way.y);
}

/* The golden ratio sequence, in fixed point. */
float golden_sequence(uint i)
{
    return unit_float(i * 2654435769u);
}

#endif
