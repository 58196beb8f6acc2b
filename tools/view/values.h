/* SPDX-License-Identifier: MIT
 *
 * What was computed, fetched from the device: as vkao has it before it writes files. */
#ifndef VKAO_VIEW_VALUES_H_
#define VKAO_VIEW_VALUES_H_

#include "output.h"
#include "viewer.h"

/* malloc'ed texels of an image in GENERAL, in its own format; NULL on errors. */
void *download_image(struct gpu *gpu, const struct gpu_image *image, struct tool_error *err);

/* The computation that the last frame showed for a side. */
const struct computation *last_result(const struct viewer *viewer, enum side side);

/* Its values without padding, finished: of a file r->gbuffer is that of the file, but with colour
 * of its own; of a live scene it has an extent only. Waits for the device. values_free frees them,
 * in any case. */
bool values_take(struct viewer *viewer, enum side side, struct rendered_view *r,
                 struct tool_error *err);
void values_free(struct rendered_view *r);

/* A texel as the window shows it, in [0,1] once clamped. */
void values_color(const struct viewer *viewer, const struct tone *tone,
                  const struct rendered_view *r, size_t texel, double color[3]);

#endif
