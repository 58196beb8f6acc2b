/* SPDX-License-Identifier: MIT */
#include "frame.h"

#include "cpu/cpu.h"
#include "formats.h"
#include "parameters.h"
#include "pipelines.h"
#include "slots.h"
#include "stages.h"

/* --- Scratch --- */

/* Half precision is plenty for AO on its way to the blur; storing to it is optional in Vulkan. */
static VkFormat ao_scratch_format(const vkao_context *ctx)
{
    return vkao_scratch_can(ctx, VK_FORMAT_R16_SFLOAT) ? VK_FORMAT_R16_SFLOAT
                                                       : VK_FORMAT_R32_SFLOAT;
}

static VkExtent2D grid_of(const vkao_frame *frame)
{
    const uint32_t shift = frame->program->settings.half_resolution;
    return (VkExtent2D){(frame->extent.width + shift) >> shift,
                        (frame->extent.height + shift) >> shift};
}

/* AO that COMPOSITE reads has the image's resolution, all else that of the grid. */
static void plan_images(const vkao_frame *frame, struct vkao_scratch_plan *plan)
{
    const struct vkao_program *program = frame->program;
    const VkFormat ao = ao_scratch_format(frame->ctx),
                   blurred = program->settings.bent_normals ? VK_FORMAT_R16G16B16A16_SFLOAT : ao;
    const VkExtent2D grid = grid_of(frame), view_z = vkao_view_z_extent(grid);
    const uint32_t halfway_rows =
        program->is_cpu ? vkao_cpu_halfway_rows(grid.height) : grid.height;
    const struct {
        enum vkao_resource resource;
        VkFormat format;
        VkExtent2D extent;
    } rows[] = {
        {VKAO_RESOURCE_AO_NOISY, ao, grid},
        {VKAO_RESOURCE_CODES, VKAO_CODES_FORMAT, grid},
        {VKAO_RESOURCE_BENT_CODES, VKAO_BENT_CODES_FORMAT, grid},
        {VKAO_RESOURCE_AO, ao, frame->extent},
        {VKAO_RESOURCE_VIEW_Z, VK_FORMAT_R32_SFLOAT, view_z},
        {VKAO_RESOURCE_SECOND_Z, VK_FORMAT_R32_SFLOAT, view_z},
        {VKAO_RESOURCE_HALFWAY, blurred, {grid.width, halfway_rows}},
        {VKAO_RESOURCE_BLURRED, blurred, grid},
        {VKAO_RESOURCE_BREAKS_X, VK_FORMAT_R32G32_UINT, {(grid.width + 31) / 32, grid.height}},
        {VKAO_RESOURCE_BREAKS_Y, VK_FORMAT_R32G32_UINT, {grid.width, (grid.height + 31) / 32}},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; ++i) {
        const enum vkao_resource r = rows[i].resource;
        if (!vkao_program_writes(program, r) ||
            (r < VKAO_SLOT_COUNT && vkao_slot_image(&frame->images, r)->format))
            continue;
        plan->images[r].format = rows[i].format;
        plan->images[r].extent = rows[i].extent;
    }
}

static vkao_result create_scratch(vkao_frame *frame, VkMemoryRequirements *out)
{
    struct vkao_scratch_plan plan = {0};
    /* Uniform blocks are multiples of 16 bytes. */
    plan.parts[VKAO_RESOURCE_CONSTANTS] = (sizeof(struct vkao_constants) + 15) / 16 * 16;
    plan_images(frame, &plan);
    if (frame->program->is_cpu)
        vkao_cpu_parts(frame->program, frame->extent, frame->copies, &frame->rows, plan.parts);
    return vkao_scratch_create(frame->program, &plan, &frame->scratch, out);
}

