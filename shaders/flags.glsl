/* SPDX-License-Identifier: MIT
 *
 * The flags of shaders/params.h, from the variant's constant or from the push constants. The includer defines params
 * before. */
#ifndef VKAO_FLAGS_GLSL_
#define VKAO_FLAGS_GLSL_

layout(constant_id = VKAO_CONSTANT_FLAGS) const uint FLAGS = VKAO_FLAGS_UNKNOWN;
layout(constant_id = VKAO_CONSTANT_BENT_NORMALS) const bool BENT_NORMALS = false;

uint flags()
{
    return FLAGS != VKAO_FLAGS_UNKNOWN ? FLAGS : params.flags;
}

bool flag(uint bit)
{
    return (flags() & bit) != 0u;
}

bool orthographic()
{
    return flag(VKAO_FLAG_ORTHOGRAPHIC);
}

uint normal_encoding()
{
    return (flags() >> VKAO_FLAG_NORMALS_SHIFT) & 7u;
}

uint bent_encoding()
{
    return (flags() >> VKAO_FLAG_BENT_SHIFT) & 7u;
}

uint depth_encoding()
{
    return (flags() >> VKAO_FLAG_DEPTH_SHIFT) & 3u;
}

uint staged_format()
{
    return (flags() >> VKAO_FLAG_STAGED_SHIFT) & 7u;
}

/* Is it a number, and not absurdly large? By its bits: compilers may assume of floats that they are numbers. */
bool is_sane(float v)
{
    return (floatBitsToUint(v) & 0x7fffffffu) < floatBitsToUint(VKAO_LARGEST_RESULT);
}

/* texel << grid_shift() is the image's. */
uint grid_shift()
{
    return flag(VKAO_FLAG_HALF_RESOLUTION) ? 1u : 0u;
}

#endif
