/* SPDX-License-Identifier: MIT
 *
 * Horizon-based ambient occlusion (Bavoil, Sainz and Dimitrov 2008), true-horizon form: marching
 * outwards, each sample that rises over the horizon so far adds the rise of its sine over the
 * tangent plane, weighted by the falloff at its own distance; visibility is 1 - the mean over
 * directions. Measured on nine G-buffers with ray-traced truth at 1x8: RMSE .087 (geometric mean),
 * against .103 with squared sines, which are cosine-weighted in a slice of their own, and .118 for
 * the point form, max(0, sine - bias) * falloff averaged over samples. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#extension GL_EXT_control_flow_attributes : require
#define VKAO_GLSL
#define VKAO_PLANE
#include "params.h"
#include "ssao.glsl"
#include "horizon.glsl"

/* Of both sides together. */
float occlusion(Slice s, ivec2 texel, float jitter)
{
    Steps steps = make_steps(s, jitter, params.radius, VKAO_STEP_LINEAR);
    vec2 sine = vec2(params.bias_cosine), occluded = vec2(0.0);
    vec2 along = SIDES * (s.normal_length * s.sin_n);
    uint t = 0u;
    [[unroll]] for (;;) {
        vec2 offset = step_offset(s, steps, t, VKAO_STEP_LEAST);
        vec2 z = load_sides(vec2(texel), offset), x, y;
        slice_points(s, offset, z, x, y);
        vec2 d2 = x * x + y * y;
        vec2 weight = mix(vec2(0.0), falloff_weight(d2), is_seen(x, z));
        vec2 elevation = (along * x + s.normal_length * s.cos_n * y) * inversesqrt(d2);
        vec2 higher = mix(sine, max(sine, elevation), greaterThan(weight, vec2(0.0)));
        occluded += weight * (higher - sine);
        sine = higher;
        if (++t >= step_count())
            break;
    }
    return occluded.x + occluded.y;
}

Visibility visibility(ivec2 texel, vec3 position, vec3 normal, Plane plane)
{
    vec3 to_eye = direction_to_eye(view_position(vec2(texel), 1.0));
    Noise noise = texel_noise(texel, slice_count());
    float occluded = 0.0, share = 1.0 / float(slice_count());
    uint k = 0u;
    [[unroll]] for (;;) {
        Slice s = make_slice((float(k) + noise.turn) * share, position, normal, plane, to_eye,
                             params.unproject.xy * params.inverse_radius, params.inverse_radius);
        occluded += occlusion(s, texel, noise.jitter);
        if (++k >= slice_count())
            break;
    }
    return Visibility(vec3(0.0), 1.0 - 0.5 * share * occluded);
}