static vkao_result bind_scratch(vkao_frame *frame, const vkao_frame_info *info,
                                const VkMemoryRequirements *need)
{
    const vkao_context *ctx = frame->ctx;
    if (!info->scratch_memory && info->scratch_offset)
        return vkao_refuse(&ctx->log, VKAO_ERROR_INVALID_ARGUMENT,
                           "frame.scratch_offset is %llu, want 0 without scratch_memory",
                           (unsigned long long)info->scratch_offset);
    if (info->scratch_memory) {
        if (info->scratch_offset % need->alignment)
            return vkao_refuse(&ctx->log, VKAO_ERROR_INVALID_ARGUMENT,
                               "frame.scratch_offset is %llu, want a multiple of %llu",
                               (unsigned long long)info->scratch_offset,
                               (unsigned long long)need->alignment);
        return vkao_scratch_bind(frame->program, &frame->scratch, info->scratch_memory,
                                 info->scratch_offset);
    }
    uint32_t type = vkao_memory_type(&ctx->memory, need->memoryTypeBits);
    if (type == UINT32_MAX)
        return vkao_refuse(&ctx->log, VKAO_ERROR_UNSUPPORTED,
                           "no DEVICE_LOCAL memory type among 0x%x", need->memoryTypeBits);
    VkResult allocated = ctx->vk.AllocateMemory(ctx->device,
                                                &(VkMemoryAllocateInfo){
                                                    .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                                    .allocationSize = need->size,
                                                    .memoryTypeIndex = type,
                                                },
                                                ctx->allocator, &frame->memory);
    if (allocated != VK_SUCCESS) {
        frame->memory = VK_NULL_HANDLE;
        return vkao_vk_failed(&ctx->log, "vkAllocateMemory", allocated);
    }
    vkao_log(&ctx->log, VKAO_LOG_INFO, "frame %ux%u: %llu bytes of scratch", frame->extent.width,
             frame->extent.height, (unsigned long long)need->size);
    return vkao_scratch_bind(frame->program, &frame->scratch, frame->memory, 0);
}

/* --- Descriptors --- */

/* For what a shader names but does not touch: some other image of the same kind. It has to be in
 * its layout when the pass runs, as are those that the pass writes. */
static enum vkao_resource stand_in(const struct vkao_program *program, const struct vkao_step *step,
                                   const struct vkao_use *use)
{
    if (!use->writes)
        return vkao_makes_ao(&program->settings) ? VKAO_RESOURCE_DEPTH : VKAO_RESOURCE_AO;
    for (uint32_t k = 0; k < step->use_count; ++k) {
        const struct vkao_use *other = &step->uses[k];
        if (other->writes && other->resource < VKAO_IMAGE_COUNT &&
            vkao_use_is_touched(program, other))
            return other->resource;
    }
    return VKAO_RESOURCE_AO;
}

/* What a use is of this frame: the caller's image or scratch. */
static vkao_image resolve(const vkao_frame *frame, const struct vkao_step *step,
                          const struct vkao_use *use)
{
    const struct vkao_program *program = frame->program;
    enum vkao_resource r = use->resource;
    if (!vkao_use_is_touched(program, use))
        r = stand_in(program, step, use);
    if (r < VKAO_SLOT_COUNT && vkao_slot_image(&frame->images, r)->format)
        return *vkao_slot_image(&frame->images, r);
    return (vkao_image){.view = frame->scratch.images[r].view, .layout = VK_IMAGE_LAYOUT_GENERAL};
}

