/* SPDX-License-Identifier: MIT
 *
 * prepare.comp for scratch in buffers: VKAO_PREPARE_WIDTH texels of a row at once, and zeros into
 * the padding. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_EXT_samplerless_texture_functions : require
#define VKAO_GLSL
#include "layout.h"

layout(local_size_x = VKAO_GROUP_WIDTH, local_size_y = VKAO_GROUP_HEIGHT) in;
layout(push_constant) uniform Block { vkao_dispatch here; };
#include "settings.glsl"
layout(binding = VKAO_BINDING_Z_WORDS) writeonly buffer ViewZ { vec4 view_z[]; };
#include "buffers.glsl"
#include "depth.glsl"

void main()
{
    ivec2 low = ivec2(params.valid.x & 0xffffu, params.valid.x >> 16);
    ivec2 high = ivec2(params.valid.y & 0xffffu, params.valid.y >> 16);
    ivec2 first =
        ivec2(round_down(low.x, VKAO_BLUR_X_WIDTH) - VKAO_BUFFER_PAD, low.y - VKAO_VIEW_Z_BORDER);
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy) * ivec2(VKAO_PREPARE_WIDTH, 1) + first;
    if (texel.x >= high.x + VKAO_BUFFER_PAD || texel.y >= high.y + VKAO_VIEW_Z_BORDER)
        return;
    vec4 z;
    [[unroll]] for (int i = 0; i < VKAO_PREPARE_WIDTH; ++i) {
        ivec2 at = texel + ivec2(i, 0);
        float inside = view_z_from_depth(clamp(at, low, high - 1) << GRID_SHIFT);
        z[i] = all(equal(at, clamp(at, low, high - 1))) ? inside : 0.0;
    }
    view_z[(z_row(texel.y) + texel.x) >> 2] = z;
}
