/* SPDX-License-Identifier: MIT
 *
 * The CPU's passes, in place of those of the image path: scratch is a buffer that shaders read
 * several texels at a time (shaders/cpu/layout.h says how they lie in it), SSAO runs in the tiles
 * that have anything in them, and the blur goes down the image in strips and hands its result over
 * in rows. Nothing outside of this folder knows more of it than this. */
#ifndef VKAO_CPU_H_
#define VKAO_CPU_H_

#include "frame.h"

void vkao_cpu_plan(struct vkao_program *program);
/* VKAO_SETTING_PATH. */
uint32_t vkao_cpu_setting(const struct vkao_program *program);

/* Can its buffers hold a frame of that size? */
bool vkao_cpu_fits(const struct vkao_program *program, VkExtent2D extent);
/* Parts of the scratch buffer, and how texels lie in them. */
void vkao_cpu_parts(const struct vkao_program *program, VkExtent2D extent, bool copies,
                    struct vkao_rows *rows, VkDeviceSize parts[VKAO_RESOURCE_COUNT]);

#endif
