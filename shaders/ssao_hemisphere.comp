/* SPDX-License-Identifier: MIT
 *
 * Normal-oriented hemisphere (Filion and McNaughton, 'StarCraft II: Effects and Techniques', 2008),
 * with a cosine-weighted kernel in pairs of points: the directions of pair k of n lie over the
 * point k of a Fibonacci disk and over the one across it,
 *     r = sqrt((k + 1/2) / n), angle = k * golden angle + noise, height sqrt(1 - r^2),
 * so that the mean over k needs no weights. Of the two lengths one is of the shorter half; each
 * half is stratified over k by the golden ratio, and within its stratum a length moves with a
 * second noise. Their distribution carries the falloff, see point_length. A point is blocked if the
 * scene stands in front of it; each blocked point counts by range_weight. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#extension GL_EXT_control_flow_attributes : require
#define VKAO_GLSL
#include "params.h"
#include "ssao.glsl"
#include "kernel.glsl"

/* What the point at offset counts. */
float blocked(vec3 position, vec3 normal, vec3 offset)
{
    vec3 point = position + offset;
    if (point.z <= 0.0)
        return 0.0;
    ivec2 at = nearest_texel(point);
    float scene_z = load_view_z(at);
    vec3 occluder = view_position(vec2(at), scene_z);
    float least = dot(normal, offset) + params.bias + depth_error(position.z);
    bool is_blocked = scene_z > 0.0 && stands_in_front(occluder, position, normal, least);
    return is_blocked ? range_weight(vec2(scene_z - position.z), params.radius).x : 0.0;
}

Visibility visibility(ivec2 texel, vec3 position, vec3 normal)
{
    Noise noise = texel_noise(texel, 1u);
    vec3 t, b;
    tangents(normal, t, b);
    uint pairs = (sample_count() + 1u) / 2u, k = 0u;
    float sum = 0.0;
    [[unroll]] for (;;) {
        float r2 = (float(k) + 0.5) / float(pairs),
              angle = float(k) * GOLDEN_ANGLE + TWO_PI * noise.turn;
        vec3 across = sqrt(r2) * (cos(angle) * t + sin(angle) * b), up = sqrt(1.0 - r2) * normal;
        vec2 lengths = params.radius * pair_lengths(k, pairs, noise.jitter);
        sum += blocked(position, normal, lengths.x * (up + across)) +
               blocked(position, normal, lengths.y * (up - across));
        if (++k >= pairs)
            break;
    }
    return Visibility(vec3(0.0), 1.0 - sum / float(2u * pairs));
}
