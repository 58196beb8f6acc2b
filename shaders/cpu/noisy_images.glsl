/* SPDX-License-Identifier: MIT
 *
 * Where AO and bent normals go that do not go through the buffer. */
#ifndef VKAO_NOISY_IMAGES_GLSL_
#define VKAO_NOISY_IMAGES_GLSL_

#include "bent_code.glsl"
#include "half.glsl"

layout(binding = VKAO_BINDING_TARGET) uniform writeonly image2D noisy_image;
layout(binding = VKAO_BINDING_BENT_TARGET) uniform writeonly image2D bent_image;

void store_images(ivec2 texel, vec3 bent, float open)
{
    imageStore(noisy_image, texel, vec4(noisy_texel(open)));
    if (BENT_NORMALS)
        imageStore(bent_image, texel, encode_bent(bent));
}

#endif
