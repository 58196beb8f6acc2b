/* SPDX-License-Identifier: MIT
 *
 * What a pass is compiled for, and what a recording says: see shaders/params.h. */
#ifndef VKAO_SETTINGS_GLSL_
#define VKAO_SETTINGS_GLSL_

layout(constant_id = VKAO_SETTING_DEPTH_ENCODING) const uint DEPTH_ENCODING = 0u;
layout(constant_id = VKAO_SETTING_NORMAL_ENCODING) const uint NORMAL_ENCODING = 0u;
layout(constant_id = VKAO_SETTING_BENT_ENCODING) const uint BENT_ENCODING = 0u;
layout(constant_id = VKAO_SETTING_ORTHOGRAPHIC) const bool ORTHOGRAPHIC = false;
layout(constant_id = VKAO_SETTING_GRID_SHIFT) const uint GRID_SHIFT = 0u;
layout(constant_id = VKAO_SETTING_BENT_NORMALS) const bool BENT_NORMALS = false;
layout(constant_id = VKAO_SETTING_THRESHOLD) const bool THRESHOLD = false;
layout(constant_id = VKAO_SETTING_SPHERE_LITERAL) const bool SPHERE_LITERAL = false;
layout(constant_id = VKAO_SETTING_SLICES) const uint SLICES = 0u;
layout(constant_id = VKAO_SETTING_STEPS) const uint STEPS = 0u;
layout(constant_id = VKAO_SETTING_SAMPLES) const uint SAMPLES = 0u;
layout(constant_id = VKAO_SETTING_BLUR_RADIUS) const int RADIUS = 0;
layout(constant_id = VKAO_SETTING_BLUR_NORMAL_POWER) const float NORMAL_POWER = 0.0;
layout(constant_id = VKAO_SETTING_COMPOSITE_MODE) const uint COMPOSITE_MODE = 0u;
layout(constant_id = VKAO_SETTING_MULTI_BOUNCE) const bool MULTI_BOUNCE = false;
layout(constant_id = VKAO_SETTING_SPECULAR) const uint SPECULAR = 0u;
layout(constant_id = VKAO_SETTING_THICKNESS_INPUT) const uint THICKNESS_INPUT = 0u;
layout(constant_id = VKAO_SETTING_SECOND_LAYER) const bool SECOND_LAYER = false;
layout(constant_id = VKAO_SETTING_NOISY_CODES) const bool NOISY_CODES = false;
layout(constant_id = VKAO_SETTING_TILE_WORDS) const uint TILE_WORDS = 2u;
layout(constant_id = VKAO_SETTING_HALF_AO) const bool HALF_AO = false;
layout(constant_id = VKAO_SETTING_HALF_NOISY) const bool HALF_NOISY = false;
layout(constant_id = VKAO_SETTING_VERTICAL) const bool VERTICAL = false;
layout(constant_id = VKAO_SETTING_TONED) const bool TONED = false;

/* Of the bits in view z that have thickness. */
const bool IS_GIVEN = THICKNESS_INPUT != VKAO_GLSL_THICKNESS_AS_SEEN;
const int THICKNESS_SHIFT = VKAO_THICKNESS_SHIFT - (IS_GIVEN ? VKAO_THICKNESS_FINER : 0);
const int THICKNESS_MASK =
    IS_GIVEN ? (VKAO_THICKNESS_MASK + 1 << VKAO_THICKNESS_FINER) - 1 : VKAO_THICKNESS_MASK;

/* All that is read is read first: behind a branch and in a loop a driver in software reads a
 * constant lane by lane. Compilers for GPUs drop what is not used. */
layout(binding = VKAO_BINDING_CONSTANTS) uniform Constants { vkao_constants constants; };
vkao_constants params = constants;

ivec2 unpack_texel(uint packed_texel)
{
    return ivec2(packed_texel & 0xffffu, packed_texel >> 16);
}

bool in_rect(ivec2 texel, uvec2 rect)
{
    return all(greaterThanEqual(texel, unpack_texel(rect.x))) &&
           all(lessThan(texel, unpack_texel(rect.y)));
}

/* These are at least 1. Loops over them test at their end, as a driver in software goes through a
 * body once more to find that no lane is left. */
uint slice_count()
{
    return SLICES != 0u ? SLICES : params.slices;
}

uint step_count()
{
    return STEPS != 0u ? STEPS : params.steps;
}

uint sample_count()
{
    return SAMPLES != 0u ? SAMPLES : params.samples;
}

/* Is it a number, and not absurdly large? By its bits: compilers may assume of floats that they are
 * numbers. */
bool is_sane(float v)
{
    return (floatBitsToUint(v) & 0x7fffffffu) < floatBitsToUint(VKAO_LARGEST_RESULT);
}

#endif
