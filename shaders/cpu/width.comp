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
layout(binding = VKAO_BINDING_Z_WORDS) buffer ViewZ { vec4 view_z[]; };
#define real vec4
#define whole ivec4
#include "thickness.glsl"

/* Words of breaks of the texels; beyond the image nothing breaks. texel and size are counted from
 * the first column that breaks_x has. */
uvec4 breaks_at(bool vertical, ivec2 texel, ivec2 size, int word)
{
    int words = ((vertical ? size.y : size.x) + 31) >> 5;
    if (word < 0 || word >= words)
        return uvec4(0u);
    return vertical ? imageLoad(breaks_y, (word * VKAO_STRIDE + texel.x) >> 2)
                    : imageLoad(breaks_x, texel.y * VKAO_BREAKS_STRIDE + word).xxxx;
}

/* Of the highest bit, where no two neighbours are set: what findMSB takes a dozen instructions
 * for. */
ivec4 position_of(uvec4 bits)
{
    return (floatBitsToInt(vec4(ivec4(bits))) >> 23 & 255) - 127;
}

/* Texels before the first break ahead or behind, at most so many. */
ivec4 run_along(bool vertical, bool back, ivec2 texel, ivec2 size, int most)
{
    ivec4 at = vertical ? ivec4(texel.y) : texel.x + ivec4(0, 1, 2, 3), run = ivec4(0);
    uvec4 shift = uvec4(at & 31), ends = uvec4(0u);
    int word = at.x >> 5;
    uvec4 nearer = breaks_at(vertical, texel, size, word);
    for (;;) {
        word += back ? -1 : 1;
        uvec4 farther = breaks_at(vertical, texel, size, word), bits;
        ivec4 free;
        if (back) {
            bits = nearer << (31u - shift) << 1u | farther >> shift;
            uvec4 high = bits >> 1u;
            free = 30 - position_of(high & ~(high >> 1u));
            free = mix(free, 31 + ivec4(~bits & 1u), equal(high, uvec4(0u)));
        } else {
            bits = nearer >> shift | farther << 1u << (31u - shift);
            free = mix(position_of(bits & (~bits + 1u)), ivec4(32), equal(bits, uvec4(0u)));
        }
        run += mix(free, ivec4(0), notEqual(ends, uvec4(0u)));
        ends |= bits;
        if (all(bvec4(ivec4(notEqual(ends, uvec4(0u))) | ivec4(greaterThanEqual(run, ivec4(most))))))
            return min(run, ivec4(most));
        nearer = farther;
    }
}

ivec4 run_of(bool vertical, ivec2 texel, ivec2 size, int most)
{
    return run_along(vertical, false, texel, size, most) +
           run_along(vertical, true, texel, size, most);
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
    vec4 z = view_z[at];
    ivec2 most = width_reach();
    ivec4 along_x = run_of(false, texel, size, most.x), along_y = run_of(true, texel, size, most.y);
    view_z[at] = with_thickness(z, along_x, along_y, most);
}
