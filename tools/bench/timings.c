/* SPDX-License-Identifier: MIT */
#include "timings.h"

#include "json.h"
#include "runs.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* --- Rows, and the runs that fill them --- */

struct timing *timings_add(struct timings *t, const struct config *config, VkExtent2D extent,
                           float radius, struct tool_error *err)
{
    struct timing *rows = realloc(t->rows, (t->count + 1) * sizeof *rows);
    if (rows)
        t->rows = rows;
    float *ms = rows ? calloc((size_t)STAGES * t->runs, sizeof *ms) : NULL;
    if (!ms) {
        fail(err, EXIT_MEMORY, "out of memory");
        return NULL;
    }
    struct timing *row = &rows[t->count++];
    *row = (struct timing){.config = *config, .extent = extent, .radius = radius};
    for (int s = 0; s < STAGES; s++)
        row->ms[s] = ms + (size_t)s * t->runs;
    return row;
}

static void take(struct timing *row, const double ms[STAGES])
{
    for (int s = 0; s < STAGES; s++)
        row->ms[s][row->runs] = (float)ms[s];
    row->runs++;
}

/* Every row once; run < 0 does not count. */
static bool run_round(struct timings *t, size_t first, struct engine *engine,
                      const struct engine_images *images, int run, struct tool_error *err)
{
    for (size_t i = first; i < t->count; i++) {
        struct timing *row = &t->rows[i];
        double ms[STAGES];
        if (!engine_run(engine, &images[row->image], &row->config, row->radius, ms, err))
            return false;
        if (run >= 0)
            take(row, ms);
    }
    return true;
}

static void finish(struct timings *t, size_t first)
{
    for (size_t i = first; i < t->count; i++) {
        struct timing *row = &t->rows[i];
        for (int s = 0; s < STAGES; s++) {
            row->median[s] = runs_median(row->ms[s], row->runs);
            row->least[s] = INFINITY;
            for (unsigned r = 0; r < row->runs; r++)
                row->least[s] = fmin(row->least[s], (double)row->ms[s][r]);
        }
    }
}

bool timings_measure(struct timings *t, size_t first, struct engine *engine,
                     const struct engine_images *images, struct rivals *rivals,
                     struct tool_error *err)
{
    for (int run = -1; run < (int)t->runs; run++) {
        if (!run_round(t, first, engine, images, run, err))
            return false;
        if (run >= 0 && rivals->command && !rivals_run(rivals, (unsigned)run, err))
            return false;
    }
    finish(t, first);
    return true;
}

void timings_free(struct timings *t)
{
    for (size_t i = 0; i < t->count; i++)
        free(t->rows[i].ms[0]);
    free(t->rows);
    *t = (struct timings){0};
}

/* --- What all reports need --- */

enum { NAME_WIDTH = 18, STAGE_WIDTH = 10, RIVAL_WIDTH = 11, RIVALS_IN_A_ROW = 7 };

static double texels(const struct timing *row)
{
    return (double)row->extent.width * row->extent.height;
}

/* Columns of stages that nothing has are left out. */
static bool is_used(const struct timings *t, int stage)
{
    for (size_t i = 0; i < t->count; i++)
        if (t->rows[i].median[stage] > 0)
            return true;
    return stage == STAGE_TOTAL;
}

static bool same_size(const struct timing *a, const struct timing *b)
{
    return a->extent.width == b->extent.width && a->extent.height == b->extent.height;
}

static void add_ms(struct text *text, int width, double ms)
{
    char number[32];
    runs_format_ms(ms, number, sizeof number);
    text_add(text, "%*s", width, number);
}

/* --- Text --- */

