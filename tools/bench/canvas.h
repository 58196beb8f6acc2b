/* SPDX-License-Identifier: MIT
 *
 * A small RGB raster: smooth lines and discs, and text in a fixed 5x7 font. */
#ifndef VKAO_BENCH_CANVAS_H_
#define VKAO_BENCH_CANVAS_H_

#include "error.h"

#include <stdbool.h>
#include <stdint.h>

struct canvas {
    uint32_t width, height;
    uint8_t *pixels; /* width * height * 3, sRGB */
};

struct rgb {
    uint8_t r, g, b;
};

/* Pixel coordinates: (0,0) is the outer corner of the first pixel, y goes down. */
struct point {
    double x, y;
};

enum marker { MARKER_DISC, MARKER_SQUARE, MARKER_DIAMOND, MARKER_TRIANGLE, MARKERS };

/* White. Errors: EXIT_MEMORY. */
bool canvas_create(struct canvas *canvas, uint32_t width, uint32_t height, struct tool_error *err);
void canvas_free(struct canvas *canvas);

/* Between two corners, smooth at the edges. */
void canvas_fill(struct canvas *canvas, struct point from, struct point to, struct rgb color);
/* dash: pixels drawn and then left out, in turn; 0 = solid. */
void canvas_line(struct canvas *canvas, struct point from, struct point to, double thickness,
                 double dash, struct rgb color);
/* With a white rim, so that markers on one another stay apart. */
void canvas_marker(struct canvas *canvas, enum marker marker, struct point centre, double radius,
                   struct rgb color);

/* at: the upper left corner. What the font lacks is left blank. */
void canvas_text(struct canvas *canvas, const char *text, struct point at, unsigned scale,
                 struct rgb color);
/* The same, read from below. */
void canvas_text_upwards(struct canvas *canvas, const char *text, struct point at, unsigned scale,
                         struct rgb color);
double canvas_text_width(const char *text, unsigned scale);
/* Without descenders. */
double canvas_text_height(unsigned scale);

#endif
