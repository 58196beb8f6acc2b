/* SPDX-License-Identifier: MIT
 *
 * Which tiles SSAO has anything to do in, for its indirect dispatch: a CPU runs both sides of every
 * branch, so that sky would cost as much as what stands before it. An invocation looks at one tile;
 * a tile of sky alone is open. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_EXT_samplerless_texture_functions : require
#define VKAO_GLSL
#include "layout.h"

layout(local_size_x = VKAO_ROW_GROUP_WIDTH) in;
layout(push_constant) uniform Block { vkao_tiling here; };
#include "settings.glsl"
layout(constant_id = VKAO_SETTING_PATH) const uint PATH = 0u;
layout(binding = VKAO_BINDING_Z4, rgba32f) uniform readonly imageBuffer view_z4;
layout(binding = VKAO_BINDING_PACKED_WORDS) writeonly buffer Packed { uint packed_ao[]; };
layout(binding = VKAO_BINDING_TILES) buffer Tiles { vkao_tiles_head head; uint tiles[]; };
#include "buffers.glsl"
#include "noisy_images.glsl"

/* All that VKAO_CODE_* make of 1. */
const uint OPEN_WORD = uint(VKAO_CODE_OPEN / VKAO_CODE_FINE) * 0x01010101u;

void store_open(ivec2 low, ivec2 high)
{
    for (int y = low.y; y < high.y; ++y) {
        for (int x = low.x; x < high.x; x += 4) {
            if ((PATH & VKAO_PATH_PACKED) != 0u) {
                packed_ao[(buffer_row(y) + x) >> 2] = OPEN_WORD;
                continue;
            }
            for (int i = max(x, int(here.rect.x & 0xffffu)); i < min(x + 4, high.x); ++i)
                store_images(ivec2(i, y), vec3(0.0), 1.0);
        }
    }
}

void main()
{
    /* Strip by strip, and down each strip: the texels within reach of a strip stay in a CPU's
     * cache. */
    uint strip_tiles = here.strip_columns * here.tiles.y;
    uint strip = gl_GlobalInvocationID.x / strip_tiles,
         left = gl_GlobalInvocationID.x % strip_tiles;
    uint columns =
        min(here.strip_columns, here.tiles.x - min(here.tiles.x, strip * here.strip_columns));
    if (columns == 0u || left >= columns * here.tiles.y)
        return;
    uvec2 tile = uvec2(strip * here.strip_columns + left % columns, left / columns);
    ivec2 rect_low = ivec2(here.rect.x & 0xffffu, here.rect.x >> 16);
    ivec2 rect_high = ivec2(here.rect.y & 0xffffu, here.rect.y >> 16);
    ivec2 size = ivec2(here.tile_width, here.tile_height);
    ivec2 low = ivec2(round_down(rect_low.x, 4), rect_low.y) + ivec2(tile) * size;
    ivec2 high = min(low + size, rect_high);
    bool sky = true;
    for (int y = low.y; y < high.y && sky; ++y) {
        for (int x = low.x; x < high.x && sky; x += 4)
            sky = !any(greaterThan(imageLoad(view_z4, (z_row(y) + x) >> 2), vec4(0.0)));
    }
    if (sky) {
        store_open(low, high);
    } else {
        tiles[atomicAdd(head.count, 1u)] = uint(low.x) | uint(low.y) << 16;
    }
}
