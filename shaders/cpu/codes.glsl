/* SPDX-License-Identifier: MIT
 *
 * Tiles that SSAO of a CPU works on, and codes of AO in the buffer: VKAO_CODES of them in a word
 * that is stored at once. */
#ifndef VKAO_CODES_GLSL_
#define VKAO_CODES_GLSL_

layout(constant_id = VKAO_SETTING_PATH) const uint PATH = 0u;
layout(binding = VKAO_BINDING_TILES) readonly buffer Tiles { vkao_tiles_head head; uint tiles[]; };
#ifdef VKAO_STORAGE_16BIT
layout(binding = VKAO_BINDING_PACKED_WORDS) writeonly buffer Packed { uint16_t packed_pairs[]; };
#else
layout(binding = VKAO_BINDING_PACKED_WRITE) uniform writeonly uimageBuffer packed_codes;
#endif

/* The first of the group's tile. */
ivec2 tile_texel()
{
    return unpack_texel(tiles[gl_WorkGroupID.y]);
}

int code_of(float open)
{
    float code = open * VKAO_CODE_SCALE + VKAO_CODE_OFFSET * VKAO_CODE_SCALE;
    return int(clamp(code, 0.0, 255.0) + 0.5);
}

void store_codes(ivec2 texel, int codes)
{
    int at = (buffer_row(texel.y) + texel.x) / VKAO_CODES;
#ifdef VKAO_STORAGE_16BIT
    packed_pairs[at] = uint16_t(codes);
#else
    imageStore(packed_codes, at, uvec4(codes));
#endif
}

#endif
