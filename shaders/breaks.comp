/* SPDX-License-Identifier: MIT
 *
 * Where depth breaks between a texel and the next one of its row, and of its column, in words of
 * 32 bits: what width.comp counts. A bit stands for 1 << shift texels, so that the words of a row
 * are those of one, two, four ... groups side by side, which share out the rows; likewise
 * columns. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#define VKAO_GLSL
#include "params.h"

const int WORD = 32;
const int THREADS = VKAO_BREAKS_WIDTH * VKAO_BREAKS_HEIGHT;
layout(local_size_x = VKAO_BREAKS_WIDTH, local_size_y = VKAO_BREAKS_HEIGHT) in;
layout(push_constant) uniform Block { vkao_dispatch here; };
#include "settings.glsl"
#include "view_z.glsl"
#include "thickness.glsl"
layout(binding = VKAO_BINDING_BREAKS_X_WRITE) uniform writeonly uimage2D breaks_x_image;
layout(binding = VKAO_BINDING_BREAKS_Y_WRITE) uniform writeonly uimage2D breaks_y_image;

/* Of the rows, or columns, that the group has. */
shared uint words[WORD];

float depth_at(ivec2 texel)
{
    float z = load_view_z(texel);
    return z > 0.0 ? z : NOTHING;
}

/* along: the direction of the words, x or y; across: the other one. */
void find_breaks(bool vertical, int shift, ivec2 low, ivec2 high, ivec2 first)
{
    const ivec2 along = vertical ? ivec2(0, 1) : ivec2(1, 0), across = ivec2(1) - along;
    ivec2 block = ivec2(gl_WorkGroupID.xy), blocks = ((high - first - 1) >> 5) + 1;
    int at = vertical ? block.y : block.x, count = vertical ? blocks.y : blocks.x;
    int line = WORD * (vertical ? block.x : block.y);
    int word = at >> shift, sharing = min(1 << shift, count - (word << shift));
    int lines = (WORD + sharing - 1) / sharing, begin = (at - (word << shift)) * lines;
    int length = WORD << shift, thread = int(gl_LocalInvocationIndex);

    if (thread < WORD)
        words[thread] = 0u;
    barrier();
    for (int i = thread; i < lines * length; i += THREADS) {
        /* Threads side by side have texels side by side. */
        int k = vertical ? i % lines : i >> (5 + shift),
            step = vertical ? i / lines : i & (length - 1);
        ivec2 texel = first + (line + begin + k) * across + ((word << 5 << shift) + step) * along;
        if (begin + k >= WORD || any(lessThan(texel, low)) ||
            any(greaterThanEqual(texel + along, high)))
            continue;
        float before = depth_at(texel - along), z = depth_at(texel), next = depth_at(texel + along),
              behind = depth_at(texel + 2 * along);
        if (break_between(before, z, next, behind) > 0.0)
            atomicOr(words[k], 1u << (step >> shift));
    }
    barrier();
    ivec2 to = (line + begin + thread) * across + word * along;
    if (thread < lines && begin + thread < WORD &&
        all(lessThan((first + to) * across, high * across + along))) {
        if (vertical)
            imageStore(breaks_y_image, to, uvec4(words[thread]));
        else
            imageStore(breaks_x_image, to, uvec4(words[thread]));
    }
}

void main()
{
    ivec2 low = unpack_texel(params.valid.x), first = low & ivec2(~3, ~0);
    ivec2 high = unpack_texel(params.valid.y);
    Reach reach = width_reach();
    find_breaks(false, reach.shift.x, low, high, first);
    barrier();
    find_breaks(true, reach.shift.y, low, high, first);
}
