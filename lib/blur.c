/* SPDX-License-Identifier: MIT */
#include "internal.h"

static_assert(sizeof(struct vkao_blur_block) == 104, "as shaders/blur.comp lays it out");

static void record_direction(const vkao_frame *frame, VkCommandBuffer cmd, enum pipeline which,
                             const vkao_blur_params *params, struct vkao_blur_block *block,
                             struct vkao_rect rect)
{
    rect_pack(rect, block->rect);
    /* What ssao or the other direction wrote is read, what an earlier one read is written. */
    record_barrier(frame, cmd);
    record_dispatch(frame, cmd, which, pipeline_key(which, block->flags, NULL, params), block,
                    sizeof *block, rect);
}

static void record_whole(const vkao_frame *frame, VkCommandBuffer cmd,
                         const struct view_constants *grid, const vkao_blur_params *params,
                         struct vkao_blur_block *block)
{
    /* The vertical direction reads the horizontal one's result above and below the rect. */
    const struct vkao_rect halfway = rect_grow(grid->rect, 0, params->radius, grid->valid);
    record_direction(frame, cmd, PIPELINE_BLUR_X, params, block, halfway);
    record_direction(frame, cmd, PIPELINE_BLUR_Y, params, block, grid->rect);
}

/* Down the image in strips, so that what lies between the directions fits a ring of rows. Each strip adds the rows that
 * the one before did not need. */
static void record_strips(const vkao_frame *frame, VkCommandBuffer cmd,
                          const struct view_constants *grid, const vkao_blur_params *params,
                          struct vkao_blur_block *block)
{
    static_assert(VKAO_STRIP_ROWS % VKAO_BLUR_Y_HEIGHT == 0 &&
                      VKAO_RING_ROWS >= VKAO_STRIP_ROWS + 2 * VKAO_BUFFER_PAD,
                  "a ring holds a strip and the largest radius around it");
    const uint32_t ring = VKAO_RING_ROWS;
    struct vkao_rect halfway = rect_grow(grid->rect, 0, params->radius, grid->valid),
                     strip = grid->rect;
    const uint32_t last = halfway.y1;
    for (; strip.y0 < grid->rect.y1; strip.y0 = strip.y1) {
        const uint32_t left = grid->rect.y1 - strip.y0;
        strip.y1 = strip.y0 + (left < VKAO_STRIP_ROWS ? left : VKAO_STRIP_ROWS);
        halfway.y1 = strip.y1 + params->radius < last ? strip.y1 + params->radius : last;
        /* Not below the first row that the strip reads, which may lie before row 0. */
        block->ring_row = (strip.y0 + ring - params->radius) / ring * ring - ring;
        record_direction(frame, cmd, PIPELINE_PACKED_BLUR_X, params, block, halfway);
        record_direction(frame, cmd, PIPELINE_PACKED_BLUR_Y, params, block, strip);
        if (frame->staged && !frame->half_resolution)
            record_copy(frame, cmd, strip);
        halfway.y0 = halfway.y1;
    }
}

void record_blur(const vkao_frame *frame, VkCommandBuffer cmd, const struct view_constants *view,
                 const vkao_blur_params *params)
{
    const struct view_constants grid = frame_grid(frame, view);
    struct vkao_blur_block block = {
        .radius = params->radius,
        .sharpness = params->sharpness,
        .normal_power = params->normal_power,
        .flags = recording_flags(&grid, frame_flags(frame), NULL, params),
        .stride = frame->scratch.buffer.stride,
        .staged_stride = frame->scratch.buffer.staged_stride,
        .intensity = params->intensity,
        .power = params->power,
        .reference_z = view->reference_z,
    };
    copy_normal_rows(view, block.normal_x, block.normal_y, block.normal_z);
    rect_pack(grid.valid, block.valid);
    record_label_begin(frame, cmd, "vkao blur");
    if (frame->packed)
        record_strips(frame, cmd, &grid, params, &block);
    else
        record_whole(frame, cmd, &grid, params, &block);
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
        result = pipelines_check(frame, &constants, NULL, &known);
    if (result == VKAO_SUCCESS)
        record_blur(frame, cmd, &constants, &known);
    return result;
}
