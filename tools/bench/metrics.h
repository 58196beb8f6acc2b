/* SPDX-License-Identifier: MIT
 *
 * How far an AO image is from another one. */
#ifndef VKAO_BENCH_METRICS_H_
#define VKAO_BENCH_METRICS_H_

#include "error.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Two images of one size, rows from the top, and the texels of them that count. */
struct image_pair {
    uint32_t width, height;
    const float *result, *truth; /* visibility; what is not finite in result counts as 9 */
    const uint8_t *mask;         /* 0 = background, left out; NULL = every texel counts */
};

/* Over the texels that count; all 0 if there is none. error = result - truth. */
struct error_scores {
    double rmse; /* root of the mean squared error */
    double mae;  /* mean absolute error */
    double bias; /* mean error: > 0 is too bright */
    double p99;  /* absolute error that 99 % stay below, interpolated between ranks */
    /* Structural similarity (Wang et al. 2004), 1 = same: 7x7 windows of equal weight, the image
     * continued by its edge, constants .01^2 and .03^2; background takes part in the windows. */
    double ssim;
    size_t texels;
};

/* Errors: EXIT_MEMORY. */
bool metrics_compare(const struct image_pair *pair, struct error_scores *scores,
                     struct tool_error *err);
double metrics_rmse(const struct image_pair *pair);
/* Of one texel: result - truth. */
double metrics_error(const struct image_pair *pair, size_t texel);

/* Linear between ranks, q in [0,1]; sorts values. 0 without values. */
double metrics_quantile(float *values, size_t count, double q);

#endif
