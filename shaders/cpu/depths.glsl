/* SPDX-License-Identifier: MIT
 *
 * The caller's depth of four texels at once, which costs a driver in software little more than one
 * of texelFetch: that looks for the level of each lane. */
#ifndef VKAO_DEPTHS_GLSL_
#define VKAO_DEPTHS_GLSL_

#include "depth.glsl"

layout(binding = VKAO_BINDING_NEAREST) uniform sampler nearest;

/* Of a texel and the one to its right, then of the two below. Outside the image they are those of
 * its edge. */
vec4 four_depths(ivec2 texel)
{
    return textureGather(sampler2D(depth_image, nearest), vec2(texel) + 1.0).wzxy;
}

#endif
