/* SPDX-License-Identifier: MIT
 *
 * Where depth breaks between a texel and the next one of its row, and of its column, in words of
 * 32 bits: what width.comp counts. .x has the breaks behind which the next texel is farther, .y
 * those behind which it is nearer. A bit stands for 1 << shift texels, so that the words of a row
 * are those of one, two, four ... groups side by side, which share out the rows; likewise
 * columns. An invocation takes parts of two lines side by side, as gathers of rows have them. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#extension GL_EXT_control_flow_attributes : require
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

/* Texels of a line that an invocation takes at once, and what it reads of it: one before them, two
 * behind, and one that comes with a gather. */
const int RUN = 8, FOLDS = 3, READ = RUN + 4;

/* Of the rows and of the columns that the group has. */
shared uvec2 words[2][WORD];

/* What a group has to find: of rows, or of columns, a word along and lines across. */
struct Lines {
    bool vertical;
    int shift; /* a bit is 1 << shift texels */
    int word;
    int first, log, count; /* of lines; count is 1 << log, or 0 if others have them all */
};

Lines lines_of(bool vertical, int shift, ivec2 size)
{
    ivec2 block = ivec2(gl_WorkGroupID.xy), blocks = ((size - 1) >> 5) + 1;
    int at = vertical ? block.y : block.x, count = vertical ? blocks.y : blocks.x;
    int word = at >> shift, sharing = clamp(count - (word << shift), 1, 1 << shift);
    int log = max(5 - findMSB(sharing), 0), skipped = at - (word << shift) << log;
    return Lines(vertical, shift, word, WORD * (vertical ? block.x : block.y) + skipped, log,
                 at < count && skipped < WORD ? 1 << log : 0);
}

ivec2 texel_of(Lines l, int along, int across)
{
    return l.vertical ? ivec2(across, along) : ivec2(along, across);
}

/* Does depth break in the middle of four texels in a row? is_next: is the third something? */
bool breaks(float before, float z, float next, float behind, bool is_next)
{
    return abs(next - z) > break_limit(before, z, next, behind) || !is_next;
}

/* View z of READ texels of a line and of the next one, from a texel on, and where it is
 * something. */
void read_lines(bool vertical, vec2 first, out vec2 z[READ], out bvec2 there[READ])
{
    if (vertical) {
        [[unroll]] for (int k = 0; k < READ; k += 2) {
            vec4 left = gather_view_z(first + vec2(0.0, k)),
                 right = gather_view_z(first + vec2(1.0, k));
            z[k] = vec2(left.w, right.w);
            z[k + 1] = vec2(left.x, right.x);
        }
    } else {
        const int next = int(BLOCKS);
        [[unroll]] for (int k = 0; k < next; ++k) {
            vec4 two = gather_view_z(first + vec2(k, 0.0)),
                 third = gather_view_z(first + vec2(k + 2 * next, 0.0));
            z[k] = two.wx;
            z[k + next] = two.zy;
            z[k + 2 * next] = third.wx;
        }
    }
    [[unroll]] for (int k = 0; k < READ; ++k) {
        there[k] = greaterThan(z[k], vec2(0.0));
        z[k] = mix(vec2(NOTHING), z[k], there[k]);
    }
}

void find_breaks(Lines l, int thread, ivec2 low, ivec2 high)
{
    const int which = l.vertical ? 1 : 0;
    int pairs = max(l.log - 1, 0), length = l.vertical ? high.y - low.y : high.x - low.x;
    for (int i = thread; i < WORD / RUN << l.shift << pairs; i += THREADS) {
        /* Threads side by side have lines side by side. */
        int line = 2 * (i & (1 << pairs) - 1), step = RUN * (i >> pairs);
        int along = (l.word * WORD << l.shift) + step;
        vec2 z[READ];
        bvec2 there[READ];
        read_lines(l.vertical, vec2(low + texel_of(l, along - 1, l.first + line)), z, there);
        uvec2 broken = uvec2(0u), nearer = uvec2(0u);
        [[unroll]] for (int k = 0; k < RUN; ++k)
            broken |= uvec2(
                breaks(z[k].x, z[k + 1].x, z[k + 2].x, z[k + 3].x, there[k + 2].x) ? 1u << k : 0u,
                breaks(z[k].y, z[k + 1].y, z[k + 2].y, z[k + 3].y, there[k + 2].y) ? 1u << k : 0u);
        [[unroll]] for (int k = RUN; k > 0; --k)
            nearer = nearer << 1 | floatBitsToUint(z[k + 1] - z[k]) >> 31;
        /* Beyond the last texel nothing breaks. */
        broken &= (1u << clamp(length - 1 - along, 0, RUN)) - 1u;
        uvec4 bits = uvec4(broken & ~nearer, broken & nearer).xzyw;
        for (int fold = 0; fold < min(l.shift, FOLDS); ++fold) {
            bits |= bits >> 1;
            bits = bits & 1u | bits >> 1 & 2u | bits >> 2 & 4u | bits >> 3 & 8u;
        }
        bits <<= step >> l.shift;
        [[unroll]] for (int k = 0; k < 4; ++k)
            if (bits[k] != 0u)
                atomicOr(words[which][line + (k >> 1)][k & 1], bits[k]);
    }
}

void main()
{
    ivec2 low = unpack_texel(params.valid.x), high = unpack_texel(params.valid.y);
    ivec2 size = high - low;
    Reach reach = width_reach();
    Lines rows = lines_of(false, reach.shift.x, size),
          columns = lines_of(true, reach.shift.y, size);
    int thread = int(gl_LocalInvocationIndex);
    for (int i = thread; i < 2 * WORD; i += THREADS)
        words[i >> 5][i & 31] = uvec2(0u);
    barrier();
    find_breaks(rows, thread, low, high);
    find_breaks(columns, thread, low, high);
    barrier();
    if (thread < rows.count && rows.first + thread < size.y)
        imageStore(breaks_x_image, ivec2(rows.word, rows.first + thread), words[0][thread].xyyy);
    if (thread < columns.count && columns.first + thread < size.x)
        imageStore(breaks_y_image, ivec2(columns.first + thread, columns.word),
                   words[1][thread].xyyy);
}
