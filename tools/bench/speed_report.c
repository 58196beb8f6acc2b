/* SPDX-License-Identifier: MIT */
#include "speed.h"

#include "json.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { NAME_WIDTH = 18, STAGE_WIDTH = 10, RIVAL_WIDTH = 11, RIVALS_IN_A_ROW = 7 };

static double texels(const struct speed_row *row)
{
    return (double)row->extent.width * row->extent.height;
}

/* Columns of stages that nothing has are left out. */
static bool is_used(const struct speed *speed, int stage)
{
    for (size_t i = 0; i < speed->count; i++)
        if (speed->rows[i].median[stage] > 0)
            return true;
    return stage == STAGE_TOTAL;
}

static bool same_size(const struct speed_row *a, const struct speed_row *b)
{
    return a->extent.width == b->extent.width && a->extent.height == b->extent.height;
}

void speed_format_ms(double ms, char *text, size_t size)
{
    int decimals = ms < 0.1 ? 4 : ms < 1 ? 3 : ms < 100 ? 2 : ms < 1000 ? 1 : 0;
    if (ms > 0)
        snprintf(text, size, "%.*f", decimals, ms);
    else
        snprintf(text, size, "-");
}

static void add_ms(struct text *text, int width, double ms)
{
    char number[32];
    speed_format_ms(ms, number, sizeof number);
    text_add(text, "%*s", width, number);
}

/* --- Text --- */

static void add_stages(const struct speed *speed, struct text *text)
{
    for (size_t i = 0; i < speed->count; i++) {
        const struct speed_row *row = &speed->rows[i];
        if (i == 0 || !same_size(row, row - 1)) {
            text_add(text, "\n%-*s", NAME_WIDTH, "ms");
            for (int s = 0; s < STAGES; s++)
                if (is_used(speed, s))
                    text_add(text, "%*s", STAGE_WIDTH, stage_name((enum stage)s));
            text_add(text, "%*s%*s   %u x %u\n", STAGE_WIDTH, "least", STAGE_WIDTH, "ns/texel",
                     row->extent.width, row->extent.height);
        }
        text_add(text, "%-*s", NAME_WIDTH, row->name);
        for (int s = 0; s < STAGES; s++)
            if (is_used(speed, s))
                add_ms(text, STAGE_WIDTH, row->median[s]);
        add_ms(text, STAGE_WIDTH, row->least[STAGE_TOTAL]);
        add_ms(text, STAGE_WIDTH, row->median[STAGE_TOTAL] * 1e6 / texels(row));
        text_add(text, "\n");
    }
}

/* False if there are none. */
static bool add_namesakes(const struct speed *speed, const struct speed_vs *vs, struct text *text)
{
    bool any = false;
    for (size_t i = 0; i < speed->count; i++) {
        const struct speed_row *row = &speed->rows[i];
        for (int s = 0; s < STAGES; s++) {
            const struct rival *rival = speed_vs_namesake(vs, row, (enum stage)s);
            if (!rival || !(row->median[s] > 0))
                continue;
            if (!any)
                text_add(text, "\n%-*s%*s%*s%*s\n", NAME_WIDTH + STAGE_WIDTH, "same names",
                         STAGE_WIDTH, "ours", STAGE_WIDTH, "theirs", STAGE_WIDTH, "/");
            any = true;
            text_add(text, "%-*s%-*s", NAME_WIDTH, row->name, STAGE_WIDTH,
                     stage_name((enum stage)s));
            add_ms(text, STAGE_WIDTH, row->median[s]);
            add_ms(text, STAGE_WIDTH, rival->median);
            text_add(text, "%*.3f\n", STAGE_WIDTH,
                     speed_vs_ratio(row, (enum stage)s, rival, row->runs));
        }
    }
    return any;
}

/* Every stage of ours over some of theirs. */
static void add_ratios(const struct speed *speed, const struct speed_vs *vs, size_t begin,
                       size_t end, struct text *text)
{
    text_add(text, "\n%-*s%*s", NAME_WIDTH + STAGE_WIDTH, "ours / theirs", STAGE_WIDTH, "ms");
    for (size_t v = begin; v < end; v++)
        text_add(text, " %*.*s", RIVAL_WIDTH, RIVAL_WIDTH, vs->rivals[v].name);
    text_add(text, "\n%-*s", NAME_WIDTH + 2 * STAGE_WIDTH, "  theirs");
    for (size_t v = begin; v < end; v++)
        add_ms(text, RIVAL_WIDTH + 1, vs->rivals[v].median);
    text_add(text, "\n");
    for (size_t i = 0; i < speed->count; i++) {
        const struct speed_row *row = &speed->rows[i];
        for (int s = 0; s < STAGES; s++) {
            if (!(row->median[s] > 0))
                continue;
            text_add(text, "%-*s%-*s", NAME_WIDTH, row->name, STAGE_WIDTH,
                     stage_name((enum stage)s));
            add_ms(text, STAGE_WIDTH, row->median[s]);
            for (size_t v = begin; v < end; v++)
                add_ms(text, RIVAL_WIDTH + 1,
                       speed_vs_ratio(row, (enum stage)s, &vs->rivals[v], row->runs));
            text_add(text, "\n");
        }
    }
}

