/* SPDX-License-Identifier: MIT
 *
 * Images, transfers and command buffers of gpu.h. */
#include "gpu.h"

#include <inttypes.h>
#include <string.h>
#include <vulkan/vulkan.h>

static bool fail_limit(const struct gpu *gpu, const char *limit, uint64_t has, uint64_t wanted,
                       struct tool_error *err)
{
    fail_hint(err, "crop or scale the image, or choose another device with --device");
    return fail(err, EXIT_DEVICE, "%s of %s is %" PRIu64 ", less than the %" PRIu64 " wanted",
                limit, gpu->properties.deviceName, has, wanted);
}

bool gpu_allocate(struct gpu *gpu, const VkMemoryRequirements *need, VkMemoryPropertyFlags flags,
                  VkDeviceMemory *memory, struct tool_error *err)
{
    uint32_t type = 0;
    if (need->size > gpu->max_allocation)
        return fail_limit(gpu, "maxMemoryAllocationSize", gpu->max_allocation, need->size, err);
    while (type < gpu->memory.memoryTypeCount &&
           (!(need->memoryTypeBits >> type & 1u) ||
            (gpu->memory.memoryTypes[type].propertyFlags & flags) != flags))
        ++type;
    if (type == gpu->memory.memoryTypeCount)
        return fail(err, EXIT_DEVICE, "the device has no memory type with flags 0x%x", flags);
    VkResult result = vkAllocateMemory(gpu->device,
                                       &(VkMemoryAllocateInfo){
                                           .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                           .allocationSize = need->size,
                                           .memoryTypeIndex = type,
                                       },
                                       NULL, memory);
    if (result != VK_SUCCESS)
        *memory = VK_NULL_HANDLE;
    return gpu_ok(err, "vkAllocateMemory", result);
}

static bool is_depth(VkFormat format)
{
    return format >= VK_FORMAT_D16_UNORM && format <= VK_FORMAT_D32_SFLOAT;
}

static VkImageSubresourceRange whole(VkFormat format)
{
    VkImageAspectFlags aspect =
        is_depth(format) ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
    return (VkImageSubresourceRange){aspect, 0, 1, 0, 1};
}

VkCommandBuffer gpu_begin(struct gpu *gpu, struct tool_error *err)
{
    VkCommandBuffer cmd = VK_NULL_HANDLE;
    VkResult result =
        vkAllocateCommandBuffers(gpu->device,
                                 &(VkCommandBufferAllocateInfo){
                                     .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                     .commandPool = gpu->command_pool,
                                     .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                     .commandBufferCount = 1,
                                 },
                                 &cmd);
    if (!gpu_ok(err, "vkAllocateCommandBuffers", result))
        return VK_NULL_HANDLE;
    result = vkBeginCommandBuffer(cmd, &(VkCommandBufferBeginInfo){
                                           .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                           .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT,
                                       });
    if (gpu_ok(err, "vkBeginCommandBuffer", result))
        return cmd;
    vkFreeCommandBuffers(gpu->device, gpu->command_pool, 1, &cmd);
    return VK_NULL_HANDLE;
}

bool gpu_submit(struct gpu *gpu, VkCommandBuffer cmd, struct tool_error *err)
{
    bool ok = gpu_ok(err, "vkEndCommandBuffer", vkEndCommandBuffer(cmd)) &&
              gpu_ok(err, "vkQueueSubmit",
                     vkQueueSubmit(gpu->queue, 1,
                                   &(VkSubmitInfo){
                                       .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                                       .commandBufferCount = 1,
                                       .pCommandBuffers = &cmd,
                                   },
                                   VK_NULL_HANDLE)) &&
              gpu_ok(err, "vkQueueWaitIdle", vkQueueWaitIdle(gpu->queue));
    vkFreeCommandBuffers(gpu->device, gpu->command_pool, 1, &cmd);
    return ok;
}

double gpu_ms_between(const struct gpu *gpu, uint64_t first, uint64_t second)
{
    const uint64_t mask =
        gpu->timestamp_bits < 64 ? (UINT64_C(1) << gpu->timestamp_bits) - 1 : UINT64_MAX;
    /* Masked after the subtraction: the counter may have wrapped in between. */
    return (double)((second - first) & mask) * (double)gpu->properties.limits.timestampPeriod *
           1e-6;
}

void gpu_full_barrier(VkCommandBuffer cmd)
{
    vkCmdPipelineBarrier(
        cmd, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 1,
        &(VkMemoryBarrier){
            .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
            .srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT,
            .dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT,
        },
        0, NULL, 0, NULL);
}

