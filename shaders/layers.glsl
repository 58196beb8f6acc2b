/* SPDX-License-Identifier: MIT
 *
 * What vbao and raymarch may know beyond the first layer of depth: how thick it is, and the layer
 * behind it. */
#ifndef VKAO_LAYERS_GLSL_
#define VKAO_LAYERS_GLSL_

layout(binding = VKAO_BINDING_SECOND_Z) uniform texture2D second_z_image;

/* As load_view_z. Where thickness is given the second layer has none of its own, and vbao takes it
 * to be thin. */
float load_second_z(ivec2 texel)
{
    ivec2 low = unpack_texel(params.valid.x) - 1, high = unpack_texel(params.valid.y);
    uvec2 inside = min(uvec2(border_texel(texel)), uvec2(high - low));
    float z = texelFetch(second_z_image, low + ivec2(inside) + VKAO_VIEW_Z_BORDER, 0).x;
    return IS_GIVEN ? intBitsToFloat(floatBitsToInt(z) & ~THICKNESS_MASK) : z;
}

/* In radii, from the last bits of view z. */
vec2 thickness_of(vec2 z)
{
    ivec2 code = floatBitsToInt(z) & THICKNESS_MASK;
    code = (code << THICKNESS_SHIFT) + VKAO_THICKNESS_LEAST_BITS;
    return params.thickness * intBitsToFloat(code);
}

#endif
