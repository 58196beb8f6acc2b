/* SPDX-License-Identifier: MIT
 *
 * What the stages share when they record, and the whole line in one call. */
#include "internal.h"

#include <math.h>

vkao_result frame_view_check(const vkao_frame *frame, VkCommandBuffer cmd, const char *call,
                             vkao_stage_flags stages, const vkao_view *view,
                             struct view_constants *out)
{
    if (!frame)
        return VKAO_ERROR_INVALID_ARGUMENT;
    const struct vkao_logger *log = &frame->ctx->log;
    vkao_view known;
    if (!cmd)
        return vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT, "%s: cmd is NULL", call);
    if (!(frame->stages & stages))
        return vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT,
                           "%s: the frame was created with stages 0x%x, want 0x%x", call,
                           frame->stages, stages);
    vkao_result result = vkao_import(log, "view", view, &known, sizeof known);
    if (result != VKAO_SUCCESS)
        return result;
    if (known.normal_encoding != VKAO_NORMALS_FROM_DEPTH &&
        frame->images.normals.format == VK_FORMAT_UNDEFINED)
        return vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT,
                           "view.normal_encoding is %d, but the frame has no images.normals",
                           (int)known.normal_encoding);
    /* A frame that only composites needs no projection, unless it has specular light to occlude. */
    bool needs_projection = (frame->stages & (VKAO_STAGE_SSAO | VKAO_STAGE_BLUR)) ||
                            frame->images.specular.format != VK_FORMAT_UNDEFINED;
    if (!needs_projection)
        return view_rects(log, &known, frame->extent, &out->valid, &out->rect);
    result = view_constants_init(log, &known, frame->extent, frame->images.depth.format, out);
    if (result == VKAO_SUCCESS && frame->ctx->half_view_z)
        view_halve_precision(out);
    if (result == VKAO_SUCCESS && frame->half_resolution && ((out->valid.x0 | out->valid.y0) & 1u))
        result = vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT,
                             "view.valid begins at (%u,%u), want even texels at half resolution",
                             out->valid.x0, out->valid.y0);
    return result;
}

struct view_constants frame_grid(const vkao_frame *frame, const struct view_constants *view)
{
    return frame->half_resolution ? view_halve(view) : *view;
}

/* What to divide by so that the matrix makes unit vectors of unit vectors: 1 for what floats make of a rotation. */
static double normal_scale(const float rows[3][3])
{
    double largest = 0.0, sum = 0.0;
    for (int i = 0; i < 9; ++i)
        largest = fmax(largest, fabs((double)rows[i / 3][i % 3]));
    for (int i = 0; largest > 0.0 && i < 9; ++i)
        sum += pow((double)rows[i / 3][i % 3] / largest, 2.0);
    const double scale = sqrt(sum / 3.0) * largest;
    return fabs(scale - 1.0) < 1e-3 || !(scale > 0.0) ? 1.0 : scale;
}

void copy_normal_rows(const struct view_constants *view, float x[4], float y[4], float z[4])
{
    const double scale = normal_scale(view->normal_rows);
    for (int column = 0; column < 3; ++column) {
        x[column] = (float)((double)view->normal_rows[0][column] / scale);
        y[column] = (float)((double)view->normal_rows[1][column] / scale);
        z[column] = (float)((double)view->normal_rows[2][column] / scale);
    }
}

bool frame_has_bent_normals(const vkao_frame *frame)
{
    return (frame->stages & VKAO_STAGE_BLUR) &&
           frame->images.bent_normals.format != VK_FORMAT_UNDEFINED;
}

void record_dispatch(const vkao_frame *frame, VkCommandBuffer cmd, enum pipeline which,
                     struct pipeline_key key, const void *block, size_t block_bytes,
                     struct vkao_rect rect)
{
    const vkao_context *ctx = frame->ctx;
    ctx->vk.CmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_COMPUTE,
                            pipeline_find(ctx, which, frame_has_bent_normals(frame), key));
    ctx->vk.CmdBindDescriptorSets(cmd, VK_PIPELINE_BIND_POINT_COMPUTE, ctx->pipeline_layout, 0, 1,
                                  &frame->set, 0, NULL);
    ctx->vk.CmdPushConstants(cmd, ctx->pipeline_layout, VK_SHADER_STAGE_COMPUTE_BIT, 0,
                             (uint32_t)block_bytes, block);
    if (ctx->buffers && which >= PIPELINE_SSAO) {
        const struct scratch_buffer *buffer = &frame->scratch.buffer;
        ctx->vk.CmdDispatchIndirect(cmd, buffer->buffer, buffer->parts[PART_TILES].offset);
        return;
    }
    /* Invocations begin at multiples of their width, as words of a buffer do. */
    const VkExtent2D texels = pipeline_texels(ctx, which), group = pipeline_group(ctx, which);
    const uint32_t width = texels.width * group.width, height = texels.height * group.height;
    const uint32_t x0 = rect.x0 - rect.x0 % texels.width;
    ctx->vk.CmdDispatch(cmd, (rect.x1 - x0 + width - 1) / width,
                        (rect.y1 - rect.y0 + height - 1) / height, 1);
}

