/* SPDX-License-Identifier: MIT
 *
 * What the files of scene.h share. */
#ifndef VKAO_VIEW_SCENE_INTERNAL_H_
#define VKAO_VIEW_SCENE_INTERNAL_H_

#include "scene.h"
#include "scene_design.h"

/* The attachments of the render pass, colour first, in the order of scene.frag's outputs. */
enum live_attachment {
    ATTACHMENT_NORMALS,
    ATTACHMENT_INDIRECT,
    ATTACHMENT_DIRECT,
    ATTACHMENT_ALBEDO,
    ATTACHMENT_DEPTH,
    ATTACHMENT_COUNT,
    ATTACHMENT_COLORS = ATTACHMENT_DEPTH
};
extern const VkFormat live_formats[ATTACHMENT_COUNT];

struct live_scene {
    struct gpu *gpu;
    const struct live_design *design;
    VkRenderPass pass;
    VkPipelineLayout layout;
    VkPipeline pipeline;
    VkBuffer buffer; /* vertices, then indices */
    VkDeviceMemory memory;
    VkDeviceSize index_offset;
    uint32_t still_count, index_count; /* indices [0,still_count) stand still, the others move */
};

bool live_pass_create(struct gpu *gpu, VkRenderPass *pass, struct tool_error *err);
/* For live_pass_create's render pass; sets scene->layout and scene->pipeline. */
bool live_pipeline_create(struct live_scene *scene, struct tool_error *err);

/* The push constants of scene.vert. */
struct live_push {
    float view_projection[16];
    float model[3][4]; /* rows */
    float eye[4];      /* position and 1, or the direction to it and 0 */
};

#endif