static void add_stages(const struct timings *t, struct text *text)
{
    for (size_t i = 0; i < t->count; i++) {
        const struct timing *row = &t->rows[i];
        if (i == 0 || !same_size(row, row - 1)) {
            text_add(text, "\n%-*s", NAME_WIDTH, "ms");
            for (int s = 0; s < STAGES; s++)
                if (is_used(t, s))
                    text_add(text, "%*s", STAGE_WIDTH, stage_name((enum stage)s));
            text_add(text, "%*s%*s   %u x %u\n", STAGE_WIDTH, "least", STAGE_WIDTH, "ns/texel",
                     row->extent.width, row->extent.height);
        }
        text_add(text, "%-*s", NAME_WIDTH, row->config.name);
        for (int s = 0; s < STAGES; s++)
            if (is_used(t, s))
                add_ms(text, STAGE_WIDTH, row->median[s]);
        add_ms(text, STAGE_WIDTH, row->least[STAGE_TOTAL]);
        add_ms(text, STAGE_WIDTH, row->median[STAGE_TOTAL] * 1e6 / texels(row));
        text_add(text, "\n");
    }
}

/* The figure of the same name, as another vkao-bench prints it; NULL if there is none. */
static const struct rival *namesake(const struct rivals *rivals, const struct timing *row,
                                    enum stage stage)
{
    char name[RIVAL_NAME];
    snprintf(name, sizeof name, "%s %s", row->config.name, stage_name(stage));
    return rivals_find(rivals, name);
}

/* The median over the runs of ours / theirs. */
static double ratio(const struct timing *row, enum stage stage, const struct rival *rival)
{
    return runs_ratio(row->ms[stage], rival->ms, row->runs);
}

/* False if there are none. */
static bool add_namesakes(const struct timings *t, const struct rivals *rivals, struct text *text)
{
    bool any = false;
    for (size_t i = 0; i < t->count; i++) {
        const struct timing *row = &t->rows[i];
        for (int s = 0; s < STAGES; s++) {
            const struct rival *rival = namesake(rivals, row, (enum stage)s);
            if (!rival || !(row->median[s] > 0))
                continue;
            if (!any)
                text_add(text, "\n%-*s%*s%*s%*s\n", NAME_WIDTH + STAGE_WIDTH, "same names",
                         STAGE_WIDTH, "ours", STAGE_WIDTH, "theirs", STAGE_WIDTH, "/");
            any = true;
            text_add(text, "%-*s%-*s", NAME_WIDTH, row->config.name, STAGE_WIDTH,
                     stage_name((enum stage)s));
            add_ms(text, STAGE_WIDTH, row->median[s]);
            add_ms(text, STAGE_WIDTH, rival->median);
            text_add(text, "%*.3f\n", STAGE_WIDTH, ratio(row, (enum stage)s, rival));
        }
    }
    return any;
}

/* Every stage of ours over some of theirs. */
static void add_ratios(const struct timings *t, const struct rivals *rivals, size_t begin,
                       size_t end, struct text *text)
{
    text_add(text, "\n%-*s%*s", NAME_WIDTH + STAGE_WIDTH, "ours / theirs", STAGE_WIDTH, "ms");
    for (size_t v = begin; v < end; v++)
        text_add(text, " %*.*s", RIVAL_WIDTH, RIVAL_WIDTH, rivals->list[v].name);
    text_add(text, "\n%-*s", NAME_WIDTH + 2 * STAGE_WIDTH, "  theirs");
    for (size_t v = begin; v < end; v++)
        add_ms(text, RIVAL_WIDTH + 1, rivals->list[v].median);
    text_add(text, "\n");
    for (size_t i = 0; i < t->count; i++) {
        const struct timing *row = &t->rows[i];
        for (int s = 0; s < STAGES; s++) {
            if (!(row->median[s] > 0))
                continue;
            text_add(text, "%-*s%-*s", NAME_WIDTH, row->config.name, STAGE_WIDTH,
                     stage_name((enum stage)s));
            add_ms(text, STAGE_WIDTH, row->median[s]);
            for (size_t v = begin; v < end; v++)
                add_ms(text, RIVAL_WIDTH + 1, ratio(row, (enum stage)s, &rivals->list[v]));
            text_add(text, "\n");
        }
    }
}

