/* SPDX-License-Identifier: MIT
 *
 * Words of breaks, into an image. */
layout(binding = VKAO_BINDING_BREAKS_WRITE) uniform writeonly uimage2D breaks_image;

void store_breaks(ivec2 word, uint bits)
{
    imageStore(breaks_image, word, uvec4(bits));
}
