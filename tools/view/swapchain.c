/* SPDX-License-Identifier: MIT */
#include "swapchain.h"

#include <stdlib.h>
#include <vulkan/vulkan.h>

/* --- What the surface offers --- */

static bool choose_format(struct swapchain *s, struct tool_error *err)
{
    static const VkFormat wanted[] = {VK_FORMAT_B8G8R8A8_UNORM, VK_FORMAT_R8G8B8A8_UNORM};
    VkSurfaceFormatKHR formats[64];
    uint32_t count = 64;
    VkResult result =
        vkGetPhysicalDeviceSurfaceFormatsKHR(s->gpu->physical_device, s->surface, &count, formats);
    if (result != VK_INCOMPLETE && !gpu_ok(err, "vkGetPhysicalDeviceSurfaceFormatsKHR", result))
        return false;
    for (size_t w = 0; w < sizeof wanted / sizeof *wanted; w++) {
        for (uint32_t i = 0; i < count; i++) {
            if (formats[i].format != wanted[w] ||
                formats[i].colorSpace != VK_COLOR_SPACE_SRGB_NONLINEAR_KHR)
                continue;
            s->format = formats[i].format;
            s->color_space = formats[i].colorSpace;
            return true;
        }
    }
    return fail(err, EXIT_DEVICE, "the display takes no 8-bit UNORM images");
}

static bool check_surface(struct swapchain *s, struct tool_error *err)
{
    VkBool32 supported = VK_FALSE;
    VkResult result = vkGetPhysicalDeviceSurfaceSupportKHR(
        s->gpu->physical_device, s->gpu->queue_family, s->surface, &supported);
    if (!gpu_ok(err, "vkGetPhysicalDeviceSurfaceSupportKHR", result))
        return false;
    return supported || fail(err, EXIT_DEVICE, "%s cannot present in this window",
                             s->gpu->properties.deviceName);
}

/* --- Made once --- */

static bool create_render_pass(struct swapchain *s, struct tool_error *err)
{
    const VkSubpassDependency dependencies[] = {
        /* The semaphore of the acquired image waits at this stage -> the layout may change. */
        {
            .srcSubpass = VK_SUBPASS_EXTERNAL,
            .dstSubpass = 0,
            .srcStageMask = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT,
            .dstStageMask = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT,
            .dstAccessMask = VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT,
        },
        /* Drawn -> a capture copies it, or the semaphore hands it to the display. */
        {
            .srcSubpass = 0,
            .dstSubpass = VK_SUBPASS_EXTERNAL,
            .srcStageMask = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT,
            .dstStageMask = VK_PIPELINE_STAGE_TRANSFER_BIT,
            .srcAccessMask = VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT,
            .dstAccessMask = VK_ACCESS_TRANSFER_READ_BIT,
        },
    };
    VkResult result =
        vkCreateRenderPass(s->gpu->device,
                           &(VkRenderPassCreateInfo){
                               .sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO,
                               .attachmentCount = 1,
                               .pAttachments =
                                   &(VkAttachmentDescription){
                                       .format = s->format,
                                       .samples = VK_SAMPLE_COUNT_1_BIT,
                                       .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
                                       .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
                                       .stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE,
                                       .stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
                                       .initialLayout = VK_IMAGE_LAYOUT_UNDEFINED,
                                       .finalLayout = VK_IMAGE_LAYOUT_PRESENT_SRC_KHR,
                                   },
                               .subpassCount = 1,
                               .pSubpasses =
                                   &(VkSubpassDescription){
                                       .pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS,
                                       .colorAttachmentCount = 1,
                                       .pColorAttachments =
                                           &(VkAttachmentReference){
                                               .attachment = 0,
                                               .layout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                                           },
                                   },
                               .dependencyCount = sizeof dependencies / sizeof *dependencies,
                               .pDependencies = dependencies,
                           },
                           NULL, &s->render_pass);
    return gpu_ok(err, "vkCreateRenderPass", result);
}

