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
 *    gap, as an edge lies somewhere in it. That gap, and that of thickness, is less by
 *    VKAO_VBAO_GAP_RISE of the rise from the sample before, and so more behind something nearer;
 *  - what it hides counts by the distance to there, joined or not: the nearest that it stands for
 *    hides first;
 *  - its back edge moves out by VKAO_VBAO_GAP_BACK of the gap, as the surface goes on to somewhere
 *    before the next sample;
 *  - sky hides nothing; what follows it is looked at as after a sample of the surface's plane;
 *  - what is seen is as thick as it is wide, and the thicker the fewer samples there are to find
 *    it, which view z holds (width.comp); if it is not seen to end, VKAO_VBAO_THICKNESS_WIDE or, of
 *    a large radius, _WIDER of the width that is followed;
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
    uvec2 open;  /* sectors that nothing hides so far: bits from 1 on */
    vec2 count;  /* of these, as counted() has it */
    vec2 hidden; /* the others, weighted */
    vec2 out_moment, eye_moment;
};

/* The sample before, of one layer. */
struct Trail {
    vec2 x, height, front;
    /* of upper bounds: less is added to them while all samples join the point's own surface */
    vec2 rounding;
};

/* The polynomial of Masks in half the cosine over the tangent plane, which is 0 to 1: GPUs clamp to
 * that at no cost. */
struct Bounds {
    vec2 low; /* half the cosine of the tangent plane */
    vec2 k1, k2, k3;
};

/* What sectors.glsl says of both sides, in fewer operations. mass: of each. */
Bounds make_bounds(Slice s, out vec2 mass)
{
    float sine2 = s.sin_n * s.sin_n, half_cos = 0.5 * s.cos_n;
    float level = half_cos + sine2 * (G1 + G3 * sine2 - half_cos);
    mass = max(level + s.sin_n * ((G1 + G3) * SIDES), 1.0e-4);
    vec2 scale = (2.0 * SECTORS) / mass, lean = product(scale, s.sin_n * SIDES);
    return Bounds(-0.5 * s.sin_n * SIDES,
                  product(lean, vec2(G1 - s.cos_n + 3.0 * G3 * sine2)),
                  product(scale, vec2(s.cos_n - 6.0 * G3 * sine2)), product(lean, vec2(4.0 * G3)));
}

/* Half the cosine of a point of the slice, over the tangent plane. */
vec2 bound_of(Bounds b, vec2 x, vec2 y, float bias)
{
    vec2 half_inverse = 0.5 * inversesqrt(x * x + y * y);
    return clamp(y * half_inverse - (b.low + 0.5 * bias), vec2(0.0), vec2(1.0));
}

/* y of what is not seen: far behind all. */
const float NOWHERE = -1.0e15;

/* y of the back of what is sampled. is_given: view z has the truth, and a sample stands for its gap
 * alone. */
vec2 back_of(vec2 z, vec2 x, vec2 y, vec2 unseen, bool is_given)
{
    vec2 width = width_of(z, VKAO_THICKNESS_LEAST_BITS - VKAO_VBAO_WIDTHS_BITS);
    if (is_given)
        return y - max(params.unit_seen * width, VKAO_VBAO_THICKNESS_GIVEN_GAP * unseen);
    return y - params.unit_seen *
                   min(max(width, unseen), params.unit_base + params.unit_slope * x);
}

/* Sectors under a bound. */
vec2 sectors_under(Bounds b, vec2 bound)
{
    return bound * (b.k1 + bound * (b.k2 + bound * b.k3));
}

/* Added to a number below 32 it leaves the whole part in the third byte of a float. GPUs shift by a
 * byte of a register at no cost, where a conversion costs one. */
const float WHOLE = 128.0;

uvec2 whole_of(vec2 with_whole)
{
    return floatBitsToUint(with_whole) >> 16 & 255u;
}

/* Bits that are set, plus 2^23: a float that takes no conversion. */
vec2 counted(uvec2 mask)
{
    return uintBitsToFloat(uvec2(bitCount(mask)) + floatBitsToUint(8388608.0));
}

/* falloff_weight of a point, by fewer operations, times unit_square, which is below 1. */
vec2 weight_at(vec2 x, vec2 y)
{
    vec2 left = (params.unit_square - x * x) - y * y;
    return THRESHOLD ? params.unit_square * vec2(greaterThanEqual(left, vec2(0.0)))
                     : clamp(left, vec2(0.0), vec2(1.0));
}

