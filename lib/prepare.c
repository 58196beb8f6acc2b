/* SPDX-License-Identifier: MIT */
#include "internal.h"

#include <math.h>
#include <string.h>

static_assert(sizeof(struct vkao_prepare_block) == 44, "as shaders/prepare.comp lays it out");
static_assert(VKAO_GLSL_DEPTH_PROJECTED == (int)VKAO_DEPTH_PROJECTED &&
                  VKAO_GLSL_DEPTH_VIEW_Z == (int)VKAO_DEPTH_VIEW_Z &&
                  VKAO_GLSL_DEPTH_DISTANCE == (int)VKAO_DEPTH_DISTANCE &&
                  VKAO_GLSL_DEPTH_INVERSE_Z == (int)VKAO_DEPTH_INVERSE_Z,
              "params.h repeats vkao_depth_encoding");

/* Scratch may be shared with other frames or hold anything: its images begin anew, and wait for whatever vkao work on
 * this queue used the memory last. */
static void begin_scratch(const vkao_frame *frame, VkCommandBuffer cmd)
{
    VkImageMemoryBarrier barriers[SCRATCH_COUNT];
    uint32_t count = 0;
    for (int i = 0; i < SCRATCH_COUNT; ++i) {
        if (!frame->scratch.images[i].image)
            continue;
        barriers[count++] = (VkImageMemoryBarrier){
            .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
            .srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT,
            .dstAccessMask = VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT,
            .oldLayout = VK_IMAGE_LAYOUT_UNDEFINED,
            .newLayout = VK_IMAGE_LAYOUT_GENERAL,
            .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
            .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
            .image = frame->scratch.images[i].image,
            .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1},
        };
    }
    /* The memory barrier covers other images in the same memory, which the image barriers do not name. */
    const VkMemoryBarrier memory = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
        .srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT,
        .dstAccessMask = VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT,
    };
    frame->ctx->vk.CmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                                      VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, 0, 1, &memory, 0, NULL,
                                      count, barriers);
}

/* As many texels as prepare writes, border and padding included, moved to begin at 0. */
static struct vkao_rect bordered(const vkao_frame *frame, struct vkao_rect valid)
{
    if (!frame->ctx->buffers)
        return (struct vkao_rect){0, 0, valid.x1 - valid.x0 + 2 * VKAO_VIEW_Z_BORDER,
                                  valid.y1 - valid.y0 + 2 * VKAO_VIEW_Z_BORDER};
    return (struct vkao_rect){
        0, 0, valid.x1 - valid.x0 + valid.x0 % VKAO_BLUR_X_WIDTH + 2 * VKAO_BUFFER_PAD,
        valid.y1 - valid.y0 + 2 * VKAO_VIEW_Z_BORDER};
}

void record_prepare(const vkao_frame *frame, VkCommandBuffer cmd, const struct view_constants *view)
{
    const struct view_constants grid = frame_grid(frame, view);
    struct vkao_prepare_block block = {
        .linearize = {view->linearize[0], view->linearize[1]},
        .far_z = fminf(view->far_z, (float)VKAO_FARTHEST_Z),
        .flags = recording_flags(&grid, 0, NULL, NULL),
        .stride = frame->scratch.buffer.stride,
    };
    memcpy(block.unproject, view->unproject,
           sizeof block.unproject); /* of the image: prepare reads it there */
    rect_pack(grid.valid, block.valid);
    record_label_begin(frame, cmd, "vkao prepare");
    begin_scratch(frame, cmd);
    record_dispatch(frame, cmd, PIPELINE_PREPARE,
                    pipeline_key(PIPELINE_PREPARE, block.flags, NULL, NULL), &block, sizeof block,
                    bordered(frame, grid.valid));
    record_label_end(frame, cmd);
}

vkao_result vkao_cmd_prepare(const vkao_frame *frame, VkCommandBuffer cmd, const vkao_view *view)
{
    struct view_constants constants = {0};
    vkao_result result = frame_view_check(frame, cmd, "vkao_cmd_prepare",
                                          VKAO_STAGE_SSAO | VKAO_STAGE_BLUR, view, &constants);
    if (result == VKAO_SUCCESS)
        result = pipelines_check(frame, &constants, NULL, NULL);
    if (result == VKAO_SUCCESS)
        record_prepare(frame, cmd, &constants);
    return result;
}
