/* SPDX-License-Identifier: MIT
 *
 * Visibility bitmask (Therrien, Levesque and Gilet, 'Screen Space Indirect Lighting with Visibility
 * Bitmask', 2023), made cosine-correct. A sample hides the angles from its front edge to its back
 * edge, thickness behind it, so that light passes behind thin things. Angles are sectors of equal
 * mass, see sectors.glsl. Samples come near to far and only sectors that they hide first count,
 * with the falloff at the hiding point: the definition of the ray-traced truths.
 *
 * The depth image is sampled in few places; what lies between two samples of a side is guessed:
 *  - a sample is joined to the one before if the surface between them rises less than
 *    VKAO_VBAO_JOIN over the plane that the depth image has at the shaded point, as any plane does;
 *    then all between is hidden;
 *  - if not, and if it rises over that plane, its front edge moves in by VKAO_VBAO_GAP_FRONT of the
 *    gap, as an edge lies somewhere in it;
 *  - what it hides counts by the distance to there, joined or not: the nearest that it stands for
 *    hides first;
 *  - its back edge moves out by VKAO_VBAO_GAP_BACK of the gap, as the surface goes on to somewhere
 *    before the next sample;
 *  - sky hides nothing; what follows it is looked at as after a sample of the surface's plane;
 *  - what is seen is as thick as it is wide, which view z holds (width.comp); if it is not seen to
 *    end, VKAO_VBAO_THICKNESS_WIDE or, of a large radius, _WIDER of the width that is followed;
 *  - that is at least VKAO_VBAO_THICKNESS_GAP of the gap, which it must hide as what lies there
 *    would, and at most VKAO_VBAO_THICKNESS_BASE of the radius and _SLOPE of its lateral
 *    distance. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#extension GL_EXT_control_flow_attributes : require
#define VKAO_GLSL
#define VKAO_PLANE
#include "params.h"
#include "ssao.glsl"
#include "horizon.glsl"
#include "sectors.glsl"
#include "layers.glsl"

/* What a march of both sides has found hidden. */
struct March {
    uvec2 mask;  /* sectors */
    vec2 hidden; /* their count, weighted */
    vec2 out_moment, eye_moment;
};

/* The sample before, of one layer. */
struct Trail {
    vec2 x, height, front;
    /* k0 of upper bounds: less is added to them while all samples join the point's own surface */
    vec2 rounding;
};

/* y of what is not seen: far behind all. */
const float NOWHERE = -1.0e15;

/* y of the back of what is sampled. is_given: view z has the truth, and a sample stands for its gap
 * alone. */
vec2 back_of(vec2 z, vec2 x, vec2 y, vec2 gap, bool is_given)
{
    vec2 thickness = thickness_of(z);
    if (is_given)
        return y - max(thickness, VKAO_VBAO_THICKNESS_GIVEN_GAP * gap);
    return max(min(y - thickness, y - params.thickness_gap * gap),
               y - params.thickness_base - params.thickness_slope * x);
}

/* Sectors from the one of cosine c on, of which all below the tangent plane is the first. */
uvec2 sectors_from(Masks m, vec2 k0, vec2 c)
{
    return uvec2(~0u) << uvec2(k0 + c * (m.k1 + c * (m.k2 + c * m.k3)));
}

/* falloff_weight of a point, by fewer operations. */
vec2 weight_at(vec2 x, vec2 y)
{
    return THRESHOLD ? falloff_weight(x * x + y * y)
                     : clamp((1.0 - x * x) - y * y, vec2(0.0), vec2(1.0));
}

