/* SPDX-License-Identifier: MIT */
#include "internal.h"

#include <math.h>
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
        .far_z = fminf(view->far_z, (float)VKAO_FARTHEST_Z),
        .intensity = params->intensity,
        .power = params->power,
        .flags = recording_flags(view, frame_flags(frame), NULL, params),
        .stride = frame->scratch.buffer.stride,
        .staged_stride = frame->scratch.buffer.staged_stride,
    };
    memcpy(block.unproject, view->unproject, sizeof block.unproject);
    copy_normal_rows(view, block.normal_x, block.normal_y, block.normal_z);
    rect_pack(grid.valid, block.valid);
    rect_pack(view->valid, block.full_valid);
    const enum pipeline which = frame->packed ? PIPELINE_PACKED_UPSAMPLE : PIPELINE_UPSAMPLE;
    const uint32_t height = frame->staged ? VKAO_STRIP_ROWS : view->rect.y1 - view->rect.y0;
    record_label_begin(frame, cmd, "vkao upsample");
    record_barrier(frame, cmd); /* blur y wrote half-resolution AO -> upsample reads it */
    for (struct vkao_rect strip = view->rect; strip.y0 < view->rect.y1; strip.y0 = strip.y1) {
        strip.y1 = view->rect.y1 - strip.y0 > height ? strip.y0 + height : view->rect.y1;
        rect_pack(strip, block.rect);
        /* Invocations of more than one row begin at rows of half resolution. */
        struct vkao_rect rows = strip;
        rows.y0 -= rows.y0 % pipeline_texels(frame->ctx, which).height;
        record_dispatch(frame, cmd, which, pipeline_key(which, block.flags, NULL, params), &block,
                        sizeof block, rows);
        if (frame->staged)
            record_copy(frame, cmd, strip);
    }
    record_label_end(frame, cmd);
}
