/* SPDX-License-Identifier: MIT
 *
 * How wide the surface is that a texel is seen of: texels without a break of depth, in its row or
 * in its column, the fewer. As thick it is taken to be, and view z gets that in its last bits:
 * what samples it has it without another load. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#define VKAO_GLSL
#include "params.h"

layout(local_size_x = VKAO_GROUP_WIDTH, local_size_y = VKAO_GROUP_HEIGHT) in;
layout(push_constant) uniform Block { vkao_dispatch here; };
#include "settings.glsl"
#include "thickness.glsl"

layout(binding = VKAO_BINDING_BREAKS_X) uniform utexture2D breaks_x_image;
layout(binding = VKAO_BINDING_BREAKS_Y) uniform utexture2D breaks_y_image;
layout(binding = VKAO_BINDING_VIEW_Z_WRITE, r32f) uniform image2D view_z_image;

float load_prepared_z(ivec2 texel)
{
    return imageLoad(view_z_image, texel + VKAO_VIEW_Z_BORDER).x;
}

void store_prepared_z(ivec2 texel, float z)
{
    imageStore(view_z_image, texel + VKAO_VIEW_Z_BORDER, vec4(z));
}

/* A group lies in one word of its rows and in one of its columns: those, and the words before and
 * behind them. */
shared uint row_words[3][VKAO_GROUP_HEIGHT], column_words[3][VKAO_GROUP_WIDTH];

/* Beyond the image nothing breaks. size, line and at are counted from the first column of words;
 * line is the row or column, at the group's place along it. */
uint breaks_at(bool vertical, ivec2 size, int shift, int line, int at, int beside)
{
    int word = (at >> 5 + shift) + beside, length = vertical ? size.y : size.x;
    if (word < 0 || word << 5 + shift >= length || line >= (vertical ? size.x : size.y))
        return 0u;
    return vertical ? texelFetch(breaks_y_image, ivec2(line, word), 0).x
                    : texelFetch(breaks_x_image, ivec2(word, line), 0).x;
}

void load_words(ivec2 size, ivec2 shift)
{
    int i = int(gl_LocalInvocationIndex);
    ivec2 group = ivec2(gl_WorkGroupID.xy) * ivec2(VKAO_GROUP_WIDTH, VKAO_GROUP_HEIGHT);
    if (i < 3 * VKAO_GROUP_HEIGHT) {
        int k = i % VKAO_GROUP_HEIGHT, beside = i / VKAO_GROUP_HEIGHT;
        row_words[beside][k] = breaks_at(false, size, shift.x, group.y + k, group.x, beside - 1);
    } else if (i < 3 * (VKAO_GROUP_HEIGHT + VKAO_GROUP_WIDTH)) {
        i -= 3 * VKAO_GROUP_HEIGHT;
        int k = i % VKAO_GROUP_WIDTH, beside = i / VKAO_GROUP_WIDTH;
        column_words[beside][k] = breaks_at(true, size, shift.y, group.x + k, group.y, beside - 1);
    }
    barrier();
}

/* Steps of the surface to both sides of bit k of here, at most so many to each. */
int run_of(uint before, uint here, uint next, int k, int most)
{
    uint ahead = here >> k | next << 1 << (31 - k);
    uint behind = here << (31 - k) << 1 | before >> k;
    return min(ahead != 0u ? findLSB(ahead) : 32, most) +
           min(behind != 0u ? 31 - findMSB(behind) : 32, most);
}

void main()
{
    ivec2 low = unpack_texel(params.valid.x), first = low & ivec2(~3, ~0);
    ivec2 size = unpack_texel(params.valid.y) - first;
    Reach reach = width_reach();
    load_words(size, reach.shift);
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy), here = ivec2(gl_LocalInvocationID.xy);
    if (any(greaterThanEqual(texel, size)) || first.x + texel.x < low.x)
        return;
    float z = load_prepared_z(first + texel);
    ivec2 k = texel >> reach.shift & 31;
    if (z > 0.0)
        store_prepared_z(first + texel,
                         with_thickness(z,
                                        run_of(row_words[0][here.y], row_words[1][here.y],
                                               row_words[2][here.y], k.x, reach.steps.x),
                                        run_of(column_words[0][here.x], column_words[1][here.x],
                                               column_words[2][here.x], k.y, reach.steps.y),
                                        reach));
}