static void write_set(const vkao_frame *frame, uint32_t i)
{
    const vkao_context *ctx = frame->ctx;
    const struct vkao_step *step = &frame->program->steps[i];
    const struct vkao_scratch *scratch = &frame->scratch;
    static const struct vkao_use constants = {VKAO_BINDING_CONSTANTS, VKAO_RESOURCE_CONSTANTS,
                                              false, VK_FORMAT_UNDEFINED};
    VkDescriptorImageInfo images[VKAO_MOST_USES + 1];
    VkDescriptorBufferInfo buffers[VKAO_MOST_USES + 1];
    VkWriteDescriptorSet writes[VKAO_MOST_USES + 1];
    uint32_t count = 0;
    for (uint32_t k = 0; k <= step->use_count; ++k) {
        const struct vkao_use *use = k < step->use_count ? &step->uses[k] : &constants;
        const VkDescriptorType type = vkao_use_type(use);
        if (type == VK_DESCRIPTOR_TYPE_SAMPLER)
            continue; /* the layout has it */
        writes[count] = (VkWriteDescriptorSet){
            .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
            .dstSet = frame->sets[i],
            .dstBinding = use->binding,
            .descriptorCount = 1,
            .descriptorType = type,
        };
        if (type == VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER) {
            writes[count].pTexelBufferView = &scratch->views[i][k];
        } else if (use->resource >= VKAO_IMAGE_COUNT) {
            const struct vkao_block *part = &scratch->blocks[use->resource];
            buffers[k] = (VkDescriptorBufferInfo){scratch->buffer, part->offset, part->size};
            writes[count].pBufferInfo = &buffers[k];
        } else {
            const vkao_image image = resolve(frame, step, use);
            images[k] =
                (VkDescriptorImageInfo){.imageView = image.view, .imageLayout = image.layout};
            writes[count].pImageInfo = &images[k];
        }
        ++count;
    }
    ctx->vk.UpdateDescriptorSets(ctx->device, count, writes, 0, NULL);
}

static void write_sets(const vkao_frame *frame)
{
    for (uint32_t i = 0; i < frame->program->count; ++i)
        write_set(frame, i);
}

static vkao_result create_sets(vkao_frame *frame)
{
    static const VkDescriptorType types[] = {
        VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER,       VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE,
        VK_DESCRIPTOR_TYPE_STORAGE_IMAGE,        VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
        VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER, VK_DESCRIPTOR_TYPE_SAMPLER};
    enum { TYPES = sizeof types / sizeof types[0] };
    const vkao_context *ctx = frame->ctx;
    const struct vkao_program *program = frame->program;
    VkDescriptorSetLayout layouts[VKAO_MOST_PASSES];
    uint32_t counts[TYPES] = {program->count};
    for (uint32_t i = 0; i < program->count; ++i) {
        const struct vkao_step *step = &program->steps[i];
        layouts[i] = step->pipelines->set_layout;
        for (uint32_t k = 0; k < step->use_count; ++k) {
            for (int t = 0; t < TYPES; ++t)
                counts[t] += vkao_use_type(&step->uses[k]) == types[t];
        }
    }
    VkDescriptorPoolSize sizes[TYPES];
    uint32_t size_count = 0;
    for (int t = 0; t < TYPES; ++t) {
        if (counts[t])
            sizes[size_count++] = (VkDescriptorPoolSize){types[t], counts[t]};
    }
    VkResult result =
        ctx->vk.CreateDescriptorPool(ctx->device,
                                     &(VkDescriptorPoolCreateInfo){
                                         .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                         .maxSets = program->count,
                                         .poolSizeCount = size_count,
                                         .pPoolSizes = sizes,
                                     },
                                     ctx->allocator, &frame->pool);
    if (result != VK_SUCCESS) {
        frame->pool = VK_NULL_HANDLE;
        return vkao_vk_failed(&ctx->log, "vkCreateDescriptorPool", result);
    }
    result =
        ctx->vk.AllocateDescriptorSets(ctx->device,
                                       &(VkDescriptorSetAllocateInfo){
                                           .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                           .descriptorPool = frame->pool,
                                           .descriptorSetCount = program->count,
                                           .pSetLayouts = layouts,
                                       },
                                       frame->sets);
    if (result != VK_SUCCESS)
        return vkao_vk_failed(&ctx->log, "vkAllocateDescriptorSets", result);
    write_sets(frame);
    return VKAO_SUCCESS;
}

/* --- Frames --- */

/* Checks the info and fills the frame's description, without creating anything. `own`: where to
 * plan the passes that use images, for frames that the CPU's cannot hold. */