/* Takes what a sample of both sides hides first. */
void hide(inout March march, inout Trail last, Slice s, Bounds b, vec2 mass, float center_z,
          vec2 offset, vec2 z, bool is_given)
{
    vec2 x, y;
    slice_points(s, offset, z, x, y);
    bvec2 seen = is_seen(x, z);
    x = mix(slice_x(s, offset, vec2(center_z)), x, seen);
    vec2 height = mix(vec2(0.0), y + x * (SIDES * s.fall), seen);
    vec2 gap = x - last.x, rise = height - last.height;
    vec2 unseen = gap - VKAO_VBAO_GAP_RISE * rise;
    y = mix(vec2(NOWHERE), y, seen);
    bvec2 joined = lessThanEqual(abs(rise), VKAO_VBAO_JOIN * gap);
    last.rounding = mix(vec2(VKAO_VBAO_ROUND), last.rounding, joined);
    vec2 inner_x = x - VKAO_VBAO_GAP_FRONT * unseen;
    bvec2 moves = bvec2(!joined.x && height.x > 0.0, !joined.y && height.y > 0.0);
    vec2 front_x = mix(x, inner_x, moves);
    vec2 back_y = back_of(z, x, y, unseen, is_given), back_x = x + VKAO_VBAO_GAP_BACK * gap;
    vec2 front = bound_of(b, front_x, y, params.bias_cosine);
    vec2 back = bound_of(b, back_x, back_y, 0.0);
    joined = bvec2(joined.x && seen.x, joined.y && seen.y);
    front = max(front, mix(vec2(0.0), last.front, joined));
    /* Open as before are those from front on, and those up to back. Bounds of a side that has next
     * to no mass may be anything. */
    uvec2 upper = uvec2(last.rounding + sectors_under(b, front)) & 31u;
    uvec2 above = whole_of((WHOLE + 32.0 - VKAO_VBAO_ROUND) - sectors_under(b, back)) & 31u;
    march.open &= uvec2(~1u) << upper | uvec2(~0u) >> above;
    /* Its square is that of min(max(back_y, 0), y), as the back is not before the front. */
    vec2 near_y = max(max(back_y, vec2(0.0)), -y), count = counted(march.open);
    vec2 w = weight_at(inner_x, near_y) * (march.count - count);
    march.count = count;
    march.hidden += w;
    if (BENT_NORMALS) {
        vec2 middle = front + back + 2.0 * b.low + 0.5 * params.bias_cosine;
        middle = clamp(middle, vec2(-1.0), vec2(1.0));
        w *= mass;
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
    Steps steps = make_steps(s, jitter, params.reach, VKAO_VBAO_STEP_LINEAR);
    const vec2 none = vec2(0.0);
    vec2 mass;
    Bounds b = make_bounds(s, mass);
    March march = March(uvec2(~0u), counted(uvec2(~0u)), none, none, none);
    Trail first = Trail(none, none, none, vec2(VKAO_VBAO_ROUND - VKAO_VBAO_ROUND_LESS));
    Trail second = Trail(none, none, none, vec2(VKAO_VBAO_ROUND));
    uint t = 0u;
    [[unroll]] for (;;) {
        vec2 offset = step_offset(s, steps, t, VKAO_VBAO_STEP_LEAST), at = vec2(texel);
        hide(march, first, s, b, mass, center_z, offset, load_sides(at, offset), IS_GIVEN);
        if (SECOND_LAYER) {
            vec2 z = load_second_sides(at, offset);
            hide(march, second, s, b, mass, center_z, offset, z, IS_GIVEN);
        }
        if (++t >= step_count())
            break;
    }
    march.hidden *= mass;
    return vec3(march.hidden.x + march.hidden.y, march.out_moment.x + march.out_moment.y,
                march.eye_moment.x + march.eye_moment.y) * params.hidden_share;
}

Visibility visibility(ivec2 texel, vec3 position, vec3 normal, Plane plane)
{
    vec3 to_eye = direction_to_eye(view_position(vec2(texel), 1.0));
    Noise noise = texel_noise(texel, slice_count());
    float share = 1.0 / float(slice_count());
    /* The mean direction of an open hemisphere is 2/3 of its normal. */
    Visibility v = Visibility(normal * (2.0 / 3.0), 1.0);
    uint k = 0u;
    for (;;) {
        Slice s = make_slice((float(k) + noise.turn) * share, position, normal, plane, to_eye,
                             params.unproject_units, params.inverse_unit);
        vec3 lost = share * s.normal_length * hidden(s, texel, position.z, noise.jitter);
        v.open -= lost.x;
        v.bent -= s.outward * lost.y + to_eye * lost.z;
        if (++k >= slice_count())
            break;
    }
    return v;
}
