/* SPDX-License-Identifier: MIT
 *
 * Depth of any encoding -> positive view z, once, so that no later tap divides. Background becomes
 * 0, as does all that is not valid. At half resolution every second texel of every second row is
 * taken as it is: an average of depths is no depth. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#define VKAO_GLSL
#include "params.h"

layout(local_size_x = VKAO_GROUP_WIDTH, local_size_y = VKAO_GROUP_HEIGHT) in;
layout(push_constant) uniform Block { vkao_dispatch here; };
#include "settings.glsl"
layout(binding = VKAO_BINDING_VIEW_Z_WRITE) uniform writeonly image2D view_z_image;
#include "columns.glsl"
#include "depth.glsl"

void main()
{
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy) - ivec2(VKAO_VIEW_Z_BLOCKS, VKAO_VIEW_Z_BORDER);
    ivec2 end = ivec2((params.view_z_columns - 1u) * BLOCKS,
                      unpack_texel(here.rect.y).y + VKAO_VIEW_Z_BORDER);
    if (any(greaterThanEqual(texel, end)))
        return;
    float z = in_rect(texel, params.valid) ? view_z_from_depth(texel << GRID_SHIFT) : 0.0;
    imageStore(view_z_image, view_z_place(texel), vec4(z));
}
