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
#define DISPLAY_AO 1u         /* the first component, 1 where it is held out */
#define DISPLAY_DEPTH 2u      /* the first component in a range; 0 where nothing is */
#define DISPLAY_PLAIN 3u      /* rgb as it is */
#define DISPLAY_SRGB 4u       /* linear rgb, encoded */
#define DISPLAY_LIT 5u        /* the same, with the light that AO left alone */
#define DISPLAY_DIFFERENCE 6u /* AO to the reference */

#define DISPLAY_BINDING_A 0
#define DISPLAY_BINDING_B 1
#define DISPLAY_BINDING_REFERENCE 2
#define DISPLAY_BINDING_KEPT 3   /* rgb: light that AO left alone, a: holdout */
#define DISPLAY_BINDING_BEFORE 4 /* colour as it was, where there is holdout */
#define DISPLAY_BINDINGS 5

struct display_block {
    float origin_x, origin_y; /* screen: where the corner of the first image texel is */
    float zoom;               /* screen texels per image texel */
    float wipe;               /* screen: A is shown left of it, B from it on */
    INT offset_x, offset_y;   /* image: the first texel that is shown */
    INT width, height;        /* image: how many are shown */
    UINT mode_a, mode_b;
    UINT line;       /* 1: draw the line at wipe */
    float gain;      /* of the difference */
    float low, high; /* of depth: what is black and white, in values of the image */
    float exposure;  /* of light: a factor */
    UINT is_kept;    /* 1: KEPT and BEFORE are images, of width x height */
};

#endif
