/* SPDX-License-Identifier: MIT
 *
 * What a frame needs between its passes, in one block of device memory: images, and a buffer with
 * the constants and what the CPU's passes keep. Resources whose lifetimes do not meet share
 * memory. */
#ifndef VKAO_SCRATCH_H_
#define VKAO_SCRATCH_H_

#include "passes.h"

/* Something that lies in memory while passes first..last run. */
struct vkao_block {
    VkDeviceSize size, alignment, offset; /* size 0 = nothing */
    uint32_t first, last;
    bool follows; /* its memory was another's before */
};

struct vkao_scratch_image {
    VkFormat format; /* UNDEFINED = not needed */
    VkExtent2D extent;
    VkImage image;
    VkImageView view;
};

struct vkao_scratch {
    struct vkao_scratch_image images[VKAO_IMAGE_COUNT];
    /* of images in the memory, of parts in the buffer */
    struct vkao_block blocks[VKAO_RESOURCE_COUNT];
    /* the buffer in the memory: what is needed to the end, and what images may follow */
    struct vkao_block kept, tail;
    VkBuffer buffer;
    VkBufferView views[VKAO_MOST_PASSES][VKAO_MOST_USES]; /* of uses as texels */
};

/* What to create. The rest is filled in. */
struct vkao_scratch_plan {
    struct {
        VkFormat format;
        VkExtent2D extent;
    } images[VKAO_IMAGE_COUNT];
    VkDeviceSize parts[VKAO_RESOURCE_COUNT]; /* bytes, from VKAO_RESOURCE_CONSTANTS on */
};

/* Creates it, unbound, and tells the memory that it takes. On failure the rest is for
 * vkao_scratch_destroy. */
vkao_result vkao_scratch_create(const struct vkao_program *program,
                                const struct vkao_scratch_plan *plan, struct vkao_scratch *scratch,
                                VkMemoryRequirements *out);
vkao_result vkao_scratch_bind(const struct vkao_program *program, struct vkao_scratch *scratch,
                              VkDeviceMemory memory, VkDeviceSize offset);
void vkao_scratch_destroy(const vkao_context *ctx, struct vkao_scratch *scratch);

#endif
