/* SPDX-License-Identifier: MIT
 *
 * ../width.comp for VKAO_PREPARE_WIDTH texels of a row at once. */
#version 450
#extension GL_GOOGLE_include_directive : require
#define VKAO_GLSL
#include "layout.h"

layout(local_size_x = VKAO_GROUP_WIDTH, local_size_y = VKAO_GROUP_HEIGHT) in;
layout(push_constant) uniform Block { vkao_dispatch here; };
#include "settings.glsl"
#include "buffers.glsl"

layout(binding = VKAO_BINDING_BREAKS_X_READ, r32ui) uniform readonly uimageBuffer breaks_x;
layout(binding = VKAO_BINDING_BREAKS_Y_READ4, rgba32ui) uniform readonly uimageBuffer breaks_y;
layout(binding = VKAO_BINDING_Z4, rgba32f) uniform readonly imageBuffer view_z4;
layout(binding = VKAO_BINDING_Z_WORDS) writeonly buffer ViewZ { vec4 view_z[]; };
#define real vec4
#define whole ivec4
#include "thickness.glsl"

/* Texels of a row, and where their words are: of one axis. */
struct Line {
    bool vertical;
    int base, step; /* of word 0, and to the next */
    int words;
};

/* Beyond the image nothing breaks. */
uvec4 breaks_at(Line line, int word)
{
    int inside = clamp(word, 0, line.words - 1), at = line.base + inside * line.step;
    uvec4 bits = line.vertical ? imageLoad(breaks_y, at) : imageLoad(breaks_x, at).xxxx;
    return inside == word ? bits : uvec4(0u);
}

/* Of the highest bit, where no two neighbours are set: what findMSB takes a dozen instructions
 * for. */
ivec4 position_of(uvec4 bits)
{
    return (floatBitsToInt(vec4(ivec4(bits))) >> 23 & 255) - 127;
}

/* Steps before the first break in 32 ahead, and behind. */
ivec4 free_ahead(uvec4 bits)
{
    return mix(position_of(bits & (~bits + 1u)), ivec4(32), equal(bits, uvec4(0u)));
}

ivec4 free_behind(uvec4 bits)
{
    uvec4 high = bits >> 1u;
    return mix(30 - position_of(high & ~(high >> 1u)), 31 + ivec4(~bits & 1u),
               equal(high, uvec4(0u)));
}

/* Steps of the surface to both sides, at most so many to each. at: of the texels, along the line;
 * they lie in one word. */
ivec4 run_of(Line line, ivec4 at, int most)
{
    uvec4 shift = uvec4(at & 31);
    int word = at.x >> 5;
    uvec4 here = breaks_at(line, word);
    uvec4 ahead = here >> shift | breaks_at(line, word + 1) << 1u << (31u - shift);
    uvec4 behind = here << (31u - shift) << 1u | breaks_at(line, word - 1) >> shift;
    return min(free_ahead(ahead), ivec4(most)) + min(free_behind(behind), ivec4(most));
}

void main()
{
    ivec2 low = ivec2(params.valid.x & 0xffffu, params.valid.x >> 16);
    ivec2 high = ivec2(params.valid.y & 0xffffu, params.valid.y >> 16);
    ivec2 first = ivec2(round_down(low.x, VKAO_PREPARE_WIDTH), low.y), size = high - first;
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy) * ivec2(VKAO_PREPARE_WIDTH, 1);
    if (any(greaterThanEqual(texel, size)))
        return;
    int at = (z_row(first.y + texel.y) + first.x + texel.x) >> 2;
    vec4 z = imageLoad(view_z4, at);
    Reach reach = width_reach();
    ivec2 words = ((size - 1) >> (5 + reach.shift)) + 1;
    Line row = Line(false, texel.y * VKAO_BREAKS_STRIDE, 1, words.x);
    Line column = Line(true, texel.x >> 2, VKAO_STRIDE >> 2, words.y);
    ivec4 along_x =
        run_of(row, (texel.x + ivec4(0, 1, 2, 3)) >> reach.shift.x, reach.steps.x);
    ivec4 along_y = run_of(column, ivec4(texel.y >> reach.shift.y), reach.steps.y);
    view_z[at] = with_thickness(z, along_x, along_y, reach);
}
