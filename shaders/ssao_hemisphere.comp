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
#define VKAO_APART
#include "ssao.glsl"

/* Directions on their way to texels: what a step in view space adds to (texel, 1) * z, in perspective, or (texel, z). A
 * point is projected by one division, without going through view space. */
vec3 to_texels(vec3 direction)
{
    vec2 xy = orthographic() ? direction.xy : direction.xy - params.unproject.zw * direction.z;
    return vec3(xy * params.inverse_unproject, direction.z);
}

vec4 visibility(ivec2 texel, vec3 position, vec3 normal)
{
    float radius = params.normal_x.w, bias = params.normal_y.w + depth_error(position.z);
    vec3 t, b;
    tangents(normal, t, b);
    /* The kernel is turned with its frame: the directions in it are constants then. */
    Real2 turns = full_turn(real(interleaved_gradient_noise(uvec2(texel), params.noise_index)));
    vec2 turn = vec2(lane(turns.x, 0), lane(turns.y, 0));
    float shift = r2_noise(uvec2(texel), params.noise_index);
    vec3 across = to_texels(turn.x * t + turn.y * b), along = to_texels(turn.x * b - turn.y * t);
    vec3 up = to_texels(normal);
    vec3 center = orthographic() ? vec3(texel, position.z) : vec3(vec2(texel) * position.z, position.z);
    /* stands_in_front, in texels: the height of an occluder is dot(normal, occluder) - dot(normal, position). */
    vec2 slope = normal.xy * params.unproject.xy;
    float level = dot(normal.xy, params.unproject.zw) + (orthographic() ? 0.0 : normal.z);
    float least = dot(normal, position) + bias;
    float blocked = 0.0;
    [[unroll]] for (uint k = 0u; k < sample_count(); ++k) {
        float r2 = (float(k) + 0.5) / float(sample_count()), r = sqrt(r2), height = sqrt(1.0 - r2);
        float angle = float(k) * GOLDEN_ANGLE;
        float len = point_length(fract(golden_sequence(k) + shift), radius);
        vec3 point = center + len * (r * cos(angle) * across + r * sin(angle) * along + height * up);
        ivec2 at = nearest_texel(orthographic() ? point.xy : point.xy * (1.0 / point.z));
        float scene_z = load_view_z(at);
        float over = dot(slope, vec2(at)) + level;
        over = orthographic() ? over + normal.z * scene_z : over * scene_z;
        bool hit = min(scene_z, point.z) > 0.0 && over > len * height + least;
        blocked += hit ? range_weight(scene_z - position.z, radius) : 0.0;
    }
    return vec4(vec3(0.0), 1.0 - blocked / float(sample_count()));
}
