/* SPDX-License-Identifier: MIT
 *
 * ../breaks.comp along columns: words of 4 columns. */
#version 450
#extension GL_GOOGLE_include_directive : require
#define VKAO_GLSL
#include "layout.h"

layout(local_size_x = VKAO_GROUP_OF(VKAO_PREPARE_WIDTH)) in;
layout(push_constant) uniform Block { vkao_dispatch here; };
#include "settings.glsl"
#include "buffers.glsl"

layout(binding = VKAO_BINDING_Z4, rgba32f) uniform readonly imageBuffer view_z4;
layout(binding = VKAO_BINDING_BREAKS_WORDS) writeonly buffer Breaks { uvec4 breaks[]; };
#define real vec4
#define whole ivec4
#include "thickness.glsl"

vec4 depths_at(int at)
{
    vec4 z = imageLoad(view_z4, at);
    return mix(vec4(NOTHING), z, greaterThan(z, vec4(0.0)));
}

void main()
{
    ivec2 low = ivec2(params.valid.x & 0xffffu, params.valid.x >> 16);
    ivec2 high = ivec2(params.valid.y & 0xffffu, params.valid.y >> 16);
    ivec2 first = ivec2(round_down(low.x, VKAO_PREPARE_WIDTH), low.y), size = high - first;
    ivec2 word = ivec2(gl_GlobalInvocationID.xy);
    int shift = width_reach().shift.y;
    ivec2 texel = word * ivec2(VKAO_PREPARE_WIDTH, 32 << shift);
    if (any(greaterThanEqual(texel, size)))
        return;
    /* Rows of zeros lie above and below. Behind the last valid texel nothing breaks. */
    int at = (z_row(first.y + texel.y) + first.x + texel.x) >> 2, row = VKAO_STRIDE >> 2;
    int left = size.y - texel.y, count = min(32 << shift, left - 1);
    vec4 before = depths_at(at - row), z = depths_at(at), next = depths_at(at + row);
    uvec4 farther = uvec4(0u), nearer = uvec4(0u);
    for (int i = 0; i < count; ++i) {
        vec4 behind = depths_at(at + min(i + 2, left) * row);
        vec4 excess = break_between(before, z, next, behind);
        uvec4 bits = mix(uvec4(0u), uvec4(1u << (i >> shift)), greaterThan(excess, vec4(0.0)));
        uvec4 is_nearer = uvec4(floatBitsToInt(next - z) >> 31);
        farther |= bits & ~is_nearer;
        nearer |= bits & is_nearer;
        before = z;
        z = next;
        next = behind;
    }
    int place = (word.y * VKAO_STRIDE + texel.x) >> 1;
    breaks[place] = farther;
    breaks[place + 1] = nearer;
}
