/* SPDX-License-Identifier: MIT
 *
 * Thickness from the width of a surface, and where that ends. Lengths are fractions of the radius
 * or of the view, so that the same scene at another resolution has the same. */
#ifndef VKAO_THICKNESS_GLSL_
#define VKAO_THICKNESS_GLSL_

#include "real.glsl"

/* Of background, and of what lies outside: no smaller change is beside that. */
const float NOTHING = 1.0e30;

/* Depth breaks between z and the next of four texels in a row if it changes by more: by far more
 * than by the smaller change beside, which a plane at any tilt does not. */
real break_limit(real before, real z, real next, real behind)
{
    real beside = min(abs(z - before), abs(behind - next));
    real least = params.break_least * (ORTHOGRAPHIC ? real(1.0) : min(z, next));
    return VKAO_VBAO_BREAK_RISE * beside + least;
}

/* Above 0 where it does, and before what is nothing. */
real break_between(real before, real z, real next, real behind)
{
    return max(abs(next - z) - break_limit(before, z, next, behind), next - 0.5 * NOTHING);
}

/* How far a surface is followed to each side, in a row and in a column: in steps of texels, fewer
 * than the 32 that a word of breaks has. In large images a step is several texels, 1 << shift. */
struct Reach {
    ivec2 shift, steps;
};

Reach width_reach()
{
    vec2 reach = params.width_reach * abs(params.inverse_unproject) + 0.5;
    ivec2 texels = ivec2(clamp(reach, vec2(1.0), vec2(65535.0)));
    ivec2 shift = findMSB(texels >> 5) + 1;
    return Reach(shift, texels >> shift);
}

/* View z with a thickness, in radii, in its last bits. */
real with_code(real z, real thickness)
{
    whole code = floatBitsToInt(thickness) - VKAO_THICKNESS_LEAST_BITS;
    code = (code + (1 << (THICKNESS_SHIFT - 1))) >> THICKNESS_SHIFT;
    code = clamp(code, whole(0), whole(THICKNESS_MASK));
    code = min(code, floatBitsToInt(z)); /* background stays 0 */
    return intBitsToFloat((floatBitsToInt(z) & ~THICKNESS_MASK) | code);
}

/* The same with what is seen. along_x, along_y: shares of a step that the surface goes on for to
 * both sides in the row and in the column; where it ends nowhere, to how far is unknown. */
real with_thickness(real z, whole along_x, whole along_y, Reach reach)
{
    vec2 texel = params.inverse_radius * abs(params.unproject.xy);
    vec2 share = texel * vec2(ivec2(1) << reach.shift) * (1.0 / VKAO_VBAO_WIDTH_SHARES);
    real width_x = texel.x + share.x * real(along_x), width_y = texel.y + share.y * real(along_y);
    real width =
        mix(min(width_x, width_y), max(width_x, width_y), real(VKAO_VBAO_THICKNESS_LENGTH));
    width *= VKAO_VBAO_THICKNESS_WIDTH * (ORTHOGRAPHIC ? real(1.0) : z);
    /* 0 where none is left. */
    whole all = whole(2 * VKAO_VBAO_WIDTH_SHARES * (reach.steps.x + reach.steps.y));
    real left = real(min(all - along_x - along_y, whole(1)));
    width *= VKAO_VBAO_THICKNESS_WIDER - (VKAO_VBAO_THICKNESS_WIDER - 1.0) * left;
    return with_code(z, min(width, real(VKAO_VBAO_THICKNESS_WIDE)));
}

#endif
