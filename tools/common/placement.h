/* SPDX-License-Identifier: MIT
 *
 * Renderers crop the data window to what they see, differently in each frame. AO is computed at the
 * place of the data window in the display, so that its noise does not move along with the crop. */
#ifndef VKAO_TOOLS_PLACEMENT_H_
#define VKAO_TOOLS_PLACEMENT_H_

#include "ao.h"
#include "error.h"
#include "gbuffer.h"

/* Texels that are added on the left and on top. */
struct placement {
    uint32_t left, top;
};

/* That of a data window inside its display window; 0, 0 for others. Less than the place in the
 * display, where that is far off: the noise repeats. */
struct placement placement_of(const struct exr_box *data, const struct exr_box *display);
/* Pads the images. gbuffer->width and height stay those of the data window; the job is larger by
 * the placement. */
bool placement_expand(struct gbuffer *gbuffer, struct placement *placement, struct tool_error *err);
/* Takes the padding off the results, and off the colour. */
void placement_crop(const struct placement *placement, struct gbuffer *gbuffer,
                    struct ao_result *result);

/* The composite, and the colour, in the window of the colour's own part, if that is another one:
 * AO is 1 where the depth does not reach. Bent normals are 0 there. */
bool placement_widen(struct gbuffer *gbuffer, struct ao_result *result, struct tool_error *err);

#endif
