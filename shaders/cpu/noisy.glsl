/* SPDX-License-Identifier: MIT
 *
 * AO as SSAO left it, for the debug views: codes in a buffer, or an image. */
layout(binding = VKAO_BINDING_SOURCE) uniform texture2D noisy_image;
layout(binding = VKAO_BINDING_PACKED_READ4, r32ui) uniform readonly uimageBuffer packed_ao;
layout(constant_id = VKAO_SETTING_PATH) const uint PATH = 0u;

float noisy_ao(ivec2 texel)
{
    if ((PATH & VKAO_PATH_PACKED) == 0u)
        return texelFetch(noisy_image, texel, 0).x;
    int i = buffer_row(texel.y) + texel.x;
    return float((imageLoad(packed_ao, i >> 2).x >> ((i & 3) << 3)) & 255u) / VKAO_CODE_SCALE -
           VKAO_CODE_OFFSET;
}