static bool to_general(struct gpu *gpu, struct gpu_image *image, struct tool_error *err)
{
    VkCommandBuffer cmd = gpu_begin(gpu, err);
    if (!cmd)
        return false;
    vkCmdPipelineBarrier(
        cmd, VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0, NULL, 0,
        NULL, 1,
        &(VkImageMemoryBarrier){
            .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
            .dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT,
            .oldLayout = VK_IMAGE_LAYOUT_UNDEFINED,
            .newLayout = VK_IMAGE_LAYOUT_GENERAL,
            .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
            .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
            .image = image->image,
            .subresourceRange = whole(image->format),
        });
    return gpu_submit(gpu, cmd, err);
}

static bool check_image_limits(const struct gpu *gpu, const VkImageCreateInfo *info,
                               struct tool_error *err)
{
    VkImageFormatProperties can;
    const uint32_t longest =
        info->extent.width > info->extent.height ? info->extent.width : info->extent.height;
    const uint32_t most = gpu->properties.limits.maxImageDimension2D;
    const uint64_t bytes =
        (uint64_t)info->extent.width * info->extent.height * gpu_format_bytes(info->format);
    if (longest > most)
        return fail_limit(gpu, "maxImageDimension2D", most, longest, err);
    VkResult result = vkGetPhysicalDeviceImageFormatProperties(
        gpu->physical_device, info->format, info->imageType, info->tiling, info->usage, 0, &can);
    if (result != VK_SUCCESS)
        return gpu_ok(err, "vkGetPhysicalDeviceImageFormatProperties", result);
    return bytes <= can.maxResourceSize ||
           fail_limit(gpu, "maxResourceSize", can.maxResourceSize, bytes, err);
}

bool gpu_image_create(struct gpu *gpu, VkFormat format, VkExtent2D extent, VkImageUsageFlags usage,
                      struct gpu_image *image, struct tool_error *err)
{
    VkMemoryRequirements need;
    const VkImageCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
        .imageType = VK_IMAGE_TYPE_2D,
        .format = format,
        .extent = {extent.width, extent.height, 1},
        .mipLevels = 1,
        .arrayLayers = 1,
        .samples = VK_SAMPLE_COUNT_1_BIT,
        .tiling = VK_IMAGE_TILING_OPTIMAL,
        .usage = usage | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT,
        .sharingMode = VK_SHARING_MODE_EXCLUSIVE,
        .initialLayout = VK_IMAGE_LAYOUT_UNDEFINED,
    };
    *image = (struct gpu_image){.format = format, .extent = extent};
    if (!check_image_limits(gpu, &info, err))
        return false;
    VkResult result = vkCreateImage(gpu->device, &info, NULL, &image->image);
    if (result != VK_SUCCESS) {
        image->image = VK_NULL_HANDLE;
        return gpu_ok(err, "vkCreateImage", result);
    }
    vkGetImageMemoryRequirements(gpu->device, image->image, &need);
    bool ok = gpu_allocate(gpu, &need, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, &image->memory, err) &&
              gpu_ok(err, "vkBindImageMemory",
                     vkBindImageMemory(gpu->device, image->image, image->memory, 0));
    if (ok) {
        result = vkCreateImageView(gpu->device,
                                   &(VkImageViewCreateInfo){
                                       .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                       .image = image->image,
                                       .viewType = VK_IMAGE_VIEW_TYPE_2D,
                                       .format = format,
                                       .subresourceRange = whole(format),
                                   },
                                   NULL, &image->view);
        if (result != VK_SUCCESS)
            image->view = VK_NULL_HANDLE;
        ok = gpu_ok(err, "vkCreateImageView", result);
    }
    if (ok && to_general(gpu, image, err))
        return true;
    gpu_image_destroy(gpu, image);
    return false;
}

void gpu_image_destroy(struct gpu *gpu, struct gpu_image *image)
{
    if (image->view)
        vkDestroyImageView(gpu->device, image->view, NULL);
    if (image->image)
        vkDestroyImage(gpu->device, image->image, NULL);
    if (image->memory)
        vkFreeMemory(gpu->device, image->memory, NULL);
    *image = (struct gpu_image){0};
}

vkao_image gpu_image_slot(const struct gpu_image *image)
{
    return (vkao_image){image->view, VK_IMAGE_LAYOUT_GENERAL, image->format, VK_NULL_HANDLE};
}