/* Takes what a sample of both sides hides first. */
void hide(inout March march, inout Trail last, Slice s, Masks m, float center_z, vec2 offset,
          vec2 z, bool is_given)
{
    vec2 x, y;
    slice_points(s, offset, z, x, y);
    bvec2 seen = is_seen(x, z);
    x = mix(slice_x(s, offset, vec2(center_z)), x, seen);
    vec2 gap = x - last.x, height = mix(vec2(0.0), y + x * (SIDES * s.fall), seen);
    y = mix(vec2(NOWHERE), y, seen);
    bvec2 joined = lessThan(abs(height - last.height), VKAO_VBAO_JOIN * abs(gap));
    last.rounding = mix(m.k0, last.rounding, joined);
    vec2 inner_x = x - VKAO_VBAO_GAP_FRONT * gap;
    bvec2 moves = bvec2(!joined.x && height.x > 0.0, !joined.y && height.y > 0.0);
    vec2 front_x = mix(x, inner_x, moves);
    vec2 back_y = back_of(z, x, y, gap, is_given), back_x = x + VKAO_VBAO_GAP_BACK * gap;
    vec2 front = y * inversesqrt(front_x * front_x + y * y) - params.bias_cosine;
    vec2 back = max(back_y * inversesqrt(back_x * back_x + back_y * back_y), m.low);
    joined = bvec2(joined.x && seen.x, joined.y && seen.y);
    front = max(max(front, mix(m.low, last.front, joined)), m.low);
    uvec2 out_of_sight = sectors_from(m, last.rounding, front) | march.mask;
    uvec2 fresh = (sectors_from(m, m.k0, back) | out_of_sight) ^ out_of_sight;
    march.mask |= fresh;
    vec2 near_y = min(max(back_y, vec2(0.0)), y);
    vec2 w = weight_at(inner_x, near_y) * vec2(bitCount(fresh));
    march.hidden += w;
    if (BENT_NORMALS) {
        vec2 middle = clamp(0.5 * (front + params.bias_cosine + back), vec2(-1.0), vec2(1.0));
        w *= m.mass;
        march.out_moment += w * SIDES * sqrt(max(vec2(0.0), 1.0 - middle * middle));
        march.eye_moment += w * middle;
    }
    last.x = x;
    last.height = height;
    last.front = front;
}

/* What a slice loses: of its mass, .x, and of its moment along O and along V. */
vec3 hidden(Slice s, ivec2 texel, float center_z, float jitter)
{
    Masks m = make_masks(SIDES * s.sin_n, vec2(s.cos_n));
    Steps steps = make_steps(s, jitter,
                             params.radius *
                                 (THRESHOLD ? VKAO_VBAO_REACH_THRESHOLD : VKAO_VBAO_REACH_SMOOTH),
                             VKAO_VBAO_STEP_LINEAR);
    const vec2 none = vec2(0.0);
    March march = March(uvec2(0u), none, none, none);
    Trail first = Trail(none, none, m.low, m.k0 - VKAO_VBAO_ROUND_LESS);
    Trail second = Trail(none, none, m.low, m.k0);
    uint t = 0u;
    [[unroll]] for (;;) {
        vec2 offset = step_offset(s, steps, t, VKAO_VBAO_STEP_LEAST), at = vec2(texel);
        hide(march, first, s, m, center_z, offset, load_sides(at, offset), IS_GIVEN);
        if (SECOND_LAYER) {
            vec2 z = vec2(load_second_z_at(at + offset), load_second_z_at(at - offset));
            hide(march, second, s, m, center_z, offset, z, IS_GIVEN);
        }
        if (++t >= step_count())
            break;
    }
    march.hidden *= m.mass;
    return vec3(march.hidden.x + march.hidden.y, march.out_moment.x + march.out_moment.y,
                march.eye_moment.x + march.eye_moment.y) / SECTORS;
}

Visibility visibility(ivec2 texel, vec3 position, vec3 normal, Plane plane)
{
    vec3 to_eye = direction_to_eye(position);
    Noise noise = texel_noise(texel, slice_count());
    float share = 1.0 / float(slice_count());
    /* The mean direction of an open hemisphere is 2/3 of its normal. */
    Visibility v = Visibility(normal * (2.0 / 3.0), 1.0);
    uint k = 0u;
    for (;;) {
        Slice s = make_slice((float(k) + noise.turn) * share, position, normal, plane, to_eye);
        vec3 lost = share * s.normal_length * hidden(s, texel, position.z, noise.jitter);
        v.open -= lost.x;
        v.bent -= s.outward * lost.y + to_eye * lost.z;
        if (++k >= slice_count())
            break;
    }
    return v;
}
