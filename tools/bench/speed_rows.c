/* SPDX-License-Identifier: MIT
 *
 * Rows of results, and the runs that fill them. */
#include "speed.h"

#include "metrics.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

struct speed_row *speed_add_row(struct speed *speed, const struct config *config, VkExtent2D extent,
                                float radius, struct tool_error *err)
{
    struct speed_row *rows = realloc(speed->rows, (speed->count + 1) * sizeof *rows);
    if (rows)
        speed->rows = rows;
    float *ms = rows ? calloc((size_t)STAGES * speed->runs, sizeof *ms) : NULL;
    if (!ms) {
        fail(err, EXIT_MEMORY, "out of memory");
        return NULL;
    }
    struct speed_row *row = &rows[speed->count++];
    *row = (struct speed_row){.config = *config, .extent = extent, .radius = radius};
    snprintf(row->name, sizeof row->name, "%s", config->name);
    for (int s = 0; s < STAGES; s++)
        row->ms[s] = ms + (size_t)s * speed->runs;
    return row;
}

static void take(struct speed_row *row, const double ms[STAGES])
{
    for (int s = 0; s < STAGES; s++)
        row->ms[s][row->runs] = (float)ms[s];
    row->runs++;
}

/* Every row once; run < 0 does not count. */
static bool run_round(struct speed_device *d, struct speed *speed, size_t first,
                      const struct speed_images *images, int run, struct tool_error *err)
{
    for (size_t i = first; i < speed->count; i++) {
        struct speed_row *row = &speed->rows[i];
        double ms[STAGES];
        if (!speed_run_once(d, &images[row->image], &row->config, row->radius, ms, err))
            return false;
        if (run >= 0)
            take(row, ms);
    }
    return true;
}

bool speed_measure(struct speed_device *d, struct speed *speed, size_t first,
                   const struct speed_images *images, struct speed_vs *vs, struct tool_error *err)
{
    for (int run = -1; run < (int)speed->runs; run++) {
        if (!run_round(d, speed, first, images, run, err))
            return false;
        if (run >= 0 && vs->command && !speed_vs_run(vs, (unsigned)run, err))
            return false;
    }
    return true;
}

double speed_now_ms(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

double speed_median(const float *values, size_t count)
{
    float known[MAX_RUNS];
    size_t n = 0;
    for (size_t i = 0; i < count && n < MAX_RUNS; i++)
        if (!isnan(values[i]))
            known[n++] = values[i];
    return n ? metrics_quantile(known, n, 0.5) : NAN;
}

void speed_finish(struct speed *speed)
{
    for (size_t i = 0; i < speed->count; i++) {
        struct speed_row *row = &speed->rows[i];
        for (int s = 0; s < STAGES; s++) {
            row->median[s] = speed_median(row->ms[s], row->runs);
            row->least[s] = INFINITY;
            for (unsigned r = 0; r < row->runs; r++)
                row->least[s] = fmin(row->least[s], (double)row->ms[s][r]);
        }
    }
}

void speed_free(struct speed *speed)
{
    for (size_t i = 0; i < speed->count; i++)
        free(speed->rows[i].ms[0]);
    free(speed->rows);
    *speed = (struct speed){0};
}
