/* SPDX-License-Identifier: MIT */
#include "internal.h"

enum slot_use { SLOT_DEPTH, SLOT_NORMALS, SLOT_AO, SLOT_COLOR, SLOT_OUTPUT };

struct slot {
    const char *name;
    size_t offset; /* in vkao_images */
    enum slot_use use;
};

enum slot_index {
    DEPTH,
    NORMALS,
    AO_NOISY,
    AO,
    COLOR,
    DIRECT,
    OUTPUT,
    BENT_NORMALS,
    ALBEDO,
    SPECULAR,
    SLOT_COUNT
};

static const struct slot slots[SLOT_COUNT] = {
    [DEPTH] = {"images.depth", offsetof(vkao_images, depth), SLOT_DEPTH},
    [NORMALS] = {"images.normals", offsetof(vkao_images, normals), SLOT_NORMALS},
    [AO_NOISY] = {"images.ao_noisy", offsetof(vkao_images, ao_noisy), SLOT_AO},
    [AO] = {"images.ao", offsetof(vkao_images, ao), SLOT_AO},
    [COLOR] = {"images.color", offsetof(vkao_images, color), SLOT_COLOR},
    [DIRECT] = {"images.direct", offsetof(vkao_images, direct), SLOT_COLOR},
    [OUTPUT] = {"images.output", offsetof(vkao_images, output), SLOT_OUTPUT},
    [BENT_NORMALS] = {"images.bent_normals", offsetof(vkao_images, bent_normals), SLOT_NORMALS},
    [ALBEDO] = {"images.albedo", offsetof(vkao_images, albedo), SLOT_COLOR},
    [SPECULAR] = {"images.specular", offsetof(vkao_images, specular), SLOT_COLOR},
};

static const vkao_image *slot_image(const vkao_images *images, enum slot_index i)
{
    return (const vkao_image *)(const void *)((const char *)images + slots[i].offset);
}

/* What the stages of a frame do with each slot. */
struct slot_access {
    bool required, read, written;
};

static void slot_accesses(vkao_stage_flags stages, struct slot_access out[SLOT_COUNT])
{
    const bool ssao = stages & VKAO_STAGE_SSAO, blur = stages & VKAO_STAGE_BLUR;
    const bool composite = stages & VKAO_STAGE_COMPOSITE, makes_ao = ssao || blur;
    out[DEPTH] = (struct slot_access){makes_ao, makes_ao, false};
    out[NORMALS] = (struct slot_access){false, makes_ao || composite, false};
    out[AO_NOISY] = (struct slot_access){blur && !ssao, blur, ssao && blur};
    out[AO] = (struct slot_access){!composite || !makes_ao, composite, makes_ao};
    out[COLOR] = (struct slot_access){false, composite, false};
    out[DIRECT] = (struct slot_access){false, composite, false};
    out[OUTPUT] = (struct slot_access){composite, false, composite};
    out[BENT_NORMALS] = (struct slot_access){false, composite, blur};
    out[ALBEDO] = (struct slot_access){false, composite, false};
    out[SPECULAR] = (struct slot_access){false, composite, false};
}

static bool format_fits(enum slot_use use, VkFormat format)
{
    switch (use) {
    case SLOT_DEPTH:
        return vk_format_is_depth(format);
    case SLOT_AO:
        return vk_format_is_ao(format);
    default:
        return vk_format_is_sampled_float(format);
    }
}

static bool read_layout(VkImageLayout layout)
{
    static const VkImageLayout allowed[] = {
        VK_IMAGE_LAYOUT_GENERAL,
        VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
        VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL,
        VK_IMAGE_LAYOUT_DEPTH_READ_ONLY_OPTIMAL,
        VK_IMAGE_LAYOUT_DEPTH_READ_ONLY_STENCIL_ATTACHMENT_OPTIMAL,
        VK_IMAGE_LAYOUT_READ_ONLY_OPTIMAL,
    };
    for (size_t i = 0; i < sizeof allowed / sizeof allowed[0]; ++i) {
        if (layout == allowed[i])
            return true;
    }
    return false;
}

