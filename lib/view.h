/* SPDX-License-Identifier: MIT
 *
 * A vkao_view read off: what shaders need of the projection, checked rectangles. Pure mathematics,
 * no Vulkan calls. */
#ifndef VKAO_VIEW_H_
#define VKAO_VIEW_H_

#include "log.h"

#include <stdbool.h>

/* A checked rectangle inside the image: half open, texels. */
struct vkao_rect {
    uint32_t x0, y0, x1, y1;
};

struct view_constants {
    bool orthographic;
    /* view xy = texel * [0..1] + [2..3], times z in perspective; texel centres are integers */
    float unproject[4];
    float inverse_unproject[2]; /* 1 / unproject[0..1] */
    float linearize[2];         /* see vkao_constants */
    float far_depth;            /* device depth of the far plane */
    float far_z;             /* view z of the far plane, FLT_MAX if infinite or not to be tested */
    float depth_error[2];    /* uncertainty of z: [0] + [1] * z, times z in perspective */
    float normal_rows[3][3]; /* normal_to_view with +z turned away from the eye */
    float reference_z;       /* width of the viewport in scene units if orthographic, else 0 */
    struct vkao_rect valid, rect;
};

/* Checks every field of the view and reads it off, for an effect that says what depth holds.
 * depth_format may be UNDEFINED where no depth is read. */
vkao_result vkao_view_constants_init(const struct vkao_logger *log, const vkao_view *view,
                                     const vkao_effect_info *effect, VkExtent2D extent,
                                     VkFormat depth_format, struct view_constants *out);

/* The rect alone, for stages that need no projection. */
vkao_result vkao_view_rects(const struct vkao_logger *log, const vkao_view *view, VkExtent2D extent,
                            struct vkao_rect *valid, struct vkao_rect *rect);

/* The same view on the grid of every second texel. rect becomes what an upsampling to it reads. */
struct view_constants vkao_view_halve(const struct view_constants *view);

/* rect grown by x and y texels on each side, inside bounds. */
struct vkao_rect vkao_rect_grow(struct vkao_rect rect, uint32_t x, uint32_t y,
                                struct vkao_rect bounds);
/* As shaders take it: see vkao_constants. */
void vkao_rect_pack(struct vkao_rect rect, uint32_t out[2]);

#endif
