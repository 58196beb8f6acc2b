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
#include "params.h"
#include "ssao.glsl"
#include "horizon.glsl"
#include "sectors.glsl"
#include "layers.glsl"

/* What a march of both sides has found hidden. */
struct March {
    ivec2 mask;  /* sectors */
    vec2 hidden; /* their count, weighted */
    vec2 out_moment, eye_moment;
};

/* The sample before, of one layer. */
struct Trail {
    vec2 x, height, front;
    vec2 rounding; /* taken off upper bounds while all samples join the point's own surface */
};

/* How far back what is sampled goes, in radii. is_given: view z has the truth, and a sample stands
 * for its gap alone. */
vec2 depth_of(vec2 z, vec2 x, vec2 gap, bool is_given)
{
    vec2 thickness = thickness_of(z);
    if (is_given)
        return max(thickness, VKAO_VBAO_THICKNESS_GIVEN_GAP * gap);
    return min(max(thickness, params.thickness_gap * gap),
               params.thickness_base + params.thickness_slope * x);
}

/* Takes what a sample of both sides hides first. */
void hide(inout March march, inout Trail last, Slice s, Masks m, float center_z, vec2 offset,
          vec2 z, bool is_given)
{
    bvec2 seen = greaterThan(z, vec2(0.0));
    vec2 x, y;
    slice_points(s, offset, mix(vec2(center_z), z, seen), x, y);
    seen = bvec2(seen.x && x.x > 0.0, seen.y && x.y > 0.0); /* see is_seen */
    vec2 gap = x - last.x, height = mix(vec2(0.0), y + x * (SIDES * s.fall), seen);
    bvec2 joined = lessThan(abs(height - last.height), VKAO_VBAO_JOIN * abs(gap));
    vec2 inner_x = x - VKAO_VBAO_GAP_FRONT * gap;
    vec2 front_x = mix(x, inner_x, greaterThan(height, vec2(0.0)));
    front_x = mix(front_x, x, joined);
    vec2 thick_y = y - depth_of(z, x, gap, is_given);
    vec2 back_x = x + VKAO_VBAO_GAP_BACK * gap;
    vec2 front = y * inversesqrt(front_x * front_x + y * y);
    vec2 back = thick_y * inversesqrt(back_x * back_x + thick_y * thick_y);
    front = max(front, mix(vec2(-2.0), last.front, joined));
    last.rounding = mix(vec2(0.0), last.rounding, joined);
    ivec2 high = min(sector(m, max(front - params.bias_cosine, m.low), last.rounding), ivec2(31));
    ivec2 low = min(sector(m, max(back, m.low), vec2(0.0)), high);
    ivec2 bits = mix(ivec2(0), (ivec2(1) << high) - (ivec2(1) << low), seen);
    ivec2 fresh = bits & ~march.mask;
    march.mask |= bits;
    vec2 near_y = min(max(thick_y, vec2(0.0)), y);
    vec2 w = falloff_weight(inner_x * inner_x + near_y * near_y) * vec2(bitCount(fresh));
    march.hidden += w;
    if (BENT_NORMALS) {
        vec2 middle = clamp(0.5 * (front + max(back, m.low)), vec2(-1.0), vec2(1.0));
        w *= m.mass;
        march.out_moment += w * SIDES * sqrt(max(vec2(0.0), 1.0 - middle * middle));
        march.eye_moment += w * middle;
    }
    last.x = x;
    last.height = height;
    last.front = mix(vec2(-2.0), front, seen);
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
    March march = March(ivec2(0), none, none, none);
    Trail first = Trail(none, none, vec2(-2.0), vec2(VKAO_VBAO_ROUND_LESS));
    Trail second = Trail(none, none, vec2(-2.0), none);
    uint t = 0u;
    [[unroll]] for (;;) {
        vec2 offset = step_offset(s, steps, t, VKAO_VBAO_STEP_LEAST);
        hide(march, first, s, m, center_z, offset, load_sides(texel, offset), IS_GIVEN);
        if (SECOND_LAYER) {
            ivec2 at = ivec2(offset);
            vec2 z = vec2(load_second_z(texel + at), load_second_z(texel - at));
            hide(march, second, s, m, center_z, offset, z, IS_GIVEN);
        }
        if (++t >= step_count())
            break;
    }
    march.hidden *= m.mass;
    return vec3(march.hidden.x + march.hidden.y, march.out_moment.x + march.out_moment.y,
                march.eye_moment.x + march.eye_moment.y) / SECTORS;
}

Visibility visibility(ivec2 texel, vec3 position, vec3 normal)
{
    vec3 to_eye = direction_to_eye(position);
    Plane plane = depth_plane(texel, position, normal);
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
