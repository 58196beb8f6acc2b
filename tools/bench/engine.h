/* SPDX-License-Identifier: MIT
 *
 * The library on a device, as an engine would drive it: images uploaded once, one recording per
 * frame, nothing read back. */
#ifndef VKAO_BENCH_ENGINE_H_
#define VKAO_BENCH_ENGINE_H_

#include "configs.h"
#include "error.h"
#include "gpu.h"
#include "room.h"
#include "stage_clock.h"

#include <stdbool.h>
#include <stddef.h>

/* What the frames hold beside AO. */
struct engine_features {
    bool composite, bent_normals;
};

struct engine {
    struct gpu gpu;
    vkao_context *ctx;
    vkao_effect *effects[MAX_CONFIGS]; /* by the settings that they are compiled for */
    struct config configs[MAX_CONFIGS];
    size_t effect_count;
    double compile_ms; /* that vkao_context_create and vkao_effect_create took */
    struct stage_clock clock;
    struct engine_features features;
};

/* device: as of --device. Errors: EXIT_DEVICE, EXIT_MEMORY. */
bool engine_create(const char *device, struct engine_features features, struct engine *e,
                   struct tool_error *err);
/* Effects for these settings, at most MAX_CONFIGS, and no others; those before are destroyed, no
 * images may be left of them. */
bool engine_compile(struct engine *e, const struct config *configs, size_t count,
                    struct tool_error *err);
void engine_destroy(struct engine *e);

/* The room of one size on the device, and frames for it that share their scratch memory. */
struct engine_images {
    VkExtent2D extent;
    struct gpu_image depth, normals, ao, bent, color, output;
    VkDeviceMemory scratch;
    vkao_frame *frames[MAX_CONFIGS]; /* by effect */
};

/* Whether its images can have that size, before anyone draws it. Errors: EXIT_DEVICE. */
bool engine_check_size(const struct engine *e, VkExtent2D size, struct tool_error *err);
/* The formats that its images are made in. */
void engine_image_formats(struct engine_images *images);
bool engine_images_create(struct engine *e, const struct room *room, struct engine_images *images,
                          struct tool_error *err);
void engine_images_destroy(struct engine *e, struct engine_images *images);

/* Records, submits and waits once. */
bool engine_run(struct engine *e, const struct engine_images *images, const struct config *config,
                float radius, double ms[STAGES], struct tool_error *err);

/* Records one frame of the room. */
vkao_result engine_record(const vkao_frame *frame, VkExtent2D extent, const struct config *config,
                          float radius, VkCommandBuffer cmd);

/* What is compiled for a setting. */
vkao_effect_info engine_effect_info(struct engine_features features, const struct config *config);
/* A frame of this extent, as vkao_frame_create wants it. on_device: NULL = for images that are not
 * there. info->images is images. */
void engine_frame_info(struct engine_features features, VkExtent2D extent,
                       const struct engine_images *on_device, vkao_images *images,
                       vkao_frame_info *info);

#endif
