/* SPDX-License-Identifier: MIT
 *
 * vkao-bench quality: methods and presets against ray-traced truth. Converged ray marching through
 * the depth image splits the error: what raymarch misses is not in the image at all, and what the
 * others differ from raymarch is their own doing. */
#include "commands.h"

#include "ao.h"
#include "arguments.h"
#include "configs.h"
#include "corpus.h"
#include "exr_file.h"
#include "gpu.h"
#include "json.h"
#include "metrics.h"
#include "report.h"
#include "text.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* --- Results --- */

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

static const char *falloff_name(int falloff)
{
    static const char *const names[FALLOFFS] = {
        [VKAO_FALLOFF_SMOOTH] = "smooth", [VKAO_FALLOFF_THRESHOLD] = "threshold"};
    return names[falloff];
}

/* --- Command line --- */

enum falloff_choice { FALLOFF_BOTH, FALLOFF_ONLY_SMOOTH, FALLOFF_ONLY_THRESHOLD };

struct quality_options {
    const char *folder, *methods, *files, *json, *device;
    int falloff; /* enum falloff_choice */
    unsigned passes, runs;
    float radius; /* 0 = what the truth says */
    bool no_raymarch, text, markdown, quiet, help;
};

#define AT(member) offsetof(struct quality_options, member)

static const struct argument_word falloff_words[] = {
    {"both", FALLOFF_BOTH},
    {"smooth", FALLOFF_ONLY_SMOOTH},
    {"threshold", FALLOFF_ONLY_THRESHOLD},
    {0},
};

/* One option a row; the values in the help are the defaults of default_options. */
static const struct argument rows[] = {
    {"methods", "LIST",
     "comma-separated: names from the table, methods, METHOD-SAMPLES or METHOD-SLICESxSTEPS. "
     "Default: four presets and six settings",
     ARGUMENT_TEXT, AT(methods), 0, 0, NULL},
    {"falloff", "NAME", "both (default), smooth (against AO_falloff) or threshold (AO_threshold)",
     ARGUMENT_WORD, AT(falloff), 0, 0, falloff_words},
    {"files", "PART", "only G-buffers whose name contains PART", ARGUMENT_TEXT, AT(files), 0, 0,
     NULL},
    {"radius", "R", "scene units, for truth files without the attribute aoRadius", ARGUMENT_NUMBER,
     AT(radius), 0, 0, NULL},
    {"raymarch-passes", "N", "noise patterns that raymarch averages, 64 rays x 64 steps each (4)",
     ARGUMENT_COUNT, AT(passes), 1, 4096, NULL},
    {"no-raymarch", NULL, "leave raymarch out: it takes most of the time", ARGUMENT_FLAG,
     AT(no_raymarch), 0, 0, NULL},
    {"runs", "N", "runs of each setting, of which the median time counts (3)", ARGUMENT_COUNT,
     AT(runs), 1, 1000, NULL},
    {"text", NULL, "print tables (default, unless another output goes there)", ARGUMENT_FLAG,
     AT(text), 0, 0, NULL},
    {"markdown", NULL, "print the means as a Markdown table", ARGUMENT_FLAG, AT(markdown), 0, 0,
     NULL},
    {"json", "FILE", "write all results, as tools/bench/plot draws them; - = standard output",
     ARGUMENT_TEXT, AT(json), 0, 0, NULL},
    {"device", "NAME", "auto, cpu, a number from 'vkao devices' or part of a name", ARGUMENT_TEXT,
     AT(device), 0, 0, NULL},
    {"quiet", NULL, "no progress", ARGUMENT_FLAG, AT(quiet), 0, 0, NULL},
    {"help", NULL, "print this", ARGUMENT_FLAG, AT(help), 0, 0, NULL},
};
static const struct argument_list arguments = {rows, sizeof rows / sizeof rows[0]};

static const struct quality_options default_options = {
    .falloff = FALLOFF_BOTH, .passes = 4, .runs = 3, .device = "auto"};

struct bench {
    const struct quality_options *options;
    struct report report;
    struct gpu gpu;
    struct ao_session *session;
    struct corpus corpus;
    struct quality quality;
    size_t capacity, failed; /* of quality.images; files */
};

/* --- One setting --- */

static bool run_once(struct bench *b, struct scene *scene, const struct ao_job *job,
                     struct ao_result *result, struct tool_error *err)
{
    if (!ao_run(b->session, job, result, err))
        return false;
    placement_crop(&scene->placement, &scene->gbuffer, result);
    return true;
}

