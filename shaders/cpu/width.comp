/* SPDX-License-Identifier: MIT
 *
 * ../width.comp for VKAO_PREPARE_WIDTH texels of a row at once, down VKAO_WIDTH_HEIGHT rows, which
 * share the words of their columns. */
#version 450
#extension GL_GOOGLE_include_directive : require
#define VKAO_GLSL
#include "layout.h"

layout(local_size_x = VKAO_GROUP_OF(VKAO_PREPARE_WIDTH)) in;
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

/* Where the next texel is farther, and where it is nearer. */
struct Breaks {
    uvec4 farther, nearer;
};

/* The word of a texel, the one before and the one after it. */
struct Line {
    Breaks before, here, after;
};

/* Beyond the image nothing breaks. */
Breaks if_inside(bool inside, uvec4 farther, uvec4 nearer)
{
    return Breaks(inside ? farther : uvec4(0u), inside ? nearer : uvec4(0u));
}

Breaks breaks_of_row(int y, int word, int words)
{
    int at = 2 * (y * VKAO_BREAKS_STRIDE + clamp(word, 0, words - 1));
    return if_inside(word >= 0 && word < words, imageLoad(breaks_x, at).xxxx,
                     imageLoad(breaks_x, at + 1).xxxx);
}

Breaks breaks_of_columns(int x, int word, int words)
{
    int at = (clamp(word, 0, words - 1) * VKAO_STRIDE + x) >> 1;
    return if_inside(word >= 0 && word < words, imageLoad(breaks_y, at),
                     imageLoad(breaks_y, at + 1));
}

uvec4 bits_ahead(uvec4 here, uvec4 after, uvec4 shift)
{
    return here >> shift | after << 1u << (31u - shift);
}

uvec4 bits_behind(uvec4 here, uvec4 before, uvec4 shift)
{
    return here << (31u - shift) << 1u | before >> shift;
}

/* Of the highest bit, where no two neighbours are set, as the exponent of a float: what findMSB
 * takes a dozen instructions for. 127 is that of bit 0; of no bit it is 0. */
ivec4 exponent_of(uvec4 bits)
{
    return floatBitsToInt(vec4(ivec4(bits))) >> 23;
}

uvec4 lowest(uvec4 bits)
{
    return bits & (~bits + 1u);
}

/* Steps before the first break ahead, whose bit alone is set, and behind: at most so many, fewer
 * than 32, which it is without any. */
ivec4 free_ahead(uvec4 first, int most)
{
    return ivec4(min(uvec4(exponent_of(first) - 127), uint(most))); /* below 0 is more than all */
}

ivec4 free_behind(uvec4 bits, int most)
{
    uvec4 high = bits >> 1u;
    return min(157 - exponent_of(high & ~(high >> 1u)), most);
}

/* Shares of a step that the surface goes on for to both sides, at most so many steps to each. at:
 * of the texels, along the line; they lie in one word. own: 1 if a bit has several texels, which
 * it has in rows or columns if is_coarse. */
ivec4 run_of(Line line, ivec4 at, int most, int own, bool is_coarse)
{
    uvec4 k = uvec4(at & 31);
    uvec4 farther = bits_ahead(line.here.farther, line.after.farther, k),
          nearer = bits_ahead(line.here.nearer, line.after.nearer, k), breaks = farther | nearer;
    /* Back over a break that leads to what is nearer, one comes from what is farther. */
    uvec4 starts = bits_behind(line.here.nearer, line.before.nearer, k),
          breaks_behind = starts | bits_behind(line.here.farther, line.before.farther, k);
    uvec4 first = lowest(breaks);
    ivec4 ahead = free_ahead(first, most), behind = free_behind(breaks_behind, most);
    ivec4 longer = max(ahead, behind);
    /* What has both kinds of breaks in one bit ends there. */
    bvec4 open_ahead = equal(first & farther, uvec4(0u)),
          open_behind = greaterThanEqual(ivec4(starts << behind), ivec4(0));
    ivec4 run = mix(ahead, longer, open_ahead) + mix(behind, longer, open_behind);
    ivec4 hidden = VKAO_VBAO_WIDTH_HIDDEN * run, seen = VKAO_VBAO_WIDTH_SHARES * run;
    ivec4 shares = mix(seen, mix(seen, hidden, lessThan(ahead, ivec4(most))), open_ahead);
    shares = mix(shares, mix(shares, hidden, lessThan(behind, ivec4(most))), open_behind);
    /* What is hidden does not count as going on for being wide alone. */
    shares = min(shares, max(seen, 2 * VKAO_VBAO_WIDTH_SHARES * most - 1));
    if (is_coarse) {
        /* Some of these texels lie before the break that their bit has, some behind it. Which is
         * not known: all get the narrower of both sides, and none is left between two breaks. */
        ivec4 beyond = min(free_ahead(lowest(breaks >> 1u), most), behind);
        bvec4 has_both = notEqual(first & farther & nearer, uvec4(0u));
        shares = mix(shares, mix(VKAO_VBAO_WIDTH_SHARES * beyond, ivec4(0), has_both),
                     lessThan(ahead, ivec4(own)));
    }
    return shares;
}

/* Of so many rows, which share the words of their columns. */
void widths(Reach reach, ivec2 first, ivec2 texel, ivec2 size, int count, bool is_coarse)
{
    ivec2 words = ((size - 1) >> (5 + reach.shift)) + 1, own = min(reach.shift, ivec2(1));
    ivec2 word = texel >> (5 + reach.shift);
    ivec4 x = (texel.x + ivec4(0, 1, 2, 3)) >> reach.shift.x;
    Line column = Line(breaks_of_columns(texel.x, word.y - 1, words.y),
                       breaks_of_columns(texel.x, word.y, words.y),
                       breaks_of_columns(texel.x, word.y + 1, words.y));
    for (int i = 0; i < count; ++i) {
        int y = texel.y + i, at = (z_row(first.y + y) + first.x + texel.x) >> 2;
        vec4 z = imageLoad(view_z4, at);
        Line row = Line(breaks_of_row(y, word.x - 1, words.x), breaks_of_row(y, word.x, words.x),
                        breaks_of_row(y, word.x + 1, words.x));
        ivec4 along_x = run_of(row, x, reach.steps.x, own.x, is_coarse),
              along_y = run_of(column, ivec4(y >> reach.shift.y), reach.steps.y, own.y, is_coarse);
        view_z[at] = with_thickness(z, along_x, along_y, reach);
    }
}

void main()
{
    ivec2 low = ivec2(params.valid.x & 0xffffu, params.valid.x >> 16);
    ivec2 high = ivec2(params.valid.y & 0xffffu, params.valid.y >> 16);
    ivec2 first = ivec2(round_down(low.x, VKAO_PREPARE_WIDTH), low.y), size = high - first;
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy) * ivec2(VKAO_PREPARE_WIDTH, VKAO_WIDTH_HEIGHT);
    if (any(greaterThanEqual(texel, size)))
        return;
    Reach reach = width_reach();
    int count = min(VKAO_WIDTH_HEIGHT, size.y - texel.y);
    /* A driver in software runs both sides of a branch, but a loop without turns only once. */
    bool is_coarse = any(greaterThan(reach.shift, ivec2(0)));
    widths(reach, first, texel, size, is_coarse ? 0 : count, false);
    widths(reach, first, texel, size, is_coarse ? count : 0, true);
}
