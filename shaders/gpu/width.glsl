/* SPDX-License-Identifier: MIT
 *
 * What width.comp reads and writes: images. */
layout(binding = VKAO_BINDING_BREAKS_X) uniform utexture2D breaks_x_image;
layout(binding = VKAO_BINDING_BREAKS_Y) uniform utexture2D breaks_y_image;
layout(binding = VKAO_BINDING_VIEW_Z_WRITE, r32f) uniform image2D view_z_image;

uint load_breaks_x(ivec2 word)
{
    return texelFetch(breaks_x_image, word, 0).x;
}

uint load_breaks_y(ivec2 word)
{
    return texelFetch(breaks_y_image, word, 0).x;
}

float load_prepared_z(ivec2 texel)
{
    return imageLoad(view_z_image, texel + VKAO_VIEW_Z_BORDER).x;
}

void store_prepared_z(ivec2 texel, float z)
{
    imageStore(view_z_image, texel + VKAO_VIEW_Z_BORDER, vec4(z));
}