static void add_vs(const struct speed *speed, const struct speed_vs *vs, struct text *text)
{
    text_add(text, "\nin turn with '%s': ", vs->command);
    add_ms(text, 0, vs->rivals[0].median);
    text_add(text, " ms a run of it\nratios are medians of those of each run\n");
    if (add_namesakes(speed, vs, text))
        return; /* another vkao-bench: what has not the same name is not the same thing */
    /* The whole process, with its start and its files, is no match for a stage if it tells more. */
    for (size_t v = vs->count > 1; v < vs->count; v += RIVALS_IN_A_ROW)
        add_ratios(speed, vs, v, v + RIVALS_IN_A_ROW < vs->count ? v + RIVALS_IN_A_ROW : vs->count,
                   text);
}

void speed_text(const struct speed *speed, const struct speed_vs *vs, struct text *text)
{
    text_add(text, "%s%s, radius %g, medians of %u interleaved run%s\n", speed->device,
             speed->threads, (double)speed->radius, speed->runs, speed->runs == 1 ? "" : "s");
    add_stages(speed, text);
    if (vs->count)
        add_vs(speed, vs, text);
}

/* --- Markdown --- */

void speed_markdown(const struct speed *speed, struct text *text)
{
    text_add(text, "Milliseconds on %s%s, radius %g, medians of %u interleaved runs:\n\n",
             speed->device, speed->threads, (double)speed->radius, speed->runs);
    text_add(text, "| setting | | size |");
    for (int s = 0; s < STAGES; s++)
        if (is_used(speed, s))
            text_add(text, " %s |", stage_name((enum stage)s));
    text_add(text, "\n|---|---|---|");
    for (int s = 0; s < STAGES; s++)
        if (is_used(speed, s))
            text_add(text, "---:|");
    text_add(text, "\n");
    for (size_t i = 0; i < speed->count; i++) {
        const struct speed_row *row = &speed->rows[i];
        char description[64], number[32];
        config_describe(&row->config, description, sizeof description);
        text_add(text, "| %s | %s | %u × %u |", row->name, description, row->extent.width,
                 row->extent.height);
        for (int s = 0; s < STAGES; s++) {
            if (!is_used(speed, s))
                continue;
            speed_format_ms(row->median[s], number, sizeof number);
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

static void add_row(cJSON *list, const struct speed_row *row, int stage, const struct speed_vs *vs)
{
    cJSON *object =
        add_entry(list, row->name, stage_name((enum stage)stage), row->median[stage], row->runs);
    json_add_number(object, "least_ms", row->least[stage]);
    cJSON_AddNumberToObject(object, "width", row->extent.width);
    cJSON_AddNumberToObject(object, "height", row->extent.height);
    json_add_number(object, "radius", (double)row->radius);
    if (row->series != SERIES_NONE)
        cJSON_AddStringToObject(object, "series", speed_series_name(row->series));
    if (vs->count == 0)
        return;
    cJSON *ratios = cJSON_AddObjectToObject(object, "ratios");
    for (size_t v = 0; v < vs->count; v++)
        json_add_number(ratios, vs->rivals[v].name,
                        speed_vs_ratio(row, (enum stage)stage, &vs->rivals[v], row->runs));
}

cJSON *speed_json(const struct speed *speed, const struct speed_vs *vs)
{
    cJSON *list = cJSON_CreateArray();
    for (size_t i = 0; i < speed->count; i++)
        for (int s = 0; s < STAGES; s++)
            if (speed->rows[i].median[s] > 0)
                add_row(list, &speed->rows[i], s, vs);
    for (size_t v = 0; v < vs->count; v++) {
        char name[SPEED_NAME + 4];
        snprintf(name, sizeof name, "vs %s", vs->rivals[v].name);
        add_entry(list, name, stage_name(STAGE_TOTAL), vs->rivals[v].median, speed->runs);
    }
    return list;
}
