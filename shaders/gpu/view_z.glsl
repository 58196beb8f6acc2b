/* SPDX-License-Identifier: MIT
 *
 * View z of the texels, as the prepare stage left it: an image whose texels are zeros where there
 * is no depth, with a border of them. What is outside is the nearest of the border: a sampler
 * clamps for nothing what would cost a shader six operations, and takes texels as they are
 * counted. */
#ifndef VKAO_VIEW_Z_GLSL_
#define VKAO_VIEW_Z_GLSL_

layout(binding = VKAO_BINDING_VIEW_Z) uniform texture2D view_z_image;
layout(binding = VKAO_BINDING_NEAREST) uniform sampler nearest;

/* Of a whole number of texels. */
float load_view_z_at(vec2 texel)
{
    return textureLod(sampler2D(view_z_image, nearest), texel + (VKAO_VIEW_Z_BORDER + 0.5), 0.0).x;
}

/* View z, 0 = background or outside the valid texels. */
float load_view_z(ivec2 texel)
{
    return load_view_z_at(vec2(texel));
}

/* Of the texel at an offset. */
float view_z_beside(ivec2 texel, ivec2 offset)
{
    return load_view_z_at(vec2(texel) + vec2(offset));
}

#endif
