/* SPDX-License-Identifier: MIT */
#include "fake_internal.h"

#include <string.h>

static VKAPI_ATTR void VKAPI_CALL fake_CmdPipelineBarrier(
    VkCommandBuffer cmd, VkPipelineStageFlags src, VkPipelineStageFlags dst,
    VkDependencyFlags flags, uint32_t memory_count, const VkMemoryBarrier *memory,
    uint32_t buffer_count, const VkBufferMemoryBarrier *buffers, uint32_t image_count,
    const VkImageMemoryBarrier *images)
{
    struct fake_vulkan *fake = fake_of(cmd);
    struct fake_call *call = fake_note(fake, "vkCmdPipelineBarrier");
    (void)flags;
    (void)buffers;
    call->src_stages = src;
    call->dst_stages = dst;
    call->memory_barrier_count = memory_count;
    call->buffer_barrier_count = buffer_count;
    call->image_barrier_count = image_count;
    if (memory_count)
        call->memory_barrier = memory[0];
    if (image_count > FAKE_BARRIERS)
        fake_misuse(fake, "vkCmdPipelineBarrier: %u image barriers", image_count);
    for (uint32_t i = 0; i < image_count && i < FAKE_BARRIERS; ++i) {
        fake_use(fake, call->name, VK_OBJECT_TYPE_IMAGE, fake_number(images[i].image));
        call->image_barriers[i] = images[i];
    }
}

static VKAPI_ATTR void VKAPI_CALL fake_CmdBindPipeline(VkCommandBuffer cmd,
                                                       VkPipelineBindPoint point,
                                                       VkPipeline pipeline)
{
    struct fake_vulkan *fake = fake_of(cmd);
    struct fake_call *call = fake_note(fake, "vkCmdBindPipeline");
    fake_use(fake, call->name, VK_OBJECT_TYPE_PIPELINE, fake_number(pipeline));
    call->handle = fake->bound_pipeline = fake_number(pipeline);
    call->bind_point = point;
}

static VKAPI_ATTR void VKAPI_CALL fake_CmdBindDescriptorSets(
    VkCommandBuffer cmd, VkPipelineBindPoint point, VkPipelineLayout layout, uint32_t first,
    uint32_t count, const VkDescriptorSet *sets, uint32_t dynamic_count, const uint32_t *dynamic)
{
    struct fake_vulkan *fake = fake_of(cmd);
    struct fake_call *call = fake_note(fake, "vkCmdBindDescriptorSets");
    (void)dynamic;
    fake_use(fake, call->name, VK_OBJECT_TYPE_PIPELINE_LAYOUT, fake_number(layout));
    fake_use(fake, call->name, VK_OBJECT_TYPE_DESCRIPTOR_SET, fake_number(sets[0]));
    if (dynamic_count)
        fake_misuse(fake, "vkCmdBindDescriptorSets: no dynamic descriptors in the layout");
    call->handle = fake->bound_set = fake_number(sets[0]);
    call->bind_point = point;
    call->first_set = first;
    call->set_count = count;
}

static VKAPI_ATTR void VKAPI_CALL fake_CmdPushConstants(VkCommandBuffer cmd,
                                                        VkPipelineLayout layout,
                                                        VkShaderStageFlags stages, uint32_t offset,
                                                        uint32_t size, const void *values)
{
    struct fake_vulkan *fake = fake_of(cmd);
    struct fake_call *call = fake_note(fake, "vkCmdPushConstants");
    fake_use(fake, call->name, VK_OBJECT_TYPE_PIPELINE_LAYOUT, fake_number(layout));
    call->push_stages = stages;
    call->push_offset = offset;
    call->push_bytes = size;
    if (offset % 4 || size % 4 || !size || offset + size > FAKE_PUSH_BYTES)
        fake_misuse(fake, "vkCmdPushConstants: %u bytes at %u", size, offset);
    else
        memcpy(call->push + offset, values, size);
}

/* What every dispatch runs, and with what. */
static void use_bound(struct fake_vulkan *fake, struct fake_call *call)
{
    call->handle = fake->bound_pipeline;
    fake_use(fake, call->name, VK_OBJECT_TYPE_PIPELINE, fake->bound_pipeline);
    const struct fake_object *set =
        fake_use(fake, call->name, VK_OBJECT_TYPE_DESCRIPTOR_SET, fake->bound_set);
    for (size_t i = 0; set && i < FAKE_WRITES; ++i) {
        if (set->views[i])
            fake_use(fake, call->name, VK_OBJECT_TYPE_IMAGE_VIEW, set->views[i]);
    }
}

static VKAPI_ATTR void VKAPI_CALL fake_CmdDispatch(VkCommandBuffer cmd, uint32_t x, uint32_t y,
                                                   uint32_t z)
{
    struct fake_vulkan *fake = fake_of(cmd);
    struct fake_call *call = fake_note(fake, "vkCmdDispatch");
    call->groups[0] = x;
    call->groups[1] = y;
    call->groups[2] = z;
    use_bound(fake, call);
}

/* A command's one buffer. NULL, and a misuse, if there is no such buffer. */
static const struct fake_object *use_buffer(struct fake_vulkan *fake, struct fake_call *call,
                                            VkBuffer buffer)
{
    call->source = fake_number(buffer);
    return fake_use(fake, call->name, VK_OBJECT_TYPE_BUFFER, call->source);
}

