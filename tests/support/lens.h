/* SPDX-License-Identifier: MIT
 *
 * Projections of every convention, and depths encoded as each wants them. */
#ifndef VKAO_TESTS_LENS_H_
#define VKAO_TESTS_LENS_H_

#include "vkao.h"

#include <stdbool.h>

struct lens {
    bool orthographic;
    /* View-space x and y at NDC -1 and +1: at distance 1 in perspective, anywhere in orthographic
     * views. Unequal sizes are off-centre, y0 > y1 has y up, a fraction of a texel is a jitter. */
    double x0, x1, y0, y1;
    double near,
        far; /* far may be INFINITY in perspective; near may be negative in orthographic views */
    bool reversed;
    double forward; /* -1: the camera looks down -z (right-handed), +1: up z */
    /* minDepth and maxDepth of the viewport, folded into the matrix. Both 0: 0 and 1. */
    double depth_min, depth_max;
};

/* Symmetric, y down, right-handed, near 0.1, far 100; half_width and half_height as x1 and y1. */
struct lens lens_perspective(double half_width, double half_height);
struct lens lens_orthographic(double half_width, double half_height);
void lens_matrix(const struct lens *lens, float matrix[16]);
/* What the depth image holds for view z (positive, INFINITY = background) at NDC position x, y. */
double lens_encode(const struct lens *lens, vkao_depth_encoding encoding, double x, double y,
                   double z);

#endif
