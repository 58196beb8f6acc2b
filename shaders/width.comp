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

/* Words of a row, or column; beyond the image nothing breaks. texel is counted from the first
 * column of words. */
uint breaks_at(bool vertical, ivec2 texel, int word, int words)
{
    if (word < 0 || word >= words)
        return 0u;
    return vertical ? texelFetch(breaks_y_image, ivec2(texel.x, word), 0).x
                    : texelFetch(breaks_x_image, ivec2(word, texel.y), 0).x;
}

/* Steps of the surface to both sides, at most so many to each. */
int run_of(bool vertical, ivec2 texel, ivec2 size, int shift, int most)
{
    int at = (vertical ? texel.y : texel.x) >> shift, k = at & 31, word = at >> 5;
    int words = (((vertical ? size.y : size.x) - 1) >> (5 + shift)) + 1;
    uint here = breaks_at(vertical, texel, word, words);
    uint ahead = here >> k | breaks_at(vertical, texel, word + 1, words) << 1 << (31 - k);
    uint behind = here << (31 - k) << 1 | breaks_at(vertical, texel, word - 1, words) >> k;
    return min(ahead != 0u ? findLSB(ahead) : 32, most) +
           min(behind != 0u ? 31 - findMSB(behind) : 32, most);
}

void main()
{
    ivec2 low = unpack_texel(params.valid.x), first = low & ivec2(~3, ~0);
    ivec2 size = unpack_texel(params.valid.y) - first;
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(texel, size)) || first.x + texel.x < low.x)
        return;
    float z = load_prepared_z(first + texel);
    Reach reach = width_reach();
    if (z > 0.0)
        store_prepared_z(first + texel,
                         with_thickness(z,
                                        run_of(false, texel, size, reach.shift.x, reach.steps.x),
                                        run_of(true, texel, size, reach.shift.y, reach.steps.y),
                                        reach));
}
