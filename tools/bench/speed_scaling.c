/* SPDX-License-Identifier: MIT
 *
 * How the cost grows: with pixels and with samples it should grow in proportion, with the radius
 * only as far as the caches are left behind. */
#include "speed.h"

#include <stdio.h>
#include <stdlib.h>

enum { SMALLER_SIZES = 3, LARGEST = SMALLER_SIZES };

const char *speed_series_name(enum speed_series series)
{
    static const char *const names[] = {[SERIES_NONE] = "",
                                        [SERIES_PIXELS] = "pixels",
                                        [SERIES_SAMPLES] = "samples",
                                        [SERIES_RADIUS] = "radius"};
    return names[series];
}

static bool add(struct speed *speed, enum speed_series series, double value, size_t image,
                const struct config *config, VkExtent2D extent, float radius,
                struct tool_error *err)
{
    struct speed_row *row = speed_add_row(speed, config, extent, radius, err);
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
static bool add_samples(struct speed *speed, const struct config *config, VkExtent2D extent,
                        struct tool_error *err)
{
    static const unsigned counts[] = {4, 8, 16, 32};
    struct ao_job job = {0};
    config_apply(config, &job);
    const char *method = config_method_name(config);
    bool has_samples = config->method == VKAO_SSAO_SPHERE || config->method == VKAO_SSAO_HEMISPHERE;
    bool is_raymarch = config->method == VKAO_SSAO_RAYMARCH;
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
        char name[64];
        struct config_list list;
        unsigned first = is_raymarch ? job.setting.effect.sample_count : job.setting.effect.slice_count;
        if (has_samples)
            snprintf(name, sizeof name, "%s-%u", method, counts[i]);
        else
            snprintf(name, sizeof name, "%s-%ux%u", method, first, counts[i]);
        if (!configs_choose("--scaling", name, &list, err) ||
            !add(speed, SERIES_SAMPLES, counts[i], LARGEST, &list.rows[0], extent, speed->radius,
                 err))
            return false;
    }
    return true;
}

static bool add_rows(struct speed *speed, const struct config *config, VkExtent2D extent,
                     struct tool_error *err)
{
    static const float radii[] = {0.25f, 0.5f, 1.0f, 2.0f, 4.0f};
    for (int i = 0; i <= LARGEST; i++) {
        VkExtent2D size = size_of(extent, i);
        if (!add(speed, SERIES_PIXELS, (double)size.width * size.height, (size_t)i, config, size,
                 speed->radius, err))
            return false;
    }
    if (!add_samples(speed, config, extent, err))
        return false;
    for (size_t i = 0; i < sizeof radii / sizeof radii[0]; i++) {
        float radius = radii[i] * speed->radius;
        if (!add(speed, SERIES_RADIUS, (double)radius, LARGEST, config, extent, radius, err))
            return false;
    }
    return true;
}

/* Pipelines for all rows. */
static bool compile_rows(struct speed_device *d, const struct speed *speed, struct tool_error *err)
{
    struct config configs[MAX_CONFIGS];
    size_t count = 0;
    for (size_t i = 0; i < speed->count && count < MAX_CONFIGS; i++)
        configs[count++] = speed->rows[i].config;
    return speed_device_compile(d, configs, count, err);
}

bool speed_scaling(struct speed_device *d, const struct config *config, VkExtent2D extent,
                   unsigned sky, struct speed *speed, struct tool_error *err)
{
    struct speed_images images[LARGEST + 1] = {0};
    struct speed_vs none = {0};
    bool ok = speed_size_check(d, extent, err) && add_rows(speed, config, extent, err) &&
              compile_rows(d, speed, err);
    for (int i = 0; ok && i <= LARGEST; i++) {
        VkExtent2D size = size_of(extent, i);
        struct room room;
        ok = room_create(size.width, size.height, sky, &room, err) &&
             speed_images_create(d, &room, &images[i], err);
        room_free(&room);
    }
    ok = ok && speed_measure(d, speed, 0, images, &none, err);
    for (int i = 0; i <= LARGEST; i++)
        speed_images_destroy(d, &images[i]);
    return ok;
}

/* --- Reports --- */

/* The median over the runs of this row / the one before. */
static double growth(const struct speed_row *row, enum stage stage)
{
    float ratios[MAX_RUNS];
    for (unsigned r = 0; r < row->runs; r++)
        ratios[r] = row->ms[stage][r] / row[-1].ms[stage][r];
    return speed_median(ratios, row->runs);
}

static void add_row(const struct speed_row *row, bool has_previous, bool markdown,
                    struct text *text)
{
    char value[48], ssao[32], total[32];
    if (row->series == SERIES_PIXELS)
        snprintf(value, sizeof value, "%u %s %u", row->extent.width, markdown ? "×" : "x",
                 row->extent.height);
    else if (row->series == SERIES_SAMPLES)
        snprintf(value, sizeof value, "%s", row->name);
    else
        snprintf(value, sizeof value, "radius %g", row->value);
    speed_format_ms(row->median[STAGE_SSAO], ssao, sizeof ssao);
    speed_format_ms(row->median[STAGE_TOTAL], total, sizeof total);
    text_add(text, markdown ? "| %s | %s | %s |" : "%-16s%12s%12s", value, ssao, total);
    if (has_previous)
        text_add(text, markdown ? " %.2f | %.2f | %.2f |" : "%12.2f%12.2f%12.2f",
                 row->value / row[-1].value, growth(row, STAGE_SSAO), growth(row, STAGE_TOTAL));
    else if (markdown)
        text_add(text, " | | |");
    text_add(text, "\n");
}

static void add_tables(const struct speed *speed, bool markdown, struct text *text)
{
    for (size_t i = 0; i < speed->count; i++) {
        const struct speed_row *row = &speed->rows[i];
        bool has_previous = i > 0 && row[-1].series == row->series;
        const char *name = speed_series_name(row->series);
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

void speed_scaling_report(const struct speed *speed, bool markdown, struct text *text)
{
    const struct speed_row *last = &speed->rows[speed->count - 1];
    text_add(text,
             "%s%s, %s at %u x %u, medians of %u interleaved runs; growth from row to row%s\n",
             speed->device, speed->threads, speed->rows[0].name, last->extent.width,
             last->extent.height, speed->runs, markdown ? ":" : "");
    add_tables(speed, markdown, text);
}
