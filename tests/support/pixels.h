/* SPDX-License-Identifier: MIT
 *
 * Doubles to the bytes of a Vulkan format and back. */
#ifndef VKAO_TESTS_PIXELS_H_
#define VKAO_TESTS_PIXELS_H_

#include <stdint.h>
#include <vulkan/vulkan_core.h>

/* 1, 2 or 4; 0 for formats that are not known here. */
uint32_t pixels_components(VkFormat format);
/* Tightly packed texels. values has 4 doubles a texel; components that the format lacks are
 * ignored. Rounds to nearest, fixed point clamps as Vulkan says. */
void pixels_encode(VkFormat format, const double *values, uint64_t texels, void *bytes);
/* 4 doubles a texel; absent components read (0, 0, 0, 1) as in a shader. */
void pixels_decode(VkFormat format, const void *bytes, uint64_t texels, double *values);

#endif