static vkao_result describe(const vkao_effect *effect, const vkao_frame_info *caller_info,
                            bool need_views, vkao_frame_info *info, struct vkao_program *own,
                            vkao_frame *frame)
{
    struct vkao_program *program = effect->passes;
    const vkao_context *ctx = program->ctx;
    vkao_result result = vkao_import(&ctx->log, VKAO_STRUCT_FRAME_INFO, "frame", caller_info, info);
    if (result == VKAO_SUCCESS)
        result = vkao_import(&ctx->log, VKAO_STRUCT_IMAGES, "frame.images", info->images,
                             &frame->images);
    if (result != VKAO_SUCCESS)
        return result;
    if (info->padding)
        return vkao_refuse(&ctx->log, VKAO_ERROR_INVALID_ARGUMENT, "frame.padding is %u, want 0",
                           info->padding);
    if (!info->extent.width || !info->extent.height)
        return vkao_refuse(&ctx->log, VKAO_ERROR_INVALID_ARGUMENT,
                           "frame.extent is %ux%u, want at least 1x1", info->extent.width,
                           info->extent.height);
    if (info->extent.width > ctx->max_dimension || info->extent.height > ctx->max_dimension)
        return vkao_refuse(&ctx->log, VKAO_ERROR_UNSUPPORTED,
                           "frame.extent is %ux%u, the limit is %u", info->extent.width,
                           info->extent.height, ctx->max_dimension);
    frame->ctx = ctx;
    frame->effect = effect;
    frame->extent = info->extent;
    frame->program = program;
    if (program->is_cpu && !vkao_cpu_fits(program, info->extent)) {
        vkao_program_plan(own, ctx, &program->settings, false);
        frame->program = own;
    }
    const VkExtent2D view_z = vkao_view_z_extent(grid_of(frame));
    if (!frame->program->is_cpu && vkao_makes_ao(&program->settings) &&
        (view_z.width > ctx->max_image || view_z.height > ctx->max_image))
        return vkao_refuse(&ctx->log, VKAO_ERROR_UNSUPPORTED,
                           "frame.extent is %ux%u, for which view z takes %ux%u; the limit is %u",
                           info->extent.width, info->extent.height, view_z.width, view_z.height,
                           ctx->max_image);
    frame->copies = frame->program->is_packed && frame->images.ao.image;
    return vkao_slots_check(frame->program, &frame->images, need_views);
}

vkao_result vkao_frame_scratch(const vkao_effect *effect, const vkao_frame_info *info,
                               VkMemoryRequirements *out)
{
    if (!effect)
        return VKAO_ERROR_INVALID_ARGUMENT;
    const vkao_context *ctx = effect->program.ctx;
    vkao_frame frame = {0};
    vkao_frame_info known;
    struct vkao_program own;
    vkao_result result = vkao_want(&ctx->log, "vkao_frame_scratch", "out", out);
    if (result == VKAO_SUCCESS)
        result = vkao_want(&ctx->log, "vkao_frame_scratch", "info", info);
    if (result == VKAO_SUCCESS)
        result = describe(effect, info, false, &known, &own, &frame);
    if (result != VKAO_SUCCESS)
        return result;
    VkMemoryRequirements requirements;
    result = create_scratch(&frame, &requirements);
    vkao_scratch_destroy(ctx, &frame.scratch);
    if (result == VKAO_SUCCESS)
        *out = requirements;
    return result;
}

/* Passes that use images, for this frame alone. */
static vkao_result compile_own(vkao_frame *frame, const struct vkao_program *own)
{
    frame->own = vkao_calloc(frame->ctx->allocator, sizeof *frame->own);
    if (!frame->own)
        return vkao_refuse(&frame->ctx->log, VKAO_ERROR_OUT_OF_HOST_MEMORY,
                           "no host memory for the frame");
    *frame->own = *own;
    frame->program = frame->own;
    return vkao_program_compile(frame->own);
}

