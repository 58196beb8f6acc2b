/* SPDX-License-Identifier: MIT
 *
 * What C and GLSL share about the display pass. Lengths are texels; screen: of the framebuffer,
 * image: of the G-buffer. */
#ifndef VKAO_VIEW_DISPLAY_BLOCK_H_
#define VKAO_VIEW_DISPLAY_BLOCK_H_

#ifdef GL_core_profile
#define UINT uint
#define INT int
#else
#include <stdint.h>
#define UINT uint32_t
#define INT int32_t
#endif

#define DISPLAY_NOTHING 0u    /* background alone */
#define DISPLAY_GREY 1u       /* the first component */
#define DISPLAY_PLAIN 2u      /* rgb as it is */
#define DISPLAY_SRGB 3u       /* linear rgb, encoded */
#define DISPLAY_DIFFERENCE 4u /* the first component to the reference */

#define DISPLAY_BINDING_A 0
#define DISPLAY_BINDING_B 1
#define DISPLAY_BINDING_REFERENCE 2
#define DISPLAY_BINDINGS 3

struct display_block {
    float origin_x, origin_y; /* screen: where the corner of the first image texel is */
    float zoom;               /* screen texels per image texel */
    float wipe;               /* screen: A is shown left of it, B from it on */
    INT offset_x, offset_y;   /* image: the first texel that is shown */
    INT width, height;        /* image: how many are shown */
    UINT mode_a, mode_b;
    UINT line;  /* 1: draw the line at wipe */
    float gain; /* of the difference */
};

#endif
