/* SPDX-License-Identifier: MIT */
#include "quality.h"

#include "json.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char *falloff_name(int falloff)
{
    static const char *const names[FALLOFFS] = {
        [VKAO_FALLOFF_SMOOTH] = "smooth", [VKAO_FALLOFF_THRESHOLD] = "threshold"};
    return names[falloff];
}

/* --- Columns --- */

enum column_place { EVERYWHERE, IN_JSON, OF_SEQUENCES, OF_REFERENCES };
enum column_form { FIXED, SIGNED, FIGURES };

/* One figure a row. */
struct column {
    const char *json, *text, *markdown; /* how it is called there */
    int width, digits;
    enum column_form form;
    enum column_place place;
    bool is_arithmetic; /* its mean: what may be 0 or negative. Else the geometric mean */
    size_t offset;      /* of a double in struct quality_cell */
};

#define AT(member) offsetof(struct quality_cell, member)

static const struct column columns[] = {
    {"rmse", "RMSE", "RMSE", 7, 4, FIXED, EVERYWHERE, false, AT(truth.rmse)},
    {"mae", "MAE", "mean abs.", 7, 4, FIXED, EVERYWHERE, false, AT(truth.mae)},
    {"bias", "bias", "bias", 8, 4, SIGNED, EVERYWHERE, true, AT(truth.bias)},
    {"p99", "p99", "p99", 7, 4, FIXED, EVERYWHERE, false, AT(truth.p99)},
    {"ssim", "SSIM", "SSIM", 7, 4, FIXED, EVERYWHERE, true, AT(truth.ssim)},
    {"flicker", "flicker", "flicker", 7, 4, FIXED, OF_SEQUENCES, false, AT(flicker)},
    {"rmse_to_reference", "to ref.", "RMSE to reference", 7, 3, FIXED, OF_REFERENCES, false,
     AT(rmse_to_reference)},
    {"rmse_against_raymarch", "raymarch", "RMSE against raymarch", 9, 4, FIXED, EVERYWHERE, false,
     AT(estimator_rmse)},
    {"rmse_against_full_resolution", "full res.", "RMSE of half against full resolution", 9, 4,
     FIXED, EVERYWHERE, false, AT(full_rmse)},
    {"ms", "ms", "ms", 9, 4, FIGURES, IN_JSON, false, AT(ms)},
    {"ms_per_megatexel", "ms/Mtexel", "ms per megatexel", 9, 4, FIGURES, EVERYWHERE, false,
     AT(ms_per_megatexel)},
};
enum { COLUMNS = sizeof columns / sizeof *columns };

static bool is_in_tables(const struct quality *q, const struct column *column)
{
    return column->place == EVERYWHERE || (column->place == OF_SEQUENCES && q->is_sequence) ||
           (column->place == OF_REFERENCES && q->has_reference);
}

static double value_of(const struct column *column, const struct quality_cell *cell)
{
    return *(const double *)((const char *)cell + column->offset);
}

/* "-" for what was not measured. */
static void print_value(const struct column *column, const struct config *config,
                        const struct quality_cell *cell, char *text, size_t size)
{
    const double value = value_of(column, cell);
    /* Of raymarch it is the noise that is left: in brackets, since it is another thing. */
    const bool is_noise = column->offset == AT(estimator_rmse) && config->is_yardstick;
    if (isnan(value))
        snprintf(text, size, "-");
    else if (column->form == FIGURES)
        snprintf(text, size, "%.*g", column->digits, value);
    else if (column->form == SIGNED)
        snprintf(text, size, "%+.*f", column->digits, value);
    else
        snprintf(text, size, is_noise ? "(%.*f)" : "%.*f", column->digits, value);
}

/* --- Groups of images --- */

enum group { GROUP_ALL, GROUP_FITTED, GROUP_OTHERS, GROUPS };

static const char *const group_names[GROUPS] = {"all", "fitted", "others"};

