/* SPDX-License-Identifier: MIT
 *
 * A live scene in the viewer: its targets, its camera and its clock. */
#ifndef VKAO_VIEW_LIVE_H_
#define VKAO_VIEW_LIVE_H_

#include "compute.h"
#include "scene.h"
#include "swapchain.h"

struct live {
    struct gpu *gpu;
    enum live_kind kind;
    struct live_scene *scene;
    struct live_target targets[FRAMES_IN_FLIGHT]; /* of the window's size */
    VkExtent2D extent;
    struct orbit camera;
    struct orbit shown[FRAMES_IN_FLIGHT]; /* the camera that is in the targets, and */
    VkExtent2D shown_used[FRAMES_IN_FLIGHT];
    double scale;   /* (0,1] share of the extent that is rendered, on each axis */
    double seconds; /* of the scene's clock */
    bool running;
};

/* name: "cubes" or "room". NULL on errors. */
struct live *live_create(struct gpu *gpu, const char *name, struct tool_error *err);
void live_destroy(struct live *live);
/* Targets of another size; none of the old ones may be in use. */
bool live_resize(struct live *live, VkExtent2D extent, struct tool_error *err);
/* What is rendered of the extent. */
VkExtent2D live_used(const struct live *live);
/* Records the scene into the target of a frame in flight. */
void live_record(struct live *live, uint32_t frame, VkCommandBuffer cmd);
/* What vkao finds there. */
struct inputs live_inputs(const struct live *live, uint32_t frame);

#endif
