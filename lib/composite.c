/* SPDX-License-Identifier: MIT */
#include "internal.h"

#include <string.h>

static_assert(sizeof(struct vkao_composite_block) == 128, "as shaders/composite.comp lays it out");
static_assert(VKAO_GLSL_COMPOSITE_MULTIPLY == (int)VKAO_COMPOSITE_MULTIPLY &&
                  VKAO_GLSL_COMPOSITE_INDIRECT == (int)VKAO_COMPOSITE_INDIRECT &&
                  VKAO_GLSL_COMPOSITE_AO_ONLY == (int)VKAO_COMPOSITE_AO_ONLY &&
                  VKAO_GLSL_COMPOSITE_NOISY_AO == (int)VKAO_COMPOSITE_NOISY_AO &&
                  VKAO_GLSL_COMPOSITE_NORMALS == (int)VKAO_COMPOSITE_NORMALS &&
                  VKAO_GLSL_COMPOSITE_BENT_NORMALS == (int)VKAO_COMPOSITE_BENT_NORMALS &&
                  VKAO_GLSL_COMPOSITE_VIEW_Z == (int)VKAO_COMPOSITE_VIEW_Z,
              "params.h repeats vkao_composite_mode");
static_assert(VKAO_GLSL_SPECULAR_NONE == (int)VKAO_SPECULAR_NONE &&
                  VKAO_GLSL_SPECULAR_FROM_AO == (int)VKAO_SPECULAR_FROM_AO,
              "params.h repeats vkao_specular");

void record_composite(const vkao_frame *frame, VkCommandBuffer cmd,
                      const struct view_constants *view, const vkao_composite_params *params)
{
    const struct view_constants grid = frame_grid(frame, view);
    struct vkao_composite_block block = {
        .tint = {params->tint[0], params->tint[1], params->tint[2], params->strength},
        .normal_x[3] = params->debug_distance,
        .mode = (uint32_t)params->mode,
        .multi_bounce = params->multi_bounce,
        .specular_occlusion = (uint32_t)params->specular,
        .flags = recording_flags(&grid, frame_flags(frame), NULL, NULL),
        .stride = frame->scratch.buffer.stride,
    };
    memcpy(block.inverse_unproject, grid.inverse_unproject, sizeof block.inverse_unproject);
    memcpy(block.unproject, grid.unproject, sizeof block.unproject);
    copy_normal_rows(view, block.normal_x, block.normal_y, block.normal_z);
    rect_pack(grid.valid, block.valid);
    rect_pack(view->rect, block.rect);
    record_label_begin(frame, cmd, "vkao composite");
    record_barrier(frame, cmd); /* ssao or blur y wrote AO -> composite reads it */
    const bool debug = params->mode > VKAO_COMPOSITE_AO_ONLY;
    record_dispatch(frame, cmd, debug ? PIPELINE_DEBUG : PIPELINE_COMPOSITE,
                    (struct pipeline_key){0}, &block, sizeof block, view->rect);
    record_label_end(frame, cmd);
}

vkao_result vkao_cmd_composite(const vkao_frame *frame, VkCommandBuffer cmd, const vkao_view *view,
                               const vkao_composite_params *params)
{
    struct view_constants constants = {0};
    vkao_composite_params known;
    vkao_result result =
        frame_view_check(frame, cmd, "vkao_cmd_composite", VKAO_STAGE_COMPOSITE, view, &constants);
    if (result == VKAO_SUCCESS)
        result = composite_params_check(frame, params, &known);
    if (result == VKAO_SUCCESS)
        record_composite(frame, cmd, &constants, &known);
    return result;
}
