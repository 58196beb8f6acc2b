/* SPDX-License-Identifier: MIT */
#include "internal.h"

#include <string.h>

static_assert(sizeof(struct vkao_ssao_block) == 128, "as shaders/ssao.glsl lays it out");
static_assert(sizeof(struct vkao_tiles_block) == 36, "as shaders/tiles.comp lays it out");
static_assert(sizeof(struct vkao_ssao_block) <= VKAO_PUSH_BYTES, "push constants of every device");
static_assert(VKAO_GLSL_NORMALS_FROM_DEPTH == (int)VKAO_NORMALS_FROM_DEPTH &&
                  VKAO_GLSL_NORMALS_XYZ_SNORM == (int)VKAO_NORMALS_XYZ_SNORM &&
                  VKAO_GLSL_NORMALS_XYZ_UNORM == (int)VKAO_NORMALS_XYZ_UNORM &&
                  VKAO_GLSL_NORMALS_OCT_SNORM == (int)VKAO_NORMALS_OCT_SNORM &&
                  VKAO_GLSL_NORMALS_OCT_UNORM == (int)VKAO_NORMALS_OCT_UNORM,
              "params.h repeats public enums");

/* Where SSAO has work to do, into the list that its dispatch reads. */
static void record_tiles(const vkao_frame *frame, VkCommandBuffer cmd, uint32_t flags,
                         struct vkao_rect rect, uint32_t tile_width)
{
    static_assert(VKAO_STRIP_TEXELS % (VKAO_ROW_GROUP_WIDTH * VKAO_SSAO_TEXELS) == 0,
                  "strips are of whole tiles");
    const struct vk_table *vk = &frame->ctx->vk;
    const struct scratch_buffer *buffer = &frame->scratch.buffer;
    const uint32_t x0 = rect.x0 - rect.x0 % 4, rows = rect.y1 - rect.y0,
                   columns = (rect.x1 - x0 + tile_width - 1) / tile_width;
    uint32_t height = VKAO_TILE_HEIGHT;
    /* maxComputeWorkGroupCount of an indirect dispatch's y, which is the count of tiles */
    while (columns * ((rows + height - 1) / height) > VKAO_MOST_TILES)
        height *= 2;
    struct vkao_tiles_block block = {
        .tiles = {columns, (rows + height - 1) / height},
        .flags = flags,
        .stride = buffer->stride,
        .tile_width = tile_width,
        .strip_columns = VKAO_STRIP_TEXELS / tile_width,
        .tile_height = height,
    };
    rect_pack(rect, block.rect);
    const struct vkao_rect tiles = {0, 0, block.tiles[0] * block.tiles[1], 1};
    const struct vkao_tiles_head none = {.group_rows = height, .one = 1};
    record_stages(frame, cmd, STAGES_COMPUTE, STAGES_TRANSFER);
    vk->CmdUpdateBuffer(cmd, buffer->buffer, buffer->parts[PART_TILES].offset, sizeof none, &none);
    record_stages(frame, cmd, STAGES_TRANSFER, STAGES_COMPUTE);
    record_dispatch(frame, cmd, PIPELINE_TILES, pipeline_key(PIPELINE_TILES, flags, NULL, NULL),
                    &block, sizeof block, tiles);
    record_stages(frame, cmd, STAGES_COMPUTE, STAGES_INDIRECT);
}

void record_ssao(const vkao_frame *frame, VkCommandBuffer cmd, const struct view_constants *view,
                 const vkao_ssao_params *params, uint32_t border)
{
    const struct view_constants grid = frame_grid(frame, view);
    const struct vkao_rect rect = rect_grow(grid.rect, border, border, grid.valid);
    const float thickness =
        params->thickness *
        (params->falloff == VKAO_FALLOFF_THRESHOLD ? (float)VKAO_THICKNESS_THRESHOLD : 1.0f);
    struct vkao_ssao_block block = {
        .normal_x[3] = params->radius,
        .normal_y[3] = params->bias * params->radius,
        .normal_z[3] = params->blocking_scale,
        .depth_error = {view->depth_error[0], view->depth_error[1]},
        .flags = recording_flags(&grid, frame_flags(frame), params, NULL),
        .noise_index = params->noise_index,
        .counts = params->slice_count | params->step_count << 8 | params->sample_count << 20,
        .inverse_radius = 1.0f / params->radius,
        .bias_cosine = params->bias,
        .thickness_base = thickness * (float)VKAO_THICKNESS_BASE,
        .thickness_slope = thickness * (float)VKAO_THICKNESS_SLOPE,
        .stride = frame->scratch.buffer.stride,
    };
    memcpy(block.inverse_unproject, grid.inverse_unproject, sizeof block.inverse_unproject);
    memcpy(block.unproject, grid.unproject, sizeof block.unproject);
    copy_normal_rows(view, block.normal_x, block.normal_y, block.normal_z);
    rect_pack(grid.valid, block.valid);
    rect_pack(rect, block.rect);
    record_label_begin(frame, cmd, "vkao ssao");
    const enum pipeline which = (enum pipeline)(PIPELINE_SSAO + (int)params->method);
    const struct pipeline_key key = pipeline_key(which, block.flags, params, NULL);
    /* prepare wrote view z; the last blur or composite may still read what we write */
    record_barrier(frame, cmd);
    if (frame->ctx->buffers)
        record_tiles(frame, cmd, block.flags, rect,
                     pipeline_texels(frame->ctx, which).width *
                         pipeline_group(frame->ctx, which).width);
    record_dispatch(frame, cmd, which, key, &block, sizeof block, rect);
    record_label_end(frame, cmd);
}

vkao_result vkao_cmd_ssao(const vkao_frame *frame, VkCommandBuffer cmd, const vkao_view *view,
                          const vkao_ssao_params *params)
{
    struct view_constants constants = {0};
    vkao_ssao_params known;
    vkao_result result =
        frame_view_check(frame, cmd, "vkao_cmd_ssao", VKAO_STAGE_SSAO, view, &constants);
    if (result == VKAO_SUCCESS)
        result = ssao_params_check(frame->ctx, &frame->ctx->log, frame_has_bent_normals(frame),
                                   params, &known);
    if (result == VKAO_SUCCESS)
        result = pipelines_check(frame, &constants, &known, NULL);
    if (result == VKAO_SUCCESS)
        record_ssao(frame, cmd, &constants, &known, 0);
    return result;
}