void gpu_buffer_destroy(struct gpu *gpu, struct gpu_buffer *buffer)
{
    if (buffer->buffer)
        vkDestroyBuffer(gpu->device, buffer->buffer, NULL);
    if (buffer->memory)
        vkFreeMemory(gpu->device, buffer->memory, NULL);
    *buffer = (struct gpu_buffer){0};
}

bool gpu_buffer_create(struct gpu *gpu, uint64_t bytes, VkBufferUsageFlags usage,
                       struct gpu_buffer *buffer, struct tool_error *err)
{
    struct gpu_buffer *s = buffer;
    VkMemoryRequirements need;
    *s = (struct gpu_buffer){0};
    VkResult result = vkCreateBuffer(gpu->device,
                                     &(VkBufferCreateInfo){
                                         .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                                         .size = bytes,
                                         .usage = usage,
                                         .sharingMode = VK_SHARING_MODE_EXCLUSIVE,
                                     },
                                     NULL, &s->buffer);
    if (result != VK_SUCCESS) {
        s->buffer = VK_NULL_HANDLE;
        return gpu_ok(err, "vkCreateBuffer", result);
    }
    vkGetBufferMemoryRequirements(gpu->device, s->buffer, &need);
    if (gpu_allocate(gpu, &need,
                     VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT,
                     &s->memory, err) &&
        gpu_ok(err, "vkBindBufferMemory",
               vkBindBufferMemory(gpu->device, s->buffer, s->memory, 0)) &&
        gpu_ok(err, "vkMapMemory",
               vkMapMemory(gpu->device, s->memory, 0, VK_WHOLE_SIZE, 0, &s->mapped)))
        return true;
    gpu_buffer_destroy(gpu, s);
    return false;
}

static VkBufferImageCopy copy_region(const struct gpu_image *image)
{
    VkImageSubresourceRange range = whole(image->format);
    return (VkBufferImageCopy){
        .imageSubresource = {range.aspectMask, 0, 0, 1},
        .imageExtent = {image->extent.width, image->extent.height, 1},
    };
}

static bool check_bytes(const struct gpu_image *image, uint64_t bytes, struct tool_error *err)
{
    uint64_t want =
        (uint64_t)image->extent.width * image->extent.height * gpu_format_bytes(image->format);
    return bytes == want || fail(err, EXIT_BUG, "image transfer of %llu bytes, want %llu",
                                 (unsigned long long)bytes, (unsigned long long)want);
}

bool gpu_image_upload(struct gpu *gpu, struct gpu_image *image, const void *data, uint64_t bytes,
                      struct tool_error *err)
{
    struct gpu_buffer staging;
    if (!check_bytes(image, bytes, err) ||
        !gpu_buffer_create(gpu, bytes, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, &staging, err))
        return false;
    memcpy(staging.mapped, data, (size_t)bytes);
    VkCommandBuffer cmd = gpu_begin(gpu, err);
    if (cmd) {
        VkBufferImageCopy region = copy_region(image);
        gpu_full_barrier(cmd);
        vkCmdCopyBufferToImage(cmd, staging.buffer, image->image, VK_IMAGE_LAYOUT_GENERAL, 1,
                               &region);
        gpu_full_barrier(cmd);
    }
    bool ok = cmd && gpu_submit(gpu, cmd, err);
    gpu_buffer_destroy(gpu, &staging);
    return ok;
}

bool gpu_image_download(struct gpu *gpu, struct gpu_image *image, void *data, uint64_t bytes,
                        struct tool_error *err)
{
    struct gpu_buffer staging;
    if (!check_bytes(image, bytes, err) ||
        !gpu_buffer_create(gpu, bytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT, &staging, err))
        return false;
    VkCommandBuffer cmd = gpu_begin(gpu, err);
    if (cmd) {
        VkBufferImageCopy region = copy_region(image);
        gpu_full_barrier(cmd);
        vkCmdCopyImageToBuffer(cmd, image->image, VK_IMAGE_LAYOUT_GENERAL, staging.buffer, 1,
                               &region);
        vkCmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1,
                             &(VkMemoryBarrier){
                                 .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                                 .srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
                                 .dstAccessMask = VK_ACCESS_HOST_READ_BIT,
                             },
                             0, NULL, 0, NULL);
    }
    bool ok = cmd && gpu_submit(gpu, cmd, err);
    if (ok)
        memcpy(data, staging.mapped, (size_t)bytes);
    gpu_buffer_destroy(gpu, &staging);
    return ok;
}
