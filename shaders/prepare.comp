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
#include "depth.glsl"

void main()
{
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy) - VKAO_VIEW_Z_BORDER;
    if (any(greaterThanEqual(texel, unpack_texel(here.rect.y) + VKAO_VIEW_Z_BORDER)))
        return;
    float z = in_rect(texel, params.valid) ? view_z_from_depth(texel << GRID_SHIFT) : 0.0;
    imageStore(view_z_image, texel + VKAO_VIEW_Z_BORDER, vec4(z));
}
