/* SPDX-License-Identifier: MIT
 *
 * AO as SSAO left it, for the debug views. */
#include "visibility_code.glsl"

layout(binding = VKAO_BINDING_SOURCE) uniform texture2D noisy_image;

float noisy_ao(ivec2 texel)
{
    return decode_visibility(texelFetch(noisy_image, texel, 0).x);
}
