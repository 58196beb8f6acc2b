/* SPDX-License-Identifier: MIT
 *
 * ../ssao_hemisphere.comp for two texels side by side. The kernel is turned with its frame, and
 * points are projected by one division, without going through view space. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_shader_16bit_storage : enable
#extension GL_EXT_samplerless_texture_functions : require
#extension GL_EXT_control_flow_attributes : require
#define VKAO_GLSL
#include "params.h"
#include "ssao.glsl"
#include "kernel.glsl"

/* What a step in view space adds to (x, y, 1) * z, in perspective, or (x, y, z), x and y being
 * texels off the shaded one, which is seen at sight * z. A point is projected by one division,
 * without going through view space. */
Real3 to_texels(Real3 direction, Real3 sight)
{
    real x = direction.x, y = direction.y;
    if (!ORTHOGRAPHIC) {
        x -= sight.x * direction.z;
        y -= sight.y * direction.z;
    }
    return Real3(x * params.inverse_unproject.x, y * params.inverse_unproject.y, direction.z);
}

Real3 weighted(Real3 a, real wa, Real3 b, real wb)
{
    return plus(times(a, wa), times(b, wb));
}

/* One coordinate of the directions of a pair: as high, and across the normal from each other. */
reals mirrored(float height, real up, vec2 at, real across, real along)
{
    return both(height * up) + SIDES * both(at.x * across + at.y * along);
}

/* cos and sin of 2 pi u, off by less than 1.4e-5. */
Real2 full_turn(real u)
{
    real x = half_turn_x(u), y = half_turn_y(u);
    return Real2(x * x - y * y, 2.0 * x * y);
}

/* View z of the texels nearest to points that are some texels off. */
reals load_nearest(ivec2 texel, RoundedSides x, RoundedSides y)
{
    ivec2 origin = border_texel(texel - ROUND_BITS);
    whole origin_x = origin.x + whole(BESIDE);
    return border_view_zs(x.bits + ints(origin_x, origin_x), y.bits + origin.y);
}

Visibility visibility(ivec2 texel, Real3 position, Real3 normal, Planes plane)
{
    float radius = params.radius;
    Real3 sight = view_positions(texel, real(1.0));
    Real3 t, b;
    tangents(normal, t, b);
    /* The kernel is turned with its frame, which is as long as the radius: the directions in it are
     * constants then. */
    Noise noise = texel_noise(texel, 1u);
    Real2 turn = full_turn(noise.turn);
    turn = Real2(turn.x * radius, turn.y * radius);
    Real3 across = to_texels(weighted(t, turn.x, b, turn.y), sight);
    Real3 along = to_texels(weighted(b, turn.x, t, -turn.y), sight);
    Real3 up = to_texels(times(normal, real(radius)), sight);
    /* stands_in_front, in texels and radii: the height of an occluder is dot(normal, occluder) -
     * dot(normal, position), and in perspective the latter is position.z times that of where the
     * texel is seen. */
    Real3 n = times(normal, real(params.inverse_radius));
    real slope_x = n.x * params.unproject.x, slope_y = n.y * params.unproject.y;
    real facing = ORTHOGRAPHIC ? n.z : n.x * sight.x + n.y * sight.y + n.z;
    real least =
        (params.bias + depth_error(position.z)) * params.inverse_radius + facing * position.z;
    uint pairs = (sample_count() + 1u) / 2u, k = 0u;
    reals blocked = reals(0.0);
    [[unroll]] for (;;) {
        float r2 = (float(k) + 0.5) / float(pairs), r = sqrt(r2), height = sqrt(1.0 - r2);
        float angle = float(k) * GOLDEN_ANGLE;
        vec2 at = r * vec2(cos(angle), sin(angle));
        reals len = pair_lengths(k, pairs, noise.jitter);
        reals x = len * mirrored(height, up.x, at, across.x, along.x);
        reals y = len * mirrored(height, up.y, at, across.y, along.y);
        reals z = both(position.z) + len * mirrored(height, up.z, at, across.z, along.z);
        if (!ORTHOGRAPHIC) {
            reals inverse = 1.0 / z;
            x *= inverse;
            y *= inverse;
        }
        RoundedSides at_x = rounded(x), at_y = rounded(y);
        reals scene_z = load_nearest(texel, at_x, at_y);
        reals over = both(slope_x) * at_x.number + both(slope_y) * at_y.number;
        over = ORTHOGRAPHIC ? over + both(facing) * scene_z : (over + both(facing)) * scene_z;
        reals weight = range_weight(scene_z - both(position.z), radius);
        weight = mix(reals(0.0), weight, greaterThan(over, height * len + both(least)));
        blocked += mix(reals(0.0), weight, greaterThan(lesser(scene_z, z), reals(0.0)));
        if (++k >= pairs)
            break;
    }
    real sum = first_side(blocked) + other_side(blocked);
    return Visibility(Real3(real(0.0), real(0.0), real(0.0)), 1.0 - sum / float(2u * pairs));
}
