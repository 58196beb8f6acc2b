/* SPDX-License-Identifier: MIT
 *
 * Normal-oriented hemisphere (Filion and McNaughton, 'StarCraft II: Effects and Techniques', 2008), with a
 * cosine-weighted kernel: direction k of n lies over the point k of a Fibonacci disk,
 *     r = sqrt((k + 1/2) / n), angle = k * golden angle + noise, height sqrt(1 - r^2),
 * so that the mean over k needs no weights. Lengths are stratified over k by the golden ratio and a second noise;
 * their distribution carries the falloff, see point_length. A point is blocked if the scene stands in front of it;
 * each blocked point counts by range_weight. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#extension GL_EXT_control_flow_attributes : require
#define VKAO_GLSL
#include "params.h"
#define VKAO_SIDE_BY_SIDE
#include "ssao.glsl"

/* Directions on their way to texels: what a step in view space adds to (texel, 1) * z, in perspective, or (texel, z). A
 * point is projected by one division, without going through view space. */
Real3 to_texels(Real3 direction)
{
    real x = direction.x, y = direction.y;
    if (!orthographic()) {
        x -= params.unproject.z * direction.z;
        y -= params.unproject.w * direction.z;
    }
    return Real3(x * params.inverse_unproject.x, y * params.inverse_unproject.y, direction.z);
}

Real3 weighted(Real3 a, real wa, Real3 b, real wb)
{
    return plus(times(a, wa), times(b, wb));
}

/* View z of the texels nearest to some points. */
real load_rounded(Rounded x, Rounded y)
{
    ivec2 to_border = border_texel(ivec2(-ROUND_BITS));
    whole at_x = x.bits + to_border.x, at_y = y.bits + to_border.y;
    float z[TEXELS];
    [[unroll]] for (int i = 0; i < TEXELS; ++i)
        z[i] = border_view_z(ivec2(lane(at_x, i), lane(at_y, i)));
    return join(z);
}

Visibility visibility(ivec2 texel, Real3 position, Real3 normal)
{
    float radius = params.normal_x.w;
    Real3 t, b;
    tangents(normal, t, b);
    /* The kernel is turned with its frame: the directions in it are constants then. */
    Noise noise = texel_noise(texel, 1u);
    Real2 turn = full_turn(noise.turn);
    Real3 across = to_texels(weighted(t, turn.x, b, turn.y)), along = to_texels(weighted(b, turn.x, t, -turn.y));
    Real3 up = to_texels(normal);
    real center_x = float(texel.x) + BESIDE, center_y = real(float(texel.y));
    if (!orthographic()) {
        center_x *= position.z;
        center_y *= position.z;
    }
    /* stands_in_front, in texels: the height of an occluder is dot(normal, occluder) - dot(normal, position). */
    real slope_x = normal.x * params.unproject.x, slope_y = normal.y * params.unproject.y;
    real level = normal.x * params.unproject.z + normal.y * params.unproject.w;
    level += orthographic() ? real(0.0) : normal.z;
    real least = dot3(normal, position) + params.normal_y.w + depth_error(position.z);
    real blocked = real(0.0);
    [[unroll]] for (uint k = 0u; k < sample_count(); ++k) {
        float r2 = (float(k) + 0.5) / float(sample_count()), r = sqrt(r2), height = sqrt(1.0 - r2);
        float angle = float(k) * GOLDEN_ANGLE;
        float a = r * cos(angle), c = r * sin(angle);
        real len = point_length(fract(golden_sequence(k) + noise.jitter), radius);
        real x = center_x + len * (a * across.x + c * along.x + height * up.x);
        real y = center_y + len * (a * across.y + c * along.y + height * up.y);
        real z = position.z + len * (a * across.z + c * along.z + height * up.z);
        if (!orthographic()) {
            real inverse = 1.0 / z;
            x *= inverse;
            y *= inverse;
        }
        Rounded at_x = rounded(x), at_y = rounded(y);
        real scene_z = load_rounded(at_x, at_y);
        real over = slope_x * at_x.number + slope_y * at_y.number + level;
        over = orthographic() ? over + normal.z * scene_z : over * scene_z;
        real weight = range_weight(scene_z - position.z, radius);
        weight = choose(real(0.0), weight, above(over, len * height + least));
        blocked += choose(real(0.0), weight, above(min(scene_z, z), real(0.0)));
    }
    return Visibility(Real3(real(0.0), real(0.0), real(0.0)), 1.0 - blocked / float(sample_count()));
}
