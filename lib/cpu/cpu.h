/* SPDX-License-Identifier: MIT
 *
 * The CPU's passes, in place of those of the image path: scratch is a buffer that shaders read
 * several texels at a time (shaders/cpu/layout.h says how they lie in it), SSAO runs in the tiles
 * that have anything in them, and the blur goes down the image in strips and hands its result over
 * in rows. Nothing outside of this folder knows more of it than this. */
#ifndef VKAO_CPU_H_
#define VKAO_CPU_H_

#include "frame.h"

/* Parts of the scratch buffer. */
enum {
    VKAO_PART_Z = VKAO_RESOURCE_CPU,
    VKAO_PART_PACKED,  /* codes of noisy AO */
    VKAO_PART_HALFWAY, /* the ring */
    VKAO_PART_RING_NORMALS,
    VKAO_PART_BLURRED,
    VKAO_PART_COPIED,
    VKAO_PART_TILES,
    VKAO_PART_BREAKS_X,
    VKAO_PART_BREAKS_Y,
    VKAO_PART_END
};

/* Has it passes for these settings? Without, those of the image path run. */
bool vkao_cpu_has(const vkao_effect_info *settings);
/* Adds its passes of a stage. False where the stage has none of its own: those of the image path
 * touch nothing of the CPU's. */
bool vkao_cpu_plan(struct vkao_program *program, vkao_stage_flags stage);
/* Rows of the image between the two directions of the blur, on a grid of so many. */
uint32_t vkao_cpu_halfway_rows(uint32_t height);
/* VKAO_SETTING_PATH. */
uint32_t vkao_cpu_setting(const struct vkao_program *program);

/* Can its buffers hold a frame of that size? */
bool vkao_cpu_fits(const struct vkao_program *program, VkExtent2D extent);
/* Parts of the scratch buffer, and how texels lie in them. */
void vkao_cpu_parts(const struct vkao_program *program, VkExtent2D extent, bool copies,
                    struct vkao_rows *rows, VkDeviceSize parts[VKAO_RESOURCE_COUNT]);

#endif
