/* SPDX-License-Identifier: MIT
 *
 * What is stored as half floats. Vulkan lets a driver round it or cut it off: NVIDIA's and lavapipe
 * cut, and took .0005 from AO that was a rounding error below 1. */
#ifndef VKAO_HALF_GLSL_
#define VKAO_HALF_GLSL_

/* The nearest half float, of two the even one. Below 2^-14, where they lie closer than these bits,
 * the rest is 2^-24 at most. */
float nearest_half(float v)
{
    uint bits = floatBitsToUint(v);
    return uintBitsToFloat(bits + 0xfffu + (bits >> 13 & 1u) & ~0x1fffu);
}

vec4 nearest_half(vec4 v)
{
    return vec4(nearest_half(v.x), nearest_half(v.y), nearest_half(v.z), nearest_half(v.w));
}

/* For the AO image. */
float ao_texel(float ao)
{
    return HALF_AO ? nearest_half(ao) : ao;
}

/* For what SSAO writes. */
float noisy_texel(float ao)
{
    return HALF_NOISY ? nearest_half(ao) : ao;
}

#endif
