/* SPDX-License-Identifier: MIT
 *
 * Integrals of gtao over the angles between two horizons h0 < h1, in a slice whose normal lies at
 * angle n (Jimenez et al. 2016, equation 7 and algorithm 2). */
#ifndef VKAO_ARC_GLSL_
#define VKAO_ARC_GLSL_

#include "real.glsl"

/* (cos n + 2 h sin n - cos(2h - n)) / 4 */
real arc_side(real h, real n, real cos_n, real sin_n)
{
    return 0.25 * (cos_n + 2.0 * h * sin_n - cos(2.0 * h - n));
}

/* Of the open slice, what lies outside the horizons. */
real arc_lost(real h0, real h1, real n, real cos_n, real sin_n)
{
    return cos_n + n * sin_n - (arc_side(h0, n, cos_n, sin_n) + arc_side(h1, n, cos_n, sin_n));
}

/* Bent normal along O. */
real arc_outward(real h0, real h1, real n)
{
    return (6.0 * sin(h0 - n) - sin(3.0 * h0 - n) + 6.0 * sin(h1 - n) - sin(3.0 * h1 - n) +
            16.0 * sin(n) - 3.0 * (sin(h0 + n) + sin(h1 + n))) /
           12.0;
}

/* And along V. */
real arc_to_eye(real h0, real h1, real n)
{
    return (-cos(3.0 * h0 - n) - cos(3.0 * h1 - n) + 8.0 * cos(n) -
            3.0 * (cos(h0 + n) + cos(h1 + n))) /
           12.0;
}

#endif
