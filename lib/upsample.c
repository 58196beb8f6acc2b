/* SPDX-License-Identifier: MIT */
#include "internal.h"

#include <string.h>

static_assert(sizeof(struct vkao_upsample_block) == 120, "as shaders/upsample.comp lays it out");

void record_upsample(const vkao_frame *frame, VkCommandBuffer cmd,
                     const struct view_constants *view, const vkao_blur_params *params)
{
    const struct view_constants grid = frame_grid(frame, view);
    struct vkao_upsample_block block = {
        .normal_x[3] = params->sharpness,
        .normal_y[3] = params->normal_power,
        .normal_z[3] = view->reference_z,
        .linearize = {view->linearize[0], view->linearize[1]},
        .far_depth = view->far_depth,
        .far_z = view->far_z,
        .intensity = params->intensity,
        .power = params->power,
        .encodings = view->encodings | view->depth_encoding << 16,
        .orthographic = view->orthographic,
    };
    memcpy(block.unproject, view->unproject, sizeof block.unproject);
    copy_normal_rows(view, block.normal_x, block.normal_y, block.normal_z);
    rect_pack(grid.valid, block.valid);
    rect_pack(view->valid, block.full_valid);
    rect_pack(view->rect, block.rect);
    record_barrier(frame, cmd); /* blur y wrote half-resolution AO -> upsample reads it */
    record_dispatch(frame, cmd, PIPELINE_UPSAMPLE, &block, sizeof block, view->rect);
}
