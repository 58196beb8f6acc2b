/* SPDX-License-Identifier: MIT
 *
 * View z of the texels, as the prepare stage left it: a buffer with a border of zeros. */
#ifndef VKAO_VIEW_Z_GLSL_
#define VKAO_VIEW_Z_GLSL_

#include "layout.h"
#include "buffers.glsl"

layout(binding = VKAO_BINDING_Z, r32f) uniform readonly imageBuffer view_z_texels;

/* Of a texel of the valid ones or of the border around them. */
float fetch_view_z(ivec2 texel)
{
    return imageLoad(view_z_texels, z_row(texel.y) + texel.x).x;
}

/* The same, counted from texel low. */
float fetch_view_z_from(ivec2 low, uvec2 texel)
{
    return imageLoad(view_z_texels, int(texel.y * params.path.x + texel.x) + (z_row(low.y) + low.x))
        .x;
}

#endif
