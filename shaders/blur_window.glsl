/* SPDX-License-Identifier: MIT
 *
 * The weights of blur.comp for many texels at once: a window of texels is loaded once, and all of its inner texels are
 * blurred from it. With VKAO_ANY_RADIUS, for the general pipelines, the radius is a push constant and taps are taken one
 * by one. The includer's params are vkao_blur_block. */
#ifndef VKAO_BLUR_WINDOW_GLSL_
#define VKAO_BLUR_WINDOW_GLSL_

layout(constant_id = VKAO_CONSTANT_RADIUS) const int RADIUS = 0;

#include "surface.glsl"

/* Texels beyond the radius whose depths tell slopes: see off_surface. */
const int MARGIN = int((FLAGS / VKAO_FLAG_HALF_RESOLUTION) & 1u);

/* A normal, and in w 1 if there is none. */
vec4 window_normal(ivec2 texel)
{
    ivec2 low = unpack_texel(params.valid.x), high = unpack_texel(params.valid.y);
    vec3 n = decode_normal(clamp(texel, low, high - 1) << grid_shift());
    return vec4(n, n == vec3(0.0) ? 1.0 : 0.0);
}

/* Row of the ring that holds the image's row y. */
int ring_row(int y)
{
    int row = y - int(params.ring_row);
    return row >= VKAO_RING_ROWS ? row - VKAO_RING_ROWS : row;
}

#endif