static bool is_in(const struct quality_image *image, enum group group)
{
    return group == GROUP_ALL || image->is_fitted == (group == GROUP_FITTED);
}

static size_t group_size(const struct quality *q, enum group group)
{
    size_t count = 0;
    for (size_t i = 0; i < q->count; i++)
        count += is_in(&q->images[i], group);
    return count;
}

/* Whether it has lines of its own. */
static bool is_shown(const struct quality *q, enum group group)
{
    return group == GROUP_ALL || (q->has_groups && group_size(q, group) > 0);
}

/* --- Means --- */

/* Means of logarithms; an error of 0 must not make all of it 0. */
static double log_of(double value)
{
    return log(value > 1e-9 ? value : 1e-9);
}

/* Over the images of the group that have a figure. */
static double mean_of(const struct quality *q, const struct column *column, enum group group,
                      int falloff, size_t config)
{
    double sum = 0;
    size_t count = 0;
    for (size_t i = 0; i < q->count; i++) {
        const double value = value_of(column, &q->images[i].cells[falloff][config]);
        if (!is_in(&q->images[i], group) || isnan(value))
            continue;
        sum += column->is_arithmetic ? value : log_of(value);
        count++;
    }
    if (count == 0)
        return NAN;
    return column->is_arithmetic ? sum / (double)count : exp(sum / (double)count);
}

static struct quality_cell quality_mean(const struct quality *q, enum group group, int falloff,
                                        size_t config)
{
    struct quality_cell mean = {0};
    for (size_t i = 0; i < COLUMNS; i++) {
        const double value = mean_of(q, &columns[i], group, falloff, config);
        memcpy((char *)&mean + columns[i].offset, &value, sizeof value);
    }
    if (q->is_sequence)
        mean.flicker = q->flicker[falloff][config];
    return mean;
}

/* --- Text --- */

static void add_head(const struct quality *q, struct text *text)
{
    text_add(text, "%-15s %-28s", "setting", "");
    if (q->has_groups)
        text_add(text, " %-6s %6s", "", "images");
    for (size_t i = 0; i < COLUMNS; i++)
        if (is_in_tables(q, &columns[i]))
            text_add(text, " %*s", columns[i].width, columns[i].text);
    text_add(text, "\n");
}

static void add_line(const struct quality *q, enum group group, int falloff, size_t c,
                     struct text *text)
{
    const struct config *config = &q->configs.rows[c];
    const struct quality_cell mean = quality_mean(q, group, falloff, c);
    char words[64];
    config_describe(config, words, sizeof words);
    text_add(text, "%-15s %-28s", config->name, words);
    if (q->has_groups)
        text_add(text, " %-6s %6zu", group_names[group], group_size(q, group));
    for (size_t i = 0; i < COLUMNS; i++) {
        print_value(&columns[i], config, &mean, words, sizeof words);
        if (is_in_tables(q, &columns[i]))
            text_add(text, " %*s", columns[i].width, words);
    }
    text_add(text, "\n");
}

static void add_means(const struct quality *q, int falloff, struct text *text)
{
    add_head(q, text);
    for (size_t c = 0; c < q->configs.count; c++)
        for (enum group g = GROUP_ALL; g < GROUPS; g++)
            if (is_shown(q, g))
                add_line(q, g, falloff, c, text);
}

/* Columns are settings, cut to their width: "hemisphere-16" becomes "hemis-16". */
static void short_name(const char *name, char *text, size_t size)
{
    size_t length = strlen(name), word = strcspn(name, "-"), rest = length - word;
    size_t room = size - 1 > rest ? size - 1 - rest : 0;
    snprintf(text, size, "%.*s%s", (int)(word < room ? word : room), name, name + word);
}