static bool create_frame(struct swapchain *s, struct frame_in_flight *f, struct tool_error *err)
{
    VkDevice device = s->gpu->device;
    const VkSemaphoreCreateInfo semaphore = {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
    VkResult result = vkCreateCommandPool(device,
                                          &(VkCommandPoolCreateInfo){
                                              .sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                              .flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT,
                                              .queueFamilyIndex = s->gpu->queue_family,
                                          },
                                          NULL, &f->pool);
    if (!gpu_ok(err, "vkCreateCommandPool", result))
        return false;
    result = vkAllocateCommandBuffers(device,
                                      &(VkCommandBufferAllocateInfo){
                                          .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                          .commandPool = f->pool,
                                          .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                          .commandBufferCount = 1,
                                      },
                                      &f->cmd);
    if (!gpu_ok(err, "vkAllocateCommandBuffers", result))
        return false;
    result = vkCreateFence(device,
                           &(VkFenceCreateInfo){
                               .sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO,
                               .flags = VK_FENCE_CREATE_SIGNALED_BIT,
                           },
                           NULL, &f->done);
    return gpu_ok(err, "vkCreateFence", result) &&
           gpu_ok(err, "vkCreateSemaphore",
                  vkCreateSemaphore(device, &semaphore, NULL, &f->acquired));
}

bool swapchain_create(struct gpu *gpu, VkSurfaceKHR surface, struct swapchain *swapchain,
                      struct tool_error *err)
{
    /* FIFO is the one that every display has. */
    *swapchain = (struct swapchain){
        .gpu = gpu, .surface = surface, .present_mode = VK_PRESENT_MODE_FIFO_KHR};
    bool ok = check_surface(swapchain, err) && choose_format(swapchain, err) &&
              create_render_pass(swapchain, err);
    for (uint32_t i = 0; ok && i < FRAMES_IN_FLIGHT; i++)
        ok = create_frame(swapchain, &swapchain->frames[i], err);
    if (!ok)
        swapchain_destroy(swapchain);
    return ok;
}

/* --- Made for each size --- */

static void destroy_images(struct swapchain *s)
{
    for (uint32_t i = 0; i < s->image_count; i++) {
        vkDestroyFramebuffer(s->gpu->device, s->images[i].framebuffer, NULL);
        vkDestroyImageView(s->gpu->device, s->images[i].view, NULL);
        vkDestroySemaphore(s->gpu->device, s->images[i].rendered, NULL);
        s->images[i] = (struct swapchain_image){0};
    }
    s->image_count = 0;
}

void swapchain_destroy(struct swapchain *swapchain)
{
    struct swapchain *s = swapchain;
    if (!s->gpu)
        return;
    VkDevice device = s->gpu->device;
    destroy_images(s);
    vkDestroySwapchainKHR(device, s->handle, NULL);
    for (uint32_t i = 0; i < FRAMES_IN_FLIGHT; i++) {
        vkDestroyCommandPool(device, s->frames[i].pool, NULL);
        vkDestroyFence(device, s->frames[i].done, NULL);
        vkDestroySemaphore(device, s->frames[i].acquired, NULL);
    }
    vkDestroyRenderPass(device, s->render_pass, NULL);
    *s = (struct swapchain){0};
}

static bool create_image(struct swapchain *s, struct swapchain_image *image, struct tool_error *err)
{
    VkDevice device = s->gpu->device;
    VkResult result =
        vkCreateImageView(device,
                          &(VkImageViewCreateInfo){
                              .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                              .image = image->image,
                              .viewType = VK_IMAGE_VIEW_TYPE_2D,
                              .format = s->format,
                              .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1},
                          },
                          NULL, &image->view);
    if (!gpu_ok(err, "vkCreateImageView", result))
        return false;
    result = vkCreateFramebuffer(device,
                                 &(VkFramebufferCreateInfo){
                                     .sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO,
                                     .renderPass = s->render_pass,
                                     .attachmentCount = 1,
                                     .pAttachments = &image->view,
                                     .width = s->extent.width,
                                     .height = s->extent.height,
                                     .layers = 1,
                                 },
                                 NULL, &image->framebuffer);
    if (!gpu_ok(err, "vkCreateFramebuffer", result))
        return false;
    result = vkCreateSemaphore(
        device, &(VkSemaphoreCreateInfo){.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO}, NULL,
        &image->rendered);
    return gpu_ok(err, "vkCreateSemaphore", result);
}

static bool create_images(struct swapchain *s, struct tool_error *err)
{
    VkImage images[MAX_SWAPCHAIN_IMAGES];
    uint32_t count = MAX_SWAPCHAIN_IMAGES;
    VkResult result = vkGetSwapchainImagesKHR(s->gpu->device, s->handle, &count, images);
    if (!gpu_ok(err, "vkGetSwapchainImagesKHR", result))
        return false;
    for (uint32_t i = 0; i < count; i++) {
        s->images[i].image = images[i];
        s->image_count = i + 1; /* a half-made one is destroyed with the others */
        if (!create_image(s, &s->images[i], err))
            return false;
    }
    return true;
}

