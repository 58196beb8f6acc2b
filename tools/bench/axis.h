/* SPDX-License-Identifier: MIT
 *
 * Logarithmic axes of a plot. */
#ifndef VKAO_BENCH_AXIS_H_
#define VKAO_BENCH_AXIS_H_

#include "canvas.h"

enum { AXIS_TEXT_SCALE = 2 };

struct axis {
    double low, high;  /* of the values; begin with {.low = INFINITY, .high = 0} */
    double start, end; /* of the pixels */
};

double axis_place(const struct axis *axis, double value);

/* Values that are not finite and above 0 are left out. */
void axis_include(struct axis *axis, double value);
/* Room around the values, and at least a factor of two. */
void axis_widen(struct axis *axis, double factor);

/* Frame, ticks, grid and what stands at its three sides: above, below, and left of it. */
void axes_draw(struct canvas *canvas, const struct axis *x, const struct axis *y, const char *title,
               const char *across, const char *up);

#endif