static vkao_result check_slot(const vkao_context *ctx, const struct slot *slot,
                              const vkao_image *image, struct slot_access access)
{
    if (image->format == VK_FORMAT_UNDEFINED) {
        if (image->view)
            return vkao_refuse(&ctx->log, VKAO_ERROR_INVALID_ARGUMENT,
                               "%s has a view but no format", slot->name);
        if (access.required)
            return vkao_refuse(&ctx->log, VKAO_ERROR_INVALID_ARGUMENT,
                               "%s is required by frame.stages", slot->name);
        return VKAO_SUCCESS;
    }
    if (!format_fits(slot->use, image->format))
        return vkao_refuse(&ctx->log, VKAO_ERROR_INVALID_ARGUMENT,
                           "%s.format is VkFormat %d, which cannot hold it", slot->name,
                           (int)image->format);
    if (access.written ? image->layout != VK_IMAGE_LAYOUT_GENERAL
                       : access.read && !read_layout(image->layout))
        return vkao_refuse(&ctx->log, VKAO_ERROR_INVALID_ARGUMENT,
                           "%s.layout is VkImageLayout %d, want %s", slot->name, (int)image->layout,
                           access.written ? "GENERAL" : "a read-only one or GENERAL");
    VkFormatFeatureFlags want = (access.read ? VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT : 0u) |
                                (access.written ? VK_FORMAT_FEATURE_STORAGE_IMAGE_BIT : 0u);
    VkFormatProperties properties;
    ctx->vk.GetPhysicalDeviceFormatProperties(ctx->physical_device, image->format, &properties);
    /* The caller's tiling is unknown: either will do. */
    if ((properties.optimalTilingFeatures & want) != want &&
        (properties.linearTilingFeatures & want) != want)
        return vkao_refuse(&ctx->log, VKAO_ERROR_UNSUPPORTED,
                           "%s.format is VkFormat %d, which the device cannot %s", slot->name,
                           (int)image->format,
                           access.written ? "use as a storage image" : "sample");
    return VKAO_SUCCESS;
}

static vkao_result check_images(const vkao_context *ctx, vkao_stage_flags stages,
                                const vkao_images *images, bool need_views)
{
    struct slot_access access[SLOT_COUNT];
    slot_accesses(stages, access);
    if (images->reserved)
        return vkao_refuse(&ctx->log, VKAO_ERROR_INVALID_ARGUMENT, "images.reserved is %u, want 0",
                           images->reserved);
    for (int i = 0; i < SLOT_COUNT; ++i) {
        const vkao_image *image = slot_image(images, (enum slot_index)i);
        vkao_result result = check_slot(ctx, &slots[i], image, access[i]);
        if (result != VKAO_SUCCESS)
            return result;
        bool used = image->format != VK_FORMAT_UNDEFINED && (access[i].read || access[i].written);
        if (need_views && used && !image->view)
            return vkao_refuse(&ctx->log, VKAO_ERROR_INVALID_ARGUMENT, "%s.view is VK_NULL_HANDLE",
                               slots[i].name);
    }
    return VKAO_SUCCESS;
}

/* Rules between slots and stages. */
static vkao_result check_combination(const vkao_frame *frame)
{
    const struct vkao_logger *log = &frame->ctx->log;
    const vkao_stage_flags both = VKAO_STAGE_SSAO | VKAO_STAGE_BLUR;
    const bool noisy = frame->images.ao_noisy.format != VK_FORMAT_UNDEFINED;
    const bool bent = frame->images.bent_normals.format != VK_FORMAT_UNDEFINED;
    if (frame->half_resolution && ((frame->stages & both) != both || noisy))
        return vkao_refuse(
            log, VKAO_ERROR_INVALID_ARGUMENT,
            "frame.half_resolution needs the stages SSAO and BLUR (frame.stages is 0x%x) and no "
            "images.ao_noisy",
            frame->stages);
    if (bent && (frame->stages & both) && ((frame->stages & both) != both || noisy))
        return vkao_refuse(
            log, VKAO_ERROR_INVALID_ARGUMENT,
            "images.bent_normals needs the stages SSAO and BLUR (frame.stages is 0x%x) and no "
            "images.ao_noisy",
            frame->stages);
    return VKAO_SUCCESS;
}

