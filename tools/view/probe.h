/* SPDX-License-Identifier: MIT
 *
 * What lies under the mouse: view position, normal and AO of one texel, copied from the device
 * along with a frame. */
#ifndef VKAO_VIEW_PROBE_H_
#define VKAO_VIEW_PROBE_H_

#include "compute.h"
#include "swapchain.h"

struct probe_result {
    bool valid;                    /* the mouse is over the image, and its values have arrived */
    int32_t x, y;                  /* texel, from the image's upper left corner */
    bool background;               /* no surface: position and normal are meaningless */
    double position[3], normal[3]; /* view space, as the projection has it */
    bool normal_is_derived;        /* from depth: there are no stored normals, or not here */
    float ao[2];                   /* of A and B */
};

/* What a frame in flight was asked. */
struct probe_request {
    bool pending;
    int32_t x, y;
    VkOffset2D block; /* first texel of the depth block */
    VkExtent2D block_extent;
    struct ao_view view;
    VkExtent2D extent;
    VkFormat normal_format; /* UNDEFINED: no normals */
};

struct probe {
    struct gpu *gpu;
    struct gpu_buffer buffers[FRAMES_IN_FLIGHT];
    struct probe_request requests[FRAMES_IN_FLIGHT];
};

bool probe_create(struct gpu *gpu, struct probe *probe, struct tool_error *err);
void probe_destroy(struct probe *probe);
/* Records the copies of texel x, y of the inputs. ao: of A and B, in GENERAL; the same image twice
 * if only one is there. All of them are visible to TRANSFER. */
void probe_record(struct probe *probe, uint32_t frame, VkCommandBuffer cmd,
                  const struct inputs *inputs, const VkImage ao[2], int32_t x, int32_t y);
/* Once the frame in flight is done. False if it was not asked. */
bool probe_read(struct probe *probe, uint32_t frame, struct probe_result *result);

/* --- Pure functions --- */

/* View position of the centre of a texel with this depth, as view says. False for background. */
bool unproject(const struct ao_view *view, VkExtent2D extent, double column, double row,
               double depth, double position[3]);

#endif
