/* SPDX-License-Identifier: MIT
 *
 * How much an AO image flickers while the camera moves: every texel of the first frame is a point
 * of the world, which is looked for in each frame. What changes in time of its error is flicker, as
 * its truth may change, and a constant error disturbs nobody. */
#ifndef VKAO_BENCH_FLICKER_H_
#define VKAO_BENCH_FLICKER_H_

#include "corpus.h"
#include "error.h"
#include "metrics.h"

#include <stddef.h>
#include <stdint.h>

enum { FLICKER_SLOTS = 128 };

struct track_point;
struct track_moments;

/* Zero-initialise. */
struct flicker {
    char first[256];        /* name of the first frame */
    uint32_t width, height; /* of its display window */
    struct track_point *points;
    size_t count;
    size_t *texels;         /* of each point in the last frame; SIZE_MAX = not seen there */
    unsigned frames, *seen; /* so far, and by each point */
    struct track_moments *slots[FLICKER_SLOTS]; /* of errors, by setting and point */
};

/* The next frame: where the points are in it. A point is seen if the texel nearest to it has its
 * depth within 1 %, or that of its tangent plane, and its normal within 10 degrees. Errors:
 * EXIT_INPUT for frames of another size or without what places them in the world, naming the file;
 * EXIT_MEMORY. */
bool flicker_track(struct flicker *flicker, const struct scene *scene, struct tool_error *err);
/* The errors of a setting on the frame that was tracked last, once for each frame. slot is the
 * setting, below FLICKER_SLOTS. Errors: EXIT_MEMORY. */
bool flicker_add(struct flicker *flicker, size_t slot, const struct image_pair *pair,
                 struct tool_error *err);
/* RMS over points of the standard deviation of the error in time, of points that half of the
 * frames have seen, and at least 3. NAN without any. */
double flicker_of(const struct flicker *flicker, size_t slot);
/* [0,1]: of the points, those that it counts. */
double flicker_share(const struct flicker *flicker);
void flicker_free(struct flicker *flicker);

#endif