/* Checks the info and fills the frame's description, without creating anything. */
static vkao_result describe(const vkao_context *ctx, const vkao_frame_info *caller_info,
                            bool need_views, vkao_frame_info *info, vkao_frame *frame)
{
    vkao_result result = vkao_import(&ctx->log, "frame", caller_info, info, sizeof *info);
    if (result == VKAO_SUCCESS)
        result = vkao_import(&ctx->log, "frame.images", info->images, &frame->images,
                             sizeof frame->images);
    if (result != VKAO_SUCCESS)
        return result;
    if (!info->stages || (info->stages & ~VKAO_STAGE_ALL))
        return vkao_refuse(&ctx->log, VKAO_ERROR_INVALID_ARGUMENT,
                           "frame.stages is 0x%x, want bits of 0x%x", info->stages, VKAO_STAGE_ALL);
    if (info->stages & ~ctx->stage_mask)
        return vkao_refuse(&ctx->log, VKAO_ERROR_INVALID_ARGUMENT,
                           "frame.stages is 0x%x, but the context was created with stage_mask 0x%x",
                           info->stages, ctx->stage_mask);
    if (!info->extent.width || !info->extent.height)
        return vkao_refuse(&ctx->log, VKAO_ERROR_INVALID_ARGUMENT,
                           "frame.extent is %ux%u, want at least 1x1", info->extent.width,
                           info->extent.height);
    if (info->extent.width > ctx->max_dimension || info->extent.height > ctx->max_dimension)
        return vkao_refuse(&ctx->log, VKAO_ERROR_UNSUPPORTED,
                           "frame.extent is %ux%u, the limit is %u", info->extent.width,
                           info->extent.height, ctx->max_dimension);
    if (info->half_resolution > 1 || info->reserved)
        return vkao_refuse(&ctx->log, VKAO_ERROR_INVALID_ARGUMENT,
                           "frame.half_resolution is %u, reserved %u, want 0 or 1, 0",
                           info->half_resolution, info->reserved);
    frame->ctx = ctx;
    frame->stages = info->stages;
    frame->extent = info->extent;
    frame->half_resolution = info->half_resolution;
    vkao_result checked = check_images(ctx, info->stages, &frame->images, need_views);
    const vkao_stage_flags both = VKAO_STAGE_SSAO | VKAO_STAGE_BLUR;
    frame->packed = ctx->buffers && (info->stages & both) == both &&
                    frame->images.ao_noisy.format == VK_FORMAT_UNDEFINED &&
                    frame->images.bent_normals.format == VK_FORMAT_UNDEFINED;
    if (frame->packed && frame->images.ao_image)
        frame->staged = vk_format_staged(frame->images.ao.format);
    return checked == VKAO_SUCCESS ? check_combination(frame) : checked;
}

vkao_result vkao_frame_scratch(const vkao_context *ctx, const vkao_frame_info *info,
                               VkMemoryRequirements *out)
{
    if (!ctx)
        return VKAO_ERROR_INVALID_ARGUMENT;
    if (!out)
        return vkao_refuse(&ctx->log, VKAO_ERROR_INVALID_ARGUMENT,
                           "vkao_frame_scratch: out is NULL");
    vkao_frame frame = {0};
    vkao_frame_info known;
    vkao_result result = describe(ctx, info, false, &known, &frame);
    if (result != VKAO_SUCCESS)
        return result;
    VkMemoryRequirements requirements;
    result = scratch_create(&frame, &frame.scratch, &requirements);
    scratch_destroy(ctx, &frame.scratch);
    if (result == VKAO_SUCCESS)
        *out = requirements;
    return result;
}

