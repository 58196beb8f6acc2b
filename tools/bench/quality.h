/* SPDX-License-Identifier: MIT
 *
 * Results of `vkao-bench quality`, and the forms in which they are put out. */
#ifndef VKAO_BENCH_QUALITY_H_
#define VKAO_BENCH_QUALITY_H_

#include "configs.h"
#include "error.h"
#include "metrics.h"
#include "text.h"

#include <cjson/cJSON.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { FALLOFFS = 2 }; /* vkao_falloff */

/* One setting on one image with one falloff. */
struct quality_cell {
    struct error_scores truth; /* against ray tracing through the scene itself */
    double estimator_rmse;     /* against raymarch; of raymarch its own noise. NAN = not measured */
    double full_rmse; /* of half resolution: against the same setting at full. NAN = is at full */
    double ms;        /* GPU time of all stages: the median; of raymarch the sum of its passes */
    double ms_per_megatexel;
};

struct quality_image {
    char name[256];
    uint32_t width, height;
    size_t foreground;
    float radius;
    struct quality_cell cells[FALLOFFS][MAX_CONFIGS]; /* by config */
};

struct quality {
    struct config_list configs; /* the yardstick last, if it is wanted */
    bool has_falloff[FALLOFFS];
    unsigned runs, passes;
    char device[256]; /* its name */
    struct quality_image *images;
    size_t count;
};

/* Over the images: the arithmetic mean of bias and ssim, which may be 0 or negative, and the
 * geometric mean of the rest. */
struct quality_cell quality_mean(const struct quality *quality, int falloff, size_t config);

const char *falloff_name(int falloff);

void quality_text(const struct quality *quality, struct text *text);
void quality_markdown(const struct quality *quality, struct text *text);
/* For json_write, which deletes it. */
cJSON *quality_json(const struct quality *quality);
/* Error over time, log-log, one panel per falloff. Errors: EXIT_OUTPUT, EXIT_MEMORY. */
bool quality_plot(const struct quality *quality, const char *path, struct tool_error *err);

#endif
