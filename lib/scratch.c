/* SPDX-License-Identifier: MIT */
#include "scratch.h"

static VkDeviceSize align_up(VkDeviceSize value, VkDeviceSize alignment)
{
    return (value + alignment - 1) / alignment * alignment;
}

static bool meet(const struct vkao_block *a, const struct vkao_block *b)
{
    return a->first <= b->last && b->first <= a->last;
}

static bool overlap(const struct vkao_block *a, const struct vkao_block *b)
{
    return a->offset < b->offset + b->size && b->offset < a->offset + a->size;
}

/* Places blocks so that those that live at the same time do not overlap; returns the size of
 * all. */
static VkDeviceSize place(struct vkao_block *blocks[], uint32_t count)
{
    VkDeviceSize all = 0;
    for (uint32_t i = 0; i < count; ++i) {
        struct vkao_block *b = blocks[i];
        b->offset = 0;
        /* Behind each that is in the way, until none is: offsets only grow. */
        for (uint32_t k = 0; k < i; ++k) {
            if (!meet(b, blocks[k]) || !overlap(b, blocks[k]))
                continue;
            b->offset = align_up(blocks[k]->offset + blocks[k]->size, b->alignment);
            k = UINT32_MAX; /* from the start again */
        }
        all = b->offset + b->size > all ? b->offset + b->size : all;
    }
    for (uint32_t i = 0; i < count; ++i) {
        blocks[i]->follows = false;
        for (uint32_t k = 0; k < count; ++k) {
            if (overlap(blocks[i], blocks[k]) && blocks[k]->last < blocks[i]->first)
                blocks[i]->follows = true;
        }
    }
    return all;
}

/* The largest that limits ask offsets of buffers to be a multiple of. */
enum { PART_ALIGNMENT = 256 };

static vkao_result create_image(const struct vkao_program *program, VkFormat format,
                                VkExtent2D extent, struct vkao_scratch_image *image,
                                VkMemoryRequirements *out)
{
    const vkao_context *ctx = program->ctx;
    VkResult result =
        ctx->vk.CreateImage(ctx->device,
                            &(VkImageCreateInfo){
                                .sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                .flags = VK_IMAGE_CREATE_ALIAS_BIT,
                                .imageType = VK_IMAGE_TYPE_2D,
                                .format = format,
                                .extent = {extent.width, extent.height, 1},
                                .mipLevels = 1,
                                .arrayLayers = 1,
                                .samples = VK_SAMPLE_COUNT_1_BIT,
                                .tiling = VK_IMAGE_TILING_OPTIMAL,
                                .usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT,
                                .sharingMode = VK_SHARING_MODE_EXCLUSIVE,
                                .initialLayout = VK_IMAGE_LAYOUT_UNDEFINED,
                            },
                            ctx->allocator, &image->image);
    if (result != VK_SUCCESS) {
        image->image = VK_NULL_HANDLE; /* drivers may leave anything behind a failure */
        return vkao_vk_failed(&ctx->log, "vkCreateImage", result);
    }
    image->format = format;
    image->extent = extent;
    ctx->vk.GetImageMemoryRequirements(ctx->device, image->image, out);
    return VKAO_SUCCESS;
}

static vkao_result create_buffer(const vkao_context *ctx, VkDeviceSize bytes, VkBuffer *buffer)
{
    VkResult result = ctx->vk.CreateBuffer(
        ctx->device,
        &(VkBufferCreateInfo){
            .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
            .size = bytes,
            .usage = VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT |
                     VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT |
                     VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_STORAGE_TEXEL_BUFFER_BIT,
            .sharingMode = VK_SHARING_MODE_EXCLUSIVE,
        },
        ctx->allocator, buffer);
    if (result == VK_SUCCESS)
        return VKAO_SUCCESS;
    *buffer = VK_NULL_HANDLE;
    return vkao_vk_failed(&ctx->log, "vkCreateBuffer", result);
}

/* Those whose passes nobody runs are kept all the time. */
static void set_lifetime(const struct vkao_program *program, enum vkao_resource resource,
                         struct vkao_block *block)
{
    vkao_program_lifetime(program, resource, &block->first, &block->last);
    if (resource == VKAO_RESOURCE_CONSTANTS || block->first > block->last) {
        block->first = 0;
        block->last = UINT32_MAX;
    }
}

