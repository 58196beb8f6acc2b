/* SPDX-License-Identifier: MIT
 *
 * The stages of the image path, which GPUs have: each adds its rows to a program and fills its part
 * of the constants. */
#ifndef VKAO_STAGES_H_
#define VKAO_STAGES_H_

#include "recording.h"

/* In the order in which they run. PREPARE is in a program that makes AO. */
#define VKAO_STAGES(X)                                                                             \
    X(PREPARE, prepare)                                                                            \
    X(SSAO, ssao)                                                                                  \
    X(BLUR, blur)                                                                                  \
    X(COMPOSITE, composite)

#define VKAO_DECLARE_STAGE(NAME, name)                                                             \
    void vkao_##name##_plan(struct vkao_program *program);                                         \
    void vkao_##name##_constants(const struct vkao_recording *r, const vkao_params *params,        \
                                 struct vkao_constants *out);
VKAO_STAGES(VKAO_DECLARE_STAGE)
#undef VKAO_DECLARE_STAGE

/* The image of view z for a grid of texels, and how many columns a block of it has: see
 * shaders/gpu/columns.glsl. */
VkExtent2D vkao_view_z_extent(VkExtent2D grid);
uint32_t vkao_view_z_columns(uint32_t width);
/* VKAO_SETTING_TILE_WORDS. */
uint32_t vkao_blur_tile_words(const vkao_effect_info *effect);

#endif
