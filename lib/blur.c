/* SPDX-License-Identifier: MIT */
#include "internal.h"

static_assert(sizeof(struct vkao_blur_block) == 96, "as shaders/blur.comp lays it out");

void record_blur(const vkao_frame *frame, VkCommandBuffer cmd, const struct view_constants *view,
                 const vkao_blur_params *params)
{
    const struct view_constants grid = frame_grid(frame, view);
    struct vkao_blur_block block = {
        .radius = params->radius,
        .sharpness = params->sharpness,
        .normal_power = params->normal_power,
        .encodings = view->encodings,
        .intensity = params->intensity,
        .power = params->power,
        .reference_z = view->reference_z,
        .grid_shift = grid.grid_shift,
    };
    copy_normal_rows(view, block.normal_x, block.normal_y, block.normal_z);
    /* The vertical direction reads the horizontal one's result above and below the rect. */
    struct vkao_rect halfway = rect_grow(grid.rect, 0, params->radius, grid.valid);
    rect_pack(grid.valid, block.valid);
    rect_pack(halfway, block.rect);
    record_label_begin(frame, cmd, "vkao blur");
    record_barrier(
        frame,
        cmd); /* ssao wrote the noisy AO -> blur x reads it; an earlier blur y read halfway */
    record_dispatch(frame, cmd, PIPELINE_BLUR_X, &block, sizeof block, halfway);
    rect_pack(grid.rect, block.rect);
    record_barrier(frame, cmd); /* blur x wrote halfway -> blur y reads it */
    record_dispatch(frame, cmd, PIPELINE_BLUR_Y, &block, sizeof block, grid.rect);
    if (frame->half_resolution)
        record_upsample(frame, cmd, view, params);
    record_label_end(frame, cmd);
}

vkao_result vkao_cmd_blur(const vkao_frame *frame, VkCommandBuffer cmd, const vkao_view *view,
                          const vkao_blur_params *params)
{
    struct view_constants constants = {0};
    vkao_blur_params known;
    vkao_result result =
        frame_view_check(frame, cmd, "vkao_cmd_blur", VKAO_STAGE_BLUR, view, &constants);
    if (result == VKAO_SUCCESS)
        result = blur_params_check(&frame->ctx->log, params, &known);
    if (result == VKAO_SUCCESS)
        record_blur(frame, cmd, &constants, &known);
    return result;
}
