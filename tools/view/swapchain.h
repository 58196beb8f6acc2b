/* SPDX-License-Identifier: MIT
 *
 * Images of a window, and the frames in flight that draw into them. Two frames are in flight at
 * most: while the device draws one, the next is recorded. */
#ifndef VKAO_VIEW_SWAPCHAIN_H_
#define VKAO_VIEW_SWAPCHAIN_H_

#include "gpu.h"

enum { FRAMES_IN_FLIGHT = 2, MAX_SWAPCHAIN_IMAGES = 16 };

struct swapchain_image {
    VkImage image;
    VkImageView view;
    VkFramebuffer framebuffer;
    VkSemaphore rendered; /* signalled for the presentation */
};

struct frame_in_flight {
    VkCommandPool pool;
    VkCommandBuffer cmd;
    VkFence done; /* signalled whenever the frame is not in flight */
    VkSemaphore acquired;
};

struct swapchain {
    struct gpu *gpu;
    VkSurfaceKHR surface;
    VkFormat format; /* UNORM: what is computed is what is shown */
    VkColorSpaceKHR color_space;
    VkPresentModeKHR present_mode;
    bool can_capture; /* images may be copied from */
    VkRenderPass render_pass;
    VkSwapchainKHR handle; /* VK_NULL_HANDLE until the first swapchain_resize */
    VkExtent2D extent;
    bool is_stale; /* the display wants other images: resize before the next frame */
    uint32_t image_count;
    struct swapchain_image images[MAX_SWAPCHAIN_IMAGES];
    struct frame_in_flight frames[FRAMES_IN_FLIGHT];
    uint32_t frame; /* index of the one that is being recorded */
    uint32_t image; /* index of the image that it draws into */
};

/* The surface stays the caller's. Errors: EXIT_DEVICE, EXIT_MEMORY. On failure there is nothing to
 * destroy. */
bool swapchain_create(struct gpu *gpu, VkSurfaceKHR surface, struct swapchain *swapchain,
                      struct tool_error *err);
/* Its frames must not be in flight any more. */
void swapchain_destroy(struct swapchain *swapchain);
/* New images of the window's size; waits for the device. False without an error in err: the surface
 * has no size now, as that of a minimised window. */
bool swapchain_resize(struct swapchain *swapchain, VkExtent2D framebuffer, struct tool_error *err);

enum swapchain_status {
    SWAPCHAIN_OK,
    SWAPCHAIN_STALE /* resize it and try again */,
    SWAPCHAIN_FAILED
};

/* Waits until the frame in flight that comes next is done with what it used. */
bool swapchain_wait(struct swapchain *swapchain, struct tool_error *err);
/* After swapchain_wait: waits until an image is there, and begins the frame's command buffer. */
enum swapchain_status swapchain_begin(struct swapchain *swapchain, VkCommandBuffer *cmd,
                                      struct tool_error *err);
/* The render pass that clears the image, draws and leaves it ready to present. */
void swapchain_begin_pass(const struct swapchain *swapchain, VkCommandBuffer cmd,
                          const float clear[4]);
/* Records a copy of the drawn image; after the pass. The buffer holds 4 bytes per texel, in the
 * order of the format. */
void swapchain_capture(const struct swapchain *swapchain, VkCommandBuffer cmd, VkBuffer buffer);
/* Submits and presents. */
enum swapchain_status swapchain_end(struct swapchain *swapchain, struct tool_error *err);

#endif
