/* SPDX-License-Identifier: MIT
 *
 * Recording: check everything, fill the constants, then pass after pass. */
#include "recording.h"

#include "cpu/cpu.h"
#include "formats.h"
#include "parameters.h"
#include "pipelines.h"
#include "stages.h"

#include <string.h>

/* Imports the view and reads it off. */
static vkao_result check_view(const vkao_frame *frame, const vkao_view *view,
                              struct view_constants *out)
{
    const struct vkao_logger *log = &frame->ctx->log;
    const struct vkao_program *program = frame->program;
    const vkao_effect_info *e = &program->settings;
    vkao_view known;
    vkao_result result = vkao_import(log, VKAO_STRUCT_VIEW, "view", view, &known);
    if (result != VKAO_SUCCESS)
        return result;
    *out = (struct view_constants){.unproject = {1.0f, 1.0f, 0.0f, 0.0f}};
    /* An effect that only composites needs no projection, unless it has specular light to
     * occlude. */
    if (!vkao_makes_ao(e) && !vkao_program_reads(program, VKAO_RESOURCE_SPECULAR))
        return vkao_view_rects(log, &known, frame->extent, &out->valid, &out->rect);
    result =
        vkao_view_constants_init(log, &known, e, frame->extent, frame->images.depth.format, out);
    if (result == VKAO_SUCCESS && e->half_resolution && ((out->valid.x0 | out->valid.y0) & 1u))
        result = vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT,
                             "view.valid begins at (%u,%u), want even texels at half resolution",
                             out->valid.x0, out->valid.y0);
    return result;
}

/* Images of scratch that begin with a pass, or where first is true those that nothing was before:
 * whatever they held is dropped. */
static uint32_t beginnings(const vkao_frame *frame, uint32_t pass, bool first,
                           VkImageMemoryBarrier out[VKAO_IMAGE_COUNT])
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < VKAO_IMAGE_COUNT; ++i) {
        const struct vkao_block *block = &frame->scratch.blocks[i];
        if (!frame->scratch.images[i].image ||
            (first ? block->follows : !block->follows || block->first != pass))
            continue;
        out[count++] = (VkImageMemoryBarrier){
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
    return count;
}

/* Waits for whatever vkao work on this queue used the scratch memory last, and writes the
 * constants. */
static void begin(const struct vkao_recording *r, vkao_stage_flags stages,
                  const struct vkao_constants *constants)
{
    const struct vk_table *vk = &r->frame->ctx->vk;
    const struct vkao_scratch *scratch = &r->frame->scratch;
    const VkPipelineStageFlags compute = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                               transfer = VK_PIPELINE_STAGE_TRANSFER_BIT;
    VkImageMemoryBarrier images[VKAO_IMAGE_COUNT];
    const uint32_t count = stages & VKAO_STAGE_PREPARE ? beginnings(r->frame, 0, true, images) : 0;
    const VkMemoryBarrier before = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
        .srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT,
        .dstAccessMask =
            VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT,
    };
    const VkMemoryBarrier after = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
        .srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
        .dstAccessMask = VK_ACCESS_UNIFORM_READ_BIT,
    };
    vk->CmdPipelineBarrier(r->cmd, compute, compute | transfer, 0, 1, &before, 0, NULL, count,
                           images);
    vk->CmdUpdateBuffer(r->cmd, scratch->buffer, scratch->blocks[VKAO_RESOURCE_CONSTANTS].offset,
                        sizeof *constants, constants);
    vk->CmdPipelineBarrier(r->cmd, transfer, compute, 0, 1, &after, 0, NULL, 0, NULL);
}

/* What earlier passes wrote is read, what they read is written. */
static void separate(const struct vkao_recording *r, uint32_t pass)
{
    const VkPipelineStageFlags compute = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT;
    VkImageMemoryBarrier images[VKAO_IMAGE_COUNT];
    const uint32_t count = beginnings(r->frame, pass, false, images);
    const VkMemoryBarrier memory = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
        .srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT,
        .dstAccessMask = VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT,
    };
    r->frame->ctx->vk.CmdPipelineBarrier(r->cmd, compute, compute, 0, 1, &memory, 0, NULL, count,
                                         images);
}

/* To debuggers, and to whoever asked the context for marks. */
static void label(const struct vkao_recording *r, const char *stage, bool begins)
{
    const vkao_context *ctx = r->frame->ctx;
    if (ctx->mark)
        ctx->mark(ctx->mark_user_data, r->cmd, stage, begins);
    if (begins && ctx->vk.CmdBeginDebugUtilsLabelEXT)
        ctx->vk.CmdBeginDebugUtilsLabelEXT(r->cmd,
                                           &(VkDebugUtilsLabelEXT){
                                               .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_LABEL_EXT,
                                               .pLabelName = stage,
                                           });
    else if (!begins && ctx->vk.CmdEndDebugUtilsLabelEXT)
        ctx->vk.CmdEndDebugUtilsLabelEXT(r->cmd);
}

