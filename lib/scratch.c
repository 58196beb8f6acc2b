/* SPDX-License-Identifier: MIT
 *
 * Intermediate images of a frame, laid out in one block of device memory. */
#include "internal.h"

static const char *const scratch_names[SCRATCH_COUNT] = {"vkao view z", "vkao noisy ao",
                                                         "vkao halfway ao", "vkao ao"};

/* Half precision is plenty for AO on its way to the blur; storing to it is optional in Vulkan. */
static VkFormat ao_scratch_format(const vkao_context *ctx, bool bent)
{
    VkFormatProperties properties;
    ctx->vk.GetPhysicalDeviceFormatProperties(ctx->physical_device, VK_FORMAT_R16_SFLOAT,
                                              &properties);
    const VkFormatFeatureFlags want =
        VK_FORMAT_FEATURE_STORAGE_IMAGE_BIT | VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT;
    if (bent)
        return VK_FORMAT_R16G16B16A16_SFLOAT; /* storage support is mandatory */
    return (properties.optimalTilingFeatures & want) == want ? VK_FORMAT_R16_SFLOAT
                                                             : VK_FORMAT_R32_SFLOAT;
}

void scratch_plan(const vkao_frame *frame, struct scratch_image scratch[SCRATCH_COUNT])
{
    const VkFormat ao = ao_scratch_format(frame->ctx, false);
    const VkFormat noisy = ao_scratch_format(frame->ctx, frame_has_bent_normals(frame));
    const bool has_ssao = frame->stages & VKAO_STAGE_SSAO,
               has_blur = frame->stages & VKAO_STAGE_BLUR;
    const bool makes_ao = has_ssao || has_blur;
    if (makes_ao)
        scratch[SCRATCH_VIEW_Z].format =
            frame->ctx->half_view_z ? VK_FORMAT_R16_SFLOAT : VK_FORMAT_R32_SFLOAT;
    if (has_ssao && has_blur && frame->images.ao_noisy.format == VK_FORMAT_UNDEFINED)
        scratch[SCRATCH_NOISY].format = noisy;
    if (has_blur)
        scratch[SCRATCH_HALFWAY].format = noisy;
    if (makes_ao && frame->images.ao.format == VK_FORMAT_UNDEFINED)
        scratch[SCRATCH_AO].format = ao;
}

static VkDeviceSize align_up(VkDeviceSize value, VkDeviceSize alignment)
{
    return (value + alignment - 1) / alignment * alignment;
}

/* AO that COMPOSITE reads has the image's resolution, all else that of the grid. */
static VkExtent2D scratch_extent(const vkao_frame *frame, int i)
{
    VkExtent2D e = frame->extent;
    return frame->half_resolution && i != SCRATCH_AO
               ? (VkExtent2D){(e.width + 1) / 2, (e.height + 1) / 2}
               : e;
}

vkao_result scratch_create_images(const vkao_frame *frame,
                                  struct scratch_image scratch[SCRATCH_COUNT],
                                  VkMemoryRequirements *out)
{
    const vkao_context *ctx = frame->ctx;
    *out = (VkMemoryRequirements){.alignment = 1, .memoryTypeBits = UINT32_MAX};
    for (int i = 0; i < SCRATCH_COUNT; ++i) {
        if (scratch[i].format == VK_FORMAT_UNDEFINED)
            continue;
        const VkExtent2D extent = scratch_extent(frame, i);
        VkResult result = ctx->vk.CreateImage(
            ctx->device,
            &(VkImageCreateInfo){
                .sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                .imageType = VK_IMAGE_TYPE_2D,
                .format = scratch[i].format,
                .extent = {extent.width, extent.height, 1},
                .mipLevels = 1,
                .arrayLayers = 1,
                .samples = VK_SAMPLE_COUNT_1_BIT,
                .tiling = VK_IMAGE_TILING_OPTIMAL,
                .usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT,
                .sharingMode = VK_SHARING_MODE_EXCLUSIVE,
                .initialLayout = VK_IMAGE_LAYOUT_UNDEFINED,
            },
            ctx->allocator, &scratch[i].image);
        if (result != VK_SUCCESS) {
            scratch[i].image = VK_NULL_HANDLE;
            return vkao_vk_failed(&ctx->log, "vkCreateImage", result);
        }
        VkMemoryRequirements r;
        ctx->vk.GetImageMemoryRequirements(ctx->device, scratch[i].image, &r);
        scratch[i].offset = align_up(out->size, r.alignment);
        out->size = scratch[i].offset + r.size;
        out->memoryTypeBits &= r.memoryTypeBits;
        if (r.alignment > out->alignment)
            out->alignment = r.alignment;
    }
    return VKAO_SUCCESS;
}

vkao_result scratch_bind(const vkao_context *ctx, struct scratch_image scratch[SCRATCH_COUNT],
                         VkDeviceMemory memory, VkDeviceSize offset)
{
    for (int i = 0; i < SCRATCH_COUNT; ++i) {
        if (!scratch[i].image)
            continue;
        VkResult result = ctx->vk.BindImageMemory(ctx->device, scratch[i].image, memory,
                                                  offset + scratch[i].offset);
        if (result != VK_SUCCESS)
            return vkao_vk_failed(&ctx->log, "vkBindImageMemory", result);
        result =
            ctx->vk.CreateImageView(ctx->device,
                                    &(VkImageViewCreateInfo){
                                        .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                        .image = scratch[i].image,
                                        .viewType = VK_IMAGE_VIEW_TYPE_2D,
                                        .format = scratch[i].format,
                                        .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1},
                                    },
                                    ctx->allocator, &scratch[i].view);
        if (result != VK_SUCCESS) {
            scratch[i].view = VK_NULL_HANDLE;
            return vkao_vk_failed(&ctx->log, "vkCreateImageView", result);
        }
        vkao_set_name(ctx, VK_OBJECT_TYPE_IMAGE, (uint64_t)scratch[i].image, scratch_names[i]);
    }
    return VKAO_SUCCESS;
}

void scratch_destroy(const vkao_context *ctx, struct scratch_image scratch[SCRATCH_COUNT])
{
    for (int i = 0; i < SCRATCH_COUNT; ++i) {
        if (scratch[i].view)
            ctx->vk.DestroyImageView(ctx->device, scratch[i].view, ctx->allocator);
        if (scratch[i].image)
            ctx->vk.DestroyImage(ctx->device, scratch[i].image, ctx->allocator);
    }
}