static VkDeviceSize place_parts(const struct vkao_program *program,
                                const struct vkao_scratch_plan *plan, struct vkao_scratch *scratch)
{
    struct vkao_block *parts[VKAO_RESOURCE_COUNT];
    uint32_t count = 0;
    for (uint32_t i = VKAO_RESOURCE_CONSTANTS; i < VKAO_RESOURCE_COUNT; ++i) {
        struct vkao_block *block = &scratch->blocks[i];
        block->size = plan->parts[i];
        block->alignment = PART_ALIGNMENT;
        set_lifetime(program, (enum vkao_resource)i, block);
        if (block->size)
            parts[count++] = block;
    }
    return place(parts, count);
}

/* Places the buffer's memory: the end of it may lie in the memory of images, once the last of its
 * parts is no longer needed. */
static void split_buffer(struct vkao_scratch *scratch, const VkMemoryRequirements *need,
                         VkDeviceSize alignment)
{
    const struct vkao_block *last = NULL;
    VkDeviceSize kept = 0;
    for (int i = VKAO_RESOURCE_CONSTANTS; i < VKAO_RESOURCE_COUNT; ++i) {
        const struct vkao_block *b = &scratch->blocks[i];
        if (b->size && (!last || b->offset + b->size > last->offset + last->size))
            last = b;
    }
    for (int i = VKAO_RESOURCE_CONSTANTS; i < VKAO_RESOURCE_COUNT; ++i) {
        const struct vkao_block *b = &scratch->blocks[i];
        if (b->size && b->last > last->last && b->offset + b->size > kept)
            kept = b->offset + b->size;
    }
    kept = last->last == UINT32_MAX ? need->size : align_up(kept, alignment);
    kept = kept < need->size ? kept : need->size;
    scratch->kept = (struct vkao_block){kept, alignment, 0, 0, UINT32_MAX, false};
    scratch->tail = (struct vkao_block){need->size - kept, alignment, 0, 0, last->last, false};
}

vkao_result vkao_scratch_create(const struct vkao_program *program,
                                const struct vkao_scratch_plan *plan, struct vkao_scratch *scratch,
                                VkMemoryRequirements *out)
{
    const vkao_context *ctx = program->ctx;
    const VkDeviceSize granularity = ctx->granularity ? ctx->granularity : 1;
    struct vkao_block *blocks[VKAO_IMAGE_COUNT + 2] = {&scratch->kept, &scratch->tail};
    uint32_t count = 2;
    VkMemoryRequirements r;
    *out = (VkMemoryRequirements){.alignment = granularity, .memoryTypeBits = UINT32_MAX};
    vkao_result result = create_buffer(ctx, place_parts(program, plan, scratch), &scratch->buffer);
    if (result != VKAO_SUCCESS)
        return result;
    ctx->vk.GetBufferMemoryRequirements(ctx->device, scratch->buffer, &r);
    split_buffer(scratch, &r, r.alignment > granularity ? r.alignment : granularity);
    out->memoryTypeBits &= r.memoryTypeBits;
    for (uint32_t i = 0; i < VKAO_IMAGE_COUNT; ++i) {
        struct vkao_block *block = &scratch->blocks[i];
        if (!plan->images[i].format)
            continue;
        result = create_image(program, plan->images[i].format, plan->images[i].extent,
                              &scratch->images[i], &r);
        if (result != VKAO_SUCCESS)
            return result;
        *block = (struct vkao_block){.size = r.size, .alignment = r.alignment};
        set_lifetime(program, (enum vkao_resource)i, block);
        blocks[count++] = block;
        out->memoryTypeBits &= r.memoryTypeBits;
    }
    for (uint32_t i = 0; i < count; ++i) {
        if (blocks[i]->alignment < granularity)
            blocks[i]->alignment = granularity;
        if (out->alignment < blocks[i]->alignment)
            out->alignment = blocks[i]->alignment;
    }
    out->size = place(blocks, count);
    return VKAO_SUCCESS;
}

