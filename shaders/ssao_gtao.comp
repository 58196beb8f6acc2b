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
#define VKAO_GLSL
#include "params.h"
#include "ssao.glsl"
#include "horizon.glsl"

/* Cosine of the horizon on one side. */
float horizon_cosine(Slice s, ivec2 texel, vec3 position, vec3 to_eye, float side, float jitter)
{
    float radius = params.normal_x.w;
    float low = -side * s.sin_n; /* cos(n +- pi/2): the tangent plane */
    float horizon = low, guard = 2.0 * depth_error(position.z);
    for (uint t = 0u; t < step_count(); ++t) {
        ivec2 at = step_texel(s, texel, side, t, jitter, radius);
        float z = load_view_z(at);
        if (z > 0.0) {
            vec3 v = view_position(vec2(at), z) - position;
            vec2 p = slice_point(s, v, to_eye, side, guard);
            float c = p.y * inversesqrt(dot(p, p)) - params.normal_y.w / radius;
            horizon = max(horizon, mix(low, c, falloff_weight(dot(v, v), radius)));
        }
    }
    return clamp(horizon, -1.0, 1.0);
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
    vec3 to_eye = direction_to_eye(position);
    vec2 noise = slice_noise(texel);
    float lost = 0.0;
    vec3 bent = vec3(0.0);
    for (uint k = 0u; k < slice_count(); ++k) {
        Slice s = make_slice(PI * (float(k) + noise.x) / float(slice_count()), position, normal, to_eye);
        float n = s.sin_n >= 0.0 ? acos(s.cos_n) : -acos(s.cos_n);
        float h1 = min(acos(horizon_cosine(s, texel, position, to_eye, 1.0, noise.y)), n + 0.5 * PI);
        float h0 = max(-acos(horizon_cosine(s, texel, position, to_eye, -1.0, noise.y)), n - 0.5 * PI);
        float open = s.cos_n + n * s.sin_n;
        lost += s.normal_length * (open - inner_integral(h0, n, s.cos_n, s.sin_n) - inner_integral(h1, n, s.cos_n, s.sin_n));
        if (BENT_NORMALS) {
            vec2 t = bent_slice(h0, h1, n);
            bent += s.normal_length * (t.x * s.outward + t.y * to_eye);
        }
    }
    return vec4(bent, 1.0 - lost / float(slice_count()));
}
