/* SPDX-License-Identifier: MIT
 *
 * Cosine-weighted horizons (Jimenez et al. 2016, equation 7): per slice and side the horizon cosine is the largest over
 * the samples, each faded towards the tangent plane by the falloff; with h1, h0 the two horizon angles,
 *     slice = L * sum over both of (cos n + 2 h sin n - cos(2h - n)) / 4.
 * An open slice is L (cos n + n sin n), whose mean over the slices is 1: the occluded part alone is summed, so that an
 * open wall is exactly 1. The bent normal is algorithm 2 of the paper. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_shader_16bit_storage : enable
#extension GL_EXT_samplerless_texture_functions : require
#extension GL_EXT_control_flow_attributes : require
#define VKAO_GLSL
#include "params.h"
#define VKAO_SIDE_BY_SIDE
#include "ssao.glsl"
#include "horizon.glsl"

/* Cosines of the horizons. */
reals horizon_cosines(Slice s, ivec2 texel, real jitter)
{
    Steps steps = make_steps(s, jitter, params.radius);
    reals low = -SIDES * both(s.sin_n); /* cos(n +- pi/2): the tangent plane */
    reals horizon = low, open = low + params.bias_cosine;
    Offset next = step_offset(s, steps, 0u);
    reals next_z = load_sides(texel, next);
    uint t = 0u;
    [[unroll]] for (;;) {
        Offset offset = next;
        reals z = next_z, x, y;
        next = step_offset(s, steps, t + 1u);
        if (STEPS == 0u || t + 1u < STEPS)
            next_z = load_sides(texel, next);
        slice_points(s, offset, z, x, y);
        reals d2 = x * x + y * y;
        reals weight = mix(reals(0.0), falloff_weight(d2), greaterThan(z, reals(0.0)));
        /* In this order, as what is no number must not stay: greater() then gives the second. */
        horizon = greater(low + weight * (y * inversesqrt(d2) - open), horizon);
        if (++t >= step_count())
            break;
    }
    return clamp(horizon, reals(-1.0), reals(1.0));
}

real inner_integral(real h, real n, real cos_n, real sin_n)
{
    return 0.25 * (cos_n + 2.0 * h * sin_n - cos(2.0 * h - n));
}

/* Along O. */
real bent_outward(real h0, real h1, real n)
{
    return (6.0 * sin(h0 - n) - sin(3.0 * h0 - n) + 6.0 * sin(h1 - n) - sin(3.0 * h1 - n) + 16.0 * sin(n) -
            3.0 * (sin(h0 + n) + sin(h1 + n))) / 12.0;
}

/* Along V. */
real bent_to_eye(real h0, real h1, real n)
{
    return (-cos(3.0 * h0 - n) - cos(3.0 * h1 - n) + 8.0 * cos(n) - 3.0 * (cos(h0 + n) + cos(h1 + n))) / 12.0;
}

Visibility visibility(ivec2 texel, Real3 position, Real3 normal)
{
    Real3 to_eye = eye_direction(texel), bent = Real3(real(0.0), real(0.0), real(0.0));
    Noise noise = texel_noise(texel, slice_count());
    real lost = real(0.0);
    float share = 1.0 / float(slice_count());
    uint k = 0u;
    [[unroll]] for (;;) {
        Slice s = make_slice((float(k) + noise.turn) * share, position, normal, to_eye);
        reals cosines = horizon_cosines(s, texel, noise.jitter);
        real n = acos(s.cos_n);
        n = choose(-n, n, above(s.sin_n, real(0.0)));
        reals h = acos(cosines);
        real h1 = min(first_side(h), n + 0.5 * PI), h0 = max(-other_side(h), n - 0.5 * PI);
        real open = s.cos_n + n * s.sin_n;
        real seen = inner_integral(h0, n, s.cos_n, s.sin_n) + inner_integral(h1, n, s.cos_n, s.sin_n);
        lost += s.normal_length * (open - seen);
        if (BENT_NORMALS)
            bent = plus(bent, times(plus(times(s.outward, bent_outward(h0, h1, n)),
                                         times(to_eye, bent_to_eye(h0, h1, n))), s.normal_length));
        if (++k >= slice_count())
            break;
    }
    return Visibility(bent, 1.0 - lost * share);
}
