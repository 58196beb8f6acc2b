/* SPDX-License-Identifier: MIT
 *
 * Visibility bitmask (Therrien, Levesque and Gilet, 'Screen Space Indirect Lighting with Visibility Bitmask', 2023),
 * made cosine-correct. A sample hides the angles from its front edge to its back edge, thickness behind it, so that
 * light passes behind thin things. With c = cos theta, the slice's density cos(theta - n) |sin theta| dtheta becomes
 * (cos n * c + sin n * sqrt(1 - c^2)) dc, whose integral is
 *     G(c) = cos n * c^2 / 2 + sin n * g(c),   g(c) = (c sqrt(1 - c^2) + asin c) / 2.
 * Each side has its own mask of 31 sectors of equal mass between the tangent plane, c = -sin n, and V, c = 1: a sector
 * bound costs a square root and a polynomial, two of them a division, and no angle. Samples come near to far and only
 * sectors that they hide first count, with the falloff at the hiding point: the definition of the ray-traced truths.
 *
 * The depth image is sampled in few places; what lies between two samples of a side is guessed:
 *  - a sample is joined to the one before if the surface between them rises less than VKAO_VBAO_JOIN
 *    over the tangent plane, as any plane does; then all between is hidden;
 *  - if not, and if it rises over that plane, its front edge moves in by VKAO_VBAO_GAP_FRONT of the gap, as an edge lies
 *    somewhere in it;
 *  - what it hides counts by the distance to there, joined or not: the nearest that it stands for hides first;
 *  - its back edge moves out by VKAO_VBAO_GAP_BACK of the gap, as the surface goes on to somewhere before the next sample;
 *  - sky hides nothing; what follows it is looked at as after a sample of the tangent plane;
 *  - what is seen is as thick as VKAO_THICKNESS_BASE of the radius plus VKAO_THICKNESS_SLOPE of its lateral distance. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_shader_16bit_storage : enable
#extension GL_EXT_samplerless_texture_functions : require
#extension GL_EXT_control_flow_attributes : require
#define VKAO_GLSL
#include "params.h"
#define VKAO_SIDE_BY_SIDE
#include "ssao.glsl"
#include "horizon.glsl"

const float SECTORS = 31.0;

/* Is all to be unrolled, steps and slices? Unknown counts, 0, are not. */
bool unrolls()
{
    return SLICES * STEPS - 1u < VKAO_VBAO_MOST_UNROLLED;
}

/* Steps that are unrolled in a loop over the rest. */
uint chunk()
{
    uint chunks = (STEPS + VKAO_VBAO_MOST_AT_ONCE - 1u) / VKAO_VBAO_MOST_AT_ONCE;
    return STEPS == 0u ? 1u : (STEPS + chunks - 1u) / chunks;
}

/* c (G1 + G3 c^2) fits g(c) over [-1, 1]. Its largest error is .0053. On the side that the normal
 * leans to that moves a sector bound by .21 of a sector at most. On the other side sectors are small:
 * there it moves by .0104 of the slice's integral at most. */
const float G1 = 1.0225, G3 = -0.232;

reals g(reals c)
{
    return c * (G1 + c * c * G3);
}

/* Sector bound of cosine c is the polynomial k0 + k1 c + k2 c^2 + k3 c^3, inside the side's mass. */
struct Masks {
    reals low; /* cosine of the tangent plane */
    reals mass;
    reals k0, k1, k2, k3;
};

Masks make_masks(Slice s)
{
    Masks m;
    reals sn = SIDES * both(s.sin_n), cn = both(0.5 * s.cos_n);
    m.low = -sn;
    reals below = cn * m.low * m.low + sn * g(m.low);
    m.mass = max(cn + sn * (G1 + G3) - below, reals(1.0e-4));
    reals scale = SECTORS / m.mass;
    m.k0 = VKAO_VBAO_ROUND - below * scale;
    m.k2 = cn * scale;
    sn *= scale;
    m.k1 = G1 * sn;
    m.k3 = G3 * sn;
    return m;
}

/* At least 0, but for rounding not always at most 31. */
ints sector(Masks m, reals c)
{
    c = greater(c, m.low);
    return ints(m.k0 + c * (m.k1 + c * (m.k2 + c * m.k3)));
}

/* How far a march of both sides has come. */
struct March {
    ints mask; /* sectors that are hidden */
    reals last_x, last_height, last_front;
    reals hidden; /* sectors, weighted */
    reals out_moment, eye_moment;
};