static struct ao_job make_job(const struct config *config, const struct scene *scene, int falloff)
{
    struct ao_job job = {0};
    scene_fill_job(scene, &job);
    config_apply(config, &job);
    job.setting.params.radius = scene->radius;
    job.setting.effect.falloff = (vkao_falloff)falloff;
    return job;
}

static bool score(const struct scene *scene, int falloff, const float *ao, const float *raymarch,
                  struct quality_cell *cell, struct tool_error *err)
{
    struct image_pair pair = {.width = scene->gbuffer.width,
                              .height = scene->gbuffer.height,
                              .result = ao,
                              .truth = scene->truth[falloff],
                              .mask = scene->foreground};
    if (!metrics_compare(&pair, &cell->truth, err))
        return false;
    cell->ms_per_megatexel = cell->ms * 1e6 / ((double)pair.width * (double)pair.height);
    if (!raymarch)
        return true;
    pair.truth = raymarch;
    cell->estimator_rmse = metrics_rmse(&pair);
    return true;
}

/* Nothing but the resolution differs: blur.radius counts the texels of either. */
static bool compare_with_full(struct bench *b, struct scene *scene, struct ao_job job,
                              const float *half, struct quality_cell *cell, struct tool_error *err)
{
    struct ao_result full;
    job.setting.effect.half_resolution = false;
    if (!run_once(b, scene, &job, &full, err))
        return false;
    const struct image_pair pair = {.width = scene->gbuffer.width,
                                    .height = scene->gbuffer.height,
                                    .result = half,
                                    .truth = full.ao,
                                    .mask = scene->foreground};
    cell->full_rmse = metrics_rmse(&pair);
    ao_result_free(&full);
    return true;
}

static bool measure(struct bench *b, struct scene *scene, const struct config *config, int falloff,
                    const float *raymarch, struct quality_cell *cell, struct tool_error *err)
{
    const struct ao_job job = make_job(config, scene, falloff);
    struct ao_result result = {0};
    float *times = calloc(b->options->runs, sizeof *times);
    bool ok = times || fail(err, EXIT_MEMORY, "out of memory");
    for (unsigned i = 0; ok && i < b->options->runs; i++) {
        ao_result_free(&result);
        ok = run_once(b, scene, &job, &result, err);
        if (ok)
            times[i] = (float)result.gpu_ms;
    }
    if (ok)
        cell->ms = metrics_quantile(times, b->options->runs, 0.5);
    ok = ok && score(scene, falloff, result.ao, raymarch, cell, err);
    if (ok && job.setting.effect.half_resolution)
        ok = compare_with_full(b, scene, job, result.ao, cell, err);
    free(times);
    ao_result_free(&result);
    return ok;
}

/* RMS over the foreground of the standard error of a mean of n values. */
static double mean_noise(const struct scene *scene, const float *mean, const double *squares,
                         unsigned n)
{
    size_t texels = (size_t)scene->gbuffer.width * scene->gbuffer.height, counted = 0;
    double sum = 0;
    for (size_t i = 0; i < texels; i++) {
        if (!scene->foreground[i])
            continue;
        double variance = squares[i] / n - (double)mean[i] * (double)mean[i];
        sum += variance > 0 ? variance / (n - 1) : 0;
        counted++;
    }
    return counted ? sqrt(sum / (double)counted) : 0;
}

/* Raymarch averaged over noise patterns, in the malloc'ed *mean. */
static bool converge(struct bench *b, struct scene *scene, const struct config *config, int falloff,
                     float **mean, struct quality_cell *cell, struct tool_error *err)
{
    size_t texels = (size_t)scene->gbuffer.width * scene->gbuffer.height;
    unsigned passes = b->options->passes;
    struct ao_job job = make_job(config, scene, falloff);
    double *sums = calloc(texels * 2, sizeof *sums), *squares = sums + texels;
    *mean = malloc(texels * sizeof **mean);
    bool ok = (sums && *mean) || fail(err, EXIT_MEMORY, "%s: out of memory", scene->name);
    cell->ms = 0;
    for (unsigned p = 0; ok && p < passes; p++) {
        struct ao_result result;
        job.setting.params.noise_index = p;
        ok = run_once(b, scene, &job, &result, err);
        for (size_t i = 0; ok && i < texels; i++) {
            sums[i] += (double)result.ao[i];
            squares[i] += (double)result.ao[i] * (double)result.ao[i];
        }
        cell->ms += ok ? result.gpu_ms : 0;
        ao_result_free(&result);
    }
    for (size_t i = 0; ok && i < texels; i++)
        (*mean)[i] = (float)(sums[i] / passes);
    cell->estimator_rmse = ok && passes > 1 ? mean_noise(scene, *mean, squares, passes) : NAN;
    ok = ok && score(scene, falloff, *mean, NULL, cell, err);
    free(sums);
    return ok;
}

