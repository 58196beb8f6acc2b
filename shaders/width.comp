/* SPDX-License-Identifier: MIT
 *
 * How wide the surface is that a texel is seen of: texels without a break of depth, in its row or
 * in its column, the fewer. What ends behind something nearer goes on unseen: to that side it is
 * taken to be as long as to the other, if that is longer, and the whole to be wider than is seen.
 * As thick as wide it is taken to be, and view z gets that in its last bits: what samples it has it
 * without another load. An invocation takes two by two texels, whose words are the same. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#define VKAO_GLSL
#include "params.h"

layout(local_size_x = VKAO_GROUP_WIDTH, local_size_y = VKAO_GROUP_HEIGHT) in;
layout(push_constant) uniform Block { vkao_dispatch here; };
#include "settings.glsl"
#include "columns.glsl"
#include "thickness.glsl"

layout(binding = VKAO_BINDING_BREAKS_X) uniform utexture2D breaks_x_image;
layout(binding = VKAO_BINDING_BREAKS_Y) uniform utexture2D breaks_y_image;
layout(binding = VKAO_BINDING_NEAREST) uniform sampler nearest;
layout(binding = VKAO_BINDING_VIEW_Z_WRITE, r32f) uniform image2D view_z_image;

/* Of two lines side by side, the word of a texel, the one before and the one after it. */
struct Words {
    uvec2 before, here, after;
};

/* Where what is next is farther, and where it is nearer. */
struct Breaks {
    Words farther, nearer;
};

Words words_of_rows(uvec4 first, uvec4 second)
{
    return Words(first.wx, first.zy, second.wx);
}

Words words_of_columns(uvec4 first, uvec4 second)
{
    return Words(first.wz, first.xy, second.wz);
}

/* Beyond the image nothing breaks. */
Words clear_outside(Words w, int at, int words)
{
    w.before = at > 0 ? w.before : uvec2(0u);
    w.after = at + 1 < words ? w.after : uvec2(0u);
    return w;
}

#define GATHER(image, x, y, component)                                                             \
    textureGather(usampler2D(image, nearest), vec2(at) + vec2(x, y), component)

Breaks breaks_of_rows(ivec2 at, int words)
{
    Words farther = words_of_rows(GATHER(breaks_x_image, 0.0, 1.0, 0),
                                  GATHER(breaks_x_image, 2.0, 1.0, 0)),
          nearer = words_of_rows(GATHER(breaks_x_image, 0.0, 1.0, 1),
                                 GATHER(breaks_x_image, 2.0, 1.0, 1));
    return Breaks(clear_outside(farther, at.x, words), clear_outside(nearer, at.x, words));
}

Breaks breaks_of_columns(ivec2 at, int words)
{
    Words farther = words_of_columns(GATHER(breaks_y_image, 1.0, 0.0, 0),
                                     GATHER(breaks_y_image, 1.0, 2.0, 0)),
          nearer = words_of_columns(GATHER(breaks_y_image, 1.0, 0.0, 1),
                                    GATHER(breaks_y_image, 1.0, 2.0, 1));
    return Breaks(clear_outside(farther, at.y, words), clear_outside(nearer, at.y, words));
}

/* Bits k to k + 31 of a line's words, and those before bit k, the nearest first. */
uint bits_ahead(Words w, int line, int k)
{
    return w.here[line] >> k | w.after[line] << 1 << (31 - k);
}

uint bits_behind(Words w, int line, int k)
{
    return bitfieldReverse(w.here[line] << 1 << (31 - k) | w.before[line] >> k);
}

/* Steps to the first that is set; -1, which findLSB has for none, is the largest of numbers without
 * sign. */
uint steps_to(uint bits)
{
    return uint(findLSB(bits));
}

/* Shares of a step that the surface goes on for to both sides of bit k of a line, at most so many
 * steps to each. own: 1 if a bit stands for several texels. */
uint run_of(Breaks b, int line, int k, uint most, uint own)
{
    uint farther = bits_ahead(b.farther, line, k), nearer = bits_ahead(b.nearer, line, k);
    uint end = steps_to(farther), hidden = steps_to(nearer);
    uint ahead = min(min(end, hidden), most);
    uint start = steps_to(bits_behind(b.nearer, line, k)),
         hidden_start = steps_to(bits_behind(b.farther, line, k));
    uint behind = min(min(start, hidden_start), most), longer = max(ahead, behind);
    uint run = (hidden < end ? longer : ahead) + (hidden_start < start ? longer : behind);
    bool is_hidden = hidden < min(end, most) || hidden_start < min(start, most);
    uint each = is_hidden ? VKAO_VBAO_WIDTH_HIDDEN : VKAO_VBAO_WIDTH_SHARES;
    /* What is hidden does not count as going on for being wide alone. */
    uint shares = min(run * each, max(VKAO_VBAO_WIDTH_SHARES * run,
                                      2u * VKAO_VBAO_WIDTH_SHARES * most - 1u));
    /* Some of these texels lie before the break that their bit has, some behind it. Which is not
     * known: all get the narrower of both sides, and none is left between two breaks. */
    uint beyond = min(min(steps_to((farther | nearer) >> 1), behind), most);
    beyond = hidden == end ? 0u : VKAO_VBAO_WIDTH_SHARES * beyond;
    return ahead < own ? beyond : shares;
}

void main()
{
    ivec2 low = unpack_texel(params.valid.x), size = unpack_texel(params.valid.y) - low;
    ivec2 texel = 2 * ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(texel, size)))
        return;
    Reach reach = width_reach();
    uvec2 own = uvec2(min(reach.shift, ivec2(1)));
    ivec2 word = texel >> (5 + reach.shift), words = ((size - 1) >> (5 + reach.shift)) + 1;
    Breaks rows = breaks_of_rows(ivec2(word.x, texel.y), words.x),
           columns = breaks_of_columns(ivec2(texel.x, word.y), words.y);
    /* One beyond the last texel is of the border, and no surface either. */
    ivec2 first = view_z_place(low + texel), right = view_z_place(low + texel + ivec2(1, 0));
    ivec2 places[2][2] = ivec2[2][2](ivec2[2](first, right),
                                     ivec2[2](first + ivec2(0, 1), right + ivec2(0, 1)));
    float z[2][2];
    [[unroll]] for (int i = 0; i < 4; ++i)
        z[i >> 1][i & 1] = imageLoad(view_z_image, places[i >> 1][i & 1]).x;
    [[unroll]] for (int i = 0; i < 4; ++i) {
        int x = i & 1, y = i >> 1;
        ivec2 bit = ((texel + ivec2(x, y)) >> reach.shift) & 31;
        uint along_x = run_of(rows, y, bit.x, uint(reach.steps.x), own.x),
             along_y = run_of(columns, x, bit.y, uint(reach.steps.y), own.y);
        imageStore(view_z_image, places[y][x],
                   vec4(with_thickness(z[y][x], int(along_x), int(along_y), reach)));
    }
}