static vkao_result bind_image(const vkao_context *ctx, struct vkao_scratch_image *image,
                              VkDeviceMemory memory, VkDeviceSize offset)
{
    VkResult result = ctx->vk.BindImageMemory(ctx->device, image->image, memory, offset);
    if (result != VK_SUCCESS)
        return vkao_vk_failed(&ctx->log, "vkBindImageMemory", result);
    result =
        ctx->vk.CreateImageView(ctx->device,
                                &(VkImageViewCreateInfo){
                                    .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                    .image = image->image,
                                    .viewType = VK_IMAGE_VIEW_TYPE_2D,
                                    .format = image->format,
                                    .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1},
                                },
                                ctx->allocator, &image->view);
    if (result != VK_SUCCESS) {
        image->view = VK_NULL_HANDLE;
        return vkao_vk_failed(&ctx->log, "vkCreateImageView", result);
    }
    vkao_set_name(ctx, VK_OBJECT_TYPE_IMAGE, (uint64_t)image->image, "vkao scratch");
    return VKAO_SUCCESS;
}

static vkao_result create_view(const vkao_context *ctx, const struct vkao_scratch *scratch,
                               const struct vkao_use *use, VkBufferView *view)
{
    const struct vkao_block *part = &scratch->blocks[use->resource];
    VkResult result =
        ctx->vk.CreateBufferView(ctx->device,
                                 &(VkBufferViewCreateInfo){
                                     .sType = VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO,
                                     .buffer = scratch->buffer,
                                     .format = use->texels,
                                     .offset = part->offset,
                                     .range = part->size,
                                 },
                                 ctx->allocator, view);
    if (result == VK_SUCCESS)
        return VKAO_SUCCESS;
    *view = VK_NULL_HANDLE;
    return vkao_vk_failed(&ctx->log, "vkCreateBufferView", result);
}

static vkao_result bind_buffer(const struct vkao_program *program, struct vkao_scratch *scratch,
                               VkDeviceMemory memory, VkDeviceSize offset)
{
    const vkao_context *ctx = program->ctx;
    VkResult bound = ctx->vk.BindBufferMemory(ctx->device, scratch->buffer, memory, offset);
    if (bound != VK_SUCCESS)
        return vkao_vk_failed(&ctx->log, "vkBindBufferMemory", bound);
    vkao_set_name(ctx, VK_OBJECT_TYPE_BUFFER, (uint64_t)scratch->buffer, "vkao scratch");
    vkao_result result = VKAO_SUCCESS;
    for (uint32_t i = 0; i < program->count; ++i) {
        const struct vkao_step *step = &program->steps[i];
        for (uint32_t k = 0; result == VKAO_SUCCESS && k < step->use_count; ++k) {
            if (vkao_use_type(&step->uses[k]) == VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER)
                result = create_view(ctx, scratch, &step->uses[k], &scratch->views[i][k]);
        }
    }
    return result;
}

vkao_result vkao_scratch_bind(const struct vkao_program *program, struct vkao_scratch *scratch,
                              VkDeviceMemory memory, VkDeviceSize offset)
{
    vkao_result result = bind_buffer(program, scratch, memory, offset + scratch->kept.offset);
    for (uint32_t i = 0; result == VKAO_SUCCESS && i < VKAO_IMAGE_COUNT; ++i) {
        if (scratch->images[i].image)
            result = bind_image(program->ctx, &scratch->images[i], memory,
                                offset + scratch->blocks[i].offset);
    }
    return result;
}

void vkao_scratch_destroy(const vkao_context *ctx, struct vkao_scratch *scratch)
{
    for (uint32_t i = 0; i < VKAO_MOST_PASSES; ++i) {
        for (uint32_t k = 0; k < VKAO_MOST_USES; ++k) {
            if (scratch->views[i][k])
                ctx->vk.DestroyBufferView(ctx->device, scratch->views[i][k], ctx->allocator);
        }
    }
    if (scratch->buffer)
        ctx->vk.DestroyBuffer(ctx->device, scratch->buffer, ctx->allocator);
    for (uint32_t i = 0; i < VKAO_IMAGE_COUNT; ++i) {
        if (scratch->images[i].view)
            ctx->vk.DestroyImageView(ctx->device, scratch->images[i].view, ctx->allocator);
        if (scratch->images[i].image)
            ctx->vk.DestroyImage(ctx->device, scratch->images[i].image, ctx->allocator);
    }
}
