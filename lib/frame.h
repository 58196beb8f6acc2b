/* SPDX-License-Identifier: MIT */
#ifndef VKAO_FRAME_H_
#define VKAO_FRAME_H_

#include "effect.h"
#include "scratch.h"

/* What the CPU's passes keep of a frame: texels in a row of buffers and of the copied AO, and its
 * bytes per texel. */
struct vkao_rows {
    uint32_t stride, copied_stride;
    VkDeviceSize copied_texel;
};

struct vkao_frame {
    const vkao_context *ctx;
    const vkao_effect *effect;
    struct vkao_program *program; /* the effect's, or own */
    struct vkao_program *own;     /* if the CPU's buffers cannot hold so large a frame */
    VkExtent2D extent;
    vkao_images images;
    bool copies; /* AO is copied into its image */
    struct vkao_rows rows;
    struct vkao_scratch scratch;
    VkDeviceMemory memory; /* null if the caller's memory is used */
    VkDescriptorPool pool;
    VkDescriptorSet sets[VKAO_MOST_PASSES];
};

#endif
