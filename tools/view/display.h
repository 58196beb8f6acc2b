/* SPDX-License-Identifier: MIT
 *
 * The pass that draws images into the window. */
#ifndef VKAO_VIEW_DISPLAY_H_
#define VKAO_VIEW_DISPLAY_H_

#include "gpu.h"
#include "shaders/display.h"
#include "swapchain.h"

/* VK_NULL_HANDLE = not shown. In VK_IMAGE_LAYOUT_GENERAL. */
struct display_images {
    VkImageView bindings[DISPLAY_BINDINGS];
};

struct display {
    struct gpu *gpu;
    VkDescriptorSetLayout set_layout;
    VkPipelineLayout pipeline_layout;
    VkPipeline pipeline;
    VkDescriptorPool pool;
    VkSampler sampler;
    struct gpu_image nothing; /* where there is no image */
    VkDescriptorSet sets[FRAMES_IN_FLIGHT];
    struct display_images bound[FRAMES_IN_FLIGHT];
};

/* Errors: EXIT_DEVICE, EXIT_MEMORY. On failure there is nothing to destroy. */
bool display_create(struct gpu *gpu, VkRenderPass pass, struct display *display,
                    struct tool_error *err);
void display_destroy(struct display *display);
/* frame: index of the frame in flight, which must not be pending. */
void display_bind(struct display *display, uint32_t frame, const struct display_images *images);
/* After an image was destroyed: its handle may come back as another image. */
void display_forget(struct display *display);
/* Inside the render pass. Images are visible to FRAGMENT_SHADER. */
void display_draw(const struct display *display, VkCommandBuffer cmd, uint32_t frame,
                  const struct display_block *block);

#endif
