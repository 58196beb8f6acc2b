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

/* VKAO_SETTING_TILE_WORDS. */
uint32_t vkao_blur_tile_words(const vkao_effect_info *effect);

#endif
