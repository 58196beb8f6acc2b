/* SPDX-License-Identifier: MIT
 *
 * Where depth breaks between a texel and the next one of its row, or column, in words of 32 bits:
 * what width.comp counts. A change of depth is a break where it is far more than the smaller change
 * beside it, which a plane at any tilt is not. An invocation has a word. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#define VKAO_GLSL
#include "params.h"

layout(local_size_x = VKAO_GROUP_WIDTH, local_size_y = VKAO_GROUP_HEIGHT) in;
layout(push_constant) uniform Block { vkao_dispatch here; };
#include "settings.glsl"
#include "view_z.glsl"
#include "breaks.glsl"

/* Of background, and of what lies outside: no smaller change is beside that. */
const float NOTHING = 1.0e30;

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
    /* Along the axis: texels before the first and behind the last. */
    int begin = VERTICAL ? first.y : first.x, left = (VERTICAL ? size.y : size.x) - begin;
    ivec2 at = low + first;
    float before = begin > 0 ? depth_at(at - axis) : NOTHING, z = depth_at(at);
    float next = left > 1 ? depth_at(at + axis) : NOTHING;
    uint bits = 0u;
    int count = min(left - 1, 32);
    for (int i = 0; i < count; ++i) {
        float behind = i + 2 < left ? depth_at(at + (i + 2) * axis) : NOTHING;
        float beside = min(abs(z - before), abs(behind - next));
        float least = params.break_least * (ORTHOGRAPHIC ? 1.0 : min(z, next));
        bool is_break = next >= NOTHING || abs(next - z) > VKAO_VBAO_BREAK_RISE * beside + least;
        bits |= is_break ? 1u << i : 0u;
        before = z;
        z = next;
        next = behind;
    }
    store_breaks(word, bits);
}
