/* SPDX-License-Identifier: MIT
 *
 * Points in the full sphere around the shaded one (Mittring, 'Finding Next Gen: CryEngine 2',
 * 2007), in two forms.
 *
 * Literal: a table of random vectors in the unit ball, rotated per texel about the view axis, times
 * the radius; at each point dz = blocking_scale * max(0, scene z - point z); the blocking factor is
 * the mean of 1 / (1 + dz^2), and visibility is 1 - factor. A point behind the scene blocks fully,
 * one in front of it the less the further.
 *
 * Rescaled: half the sphere lies inside a flat wall, so visibility = min(1, 2 * (1 - blocked)):
 * more than 50 % of the points must be hidden before a texel darkens. Points come in antipodal
 * pairs, so that a plane hides exactly one of each pair; directions are stratified over the sphere,
 * lengths as in point_length. Where the scene is out of range or unknown a point counts as the
 * plane would have it, which changes nothing. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#extension GL_EXT_control_flow_attributes : require
#define VKAO_GLSL
#include "params.h"
#include "ssao.glsl"

/* Uniform in the unit ball from three numbers in [0,1). */
vec3 ball_point(float u, float v, float w)
{
    float z = 1.0 - 2.0 * u, ring = sqrt(max(0.0, 1.0 - z * z));
    return pow(w, 1.0 / 3.0) * vec3(ring * cos(TWO_PI * v), ring * sin(TWO_PI * v), z);
}

/* Point k of the literal form's table: the R3 sequence (Roberts 2018), powers of 0.81917 in fixed
 * point. */
vec3 table_point(uint k)
{
    k += 1u;
    return ball_point(unit_float(k * 3518319155u), unit_float(k * 2882110345u),
                      unit_float(k * 2360945575u));
}

float literal_blocking(ivec2 texel, vec3 position)
{
    float radius = params.radius, scale = params.blocking_scale;
    float turn = TWO_PI * texel_noise(texel, 1u).turn;
    vec2 rotation = vec2(cos(turn), sin(turn));
    float factor = 0.0;
    uint k = 0u;
    for (;;) {
        vec3 p = table_point(k);
        p.xy = vec2(p.x * rotation.x - p.y * rotation.y, p.x * rotation.y + p.y * rotation.x);
        vec3 point = position + radius * p;
        float scene_z = point.z > 0.0 ? load_view_z(nearest_texel(point)) : 0.0;
        float dz = scale * max(0.0, scene_z - point.z);
        factor += scene_z > 0.0 ? 1.0 / (1.0 + dz * dz) : 0.0;
        if (++k >= sample_count())
            break;
    }
    return factor / float(sample_count());
}

float hidden(vec3 position, vec3 normal, vec3 offset)
{
    float radius = params.radius, bias = params.bias + depth_error(position.z);
    vec3 point = position + offset;
    float height = dot(normal, offset);
    ivec2 at = nearest_texel(point);
    float scene_z = point.z > 0.0 ? load_view_z(at) : 0.0;
    vec3 occluder = view_position(vec2(at), scene_z);
    float weight = scene_z > 0.0 ? range_weight(vec2(scene_z - position.z), radius).x : 0.0;
    bool behind = stands_in_front(occluder, position, normal, height + bias);
    return mix(height < 0.0 ? 1.0 : 0.0, behind ? 1.0 : 0.0, weight);
}

float rescaled_blocking(ivec2 texel, vec3 position, vec3 normal)
{
    Noise noise = texel_noise(texel, 1u);
    float turn = TWO_PI * noise.turn, shift = noise.jitter;
    uint pairs = (sample_count() + 1u) / 2u;
    float blocked = 0.0;
    uint k = 0u;
    for (;;) {
        /* z over (0,1), the antipode over (-1,0) */
        float z = (float(k) + shift) / float(pairs), ring = sqrt(1.0 - z * z);
        float angle = float(k) * GOLDEN_ANGLE + turn;
        float len = params.radius * point_length(fract(golden_sequence(k) + shift));
        vec3 offset = len * vec3(ring * cos(angle), ring * sin(angle), z);
        blocked += hidden(position, normal, offset) + hidden(position, normal, -offset);
        if (++k >= pairs)
            break;
    }
    return blocked / float(2u * pairs);
}

Visibility visibility(ivec2 texel, vec3 position, vec3 normal)
{
    float open = SPHERE_LITERAL
                     ? 1.0 - literal_blocking(texel, position)
                     : min(1.0, 2.0 * (1.0 - rescaled_blocking(texel, position, normal)));
    return Visibility(vec3(0.0), open);
}
