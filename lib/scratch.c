/* SPDX-License-Identifier: MIT */
#include "scratch.h"

#include "internal.h"

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

/* AO that COMPOSITE reads has the image's resolution, all else that of the grid. */
static VkExtent2D grid_extent(const vkao_frame *frame)
{
    VkExtent2D e = frame->extent;
    return frame->half_resolution ? (VkExtent2D){(e.width + 1) / 2, (e.height + 1) / 2} : e;
}

static void plan_images(const vkao_frame *frame, struct scratch_image images[SCRATCH_COUNT])
{
    const vkao_context *ctx = frame->ctx;
    const VkFormat ao = ao_scratch_format(ctx, false);
    const VkFormat noisy = ao_scratch_format(ctx, frame_has_bent_normals(frame));
    const VkExtent2D grid = grid_extent(frame);
    const bool has_ssao = frame->stages & VKAO_STAGE_SSAO,
               has_blur = frame->stages & VKAO_STAGE_BLUR;
    const bool makes_ao = has_ssao || has_blur;
    for (int i = 0; i < SCRATCH_COUNT; ++i)
        images[i].extent = grid;
    images[SCRATCH_AO].extent = frame->extent;
    if (makes_ao && !ctx->buffers) {
        images[SCRATCH_VIEW_Z].format =
            ctx->half_view_z ? VK_FORMAT_R16_SFLOAT : VK_FORMAT_R32_SFLOAT;
        images[SCRATCH_VIEW_Z].extent =
            (VkExtent2D){grid.width + 2 * VKAO_VIEW_Z_BORDER, grid.height + 2 * VKAO_VIEW_Z_BORDER};
    }
    if (has_ssao && has_blur && !frame->packed &&
        frame->images.ao_noisy.format == VK_FORMAT_UNDEFINED)
        images[SCRATCH_NOISY].format = noisy;
    if (has_blur && !frame->packed)
        images[SCRATCH_HALFWAY].format = noisy;
    if (makes_ao && frame->images.ao.format == VK_FORMAT_UNDEFINED)
        images[SCRATCH_AO].format = ao;
}

/* The largest that limits ask offsets of buffers to be a multiple of. */
enum { PART_ALIGNMENT = 256 };

static void plan_staged(const vkao_frame *frame, struct scratch_buffer *buffer)
{
    static const VkDeviceSize bytes[] = {[VKAO_STAGED_UNORM8] = 1,
                                         [VKAO_STAGED_UNORM16] = 2,
                                         [VKAO_STAGED_FLOAT16] = 2,
                                         [VKAO_STAGED_FLOAT32] = 4};
    const uint32_t window = VKAO_UPSAMPLE_WIDTH, most = VKAO_STRIP_ROWS;
    buffer->staged_stride = (frame->extent.width + window - 1) / window * window;
    buffer->staged_texel = bytes[frame->staged];
    buffer->parts[PART_STAGED].bytes = buffer->staged_texel * buffer->staged_stride *
                                       (frame->extent.height < most ? frame->extent.height : most);
}

static void plan_buffer(const vkao_frame *frame, struct scratch_buffer *buffer)
{
    if (!frame->ctx->buffers || !(frame->stages & (VKAO_STAGE_SSAO | VKAO_STAGE_BLUR)))
        return;
    const VkExtent2D grid = grid_extent(frame);
    const uint32_t window = VKAO_BLUR_X_WIDTH; /* the last one of a row stays inside its padding */
    buffer->stride = (grid.width + window - 1) / window * window + 2 * VKAO_BUFFER_PAD;
    const VkDeviceSize stride = buffer->stride;
    buffer->parts[PART_VIEW_Z].bytes = stride * (grid.height + 2 * VKAO_VIEW_Z_BORDER) * 4;
    /* A rect may begin within a tile of this many at most. */
    const VkDeviceSize columns = (grid.width + 3) / VKAO_ROW_GROUP_WIDTH + 1,
                       rows = (grid.height + VKAO_TILE_HEIGHT - 1) / VKAO_TILE_HEIGHT;
    buffer->parts[PART_TILES].bytes = sizeof(struct vkao_tiles_head) + columns * rows * 4;
    /* Shaders name these whether they are used or not. */
    buffer->parts[PART_PACKED].bytes = buffer->parts[PART_BLURRED].bytes =
        buffer->parts[PART_STAGED].bytes = PART_ALIGNMENT;
    if (frame->packed) {
        const uint32_t ring = VKAO_RING_ROWS;
        buffer->parts[PART_PACKED].bytes = stride * grid.height;
        buffer->parts[PART_HALFWAY].bytes = stride * ring * 2;
        if (frame->half_resolution)
            buffer->parts[PART_BLURRED].bytes = stride * grid.height * 2;
        if (frame->staged)
            plan_staged(frame, buffer);
    }
    for (int i = 0; i < PART_COUNT; ++i) {
        buffer->parts[i].offset = buffer->bytes;
        buffer->bytes +=
            (buffer->parts[i].bytes + PART_ALIGNMENT - 1) & ~(VkDeviceSize)(PART_ALIGNMENT - 1);
    }
}

