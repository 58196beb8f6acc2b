/* SPDX-License-Identifier: MIT
 *
 * Two small scenes that an engine could have rendered: a depth, normal and light pass of its own,
 * which vkao then works on in the same command buffer.
 *
 *     struct live_scene *scene = live_scene_create(gpu, LIVE_ROOM, &err);
 *     struct orbit camera = live_scene_camera(LIVE_ROOM);
 *     live_target_create(scene, extent, &target, &err);          one per frame in flight
 *     live_target_images(&target, &images);                      then vkao_frame_create
 *
 *     live_scene_record(scene, &target, cmd, &camera, seconds, used);
 *     live_scene_view(&camera, used, &view);
 *     vkao_cmd_record(frame, cmd, &view, &params);
 *
 * Synchronization: live_scene_record brings its own. Before, every earlier access to the target's
 * images came from live_scene_record or was a read by COMPUTE_SHADER, FRAGMENT_SHADER or TRANSFER
 * on the same queue, in whatever layout (contents are discarded). After, all images are visible to
 * COMPUTE_SHADER and FRAGMENT_SHADER / SHADER_READ and to TRANSFER / TRANSFER_READ, in the layouts
 * of live_target_images().
 *
 * Thread-safety: a scene is constant once created; any number of threads may record it. */
#ifndef VKAO_VIEW_SCENE_H_
#define VKAO_VIEW_SCENE_H_

#include "gpu.h"
#include "setting.h"
#include "orbit.h"

enum live_kind {
    LIVE_CUBES, /* cubes coloured by local coordinates, on a slab before nothing; one tumbles */
    LIVE_ROOM,  /* a furnished room, 8 by 6 by 3 scene units; a ball circles a column */
    LIVE_KIND_COUNT
};

/* "cubes", "room" */
const char *live_scene_name(enum live_kind kind);
/* Where to start from. */
struct orbit live_scene_camera(enum live_kind kind);
/* Scene units: an ssao.radius that suits the scene. */
float live_scene_radius(enum live_kind kind);

/* Geometry on the device, a render pass and a pipeline. Needs Vulkan 1.1 core and a queue with
 * graphics. NULL on errors: EXIT_DEVICE, EXIT_MEMORY. The gpu must outlive it; targets must be
 * destroyed before. */
struct live_scene *live_scene_create(struct gpu *gpu, enum live_kind kind, struct tool_error *err);
/* Not in use by a pending command buffer. NULL is ignored. */
void live_scene_destroy(struct live_scene *scene);

/* What one frame in flight renders into. Light is linear; its alpha is 1 on surfaces, else 0. */
struct live_target {
    struct live_scene *scene;
    VkExtent2D extent;        /* texels, of every image */
    struct gpu_image depth;   /* D32_SFLOAT, projected, reversed: 0 = background */
    struct gpu_image normals; /* A2B10G10R10_UNORM, xyz * 0.5 + 0.5, world space */
    /* R16G16B16A16_SFLOAT: light from the sky, which AO is for, and what the background shows. */
    struct gpu_image indirect;
    struct gpu_image direct; /* R16G16B16A16_SFLOAT: light from the sun, without shadows */
    struct gpu_image albedo; /* R8G8B8A8_UNORM: diffuse reflectance */
    VkFramebuffer framebuffer;
};

/* extent: 1x1 .. the device's limit; a minimised window has no targets. Waits for the queue. On
 * failure *target is empty. */
bool live_target_create(struct live_scene *scene, VkExtent2D extent, struct live_target *target,
                        struct tool_error *err);
/* Not in use by a pending command buffer. Takes empty (zeroed) targets too. */
void live_target_destroy(struct live_target *target);
/* Sets the slots depth, normals, color (indirect), direct and albedo, not the others. */
void live_target_images(const struct live_target *target, vkao_images *images);

/* Records the scene as it is at `time` (seconds, any finite value) into the upper left `used`
 * texels (1x1 .. target->extent) of the target; what the other texels hold is undefined. Outside of
 * render passes, on the gpu's queue family. Changes graphics state, not compute state. */
void live_scene_record(const struct live_scene *scene, const struct live_target *target,
                       VkCommandBuffer cmd, const struct orbit *camera, double time,
                       VkExtent2D used);
/* ao_view_default() with encodings, matrices and `valid` set to match live_scene_record of the
 * same arguments. */
void live_scene_view(const struct orbit *camera, VkExtent2D used, struct ao_view *out);

#endif
