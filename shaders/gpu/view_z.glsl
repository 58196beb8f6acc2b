/* SPDX-License-Identifier: MIT
 *
 * View z of the texels, as the prepare stage left it: an image with a border of zeros. */
#ifndef VKAO_VIEW_Z_GLSL_
#define VKAO_VIEW_Z_GLSL_

layout(binding = VKAO_BINDING_VIEW_Z) uniform texture2D view_z_image;

/* Of a texel of the valid ones or of the border around them. */
float fetch_view_z(ivec2 texel)
{
    return texelFetch(view_z_image, texel + VKAO_VIEW_Z_BORDER, 0).x;
}

/* The same, counted from texel low. */
float fetch_view_z_from(ivec2 low, uvec2 texel)
{
    return fetch_view_z(low + ivec2(texel));
}

#endif