/* --- Images --- */

static bool measure_falloff(struct bench *b, struct scene *scene, int falloff,
                            struct quality_image *image, struct tool_error *err)
{
    const struct config_list *configs = &b->quality.configs;
    float *raymarch = NULL;
    bool ok = true;
    for (size_t c = 0; c < configs->count; c++)
        image->cells[falloff][c].estimator_rmse = image->cells[falloff][c].full_rmse = NAN;
    /* First: the others are compared with it. */
    for (size_t c = 0; ok && c < configs->count; c++)
        if (configs->rows[c].is_yardstick)
            ok = converge(b, scene, &configs->rows[c], falloff, &raymarch,
                          &image->cells[falloff][c], err);
    for (size_t c = 0; ok && c < configs->count; c++) {
        if (!configs->rows[c].is_yardstick)
            ok = measure(b, scene, &configs->rows[c], falloff, raymarch, &image->cells[falloff][c],
                         err);
    }
    free(raymarch);
    return ok;
}

static struct quality_image *next_image(struct bench *b, struct tool_error *err)
{
    struct quality *q = &b->quality;
    if (q->count == b->capacity) {
        size_t capacity = b->capacity ? b->capacity * 2 : 32;
        struct quality_image *images = realloc(q->images, capacity * sizeof *images);
        if (!images) {
            fail(err, EXIT_MEMORY, "out of memory");
            return NULL;
        }
        q->images = images;
        b->capacity = capacity;
    }
    struct quality_image *image = &q->images[q->count];
    memset(image, 0, sizeof *image);
    return image;
}

static bool measure_scene(struct bench *b, struct scene *scene, struct tool_error *err)
{
    struct quality_image *image = next_image(b, err);
    if (!image)
        return false;
    if (b->options->radius > 0 && !(scene->radius > 0))
        scene->radius = b->options->radius;
    if (!(scene->radius > 0)) {
        fail_hint(err, "add --radius R");
        return fail(err, EXIT_INPUT, "%s: the truth file has no attribute aoRadius", scene->name);
    }
    snprintf(image->name, sizeof image->name, "%s", scene->name);
    image->width = scene->gbuffer.width;
    image->height = scene->gbuffer.height;
    image->radius = scene->radius;
    for (size_t i = 0; i < (size_t)image->width * image->height; i++)
        image->foreground += scene->foreground[i];
    for (int f = 0; f < FALLOFFS; f++)
        if (b->quality.has_falloff[f] && !measure_falloff(b, scene, f, image, err))
            return false;
    b->quality.count++;
    return true;
}

static bool measure_file(struct bench *b, size_t index, struct tool_error *err)
{
    struct frame_source source;
    bool ok = corpus_read(&b->corpus, index, &source, err);
    for (size_t v = 0; ok && v < source.view_count; v++) {
        struct scene scene;
        ok = scene_load(&b->corpus, index, &source, v, &b->report, &scene, err);
        if (ok)
            report_note(&b->report, "%zu/%zu %s: %u x %u, radius %g", index + 1, b->corpus.count,
                        scene.name, scene.gbuffer.width, scene.gbuffer.height,
                        (double)scene.radius);
        ok = ok && measure_scene(b, &scene, err);
        scene_free(&scene);
    }
    frame_source_close(&source);
    return ok;
}

/* Errors that the next file would meet again end it. */
static bool measure_all(struct bench *b, struct tool_error *err)
{
    for (size_t i = 0; i < b->corpus.count; i++) {
        struct tool_error once = {0};
        if (measure_file(b, i, &once))
            continue;
        if (once.code == EXIT_DEVICE || once.code == EXIT_MEMORY || once.code == EXIT_BUG ||
            b->corpus.count == 1) {
            *err = once;
            return false;
        }
        report_error(&once);
        b->failed++;
    }
    if (b->quality.count == 0)
        return fail(err, EXIT_INPUT, "%s: no G-buffer could be measured", b->options->folder);
    return true;
}

/* --- Means --- */

/* Means of logarithms; an error of 0 must not make all of it 0. */
static double log_of(double value)
{
    return log(value > 1e-9 ? value : 1e-9);
}

/* Over the images: the arithmetic mean of bias and ssim, which may be 0 or negative, and the
 * geometric mean of the rest. */
