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
#include "flicker.h"
#include "gpu.h"
#include "json.h"
#include "metrics.h"
#include "quality.h"
#include "reference.h"
#include "report.h"
#include "text.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* --- Command line --- */

enum falloff_choice { FALLOFF_BOTH, FALLOFF_ONLY_SMOOTH, FALLOFF_ONLY_THRESHOLD };

struct quality_options {
    const char *folder, *methods, *files, *fitted, *against, *json, *device;
    int falloff; /* enum falloff_choice */
    unsigned passes, runs;
    float radius; /* 0 = what the truth says */
    bool sequence, no_raymarch, text, markdown, quiet;
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
    {"sequence", NULL,
     "the G-buffers are frames STEM.NUMBER of one move of the camera (world_to_view says where it "
     "is): how much the error of what they show changes in time is stated as flicker",
     ARGUMENT_FLAG, AT(sequence), 0, 0, NULL},
    {"fitted", "LIST",
     "comma-separated patterns of names that constants were fitted to (b5_*,t2_fur): states the "
     "means over these and those over the others too",
     ARGUMENT_TEXT, AT(fitted), 0, 0, NULL},
    {"against", "FILE",
     "JSON {\"X\": RMSE, ...}, the errors of another program at one --falloff: states the mean of "
     "the RMSE over these, of images that are in both",
     ARGUMENT_TEXT, AT(against), 0, 0, NULL},
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
};

static const char usage[] =
    "Usage: vkao-bench quality FOLDER [OPTION]...\n\n"
    "Methods and presets against ray-traced ambient occlusion. FOLDER holds\n"
    "G-buffers X.exr, their cameras X.camera.json and their truth X.gt.exr\n"
    "(X.VIEW.gt.exr for stereo) with the channels AO_falloff and AO_threshold.\n"
    "RMSE, mean absolute error, bias, p99 and SSIM are those of visibility over\n"
    "the foreground; intensity and power are 1. Of half resolution, the RMSE\n"
    "against the same setting at full resolution is stated too. The truth of a\n"
    "falloff that is not measured may be missing.\n\n"
    "Flicker, of a --sequence: each texel of the first frame is a point of the\n"
    "world, which the nearest texel of a frame stands for if its depth agrees\n"
    "within 1 % and its normal within 10 degrees. It is the RMS, over the points\n"
    "that half of the frames show, of the standard deviation of their error.\n\n";

static const struct argument_list arguments = {"quality", usage, rows,
                                               sizeof rows / sizeof rows[0]};

static const struct quality_options default_options = {
    .falloff = FALLOFF_BOTH, .passes = 4, .runs = 3, .device = "auto"};

