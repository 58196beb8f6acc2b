/* SPDX-License-Identifier: MIT
 *
 * Pipelines of a context: for each stage a general one, and those of the variants that the caller named. */
#ifndef VKAO_PIPELINE_H_
#define VKAO_PIPELINE_H_

#include "view.h"
#include "vk.h"

#define VKAO_METHOD_COUNT 6

enum pipeline {
    PIPELINE_PREPARE,
    PIPELINE_BLUR_X,
    PIPELINE_BLUR_Y,
    PIPELINE_UPSAMPLE,
    PIPELINE_TILES,         /* of SSAO, for scratch in buffers */
    PIPELINE_PACKED_BLUR_X, /* the same as above for AO in buffers */
    PIPELINE_PACKED_BLUR_Y,
    PIPELINE_PACKED_UPSAMPLE,
    PIPELINE_COMPOSITE,
    PIPELINE_DEBUG,
    PIPELINE_SSAO, /* + vkao_ssao_method */
    PIPELINE_COUNT = PIPELINE_SSAO + VKAO_METHOD_COUNT
};

/* What a pipeline is compiled for: specialization constants VKAO_CONSTANT_FLAGS and those after it, in their order.
 * Zero counts and VKAO_FLAGS_UNKNOWN are left to the push constants, but for the radius: see blur_window.glsl. */
struct pipeline_key {
    uint32_t flags, slices, steps, samples, radius;
};

struct pipeline_entry {
    enum pipeline which;
    VkBool32 bent; /* also computes bent normals */
    struct pipeline_key key;
    VkPipeline pipeline;
    vkao_result result; /* of its creation */
};

struct pipelines {
    struct pipeline_entry *entries;
    uint32_t count;
};

/* What a pipeline is made of. */
struct shader_code {
    const char *name;
    const uint32_t *code; /* NULL = not in the context's build */
    size_t bytes;
    VkBool32 vertical; /* VKAO_CONSTANT_BLUR_VERTICAL */
    bool bent;         /* has a form with VKAO_CONSTANT_BENT_NORMALS */
};

/* general: of the general pipeline, which may have code of its own; all else is the same. */
struct shader_code shader_code(const vkao_context *ctx, enum pipeline which, bool general);

/* Creates what the info asks for; info is checked. On failure the rest is for pipelines_destroy. */
vkao_result pipelines_create(vkao_context *ctx, const vkao_context_info *info);
void pipelines_destroy(vkao_context *ctx);

/* The variant for exactly this key, else the general pipeline; VK_NULL_HANDLE if there is none. */
VkPipeline pipeline_find(const vkao_context *ctx, enum pipeline which, bool bent,
                         struct pipeline_key key);

/* Refuses settings for which a context with variants_only has no pipeline. ssao and blur may be NULL. */
vkao_result pipelines_check(const vkao_frame *frame, const struct view_constants *view,
                            const vkao_ssao_params *ssao, const vkao_blur_params *blur);

/* What a pipeline of that stage is told of a recording. */
struct pipeline_key pipeline_key(enum pipeline which, uint32_t flags, const vkao_ssao_params *ssao,
                                 const vkao_blur_params *blur);
/* In which way AO travels: VKAO_FLAG_PACKED and VKAO_STAGED_*. */
uint32_t recording_way(bool packed, uint32_t staged);
/* The frame's. */
uint32_t frame_flags(const vkao_frame *frame);
/* Flags of shaders/params.h, of a view on the grid that the stages run on; way: frame_flags().
 * ssao and blur may be NULL. */
uint32_t recording_flags(const struct view_constants *grid, uint32_t way,
                         const vkao_ssao_params *ssao, const vkao_blur_params *blur);
/* Texels of one invocation. */
VkExtent2D pipeline_texels(const vkao_context *ctx, enum pipeline which);
/* Invocations of one workgroup. */
VkExtent2D pipeline_group(const vkao_context *ctx, enum pipeline which);

#endif
