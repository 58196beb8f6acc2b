/* SPDX-License-Identifier: MIT
 *
 * AO between the two directions of the blur: an image of the grid's size. */
layout(push_constant) uniform Block { vkao_dispatch here; };

ivec2 halfway_texel(ivec2 texel)
{
    return texel;
}
