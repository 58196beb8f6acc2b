/* SPDX-License-Identifier: MIT
 *
 * The caller's images of a frame: one row a slot. */
#ifndef VKAO_SLOTS_H_
#define VKAO_SLOTS_H_

#include "passes.h"

const vkao_image *vkao_slot_image(const vkao_images *images, uint32_t slot);
/* "images.depth" */
const char *vkao_slot_name(uint32_t slot);

/* What the program needs is there, and what is there can be used. need_views: views must not be
 * null, and layouts must fit. */
vkao_result vkao_slots_check(const struct vkao_program *program, const vkao_images *images,
                             bool need_views);
/* Says what SSAO would read or write by other settings. Stages may share a vkao_images, so that
 * what others need is no mistake. */
void vkao_slots_warn(const struct vkao_program *program, const vkao_images *images);

#endif
