/* SPDX-License-Identifier: MIT */
#include "internal.h"

#include <string.h>

static_assert(sizeof(struct vkao_upsample_block) == 116, "as shaders/upsample.comp lays it out");

void record_upsample(const vkao_frame *frame, VkCommandBuffer cmd,
                     const struct view_constants *view, const vkao_blur_params *params)
{
    const struct view_constants grid = frame_grid(frame, view);
    struct vkao_upsample_block block = {
        .normal_x[3] = params->sharpness,
        .normal_y[3] = params->normal_power,
        .normal_z[3] = view->reference_z,
        .linearize = {view->linearize[0], view->linearize[1]},
        .far_z = view->far_z,
        .intensity = params->intensity,
        .power = params->power,
        .flags = recording_flags(view, frame->packed, NULL, params),
        .stride = frame->scratch.buffer.stride,
    };
    memcpy(block.unproject, view->unproject, sizeof block.unproject);
    copy_normal_rows(view, block.normal_x, block.normal_y, block.normal_z);
    rect_pack(grid.valid, block.valid);
    rect_pack(view->valid, block.full_valid);
    rect_pack(view->rect, block.rect);
    const enum pipeline which = frame->packed ? PIPELINE_PACKED_UPSAMPLE : PIPELINE_UPSAMPLE;
    /* Invocations of more than one row begin at rows of half resolution. */
    struct vkao_rect rows = view->rect;
    rows.y0 -= rows.y0 % pipeline_texels(frame->ctx, which).height;
    record_label_begin(frame, cmd, "vkao upsample");
    record_barrier(frame, cmd); /* blur y wrote half-resolution AO -> upsample reads it */
    record_dispatch(frame, cmd, which, pipeline_key(which, block.flags, NULL, params), &block,
                    sizeof block, rows);
    record_label_end(frame, cmd);
}
