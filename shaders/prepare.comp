/* SPDX-License-Identifier: MIT
 *
 * Depth of any encoding -> positive view z, once, so that no later tap divides. Background becomes
 * 0, as does all that is not valid. At half resolution every second texel of every second row is
 * taken as it is: an average of depths is no depth. An invocation takes two by two texels. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#extension GL_EXT_control_flow_attributes : require
#define VKAO_GLSL
#include "params.h"

layout(local_size_x = VKAO_GROUP_WIDTH, local_size_y = VKAO_GROUP_HEIGHT) in;
layout(push_constant) uniform Block { vkao_dispatch here; };
#include "settings.glsl"
layout(binding = VKAO_BINDING_VIEW_Z_WRITE) uniform writeonly image2D view_z_image;
#include "columns.glsl"
#include "depth.glsl"
#include "gathered.glsl"
layout(binding = VKAO_BINDING_NEAREST) uniform sampler nearest;

vec4 gather_depths(ivec2 texel)
{
    if (GRID_SHIFT == 0u)
        return textureGather(sampler2D(depth_image, nearest), vec2(texel) + 1.0);
    vec4 depths;
    [[unroll]] for (int i = 0; i < 4; ++i)
        depths[GATHERED[i >> 1][i & 1]] =
            textureLod(sampler2D(depth_image, nearest),
                       vec2(texel + ivec2(i & 1, i >> 1) << GRID_SHIFT) + 0.5, 0.0)
                .x;
    return depths;
}

void main()
{
    ivec2 first =
        2 * ivec2(gl_GlobalInvocationID.xy) - ivec2(VKAO_VIEW_Z_BLOCKS, VKAO_VIEW_Z_BORDER);
    ivec2 end = ivec2((params.view_z_columns - 1u) * BLOCKS,
                      unpack_texel(here.rect.y).y + VKAO_VIEW_Z_BORDER);
    if (any(greaterThanEqual(first, end)))
        return;
    vec4 depths = gather_depths(first);
    ivec2 place = view_z_place(first), right = view_z_place(first + ivec2(1, 0));
    [[unroll]] for (int i = 0; i < 4; ++i) {
        ivec2 beside = ivec2(i & 1, i >> 1), texel = first + beside;
        float z = view_z_of(depths[GATHERED[beside.y][beside.x]], texel << GRID_SHIFT);
        /* Columns are even in number, rows need not be. */
        if (texel.y < end.y)
            imageStore(view_z_image, (beside.x == 0 ? place : right) + ivec2(0, beside.y),
                       vec4(in_rect(texel, params.valid) ? z : 0.0));
    }
}