static struct quality_cell quality_mean(const struct quality *q, int falloff, size_t config)
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

static void add_text(const struct quality *q, struct text *text)
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

static void add_markdown(const struct quality *q, struct text *text)
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
        cJSON_AddBoolToObject(object, "yardstick", q->configs.rows[c].is_yardstick);
    }
}

/* For json_write, which deletes it. */
static cJSON *make_json(const struct quality *q)
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

/* --- Output --- */

static bool put_out(const struct bench *b, struct tool_error *err)
{
    const struct quality_options *o = b->options;
    const bool json_on_stdout = o->json && strcmp(o->json, "-") == 0;
    struct text text = {0};
    if (o->text || !(o->markdown || json_on_stdout))
        add_text(&b->quality, &text);
    if (o->markdown)
        add_markdown(&b->quality, &text);
    bool ok = !text.out_of_memory || fail(err, EXIT_MEMORY, "out of memory");
    ok = ok && (!text.data || report_text(text.data, err));
    text_free(&text);
    const unsigned begun = json_begin();
    return ok && (!o->json || json_write(o->json, make_json(&b->quality), begun, err));
}

/* --- Command --- */

static bool prepare(struct bench *b, struct tool_error *err)
{
    const struct quality_options *o = b->options;
    struct quality *q = &b->quality;
    const struct config yardstick = config_yardstick();
    const struct gpu_options gpu = {.device = o->device};
    const long processors = sysconf(_SC_NPROCESSORS_ONLN);
    exr_set_threads(processors > 1 ? (int)(processors < 64 ? processors : 64) : 0);
    if (!configs_choose("--methods", o->methods, &q->configs, err))
        return false;
    if (!o->no_raymarch) {
        if (q->configs.count == MAX_CONFIGS)
            return fail(err, EXIT_USAGE, "--methods leaves no room for raymarch");
        q->configs.rows[q->configs.count++] = yardstick;
    }
    q->has_falloff[VKAO_FALLOFF_SMOOTH] = o->falloff != FALLOFF_ONLY_THRESHOLD;
    q->has_falloff[VKAO_FALLOFF_THRESHOLD] = o->falloff != FALLOFF_ONLY_SMOOTH;
    q->runs = o->runs;
    q->passes = o->no_raymarch ? 0 : o->passes;
    if (!corpus_open(o->folder, o->files, &b->corpus, err) || !gpu_create(&gpu, &b->gpu, err))
        return false;
    snprintf(q->device, sizeof q->device, "%s", b->gpu.properties.deviceName);
    b->session = ao_session_create(&b->gpu, err);
    return b->session != NULL;
}

static void print_help(void)
{
    struct text text = {0};
    text_add(&text, "Usage: vkao-bench quality FOLDER [OPTION]...\n\n"
                    "Methods and presets against ray-traced ambient occlusion. FOLDER holds\n"
                    "G-buffers X.exr, their cameras X.camera.json and their truth X.gt.exr\n"
                    "(X.VIEW.gt.exr for stereo) with the channels AO_falloff and AO_threshold.\n"
                    "RMSE, mean absolute error, bias, p99 and SSIM are those of visibility over\n"
                    "the foreground; intensity and power are 1. Of half resolution, the RMSE\n"
                    "against the same setting at full resolution is stated too.\n\n");
    arguments_help(&arguments, &text);
    if (text.data && !text.out_of_memory)
        fputs(text.data, stdout);
    text_free(&text);
}

int command_quality(int argc, char **argv)
{
    struct quality_options options = default_options;
    struct bench b = {.options = &options};
    struct tool_error err = {0};
    bool ok = arguments_parse(&arguments, argc, argv, &options, &options.folder, &err);
    if (ok && options.help) {
        print_help();
        return EXIT_OK;
    }
    if (ok && !options.folder)
        ok = fail(&err, EXIT_USAGE, "no FOLDER given");
    if (!ok)
        fail_hint(&err, "'vkao-bench quality --help' explains the options");
    b.report.verbosity = options.quiet ? REPORT_QUIET : REPORT_NORMAL;
    ok = ok && prepare(&b, &err) && measure_all(&b, &err) && put_out(&b, &err);
    if (!ok)
        report_error(&err);
    ao_session_destroy(b.session);
    gpu_destroy(&b.gpu);
    corpus_close(&b.corpus);
    free(b.quality.images);
    if (!ok)
        return err.code;
    return b.failed ? EXIT_SOME_FRAMES : EXIT_OK;
}
