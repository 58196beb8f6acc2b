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
    int base, step; /* of the first word that tells what is farther, and to the next */
    int words;
};

/* Where the next texel is farther, and where it is nearer. */
struct Breaks {
    uvec4 farther, nearer;
};

/* Beyond the image nothing breaks. */
Breaks breaks_at(Line line, int word)
{
    int inside = clamp(word, 0, line.words - 1), at = line.base + inside * line.step;
    Breaks b;
    if (line.vertical) {
        b = Breaks(imageLoad(breaks_y, at), imageLoad(breaks_y, at + 1));
    } else {
        b = Breaks(imageLoad(breaks_x, at).xxxx, imageLoad(breaks_x, at + 1).xxxx);
    }
    if (inside != word)
        b = Breaks(uvec4(0u), uvec4(0u));
    return b;
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

/* Steps before the first break ahead, and behind. Without any they are more than `most`, which is
 * less than 32. */
ivec4 free_ahead(uvec4 bits)
{
    return exponent_of(bits & (~bits + 1u)) - 127 & 255;
}

ivec4 free_behind(uvec4 bits)
{
    uvec4 high = bits >> 1u;
    return 157 - exponent_of(high & ~(high >> 1u));
}

/* Steps of the surface to both sides, at most so many to each. at: of the texels, along the line;
 * they lie in one word. own: 1 if a bit stands for several texels. */
ivec4 run_of(Line line, ivec4 at, int most, int own)
{
    uvec4 k = uvec4(at & 31);
    int word = at.x >> 5;
    Breaks before = breaks_at(line, word - 1), here = breaks_at(line, word),
           after = breaks_at(line, word + 1);
    uvec4 farther = bits_ahead(here.farther, after.farther, k),
          nearer = bits_ahead(here.nearer, after.nearer, k);
    ivec4 end = free_ahead(farther), hidden = free_ahead(nearer);
    ivec4 start = free_behind(bits_behind(here.nearer, before.nearer, k)),
          hidden_start = free_behind(bits_behind(here.farther, before.farther, k));
    ivec4 ahead = min(min(end, hidden), most), behind = min(min(start, hidden_start), most);
    ivec4 longer = max(ahead, behind);
    ivec4 run = mix(ahead, longer, lessThan(hidden, end)) +
                mix(behind, longer, lessThan(hidden_start, start));
    if (own > 0) {
        /* Some of these texels lie before the break that their bit has, some behind it. Which is
         * not known: all get the narrower of both sides, and none is left between two breaks. */
        ivec4 beyond = min(min(free_ahead((farther | nearer) >> 1u), behind), most);
        run = mix(run, mix(beyond, ivec4(0), equal(hidden, end)), equal(ahead, ivec4(0)));
    }
    return run;
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
    Line row = Line(false, 2 * texel.y * VKAO_BREAKS_STRIDE, 2, words.x);
    Line column = Line(true, texel.x >> 1, VKAO_STRIDE >> 1, words.y);
    ivec2 own = min(reach.shift, ivec2(1));
    ivec4 along_x = run_of(row, (texel.x + ivec4(0, 1, 2, 3)) >> reach.shift.x, reach.steps.x,
                           own.x);
    ivec4 along_y = run_of(column, ivec4(texel.y >> reach.shift.y), reach.steps.y, own.y);
    view_z[at] = with_thickness(z, along_x, along_y, reach);
}
