/* SPDX-License-Identifier: MIT
 *
 * How wide the surface is that a texel is seen of: texels without a break of depth, in its row or
 * in its column, the fewer. As thick it is taken to be, and view z gets that in its last bits:
 * what samples it has it without another load. Lengths are fractions of the radius, so that the
 * same scene at another resolution has the same. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#define VKAO_GLSL
#include "params.h"

layout(local_size_x = VKAO_GROUP_WIDTH, local_size_y = VKAO_GROUP_HEIGHT) in;
layout(push_constant) uniform Block { vkao_dispatch here; };
#include "settings.glsl"
#include "width.glsl"

/* Words of a row, or column; beyond the image nothing breaks. */
uint breaks_at(bool vertical, ivec2 texel, ivec2 size, int word)
{
    int words = ((vertical ? size.y : size.x) + 31) >> 5;
    if (word < 0 || word >= words)
        return 0u;
    return vertical ? load_breaks_y(ivec2(texel.x, word)) : load_breaks_x(ivec2(word, texel.y));
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

/* Texels of the surface along one axis, and whether it goes on on both sides. */
int run_of(bool vertical, ivec2 texel, ivec2 size, int most, out bool goes_on)
{
    int run = run_ahead(vertical, texel, size, most) + run_back(vertical, texel, size, most);
    goes_on = run == 2 * most;
    return run + 1;
}

void main()
{
    ivec2 low = ivec2(params.valid.x & 0xffffu, params.valid.x >> 16);
    ivec2 size = ivec2(params.valid.y & 0xffffu, params.valid.y >> 16) - low;
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(texel, size)))
        return;
    float z = load_prepared_z(low + texel);
    if (!(z > 0.0))
        return;
    vec2 radius = params.radius * abs(params.inverse_unproject); /* in texels */
    radius /= ORTHOGRAPHIC ? 1.0 : z;
    ivec2 most = ivec2(max(vec2(1.0), params.width_reach * abs(params.inverse_unproject) + 0.5));
    bvec2 goes_on;
    float across = float(run_of(false, texel, size, most.x, goes_on.x)) / radius.x;
    float along = float(run_of(true, texel, size, most.y, goes_on.y)) / radius.y;
    float thickness = all(goes_on) ? VKAO_VBAO_THICKNESS_WIDE
                                   : VKAO_VBAO_THICKNESS_WIDTH * min(across, along);
    int code = floatBitsToInt(min(thickness, 2.0)) - VKAO_THICKNESS_LEAST_BITS;
    code = clamp((code + (1 << (VKAO_THICKNESS_SHIFT - 1))) >> VKAO_THICKNESS_SHIFT, 0,
                 VKAO_THICKNESS_MASK);
    int bits = floatBitsToInt(z) & ~VKAO_THICKNESS_MASK;
    store_prepared_z(low + texel, intBitsToFloat(bits | code));
}
