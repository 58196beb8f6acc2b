/* SPDX-License-Identifier: MIT
 *
 * AO as SSAO left it, for the debug views. */
layout(binding = VKAO_BINDING_SOURCE) uniform texture2D noisy_image;

float noisy_ao(ivec2 texel)
{
    return texelFetch(noisy_image, texel, 0).x;
}