void record_stages(const vkao_frame *frame, VkCommandBuffer cmd, enum stages before,
                   enum stages after)
{
    static const struct {
        VkPipelineStageFlags stages;
        VkAccessFlags writes, all;
    } what[] = {
        [STAGES_COMPUTE] = {VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
                            VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT},
        [STAGES_TRANSFER] = {VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
                             VK_ACCESS_TRANSFER_READ_BIT | VK_ACCESS_TRANSFER_WRITE_BIT},
        [STAGES_INDIRECT] = {VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT |
                                 VK_PIPELINE_STAGE_DRAW_INDIRECT_BIT,
                             VK_ACCESS_SHADER_WRITE_BIT,
                             VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT |
                                 VK_ACCESS_INDIRECT_COMMAND_READ_BIT},
    };
    const VkMemoryBarrier barrier = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
        .srcAccessMask = what[before].writes,
        .dstAccessMask = what[after].all,
    };
    frame->ctx->vk.CmdPipelineBarrier(cmd, what[before].stages, what[after].stages, 0, 1, &barrier,
                                      0, NULL, 0, NULL);
}

void record_barrier(const vkao_frame *frame, VkCommandBuffer cmd)
{
    record_stages(frame, cmd, STAGES_COMPUTE, STAGES_COMPUTE);
}

void record_copy(const vkao_frame *frame, VkCommandBuffer cmd, struct vkao_rect strip)
{
    const struct scratch_buffer *buffer = &frame->scratch.buffer;
    const VkBufferImageCopy region = {
        .bufferOffset = buffer->parts[PART_STAGED].offset + strip.x0 * buffer->staged_texel,
        .bufferRowLength = buffer->staged_stride,
        .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, frame->images.ao_mip_level,
                             frame->images.ao_array_layer, 1},
        .imageOffset = {(int32_t)strip.x0, (int32_t)strip.y0, 0},
        .imageExtent = {strip.x1 - strip.x0, strip.y1 - strip.y0, 1},
    };
    record_stages(frame, cmd, STAGES_COMPUTE, STAGES_TRANSFER);
    frame->ctx->vk.CmdCopyBufferToImage(cmd, buffer->buffer, frame->images.ao_image,
                                        VK_IMAGE_LAYOUT_GENERAL, 1, &region);
    record_stages(frame, cmd, STAGES_TRANSFER, STAGES_COMPUTE);
}

void record_label_begin(const vkao_frame *frame, VkCommandBuffer cmd, const char *name)
{
    if (frame->ctx->vk.CmdBeginDebugUtilsLabelEXT)
        frame->ctx->vk.CmdBeginDebugUtilsLabelEXT(
            cmd, &(VkDebugUtilsLabelEXT){
                     .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_LABEL_EXT,
                     .pLabelName = name,
                 });
}

void record_label_end(const vkao_frame *frame, VkCommandBuffer cmd)
{
    if (frame->ctx->vk.CmdEndDebugUtilsLabelEXT)
        frame->ctx->vk.CmdEndDebugUtilsLabelEXT(cmd);
}

/* Params of absent stages must be NULL: whoever passes them believes in a stage that will not run. */
static vkao_result check_presence(const vkao_frame *frame, const void *ssao, const void *blur,
                                  const void *composite)
{
    const struct {
        const char *name;
        vkao_stage_flags stage;
        const void *params;
    } stages[] = {
        {"ssao", VKAO_STAGE_SSAO, ssao},
        {"blur", VKAO_STAGE_BLUR, blur},
        {"composite", VKAO_STAGE_COMPOSITE, composite},
    };
    for (size_t i = 0; i < sizeof stages / sizeof stages[0]; ++i) {
        if (stages[i].params && !(frame->stages & stages[i].stage))
            return vkao_refuse(&frame->ctx->log, VKAO_ERROR_INVALID_ARGUMENT,
                               "vkao_cmd_all: %s is not NULL, but the frame has no such stage",
                               stages[i].name);
    }
    return VKAO_SUCCESS;
}

vkao_result vkao_cmd_all(const vkao_frame *frame, VkCommandBuffer cmd, const vkao_view *view,
                         const vkao_ssao_params *ssao, const vkao_blur_params *blur,
                         const vkao_composite_params *composite)
{
    struct view_constants constants = {0};
    vkao_ssao_params ssao_known;
    vkao_blur_params blur_known = {0};
    vkao_composite_params composite_known;
    vkao_result result =
        frame_view_check(frame, cmd, "vkao_cmd_all", VKAO_STAGE_ALL, view, &constants);
    if (result == VKAO_SUCCESS)
        result = check_presence(frame, ssao, blur, composite);
    if (result == VKAO_SUCCESS && (frame->stages & VKAO_STAGE_SSAO))
        result = ssao_params_check(frame->ctx, &frame->ctx->log, frame_has_bent_normals(frame),
                                   ssao, &ssao_known);
    if (result == VKAO_SUCCESS && (frame->stages & VKAO_STAGE_BLUR))
        result = blur_params_check(&frame->ctx->log, blur, &blur_known);
    if (result == VKAO_SUCCESS && (frame->stages & VKAO_STAGE_COMPOSITE))
        result = composite_params_check(frame, composite, &composite_known);
    if (result == VKAO_SUCCESS && (frame->stages & (VKAO_STAGE_SSAO | VKAO_STAGE_BLUR)))
        result =
            pipelines_check(frame, &constants, frame->stages & VKAO_STAGE_SSAO ? &ssao_known : NULL,
                            frame->stages & VKAO_STAGE_BLUR ? &blur_known : NULL);
    if (result != VKAO_SUCCESS)
        return result;

    if (frame->stages & (VKAO_STAGE_SSAO | VKAO_STAGE_BLUR))
        record_prepare(frame, cmd, &constants);
    if (frame->stages & VKAO_STAGE_SSAO)
        record_ssao(frame, cmd, &constants, &ssao_known, blur_known.radius);
    if (frame->stages & VKAO_STAGE_BLUR)
        record_blur(frame, cmd, &constants, &blur_known);
    if (frame->stages & VKAO_STAGE_COMPOSITE)
        record_composite(frame, cmd, &constants, &composite_known);
    return VKAO_SUCCESS;
}