static VkDeviceSize align_up(VkDeviceSize value, VkDeviceSize alignment)
{
    return (value + alignment - 1) / alignment * alignment;
}

/* Lays out one more thing; returns its offset. */
static VkDeviceSize add_requirements(VkMemoryRequirements *all, const VkMemoryRequirements *one)
{
    const VkDeviceSize offset = align_up(all->size, one->alignment);
    all->size = offset + one->size;
    all->memoryTypeBits &= one->memoryTypeBits;
    if (one->alignment > all->alignment)
        all->alignment = one->alignment;
    return offset;
}

static vkao_result create_image(const vkao_context *ctx, struct scratch_image *image,
                                VkMemoryRequirements *all)
{
    VkResult result =
        ctx->vk.CreateImage(ctx->device,
                            &(VkImageCreateInfo){
                                .sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                .imageType = VK_IMAGE_TYPE_2D,
                                .format = image->format,
                                .extent = {image->extent.width, image->extent.height, 1},
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
        image->image = VK_NULL_HANDLE;
        return vkao_vk_failed(&ctx->log, "vkCreateImage", result);
    }
    VkMemoryRequirements r;
    ctx->vk.GetImageMemoryRequirements(ctx->device, image->image, &r);
    image->offset = add_requirements(all, &r);
    return VKAO_SUCCESS;
}

static vkao_result create_buffer(const vkao_context *ctx, struct scratch_buffer *buffer,
                                 VkMemoryRequirements *all)
{
    /* The most texels of a part, of view z or in low images the ring, and the most bytes. */
    const VkDeviceSize z = buffer->parts[PART_VIEW_Z].bytes,
                       ring = buffer->parts[PART_HALFWAY].bytes,
                       staged = buffer->parts[PART_STAGED].bytes,
                       texels = (z > ring ? z : ring) / 4,
                       bytes = texels * 4 > staged ? texels * 4 : staged;
    if (texels > ctx->max_texels || bytes > ctx->max_buffer)
        return vkao_refuse(&ctx->log, VKAO_ERROR_UNSUPPORTED,
                           "frame.extent needs a buffer of %llu texels, the device's limits are %u "
                           "texels and %u bytes; images may be larger: context.scratch_layout",
                           (unsigned long long)texels, ctx->max_texels, ctx->max_buffer);
    VkResult result = ctx->vk.CreateBuffer(
        ctx->device,
        &(VkBufferCreateInfo){
            .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
            .size = buffer->bytes,
            .usage = VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT |
                     VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT |
                     VK_BUFFER_USAGE_STORAGE_TEXEL_BUFFER_BIT,
            .sharingMode = VK_SHARING_MODE_EXCLUSIVE,
        },
        ctx->allocator, &buffer->buffer);
    if (result != VK_SUCCESS) {
        buffer->buffer = VK_NULL_HANDLE;
        return vkao_vk_failed(&ctx->log, "vkCreateBuffer", result);
    }
    VkMemoryRequirements r;
    ctx->vk.GetBufferMemoryRequirements(ctx->device, buffer->buffer, &r);
    buffer->offset = add_requirements(all, &r);
    return VKAO_SUCCESS;
}

vkao_result scratch_create(const vkao_frame *frame, struct scratch *scratch,
                           VkMemoryRequirements *out)
{
    vkao_result result = VKAO_SUCCESS;
    *out = (VkMemoryRequirements){.alignment = 1, .memoryTypeBits = UINT32_MAX};
    plan_images(frame, scratch->images);
    plan_buffer(frame, &scratch->buffer);
    if (scratch->buffer.bytes)
        result = create_buffer(frame->ctx, &scratch->buffer, out);
    for (int i = 0; result == VKAO_SUCCESS && i < SCRATCH_COUNT; ++i) {
        if (scratch->images[i].format != VK_FORMAT_UNDEFINED)
            result = create_image(frame->ctx, &scratch->images[i], out);
    }
    return result;
}

static vkao_result bind_image(const vkao_context *ctx, struct scratch_image *image,
                              const char *name, VkDeviceMemory memory, VkDeviceSize offset)
{
    VkResult result =
        ctx->vk.BindImageMemory(ctx->device, image->image, memory, offset + image->offset);
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
    vkao_set_name(ctx, VK_OBJECT_TYPE_IMAGE, (uint64_t)image->image, name);
    return VKAO_SUCCESS;
}

const struct scratch_view *scratch_view(uint32_t binding)
{
    static const struct scratch_view views[SCRATCH_VIEWS] = {
#define VIEW(name) [VKAO_BINDING_##name - VKAO_BINDING_Z]
        VIEW(Z) = {PART_VIEW_Z, VK_FORMAT_R32_SFLOAT},
        VIEW(Z4) = {PART_VIEW_Z, VK_FORMAT_R32G32B32A32_SFLOAT},
        VIEW(PACKED_WRITE) = {PART_PACKED, VK_FORMAT_R8_UINT},
        VIEW(PACKED_WRITE2) = {PART_PACKED, VK_FORMAT_R16_UINT},
        VIEW(PACKED_READ4) = {PART_PACKED, VK_FORMAT_R32_UINT},
        VIEW(HALFWAY_READ2) = {PART_HALFWAY, VK_FORMAT_R32_UINT},
        VIEW(BLURRED_READ2) = {PART_BLURRED, VK_FORMAT_R32_UINT},
        VIEW(Z_WORDS) = {PART_VIEW_Z, VK_FORMAT_UNDEFINED},
        VIEW(HALFWAY_WORDS) = {PART_HALFWAY, VK_FORMAT_UNDEFINED},
        VIEW(BLURRED_WORDS) = {PART_BLURRED, VK_FORMAT_UNDEFINED},
        VIEW(STAGED_WORDS) = {PART_STAGED, VK_FORMAT_UNDEFINED},
        VIEW(PACKED_WORDS) = {PART_PACKED, VK_FORMAT_UNDEFINED},
        VIEW(TILES) = {PART_TILES, VK_FORMAT_UNDEFINED},
#undef VIEW
    };
    return binding >= VKAO_BINDING_Z ? &views[binding - VKAO_BINDING_Z] : NULL;
}

static vkao_result bind_buffer(const vkao_context *ctx, struct scratch_buffer *buffer,
                               VkDeviceMemory memory, VkDeviceSize offset)
{
    VkResult result =
        ctx->vk.BindBufferMemory(ctx->device, buffer->buffer, memory, offset + buffer->offset);
    if (result != VK_SUCCESS)
        return vkao_vk_failed(&ctx->log, "vkBindBufferMemory", result);
    for (uint32_t i = 0; i < SCRATCH_VIEWS; ++i) {
        const struct scratch_view *view = scratch_view(VKAO_BINDING_Z + i);
        if (!view->format || !buffer->parts[view->part].bytes)
            continue;
        result = ctx->vk.CreateBufferView(ctx->device,
                                          &(VkBufferViewCreateInfo){
                                              .sType = VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO,
                                              .buffer = buffer->buffer,
                                              .format = view->format,
                                              .offset = buffer->parts[view->part].offset,
                                              .range = buffer->parts[view->part].bytes,
                                          },
                                          ctx->allocator, &buffer->views[i]);
        if (result != VK_SUCCESS) {
            buffer->views[i] = VK_NULL_HANDLE;
            return vkao_vk_failed(&ctx->log, "vkCreateBufferView", result);
        }
    }
    vkao_set_name(ctx, VK_OBJECT_TYPE_BUFFER, (uint64_t)buffer->buffer, "vkao scratch");
    return VKAO_SUCCESS;
}

vkao_result scratch_bind(const vkao_context *ctx, struct scratch *scratch, VkDeviceMemory memory,
                         VkDeviceSize offset)
{
    static const char *const names[SCRATCH_COUNT] = {"vkao view z", "vkao noisy ao",
                                                     "vkao halfway ao", "vkao ao"};
    vkao_result result = VKAO_SUCCESS;
    if (scratch->buffer.buffer)
        result = bind_buffer(ctx, &scratch->buffer, memory, offset);
    for (int i = 0; result == VKAO_SUCCESS && i < SCRATCH_COUNT; ++i) {
        if (scratch->images[i].image)
            result = bind_image(ctx, &scratch->images[i], names[i], memory, offset);
    }
    return result;
}

void scratch_destroy(const vkao_context *ctx, struct scratch *scratch)
{
    for (uint32_t i = 0; i < SCRATCH_VIEWS; ++i) {
        if (scratch->buffer.views[i])
            ctx->vk.DestroyBufferView(ctx->device, scratch->buffer.views[i], ctx->allocator);
    }
    if (scratch->buffer.buffer)
        ctx->vk.DestroyBuffer(ctx->device, scratch->buffer.buffer, ctx->allocator);
    for (int i = 0; i < SCRATCH_COUNT; ++i) {
        if (scratch->images[i].view)
            ctx->vk.DestroyImageView(ctx->device, scratch->images[i].view, ctx->allocator);
        if (scratch->images[i].image)
            ctx->vk.DestroyImage(ctx->device, scratch->images[i].image, ctx->allocator);
    }
}
