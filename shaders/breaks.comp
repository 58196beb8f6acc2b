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
    ivec2 low = ivec2(params.valid.x & 0xffffu, params.valid.x >> 16), first = low & ivec2(~3, ~0);
    ivec2 size = ivec2(params.valid.y & 0xffffu, params.valid.y >> 16) - first;
    Reach reach = width_reach();
    int shift = VERTICAL ? reach.shift.y : reach.shift.x;
    ivec2 word = ivec2(gl_GlobalInvocationID.xy), axis = VERTICAL ? ivec2(0, 1) : ivec2(1, 0);
    ivec2 texel = word * (VERTICAL ? ivec2(1, 32 << shift) : ivec2(32 << shift, 1));
    if (any(greaterThanEqual(texel, size)))
        return;
    /* Along the axis: texels before these that are not valid, and up to the last valid one. */
    int begin = VERTICAL ? 0 : low.x - first.x - texel.x;
    int left = VERTICAL ? size.y - texel.y : size.x - texel.x;
    ivec2 at = first + texel;
    bool is_first = VERTICAL ? texel.y == 0 : begin >= 0;
    float before = is_first ? NOTHING : depth_at(at - axis);
    float z = begin > 0 ? NOTHING : depth_at(at);
    float next = left > 1 && begin < 2 ? depth_at(at + axis) : NOTHING;
    uint bits = 0u;
    int count = min(left - 1, 32 << shift);
    for (int i = 0; i < count; ++i) {
        float behind = i + 2 < left && i + 2 >= begin ? depth_at(at + (i + 2) * axis) : NOTHING;
        bool is_break = i >= begin && break_between(before, z, next, behind) > 0.0;
        bits |= is_break ? 1u << (i >> shift) : 0u;
        before = z;
        z = next;
        next = behind;
    }
    imageStore(breaks_image, word, uvec4(bits));
}
