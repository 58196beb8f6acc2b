/* SPDX-License-Identifier: MIT
 *
 * What the README's engine example says is the engine's own. */
#ifndef README_PRELUDE_H_
#define README_PRELUDE_H_

#include "vkao.h"

#include <stdbool.h>
#include <string.h>

extern vkao_context *context;
extern vkao_effect *effect;
extern vkao_frame *frame;
extern VkImage ao_image;
extern VkExtent2D extent;
extern VkInstance instance;
extern VkPhysicalDevice physical_device;
extern VkDevice device;
extern VkCommandBuffer cmd;
extern VkImageView depth_view, normals_view, ao_view, color_view, direct_view, output_view;
extern float camera_projection[16];

bool engine(void);

#endif
