/* SPDX-License-Identifier: MIT
 *
 * The descriptor set of a frame: one descriptor per binding that its stages use. */
#include "internal.h"

struct image_binding {
    uint32_t binding;
    bool used;
    vkao_image image;
};

static vkao_image scratch_of(const vkao_frame *frame, enum scratch_slot i)
{
    const struct scratch_image *s = &frame->scratch.images[i];
    return (vkao_image){s->view, VK_IMAGE_LAYOUT_GENERAL, s->format};
}

/* Shaders statically use a few slots that may be absent (normals, color, direct; images where AO goes through buffers);
 * those bindings repeat another image, which is never touched there. */
static void describe_images(const vkao_frame *frame, struct image_binding table[VKAO_BINDING_COUNT])
{
    const vkao_images *images = &frame->images;
    const bool has_ssao = frame->stages & VKAO_STAGE_SSAO,
               has_blur = frame->stages & VKAO_STAGE_BLUR,
               composite = frame->stages & VKAO_STAGE_COMPOSITE;
    const bool makes_ao = has_ssao || has_blur, packed = frame->packed;
    const vkao_image ao = images->ao.format ? images->ao : scratch_of(frame, SCRATCH_AO);
    const vkao_image halfway = packed ? ao : scratch_of(frame, SCRATCH_HALFWAY);
    vkao_image noisy = images->ao_noisy;
    if (!has_blur || packed)
        noisy = ao; /* without BLUR, SSAO writes the final image itself */
    else if (!noisy.format)
        noisy = scratch_of(frame, SCRATCH_NOISY);
    /* BLUR alone reads the caller's image and has no use for writing it, but the shader names the binding. */
    const vkao_image noisy_write = has_ssao ? noisy : halfway;
    const vkao_image color = images->color.format ? images->color : ao;
    const vkao_image stand_in = makes_ao ? images->depth : ao;
    const vkao_image rows[VKAO_BINDING_COUNT] = {
        [VKAO_BINDING_DEPTH] = images->depth,
        [VKAO_BINDING_NORMALS] = images->normals.format ? images->normals : stand_in,
        [VKAO_BINDING_VIEW_Z] = scratch_of(frame, SCRATCH_VIEW_Z),
        [VKAO_BINDING_NOISY_WRITE] = noisy_write,
        [VKAO_BINDING_NOISY_READ] = has_blur ? noisy : ao,
        [VKAO_BINDING_HALFWAY_WRITE] = halfway,
        [VKAO_BINDING_HALFWAY_READ] = halfway,
        [VKAO_BINDING_AO_WRITE] = ao,
        [VKAO_BINDING_AO_READ] = ao,
        [VKAO_BINDING_COLOR] = color,
        [VKAO_BINDING_DIRECT] = images->direct.format ? images->direct : color,
        [VKAO_BINDING_OUTPUT] = images->output,
        [VKAO_BINDING_BENT_WRITE] = frame_has_bent_normals(frame) ? images->bent_normals : ao,
        [VKAO_BINDING_BENT_READ] = images->bent_normals.format ? images->bent_normals : ao,
        [VKAO_BINDING_ALBEDO] = images->albedo.format ? images->albedo : ao,
        [VKAO_BINDING_SPECULAR] = images->specular.format ? images->specular : ao,
    };
    const bool blurs_images = has_blur && !packed;
    const bool used[VKAO_BINDING_COUNT] = {
        [VKAO_BINDING_DEPTH] = makes_ao,
        [VKAO_BINDING_NORMALS] = makes_ao || composite,
        [VKAO_BINDING_VIEW_Z] = makes_ao && !frame->ctx->buffers,
        [VKAO_BINDING_NOISY_WRITE] = makes_ao,
        [VKAO_BINDING_NOISY_READ] = blurs_images || composite,
        [VKAO_BINDING_HALFWAY_WRITE] = blurs_images,
        [VKAO_BINDING_HALFWAY_READ] = blurs_images,
        [VKAO_BINDING_AO_WRITE] = has_blur,
        [VKAO_BINDING_AO_READ] = composite,
        [VKAO_BINDING_COLOR] = composite,
        [VKAO_BINDING_DIRECT] = composite,
        [VKAO_BINDING_OUTPUT] = composite,
        [VKAO_BINDING_BENT_WRITE] = has_blur,
        [VKAO_BINDING_BENT_READ] = composite,
        [VKAO_BINDING_ALBEDO] = composite,
        [VKAO_BINDING_SPECULAR] = composite,
    };
    for (uint32_t i = 0; i < VKAO_BINDING_COUNT; ++i)
        table[i] = (struct image_binding){i, used[i], rows[i]};
}

void descriptors_write(const vkao_frame *frame)
{
    const struct scratch_buffer *buffer = &frame->scratch.buffer;
    struct image_binding table[VKAO_BINDING_COUNT];
    VkDescriptorImageInfo images[VKAO_BINDING_COUNT];
    VkDescriptorBufferInfo buffers[VKAO_BINDING_COUNT];
    VkWriteDescriptorSet writes[VKAO_BINDING_COUNT];
    uint32_t count = 0;
    describe_images(frame, table);
    for (uint32_t i = 0; i < VKAO_BINDING_COUNT; ++i) {
        const struct scratch_view *view = scratch_view(i);
        if (view ? !buffer->parts[view->part].bytes : !table[i].used)
            continue;
        images[count] = (VkDescriptorImageInfo){.imageView = table[i].image.view,
                                                .imageLayout = table[i].image.layout};
        writes[count] = (VkWriteDescriptorSet){
            .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
            .dstSet = frame->set,
            .dstBinding = i,
            .descriptorCount = 1,
            .descriptorType = binding_type(i),
            .pImageInfo = &images[count],
        };
        if (view) {
            buffers[count] = (VkDescriptorBufferInfo){
                buffer->buffer, buffer->parts[view->part].offset, buffer->parts[view->part].bytes};
            writes[count].pImageInfo = NULL;
            writes[count].pBufferInfo = &buffers[count];
            writes[count].pTexelBufferView = &buffer->views[i - VKAO_BINDING_Z];
        }
        ++count;
    }
    frame->ctx->vk.UpdateDescriptorSets(frame->ctx->device, count, writes, 0, NULL);
}

vkao_result descriptors_create(vkao_frame *frame)
{
    const vkao_context *ctx = frame->ctx;
    const VkDescriptorPoolSize sizes[] = {
        {VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE, VKAO_BINDING_COUNT},
        {VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, VKAO_BINDING_COUNT},
        {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, SCRATCH_VIEWS},
        {VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER, SCRATCH_VIEWS},
    };
    VkResult result =
        ctx->vk.CreateDescriptorPool(ctx->device,
                                     &(VkDescriptorPoolCreateInfo){
                                         .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                         .maxSets = 1,
                                         .poolSizeCount = sizeof sizes / sizeof sizes[0],
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
                                           .descriptorSetCount = 1,
                                           .pSetLayouts = &ctx->set_layout,
                                       },
                                       &frame->set);
    if (result != VK_SUCCESS)
        return vkao_vk_failed(&ctx->log, "vkAllocateDescriptorSets", result);
    descriptors_write(frame);
    return VKAO_SUCCESS;
}
