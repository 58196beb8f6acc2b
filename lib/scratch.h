/* SPDX-License-Identifier: MIT
 *
 * What a frame needs between its stages, in one block of device memory: images, or for CPUs a buffer in their place
 * (shaders/params.h says how texels lie in it). */
#ifndef VKAO_SCRATCH_H_
#define VKAO_SCRATCH_H_

#include "vk.h"

#include "params.h"

enum scratch_slot {
    SCRATCH_VIEW_Z,
    SCRATCH_NOISY,   /* if the SSAO stage feeds BLUR and the caller gave no ao_noisy */
    SCRATCH_HALFWAY, /* between the two directions of the blur */
    SCRATCH_AO,      /* if COMPOSITE reads AO and the caller gave no ao */
    SCRATCH_COUNT
};

struct scratch_image {
    VkFormat format; /* UNDEFINED = not needed */
    VkExtent2D extent;
    VkImage image;
    VkImageView view;
    VkDeviceSize offset;
};

enum scratch_part {
    PART_VIEW_Z,
    PART_PACKED,
    PART_HALFWAY,
    PART_BLURRED,
    PART_STAGED,
    PART_TILES,
    PART_COUNT
};

/* Bindings from VKAO_BINDING_Z on. */
enum { SCRATCH_VIEWS = VKAO_BINDING_COUNT - VKAO_BINDING_Z };

struct scratch_view {
    enum scratch_part part;
    VkFormat format; /* of texels; UNDEFINED = as words */
};

/* What a VKAO_BINDING_* is of the buffer, NULL if it is not in it. */
const struct scratch_view *scratch_view(uint32_t binding);

struct scratch_buffer {
    uint32_t stride;           /* texels in a row */
    uint32_t staged_stride;    /* the same of PART_STAGED */
    VkDeviceSize staged_texel; /* bytes */
    struct {
        VkDeviceSize offset, bytes; /* in the buffer; 0 bytes = not needed */
    } parts[PART_COUNT];
    VkDeviceSize bytes; /* 0 = not needed */
    VkBuffer buffer;
    VkBufferView views[SCRATCH_VIEWS]; /* [binding - VKAO_BINDING_Z] */
    VkDeviceSize offset;               /* in the memory */
};

struct scratch {
    struct scratch_image images[SCRATCH_COUNT];
    struct scratch_buffer buffer;
};

/* Creates what a checked frame needs, unbound, and lays it out in one block. On failure the rest is for
 * scratch_destroy. */
vkao_result scratch_create(const vkao_frame *frame, struct scratch *scratch,
                           VkMemoryRequirements *out);
vkao_result scratch_bind(const vkao_context *ctx, struct scratch *scratch, VkDeviceMemory memory,
                         VkDeviceSize offset);
void scratch_destroy(const vkao_context *ctx, struct scratch *scratch);

#endif