static void add_vs(const struct timings *t, const struct rivals *rivals, struct text *text)
{
    text_add(text, "\nin turn with '%s': ", rivals->command);
    add_ms(text, 0, rivals->list[0].median);
    text_add(text, " ms a run of it\nratios are medians of those of each run\n");
    if (add_namesakes(t, rivals, text))
        return; /* another vkao-bench: what has not the same name is not the same thing */
    /* The whole process, with its start and its files, is no match for a stage if it tells more. */
    for (size_t v = rivals->count > 1; v < rivals->count; v += RIVALS_IN_A_ROW)
        add_ratios(t, rivals, v,
                   v + RIVALS_IN_A_ROW < rivals->count ? v + RIVALS_IN_A_ROW : rivals->count, text);
}

void timings_text(const struct timings *t, const struct rivals *rivals, struct text *text)
{
    text_add(text, "%s, radius %g, medians of %u interleaved run%s\n", t->device, (double)t->radius,
             t->runs, t->runs == 1 ? "" : "s");
    add_stages(t, text);
    if (rivals->count)
        add_vs(t, rivals, text);
}

/* --- Markdown --- */

void timings_markdown(const struct timings *t, struct text *text)
{
    text_add(text, "Milliseconds on %s, radius %g, medians of %u interleaved runs:\n\n", t->device,
             (double)t->radius, t->runs);
    text_add(text, "| setting | | size |");
    for (int s = 0; s < STAGES; s++)
        if (is_used(t, s))
            text_add(text, " %s |", stage_name((enum stage)s));
    text_add(text, "\n|---|---|---|");
    for (int s = 0; s < STAGES; s++)
        if (is_used(t, s))
            text_add(text, "---:|");
    text_add(text, "\n");
    for (size_t i = 0; i < t->count; i++) {
        const struct timing *row = &t->rows[i];
        char description[64], number[32];
        config_describe(&row->config, description, sizeof description);
        text_add(text, "| %s | %s | %u × %u |", row->config.name, description, row->extent.width,
                 row->extent.height);
        for (int s = 0; s < STAGES; s++) {
            if (!is_used(t, s))
                continue;
            runs_format_ms(row->median[s], number, sizeof number);
            text_add(text, " %s |", number);
        }
        text_add(text, "\n");
    }
}

/* --- JSON --- */

static cJSON *add_entry(cJSON *list, const char *config, const char *stage, double median,
                        unsigned runs)
{
    cJSON *object = cJSON_CreateObject();
    cJSON_AddItemToArray(list, object);
    cJSON_AddStringToObject(object, "config", config);
    cJSON_AddStringToObject(object, "stage", stage);
    json_add_number(object, "median_ms", median);
    cJSON_AddNumberToObject(object, "runs", runs);
    return object;
}

static void add_row(cJSON *list, const struct timing *row, int stage, const struct rivals *rivals)
{
    cJSON *object = add_entry(list, row->config.name, stage_name((enum stage)stage),
                              row->median[stage], row->runs);
    json_add_number(object, "least_ms", row->least[stage]);
    cJSON_AddNumberToObject(object, "width", row->extent.width);
    cJSON_AddNumberToObject(object, "height", row->extent.height);
    json_add_number(object, "radius", (double)row->radius);
    if (row->series) {
        cJSON_AddStringToObject(object, "series", row->series);
        json_add_number(object, "value", row->value);
    }
    if (rivals->count == 0)
        return;
    cJSON *ratios = cJSON_AddObjectToObject(object, "ratios");
    for (size_t v = 0; v < rivals->count; v++)
        json_add_number(ratios, rivals->list[v].name,
                        ratio(row, (enum stage)stage, &rivals->list[v]));
}

cJSON *timings_json(const struct timings *t, const struct rivals *rivals)
{
    cJSON *list = cJSON_CreateArray();
    for (size_t i = 0; i < t->count; i++)
        for (int s = 0; s < STAGES; s++)
            if (t->rows[i].median[s] > 0)
                add_row(list, &t->rows[i], s, rivals);
    for (size_t v = 0; v < rivals->count; v++) {
        char name[RIVAL_NAME + 4];
        snprintf(name, sizeof name, "vs %s", rivals->list[v].name);
        add_entry(list, name, stage_name(STAGE_TOTAL), rivals->list[v].median, t->runs);
    }
    return list;
}
