/* SPDX-License-Identifier: MIT
 *
 * Final AO of four neighbours in a row, from the shaders for buffers: into the AO image texel by
 * texel, or as words that will be copied there, which is many times faster on a CPU. */
#ifndef VKAO_STAGED_GLSL_
#define VKAO_STAGED_GLSL_

layout(constant_id = VKAO_SETTING_PATH) const uint PATH = 0u;
layout(constant_id = VKAO_SETTING_COPIED) const bool COPIED = false;
const uint FORMAT = PATH & VKAO_PATH_FORMAT;
layout(binding = VKAO_BINDING_STAGED_WORDS) writeonly buffer Staged { uint staged[]; };

#define VKAO_NO_BENT_NORMALS /* they go through images */
#include "finish.glsl"

/* From texel on, whose x is a multiple of 4, as all of a word are written: those beyond the rect
 * are not copied. */
void stage(ivec2 texel, vec4 ao)
{
    int at = (texel.y - int(here.rect.x >> 16)) * VKAO_STAGED_STRIDE + texel.x;
    if (FORMAT == VKAO_STAGED_UNORM8) {
        ivec4 v = ivec4(ao * 255.0 + 0.5);
        staged[at >> 2] = uint(v.x | v.y << 8 | v.z << 16 | v.w << 24);
    } else if (FORMAT == VKAO_STAGED_UNORM16) {
        ivec4 v = ivec4(ao * 65535.0 + 0.5);
        staged[at >> 1] = uint(v.x | v.y << 16);
        staged[(at >> 1) + 1] = uint(v.z | v.w << 16);
    } else if (FORMAT == VKAO_STAGED_FLOAT16) {
        staged[at >> 1] = packHalf2x16(ao.xy);
        staged[(at >> 1) + 1] = packHalf2x16(ao.zw);
    } else {
        [[unroll]] for (int i = 0; i < 4; ++i)
            staged[at + i] = floatBitsToUint(ao[i]);
    }
}

void put_ao(ivec2 texel, vec4 visibility, bvec4 background)
{
    ivec2 low = unpack_texel(here.rect.x), high = unpack_texel(here.rect.y);
    if (COPIED) {
        vec4 ao;
        [[unroll]] for (int i = 0; i < 4; ++i)
            ao[i] = final_ao(visibility[i], background[i]);
        if (texel.y >= low.y && texel.y < high.y)
            stage(texel, ao);
        return;
    }
    [[unroll]] for (int i = 0; i < 4; ++i) {
        if (in_rect(texel + ivec2(i, 0), here.rect))
            finish(texel + ivec2(i, 0), vec4(0.0, 0.0, 0.0, visibility[i]), background[i]);
    }
}

#endif
