/* SPDX-License-Identifier: MIT
 *
 * How wide the surface is that a texel is seen of: texels without a break of depth, in its row or
 * in its column, the fewer. As thick it is taken to be, and view z gets that in its last bits:
 * what samples it has it without another load. An invocation takes two by two texels, whose words
 * are the same. */
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

Words words_of_rows(ivec2 at)
{
    uvec4 first = textureGather(usampler2D(breaks_x_image, nearest), vec2(at) + vec2(0.0, 1.0)),
          second = textureGather(usampler2D(breaks_x_image, nearest), vec2(at) + vec2(2.0, 1.0));
    return Words(first.wx, first.zy, second.wx);
}

Words words_of_columns(ivec2 at)
{
    uvec4 first = textureGather(usampler2D(breaks_y_image, nearest), vec2(at) + vec2(1.0, 0.0)),
          second = textureGather(usampler2D(breaks_y_image, nearest), vec2(at) + vec2(1.0, 2.0));
    return Words(first.wz, first.xy, second.wz);
}

/* Beyond the image nothing breaks. */
void clear_outside(inout Words w, int at, int words)
{
    w.before = at > 0 ? w.before : uvec2(0u);
    w.after = at + 1 < words ? w.after : uvec2(0u);
}

/* Steps of the surface to both sides of bit k of a line's words, at most so many to each. */
int run_of(uint before, uint here, uint after, int k, uint most)
{
    uint ahead = here >> k | after << 1 << (31 - k);
    uint behind = here << 1 << (31 - k) | before >> k;
    /* What is not found is -1: the largest of numbers without sign. */
    return int(min(uint(findLSB(ahead)), most) + min(uint(findLSB(bitfieldReverse(behind))), most));
}

void main()
{
    ivec2 low = unpack_texel(params.valid.x), size = unpack_texel(params.valid.y) - low;
    ivec2 texel = 2 * ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(texel, size)))
        return;
    Reach reach = width_reach();
    ivec2 word = texel >> (5 + reach.shift), words = ((size - 1) >> (5 + reach.shift)) + 1;
    Words rows = words_of_rows(ivec2(word.x, texel.y)),
          columns = words_of_columns(ivec2(texel.x, word.y));
    clear_outside(rows, word.x, words.x);
    clear_outside(columns, word.y, words.y);
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
        int along_x =
            run_of(rows.before[y], rows.here[y], rows.after[y], bit.x, uint(reach.steps.x));
        int along_y = run_of(columns.before[x], columns.here[x], columns.after[x], bit.y,
                             uint(reach.steps.y));
        imageStore(view_z_image, places[y][x],
                   vec4(with_thickness(z[y][x], along_x, along_y, reach)));
    }
}
