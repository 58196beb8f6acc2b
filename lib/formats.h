/* SPDX-License-Identifier: MIT
 *
 * Formats and layouts of the caller's images. */
#ifndef VKAO_FORMATS_H_
#define VKAO_FORMATS_H_

#include <stdbool.h>
#include <vulkan/vulkan_core.h>

/* Name and number, as messages show them: "R8_UNORM (9)". */
enum { VKAO_NAME_BYTES = 64 };
const char *vkao_format_name(VkFormat format, char buffer[VKAO_NAME_BYTES]);
const char *vkao_layout_name(VkImageLayout layout, char buffer[VKAO_NAME_BYTES]);

/* Formats of colour that texture2D can read: neither integers nor multi-planar. */
bool vkao_format_is_color(VkFormat format);
bool vkao_format_is_srgb(VkFormat format);
/* Formats of AO images. */
bool vkao_format_is_ao(VkFormat format);
/* Depth formats and one-component floats. */
bool vkao_format_is_depth(VkFormat format);
/* Size of one step of a depth value in [0.5,1), and whether the format floats; 0 for other
 * formats. */
float vkao_format_depth_step(VkFormat format, bool *floating);
/* Of formats of colour: components without alpha, 3 for 3 and more; is there alpha; can they hold
 * negative numbers? */
uint32_t vkao_format_components(VkFormat format);
bool vkao_format_has_alpha(VkFormat format);
bool vkao_format_is_signed(VkFormat format);

#endif
