/* SPDX-License-Identifier: MIT
 *
 * A table of what settings cost, stage by stage: the runs that fill it take turns, beside those of
 * another program, and it can be put out as text, Markdown or JSON. */
#ifndef VKAO_BENCH_TIMINGS_H_
#define VKAO_BENCH_TIMINGS_H_

#include "configs.h"
#include "engine.h"
#include "error.h"
#include "rival.h"
#include "stage_clock.h"
#include "text.h"

#include <cjson/cJSON.h>
#include <stdbool.h>
#include <stddef.h>

/* One setting at one size. */
struct timing {
    struct config config;
    VkExtent2D extent;
    float radius;
    const char *series; /* what varies from row to row: "radius" ...; NULL = nothing does */
    double value;       /* of what varies */
    size_t image;       /* index of the images that it runs on */
    unsigned runs;      /* of those asked for, how many are done */
    float *ms[STAGES];  /* by run; all 0 for stages that the setting lacks */
    double median[STAGES], least[STAGES];
};

struct timings {
    char device[320]; /* its name, and ", LP_NUM_THREADS 1" if that was chosen */
    unsigned runs;
    float radius;
    struct timing *rows;
    size_t count;
};

/* A row more; NULL if memory runs out. Pointers to earlier rows become invalid. */
struct timing *timings_add(struct timings *timings, const struct config *config, VkExtent2D extent,
                           float radius, struct tool_error *err);
/* Runs the rows from first on, in turns, after a round that does not count; and the other program,
 * if rivals names one, after each round that does. images: one for each index that a row names. */
bool timings_measure(struct timings *timings, size_t first, struct engine *engine,
                     const struct engine_images *images, struct rivals *rivals,
                     struct tool_error *err);
void timings_free(struct timings *timings);

void timings_text(const struct timings *timings, const struct rivals *rivals, struct text *text);
void timings_markdown(const struct timings *timings, struct text *text);
/* For json_write, which deletes it. */
cJSON *timings_json(const struct timings *timings, const struct rivals *rivals);

#endif
