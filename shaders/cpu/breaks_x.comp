/* SPDX-License-Identifier: MIT
 *
 * ../breaks.comp along rows: a word, 4 texels at once. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#define VKAO_GLSL
#include "layout.h"

layout(local_size_x = VKAO_GROUP_WIDTH, local_size_y = VKAO_GROUP_HEIGHT) in;
layout(push_constant) uniform Block { vkao_dispatch here; };
#include "settings.glsl"
#include "buffers.glsl"

layout(binding = VKAO_BINDING_Z4, rgba32f) uniform readonly imageBuffer view_z4;
layout(binding = VKAO_BINDING_BREAKS_WORDS) writeonly buffer Breaks { uint breaks[]; };
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
    if (32 * word.x >= size.x || word.y >= size.y)
        return;
    /* What lies in the padding, on both sides, is 0. */
    int at = (z_row(first.y + word.y) + first.x + 32 * word.x) >> 2;
    vec4 before = depths_at(at - 1), z = depths_at(at), next = depths_at(at + 1);
    uint bits = 0u;
    [[unroll]] for (int i = 0; i < 8; ++i) {
        vec4 behind = i < 7 ? depths_at(at + min(i + 2, ((size.x - 32 * word.x) >> 2) + 1)) : vec4(0.0);
        vec4 excess = break_between(vec4(before.w, z.xyz), z, vec4(z.yzw, next.x),
                                    vec4(z.zw, next.xy));
        uvec4 found = mix(uvec4(0u), uvec4(1u, 2u, 4u, 8u), greaterThan(excess, vec4(0.0)));
        bits |= (found.x | found.y | found.z | found.w) << 4 * i;
        before = z;
        z = next;
        next = behind;
    }
    /* Between the first texel and what is left of it nothing breaks, nor behind the last. */
    int begin = max(low.x - first.x - 32 * word.x, 0), end = size.x - 1 - 32 * word.x;
    bits &= 0xffffffffu << begin;
    bits &= end < 32 ? (1u << end) - 1u : 0xffffffffu;
    breaks[word.y * VKAO_BREAKS_STRIDE + word.x] = bits;
}
