/* SPDX-License-Identifier: MIT */
#include "gbuffer_internal.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { MOST = 300, KINDS = 6 };

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

/* Value i of n: rising, falling, all equal, two values, few values, many. */
static double value(int kind, size_t i, size_t n)
{
    static uint32_t state = 1;
    state = state * 1664525u + 1013904223u;
    switch (kind) {
    case 0:
        return (double)i;
    case 1:
        return (double)(n - i);
    case 2:
        return 7.0;
    case 3:
        return i * 2 < n ? 1.0 : -1.0;
    case 4:
        return (double)(state >> 30);
    default:
        return (double)state / 65536.0 - 1e4;
    }
}

static void median_is_what_sorting_says(void **state)
{
    double values[MOST], sorted[MOST];
    (void)state;
    for (size_t n = 1; n <= MOST; n++) {
        for (int kind = 0; kind < KINDS; kind++) {
            for (size_t i = 0; i < n; i++)
                values[i] = value(kind, i, n);
            memcpy(sorted, values, sizeof sorted);
            qsort(sorted, n, sizeof *sorted, compare);
            assert_memory_equal(&(double){gbuffer_median(values, n)}, &sorted[n / 2],
                                sizeof *sorted);
            /* and none got lost */
            qsort(values, n, sizeof *values, compare);
            assert_memory_equal(values, sorted, n * sizeof *values);
        }
    }
}

static void nothing_has_no_median(void **state)
{
    (void)state;
    assert_true(gbuffer_median(NULL, 0) <= 0.0 && gbuffer_median(NULL, 0) >= 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(median_is_what_sorting_says),
        cmocka_unit_test(nothing_has_no_median),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
