/* SPDX-License-Identifier: MIT
 *
 * ../breaks.comp along rows: a word, 4 texels at once. */
#version 450
#extension GL_GOOGLE_include_directive : require
#define VKAO_GLSL
#include "layout.h"

layout(local_size_x = VKAO_GROUP_OF(32)) in;
layout(push_constant) uniform Block { vkao_dispatch here; };
#include "settings.glsl"
#include "buffers.glsl"

layout(binding = VKAO_BINDING_Z4, rgba32f) uniform readonly imageBuffer view_z4;
layout(binding = VKAO_BINDING_BREAKS_WORDS) writeonly buffer Breaks { uvec2 breaks[]; };
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
    int shift = width_reach().shift.x, begin = (32 << shift) * word.x, left = size.x - begin;
    if (left <= 0 || word.y >= size.y)
        return;
    /* Of the padding, which is 0 on both sides, and of vectors. */
    int at = (z_row(first.y + word.y) + first.x + begin) >> 2, most = (left >> 2) + 1;
    /* Between the first valid texel and what is left of it nothing breaks, nor behind the last. */
    ivec4 texel = ivec4(0, 1, 2, 3);
    int valid = low.x - first.x - begin;
    vec4 before = depths_at(at - 1), z = depths_at(at), next = depths_at(at + 1);
    uvec4 farther = uvec4(0u), nearer = uvec4(0u);
    int count = min(8 << shift, (left + 3) >> 2);
    for (int i = 0; i < count; ++i) {
        vec4 behind = depths_at(at + min(i + 2, most));
        vec4 excess = break_between(vec4(before.w, z.xyz), z, vec4(z.yzw, next.x),
                                    vec4(z.zw, next.xy));
        excess = mix(vec4(0.0), excess, greaterThanEqual(texel, ivec4(valid)));
        excess = mix(vec4(0.0), excess, lessThan(texel, ivec4(left - 1)));
        uvec4 bits = mix(uvec4(0u), uvec4(1u) << uvec4(texel >> shift),
                         greaterThan(excess, vec4(0.0)));
        uvec4 is_nearer = uvec4(floatBitsToInt(vec4(z.yzw, next.x) - z) >> 31);
        farther |= bits & ~is_nearer;
        nearer |= bits & is_nearer;
        texel += 4;
        before = z;
        z = next;
        next = behind;
    }
    breaks[word.y * VKAO_BREAKS_STRIDE + word.x] =
        uvec2(farther.x | farther.y | farther.z | farther.w,
              nearer.x | nearer.y | nearer.z | nearer.w);
}
