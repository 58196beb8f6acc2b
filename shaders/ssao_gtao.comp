/* SPDX-License-Identifier: MIT
 *
 * Cosine-weighted horizons (Jimenez et al. 2016, equation 7): per slice and side the horizon cosine is the largest over
 * the samples, each faded towards the tangent plane by the falloff; with h1, h0 the two horizon angles,
 *     slice = L * sum over both of (cos n + 2 h sin n - cos(2h - n)) / 4.
 * An open slice is L (cos n + n sin n), whose mean over the slices is 1: the occluded part alone is summed, so that an
 * open wall is exactly 1. The bent normal is algorithm 2 of the paper. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#extension GL_EXT_control_flow_attributes : require
#define VKAO_GLSL
#include "params.h"
#include "ssao.glsl"
#include "horizon.glsl"

/* Cosines of the horizons. */
vec2 horizon_cosines(Slice s, ivec2 texel, float jitter)
{
    float radius = params.normal_x.w;
    vec2 low = -SIDES * s.sin_n; /* cos(n +- pi/2): the tangent plane */
    vec2 horizon = low, open = low + params.bias_cosine;
    vec2 next = step_offset(s, 0u, jitter, radius), next_z = load_sides(texel, next);
    [[unroll]] for (uint t = 0u; t < step_count(); ++t) {
        vec2 offset = next, z = next_z, x, y;
        next = step_offset(s, t + 1u, jitter, radius);
        if (STEPS == 0u || t + 1u < STEPS)
            next_z = load_sides(texel, next);
        slice_points(s, offset, z, x, y);
        vec2 d2 = x * x + y * y;
        vec2 weight = mix(vec2(0.0), falloff_weight(d2), greaterThan(z, vec2(0.0)));
        horizon = greater(horizon, low + weight * (y * inversesqrt(d2) - open));
    }
    return clamp(horizon, vec2(-1.0), vec2(1.0));
}

float inner_integral(float h, float n, float cos_n, float sin_n)
{
    return 0.25 * (cos_n + 2.0 * h * sin_n - cos(2.0 * h - n));
}

/* Along O and along V. */
vec2 bent_slice(float h0, float h1, float n)
{
    float t0 = (6.0 * sin(h0 - n) - sin(3.0 * h0 - n) + 6.0 * sin(h1 - n) - sin(3.0 * h1 - n) + 16.0 * sin(n) -
                3.0 * (sin(h0 + n) + sin(h1 + n))) / 12.0;
    float t1 = (-cos(3.0 * h0 - n) - cos(3.0 * h1 - n) + 8.0 * cos(n) - 3.0 * (cos(h0 + n) + cos(h1 + n))) / 12.0;
    return vec2(t0, t1);
}

vec4 visibility(ivec2 texel, vec3 position, vec3 normal)
{
    vec3 to_eye = eye_direction(texel);
    vec2 noise = slice_noise(texel);
    float lost = 0.0;
    vec3 bent = vec3(0.0);
    [[unroll]] for (uint k = 0u; k < slice_count(); ++k) {
        Slice s = make_slice((float(k) + noise.x) * (1.0 / float(slice_count())), position, normal, to_eye);
        vec2 cosines = horizon_cosines(s, texel, noise.y);
        float n = s.sin_n >= 0.0 ? acos(s.cos_n) : -acos(s.cos_n);
        float h1 = min(acos(cosines.x), n + 0.5 * PI), h0 = max(-acos(cosines.y), n - 0.5 * PI);
        float open = s.cos_n + n * s.sin_n;
        float seen = inner_integral(h0, n, s.cos_n, s.sin_n) + inner_integral(h1, n, s.cos_n, s.sin_n);
        lost += s.normal_length * (open - seen);
        if (BENT_NORMALS) {
            vec2 t = bent_slice(h0, h1, n);
            bent += s.normal_length * (t.x * s.outward + t.y * to_eye);
        }
    }
    return vec4(bent, 1.0 - lost / float(slice_count()));
}
