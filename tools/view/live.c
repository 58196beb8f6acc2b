/* SPDX-License-Identifier: MIT */
#include "live.h"

#include <stdlib.h>
#include <string.h>

struct live *live_create(struct gpu *gpu, const char *name, struct tool_error *err)
{
    struct live *live = calloc(1, sizeof *live);
    if (!live) {
        fail(err, EXIT_MEMORY, "out of memory");
        return NULL;
    }
    *live = (struct live){.gpu = gpu, .scale = 1, .running = true};
    for (int k = 0; k < LIVE_KIND_COUNT; k++)
        if (strcmp(live_scene_name((enum live_kind)k), name) == 0)
            live->kind = (enum live_kind)k;
    live->camera = live_scene_camera(live->kind);
    live->scene = live_scene_create(gpu, live->kind, err);
    if (live->scene)
        return live;
    live_destroy(live);
    return NULL;
}

static void destroy_targets(struct live *live)
{
    for (int i = 0; i < FRAMES_IN_FLIGHT; i++)
        live_target_destroy(&live->targets[i]);
    live->extent = (VkExtent2D){0};
}

void live_destroy(struct live *live)
{
    if (!live)
        return;
    destroy_targets(live);
    live_scene_destroy(live->scene);
    free(live);
}

bool live_resize(struct live *live, VkExtent2D extent, struct tool_error *err)
{
    destroy_targets(live);
    for (int i = 0; i < FRAMES_IN_FLIGHT; i++) {
        if (!live_target_create(live->scene, extent, &live->targets[i], err)) {
            destroy_targets(live);
            return false;
        }
    }
    live->extent = extent;
    return true;
}

VkExtent2D live_used(const struct live *live)
{
    VkExtent2D used = {(uint32_t)(live->extent.width * live->scale + 0.5),
                       (uint32_t)(live->extent.height * live->scale + 0.5)};
    used.width = used.width < 1 ? 1 : used.width;
    used.height = used.height < 1 ? 1 : used.height;
    return used;
}

struct inputs live_inputs(const struct live *live, uint32_t frame)
{
    const struct live_target *target = &live->targets[frame];
    struct inputs inputs = {.images = vkao_images_default(),
                            .extent = live->extent,
                            .depth = target->depth.image,
                            .normals = target->normals.image};
    live_target_images(target, &inputs.images);
    live_scene_view(&live->camera, live_used(live), &inputs.view);
    return inputs;
}

void live_record(struct live *live, uint32_t frame, VkCommandBuffer cmd)
{
    live->shown[frame] = live->camera;
    live->shown_used[frame] = live_used(live);
    live_scene_record(live->scene, &live->targets[frame], cmd, &live->camera, live->seconds,
                      live_used(live));
}
