/* SPDX-License-Identifier: MIT */
#include "quality.h"

#include "json.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const char *falloff_name(int falloff)
{
    static const char *const names[FALLOFFS] = {
        [VKAO_FALLOFF_SMOOTH] = "smooth", [VKAO_FALLOFF_THRESHOLD] = "threshold"};
    return names[falloff];
}

/* --- Means --- */

/* Means of logarithms; an error of 0 must not make all of it 0. */
static double log_of(double value)
{
    return log(value > 1e-9 ? value : 1e-9);
}

struct quality_cell quality_mean(const struct quality *q, int falloff, size_t config)
{
    struct quality_cell logs = {0}, mean = {0};
    for (size_t i = 0; i < q->count; i++) {
        const struct quality_cell *c = &q->images[i].cells[falloff][config];
        logs.truth.rmse += log_of(c->truth.rmse);
        logs.truth.mae += log_of(c->truth.mae);
        logs.truth.p99 += log_of(c->truth.p99);
        logs.estimator_rmse += isnan(c->estimator_rmse) ? NAN : log_of(c->estimator_rmse);
        logs.full_rmse += isnan(c->full_rmse) ? NAN : log_of(c->full_rmse);
        logs.ms += log_of(c->ms);
        logs.ms_per_megatexel += log_of(c->ms_per_megatexel);
        mean.truth.bias += c->truth.bias;
        mean.truth.ssim += c->truth.ssim;
        mean.truth.texels += c->truth.texels;
    }
    double n = q->count ? (double)q->count : 1.0;
    mean.truth.rmse = exp(logs.truth.rmse / n);
    mean.truth.mae = exp(logs.truth.mae / n);
    mean.truth.p99 = exp(logs.truth.p99 / n);
    mean.truth.bias /= n;
    mean.truth.ssim /= n;
    mean.estimator_rmse = exp(logs.estimator_rmse / n);
    mean.full_rmse = exp(logs.full_rmse / n);
    mean.ms = exp(logs.ms / n);
    mean.ms_per_megatexel = exp(logs.ms_per_megatexel / n);
    return mean;
}

/* --- Text --- */

/* Columns that not every setting has something for. */
struct partial_columns {
    char estimator[32], full[32];
};

static struct partial_columns partial_columns(const struct config *config,
                                              const struct quality_cell *cell)
{
    struct partial_columns columns = {"-", "-"};
    /* Of raymarch it is the noise that is left: in brackets, since it is another thing. */
    if (!isnan(cell->estimator_rmse))
        snprintf(columns.estimator, sizeof columns.estimator,
                 config->is_yardstick ? "(%.4f)" : "%.4f", cell->estimator_rmse);
    if (!isnan(cell->full_rmse))
        snprintf(columns.full, sizeof columns.full, "%.4f", cell->full_rmse);
    return columns;
}

static void add_means(const struct quality *q, int falloff, struct text *text)
{
    text_add(text, "%-15s %-28s %7s %7s %8s %7s %7s %9s %9s %9s\n", "setting", "", "RMSE", "MAE",
             "bias", "p99", "SSIM", "raymarch", "full res.", "ms/Mtexel");
    for (size_t c = 0; c < q->configs.count; c++) {
        const struct config *config = &q->configs.rows[c];
        const struct quality_cell m = quality_mean(q, falloff, c);
        const struct partial_columns partial = partial_columns(config, &m);
        char description[64];
        config_describe(config, description, sizeof description);
        text_add(text, "%-15s %-28s %7.4f %7.4f %+8.4f %7.4f %7.4f %9s %9s %9.4g\n", config->name,
                 description, m.truth.rmse, m.truth.mae, m.truth.bias, m.truth.p99, m.truth.ssim,
                 partial.estimator, partial.full, m.ms_per_megatexel);
    }
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

void quality_text(const struct quality *q, struct text *text)
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
    text_add(text,
             "\nErrors are of visibility against ray-traced truth; the column raymarch is the "
             "RMSE\nagainst converged ray marching through the same depth image (of raymarch "
             "itself,\nin brackets, its noise), the column full res. that of half resolution "
             "against the\nsame setting at full resolution. Bias and SSIM are arithmetic means, "
             "the rest geometric.\n");
}

