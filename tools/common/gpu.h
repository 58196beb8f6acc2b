/* SPDX-License-Identifier: MIT
 *
 * A Vulkan device for tools and tests: instance, device, one compute queue, images to upload and
 * download. Everything waits until it is done: simple first, and the tools overlap I/O with compute
 * by threads. */
#ifndef VKAO_TOOLS_GPU_H_
#define VKAO_TOOLS_GPU_H_

#include "error.h"
#include "vkao.h"

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

struct gpu {
    VkInstance instance;
    VkPhysicalDevice physical_device;
    VkDevice device;
    VkQueue queue;
    uint32_t queue_family;
    uint32_t timestamp_bits; /* of the queue's timestamps that count; 0 = it has none */
    VkCommandPool command_pool;
    VkDebugUtilsMessengerEXT messenger;
    VkPhysicalDeviceProperties properties;
    VkPhysicalDeviceMemoryProperties memory;
    VkDeviceSize max_allocation; /* maxMemoryAllocationSize */
    /* As enabled; the first is the head of the chain. */
    VkPhysicalDeviceFeatures2 features;
    VkPhysicalDevice16BitStorageFeatures storage_features;
    uint32_t validation_messages; /* warnings and errors of the validation layers so far */
    bool print_validation;
};

/* What a device needs that shows pictures in a window; surface and swapchain are the caller's. */
struct gpu_presentation {
    const char *const *instance_extensions; /* of the window system */
    uint32_t instance_extension_count;
    /* Whether a queue family can present. The family also has graphics, and VK_KHR_swapchain is
     * enabled. */
    bool (*supported)(VkInstance instance, VkPhysicalDevice device, uint32_t queue_family);
};

struct gpu_options {
    /* NULL or "auto": a discrete GPU, else an integrated one, else the CPU. "cpu": a software
     * device (lavapipe). A number: index in `vkao devices`. Anything else: the first device whose
     * name contains it. */
    const char *device;
    /* core, synchronization and queue-submit validation; fails if the layer is missing */
    bool validation;
    /* NULL: compute alone. Read during gpu_create only */
    const struct gpu_presentation *presentation;
};

struct gpu_device_list {
    uint32_t count;
    VkPhysicalDeviceProperties *properties; /* free with gpu_device_list_free */
};

bool gpu_create(const struct gpu_options *options, struct gpu *gpu, struct tool_error *err);
void gpu_destroy(struct gpu *gpu);

bool gpu_list_devices(struct gpu_device_list *list, struct tool_error *err);
void gpu_device_list_free(struct gpu_device_list *list);
/* "discrete GPU", "CPU" ... */
const char *gpu_device_type_name(VkPhysicalDeviceType type);

/* A 2D image with its own memory; created in, and always returned to, VK_IMAGE_LAYOUT_GENERAL. */
struct gpu_image {
    VkImage image;
    VkImageView view;
    VkDeviceMemory memory;
    VkFormat format;
    VkExtent2D extent;
};

/* Errors: EXIT_DEVICE, naming the limit, for what the device says beforehand that it cannot hold;
 * EXIT_MEMORY. */
bool gpu_image_create(struct gpu *gpu, VkFormat format, VkExtent2D extent, VkImageUsageFlags usage,
                      struct gpu_image *image, struct tool_error *err);
void gpu_image_destroy(struct gpu *gpu, struct gpu_image *image);
/* Tightly packed rows in the image's own format. bytes must be the image's size. */
bool gpu_image_upload(struct gpu *gpu, struct gpu_image *image, const void *data, uint64_t bytes,
                      struct tool_error *err);
bool gpu_image_download(struct gpu *gpu, struct gpu_image *image, void *data, uint64_t bytes,
                        struct tool_error *err);
/* The slot of a vkao_images for it, in GENERAL. */
vkao_image gpu_image_slot(const struct gpu_image *image);
/* 0 for formats that the tools do not use. */
uint32_t gpu_format_bytes(VkFormat format);
/* Memory of a type that fits need and has all flags; free it with vkFreeMemory. */
bool gpu_allocate(struct gpu *gpu, const VkMemoryRequirements *need, VkMemoryPropertyFlags flags,
                  VkDeviceMemory *memory, struct tool_error *err);

/* Host memory that the device copies from or to: visible, coherent, mapped as long as it lives. */
struct gpu_buffer {
    VkBuffer buffer;
    VkDeviceMemory memory;
    void *mapped;
};

bool gpu_buffer_create(struct gpu *gpu, uint64_t bytes, VkBufferUsageFlags usage,
                       struct gpu_buffer *buffer, struct tool_error *err);
void gpu_buffer_destroy(struct gpu *gpu, struct gpu_buffer *buffer);

/* A command buffer in recording state; gpu_submit ends, runs, waits for and frees it. */
VkCommandBuffer gpu_begin(struct gpu *gpu, struct tool_error *err);
bool gpu_submit(struct gpu *gpu, VkCommandBuffer cmd, struct tool_error *err);
/* Milliseconds between two timestamps of the queue. */
double gpu_ms_between(const struct gpu *gpu, uint64_t first, uint64_t second);
/* Makes every earlier write visible to every later access on the queue. */
void gpu_full_barrier(VkCommandBuffer cmd);

/* A vkao context on this device; log lines go to stderr. Destroy it before the gpu. */
vkao_context *gpu_context(struct gpu *gpu, struct tool_error *err);
/* The two halves of gpu_context, for those who change something in between. The info points into
 * gpu. */
vkao_context_info gpu_context_info(struct gpu *gpu);
vkao_context *gpu_context_create(const vkao_context_info *info, struct tool_error *err);
/* True if result is VK_SUCCESS; else the error of the call: EXIT_MEMORY or EXIT_DEVICE. */
bool gpu_ok(struct tool_error *err, const char *call, VkResult result);
/* The error of a library call that returned result. */
bool gpu_library_failed(struct tool_error *err, const char *call, vkao_result result);

#ifdef __cplusplus
}
#endif
#endif
