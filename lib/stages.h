/* SPDX-License-Identifier: MIT
 *
 * The stages of the image path, which GPUs have: each adds its rows to a program and fills its part
 * of the constants. */
#ifndef VKAO_STAGES_H_
#define VKAO_STAGES_H_

#include "recording.h"

#include <math.h>

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

/* As constants have it. Beyond that all depth is near, or all far: nothing changes but that squares
 * are floats. */
static inline float vkao_radius_of(const vkao_params *params)
{
    return fminf(fmaxf(params->radius, (float)VKAO_NEAREST_Z), (float)VKAO_FARTHEST_Z);
}

/* The image of view z for a grid of texels. */
VkExtent2D vkao_view_z_extent(VkExtent2D grid);
/* VKAO_SETTING_TILE_WORDS. */
uint32_t vkao_blur_tile_words(const vkao_effect_info *effect);

#endif
