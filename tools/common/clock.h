/* SPDX-License-Identifier: MIT */
#ifndef VKAO_TOOLS_CLOCK_H_
#define VKAO_TOOLS_CLOCK_H_

#include <time.h>

/* Milliseconds of a clock that nobody sets. */
static inline double now_ms(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

#endif
