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
#extension GL_EXT_control_flow_attributes : require
#define VKAO_GLSL
#include "params.h"
#include "ssao.glsl"
#include "horizon.glsl"

const float SECTORS = 31.0;

/* g(c) = c (G1 + G3 c^2 + G5 c^4). Least squares, largest error .0014: below half a sector. */
const float G1 = 0.99183605, G3 = -0.11897914, G5 = -0.08610474;

vec2 g(vec2 c)
{
    vec2 c2 = c * c;
    return c * (G1 + c2 * (G3 + G5 * c2));
}

/* Sector bound of cosine c is the polynomial k0 + k1 c + k2 c^2 + k3 c^3 + k5 c^5, inside the side's mass. Vectors hold
 * both sides. */
struct Masks {
    vec2 low; /* cosine of the tangent plane */
    vec2 mass;
    vec2 k0, k1, k2, k3, k5;
};

Masks make_masks(Slice s)
{
    Masks m;
    vec2 sn = SIDES * s.sin_n;
    m.low = -sn;
    vec2 below = 0.5 * s.cos_n * m.low * m.low + sn * g(m.low);
    m.mass = max(0.5 * s.cos_n + sn * (G1 + G3 + G5) - below, vec2(1.0e-4));
    vec2 scale = SECTORS / m.mass;
    m.k0 = VKAO_VBAO_ROUND - below * scale;
    m.k2 = 0.5 * s.cos_n * scale;
    sn *= scale;
    m.k1 = G1 * sn;
    m.k3 = G3 * sn;
    m.k5 = G5 * sn;
    return m;
}

ivec2 sector(Masks m, vec2 c)
{
    c = greater(c, m.low);
    return min(ivec2(m.k0 + c * (m.k1 + c * (m.k2 + c * (m.k3 + c * c * m.k5)))), ivec2(31));
}

vec2 perpendicular(float c)
{
    return vec2(sqrt(max(0.0, 1.0 - c * c)), c);
}

/* x: weighted share of the slice's mass that is hidden. yz: its moment along O and V. */
vec3 hidden_mass(Slice s, ivec2 texel, float jitter)
{
    float radius = params.normal_x.w;
    float reach = radius * (flag(VKAO_FLAG_THRESHOLD) ? VKAO_VBAO_REACH_THRESHOLD : VKAO_VBAO_REACH_SMOOTH);
    vec2 tangent = SIDES * (s.sin_n / max(s.cos_n, 0.02));
    Masks m = make_masks(s);
    ivec2 mask = ivec2(0);
    vec2 last_x = vec2(0.0), last_height = vec2(0.0), last_front = vec2(-2.0);
    vec2 hidden = vec2(0.0);
    vec3 moment = vec3(0.0);
    vec2 next = step_offset(s, 0u, jitter, reach), next_z = load_sides(texel, next);
    [[unroll]] for (uint t = 0u; t < step_count(); ++t) {
        vec2 offset = next, z = next_z, x, y;
        next = step_offset(s, t + 1u, jitter, reach);
        if (STEPS == 0u || t + 1u < STEPS)
            next_z = load_sides(texel, next);
        slice_points(s, offset, z, x, y);
        bvec2 seen = greaterThan(z, vec2(0.0));
        vec2 gap = x - last_x, height = y + x * tangent;
        bvec2 joined = lessThan(abs(height - last_height), VKAO_VBAO_JOIN * abs(gap));
        vec2 moved = lesser(VKAO_VBAO_GAP_FRONT * gap, x - 1.0e-4 * radius);
        moved = mix(vec2(0.0), moved, greaterThan(height, vec2(0.0)));
        vec2 front_x = mix(x - moved, x, joined);
        vec2 front = y * inversesqrt(front_x * front_x + y * y);
        front = greater(front, mix(vec2(-2.0), last_front, joined));
        vec2 thick_y = y - (params.thickness_base + params.thickness_slope * x);
        vec2 back_x = x + VKAO_VBAO_GAP_BACK * gap;
        vec2 back = thick_y * inversesqrt(back_x * back_x + thick_y * thick_y);
        ivec2 high = sector(m, front - params.bias_cosine), low = min(sector(m, back), high);
        ivec2 bits = (ivec2(1) << high) - (ivec2(1) << low);
        bits = mix(ivec2(0), bits, seen);
        ivec2 fresh = bits & ~mask;
        mask |= bits;
        vec2 near_y = lesser(max(thick_y, vec2(0.0)), y);
        vec2 w = falloff_weight(x * x + near_y * near_y) * vec2(bitCount(fresh));
        hidden += w;
        if (BENT_NORMALS) {
            vec2 middle = clamp(0.5 * (front + max(back, m.low)), vec2(-1.0), vec2(1.0));
            w *= m.mass;
            moment.yz += w.x * perpendicular(middle.x) + w.y * vec2(-1.0, 1.0) * perpendicular(middle.y);
        }
        last_x = mix(last_x, x, seen);
        last_height = mix(last_height, height, seen);
        last_front = mix(last_front, front, seen);
    }
    moment.x = dot(hidden, m.mass);
    return moment * (1.0 / SECTORS);
}

vec4 visibility(ivec2 texel, vec3 position, vec3 normal)
{
    vec3 to_eye = eye_direction(texel);
    vec2 noise = slice_noise(texel);
    vec3 bent = vec3(0.0);
    float lost = 0.0;
    [[unroll]] for (uint k = 0u; k < slice_count(); ++k) {
        Slice s = make_slice((float(k) + noise.x) * (1.0 / float(slice_count())), position, normal, to_eye);
        vec3 hidden = hidden_mass(s, texel, noise.y);
        lost += s.normal_length * hidden.x;
        bent += s.normal_length * (hidden.y * s.outward + hidden.z * to_eye);
    }
    /* The mean direction of an open hemisphere is 2/3 of its normal. */
    return vec4(normal * (2.0 / 3.0) - bent / float(slice_count()), 1.0 - lost / float(slice_count()));
}
