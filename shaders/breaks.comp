/* SPDX-License-Identifier: MIT
 *
 * Where depth breaks between a texel and the next one of its row, or column, in words of 32 bits:
 * what width.comp counts. An invocation has a word. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#define VKAO_GLSL
#include "params.h"

layout(local_size_x = VKAO_GROUP_WIDTH, local_size_y = VKAO_GROUP_HEIGHT) in;
layout(push_constant) uniform Block { vkao_dispatch here; };
#include "settings.glsl"
#include "view_z.glsl"
#include "thickness.glsl"
layout(binding = VKAO_BINDING_BREAKS_WRITE) uniform writeonly uimage2D breaks_image;

float depth_at(ivec2 texel)
{
    float z = fetch_view_z(texel);
    return z > 0.0 ? z : NOTHING;
}

void main()
{
    ivec2 low = ivec2(params.valid.x & 0xffffu, params.valid.x >> 16);
    ivec2 size = ivec2(params.valid.y & 0xffffu, params.valid.y >> 16) - low;
    ivec2 word = ivec2(gl_GlobalInvocationID.xy), axis = VERTICAL ? ivec2(0, 1) : ivec2(1, 0);
    ivec2 first = word * (VERTICAL ? ivec2(1, 32) : ivec2(32, 1));
    if (any(greaterThanEqual(first, size)))
        return;
    /* Along the axis: texels before the first, and from it to the last. */
    int begin = VERTICAL ? first.y : first.x, left = (VERTICAL ? size.y : size.x) - begin;
    ivec2 at = low + first;
    float before = begin > 0 ? depth_at(at - axis) : NOTHING, z = depth_at(at);
    float next = left > 1 ? depth_at(at + axis) : NOTHING;
    uint bits = 0u;
    int count = min(left - 1, 32);
    for (int i = 0; i < count; ++i) {
        float behind = i + 2 < left ? depth_at(at + (i + 2) * axis) : NOTHING;
        bits |= break_between(before, z, next, behind) > 0.0 ? 1u << i : 0u;
        before = z;
        z = next;
        next = behind;
    }
    imageStore(breaks_image, word, uvec4(bits));
}
