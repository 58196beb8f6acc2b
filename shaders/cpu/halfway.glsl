/* SPDX-License-Identifier: MIT
 *
 * AO between the two directions of the blur: an image of the rows of a ring. */
#include "layout.h"

layout(push_constant) uniform Block { vkao_strip here; };
#include "ring.glsl"

ivec2 halfway_texel(ivec2 texel)
{
    return ivec2(texel.x, ring_row(texel.y));
}
