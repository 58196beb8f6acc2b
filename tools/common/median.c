/* SPDX-License-Identifier: MIT
 *
 * Hoare's FIND: sorts no more than it takes to know what stands in the middle. What is left after
 * MEDIAN_MOST_ROUNDS is sorted. */
#include "median.h"

#include <stdlib.h>

static int compare_doubles(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

double median_of(double *values, size_t count)
{
    const ptrdiff_t middle = (ptrdiff_t)(count / 2);
    ptrdiff_t low = 0, high = (ptrdiff_t)count - 1;
    for (int rounds = 0; low < high; rounds++) {
        if (rounds == MEDIAN_MOST_ROUNDS) {
            qsort(values + low, (size_t)(high - low) + 1, sizeof *values, compare_doubles);
            break;
        }
        const double pivot = values[middle];
        ptrdiff_t i = low, j = high;
        while (i <= j) {
            while (values[i] < pivot)
                i++;
            while (pivot < values[j])
                j--;
            if (i > j)
                break;
            const double moved = values[i];
            values[i++] = values[j];
            values[j--] = moved;
        }
        if (j < middle)
            low = i;
        if (middle < i)
            high = j;
    }
    return count ? values[middle] : 0.0;
}
