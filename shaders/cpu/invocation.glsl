/* SPDX-License-Identifier: MIT
 *
 * SSAO of a CPU: TEXELS of a tile from the list per invocation, as codes into the buffer or as texels into an image. With
 * VKAO_STORAGE_16BIT two codes are one store to a storage buffer, which costs less than a texel buffer. */
layout(local_size_x = VKAO_ROW_GROUP_WIDTH) in;
layout(binding = VKAO_BINDING_TARGET) uniform writeonly image2D noisy_image;
#ifdef VKAO_STORAGE_16BIT
#ifndef VKAO_SIDE_BY_SIDE
#error two codes at once are those of two texels
#endif
layout(binding = VKAO_BINDING_PACKED_WORDS) writeonly buffer Packed { uint16_t packed_pairs[]; };
#else
layout(binding = VKAO_BINDING_PACKED_WRITE) uniform writeonly uimageBuffer packed_codes;
#endif
layout(binding = VKAO_BINDING_TILES) readonly buffer Tiles { vkao_tiles_head head; uint tiles[]; };
layout(constant_id = VKAO_SETTING_PATH) const uint PATH = 0u;

void store_noisy(ivec2 texel, Visibility v)
{
    /* All of the texels at once, those beyond the rect as well: what they are does not depend on it. */
    if ((PATH & VKAO_PATH_PACKED) != 0u) {
        whole code = whole(clamp((v.open + VKAO_CODE_OFFSET) * VKAO_CODE_SCALE, 0.0, 255.0) + 0.5);
        int at = (buffer_row(texel.y) + texel.x) / TEXELS;
#ifdef VKAO_STORAGE_16BIT
        packed_pairs[at] = uint16_t(pack_codes(code));
#else
        imageStore(packed_codes, at, uvec4(pack_codes(code)));
#endif
        return;
    }
    [[unroll]] for (int i = 0; i < TEXELS; ++i) {
        ivec2 at = texel + ivec2(i, 0);
        vec4 result = vec4(lane3(v.bent, i), lane(v.open, i));
        if (in_rect(at, here.rect))
            imageStore(noisy_image, at, BENT_NORMALS ? result : result.wwww);
    }
}

void main()
{
    /* Straight on, also where there is nothing to do: a driver in software runs both sides of a branch anyway. */
    ivec2 texel = unpack_texel(tiles[gl_WorkGroupID.y]);
    texel += ivec2(int(gl_LocalInvocationID.x) * TEXELS, gl_WorkGroupID.x);
    Visibility v = shade(texel);
    if (all(lessThan(texel, unpack_texel(here.rect.y))))
        store_noisy(texel, v);
}
