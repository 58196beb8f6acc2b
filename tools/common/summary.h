/* SPDX-License-Identifier: MIT
 *
 * What a G-buffer was read as, in a line. */
#ifndef VKAO_TOOLS_SUMMARY_H_
#define VKAO_TOOLS_SUMMARY_H_

#include "gbuffer.h"
#include "text.h"

/* "depth=Z (planar, float) normal=N (camera) fov=60h (--fov)" */
void text_add_summary(struct text *text, const struct gbuffer *gbuffer);

#endif
