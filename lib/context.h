/* SPDX-License-Identifier: MIT
 *
 * What is known of a device, and what every other part asks of it: host memory, names, logging. */
#ifndef VKAO_CONTEXT_H_
#define VKAO_CONTEXT_H_

#include "log.h"
#include "vk.h"

#include <stdatomic.h>

/* Of all effects of a context, see pipelines.h. The flag is set by who goes through the list. */
struct vkao_shared_pipelines {
    atomic_flag is_busy;
    struct vkao_pipelines *first;
};

struct vkao_context {
    struct vk_table vk;
    struct vkao_logger log;
    vkao_mark_fn mark;
    void *mark_user_data;
    VkDevice device;
    VkPhysicalDevice physical_device;
    VkPhysicalDeviceMemoryProperties memory;
    VkAllocationCallbacks allocator_copy;
    const VkAllocationCallbacks *allocator; /* &allocator_copy or NULL */
    uint32_t max_image;                     /* maxImageDimension2D */
    uint32_t max_dimension;                 /* of a frame */
    uint32_t max_texels, max_buffer;        /* of a texel buffer; bytes of a storage buffer */
    VkDeviceSize granularity;               /* between images and buffers in one memory */
    bool is_cpu;                            /* and can do what the CPU's passes want */
    bool has_16bit_storage;
    /* Effects and frames that live, and what effects share. What changes is behind pointers, so
     * that contexts can be const. */
    atomic_uint *live, live_count;
    struct vkao_shared_pipelines *shared, shared_pipelines;
};

/* Host memory through the caller's callbacks, zeroed; NULL when there is none. */
void *vkao_calloc(const VkAllocationCallbacks *allocator, size_t bytes);
void vkao_free(const VkAllocationCallbacks *allocator, void *memory);

/* For debuggers, if the caller asked for names. */
void vkao_set_name(const vkao_context *ctx, VkObjectType type, uint64_t handle, const char *name);

/* Can scratch images of this format be written and sampled? */
bool vkao_scratch_can(const vkao_context *ctx, VkFormat format);
/* Can images of this format, in either tiling, do all that is wanted? */
bool vkao_format_can(const vkao_context *ctx, VkFormat format, VkFormatFeatureFlags want);

#endif
