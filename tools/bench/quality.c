/* SPDX-License-Identifier: MIT
 *
 * vkao-bench quality: methods and presets against ray-traced truth. Converged ray marching through
 * the depth image splits the error: what raymarch misses is not in the image at all, and what the
 * others differ from raymarch is their own doing. */
#include "commands.h"

#include "ao.h"
#include "arguments.h"
#include "corpus.h"
#include "exr_file.h"
#include "gpu.h"
#include "json.h"
#include "quality.h"
#include "report.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum falloff_choice { FALLOFF_BOTH, FALLOFF_ONLY_SMOOTH, FALLOFF_ONLY_THRESHOLD };

struct quality_options {
    const char *folder, *methods, *files, *json, *plot, *device;
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
    {"text", NULL, "print tables (default)", ARGUMENT_FLAG, AT(text), 0, 0, NULL},
    {"markdown", NULL, "print the means as a Markdown table", ARGUMENT_FLAG, AT(markdown), 0, 0,
     NULL},
    {"json", "FILE", "write all results", ARGUMENT_TEXT, AT(json), 0, 0, NULL},
    {"plot", "FILE.png", "draw error over time", ARGUMENT_TEXT, AT(plot), 0, 0, NULL},
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

/* --- Output --- */

static bool put_out(const struct bench *b, struct tool_error *err)
{
    const struct quality_options *o = b->options;
    struct text text = {0};
    if (o->text || !o->markdown)
        quality_text(&b->quality, &text);
    if (o->markdown)
        quality_markdown(&b->quality, &text);
    bool ok = !text.out_of_memory || fail(err, EXIT_MEMORY, "out of memory");
    ok = ok && report_text(text.data, err);
    text_free(&text);
    const unsigned begun = json_begin();
    ok = ok && (!o->json || json_write(o->json, quality_json(&b->quality), begun, err));
    return ok && (!o->plot || quality_plot(&b->quality, o->plot, err));
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
