/* SPDX-License-Identifier: MIT */
#include "scaling.h"

#include "runs.h"

#include <stdio.h>
#include <string.h>

enum { SMALLER_SIZES = 3, LARGEST = SMALLER_SIZES };

static const char by_pixels[] = "pixels", by_samples[] = "samples", by_radius[] = "radius";

static bool add(struct timings *timings, const char *series, double value, size_t image,
                const struct config *config, VkExtent2D extent, float radius,
                struct tool_error *err)
{
    struct timing *row = timings_add(timings, config, extent, radius, err);
    if (!row)
        return false;
    row->series = series;
    row->value = value;
    row->image = image;
    return true;
}

/* Each size has a fourth of the pixels of the next. */
static VkExtent2D size_of(VkExtent2D largest, int i)
{
    VkExtent2D size = {largest.width >> (LARGEST - i), largest.height >> (LARGEST - i)};
    return (VkExtent2D){size.width ? size.width : 1, size.height ? size.height : 1};
}

/* The same method with other numbers. A preset keeps its method and its slices only. */
static bool add_samples(struct timings *timings, const struct config *config, VkExtent2D extent,
                        struct tool_error *err)
{
    static const unsigned counts[] = {4, 8, 16, 32};
    const bool has_steps = config_reads(config->method, "step_count");
    struct ao_job job = {0};
    config_apply(config, &job);
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
        const unsigned samples = has_steps ? job.setting.effect.sample_count : counts[i];
        const struct config other =
            config_of(config->method, samples, job.setting.effect.slice_count, counts[i]);
        if (!add(timings, by_samples, counts[i], LARGEST, &other, extent, timings->radius, err))
            return false;
    }
    return true;
}

static bool add_rows(struct timings *timings, const struct config *config, VkExtent2D extent,
                     struct tool_error *err)
{
    static const float radii[] = {0.25f, 0.5f, 1.0f, 2.0f, 4.0f};
    for (int i = 0; i <= LARGEST; i++) {
        VkExtent2D size = size_of(extent, i);
        if (!add(timings, by_pixels, (double)size.width * size.height, (size_t)i, config, size,
                 timings->radius, err))
            return false;
    }
    if (!add_samples(timings, config, extent, err))
        return false;
    for (size_t i = 0; i < sizeof radii / sizeof radii[0]; i++) {
        float radius = radii[i] * timings->radius;
        if (!add(timings, by_radius, (double)radius, LARGEST, config, extent, radius, err))
            return false;
    }
    return true;
}

/* For all rows, which have few settings. */
static bool compile_rows(struct engine *engine, const struct timings *timings,
                         struct tool_error *err)
{
    struct config configs[MAX_CONFIGS];
    size_t count = 0;
    for (size_t i = 0; i < timings->count && count < MAX_CONFIGS; i++) {
        size_t known = 0;
        while (known < count && strcmp(configs[known].name, timings->rows[i].config.name) != 0)
            known++;
        if (known == count)
            configs[count++] = timings->rows[i].config;
    }
    return engine_compile(engine, configs, count, err);
}

bool scaling_measure(struct engine *engine, const struct config *config, VkExtent2D extent,
                     unsigned sky, struct timings *timings, struct tool_error *err)
{
    struct engine_images images[LARGEST + 1] = {0};
    struct rivals none = {0};
    bool ok = engine_check_size(engine, extent, err) && add_rows(timings, config, extent, err) &&
              compile_rows(engine, timings, err);
    for (int i = 0; ok && i <= LARGEST; i++) {
        VkExtent2D size = size_of(extent, i);
        struct room room;
        ok = room_create(size.width, size.height, sky, &room, err) &&
             engine_images_create(engine, &room, &images[i], err);
        room_free(&room);
    }
    ok = ok && timings_measure(timings, 0, engine, images, &none, err);
    for (int i = 0; i <= LARGEST; i++)
        engine_images_destroy(engine, &images[i]);
    return ok;
}

/* --- Reports --- */

/* The median over the runs of this row / the one before. */
static double growth(const struct timing *row, enum stage stage)
{
    return runs_ratio(row->ms[stage], row[-1].ms[stage], row->runs);
}

static void add_row(const struct timing *row, bool has_previous, bool markdown, struct text *text)
{
    char value[48], ssao[32], total[32];
    if (row->series == by_pixels)
        snprintf(value, sizeof value, "%u %s %u", row->extent.width, markdown ? "×" : "x",
                 row->extent.height);
    else if (row->series == by_samples)
        snprintf(value, sizeof value, "%s", row->config.name);
    else
        snprintf(value, sizeof value, "radius %g", row->value);
    runs_format_ms(row->median[STAGE_SSAO], ssao, sizeof ssao);
    runs_format_ms(row->median[STAGE_TOTAL], total, sizeof total);
    text_add(text, markdown ? "| %s | %s | %s |" : "%-16s%12s%12s", value, ssao, total);
    if (has_previous)
        text_add(text, markdown ? " %.2f | %.2f | %.2f |" : "%12.2f%12.2f%12.2f",
                 row->value / row[-1].value, growth(row, STAGE_SSAO), growth(row, STAGE_TOTAL));
    else if (markdown)
        text_add(text, " | | |");
    text_add(text, "\n");
}

static void add_tables(const struct timings *timings, bool markdown, struct text *text)
{
    for (size_t i = 0; i < timings->count; i++) {
        const struct timing *row = &timings->rows[i];
        bool has_previous = i > 0 && row[-1].series == row->series;
        const char *name = row->series;
        if (!has_previous && markdown)
            text_add(text,
                     "\n| %s | ssao, ms | total, ms | %s by | ssao by | total by |\n"
                     "|---|---:|---:|---:|---:|---:|\n",
                     name, name);
        else if (!has_previous)
            text_add(text, "\n%-16s%12s%12s%9s by%12s%12s\n", name, "ssao, ms", "total, ms", name,
                     "ssao by", "total by");
        add_row(row, has_previous, markdown, text);
    }
}

void scaling_report(const struct timings *timings, bool markdown, struct text *text)
{
    const struct timing *last = &timings->rows[timings->count - 1];
    text_add(text, "%s, %s at %u x %u, medians of %u interleaved runs; growth from row to row%s\n",
             timings->device, timings->rows[0].config.name, last->extent.width, last->extent.height,
             timings->runs, markdown ? ":" : "");
    add_tables(timings, markdown, text);
}
