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

/* From where border_view_z counts: the first texel of the border. */
ivec2 border_texel(ivec2 texel)
{
    return texel - unpack_texel(params.valid.x) + 1;
}

/* View z, 0 = background or outside the valid texels: prepare writes a border of zeros around them,
 * to which what is outside is moved. As an unsigned number, what is too small is too large. */
float border_view_z(ivec2 at)
{
    ivec2 low = unpack_texel(params.valid.x) - 1, high = unpack_texel(params.valid.y);
    uvec2 inside = min(uvec2(at), uvec2(high - low));
    return fetch_view_z_from(low, inside);
}

float load_view_z(ivec2 texel)
{
    return border_view_z(border_texel(texel));
}

/* Of the texel at an offset. */
float view_z_beside(ivec2 texel, ivec2 offset)
{
    return load_view_z(texel + offset);
}

#endif
