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

/* Steps to the first that is set; -1, which findLSB has for none, is the largest of numbers without
 * sign. */
uint steps_to(uint bits)
{
    return uint(findLSB(bits));
}

/* What lies before and behind two texels side by side in a line: bits from that of the first on,
 * the nearest lowest, and those before that of the second, the nearest highest. Each has what the
 * other texel needs as well: it is followed through fewer than 32. */
struct Ends {
    uint farther_ahead, nearer_ahead, farther_behind, nearer_behind;
};

uint bits_ahead(Words w, int line, int first)
{
    return w.here[line] >> first | w.after[line] << 1 << (31 - first);
}

uint bits_behind(Words w, int line, int second)
{
    return w.here[line] << 1 << (31 - second) | w.before[line] >> second;
}

Ends ends_of(Breaks b, int line, int first, int second)
{
    return Ends(bits_ahead(b.farther, line, first), bits_ahead(b.nearer, line, first),
                bits_behind(b.farther, line, second), bits_behind(b.nearer, line, second));
}

/* Those of one of the texels, whose bits are apart. */
Ends ends_of_texel(Ends e, bool is_second, uint apart)
{
    uint ahead = is_second ? apart : 0u, behind = is_second ? 0u : apart;
    return Ends(e.farther_ahead >> ahead, e.nearer_ahead >> ahead, e.farther_behind << behind,
                e.nearer_behind << behind);
}

/* Steps from a bit behind which depth breaks to the next; 0 if what is next is both farther and
 * nearer. */
uint steps_between(Ends e)
{
    return steps_to((e.farther_ahead | e.nearer_ahead) >> 1 | e.farther_ahead & e.nearer_ahead);
}

/* Shares of a step that the surface goes on for to both sides, at most so many steps to each. own:
 * 1 if a bit stands for several texels; between: steps_between of that. */
uint run_of(Ends e, uint most, uint own, uint between)
{
    const uint SHARES = VKAO_VBAO_WIDTH_SHARES, MORE = VKAO_VBAO_WIDTH_HIDDEN - SHARES;
    uint end = steps_to(e.farther_ahead), hidden = steps_to(e.nearer_ahead);
    uint start = steps_to(bitfieldReverse(e.nearer_behind)),
         hidden_start = steps_to(bitfieldReverse(e.farther_behind));
    uint seen_end = min(end, most), seen_start = min(start, most);
    bool hides_end = hidden < seen_end, hides_start = hidden_start < seen_start;
    uint ahead = min(seen_end, hidden), behind = min(seen_start, hidden_start);
    uint longer = max(ahead, behind);
    uint run = (hides_end ? longer : ahead) + (hides_start ? longer : behind);
    uint shares = SHARES * run;
    /* What is hidden does not count as going on for being wide alone. */
    uint more = min(shares + MORE * run, max(shares, 2u * SHARES * most - 1u));
    shares = hides_end || hides_start ? more : shares;
    /* Some of these texels lie before the break that their bit has, some behind it. Which is not
     * known: all get the narrower of both sides, and none is left between two breaks. */
    return ahead < own ? SHARES * min(between, behind) : shares;
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
    ivec2 bit = texel >> reach.shift & 31, next = texel + 1 >> reach.shift & 31;
    Ends row_ends[2], column_ends[2];
    [[unroll]] for (int i = 0; i < 2; ++i) {
        row_ends[i] = ends_of(rows, i, bit.x, next.x);
        column_ends[i] = ends_of(columns, i, bit.y, next.y);
    }
    [[unroll]] for (int i = 0; i < 4; ++i) {
        int x = i & 1, y = i >> 1;
        uint along_x = run_of(ends_of_texel(row_ends[y], x == 1, 1u - own.x), uint(reach.steps.x),
                              own.x, steps_between(row_ends[y])),
             along_y = run_of(ends_of_texel(column_ends[x], y == 1, 1u - own.y),
                              uint(reach.steps.y), own.y, steps_between(column_ends[x]));
        imageStore(view_z_image, places[y][x],
                   vec4(with_thickness(z[y][x], int(along_x), int(along_y), reach)));
    }
}
