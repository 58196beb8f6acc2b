/* SPDX-License-Identifier: MIT */
#ifndef VKAO_INTERNAL_H_
#define VKAO_INTERNAL_H_

#include "log.h"
#include "params.h"
#include "pipeline.h"
#include "scratch.h"
#include "view.h"
#include "vk.h"

#include <assert.h>
#include <stddef.h>

#define VKAO_PUSH_BYTES 128u

/* GTAO, VBAO and RAYMARCH know where the light comes from. */
#define VKAO_BENT_METHODS 0x38u

struct vkao_context {
    struct vk_table vk;
    struct vkao_logger log;
    VkDevice device;
    VkPhysicalDevice physical_device;
    VkPhysicalDeviceMemoryProperties memory;
    uint32_t max_dimension;
    VkAllocationCallbacks allocator_copy;
    const VkAllocationCallbacks *allocator; /* &allocator_copy or NULL */
    uint32_t method_mask;
    vkao_stage_flags stage_mask;
    bool half_view_z, storage_16bit;
    bool buffers; /* scratch is in buffers, and shaders are those for it */
    uint32_t max_texels, max_buffer;
    VkDescriptorSetLayout set_layout;
    VkPipelineLayout pipeline_layout;
    struct pipelines pipelines;
};

/* Host memory through the caller's callbacks, zeroed; NULL when there is none. */
void *vkao_calloc(const VkAllocationCallbacks *allocator, size_t bytes);
void vkao_free(const VkAllocationCallbacks *allocator, void *memory);

struct vkao_frame {
    const vkao_context *ctx;
    vkao_stage_flags stages;
    VkExtent2D extent;
    bool half_resolution;
    vkao_images images;
    bool packed;     /* noisy AO goes to the blur through the scratch buffer */
    uint32_t staged; /* VKAO_STAGED_*: AO is copied to its image */
    struct scratch scratch;
    VkDeviceMemory memory; /* null if the caller's memory is used */
    VkDescriptorPool pool;
    VkDescriptorSet set;
};

/* --- Checks, each before anything is recorded --- */

/* Copies a caller's struct by the struct rule of vkao.h into dst, which has `known` bytes. */
vkao_result vkao_import(const struct vkao_logger *log, const char *name, const void *src, void *dst,
                        size_t known);

vkao_result ssao_params_check(const vkao_context *ctx, const struct vkao_logger *log, bool bent,
                              const vkao_ssao_params *in, vkao_ssao_params *out);
vkao_result blur_params_check(const struct vkao_logger *log, const vkao_blur_params *in,
                              vkao_blur_params *out);
vkao_result composite_params_check(const vkao_frame *frame, const vkao_composite_params *in,
                                   vkao_composite_params *out);
/* Imports the view and reads it off for a frame that must have been built for one of `stages`. */
vkao_result frame_view_check(const vkao_frame *frame, VkCommandBuffer cmd, const char *call,
                             vkao_stage_flags stages, const vkao_view *view,
                             struct view_constants *out);

/* --- Recording of checked stages; cannot fail --- */

void record_prepare(const vkao_frame *frame, VkCommandBuffer cmd,
                    const struct view_constants *view);
/* border: how far around the rect, in texels of the grid, the blur will read. */
void record_ssao(const vkao_frame *frame, VkCommandBuffer cmd, const struct view_constants *view,
                 const vkao_ssao_params *params, uint32_t border);
void record_blur(const vkao_frame *frame, VkCommandBuffer cmd, const struct view_constants *view,
                 const vkao_blur_params *params);
void record_upsample(const vkao_frame *frame, VkCommandBuffer cmd,
                     const struct view_constants *view, const vkao_blur_params *params);
void record_composite(const vkao_frame *frame, VkCommandBuffer cmd,
                      const struct view_constants *view, const vkao_composite_params *params);

/* The view on the grid that SSAO and BLUR run on. */
struct view_constants frame_grid(const vkao_frame *frame, const struct view_constants *view);
/* Rows of normal_to_view, without what it scales by, into the first three components of three rows of a block. */
void copy_normal_rows(const struct view_constants *view, float x[4], float y[4], float z[4]);
bool frame_has_bent_normals(const vkao_frame *frame);

/* What every stage records: bind, push, one invocation per texel of the rect, or for SSAO in
 * buffers per texel of the tiles that record_ssao listed. */
void record_dispatch(const vkao_frame *frame, VkCommandBuffer cmd, enum pipeline which,
                     struct pipeline_key key, const void *block, size_t block_bytes,
                     struct vkao_rect rect);
/* What a command does and waits for. STAGES_INDIRECT: shaders, and the reading of their
 * dispatch's size. */
enum stages { STAGES_COMPUTE, STAGES_TRANSFER, STAGES_INDIRECT };
void record_stages(const vkao_frame *frame, VkCommandBuffer cmd, enum stages before,
                   enum stages after);
/* Earlier vkao work on this queue -> the next dispatch. */
void record_barrier(const vkao_frame *frame, VkCommandBuffer cmd);
/* Staged AO of a strip -> its image. Later vkao work, and whoever waits for it, sees the copy as
 * one of its writes. */
void record_copy(const vkao_frame *frame, VkCommandBuffer cmd, struct vkao_rect strip);
void record_label_begin(const vkao_frame *frame, VkCommandBuffer cmd, const char *name);
void record_label_end(const vkao_frame *frame, VkCommandBuffer cmd);

/* The frame's set, for its current images. */
vkao_result descriptors_create(vkao_frame *frame);
void descriptors_write(const vkao_frame *frame);

/* Descriptor type of a VKAO_BINDING_*. */
VkDescriptorType binding_type(uint32_t binding);

void vkao_set_name(const vkao_context *ctx, VkObjectType type, uint64_t handle, const char *name);

#endif
