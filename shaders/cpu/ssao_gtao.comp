/* SPDX-License-Identifier: MIT
 *
 * ../ssao_gtao.comp for two texels side by side: each sample is loaded one step ahead. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_shader_16bit_storage : enable
#extension GL_EXT_samplerless_texture_functions : require
#extension GL_EXT_control_flow_attributes : require
#define VKAO_GLSL
#include "params.h"
#include "ssao.glsl"
#include "horizon.glsl"
#include "arc.glsl"

/* Cosines of the horizons. */
reals horizon_cosines(Slice s, ivec2 texel, real jitter)
{
    Steps steps = make_steps(s, jitter, params.radius, VKAO_STEP_LINEAR);
    reals low = -SIDES * both(s.sin_n); /* cos(n +- pi/2): the tangent plane */
    reals horizon = low, open = low + params.bias_cosine;
    Offset next = step_offset(s, steps, 0u, VKAO_STEP_LEAST);
    reals next_z = load_sides(texel, next);
    uint t = 0u;
    [[unroll]] for (;;) {
        Offset offset = next;
        reals z = next_z, x, y;
        next = step_offset(s, steps, t + 1u, VKAO_STEP_LEAST);
        if (STEPS == 0u || t + 1u < STEPS)
            next_z = load_sides(texel, next);
        slice_points(s, offset, z, x, y);
        reals d2 = x * x + y * y;
        reals weight = mix(reals(0.0), falloff_weight(d2), is_seen(x, z));
        /* In this order, as what is no number must not stay: greater() then gives the second. */
        horizon = greater(low + weight * (y * inversesqrt(d2) - open), horizon);
        if (++t >= step_count())
            break;
    }
    return clamp(horizon, reals(-1.0), reals(1.0));
}

Visibility visibility(ivec2 texel, Real3 position, Real3 normal, Planes plane)
{
    Real3 to_eye = eye_direction(texel), bent = Real3(real(0.0), real(0.0), real(0.0));
    Noise noise = texel_noise(texel, slice_count());
    real lost = real(0.0);
    float share = 1.0 / float(slice_count());
    /* All slices in a row would leave a CPU's instruction cache. */
    uint k = 0u;
    [[dont_unroll]] for (;;) {
        Slice s = make_slice((float(k) + noise.turn) * share, position, normal, plane, to_eye);
        reals cosines = horizon_cosines(s, texel, noise.jitter);
        real n = acos(s.cos_n);
        n = choose(-n, n, above(s.sin_n, real(0.0)));
        reals h = acos(cosines);
        real h1 = min(first_side(h), n + 0.5 * PI), h0 = max(-other_side(h), n - 0.5 * PI);
        lost += s.normal_length * arc_lost(h0, h1, n, s.cos_n, s.sin_n);
        if (BENT_NORMALS)
            bent = plus(bent, times(plus(times(s.outward, arc_outward(h0, h1, n)),
                                         times(to_eye, arc_to_eye(h0, h1, n))), s.normal_length));
        if (++k >= slice_count())
            break;
    }
    return Visibility(bent, 1.0 - lost * share);
}