static void add_matrix(const struct quality *q, int falloff, struct text *text)
{
    enum { WIDTH = 9 };
    text_add(text, "%-28s %6s", "RMSE by image", "radius");
    for (size_t c = 0; c < q->configs.count; c++) {
        char name[WIDTH + 1];
        short_name(q->configs.rows[c].name, name, sizeof name);
        text_add(text, " %*s", WIDTH, name);
    }
    text_add(text, "\n");
    for (size_t i = 0; i < q->count; i++) {
        text_add(text, "%-28s %6.3g", q->images[i].name, (double)q->images[i].radius);
        for (size_t c = 0; c < q->configs.count; c++)
            text_add(text, " %*.4f", WIDTH, q->images[i].cells[falloff][c].truth.rmse);
        text_add(text, "\n");
    }
}

static size_t images_with_reference(const struct quality *q)
{
    size_t count = 0;
    for (size_t i = 0; i < q->count; i++)
        count += q->images[i].has_reference;
    return count;
}

static void add_notes(const struct quality *q, struct text *text)
{
    text_add(text,
             "\nErrors are of visibility against ray-traced truth; the column raymarch is the "
             "RMSE\nagainst converged ray marching through the same depth image (of raymarch "
             "itself,\nin brackets, its noise), the column full res. that of half resolution "
             "against the\nsame setting at full resolution. Bias and SSIM are arithmetic means, "
             "the rest geometric.\n");
    if (q->is_sequence)
        text_add(text,
                 "Flicker is the RMS over points of the standard deviation in time of their "
                 "error;\n%.1f %% of the points of the first frame could be followed.\n",
                 q->tracked_share * 100.0);
    if (q->has_reference)
        text_add(text,
                 "The column to ref. is the RMSE over that of the reference; it names %zu of the "
                 "images.\n",
                 images_with_reference(q));
}

void quality_add_text(const struct quality *q, struct text *text)
{
    text_add(text, "%zu image%s, %s, median of %u run%s\n", q->count, q->count == 1 ? "" : "s",
             q->device, q->runs, q->runs == 1 ? "" : "s");
    for (int f = 0; f < FALLOFFS; f++) {
        if (!q->has_falloff[f])
            continue;
        text_add(text, "\nfalloff %s, means over the images:\n", falloff_name(f));
        add_means(q, f, text);
        text_add(text, "\n");
        add_matrix(q, f, text);
    }
    add_notes(q, text);
}

/* --- Markdown --- */

static void add_markdown_head(const struct quality *q, struct text *text)
{
    text_add(text, "| setting | |%s", q->has_groups ? " images |" : "");
    for (size_t i = 0; i < COLUMNS; i++)
        if (is_in_tables(q, &columns[i]))
            text_add(text, " %s |", columns[i].markdown);
    text_add(text, "\n|---|---|%s", q->has_groups ? "---|" : "");
    for (size_t i = 0; i < COLUMNS; i++)
        if (is_in_tables(q, &columns[i]))
            text_add(text, "---:|");
    text_add(text, "\n");
}

static void add_markdown_row(const struct quality *q, enum group group, int falloff, size_t c,
                             struct text *text)
{
    const struct config *config = &q->configs.rows[c];
    const struct quality_cell mean = quality_mean(q, group, falloff, c);
    char words[64];
    config_describe(config, words, sizeof words);
    text_add(text, "| %s | %s |", config->name, words);
    if (q->has_groups)
        text_add(text, " %s %zu |", group_names[group], group_size(q, group));
    for (size_t i = 0; i < COLUMNS; i++) {
        print_value(&columns[i], config, &mean, words, sizeof words);
        if (is_in_tables(q, &columns[i]))
            text_add(text, " %s |", words);
    }
    text_add(text, "\n");
}

