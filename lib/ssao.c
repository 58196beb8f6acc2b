/* SPDX-License-Identifier: MIT */
#include "internal.h"

#include <string.h>

static_assert(sizeof(struct vkao_ssao_block) == 128, "as shaders/ssao.glsl lays it out");
static_assert(sizeof(struct vkao_ssao_block) <= VKAO_PUSH_BYTES, "push constants of every device");
static_assert(VKAO_GLSL_NORMALS_FROM_DEPTH == (int)VKAO_NORMALS_FROM_DEPTH &&
                  VKAO_GLSL_NORMALS_XYZ_SNORM == (int)VKAO_NORMALS_XYZ_SNORM &&
                  VKAO_GLSL_NORMALS_XYZ_UNORM == (int)VKAO_NORMALS_XYZ_UNORM &&
                  VKAO_GLSL_NORMALS_OCT_SNORM == (int)VKAO_NORMALS_OCT_SNORM &&
                  VKAO_GLSL_NORMALS_OCT_UNORM == (int)VKAO_NORMALS_OCT_UNORM,
              "params.h repeats public enums");

/* Whole workgroups. */
enum { STRIP_TEXELS = 5 * VKAO_ROW_GROUP_WIDTH * VKAO_SSAO_TEXELS };

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
        .flags = recording_flags(&grid, frame_flags(frame), params, NULL),
        .noise_index = params->noise_index,
        .counts = params->slice_count | params->step_count << 8 | params->sample_count << 20,
        .inverse_radius = 1.0f / params->radius,
        .bias_cosine = params->bias,
        .thickness_base = thickness * (float)VKAO_THICKNESS_BASE,
        .thickness_slope = thickness * (float)VKAO_THICKNESS_SLOPE,
        .stride = frame->scratch.buffer.stride,
    };
    block.inverse_unproject[0] = 1.0f / grid.unproject[0];
    block.inverse_unproject[1] = 1.0f / grid.unproject[1];
    memcpy(block.unproject, grid.unproject, sizeof block.unproject);
    copy_normal_rows(view, block.normal_x, block.normal_y, block.normal_z);
    rect_pack(grid.valid, block.valid);
    record_label_begin(frame, cmd, "vkao ssao");
    record_barrier(
        frame,
        cmd); /* prepare wrote view z; the last blur or composite may still read what we write */
    const enum pipeline which = (enum pipeline)(PIPELINE_SSAO + (int)params->method);
    const struct pipeline_key key = pipeline_key(which, block.flags, params, NULL);
    /* On a CPU one strip after the other, so that the texels within reach stay in its cache. */
    const uint32_t width = frame->ctx->buffers ? STRIP_TEXELS : rect.x1 - rect.x0;
    for (struct vkao_rect strip = rect; strip.x0 < rect.x1; strip.x0 = strip.x1) {
        strip.x1 = rect.x1 - strip.x0 > width ? strip.x0 + width : rect.x1;
        rect_pack(strip, block.rect);
        record_dispatch(frame, cmd, which, key, &block, sizeof block, strip);
    }
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
