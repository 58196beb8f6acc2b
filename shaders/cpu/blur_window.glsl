/* SPDX-License-Identifier: MIT
 *
 * The weights of blur.comp for many texels at once: a window of texels is loaded once, and all of
 * its inner texels are blurred from it. */
#ifndef VKAO_BLUR_WINDOW_GLSL_
#define VKAO_BLUR_WINDOW_GLSL_

#include "ring.glsl"
#include "surface.glsl"

/* Texels beyond the radius whose depths tell slopes: see off_surface. */
const int MARGIN = int(GRID_SHIFT);

vec4 window_normal(ivec2 texel)
{
    ivec2 low = unpack_texel(params.valid.x), high = unpack_texel(params.valid.y);
    return stored_normal(clamp(texel, low, high - 1) << GRID_SHIFT);
}

#endif