static void record_pass(const struct vkao_recording *r, uint32_t pass)
{
    const struct vkao_pass *row = r->frame->program->steps[pass].row;
    if (row->record) {
        row->record(r, pass);
        return;
    }
    struct vkao_rect rect = vkao_area(r, row->area);
    struct vkao_dispatch push;
    vkao_rect_pack(rect, push.rect);
    if (row->area <= VKAO_AREA_VALID) { /* and the border, which begins before the first texel */
        const VkExtent2D extent =
            vkao_view_z_extent((VkExtent2D){rect.x1 - rect.x0, rect.y1 - rect.y0});
        rect = (struct vkao_rect){0, 0, extent.width, extent.height};
    }
    vkao_bind(r, pass, &push, sizeof push);
    vkao_dispatch(r, pass, rect);
}

static void record_passes(const struct vkao_recording *r, vkao_stage_flags stages)
{
    const struct vkao_program *program = r->frame->program;
    const char *open = NULL;
    bool first = true;
    for (uint32_t i = 0; i < program->count; ++i) {
        const struct vkao_pass *row = program->steps[i].row;
        if (!(row->stage & stages))
            continue;
        if (!open || strcmp(open, row->label) != 0) {
            if (open)
                label(r, open, false);
            label(r, row->label, true);
            open = row->label;
        }
        /* What runs first has waited in begin(). */
        if (!first || beginnings(r->frame, i, false, (VkImageMemoryBarrier[VKAO_IMAGE_COUNT]){0}))
            separate(r, i);
        record_pass(r, i);
        first = false;
    }
    if (open)
        label(r, open, false);
}

static vkao_result record(const vkao_frame *frame, VkCommandBuffer cmd, const char *call,
                          vkao_stage_flags stages, const vkao_view *view, const vkao_params *params)
{
    vkao_params known;
    struct vkao_recording r = {.frame = frame, .cmd = cmd};
    if (!frame)
        return VKAO_ERROR_INVALID_ARGUMENT;
    const vkao_effect_info *e = &frame->program->settings;
    const vkao_stage_flags has = vkao_stages_of(e);
    char asked[VKAO_NAME_BYTES], all[VKAO_NAME_BYTES];
    const struct {
        const char *name;
        const void *value;
    } given[] = {{"cmd", cmd}, {"view", view}, {"params", params}};
    for (size_t i = 0; i < sizeof given / sizeof given[0]; ++i) {
        const vkao_result result = vkao_want(&frame->ctx->log, call, given[i].name, given[i].value);
        if (result != VKAO_SUCCESS)
            return result;
    }
    if (!stages || (stages & ~has))
        return vkao_refuse(&frame->ctx->log, VKAO_ERROR_INVALID_ARGUMENT,
                           "%s: stages is %s, want bits of %s, which the effect has", call,
                           vkao_stages_name(stages, asked), vkao_stages_name(has, all));
    vkao_result result = check_view(frame, view, &r.image);
    if (result == VKAO_SUCCESS)
        result = vkao_params_check(&frame->ctx->log, params, &known);
    if (result != VKAO_SUCCESS)
        return result;

    struct vkao_constants constants = {.path = {frame->rows.stride, frame->rows.copied_stride}};
    r.grid = e->half_resolution ? vkao_view_halve(&r.image) : r.image;
    r.form = (known.intensity != 1.0f || known.power != 1.0f ? VKAO_FORM_TONED : 0u) |
             (frame->copies ? VKAO_FORM_COPIED : 0u);
#define COPY(name) constants.name = known.name
    VKAO_PLAIN_CONSTANTS(COPY, COPY)
#undef COPY
#define FILL(NAME, name) vkao_##name##_constants(&r, &known, &constants);
    VKAO_STAGES(FILL)
#undef FILL
    result = vkao_program_complete(frame->program, r.form);
    if (result != VKAO_SUCCESS)
        return result;
    begin(&r, stages, &constants);
    record_passes(&r, stages);
    return VKAO_SUCCESS;
}

vkao_result vkao_cmd_record(const vkao_frame *frame, VkCommandBuffer cmd, const vkao_view *view,
                            const vkao_params *params)
{
    vkao_stage_flags stages = 0;
    if (frame)
        stages = vkao_stages_of(&frame->program->settings);
    return record(frame, cmd, "vkao_cmd_record", stages, view, params);
}

vkao_result vkao_cmd_stage(const vkao_frame *frame, VkCommandBuffer cmd, vkao_stage_flags stages,
                           const vkao_view *view, const vkao_params *params)
{
    return record(frame, cmd, "vkao_cmd_stage", stages, view, params);
}
