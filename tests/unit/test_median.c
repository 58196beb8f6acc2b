/* SPDX-License-Identifier: MIT */
#include "median.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
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

/* An adversary (McIlroy, 'A Killer Adversary for Quicksort', 1999): decides what values are while
 * they are compared, so that every round gets rid of little. */
struct adversary {
    double values[MOST];
    double solid; /* smaller ones are decided */
    size_t candidate;
};

static bool is_less(struct adversary *a, size_t x, size_t y)
{
    const double gas = MOST;
    if (a->values[x] >= gas && a->values[y] >= gas)
        a->values[x == a->candidate ? x : y] = a->solid++;
    if (a->values[x] >= gas)
        a->candidate = x;
    else if (a->values[y] >= gas)
        a->candidate = y;
    return a->values[x] < a->values[y];
}

/* Rounds that FIND needs for what the adversary makes it meet. */
static int find_against(struct adversary *a)
{
    size_t at[MOST];
    const ptrdiff_t middle = MOST / 2;
    ptrdiff_t low = 0, high = MOST - 1;
    int rounds = 0;
    for (size_t i = 0; i < MOST; i++) {
        at[i] = i;
        a->values[i] = MOST;
    }
    for (; low < high; rounds++) {
        const size_t pivot = at[middle];
        ptrdiff_t i = low, j = high;
        while (i <= j) {
            while (is_less(a, at[i], pivot))
                i++;
            while (is_less(a, pivot, at[j]))
                j--;
            if (i > j)
                break;
            const size_t moved = at[i];
            at[i++] = at[j];
            at[j--] = moved;
        }
        if (j < middle)
            low = i;
        if (middle < i)
            high = j;
    }
    return rounds;
}

static void killers_are_sorted(void **state)
{
    (void)state;
    static struct adversary a;
    double sorted[MOST];
    const int rounds = find_against(&a);
    assert_true(rounds > MEDIAN_MOST_ROUNDS);
    memcpy(sorted, a.values, sizeof sorted);
    qsort(sorted, MOST, sizeof *sorted, compare);
    assert_memory_equal(&(double){median_of(a.values, MOST)}, &sorted[MOST / 2], sizeof *sorted);
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
            assert_memory_equal(&(double){median_of(values, n)}, &sorted[n / 2], sizeof *sorted);
            /* and none got lost */
            qsort(values, n, sizeof *values, compare);
            assert_memory_equal(values, sorted, n * sizeof *values);
        }
    }
}

static void nothing_has_no_median(void **state)
{
    (void)state;
    assert_true(median_of(NULL, 0) <= 0.0 && median_of(NULL, 0) >= 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(median_is_what_sorting_says),
        cmocka_unit_test(killers_are_sorted),
        cmocka_unit_test(nothing_has_no_median),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
