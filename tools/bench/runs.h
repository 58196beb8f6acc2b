/* SPDX-License-Identifier: MIT
 *
 * What is made of the times of several runs. */
#ifndef VKAO_BENCH_RUNS_H_
#define VKAO_BENCH_RUNS_H_

#include <stddef.h>

enum { MAX_RUNS = 1000 };

/* Linear between ranks, of the values that are not NaN, at most MAX_RUNS; NaN if there is none. */
double runs_median(const float *values, size_t count);
/* The median over the runs of ours / theirs, less those in which theirs is not above 0. */
double runs_ratio(const float *ours, const float *theirs, size_t count);

/* Four digits, or "-" for what is not above 0. */
void runs_format_ms(double ms, char *text, size_t size);

#endif
