/* SPDX-License-Identifier: MIT
 *
 * What values look like: the arithmetic of the display pass, for pictures and counts that are made
 * on the host. Pure functions. */
#ifndef VKAO_VIEW_TONE_H_
#define VKAO_VIEW_TONE_H_

#include <stdint.h>

/* Mode: DISPLAY_AO and so on, of shaders/display.h. */
struct tone {
    uint32_t mode;
    double gain;      /* of the difference */
    double low, high; /* of depth: what is black and white, in values as computed */
    double exposure;  /* of light: a factor */
};

/* Of a texel as shown, in [0,1] once clamped; reference: of the difference. */
void tone_color(const struct tone *tone, const float value[3], double reference, double color[3]);

#endif