static VKAPI_ATTR void VKAPI_CALL fake_CmdDispatchIndirect(VkCommandBuffer cmd, VkBuffer buffer,
                                                           VkDeviceSize offset)
{
    struct fake_vulkan *fake = fake_of(cmd);
    struct fake_call *call = fake_note(fake, "vkCmdDispatchIndirect");
    const struct fake_object *from = use_buffer(fake, call, buffer);
    call->offset = offset;
    if (from && !(from->usage & VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT))
        fake_misuse(fake, "vkCmdDispatchIndirect: the buffer is not for it");
    if (from && (offset % 4 || offset + sizeof(VkDispatchIndirectCommand) > from->bytes))
        fake_misuse(fake, "vkCmdDispatchIndirect: offset %llu", (unsigned long long)offset);
    use_bound(fake, call);
}

static VKAPI_ATTR void VKAPI_CALL fake_CmdUpdateBuffer(VkCommandBuffer cmd, VkBuffer buffer,
                                                       VkDeviceSize offset, VkDeviceSize size,
                                                       const void *data)
{
    struct fake_vulkan *fake = fake_of(cmd);
    struct fake_call *call = fake_note(fake, "vkCmdUpdateBuffer");
    const struct fake_object *to = use_buffer(fake, call, buffer);
    call->offset = offset;
    call->size = size;
    if (to && !(to->usage & VK_BUFFER_USAGE_TRANSFER_DST_BIT))
        fake_misuse(fake, "vkCmdUpdateBuffer: the buffer is no destination");
    if (offset % 4 || size % 4 || !size || size > FAKE_UPDATE_BYTES ||
        (to && offset + size > to->bytes))
        fake_misuse(fake, "vkCmdUpdateBuffer: %llu bytes at %llu", (unsigned long long)size,
                    (unsigned long long)offset);
    else
        memcpy(call->update, data, size);
}

/* Bytes of a texel of the formats that AO has. */
static VkDeviceSize texel_bytes(VkFormat format)
{
    switch (format) {
    case VK_FORMAT_R8_UNORM:
        return 1;
    case VK_FORMAT_R16_UNORM:
    case VK_FORMAT_R16_SFLOAT:
        return 2;
    case VK_FORMAT_R32_SFLOAT:
        return 4;
    default:
        return 0;
    }
}

/* What validation layers say of a region. */
static void check_copy(struct fake_vulkan *fake, const struct fake_object *buffer,
                       const struct fake_object *image, const VkBufferImageCopy *r)
{
    const VkDeviceSize texel = texel_bytes(image->image.format);
    const VkDeviceSize row = r->bufferRowLength ? r->bufferRowLength : r->imageExtent.width;
    const uint32_t mip = r->imageSubresource.mipLevel;
    if (!(buffer->usage & VK_BUFFER_USAGE_TRANSFER_SRC_BIT))
        fake_misuse(fake, "vkCmdCopyBufferToImage: the buffer is no source");
    if (!texel || r->bufferOffset % texel || row < r->imageExtent.width)
        fake_misuse(fake, "vkCmdCopyBufferToImage: offset %llu, rows of %llu texels",
                    (unsigned long long)r->bufferOffset, (unsigned long long)row);
    if (!r->imageExtent.width || !r->imageExtent.height || r->imageExtent.depth != 1 ||
        r->bufferOffset + ((r->imageExtent.height - 1) * row + r->imageExtent.width) * texel >
            buffer->bytes)
        fake_misuse(fake, "vkCmdCopyBufferToImage: nothing, or beyond the buffer");
    if (mip >= image->image.mipLevels ||
        r->imageSubresource.baseArrayLayer >= image->image.arrayLayers || r->imageOffset.x < 0 ||
        r->imageOffset.y < 0 || r->imageOffset.z ||
        (uint32_t)r->imageOffset.x + r->imageExtent.width > image->image.extent.width >> mip ||
        (uint32_t)r->imageOffset.y + r->imageExtent.height > image->image.extent.height >> mip)
        fake_misuse(fake, "vkCmdCopyBufferToImage: beyond the image");
}

static VKAPI_ATTR void VKAPI_CALL fake_CmdCopyBufferToImage(VkCommandBuffer cmd, VkBuffer buffer,
                                                            VkImage image, VkImageLayout layout,
                                                            uint32_t count,
                                                            const VkBufferImageCopy *regions)
{
    struct fake_vulkan *fake = fake_of(cmd);
    struct fake_call *call = fake_note(fake, "vkCmdCopyBufferToImage");
    const struct fake_object *from = use_buffer(fake, call, buffer);
    const struct fake_object *to =
        fake_use(fake, call->name, VK_OBJECT_TYPE_IMAGE, fake_number(image));
    call->handle = fake_number(image);
    call->layout = layout;
    call->copy = regions[0];
    if (count != 1)
        fake_misuse(fake, "vkCmdCopyBufferToImage: the fake copies one region a call");
    if (from && to)
        check_copy(fake, from, to, &regions[0]);
}

#define ENTRY(name)                                                                                \
    {                                                                                              \
        "vk" #name, (PFN_vkVoidFunction)fake_##name                                                \
    }
const struct fake_entry fake_commands[FAKE_COMMANDS] = {
    ENTRY(CmdPipelineBarrier), ENTRY(CmdBindPipeline),      ENTRY(CmdBindDescriptorSets),
    ENTRY(CmdPushConstants),   ENTRY(CmdDispatch),          ENTRY(CmdDispatchIndirect),
    ENTRY(CmdUpdateBuffer),    ENTRY(CmdCopyBufferToImage),
};
