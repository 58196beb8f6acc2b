/* SPDX-License-Identifier: MIT
 *
 * Depth of any encoding -> positive view z, once, so that no later tap divides. Background becomes 0. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#define VKAO_GLSL
#include "params.h"

layout(local_size_x = VKAO_GROUP_WIDTH, local_size_y = VKAO_GROUP_HEIGHT) in;
layout(push_constant) uniform Block { vkao_prepare_block params; };
layout(binding = VKAO_BINDING_DEPTH) uniform texture2D depth_image;
layout(binding = VKAO_BINDING_VIEW_Z, r32f) uniform writeonly image2D view_z_image;

/* z/w beyond 0 or 1 cannot have been rasterised; what is at or past the far plane is background. */
float from_projected(float depth)
{
    bool far = params.far_depth > 0.5 ? depth >= 1.0 : depth <= 0.0;
    float z = params.orthographic != 0u ? params.linearize.x + params.linearize.y * depth
                                        : params.linearize.x / (params.linearize.y - depth);
    return far ? 0.0 : z;
}

void main()
{
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy) + ivec2(params.valid.x & 0xffffu, params.valid.x >> 16);
    if (texel.x >= int(params.valid.y & 0xffffu) || texel.y >= int(params.valid.y >> 16))
        return;
    float depth = texelFetch(depth_image, texel, 0).x;
    float z = depth;
    if (params.depth_encoding == VKAO_GLSL_DEPTH_PROJECTED)
        z = from_projected(depth);
    else if (params.depth_encoding == VKAO_GLSL_DEPTH_INVERSE_Z)
        z = 1.0 / depth;
    else if (params.depth_encoding == VKAO_GLSL_DEPTH_DISTANCE && params.orthographic == 0u)
        z = depth * inversesqrt(1.0 + dot(texel * params.unproject.xy + params.unproject.zw,
                                          texel * params.unproject.xy + params.unproject.zw));
    /* Comparisons with NaN are false, so NaN is background too. */
    bool valid = z > 0.0 && z < params.far_z;
    imageStore(view_z_image, texel, vec4(valid ? z : 0.0));
}
