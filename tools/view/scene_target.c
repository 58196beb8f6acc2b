/* SPDX-License-Identifier: MIT
 *
 * The images that a scene is rendered into, and the render pass that orders access to them. */
#include "scene_internal.h"

#include <vulkan/vulkan.h>

const VkFormat live_formats[ATTACHMENT_COUNT] = {
    [ATTACHMENT_NORMALS] = VK_FORMAT_A2B10G10R10_UNORM_PACK32,
    [ATTACHMENT_INDIRECT] = VK_FORMAT_R16G16B16A16_SFLOAT,
    [ATTACHMENT_DIRECT] = VK_FORMAT_R16G16B16A16_SFLOAT,
    [ATTACHMENT_ALBEDO] = VK_FORMAT_R8G8B8A8_UNORM,
    [ATTACHMENT_DEPTH] = VK_FORMAT_D32_SFLOAT,
};

/* Where the render pass leaves them. */
static const VkImageLayout final_layouts[ATTACHMENT_COUNT] = {
    [ATTACHMENT_NORMALS] = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
    [ATTACHMENT_INDIRECT] = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
    [ATTACHMENT_DIRECT] = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
    [ATTACHMENT_ALBEDO] = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
    [ATTACHMENT_DEPTH] = VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL,
};

static const VkPipelineStageFlags render_stages = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT |
                                                  VK_PIPELINE_STAGE_EARLY_FRAGMENT_TESTS_BIT |
                                                  VK_PIPELINE_STAGE_LATE_FRAGMENT_TESTS_BIT;
static const VkAccessFlags render_writes =
    VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;
/* vkao, a viewer that shows an image as it is, and one that copies it. */
static const VkPipelineStageFlags reader_stages = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT |
                                                  VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT |
                                                  VK_PIPELINE_STAGE_TRANSFER_BIT;

bool live_pass_create(struct gpu *gpu, VkRenderPass *pass, struct tool_error *err)
{
    VkAttachmentDescription attachments[ATTACHMENT_COUNT];
    VkAttachmentReference colors[ATTACHMENT_COLORS];
    for (uint32_t i = 0; i < ATTACHMENT_COUNT; ++i) {
        attachments[i] = (VkAttachmentDescription){
            .format = live_formats[i],
            .samples = VK_SAMPLE_COUNT_1_BIT,
            .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
            .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
            .stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE,
            .stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
            .initialLayout = VK_IMAGE_LAYOUT_UNDEFINED, /* what the last frame left is not needed */
            .finalLayout = final_layouts[i],
        };
        if (i < ATTACHMENT_COLORS)
            colors[i] = (VkAttachmentReference){i, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
    }
    const VkSubpassDescription subpass = {
        .pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS,
        .colorAttachmentCount = ATTACHMENT_COLORS,
        .pColorAttachments = colors,
        .pDepthStencilAttachment =
            &(VkAttachmentReference){ATTACHMENT_DEPTH,
                                     VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL},
    };
    const VkSubpassDependency dependencies[2] = {
        /* the last frame's readers, or its render pass if nobody read -> clearing */
        {
            .srcSubpass = VK_SUBPASS_EXTERNAL,
            .dstSubpass = 0,
            .srcStageMask = reader_stages | render_stages,
            .dstStageMask = render_stages,
            .srcAccessMask = render_writes,
            .dstAccessMask = render_writes | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_READ_BIT,
        },
        /* the render pass wrote them -> vkao and the viewer read */
        {
            .srcSubpass = 0,
            .dstSubpass = VK_SUBPASS_EXTERNAL,
            .srcStageMask = render_stages,
            .dstStageMask = reader_stages,
            .srcAccessMask = render_writes,
            .dstAccessMask = VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_TRANSFER_READ_BIT,
        },
    };
    VkResult result = vkCreateRenderPass(gpu->device,
                                         &(VkRenderPassCreateInfo){
                                             .sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO,
                                             .attachmentCount = ATTACHMENT_COUNT,
                                             .pAttachments = attachments,
                                             .subpassCount = 1,
                                             .pSubpasses = &subpass,
                                             .dependencyCount = 2,
                                             .pDependencies = dependencies,
                                         },
                                         NULL, pass);
    if (result == VK_SUCCESS)
        return true;
    *pass = VK_NULL_HANDLE;
    return gpu_ok(err, "vkCreateRenderPass", result);
}

/* The target's image for each attachment. */
static void list_images(struct live_target *target, struct gpu_image *images[ATTACHMENT_COUNT])
{
    images[ATTACHMENT_NORMALS] = &target->normals;
    images[ATTACHMENT_INDIRECT] = &target->indirect;
    images[ATTACHMENT_DIRECT] = &target->direct;
    images[ATTACHMENT_ALBEDO] = &target->albedo;
    images[ATTACHMENT_DEPTH] = &target->depth;
}

static bool create_framebuffer(struct live_target *target, const VkImageView *views,
                               struct tool_error *err)
{
    VkResult result = vkCreateFramebuffer(target->scene->gpu->device,
                                          &(VkFramebufferCreateInfo){
                                              .sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO,
                                              .renderPass = target->scene->pass,
                                              .attachmentCount = ATTACHMENT_COUNT,
                                              .pAttachments = views,
                                              .width = target->extent.width,
                                              .height = target->extent.height,
                                              .layers = 1,
                                          },
                                          NULL, &target->framebuffer);
    if (result == VK_SUCCESS)
        return true;
    target->framebuffer = VK_NULL_HANDLE;
    return gpu_ok(err, "vkCreateFramebuffer", result);
}

bool live_target_create(struct live_scene *scene, VkExtent2D extent, struct live_target *target,
                        struct tool_error *err)
{
    struct gpu_image *images[ATTACHMENT_COUNT];
    VkImageView views[ATTACHMENT_COUNT];
    bool ok = true;
    *target = (struct live_target){.scene = scene, .extent = extent};
    list_images(target, images);
    for (uint32_t i = 0; ok && i < ATTACHMENT_COUNT; ++i) {
        VkImageUsageFlags usage = i == ATTACHMENT_DEPTH
                                      ? VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT
                                      : VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
        ok = gpu_image_create(scene->gpu, live_formats[i], extent,
                              usage | VK_IMAGE_USAGE_SAMPLED_BIT, images[i], err);
        views[i] = images[i]->view;
    }
    if (ok && create_framebuffer(target, views, err))
        return true;
    live_target_destroy(target);
    return false;
}

void live_target_destroy(struct live_target *target)
{
    struct gpu_image *images[ATTACHMENT_COUNT];
    if (!target->scene)
        return;
    vkDestroyFramebuffer(target->scene->gpu->device, target->framebuffer, NULL);
    list_images(target, images);
    for (uint32_t i = 0; i < ATTACHMENT_COUNT; ++i)
        gpu_image_destroy(target->scene->gpu, images[i]);
    *target = (struct live_target){0};
}

static vkao_image slot(const struct gpu_image *image, enum live_attachment attachment)
{
    return (vkao_image){image->view, final_layouts[attachment], image->format, VK_NULL_HANDLE};
}

void live_target_images(const struct live_target *target, vkao_images *images)
{
    images->depth = slot(&target->depth, ATTACHMENT_DEPTH);
    images->normals = slot(&target->normals, ATTACHMENT_NORMALS);
    images->color = slot(&target->indirect, ATTACHMENT_INDIRECT);
    images->direct = slot(&target->direct, ATTACHMENT_DIRECT);
    images->albedo = slot(&target->albedo, ATTACHMENT_ALBEDO);
}