/* Takes what a sample of both sides hides first. */
void hide(inout March march, Slice s, Masks m, reals tangent, Offset offset, reals z)
{
    bools seen = greaterThan(z, reals(0.0));
    reals x, y;
    slice_points(s, offset, mix(both(s.center_z), z, seen), x, y);
    reals gap = x - march.last_x, height = mix(reals(0.0), y + x * tangent, seen);
    bools joined = lessThan(abs(height - march.last_height), VKAO_VBAO_JOIN * abs(gap));
    reals inner_x = x - VKAO_VBAO_GAP_FRONT * gap;
    reals front_x = mix(x, inner_x, greaterThan(height, reals(0.0)));
    front_x = mix(front_x, x, joined);
    reals thick_y = y - (params.thickness_base + params.thickness_slope * x);
    reals back_x = x + VKAO_VBAO_GAP_BACK * gap;
    /* Cosines of both edges by one division. */
    reals front_length = sqrt(front_x * front_x + y * y);
    reals back_length = sqrt(back_x * back_x + thick_y * thick_y);
    reals inverse = 1.0 / (front_length * back_length);
    reals front = y * (back_length * inverse), back = thick_y * (front_length * inverse);
    front = greater(front, mix(reals(-2.0), march.last_front, joined));
    ints high = min(sector(m, front - params.bias_cosine), ints(31)), low = min(sector(m, back), high);
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
void take_step(inout March march, Slice s, Masks m, reals tangent, ivec2 texel, Steps steps, uint t)
{
    Offset offset = step_offset(s, steps, t);
    reals z = load_sides(texel, offset);
    if (STEPS % chunk() != 0u)
        z = t < STEPS ? z : reals(0.0);
    hide(march, s, m, tangent, offset, z);
}

Hidden hidden_mass(Slice s, ivec2 texel, real jitter, bool unrolled)
{
    float reach = params.radius;
    reach *= THRESHOLD ? VKAO_VBAO_REACH_THRESHOLD : VKAO_VBAO_REACH_SMOOTH;
    reals tangent = SIDES * both(s.sin_n / max(s.cos_n, real(VKAO_STEEPEST)));
    Masks m = make_masks(s);
    const reals none = reals(0.0);
    Steps steps = make_steps(s, jitter, reach);
    March march = March(ints(0), none, none, reals(-2.0), none, none, none);
    if (unrolled) {
        [[unroll]] for (uint t = 0u; t < STEPS; ++t)
            take_step(march, s, m, tangent, texel, steps, t);
    } else {
        uint t = 0u;
        [[dont_unroll]] for (;;) {
            [[unroll]] for (uint i = 0u; i < chunk(); ++i)
                take_step(march, s, m, tangent, texel, steps, t + i);
            t += chunk();
            if (t >= step_count())
                break;
        }
    }
    return Hidden(both_sides(march.hidden * m.mass), both_sides(march.out_moment), both_sides(march.eye_moment));
}

void add_slice(inout Visibility v, uint k, ivec2 texel, Real3 position, Real3 normal, Real3 to_eye, real turn,
               real jitter, bool unrolled)
{
    float share = 1.0 / float(slice_count());
    Slice s = make_slice((float(k) + turn) * share, position, normal, to_eye);
    Hidden hidden = hidden_mass(s, texel, jitter, unrolled);
    v.open -= s.normal_length * hidden.mass * share;
    Real3 moment = plus(times(s.outward, hidden.out_moment), times(to_eye, hidden.eye_moment));
    v.bent = plus(v.bent, times(moment, -share * s.normal_length));
}

Visibility visibility(ivec2 texel, Real3 position, Real3 normal)
{
    Real3 to_eye = eye_direction(texel);
    Noise noise = texel_noise(texel, slice_count());
    /* The mean direction of an open hemisphere is 2/3 of its normal. */
    Visibility v = Visibility(times(normal, real(2.0 / 3.0)), real(1.0));
    if (unrolls()) {
        [[unroll]] for (uint k = 0u; k < SLICES; ++k)
            add_slice(v, k, texel, position, normal, to_eye, noise.turn, noise.jitter, true);
    } else {
        uint k = 0u;
        [[dont_unroll]] for (;;) {
            add_slice(v, k, texel, position, normal, to_eye, noise.turn, noise.jitter, false);
            if (++k >= slice_count())
                break;
        }
    }
    return v;
}
