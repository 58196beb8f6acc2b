/* SPDX-License-Identifier: MIT
 *
 * prepare.comp for scratch in buffers: VKAO_PREPARE_WIDTH by VKAO_PREPARE_HEIGHT texels at once,
 * and zeros into the padding. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_EXT_samplerless_texture_functions : require
#define VKAO_GLSL
#include "layout.h"

layout(local_size_x = VKAO_GROUP_OF(VKAO_PREPARE_WIDTH)) in;
layout(push_constant) uniform Block { vkao_dispatch here; };
#include "settings.glsl"
layout(binding = VKAO_BINDING_Z_WORDS) writeonly buffer ViewZ { vec4 view_z[]; };
#include "buffers.glsl"
#include "depths.glsl"

/* Of the texels from one of the grid on; what is not valid may have any. */
void load_depths(ivec2 texel, ivec2 low, ivec2 high, out vec4 depth[VKAO_PREPARE_HEIGHT])
{
    if (GRID_SHIFT == 0u) {
        vec4 left = four_depths(texel), right = four_depths(texel + ivec2(2, 0));
        depth[0] = vec4(left.xy, right.xy);
        depth[1] = vec4(left.zw, right.zw);
        return;
    }
    [[unroll]] for (int row = 0; row < VKAO_PREPARE_HEIGHT; ++row) {
        [[unroll]] for (int i = 0; i < VKAO_PREPARE_WIDTH; ++i) {
            ivec2 at = clamp(texel + ivec2(i, row), low, high - 1);
            depth[row][i] = texelFetch(depth_image, at << GRID_SHIFT, 0).x;
        }
    }
}

void main()
{
    ivec2 low = ivec2(params.valid.x & 0xffffu, params.valid.x >> 16);
    ivec2 high = ivec2(params.valid.y & 0xffffu, params.valid.y >> 16);
    ivec2 first =
        ivec2(round_down(low.x, VKAO_BLUR_X_WIDTH) - VKAO_BUFFER_PAD, low.y - VKAO_VIEW_Z_BORDER);
    ivec2 texel =
        ivec2(gl_GlobalInvocationID.xy) * ivec2(VKAO_PREPARE_WIDTH, VKAO_PREPARE_HEIGHT) + first;
    ivec2 end = high + ivec2(VKAO_BUFFER_PAD, VKAO_VIEW_Z_BORDER);
    if (any(greaterThanEqual(texel, end)))
        return;
    vec4 depth[VKAO_PREPARE_HEIGHT];
    load_depths(texel, low, high, depth);
    [[unroll]] for (int row = 0; row < VKAO_PREPARE_HEIGHT; ++row) {
        vec4 z;
        [[unroll]] for (int i = 0; i < VKAO_PREPARE_WIDTH; ++i) {
            ivec2 at = texel + ivec2(i, row);
            bool inside = all(equal(at, clamp(at, low, high - 1)));
            z[i] = inside ? view_z_of(depth[row][i], at << GRID_SHIFT) : 0.0;
        }
        if (texel.y + row < end.y)
            view_z[(z_row(texel.y + row) + texel.x) >> 2] = z;
    }
}
