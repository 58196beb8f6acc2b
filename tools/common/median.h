/* SPDX-License-Identifier: MIT */
#ifndef VKAO_TOOLS_MEDIAN_H_
#define VKAO_TOOLS_MEDIAN_H_

#include <stddef.h>

/* Rounds halve what is left, more or less, unless values are laid out to make them slow. */
enum { MEDIAN_MOST_ROUNDS = 64 };

/* Moves values about; 0 if there are none. */
double median_of(double *values, size_t count);

#endif
