/* SPDX-License-Identifier: MIT
 *
 * A Vulkan driver that computes nothing: it stands behind the two proc-addr functions that vkao
 * takes, writes down every call, keeps count of every object and fails on demand. Each fake is its
 * own world; its handles lead back to it, so there is no global state. What compiles a pipeline may
 * be called by several threads at once, all else by one at a time. */
#ifndef FAKE_VULKAN_H_
#define FAKE_VULKAN_H_

#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>
#include <vulkan/vulkan_core.h>

enum {
    FAKE_OBJECTS = 8192,
    FAKE_CALLS = 2048,
    FAKE_BARRIERS = 8,
    FAKE_WRITES = 29,
    FAKE_PUSH_BYTES = 128,
    FAKE_UPDATE_BYTES = 512,
    FAKE_CONSTANTS = 32,
    FAKE_FORMATS = 8,
    FAKE_NAMES = 64
};

/* The arguments that tests ask about; what a call does not have stays zero. */
struct fake_call {
    const char *name;
    uint64_t handle; /* created, destroyed, bound or named; the image of a memory binding */

    /* vkCmdPipelineBarrier */
    VkPipelineStageFlags src_stages, dst_stages;
    uint32_t memory_barrier_count, buffer_barrier_count, image_barrier_count;
    VkMemoryBarrier memory_barrier; /* the first */
    VkImageMemoryBarrier image_barriers[FAKE_BARRIERS];

    VkPipelineBindPoint bind_point;
    uint32_t first_set, set_count;

    uint32_t push_offset, push_bytes;
    VkShaderStageFlags push_stages;
    unsigned char push[FAKE_PUSH_BYTES];

    uint32_t groups[3];

    /* vkUpdateDescriptorSets, one image each */
    uint32_t write_count;
    struct {
        uint32_t binding;
        VkDescriptorType type;
        uint64_t view;
        VkImageLayout layout;
    } writes[FAKE_WRITES];

    uint64_t memory;           /* vkBindImageMemory */
    VkDeviceSize size, offset; /* also of a buffer view, an update and an indirect dispatch */
    uint32_t memory_type;
    VkImageCreateInfo image;
    VkFormat format; /* of a buffer view */
    VkPipelineCache cache;

    unsigned char update[FAKE_UPDATE_BYTES]; /* vkCmdUpdateBuffer */

    /* vkCmdCopyBufferToImage, vkCmdUpdateBuffer, vkCmdDispatchIndirect: the buffer; handle: the
     * image, nothing, the pipeline */
    uint64_t source;
    VkImageLayout layout;
    VkBufferImageCopy copy; /* the only region */
};

struct fake_object {
    VkObjectType type;
    uint64_t handle;
    bool alive, of_caller;
    const VkAllocationCallbacks *allocator;
    void *host;         /* what the driver holds through the callbacks */
    uint64_t parent;    /* image or buffer of a view, pool of a set */
    VkDeviceSize bytes; /* of a buffer */
    VkBufferUsageFlags usage;
    VkImageCreateInfo image;
    uint64_t memory;                    /* bound to an image */
    uint64_t views[FAKE_WRITES];        /* descriptors of a set, by binding */
    const uint32_t *code;               /* SPIR-V of a module, and of a pipeline */
    uint32_t constants[FAKE_CONSTANTS]; /* of a pipeline, by their ids */
    uint32_t given;                     /* bits of those that it was given */
};

struct fake_vulkan {
    pthread_mutex_t lock; /* of what happened, while pipelines are compiled */
    /* What dispatchable handles point at. */
    struct fake_vulkan *instance, *physical_device, *device, *command_buffer;

    /* Told by the test. fake_init sets a capable device. */
    uint32_t api_version, max_dimension;
    VkPhysicalDeviceType device_type;
    VkPhysicalDeviceMemoryProperties memory;
    VkDeviceSize image_alignment;
    uint32_t image_type_bits;
    struct {
        VkFormat format;
        VkFormatFeatureFlags optimal, linear;
    } formats[FAKE_FORMATS]; /* exceptions; every other format can be sampled and stored to */
    size_t format_count;
    VkFormatFeatureFlags buffer_features; /* of every format */
    VkFormat no_texel_buffer;             /* but of this one; UNDEFINED = none */
    uint32_t max_texels, max_buffer;      /* in a texel buffer; bytes of a storage buffer */
    bool debug_utils;
    const char *missing; /* proc-addr answers NULL for this name */
    unsigned fail_at;    /* 1 = the first call that returns VkResult; 0 = none */
    bool fail_from;      /* and every one after it */
    VkResult fail_result;
    const VkAllocationCallbacks *expected_allocator; /* must be given to every create and destroy */
    /* If not NULL: who compiles a pipeline waits here with it, as long as compiling takes. */
    pthread_barrier_t *compiling;

    /* What happened. */
    unsigned result_calls;
    const char *failed;            /* name of the call that was made to fail */
    const char *asked[FAKE_NAMES]; /* required function names, each once */
    size_t asked_count;
    struct fake_call *calls;
    size_t call_count;
    struct fake_object *objects;
    size_t object_count;
    uint64_t bound_pipeline, bound_set;
    char error[256]; /* first misuse of the API; empty = none */
};

void fake_init(struct fake_vulkan *fake);
void fake_release(struct fake_vulkan *fake);

VkInstance fake_instance(struct fake_vulkan *fake);
VkPhysicalDevice fake_physical_device(struct fake_vulkan *fake);
VkDevice fake_device(struct fake_vulkan *fake);
VkCommandBuffer fake_command_buffer(struct fake_vulkan *fake);

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL fake_get_instance_proc_addr(VkInstance instance,
                                                                     const char *name);
VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL fake_get_device_proc_addr(VkDevice device,
                                                                   const char *name);

/* The format can do nothing but this. */
void fake_limit_format(struct fake_vulkan *fake, VkFormat format, VkFormatFeatureFlags optimal,
                       VkFormatFeatureFlags linear);
/* Objects of the caller: vkao may use them and must not destroy them. */
VkImageView fake_caller_view(struct fake_vulkan *fake);
/* With its format, extent, levels and layers; the rest of info may be zero. */
VkImage fake_caller_image(struct fake_vulkan *fake, const VkImageCreateInfo *info);
VkDeviceMemory fake_caller_memory(struct fake_vulkan *fake);

/* Objects that the library has made and not destroyed. */
size_t fake_live(const struct fake_vulkan *fake);
size_t fake_live_of(const struct fake_vulkan *fake, VkObjectType type);
const struct fake_object *fake_find(const struct fake_vulkan *fake, uint64_t handle);
void fake_forget_calls(struct fake_vulkan *fake);
/* Calls whose name begins with the prefix: "vkCmd", "vkCreateImage". */
size_t fake_count(const struct fake_vulkan *fake, const char *prefix);
/* The index-th call of exactly this name, or NULL. */
const struct fake_call *fake_nth(const struct fake_vulkan *fake, const char *name, size_t index);

#endif
