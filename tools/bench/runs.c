/* SPDX-License-Identifier: MIT */
#include "runs.h"

#include "metrics.h"

#include <math.h>
#include <stdio.h>

double runs_median(const float *values, size_t count)
{
    float known[MAX_RUNS];
    size_t n = 0;
    for (size_t i = 0; i < count && n < MAX_RUNS; i++)
        if (!isnan(values[i]))
            known[n++] = values[i];
    return n ? metrics_quantile(known, n, 0.5) : NAN;
}

double runs_ratio(const float *ours, const float *theirs, size_t count)
{
    float ratios[MAX_RUNS];
    size_t n = 0;
    for (size_t i = 0; i < count && n < MAX_RUNS; i++)
        if (theirs[i] > 0)
            ratios[n++] = ours[i] / theirs[i];
    return runs_median(ratios, n);
}

void runs_format_ms(double ms, char *text, size_t size)
{
    int decimals = ms < 0.1 ? 4 : ms < 1 ? 3 : ms < 100 ? 2 : ms < 1000 ? 1 : 0;
    if (ms > 0)
        snprintf(text, size, "%.*f", decimals, ms);
    else
        snprintf(text, size, "-");
}
