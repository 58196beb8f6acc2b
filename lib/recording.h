/* SPDX-License-Identifier: MIT
 *
 * What passes share when they are recorded. */
#ifndef VKAO_RECORDING_H_
#define VKAO_RECORDING_H_

#include "frame.h"
#include "view.h"

struct vkao_recording {
    const vkao_frame *frame;
    VkCommandBuffer cmd;
    struct view_constants image, grid; /* the view on the image's grid, and on that of the stages */
    uint32_t form;                     /* VKAO_FORM_* */
};

/* The texels that a pass writes. */
struct vkao_rect vkao_area(const struct vkao_recording *r, enum vkao_area area);

/* What a command does and waits for. INDIRECT: shaders, and the reading of their dispatch's
 * size. */
enum vkao_access { VKAO_SHADERS, VKAO_TRANSFER, VKAO_INDIRECT };
void vkao_barrier(const struct vkao_recording *r, enum vkao_access before, enum vkao_access after);

/* Binds a pass with its push constants. */
void vkao_bind(const struct vkao_recording *r, uint32_t pass, const void *push, size_t bytes);
/* An invocation for each of its texels in the rect, beginning at multiples of their width, and if
 * the row says so of their height. */
void vkao_dispatch(const struct vkao_recording *r, uint32_t pass, struct vkao_rect rect);

#endif
