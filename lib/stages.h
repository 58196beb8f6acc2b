/* SPDX-License-Identifier: MIT
 *
 * The stages of the image path, which GPUs have: each adds its rows to a program and fills its part
 * of the constants. */
#ifndef VKAO_STAGES_H_
#define VKAO_STAGES_H_

#include "passes.h"
#include "view.h"

void vkao_prepare_plan(struct vkao_program *program);
void vkao_ssao_plan(struct vkao_program *program);
void vkao_blur_plan(struct vkao_program *program);
void vkao_composite_plan(struct vkao_program *program);

/* image: the view on the image's grid; grid: on that of the stages. */
void vkao_prepare_constants(const struct view_constants *image, const struct view_constants *grid,
                            struct vkao_constants *out);
void vkao_ssao_constants(const vkao_effect_info *effect, const vkao_params *params,
                         struct vkao_constants *out);
void vkao_blur_constants(const vkao_params *params, struct vkao_constants *out);
void vkao_composite_constants(const vkao_params *params, struct vkao_constants *out);

#endif
