/* SPDX-License-Identifier: MIT
 *
 * ../ssao_vbao.comp for two texels side by side. Some steps at once are unrolled, so that the code
 * fits an instruction cache: where it does not, a run takes up to half as long again, by where in
 * memory the code happens to lie. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_shader_16bit_storage : enable
#extension GL_EXT_samplerless_texture_functions : require
#extension GL_EXT_control_flow_attributes : require
#define VKAO_GLSL
#include "params.h"
#include "ssao.glsl"
#include "horizon.glsl"
#include "sectors.glsl"

/* Steps in chunks of n. */
uint padded(uint n)
{
    return (STEPS + n - 1u) / n * n;
}

/* Steps that are unrolled in a loop over the rest: as many as are allowed, or up to two fewer if
 * that leaves fewer to take for nothing at the end. */
uint chunk()
{
    const uint most = VKAO_VBAO_MOST_AT_ONCE;
    if (STEPS <= most)
        return max(STEPS, 1u);
    uint fewer = padded(most - 1u) <= padded(most - 2u) ? most - 1u : most - 2u;
    return padded(most) <= padded(fewer) ? most : fewer;
}

/* How far a march of both sides has come. */
struct March {
    ints mask; /* sectors that are hidden */
    reals last_x, last_height, last_front;
    reals upper;    /* k0 of upper bounds: less while all samples join the point's own surface */
    reals hidden;   /* sectors, weighted */
    reals out_moment, eye_moment;
};

/* In radii, as is seen. */
reals width_of(reals z)
{
    ints code = floatBitsToInt(z) & VKAO_THICKNESS_MASK;
    return intBitsToFloat((code << VKAO_THICKNESS_SHIFT) + VKAO_THICKNESS_LEAST_BITS);
}

/* The bound of a cosine that is not below the tangent plane: at least 0, but for rounding not
 * always at most SECTORS. upper: k0, or less by at most VKAO_VBAO_ROUND. */
ints sector(Masks m, reals c, reals upper)
{
    return ints(upper + c * (m.k1 + c * (m.k2 + c * m.k3)));
}

/* Takes what a sample of both sides hides first. */
void hide(inout March march, Slice s, Masks m, reals fall, Offset offset, reals z)
{
    bools seen = greaterThan(z, reals(0.0));
    reals x, y;
    slice_points(s, offset, mix(both(s.center_z), z, seen), x, y);
    if (!ORTHOGRAPHIC) /* see is_seen */
        seen = bools(ivec4(seen) * ivec4(greaterThan(x, reals(0.0))));
    reals height = mix(reals(0.0), y + x * fall, seen);
    reals gap = x - march.last_x, rise = height - march.last_height;
    bools joined = lessThanEqual(abs(rise), VKAO_VBAO_JOIN * gap);
    reals unseen = gap - VKAO_VBAO_GAP_RISE * rise;
    reals inner_x = x - VKAO_VBAO_GAP_FRONT * unseen;
    reals front_x = mix(x, inner_x, greaterThan(height, reals(0.0)));
    front_x = mix(front_x, x, joined);
    reals width = greater(width_of(z), params.thickness_gap * unseen);
    reals thick_y = y - params.thickness_seen * lesser(width, params.thickness_base +
                                                                  params.thickness_slope * x);
    reals back_x = x + VKAO_VBAO_GAP_BACK * gap;
    reals front = y / sqrt(front_x * front_x + y * y);
    reals back = thick_y / sqrt(back_x * back_x + thick_y * thick_y);
    front = mix(front, greater(front, march.last_front), joined);
    march.upper = mix(m.k0, march.upper, joined);
    /* Without a sign: a driver then sees that nothing is shifted by more. */
    uvec4 high = uvec4(sector(m, greater(front - params.bias_cosine, m.low), march.upper)),
          low = uvec4(sector(m, greater(back, m.low), m.k0));
    high = min(high, uvec4(SECTORS));
    low = min(low, high);
    ints bits = (ints(1) << high) - (ints(1) << low);
    bits = mix(ints(0), bits, seen);
    ints fresh = bits & ~march.mask;
    march.mask |= bits;
    reals near_y = lesser(max(thick_y, reals(0.0)), y);
    reals w = falloff_weight(inner_x * inner_x + near_y * near_y) * reals(bitCount(fresh));
    march.hidden += w;
    if (BENT_NORMALS) {
        reals middle = clamp(0.5 * (front + max(back, m.low)), reals(-1.0), reals(1.0));
        w *= m.mass;
        march.out_moment += w * SIDES * sqrt(max(reals(0.0), 1.0 - middle * middle));
        march.eye_moment += w * middle;
    }
    march.last_x = x;
    march.last_height = height;
    march.last_front = mix(reals(-2.0), front, seen);
}

