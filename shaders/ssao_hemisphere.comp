/* SPDX-License-Identifier: MIT
 *
 * Normal-oriented hemisphere (Filion and McNaughton, 'StarCraft II: Effects and Techniques', 2008), with a
 * cosine-weighted kernel: direction k of n lies over the point k of a Fibonacci disk,
 *     r = sqrt((k + 1/2) / n), angle = k * golden angle + noise, height sqrt(1 - r^2),
 * so that the mean over k needs no weights. Lengths are stratified over k by the golden ratio and a second noise;
 * their distribution carries the falloff, see point_length. A point is blocked if the scene stands in front of it;
 * each blocked point counts by range_weight. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#extension GL_EXT_control_flow_attributes : require
#define VKAO_GLSL
#include "params.h"
#include "ssao.glsl"

vec4 visibility(ivec2 texel, vec3 position, vec3 normal)
{
    float radius = params.normal_x.w, bias = params.normal_y.w + depth_error(position.z);
    vec3 t, b;
    tangents(normal, t, b);
    float turn = TWO_PI * interleaved_gradient_noise(uvec2(texel), params.noise_index);
    float shift = r2_noise(uvec2(texel), params.noise_index);
    float blocked = 0.0;
    for (uint k = 0u; k < sample_count(); ++k) {
        float r2 = (float(k) + 0.5) / float(sample_count());
        float angle = float(k) * GOLDEN_ANGLE + turn;
        float len = point_length(fract(golden_sequence(k) + shift), radius);
        vec3 offset = len * (sqrt(r2) * (cos(angle) * t + sin(angle) * b) + sqrt(1.0 - r2) * normal);
        vec3 point = position + offset;
        ivec2 at = ivec2(floor(project_to_texel(point) + 0.5));
        float scene_z = point.z > 0.0 ? load_view_z(at) : 0.0;
        vec3 occluder = view_position(vec2(at), scene_z);
        bool hit = scene_z > 0.0 && stands_in_front(occluder, position, normal, len * sqrt(1.0 - r2) + bias);
        blocked += hit ? range_weight(scene_z - position.z, radius) : 0.0;
    }
    return vec4(vec3(0.0), 1.0 - blocked / float(sample_count()));
}
