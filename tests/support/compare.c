/* SPDX-License-Identifier: MIT */
#include "fixture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static int ascending(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

struct difference difference_of(const double *a, const double *b, size_t count)
{
    struct difference d = {0.0, 0.0, 0.0};
    double *sorted = test_alloc(count, sizeof *sorted);
    for (size_t i = 0; i < count; ++i) {
        double delta = fabs(a[i] - b[i]);
        sorted[i] = isnan(delta) ? (double)INFINITY : delta;
        d.mean += sorted[i] / (double)count;
    }
    qsort(sorted, count, sizeof *sorted, ascending);
    d.max = sorted[count - 1];
    d.p99 = sorted[(count - 1) * 99 / 100];
    free(sorted);
    return d;
}

void check_close(const char *what, const double *a, const double *b, size_t count, double mean,
                 double p99, double max)
{
    struct difference d = difference_of(a, b, count);
    print_message("    %-44s max %.2e  mean %.2e  p99 %.2e\n", what, d.max, d.mean, d.p99);
    if (!(d.mean <= mean) || !(d.p99 <= p99) || !(d.max <= max))
        fail_msg("%s: mean %g, p99 %g, max %g, want at most %g, %g, %g", what, d.mean, d.p99, d.max,
                 mean, p99, max);
}

void check_equal(const char *what, const double *a, const double *b, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        if (!(a[i] == b[i]))
            fail_msg("%s: value %zu is %.9g, want %.9g", what, i, a[i], b[i]);
    }
}

double mean_of(const double *v, size_t count)
{
    double sum = 0.0;
    for (size_t i = 0; i < count; ++i)
        sum += v[i];
    return sum / (double)count;
}