vkao_result vkao_frame_create(const vkao_effect *effect, const vkao_frame_info *caller_info,
                              vkao_frame **out)
{
    if (out)
        *out = NULL;
    if (!effect)
        return VKAO_ERROR_INVALID_ARGUMENT;
    const vkao_context *ctx = effect->program.ctx;
    vkao_frame described = {0};
    vkao_frame_info info;
    struct vkao_program own;
    vkao_result result = vkao_want(&ctx->log, "vkao_frame_create", "out", out);
    if (result == VKAO_SUCCESS)
        result = vkao_want(&ctx->log, "vkao_frame_create", "info", caller_info);
    if (result == VKAO_SUCCESS)
        result = describe(effect, caller_info, true, &info, &own, &described);
    if (result != VKAO_SUCCESS)
        return result;
    vkao_slots_warn(described.program, &described.images);
    vkao_frame *frame = vkao_calloc(ctx->allocator, sizeof *frame);
    if (!frame)
        return vkao_refuse(&ctx->log, VKAO_ERROR_OUT_OF_HOST_MEMORY,
                           "no host memory for the frame");
    *frame = described;
    atomic_fetch_add(ctx->live, 1);
    atomic_fetch_add(effect->frames, 1);
    VkMemoryRequirements need;
    if (frame->program == &own)
        result = compile_own(frame, &own);
    else
        result = vkao_program_complete(effect->passes, frame->copies ? VKAO_FORM_COPIED : 0);
    if (result == VKAO_SUCCESS)
        result = create_scratch(frame, &need);
    if (result == VKAO_SUCCESS)
        result = bind_scratch(frame, &info, &need);
    if (result == VKAO_SUCCESS)
        result = create_sets(frame);
    if (result != VKAO_SUCCESS) {
        vkao_frame_destroy(frame);
        return result;
    }
    *out = frame;
    return VKAO_SUCCESS;
}

vkao_result vkao_frame_update(vkao_frame *frame, const vkao_images *images)
{
    if (!frame)
        return VKAO_ERROR_INVALID_ARGUMENT;
    vkao_images known;
    char now[VKAO_NAME_BYTES], then[VKAO_NAME_BYTES];
    const vkao_context *ctx = frame->ctx;
    vkao_result result = vkao_want(&ctx->log, "vkao_frame_update", "images", images);
    if (result == VKAO_SUCCESS)
        result = vkao_import(&ctx->log, VKAO_STRUCT_IMAGES, "images", images, &known);
    if (result != VKAO_SUCCESS)
        return result;
    for (uint32_t i = 0; i < VKAO_SLOT_COUNT; ++i) {
        const vkao_image *was = vkao_slot_image(&frame->images, i),
                         *is = vkao_slot_image(&known, i);
        if (was->format != is->format)
            return vkao_refuse(&ctx->log, VKAO_ERROR_INVALID_ARGUMENT,
                               "%s.format is %s, the frame was created with %s", vkao_slot_name(i),
                               vkao_format_name(is->format, now),
                               vkao_format_name(was->format, then));
        if (!was->image != !is->image)
            return vkao_refuse(&ctx->log, VKAO_ERROR_INVALID_ARGUMENT,
                               "%s.image is %s, the frame was created %s it", vkao_slot_name(i),
                               is->image ? "given" : "VK_NULL_HANDLE",
                               is->image ? "without" : "with");
    }
    result = vkao_slots_check(frame->program, &known, true);
    if (result != VKAO_SUCCESS)
        return result;
    frame->images = known;
    write_sets(frame);
    return VKAO_SUCCESS;
}

void vkao_frame_destroy(vkao_frame *frame)
{
    if (!frame)
        return;
    const vkao_context *ctx = frame->ctx;
    atomic_uint *frames = frame->effect->frames;
    if (frame->pool)
        ctx->vk.DestroyDescriptorPool(ctx->device, frame->pool, ctx->allocator);
    vkao_scratch_destroy(ctx, &frame->scratch);
    if (frame->memory)
        ctx->vk.FreeMemory(ctx->device, frame->memory, ctx->allocator);
    if (frame->own)
        vkao_program_destroy(frame->own);
    vkao_free(ctx->allocator, frame->own);
    vkao_free(ctx->allocator, frame);
    atomic_fetch_sub(frames, 1);
    atomic_fetch_sub(ctx->live, 1);
}
