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

/* Texels that a group looks at in a turn, and of each line of them one before and two behind. */
const int TURN_BITS = 10, TURN = 1 << TURN_BITS, BESIDE = 3;

/* Of the rows, or columns, that the group has. */
shared uint words[WORD];
shared float depths[TURN + WORD * BESIDE];

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
    int word = at >> shift, sharing = min(1 << shift, count - (word << shift));
    int lines = (WORD + sharing - 1) / sharing, begin = (at - (word << shift)) * lines;
    lines = min(lines, WORD - begin);
    ivec2 origin = first + (WORD * (vertical ? block.x : block.y) + begin) * across +
                   (word << 5 << shift) * along;
    int thread = int(gl_LocalInvocationIndex);
    if (thread < WORD)
        words[thread] = 0u;
    /* Powers of two: lines of a turn, and how much of them. */
    int bits = min(5 + shift, TURN_BITS), size = 1 << bits, rows = TURN >> bits;
    int pitch = size + BESIDE;
    for (int line = 0; line < lines; line += rows) {
        for (int from = 0; from < WORD << shift; from += size) {
            barrier();
            /* Threads side by side have texels side by side. */
            for (int i = thread; i < rows * pitch; i += THREADS) {
                int k = vertical ? i & (rows - 1) : i / pitch,
                    step = vertical ? i >> TURN_BITS - bits : i - k * pitch;
                depths[k * pitch + step] =
                    depth_at(origin + (line + k) * across + (from + step - 1) * along);
            }
            barrier();
            for (int i = thread; i < TURN; i += THREADS) {
                int k = i >> bits, step = i & (size - 1), d = k * pitch + step;
                ivec2 texel = origin + (line + k) * across + (from + step) * along;
                if (line + k < lines && all(greaterThanEqual(texel, low)) &&
                    all(lessThan(texel + along, high)) &&
                    break_between(depths[d], depths[d + 1], depths[d + 2], depths[d + 3]) > 0.0)
                    atomicOr(words[line + k], 1u << (from + step >> shift));
            }
        }
    }
    barrier();
    ivec2 to = origin + thread * across;
    if (thread < lines && all(lessThan(to * across, high * across + along))) {
        to = (to - first) * across + word * along;
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
