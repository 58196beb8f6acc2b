/* SPDX-License-Identifier: MIT
 *
 * View z of the second layer of depth, an image as the first one's. */
layout(binding = VKAO_BINDING_SECOND_Z) uniform texture2D second_z_image;

/* Where thickness is given the second layer has none of its own, and vbao takes it to be thin. */
float without_thickness(float z)
{
    return IS_GIVEN ? intBitsToFloat(floatBitsToInt(z) & ~THICKNESS_MASK) : z;
}

float load_second_z(ivec2 texel)
{
    return without_thickness(load_from(second_z_image, vec2(texel)));
}

/* As load_sides. */
vec2 load_second_sides(vec2 texel, vec2 offset)
{
    vec2 z = load_sides_from(second_z_image, texel, offset);
    return vec2(without_thickness(z.x), without_thickness(z.y));
}