static uint32_t clamp(uint32_t value, uint32_t low, uint32_t high)
{
    return value < low ? low : value > high ? high : value;
}

bool swapchain_resize(struct swapchain *swapchain, VkExtent2D framebuffer, struct tool_error *err)
{
    struct swapchain *s = swapchain;
    VkSurfaceCapabilitiesKHR can;
    VkResult result = vkDeviceWaitIdle(s->gpu->device);
    if (!gpu_ok(err, "vkDeviceWaitIdle", result))
        return false;
    result = vkGetPhysicalDeviceSurfaceCapabilitiesKHR(s->gpu->physical_device, s->surface, &can);
    if (!gpu_ok(err, "vkGetPhysicalDeviceSurfaceCapabilitiesKHR", result))
        return false;
    VkExtent2D extent = can.currentExtent;
    if (extent.width == UINT32_MAX) {
        extent.width = clamp(framebuffer.width, can.minImageExtent.width, can.maxImageExtent.width);
        extent.height =
            clamp(framebuffer.height, can.minImageExtent.height, can.maxImageExtent.height);
    }
    if (extent.width == 0 || extent.height == 0)
        return false;
    uint32_t count = can.minImageCount + 1;
    if (can.maxImageCount > 0 && count > can.maxImageCount)
        count = can.maxImageCount;
    s->can_capture = can.supportedUsageFlags & VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    VkSwapchainKHR old = s->handle;
    destroy_images(s);
    result = vkCreateSwapchainKHR(
        s->gpu->device,
        &(VkSwapchainCreateInfoKHR){
            .sType = VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR,
            .surface = s->surface,
            .minImageCount = count,
            .imageFormat = s->format,
            .imageColorSpace = s->color_space,
            .imageExtent = extent,
            .imageArrayLayers = 1,
            .imageUsage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT |
                          (s->can_capture ? VK_IMAGE_USAGE_TRANSFER_SRC_BIT : 0u),
            .imageSharingMode = VK_SHARING_MODE_EXCLUSIVE,
            .preTransform = can.currentTransform,
            .compositeAlpha = VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR,
            .presentMode = s->present_mode,
            .clipped = VK_FALSE, /* captures want every texel */
            .oldSwapchain = old,
        },
        NULL, &s->handle);
    vkDestroySwapchainKHR(s->gpu->device, old, NULL);
    if (result != VK_SUCCESS) {
        s->handle = VK_NULL_HANDLE;
        return gpu_ok(err, "vkCreateSwapchainKHR", result);
    }
    s->extent = extent;
    s->is_stale = false;
    return create_images(s, err);
}

/* --- Frames --- */

static enum swapchain_status status_of(VkResult result, const char *call, struct tool_error *err)
{
    if (result == VK_ERROR_OUT_OF_DATE_KHR)
        return SWAPCHAIN_STALE;
    return gpu_ok(err, call, result) ? SWAPCHAIN_OK : SWAPCHAIN_FAILED;
}

bool swapchain_wait(struct swapchain *swapchain, struct tool_error *err)
{
    const struct frame_in_flight *f = &swapchain->frames[swapchain->frame];
    return gpu_ok(err, "vkWaitForFences",
                  vkWaitForFences(swapchain->gpu->device, 1, &f->done, VK_TRUE, UINT64_MAX));
}

enum swapchain_status swapchain_begin(struct swapchain *swapchain, VkCommandBuffer *cmd,
                                      struct tool_error *err)
{
    struct swapchain *s = swapchain;
    struct frame_in_flight *f = &s->frames[s->frame];
    if (!s->handle)
        return SWAPCHAIN_STALE;
    VkResult result = vkAcquireNextImageKHR(s->gpu->device, s->handle, UINT64_MAX, f->acquired,
                                            VK_NULL_HANDLE, &s->image);
    /* A suboptimal image is acquired all the same: it is drawn, and the presentation says so
     * again. */
    if (result != VK_SUBOPTIMAL_KHR && result != VK_SUCCESS)
        return status_of(result, "vkAcquireNextImageKHR", err);
    if (!gpu_ok(err, "vkResetCommandPool", vkResetCommandPool(s->gpu->device, f->pool, 0)))
        return SWAPCHAIN_FAILED;
    result = vkBeginCommandBuffer(f->cmd, &(VkCommandBufferBeginInfo){
                                              .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                              .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT,
                                          });
    *cmd = f->cmd;
    return status_of(result, "vkBeginCommandBuffer", err);
}

