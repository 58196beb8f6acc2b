/* SPDX-License-Identifier: MIT
 *
 * What vbao and raymarch may know beyond the first layer of depth: how thick it is, and the layer
 * behind it. */
#ifndef VKAO_LAYERS_GLSL_
#define VKAO_LAYERS_GLSL_

#include "second_z.glsl"

/* Thickness from the last bits of view z, without the caller's scale. least: the bits of the least
 * there is. */
vec2 width_of(vec2 z, int least)
{
    ivec2 code = floatBitsToInt(z) & THICKNESS_MASK;
    return intBitsToFloat((code << THICKNESS_SHIFT) + least);
}

vec2 thickness_of(vec2 z)
{
    return params.thickness * width_of(z, VKAO_THICKNESS_LEAST_BITS);
}

#endif