struct bench {
    const struct quality_options *options;
    struct report report;
    struct gpu gpu;
    struct ao_session *session;
    struct corpus corpus;
    struct flicker flicker; /* with --sequence */
    cJSON *reference;       /* of --against, NULL without */
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

/* Of the config-th setting, whose cell holds its time. raymarch: NULL = not compared with it. */
static bool score(struct bench *b, const struct scene *scene, int falloff, size_t config,
                  const float *ao, const float *raymarch, struct tool_error *err)
{
    struct quality_image *image = &b->quality.images[b->quality.count];
    struct quality_cell *cell = &image->cells[falloff][config];
    struct image_pair pair = {.width = scene->gbuffer.width,
                              .height = scene->gbuffer.height,
                              .result = ao,
                              .truth = scene->truth[falloff],
                              .mask = scene->foreground};
    const size_t slot = (size_t)falloff * MAX_CONFIGS + config;
    if (!metrics_compare(&pair, &cell->truth, err) ||
        (b->options->sequence && !flicker_add(&b->flicker, slot, &pair, err)))
        return false;
    cell->rmse_to_reference = cell->truth.rmse / reference_rmse(b->reference, scene->name);
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

static bool measure(struct bench *b, struct scene *scene, int falloff, size_t config,
                    const float *raymarch, struct tool_error *err)
{
    struct quality_cell *cell = &b->quality.images[b->quality.count].cells[falloff][config];
    const struct ao_job job = make_job(&b->quality.configs.rows[config], scene, falloff);
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
    ok = ok && score(b, scene, falloff, config, result.ao, raymarch, err);
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
static bool converge(struct bench *b, struct scene *scene, int falloff, size_t config, float **mean,
                     struct tool_error *err)
{
    struct quality_cell *cell = &b->quality.images[b->quality.count].cells[falloff][config];
    size_t texels = (size_t)scene->gbuffer.width * scene->gbuffer.height;
    unsigned passes = b->options->passes;
    struct ao_job job = make_job(&b->quality.configs.rows[config], scene, falloff);
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
    ok = ok && score(b, scene, falloff, config, *mean, NULL, err);
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
        image->cells[falloff][c] = (struct quality_cell){
            .estimator_rmse = NAN, .full_rmse = NAN, .rmse_to_reference = NAN, .flicker = NAN};
    /* First: the others are compared with it. */
    for (size_t c = 0; ok && c < configs->count; c++)
        if (configs->rows[c].is_yardstick)
            ok = converge(b, scene, falloff, c, &raymarch, err);
    for (size_t c = 0; ok && c < configs->count; c++)
        if (!configs->rows[c].is_yardstick)
            ok = measure(b, scene, falloff, c, raymarch, err);
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

static bool measure_scene(struct bench *b, size_t index, struct scene *scene,
                          struct tool_error *err)
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
    if (b->options->sequence && !flicker_track(&b->flicker, scene, err))
        return false;
    snprintf(image->name, sizeof image->name, "%s", scene->name);
    image->is_fitted = b->options->fitted && corpus_fits(&b->corpus, index, b->options->fitted);
    image->has_reference = isfinite(reference_rmse(b->reference, scene->name));
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
    if (ok && b->options->sequence && source.view_count != 1)
        ok = fail(err, EXIT_INPUT, "%s: %zu views, want one in a sequence", source.info.path,
                  source.view_count);
    for (size_t v = 0; ok && v < source.view_count; v++) {
        struct scene scene;
        ok = scene_load(&b->corpus, index, &source, v, b->quality.has_falloff, &b->report, &scene,
                        err);
        if (ok)
            report_note(&b->report, "%zu/%zu %s: %u x %u, radius %g", index + 1, b->corpus.count,
                        scene.name, scene.gbuffer.width, scene.gbuffer.height,
                        (double)scene.radius);
        ok = ok && measure_scene(b, index, &scene, err);
        scene_free(&scene);
    }
    frame_source_close(&source);
    return ok;
}

static void finish_flicker(struct bench *b)
{
    struct quality *q = &b->quality;
    q->tracked_share = flicker_share(&b->flicker);
    for (int f = 0; f < FALLOFFS; f++)
        for (size_t c = 0; c < q->configs.count; c++)
            q->flicker[f][c] = flicker_of(&b->flicker, (size_t)f * MAX_CONFIGS + c);
}

/* Errors that the next file would meet again end it, and so do those of a frame. */
static bool measure_all(struct bench *b, struct tool_error *err)
{
    for (size_t i = 0; i < b->corpus.count; i++) {
        struct tool_error once = {0};
        if (measure_file(b, i, &once))
            continue;
        if (once.code == EXIT_DEVICE || once.code == EXIT_MEMORY || once.code == EXIT_BUG ||
            b->corpus.count == 1 || b->options->sequence) {
            *err = once;
            return false;
        }
        report_error(&once);
        b->failed++;
    }
    if (b->quality.count == 0)
        return fail(err, EXIT_INPUT, "%s: no G-buffer could be measured", b->options->folder);
    finish_flicker(b);
    return true;
}

/* --- Output --- */

static bool put_out(const struct bench *b, struct tool_error *err)
{
    const struct quality_options *o = b->options;
    const bool json_on_stdout = o->json && strcmp(o->json, "-") == 0;
    struct text text = {0};
    if (o->text || !(o->markdown || json_on_stdout))
        quality_add_text(&b->quality, &text);
    if (o->markdown)
        quality_add_markdown(&b->quality, &text);
    bool ok = !text.out_of_memory || fail(err, EXIT_MEMORY, "out of memory");
    ok = ok && (!text.data || report_text(text.data, err));
    text_free(&text);
    const unsigned begun = json_begin();
    return ok && (!o->json || json_write(o->json, quality_json(&b->quality), begun, err));
}

/* --- Command --- */

static bool check_options(const struct quality_options *o, struct tool_error *err)
{
    if (o->sequence && o->fitted)
        return fail(err, EXIT_USAGE, "--fitted with --sequence: its frames are one scene");
    if (o->against && o->falloff == FALLOFF_BOTH)
        return fail(err, EXIT_USAGE,
                    "--against holds the errors of one falloff: add --falloff smooth or threshold");
    return true;
}

/* All that is known of the files before the first is opened. */
static bool prepare_files(struct bench *b, struct tool_error *err)
{
    const struct quality_options *o = b->options;
    b->quality.is_sequence = o->sequence;
    b->quality.has_groups = o->fitted != NULL;
    b->quality.has_reference = o->against != NULL;
    b->reference = o->against ? reference_read(o->against, err) : NULL;
    return (!o->against || b->reference) && corpus_open(o->folder, o->files, &b->corpus, err) &&
           (!o->sequence || corpus_order_frames(&b->corpus, err)) &&
           (!o->fitted || corpus_check_patterns(&b->corpus, "--fitted", o->fitted, err));
}

static bool prepare(struct bench *b, struct tool_error *err)
{
    const struct quality_options *o = b->options;
    struct quality *q = &b->quality;
    const struct config yardstick = config_yardstick();
    const struct gpu_options gpu = {.device = o->device};
    exr_set_threads(0);
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
    if (!prepare_files(b, err) || !gpu_create(&gpu, &b->gpu, err))
        return false;
    snprintf(q->device, sizeof q->device, "%s", b->gpu.properties.deviceName);
    b->session = ao_session_create(&b->gpu, err);
    return b->session != NULL;
}

int command_quality(int argc, char **argv)
{
    struct quality_options options = default_options;
    struct bench b = {.options = &options};
    struct tool_error err = {0};
    bool ok = arguments_take(&arguments, argc, argv, &options, &options.folder, &err) &&
              check_options(&options, &err);
    b.report.verbosity = options.quiet ? REPORT_QUIET : REPORT_NORMAL;
    ok = ok && prepare(&b, &err) && measure_all(&b, &err) && put_out(&b, &err);
    ao_session_destroy(b.session);
    gpu_destroy(&b.gpu);
    corpus_close(&b.corpus);
    flicker_free(&b.flicker);
    cJSON_Delete(b.reference);
    free(b.quality.images);
    const int code = arguments_end(&arguments, ok, &err);
    return ok && b.failed ? EXIT_SOME_FRAMES : code;
}
