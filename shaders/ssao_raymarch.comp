/* SPDX-License-Identifier: MIT
 *
 * The ray cast with a threshold distance, inside the depth image: cosine-distributed rays from the
 * shaded point, marched in equal steps to the radius, hit where the ray is behind the surface by
 * less than the surface is thick. Unbiased for its model of the scene, and slow: what the other
 * methods are measured against. Rays are stratified by the golden ratio and the noise; noise_index
 * gives another set. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#extension GL_EXT_control_flow_attributes : require
#define VKAO_GLSL
#include "params.h"
#include "ssao.glsl"
#include "layers.glsl"

/* Is the point of a ray behind what is seen at a texel, by less than that is thick? */
bool is_inside(vec3 point, ivec2 at, float z, bool is_given, vec3 position, vec3 normal,
               vec3 to_eye, float bias)
{
    vec3 surface = view_position(vec2(at), z);
    vec3 v = surface - position;
    float lateral = length(v - dot(v, to_eye) * to_eye), radius = params.radius;
    float behind = dot(to_eye, surface - point);
    float depth = params.thickness_base * radius + params.thickness_slope * min(lateral, radius);
    if (is_given)
        depth = radius * thickness_of(vec2(z)).x;
    return z > 0.0 && dot(normal, surface - point) > bias && behind > 0.0 && behind < depth;
}

/* Weight of the first hit, 0 if there is none. */
float first_hit(vec3 position, vec3 normal, vec3 direction, float jitter)
{
    float radius = params.radius;
    float bias = params.bias + depth_error(position.z);
    vec3 to_eye = direction_to_eye(position);
    uint t = 0u;
    for (;;) {
        float d = radius * (float(t) + jitter) / float(step_count());
        vec3 point = position + d * direction;
        if (point.z <= 0.0)
            return 0.0;
        ivec2 at = nearest_texel(point);
        bool hit =
            is_inside(point, at, load_view_z(at), IS_GIVEN, position, normal, to_eye, bias);
        if (SECOND_LAYER && !hit)
            hit = is_inside(point, at, load_second_z(at), false, position, normal, to_eye, bias);
        if (hit) {
            d *= params.inverse_radius;
            return falloff_weight(vec2(d * d)).x;
        }
        if (++t >= step_count())
            return 0.0;
    }
}

Visibility visibility(ivec2 texel, vec3 position, vec3 normal)
{
    Noise noise = texel_noise(texel, 1u);
    float turn = TWO_PI * noise.turn, shift = noise.jitter;
    vec3 t, b, bent = vec3(0.0);
    tangents(normal, t, b);
    float lost = 0.0;
    uint k = 0u;
    for (;;) {
        float r2 = (float(k) + shift) / float(sample_count());
        float angle = float(k) * GOLDEN_ANGLE + turn;
        vec3 across = cos(angle) * t + sin(angle) * b;
        vec3 direction = sqrt(r2) * across + sqrt(1.0 - r2) * normal;
        float hit = first_hit(position, normal, direction, fract(golden_sequence(k) + shift));
        lost += hit;
        bent += (1.0 - hit) * direction;
        if (++k >= sample_count())
            break;
    }
    return Visibility(bent, 1.0 - lost / float(sample_count()));
}
