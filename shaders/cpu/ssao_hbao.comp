/* SPDX-License-Identifier: MIT
 *
 * ../ssao_hbao.comp for two texels side by side. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_shader_16bit_storage : enable
#extension GL_EXT_samplerless_texture_functions : require
#extension GL_EXT_control_flow_attributes : require
#define VKAO_GLSL
#include "params.h"
#include "ssao.glsl"
#include "horizon.glsl"

/* Of both sides together. */
real occlusion(Slice s, ivec2 texel, real jitter)
{
    Steps steps = make_steps(s, jitter, params.radius, VKAO_STEP_LINEAR);
    reals sine = reals(params.bias_cosine), occluded = reals(0.0);
    reals along = SIDES * both(s.normal_length * s.sin_n), facing = both(s.normal_length * s.cos_n);
    uint t = 0u;
    [[unroll]] for (;;) {
        Offset offset = step_offset(s, steps, t, VKAO_STEP_LEAST);
        reals z = load_sides(texel, offset), x, y;
        slice_points(s, offset, z, x, y);
        reals d2 = x * x + y * y;
        reals weight = mix(reals(0.0), falloff_weight(d2), is_seen(x, z));
        reals elevation = (along * x + facing * y) * inversesqrt(d2);
        reals higher = mix(sine, max(sine, elevation), greaterThan(weight, reals(0.0)));
        occluded += weight * (higher - sine);
        sine = higher;
        if (++t >= step_count())
            break;
    }
    return first_side(occluded) + other_side(occluded);
}

Visibility visibility(ivec2 texel, Real3 position, Real3 normal, Planes plane)
{
    Real3 to_eye = eye_direction(texel);
    Noise noise = texel_noise(texel, slice_count());
    real occluded = real(0.0);
    float share = 1.0 / float(slice_count());
    /* All slices in a row would leave a CPU's instruction cache. */
    uint k = 0u;
    [[dont_unroll]] for (;;) {
        occluded +=
            occlusion(make_slice((float(k) + noise.turn) * share, position, normal, plane, to_eye),
                      texel, noise.jitter);
        if (++k >= slice_count())
            break;
    }
    return Visibility(Real3(real(0.0), real(0.0), real(0.0)), 1.0 - 0.5 * share * occluded);
}
