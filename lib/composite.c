/* SPDX-License-Identifier: MIT */
#include "internal.h"

static_assert(offsetof(struct vkao_composite_block, mode) == 24, "as shaders/composite.comp lays it out");
static_assert(VKAO_GLSL_COMPOSITE_MULTIPLY == (int)VKAO_COMPOSITE_MULTIPLY &&
                  VKAO_GLSL_COMPOSITE_INDIRECT == (int)VKAO_COMPOSITE_INDIRECT &&
                  VKAO_GLSL_COMPOSITE_AO_ONLY == (int)VKAO_COMPOSITE_AO_ONLY,
              "params.h repeats vkao_composite_mode");

void record_composite(const vkao_frame *frame, VkCommandBuffer cmd, const struct view_constants *view,
                      const vkao_composite_params *params)
{
    struct vkao_composite_block block = {
        .tint = {params->tint[0], params->tint[1], params->tint[2], params->strength},
        .mode = (uint32_t)params->mode,
    };
    rect_pack(view->rect, block.rect);
    record_label_begin(frame, cmd, "vkao composite");
    record_barrier(frame, cmd); /* ssao or blur y wrote AO -> composite reads it */
    record_dispatch(frame, cmd, PIPELINE_COMPOSITE, &block, sizeof block, view->rect);
    record_label_end(frame, cmd);
}

vkao_result vkao_cmd_composite(const vkao_frame *frame, VkCommandBuffer cmd, const vkao_view *view,
                               const vkao_composite_params *params)
{
    struct view_constants constants = {0};
    vkao_composite_params known;
    vkao_result result = frame_view_check(frame, cmd, "vkao_cmd_composite", VKAO_STAGE_COMPOSITE, view, &constants);
    if (result == VKAO_SUCCESS)
        result = composite_params_check(frame, params, &known);
    if (result == VKAO_SUCCESS)
        record_composite(frame, cmd, &constants, &known);
    return result;
}