/* What a slice loses of its mass, weighted, and of its moment along O and along V. */
struct Hidden {
    real mass, out_moment, eye_moment;
};

real both_sides(reals sectors)
{
    return (first_side(sectors) + other_side(sectors)) * (1.0 / SECTORS);
}

/* Steps beyond the last hide nothing. */
void take_step(inout March march, Slice s, Masks m, reals fall, ivec2 texel, Steps steps, uint t)
{
    Offset offset = step_offset(s, steps, t, VKAO_VBAO_STEP_LEAST);
    reals z = load_sides(texel, offset);
    if (STEPS % chunk() != 0u)
        z = t < STEPS ? z : reals(0.0);
    hide(march, s, m, fall, offset, z);
}

Hidden hidden_mass(Slice s, ivec2 texel, real jitter)
{
    float reach = params.radius;
    reach *= THRESHOLD ? VKAO_VBAO_REACH_THRESHOLD : VKAO_VBAO_REACH_SMOOTH;
    reals fall = SIDES * both(s.fall);
    Masks m = make_masks(SIDES * both(s.sin_n), both(s.cos_n));
    const reals none = reals(0.0);
    Steps steps = make_steps(s, jitter, reach, VKAO_VBAO_STEP_LINEAR);
    March march =
        March(ints(0), none, none, reals(-2.0), m.k0 - VKAO_VBAO_ROUND_LESS, none, none, none);
    uint t = 0u;
    /* A loop that is gone through once is none: a driver in software would count lanes for it. */
    [[dont_unroll]] for (;;) {
        [[unroll]] for (uint i = 0u; i < chunk(); ++i)
            take_step(march, s, m, fall, texel, steps, t + i);
        t += chunk();
        if (STEPS == chunk() || t >= step_count())
            break;
    }
    return Hidden(both_sides(march.hidden * m.mass), both_sides(march.out_moment),
                  both_sides(march.eye_moment));
}

void add_slice(inout Visibility v, uint k, ivec2 texel, Real3 position, Real3 normal, Planes plane,
               Real3 to_eye, Noise noise)
{
    float share = 1.0 / float(slice_count());
    Slice s = make_slice((float(k) + noise.turn) * share, position, normal, plane, to_eye);
    Hidden hidden = hidden_mass(s, texel, noise.jitter);
    v.open -= s.normal_length * hidden.mass * share;
    Real3 moment = plus(times(s.outward, hidden.out_moment), times(to_eye, hidden.eye_moment));
    v.bent = plus(v.bent, times(moment, -share * s.normal_length));
}

Visibility visibility(ivec2 texel, Real3 position, Real3 normal, Planes plane)
{
    Real3 to_eye = eye_direction(texel);
    Noise noise = texel_noise(texel, slice_count());
    /* The mean direction of an open hemisphere is 2/3 of its normal. */
    Visibility v = Visibility(times(normal, real(2.0 / 3.0)), real(1.0));
    uint k = 0u;
    [[dont_unroll]] for (;;) {
        add_slice(v, k, texel, position, normal, plane, to_eye, noise);
        if (SLICES == 1u || ++k >= slice_count())
            break;
    }
    return v;
}
