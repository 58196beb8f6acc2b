/* SPDX-License-Identifier: MIT
 *
 * What width.comp reads and writes: buffers. */
#include "layout.h"
#include "buffers.glsl"

layout(binding = VKAO_BINDING_BREAKS_X_READ, r32ui) uniform readonly uimageBuffer breaks_x;
layout(binding = VKAO_BINDING_BREAKS_Y_READ, r32ui) uniform readonly uimageBuffer breaks_y;
layout(binding = VKAO_BINDING_Z_WORDS) buffer ViewZ { float view_z[]; };

uint load_breaks_x(ivec2 word)
{
    return imageLoad(breaks_x, word.y * VKAO_BREAKS_STRIDE + word.x).x;
}

uint load_breaks_y(ivec2 word)
{
    return imageLoad(breaks_y, word.y * VKAO_STRIDE + word.x).x;
}

float load_prepared_z(ivec2 texel)
{
    return view_z[z_row(texel.y) + texel.x];
}

void store_prepared_z(ivec2 texel, float z)
{
    view_z[z_row(texel.y) + texel.x] = z;
}
