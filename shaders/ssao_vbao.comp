/* SPDX-License-Identifier: MIT
 *
 * Visibility bitmask (Therrien, Levesque and Gilet, 'Screen Space Indirect Lighting with Visibility Bitmask', 2023),
 * made cosine-correct. A sample hides the angles from its front edge to its back edge, thickness behind it, so that
 * light passes behind thin things. With c = cos theta, the slice's density cos(theta - n) |sin theta| dtheta becomes
 * (cos n * c + sin n * sqrt(1 - c^2)) dc, whose integral is
 *     G(c) = cos n * c^2 / 2 + sin n * g(c),   g(c) = (c sqrt(1 - c^2) + asin c) / 2.
 * Each side has its own mask of 31 sectors of equal mass between the tangent plane, c = -sin n, and V, c = 1: sector
 * bounds cost one inversesqrt and a polynomial, no angle. Samples come near to far and only sectors that they hide
 * first count, with the falloff at the hiding point: the definition of the ray-traced truths.
 *
 * The depth image is sampled in few places; what lies between two samples of a side is guessed:
 *  - a sample is joined to the one before if the surface between them rises less than VKAO_VBAO_JOIN
 *    over the tangent plane, as any plane does; then all between is hidden;
 *  - if not, its front edge moves in by VKAO_VBAO_GAP_FRONT of the gap, as an edge lies somewhere in it;
 *  - its back edge moves out by VKAO_VBAO_GAP_BACK of the gap, as the surface goes on to somewhere before the next sample;
 *  - what is seen is as thick as VKAO_THICKNESS_BASE of the radius plus VKAO_THICKNESS_SLOPE of its lateral distance. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#define VKAO_GLSL
#include "params.h"
#include "ssao.glsl"
#include "horizon.glsl"

const float SECTORS = 31.0;

/* Least squares, largest error .0014: below half a sector. */
float g(float c)
{
    float c2 = c * c;
    return c * (0.99183605 + c2 * (-0.11897914 - 0.08610474 * c2));
}

/* Sector bound of cosine c is k.x + k.y c^2 + k.z g(c), inside the side's mass. */
struct Side {
    vec3 k;
    float low; /* cosine of the tangent plane */
    float mass;
};

Side make_side(Slice s, float side)
{
    Side r;
    float sn = side * s.sin_n;
    float below = 0.5 * s.cos_n * sn * sn - sn * g(sn);
    r.low = -sn;
    r.mass = max(0.5 * s.cos_n + sn * g(1.0) - below, 1.0e-4);
    r.k = vec3(-below, 0.5 * s.cos_n, sn) * (SECTORS / r.mass);
    return r;
}

int sector(Side r, float c)
{
    return c <= r.low ? 0 : clamp(int(r.k.x + VKAO_VBAO_ROUND + r.k.y * c * c + r.k.z * g(c)), 0, 31);
}

vec2 perpendicular(float c)
{
    return vec2(sqrt(max(0.0, 1.0 - c * c)), c);
}

/* x: weighted share of the side's mass that is hidden. yz: its moment along O and V. */
vec3 hidden_mass(Slice s, ivec2 texel, vec3 position, vec3 to_eye, float side, float jitter)
{
    float radius = params.normal_x.w;
    float reach = radius * (params.falloff == VKAO_GLSL_FALLOFF_SMOOTH ? VKAO_VBAO_REACH_SMOOTH : VKAO_VBAO_REACH_THRESHOLD);
    float tangent = side * s.sin_n / max(s.cos_n, 0.02);
    float bias = params.normal_y.w / radius;
    float guard = 2.0 * depth_error(position.z);
    Side r = make_side(s, side);
    uint mask = 0u;
    vec2 previous = vec2(0.0);
    float previous_cosine = -2.0;
    vec3 hidden = vec3(0.0);
    for (uint t = 0u; t < step_count(); ++t) {
        ivec2 at = step_texel(s, texel, side, t, jitter, reach);
        float z = load_view_z(at);
        if (z > 0.0) {
            vec2 p = slice_point(s, view_position(vec2(at), z) - position, to_eye, side, guard);
            vec2 gap = p - previous;
            bool joined = abs(gap.y + gap.x * tangent) < VKAO_VBAO_JOIN * abs(gap.x);
            bool above = p.y + p.x * tangent > 0.0;
            float front_x = !joined && above ? max(p.x - VKAO_VBAO_GAP_FRONT * gap.x, 1.0e-4 * radius) : p.x;
            float front = p.y * inversesqrt(front_x * front_x + p.y * p.y);
            if (joined)
                front = max(front, previous_cosine);
            previous_cosine = p.y * inversesqrt(dot(p, p));
            float depth = params.normal_z.w * (VKAO_THICKNESS_BASE * radius + VKAO_THICKNESS_SLOPE * min(p.x, radius));
            vec2 back_edge = vec2(p.x + VKAO_VBAO_GAP_BACK * gap.x, p.y - depth);
            float back = back_edge.y * inversesqrt(dot(back_edge, back_edge));
            int high = sector(r, front - bias), low = min(sector(r, back), high);
            uint bits = (1u << high) - (1u << low);
            uint fresh = bits & ~mask;
            mask |= bits;
            float near_y = clamp(0.0, p.y - depth, p.y);
            float w = falloff_weight(p.x * p.x + near_y * near_y, radius) * float(bitCount(fresh));
            hidden.x += w;
            if (BENT_NORMALS)
                hidden.yz += w * vec2(side, 1.0) * perpendicular(clamp(0.5 * (front + max(back, r.low)), -1.0, 1.0));
            previous = p;
        }
    }
    return hidden * (r.mass / SECTORS);
}

vec4 visibility(ivec2 texel, vec3 position, vec3 normal)
{
    vec3 to_eye = direction_to_eye(position);
    vec2 noise = slice_noise(texel);
    vec3 bent = vec3(0.0);
    float lost = 0.0;
    for (uint k = 0u; k < slice_count(); ++k) {
        Slice s = make_slice(PI * (float(k) + noise.x) / float(slice_count()), position, normal, to_eye);
        vec3 hidden = hidden_mass(s, texel, position, to_eye, 1.0, noise.y) +
                      hidden_mass(s, texel, position, to_eye, -1.0, noise.y);
        lost += s.normal_length * hidden.x;
        bent += s.normal_length * (hidden.y * s.outward + hidden.z * to_eye);
    }
    /* The mean direction of an open hemisphere is 2/3 of its normal. */
    return vec4(normal * (2.0 / 3.0) - bent / float(slice_count()), 1.0 - lost / float(slice_count()));
}