static vkao_result create_scratch(vkao_frame *frame, const vkao_frame_info *info)
{
    const vkao_context *ctx = frame->ctx;
    VkMemoryRequirements requirements;
    vkao_result result = scratch_create(frame, &frame->scratch, &requirements);
    if (result != VKAO_SUCCESS || requirements.size == 0)
        return result;
    if (info->scratch_memory) {
        if (info->scratch_offset % requirements.alignment)
            return vkao_refuse(&ctx->log, VKAO_ERROR_INVALID_ARGUMENT,
                               "frame.scratch_offset is %llu, want a multiple of %llu",
                               (unsigned long long)info->scratch_offset,
                               (unsigned long long)requirements.alignment);
        return scratch_bind(ctx, &frame->scratch, info->scratch_memory, info->scratch_offset);
    }
    uint32_t type = vk_memory_type(&ctx->memory, requirements.memoryTypeBits);
    if (type == UINT32_MAX)
        return vkao_refuse(&ctx->log, VKAO_ERROR_UNSUPPORTED,
                           "no DEVICE_LOCAL memory type among 0x%x", requirements.memoryTypeBits);
    VkResult allocated = ctx->vk.AllocateMemory(ctx->device,
                                                &(VkMemoryAllocateInfo){
                                                    .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                                    .allocationSize = requirements.size,
                                                    .memoryTypeIndex = type,
                                                },
                                                ctx->allocator, &frame->memory);
    if (allocated != VK_SUCCESS) {
        frame->memory = VK_NULL_HANDLE;
        return vkao_vk_failed(&ctx->log, "vkAllocateMemory", allocated);
    }
    vkao_log(&ctx->log, VKAO_LOG_INFO, "frame %ux%u: %llu bytes of scratch", frame->extent.width,
             frame->extent.height, (unsigned long long)requirements.size);
    return scratch_bind(ctx, &frame->scratch, frame->memory, 0);
}

vkao_result vkao_frame_create(const vkao_context *ctx, const vkao_frame_info *caller_info,
                              vkao_frame **out)
{
    if (out)
        *out = NULL;
    if (!ctx)
        return VKAO_ERROR_INVALID_ARGUMENT;
    if (!out)
        return vkao_refuse(&ctx->log, VKAO_ERROR_INVALID_ARGUMENT,
                           "vkao_frame_create: out is NULL");
    vkao_frame described = {0};
    vkao_frame_info info;
    vkao_result result = describe(ctx, caller_info, true, &info, &described);
    if (result != VKAO_SUCCESS)
        return result;
    vkao_frame *frame = vkao_calloc(ctx->allocator, sizeof *frame);
    if (!frame)
        return vkao_refuse(&ctx->log, VKAO_ERROR_OUT_OF_HOST_MEMORY,
                           "no host memory for the frame");
    *frame = described;
    result = create_scratch(frame, &info);
    if (result == VKAO_SUCCESS)
        result = descriptors_create(frame);
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
    const vkao_context *ctx = frame->ctx;
    vkao_result result = vkao_import(&ctx->log, "images", images, &known, sizeof known);
    if (result != VKAO_SUCCESS)
        return result;
    for (int i = 0; i < SLOT_COUNT; ++i) {
        VkFormat was = slot_image(&frame->images, (enum slot_index)i)->format;
        VkFormat is = slot_image(&known, (enum slot_index)i)->format;
        if (was != is)
            return vkao_refuse(&ctx->log, VKAO_ERROR_INVALID_ARGUMENT,
                               "%s.format is VkFormat %d, the frame was created with %d",
                               slots[i].name, (int)is, (int)was);
    }
    if (!known.ao_image != !frame->images.ao_image)
        return vkao_refuse(&ctx->log, VKAO_ERROR_INVALID_ARGUMENT,
                           "images.ao_image is %s, the frame was created %s it",
                           known.ao_image ? "given" : "VK_NULL_HANDLE",
                           known.ao_image ? "without" : "with");
    result = check_images(ctx, frame->stages, &known, true);
    if (result != VKAO_SUCCESS)
        return result;
    frame->images = known;
    descriptors_write(frame);
    return VKAO_SUCCESS;
}

void vkao_frame_destroy(vkao_frame *frame)
{
    if (!frame)
        return;
    const vkao_context *ctx = frame->ctx;
    if (frame->pool)
        ctx->vk.DestroyDescriptorPool(ctx->device, frame->pool, ctx->allocator);
    scratch_destroy(ctx, &frame->scratch);
    if (frame->memory)
        ctx->vk.FreeMemory(ctx->device, frame->memory, ctx->allocator);
    vkao_free(ctx->allocator, frame);
}
