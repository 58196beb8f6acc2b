/* SPDX-License-Identifier: MIT
 *
 * Cosine-weighted horizons (Jimenez et al. 2016, equation 7): per slice and side the horizon cosine
 * is the largest over the samples, each faded towards the tangent plane by the falloff; with h1, h0
 * the two horizon angles,
 *     slice = L * sum over both of (cos n + 2 h sin n - cos(2h - n)) / 4.
 * An open slice is L (cos n + n sin n), whose mean over the slices is 1: the occluded part alone is
 * summed, so that an open wall is exactly 1. The bent normal is algorithm 2 of the paper. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#extension GL_EXT_control_flow_attributes : require
#define VKAO_GLSL
#define VKAO_PLANE
#include "params.h"
#include "ssao.glsl"
#include "horizon.glsl"
#include "arc.glsl"

/* Cosines of the horizons. */
vec2 horizon_cosines(Slice s, ivec2 texel, float jitter)
{
    Steps steps = make_steps(s, jitter, params.radius, VKAO_STEP_LINEAR);
    vec2 low = -SIDES * s.sin_n; /* cos(n +- pi/2): the tangent plane */
    vec2 horizon = low;
    uint t = 0u;
    [[unroll]] for (;;) {
        vec2 offset = step_offset(s, steps, t, VKAO_STEP_LEAST);
        vec2 z = load_sides(vec2(texel), offset), x, y;
        slice_points(s, offset, z, x, y);
        vec2 d2 = x * x + y * y;
        vec2 weight = mix(vec2(0.0), falloff_weight(d2), is_seen(x, z));
        vec2 cosine = low + weight * (y * inversesqrt(d2) - low - params.bias_cosine);
        /* What is no number must not stay: a comparison with it is false. */
        horizon = mix(horizon, cosine, greaterThan(cosine, horizon));
        if (++t >= step_count())
            break;
    }
    return clamp(horizon, vec2(-1.0), vec2(1.0));
}

Visibility visibility(ivec2 texel, vec3 position, vec3 normal, Plane plane)
{
    vec3 to_eye = direction_to_eye(view_position(vec2(texel), 1.0)), bent = vec3(0.0);
    Noise noise = texel_noise(texel, slice_count());
    float lost = 0.0, share = 1.0 / float(slice_count());
    uint k = 0u;
    [[unroll]] for (;;) {
        Slice s = make_slice((float(k) + noise.turn) * share, position, normal, plane, to_eye,
                             params.unproject.xy * params.inverse_radius, params.inverse_radius);
        vec2 h = acos(horizon_cosines(s, texel, noise.jitter));
        float n = s.sin_n > 0.0 ? acos(s.cos_n) : -acos(s.cos_n);
        float h1 = min(h.x, n + 0.5 * PI), h0 = max(-h.y, n - 0.5 * PI);
        lost += s.normal_length * arc_lost(h0, h1, n, s.cos_n, s.sin_n);
        if (BENT_NORMALS)
            bent += s.normal_length *
                    (s.outward * arc_outward(h0, h1, n) + to_eye * arc_to_eye(h0, h1, n));
        if (++k >= slice_count())
            break;
    }
    return Visibility(bent, 1.0 - lost * share);
}
