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

/* Words of a row, or column; beyond the image nothing breaks. */
uint breaks_at(bool vertical, ivec2 texel, ivec2 size, int word)
{
    int words = ((vertical ? size.y : size.x) + 31) >> 5;
    if (word < 0 || word >= words)
        return 0u;
    return vertical ? texelFetch(breaks_y_image, ivec2(texel.x, word), 0).x
                    : texelFetch(breaks_x_image, ivec2(word, texel.y), 0).x;
}

/* Texels that follow before the first break, at most so many. */
int run_ahead(bool vertical, ivec2 texel, ivec2 size, int most)
{
    int at = vertical ? texel.y : texel.x, shift = at & 31, word = at >> 5, run = 0;
    uint here = breaks_at(vertical, texel, size, word);
    for (;;) {
        uint next = breaks_at(vertical, texel, size, ++word);
        uint bits = here >> shift | next << 1 << (31 - shift);
        run += bits != 0u ? findLSB(bits) : 32;
        if (bits != 0u || run >= most)
            return min(run, most);
        here = next;
    }
}

/* And those before, back to the last break. */
int run_back(bool vertical, ivec2 texel, ivec2 size, int most)
{
    int at = vertical ? texel.y : texel.x, shift = at & 31, word = at >> 5, run = 0;
    uint here = breaks_at(vertical, texel, size, word);
    for (;;) {
        uint before = breaks_at(vertical, texel, size, --word);
        uint bits = here << (31 - shift) << 1 | before >> shift;
        run += bits != 0u ? 31 - findMSB(bits) : 32;
        if (bits != 0u || run >= most)
            return min(run, most);
        here = before;
    }
}

/* Texels of the surface to both sides. */
int run_of(bool vertical, ivec2 texel, ivec2 size, int most)
{
    return run_ahead(vertical, texel, size, most) + run_back(vertical, texel, size, most);
}

void main()
{
    ivec2 low = ivec2(params.valid.x & 0xffffu, params.valid.x >> 16);
    ivec2 size = ivec2(params.valid.y & 0xffffu, params.valid.y >> 16) - low;
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy), most = width_reach();
    if (any(greaterThanEqual(texel, size)))
        return;
    float z = load_prepared_z(low + texel);
    if (z > 0.0)
        store_prepared_z(low + texel,
                         with_thickness(z, run_of(false, texel, size, most.x),
                                        run_of(true, texel, size, most.y), most));
}