void swapchain_begin_pass(const struct swapchain *swapchain, VkCommandBuffer cmd,
                          const float clear[4])
{
    const VkRect2D area = {.extent = swapchain->extent};
    vkCmdBeginRenderPass(
        cmd,
        &(VkRenderPassBeginInfo){
            .sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO,
            .renderPass = swapchain->render_pass,
            .framebuffer = swapchain->images[swapchain->image].framebuffer,
            .renderArea = area,
            .clearValueCount = 1,
            .pClearValues =
                &(VkClearValue){.color = {.float32 = {clear[0], clear[1], clear[2], clear[3]}}},
        },
        VK_SUBPASS_CONTENTS_INLINE);
    vkCmdSetViewport(cmd, 0, 1,
                     &(VkViewport){
                         .width = (float)swapchain->extent.width,
                         .height = (float)swapchain->extent.height,
                         .maxDepth = 1.0f,
                     });
    vkCmdSetScissor(cmd, 0, 1, &area);
}

static void change_layout(VkCommandBuffer cmd, VkImage image, VkImageLayout from, VkImageLayout to,
                          VkAccessFlags before, VkAccessFlags after)
{
    vkCmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0,
                         NULL, 0, NULL, 1,
                         &(VkImageMemoryBarrier){
                             .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
                             .srcAccessMask = before,
                             .dstAccessMask = after,
                             .oldLayout = from,
                             .newLayout = to,
                             .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                             .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                             .image = image,
                             .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1},
                         });
}

void swapchain_capture(const struct swapchain *swapchain, VkCommandBuffer cmd, VkBuffer buffer)
{
    VkImage image = swapchain->images[swapchain->image].image;
    change_layout(cmd, image, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                  VK_ACCESS_TRANSFER_READ_BIT, VK_ACCESS_TRANSFER_READ_BIT);
    vkCmdCopyImageToBuffer(
        cmd, image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, buffer, 1,
        &(VkBufferImageCopy){
            .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
            .imageExtent = {swapchain->extent.width, swapchain->extent.height, 1},
        });
    change_layout(cmd, image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR,
                  VK_ACCESS_TRANSFER_READ_BIT, 0);
}

enum swapchain_status swapchain_end(struct swapchain *swapchain, struct tool_error *err)
{
    struct swapchain *s = swapchain;
    struct frame_in_flight *f = &s->frames[s->frame];
    VkSemaphore rendered = s->images[s->image].rendered;
    if (!gpu_ok(err, "vkEndCommandBuffer", vkEndCommandBuffer(f->cmd)) ||
        !gpu_ok(err, "vkResetFences", vkResetFences(s->gpu->device, 1, &f->done)))
        return SWAPCHAIN_FAILED;
    /* Compute does not touch the window's image and need not wait for it. */
    const VkPipelineStageFlags wait = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT;
    VkResult result = vkQueueSubmit(s->gpu->queue, 1,
                                    &(VkSubmitInfo){
                                        .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                                        .waitSemaphoreCount = 1,
                                        .pWaitSemaphores = &f->acquired,
                                        .pWaitDstStageMask = &wait,
                                        .commandBufferCount = 1,
                                        .pCommandBuffers = &f->cmd,
                                        .signalSemaphoreCount = 1,
                                        .pSignalSemaphores = &rendered,
                                    },
                                    f->done);
    if (!gpu_ok(err, "vkQueueSubmit", result))
        return SWAPCHAIN_FAILED;
    s->frame = (s->frame + 1) % FRAMES_IN_FLIGHT;
    result = vkQueuePresentKHR(s->gpu->queue, &(VkPresentInfoKHR){
                                                  .sType = VK_STRUCTURE_TYPE_PRESENT_INFO_KHR,
                                                  .waitSemaphoreCount = 1,
                                                  .pWaitSemaphores = &rendered,
                                                  .swapchainCount = 1,
                                                  .pSwapchains = &s->handle,
                                                  .pImageIndices = &s->image,
                                              });
    return result == VK_SUBOPTIMAL_KHR ? SWAPCHAIN_STALE
                                       : status_of(result, "vkQueuePresentKHR", err);
}