/* --- Markdown --- */

void quality_markdown(const struct quality *q, struct text *text)
{
    for (int f = 0; f < FALLOFFS; f++) {
        if (!q->has_falloff[f])
            continue;
        text_add(text, "%sFalloff %s, %zu image%s, %s:\n\n", text->length ? "\n" : "",
                 falloff_name(f), q->count, q->count == 1 ? "" : "s", q->device);
        text_add(text, "| setting | | RMSE | mean abs. | bias | p99 | SSIM | RMSE against raymarch "
                       "| RMSE of half against full resolution | ms per megatexel |\n");
        text_add(text, "|---|---|---:|---:|---:|---:|---:|---:|---:|---:|\n");
        for (size_t c = 0; c < q->configs.count; c++) {
            const struct config *config = &q->configs.rows[c];
            const struct quality_cell m = quality_mean(q, f, c);
            const struct partial_columns partial = partial_columns(config, &m);
            char description[64];
            config_describe(config, description, sizeof description);
            text_add(text, "| %s | %s | %.4f | %.4f | %+.4f | %.4f | %.4f | %s | %s | %.4g |\n",
                     config->name, description, m.truth.rmse, m.truth.mae, m.truth.bias,
                     m.truth.p99, m.truth.ssim, partial.estimator, partial.full,
                     m.ms_per_megatexel);
        }
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
    json_add_number(object, "rmse", cell->truth.rmse);
    json_add_number(object, "mae", cell->truth.mae);
    json_add_number(object, "bias", cell->truth.bias);
    json_add_number(object, "p99", cell->truth.p99);
    json_add_number(object, "ssim", cell->truth.ssim);
    json_add_number(object, config->is_yardstick ? "noise" : "rmse_against_raymarch",
                    cell->estimator_rmse);
    json_add_number(object, "rmse_against_full_resolution", cell->full_rmse);
    json_add_number(object, "ms", cell->ms);
    json_add_number(object, "ms_per_megatexel", cell->ms_per_megatexel);
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
    }
}

cJSON *quality_json(const struct quality *q)
{
    cJSON *root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "device", q->device);
    cJSON_AddNumberToObject(root, "runs", q->runs);
    cJSON_AddNumberToObject(root, "raymarch_passes", q->passes);
    add_settings(root, q);
    cJSON *images = cJSON_AddArrayToObject(root, "images");
    for (size_t i = 0; i < q->count; i++) {
        const struct quality_image *image = &q->images[i];
        cJSON *object = cJSON_CreateObject();
        cJSON_AddItemToArray(images, object);
        cJSON_AddStringToObject(object, "name", image->name);
        cJSON_AddNumberToObject(object, "width", image->width);
        cJSON_AddNumberToObject(object, "height", image->height);
        cJSON_AddNumberToObject(object, "foreground", (double)image->foreground);
        json_add_number(object, "radius", (double)image->radius);
        cJSON *results = cJSON_AddArrayToObject(object, "results");
        for (int f = 0; f < FALLOFFS; f++)
            for (size_t c = 0; q->has_falloff[f] && c < q->configs.count; c++)
                add_cell(results, &q->configs.rows[c], f, &image->cells[f][c]);
    }
    cJSON *means = cJSON_AddArrayToObject(root, "means");
    for (int f = 0; f < FALLOFFS; f++) {
        for (size_t c = 0; q->has_falloff[f] && c < q->configs.count; c++) {
            const struct quality_cell mean = quality_mean(q, f, c);
            add_cell(means, &q->configs.rows[c], f, &mean);
        }
    }
    return root;
}
