/* SPDX-License-Identifier: MIT */
#include "internal.h"

#include <string.h>

static_assert(sizeof(struct vkao_ssao_block) == 124, "as shaders/ssao.glsl lays it out");
static_assert(sizeof(struct vkao_ssao_block) <= VKAO_PUSH_BYTES, "push constants of every device");
static_assert(VKAO_GLSL_NORMALS_FROM_DEPTH == (int)VKAO_NORMALS_FROM_DEPTH &&
                  VKAO_GLSL_NORMALS_XYZ_SNORM == (int)VKAO_NORMALS_XYZ_SNORM &&
                  VKAO_GLSL_NORMALS_XYZ_UNORM == (int)VKAO_NORMALS_XYZ_UNORM &&
                  VKAO_GLSL_NORMALS_OCT_SNORM == (int)VKAO_NORMALS_OCT_SNORM &&
                  VKAO_GLSL_NORMALS_OCT_UNORM == (int)VKAO_NORMALS_OCT_UNORM,
              "params.h repeats public enums");

void record_ssao(const vkao_frame *frame, VkCommandBuffer cmd, const struct view_constants *view,
                 const vkao_ssao_params *params, uint32_t border)
{
    const struct view_constants grid = frame_grid(frame, view);
    const struct vkao_rect rect = rect_grow(grid.rect, border, border, grid.valid);
    const float thickness = params->thickness;
    struct vkao_ssao_block block = {
        .normal_x[3] = params->radius,
        .normal_y[3] = params->bias * params->radius,
        .normal_z[3] = params->blocking_scale,
        .depth_error = {view->depth_error[0], view->depth_error[1]},
        .flags = recording_flags(&grid, frame->packed, params, NULL),
        .sample_count = params->sample_count,
        .noise_index = params->noise_index,
        .slices_and_steps = params->slice_count | params->step_count << 16,
        .inverse_radius2 = 1.0f / (params->radius * params->radius),
        .bias_cosine = params->bias,
        .thickness_base = thickness * (float)VKAO_THICKNESS_BASE * params->radius,
        .thickness_slope = thickness * (float)VKAO_THICKNESS_SLOPE,
        .stride = frame->scratch.buffer.stride,
    };
    memcpy(block.unproject, grid.unproject, sizeof block.unproject);
    copy_normal_rows(view, block.normal_x, block.normal_y, block.normal_z);
    rect_pack(grid.valid, block.valid);
    rect_pack(rect, block.rect);
    record_label_begin(frame, cmd, "vkao ssao");
    record_barrier(
        frame,
        cmd); /* prepare wrote view z; the last blur or composite may still read what we write */
    const enum pipeline which = (enum pipeline)(PIPELINE_SSAO + (int)params->method);
    record_dispatch(frame, cmd, which, pipeline_key(which, block.flags, params, NULL), &block,
                    sizeof block, rect);
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
        result = ssao_params_check(frame->ctx, frame_has_bent_normals(frame), params, &known);
    if (result == VKAO_SUCCESS)
        record_ssao(frame, cmd, &constants, &known, 0);
    return result;
}
