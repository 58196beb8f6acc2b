/* SPDX-License-Identifier: MIT
 *
 * View z of the texels, as the prepare stage left it: an image whose texels are zeros where there
 * is no depth, with a border of them. What is outside is the nearest of the border: above and below
 * a sampler clamps for nothing what would cost a shader three operations, and takes texels as they
 * are counted. */
#ifndef VKAO_VIEW_Z_GLSL_
#define VKAO_VIEW_Z_GLSL_

#include "columns.glsl"

layout(binding = VKAO_BINDING_VIEW_Z) uniform texture2D view_z_image;
layout(binding = VKAO_BINDING_NEAREST) uniform sampler nearest;

/* Where a texel is: the column in its block, with the block as the fraction, and the row. */
vec2 place_of(vec2 texel)
{
    return texel * vec2(1.0 / float(BLOCKS), 1.0) + vec2(1.0, VKAO_VIEW_Z_BORDER + 0.5);
}

/* Of an image that lies as view z does; the column is between 0 and view_z_last. Whole numbers are
 * the edges of texels, and belong to the texel behind them. */
float load_from(texture2D image, float column, float row)
{
    vec2 at = vec2(column + fract(column) * params.view_z_pitch, row);
    return textureLod(sampler2D(image, nearest), at, 0.0).x;
}

float load_from(texture2D image, vec2 texel)
{
    vec2 at = place_of(texel);
    return load_from(image, clamp(at.x, 0.0, params.view_z_last), at.y);
}

/* Of the texels at +offset and at -offset, which is not to the left: each leaves the image on one
 * side. */
vec2 load_sides_from(texture2D image, vec2 texel, vec2 offset)
{
    vec2 at = place_of(texel);
    float columns = offset.x * (1.0 / float(BLOCKS));
    return vec2(load_from(image, min(at.x + columns, params.view_z_last), at.y + offset.y),
                load_from(image, max(at.x - columns, 0.0), at.y - offset.y));
}

/* Of a whole number of texels. */
float load_view_z_at(vec2 texel)
{
    return load_from(view_z_image, texel);
}

/* View z, 0 = background or outside the valid texels. */
float load_view_z(ivec2 texel)
{
    return load_view_z_at(vec2(texel));
}

/* Of the texel at an offset of at most BLOCKS from one in the image: none is beyond the border. */
float view_z_beside(ivec2 texel, ivec2 offset)
{
    vec2 at = place_of(vec2(texel)) + vec2(offset) * vec2(1.0 / float(BLOCKS), 1.0);
    return load_from(view_z_image, at.x, at.y);
}

/* Of a whole texel, the fourth to its right, and those below them, as textureGather has them. */
vec4 gather_view_z(vec2 texel)
{
    vec2 at = place_of(texel) + vec2(1.0, 0.5);
    at.x += fract(at.x) * params.view_z_pitch;
    return textureGather(sampler2D(view_z_image, nearest), at);
}

#endif
