/* SPDX-License-Identifier: MIT
 *
 * What vkao-bench quality has measured, and what it says of it. */
#ifndef VKAO_BENCH_QUALITY_H_
#define VKAO_BENCH_QUALITY_H_

#include "configs.h"
#include "metrics.h"
#include "text.h"

#include <cjson/cJSON.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { FALLOFFS = 2 }; /* vkao_falloff */

/* One setting on one image with one falloff, or a mean over images. NAN = not measured. */
struct quality_cell {
    struct error_scores truth; /* against ray tracing through the scene itself */
    double estimator_rmse;     /* against raymarch; of raymarch its own noise */
    double full_rmse; /* of half resolution: against the same setting at full. NAN = is at full */
    double rmse_to_reference; /* truth.rmse over the error of another program */
    double flicker;           /* of a sequence, which a frame alone has not */
    double ms;                /* GPU time of all stages: the median; of raymarch all passes */
    double ms_per_megatexel;
};

struct quality_image {
    char name[256];
    uint32_t width, height;
    size_t foreground;
    float radius;
    bool is_fitted, has_reference;
    struct quality_cell cells[FALLOFFS][MAX_CONFIGS]; /* by config */
};

struct quality {
    struct config_list configs; /* the yardstick last, if it is wanted */
    bool has_falloff[FALLOFFS];
    bool is_sequence, has_groups, has_reference; /* --sequence, --fitted, --against */
    unsigned runs, passes;
    char device[256]; /* its name */
    struct quality_image *images;
    size_t count;
    double flicker[FALLOFFS][MAX_CONFIGS]; /* of a sequence */
    double tracked_share;                  /* [0,1]: of its points, those that flicker counts */
};

void quality_add_text(const struct quality *quality, struct text *text);
void quality_add_markdown(const struct quality *quality, struct text *text);
/* For json_write, which deletes it. */
cJSON *quality_json(const struct quality *quality);

#endif
