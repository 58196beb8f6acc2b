/* SPDX-License-Identifier: MIT
 *
 * vkao at work on images that stay on the device, recorded into the viewer's command buffers. */
#ifndef VKAO_VIEW_COMPUTE_H_
#define VKAO_VIEW_COMPUTE_H_

#include "gpu.h"
#include "setting.h"
#include "settings.h"

/* What vkao reads: of a file or of a live scene. */
struct inputs {
    vkao_images images; /* depth, normals, color, direct, albedo */
    VkExtent2D extent;
    struct ao_view view;
    VkImage depth, normals; /* of the slots, for the probe; normals may be VK_NULL_HANDLE */
};

enum { STAGES = 4 };

struct stage_times {
    double ms[STAGES]; /* < 0: the stage did not run */
};

/* What decides about frame and images: when it changes, they are made anew. The same frames that
 * the command line tool makes, so that the same numbers come out. */
struct shape {
    VkExtent2D extent;
    VkBool32 bent, composite;
    vkao_images inputs; /* slots that are read */
    vkao_effect_info effect;
};

/* One setting's frame and results. */
struct computation {
    struct gpu *gpu;
    struct shape shape;
    vkao_effect *effect;
    vkao_frame *frame;
    struct gpu_image ao, bent,
        output; /* R32, RGBA32, RGBA32 float; the last two only if the shape has them */
};

/* Whether it can be recorded as it is. */
bool computation_fits(const struct computation *c, const struct inputs *inputs,
                      const struct setting *setting, enum view_kind view);
/* Makes frame and images; what there was must not be in use. Errors: EXIT_DEVICE, EXIT_MEMORY,
 * EXIT_BUG. */
bool computation_create(struct computation *c, struct gpu *gpu, const vkao_context *ctx,
                        const struct inputs *inputs, const struct setting *setting,
                        enum view_kind view, struct tool_error *err);
void computation_destroy(struct computation *c);

/* Records all stages, with a timestamp before the first and after each: STAGES + 1 queries from
 * `query` on, unless the pool is VK_NULL_HANDLE. Inputs are visible to COMPUTE_SHADER; results
 * become visible to FRAGMENT_SHADER, TRANSFER. On errors the command buffer is still good to go. */
bool computation_record(const struct computation *c, VkCommandBuffer cmd,
                        const struct inputs *inputs, const struct setting *setting,
                        enum view_kind view, VkQueryPool pool, uint32_t query,
                        struct tool_error *err);
/* False without an error in err: the results are not there yet. */
bool read_stage_times(const struct gpu *gpu, VkQueryPool pool, uint32_t query,
                      struct stage_times *times, struct tool_error *err);

/* The image that a view shows. */
VkImageView computation_result(const struct computation *c, enum view_kind view);

#endif