void quality_add_markdown(const struct quality *q, struct text *text)
{
    for (int f = 0; f < FALLOFFS; f++) {
        if (!q->has_falloff[f])
            continue;
        text_add(text, "%sFalloff %s, %zu image%s, %s:\n\n", text->length ? "\n" : "",
                 falloff_name(f), q->count, q->count == 1 ? "" : "s", q->device);
        add_markdown_head(q, text);
        for (size_t c = 0; c < q->configs.count; c++)
            for (enum group g = GROUP_ALL; g < GROUPS; g++)
                if (is_shown(q, g))
                    add_markdown_row(q, g, f, c, text);
    }
}

/* --- JSON --- */

static void add_cell(cJSON *array, const struct config *config, int falloff,
                     const struct quality_cell *cell)
{
    cJSON *object = cJSON_CreateObject();
    cJSON_AddItemToArray(array, object);
    cJSON_AddStringToObject(object, "setting", config->name);
    cJSON_AddStringToObject(object, "falloff", falloff_name(falloff));
    for (size_t i = 0; i < COLUMNS; i++) {
        const bool is_noise = columns[i].offset == AT(estimator_rmse) && config->is_yardstick;
        json_add_number(object, is_noise ? "noise" : columns[i].json, value_of(&columns[i], cell));
    }
}

static void add_settings(cJSON *root, const struct quality *q)
{
    cJSON *settings = cJSON_AddArrayToObject(root, "settings");
    for (size_t c = 0; c < q->configs.count; c++) {
        char description[64];
        cJSON *object = cJSON_CreateObject();
        cJSON_AddItemToArray(settings, object);
        config_describe(&q->configs.rows[c], description, sizeof description);
        cJSON_AddStringToObject(object, "name", q->configs.rows[c].name);
        cJSON_AddStringToObject(object, "method", config_method_name(&q->configs.rows[c]));
        cJSON_AddStringToObject(object, "description", description);
        cJSON_AddBoolToObject(object, "yardstick", q->configs.rows[c].is_yardstick);
    }
}

static void add_image(cJSON *images, const struct quality *q, const struct quality_image *image)
{
    cJSON *object = cJSON_CreateObject();
    cJSON_AddItemToArray(images, object);
    cJSON_AddStringToObject(object, "name", image->name);
    cJSON_AddNumberToObject(object, "width", image->width);
    cJSON_AddNumberToObject(object, "height", image->height);
    cJSON_AddNumberToObject(object, "foreground", (double)image->foreground);
    json_add_number(object, "radius", (double)image->radius);
    if (q->has_groups)
        cJSON_AddBoolToObject(object, "fitted", image->is_fitted);
    cJSON *results = cJSON_AddArrayToObject(object, "results");
    for (int f = 0; f < FALLOFFS; f++)
        for (size_t c = 0; q->has_falloff[f] && c < q->configs.count; c++)
            add_cell(results, &q->configs.rows[c], f, &image->cells[f][c]);
}

static void add_json_means(cJSON *root, const char *name, const struct quality *q, enum group group)
{
    cJSON *means = cJSON_AddArrayToObject(root, name);
    for (int f = 0; f < FALLOFFS; f++) {
        for (size_t c = 0; q->has_falloff[f] && c < q->configs.count; c++) {
            const struct quality_cell mean = quality_mean(q, group, f, c);
            add_cell(means, &q->configs.rows[c], f, &mean);
        }
    }
}

cJSON *quality_json(const struct quality *q)
{
    static const char *const names[GROUPS] = {"means", "means_fitted", "means_others"};
    cJSON *root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "device", q->device);
    cJSON_AddNumberToObject(root, "runs", q->runs);
    cJSON_AddNumberToObject(root, "raymarch_passes", q->passes);
    if (q->is_sequence)
        json_add_number(root, "tracked_share", q->tracked_share);
    add_settings(root, q);
    cJSON *images = cJSON_AddArrayToObject(root, "images");
    for (size_t i = 0; i < q->count; i++)
        add_image(images, q, &q->images[i]);
    for (enum group g = GROUP_ALL; g < GROUPS; g++)
        if (is_shown(q, g))
            add_json_means(root, names[g], q, g);
    return root;
}
