/* SPDX-License-Identifier: MIT
 *
 * View z of the second layer of depth, an image as the first one's. */
layout(binding = VKAO_BINDING_SECOND_Z) uniform texture2D second_z_image;

/* As load_view_z_at. Where thickness is given the second layer has none of its own, and vbao takes
 * it to be thin. */
float load_second_z_at(vec2 texel)
{
    vec2 at = texel + (VKAO_VIEW_Z_BORDER + 0.5);
    float z = textureLod(sampler2D(second_z_image, nearest), at, 0.0).x;
    return IS_GIVEN ? intBitsToFloat(floatBitsToInt(z) & ~THICKNESS_MASK) : z;
}

float load_second_z(ivec2 texel)
{
    return load_second_z_at(vec2(texel));
}
