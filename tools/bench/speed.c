/* SPDX-License-Identifier: MIT
 *
 * vkao-bench speed: what each stage costs, in runs that take turns, beside any other program. */
#include "commands.h"

#include "arguments.h"
#include "engine.h"
#include "json.h"
#include "memory.h"
#include "report.h"
#include "rival.h"
#include "room.h"
#include "scaling.h"
#include "sizes.h"
#include "start.h"
#include "timings.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { THREADS_AS_THEY_ARE = 1 << 16 };

struct speed_options {
    const char *size, *configs, *preset, *method, *vs, *json, *dump, *device;
    unsigned slices, steps, samples; /* 0 = the method's default */
    unsigned sky, threads, runs;
    float radius;
    bool composite, bent_normals, start, scaling, memory, text, markdown, quiet;
};

#define AT(member) offsetof(struct speed_options, member)

/* One option a row; the values in the help are the defaults of default_options. */
static const struct argument rows[] = {
    {"size", "LIST", "comma-separated: WxH, 720p, 1080p (default), 2160p or 8k", ARGUMENT_TEXT,
     AT(size), 0, 0, NULL},
    {"configs", "LIST",
     "comma-separated: names from the table, methods, METHOD-SAMPLES or METHOD-SLICESxSTEPS. "
     "Default: four presets and six settings",
     ARGUMENT_TEXT, AT(configs), 0, 0, NULL},
    {"preset", "LIST", "fast, default, high, best", ARGUMENT_TEXT, AT(preset), 0, 0, NULL},
    {"method", "LIST", "sphere, hemisphere, hbao, gtao, vbao, raymarch; with the next three",
     ARGUMENT_TEXT, AT(method), 0, 0, NULL},
    {"slices", "N", "of hbao, gtao and vbao (1)", ARGUMENT_COUNT, AT(slices), 1, 64, NULL},
    {"steps", "N", "of hbao, gtao, vbao and raymarch (9)", ARGUMENT_COUNT, AT(steps), 1, 256, NULL},
    {"samples", "N", "of sphere and hemisphere, rays of raymarch (16)", ARGUMENT_COUNT, AT(samples),
     1, 1024, NULL},
    {"radius", "R", "scene units; the room is 10 deep (0.5)", ARGUMENT_NUMBER, AT(radius), 0, 0,
     NULL},
    {"sky", "PERCENT", "rows that show sky, from the top (0)", ARGUMENT_COUNT, AT(sky), 0, 100,
     NULL},
    {"composite", NULL, "also multiply a colour image with it", ARGUMENT_FLAG, AT(composite), 0, 0,
     NULL},
    {"bent-normals", NULL, "also write bent normals: gtao, vbao, raymarch", ARGUMENT_FLAG,
     AT(bent_normals), 0, 0, NULL},
    {"threads", "N", "of Mesa lavapipe (LP_NUM_THREADS), for --vs too; others ignore it",
     ARGUMENT_COUNT, AT(threads), 0, 256, NULL},
    {"runs", "N", "of each setting, taking turns, after one that does not count (9)",
     ARGUMENT_COUNT, AT(runs), 1, MAX_RUNS, NULL},
    {"vs", "COMMAND",
     "run it in turn with every run of all settings, and take the lines 'NAME med X ms' that it "
     "prints, or the list that --json writes",
     ARGUMENT_TEXT, AT(vs), 0, 0, NULL},
    {"start", NULL,
     "instead: device, context and effect, and the first two frames of a process, with an empty "
     "(cold) and a filled (warm) shader cache on disk",
     ARGUMENT_FLAG, AT(start), 0, 0, NULL},
    {"scaling", NULL,
     "instead: growth with pixels, samples and radius. Default setting: vbao-default",
     ARGUMENT_FLAG, AT(scaling), 0, 0, NULL},
    {"memory", NULL, "instead: scratch memory of frames. Default sizes: all four names",
     ARGUMENT_FLAG, AT(memory), 0, 0, NULL},
    {"dump", "PREFIX", "write the room to PREFIX_z32.npy and PREFIX_n8.npy first", ARGUMENT_TEXT,
     AT(dump), 0, 0, NULL},
    {"text", NULL, "print tables (default, unless another output goes there)", ARGUMENT_FLAG,
     AT(text), 0, 0, NULL},
    {"markdown", NULL, "print Markdown tables", ARGUMENT_FLAG, AT(markdown), 0, 0, NULL},
    {"json", "FILE", "write all medians, as tools/bench/plot draws them; - = standard output",
     ARGUMENT_TEXT, AT(json), 0, 0, NULL},
    {"device", "NAME", "auto, cpu, a number from 'vkao devices' or part of a name", ARGUMENT_TEXT,
     AT(device), 0, 0, NULL},
    {"quiet", NULL, "no progress", ARGUMENT_FLAG, AT(quiet), 0, 0, NULL},
};

static const char usage[] =
    "Usage: vkao-bench speed [OPTION]...\n\n"
    "Device time of every stage, by timestamps. The scene is a furnished room,\n"
    "computed at any size: view z 2 to 9, horizontal field of view 60 degrees.\n"
    "Depth is R32_SFLOAT view z, normals R8G8B8A8_SNORM, AO R8_UNORM; all stay on\n"
    "the device. Settings take turns, so that a busy machine slows all of them.\n\n";

static const struct argument_list arguments = {"speed", usage, rows, sizeof rows / sizeof rows[0]};

static const struct speed_options default_options = {
    .radius = ROOM_RADIUS, .threads = THREADS_AS_THEY_ARE, .runs = 9, .device = "auto"};

struct bench {
    const struct speed_options *options;
    struct report report;
    struct config_list configs;
    struct size_list sizes;
    struct engine engine;
    struct timings timings;
    struct rivals rivals;
    struct start starts[MAX_CONFIGS];
};

/* --- What to measure --- */

/* --method and its numbers, in the names of settings. */
static bool name_methods(const struct speed_options *o, struct text *names, struct tool_error *err)
{
    const vkao_effect_info params = vkao_effect_info_default();
    const unsigned slices = o->slices ? o->slices : params.slice_count;
    const unsigned steps = o->steps ? o->steps : params.step_count;
    const unsigned samples = o->samples ? o->samples : params.sample_count;
    const char *rest = o->method;
    if (!rest && (o->slices || o->steps || o->samples))
        return fail(err, EXIT_USAGE, "--slices, --steps and --samples belong to --method");
    while (rest && *rest) {
        const size_t length = strcspn(rest, ",");
        vkao_ssao_method method;
        if (!config_find_method(rest, length, &method))
            return fail(err, EXIT_USAGE, "--method: no method '%.*s'", (int)length, rest);
        text_add(names, ",%s", config_of(method, samples, slices, steps).name);
        rest += length + (rest[length] == ',');
    }
    return true;
}

static bool choose_configs(struct bench *b, struct tool_error *err)
{
    const struct speed_options *o = b->options;
    struct text names = {0};
    const char *option = o->configs ? "--configs" : o->preset ? "--preset" : "--method";
    if (o->configs)
        text_add(&names, ",%s", o->configs);
    if (o->preset)
        text_add(&names, ",%s", o->preset);
    if (o->scaling && !o->configs && !o->preset && !o->method)
        text_add(&names, "vbao-default");
    bool ok = name_methods(o, &names, err);
    if (names.out_of_memory)
        ok = fail(err, EXIT_MEMORY, "out of memory");
    ok = ok && configs_choose(option, names.data, &b->configs, err);
    text_free(&names);
    for (size_t i = 0; ok && o->bent_normals && i < b->configs.count; i++) {
        const struct config *c = &b->configs.rows[i];
        if (!config_reads(c->method, "bent_normals"))
            ok = fail(err, EXIT_USAGE, "--bent-normals: %s has none", c->name);
    }
    return ok;
}

/* --- Measuring --- */

static bool add_rows(struct bench *b, VkExtent2D size, struct tool_error *err)
{
    for (size_t c = 0; c < b->configs.count; c++)
        if (!timings_add(&b->timings, &b->configs.rows[c], size, b->options->radius, err))
            return false;
    return true;
}

static bool measure_size(struct bench *b, VkExtent2D size, struct tool_error *err)
{
    const struct speed_options *o = b->options;
    struct engine_images images = {0};
    struct room room = {0};
    size_t first = b->timings.count;
    report_note(&b->report, "%u x %u: %zu setting%s, %u run%s", size.width, size.height,
                b->configs.count, b->configs.count == 1 ? "" : "s", o->runs,
                o->runs == 1 ? "" : "s");
    bool ok = engine_check_size(&b->engine, size, err) &&
              room_create(size.width, size.height, o->sky, &room, err) &&
              (!o->dump || room_dump(&room, o->dump, err)) &&
              engine_images_create(&b->engine, &room, &images, err);
    room_free(&room);
    ok = ok && add_rows(b, size, err) &&
         timings_measure(&b->timings, first, &b->engine, &images, &b->rivals, err);
    engine_images_destroy(&b->engine, &images);
    return ok;
}

/* A size that the device cannot hold is left out, if there are others. */
static bool measure_sizes(struct bench *b, struct tool_error *err)
{
    for (size_t i = 0; i < b->sizes.count; i++) {
        struct tool_error once = {0};
        size_t before = b->timings.count;
        if (measure_size(b, b->sizes.sizes[i], &once))
            continue;
        bool is_limit = once.code == EXIT_MEMORY || once.code == EXIT_DEVICE;
        if (!is_limit || b->sizes.count == 1 || b->timings.count != before) {
            *err = once;
            return false;
        }
        report_note(&b->report, "%u x %u left out: %s", b->sizes.sizes[i].width,
                    b->sizes.sizes[i].height, once.message);
    }
    if (b->timings.count == 0)
        return fail(err, EXIT_DEVICE, "no size fits the device");
    return true;
}

static void name_device(struct bench *b, const char *name)
{
    const unsigned threads = b->options->threads;
    char *text = b->timings.device;
    const size_t size = sizeof b->timings.device;
    if (threads == THREADS_AS_THEY_ARE)
        snprintf(text, size, "%s", name);
    else
        snprintf(text, size, "%s, LP_NUM_THREADS %u", name, threads);
}

static bool open_device(struct bench *b, struct tool_error *err)
{
    const struct speed_options *o = b->options;
    const struct engine_features features = {.composite = o->composite,
                                             .bent_normals = o->bent_normals};
    if (!engine_create(o->device, features, &b->engine, err) ||
        !engine_compile(&b->engine, b->configs.rows, b->configs.count, err))
        return false;
    name_device(b, b->engine.gpu.properties.deviceName);
    return true;
}

static bool measure_starts(struct bench *b, struct tool_error *err)
{
    const struct speed_options *o = b->options;
    char device[256];
    for (size_t c = 0; c < b->configs.count; c++) {
        report_note(&b->report, "%s: %u starts", b->configs.rows[c].name, 2 * o->runs);
        if (!start_measure(o->device, &b->configs.rows[c], b->sizes.sizes[0], o->runs, device,
                           &b->starts[c], err))
            return false;
        name_device(b, device);
    }
    return true;
}

static bool measure(struct bench *b, struct tool_error *err)
{
    const struct speed_options *o = b->options;
    if (o->start)
        return measure_starts(b, err);
    if (!open_device(b, err))
        return false;
    if (o->scaling)
        return scaling_measure(&b->engine, &b->configs.rows[0], b->sizes.sizes[0], o->sky,
                               &b->timings, err);
    return measure_sizes(b, err);
}

/* --- Command --- */

/* What --start and --memory do not read is a mistake there. */
static bool check_unread(const struct speed_options *o, struct tool_error *err)
{
    const struct {
        const char *name;
        bool is_given, start_reads;
    } options[] = {
        {"composite", o->composite, false},
        {"bent-normals", o->bent_normals, false},
        {"radius", o->radius < ROOM_RADIUS || o->radius > ROOM_RADIUS, false},
        {"sky", o->sky > 0, false},
        {"configs", o->configs, true},
        {"preset", o->preset, true},
        {"method", o->method, true},
    };
    for (size_t i = 0; i < sizeof options / sizeof options[0]; i++)
        if (options[i].is_given && (o->memory || (o->start && !options[i].start_reads)))
            return fail(err, EXIT_USAGE, "--%s does not go with --%s", options[i].name,
                        o->memory ? "memory" : "start");
    return true;
}

static bool check(const struct bench *b, struct tool_error *err)
{
    const struct speed_options *o = b->options;
    const bool instead = o->start || o->scaling || o->memory;
    if (o->start + o->scaling + o->memory > 1)
        return fail(err, EXIT_USAGE, "--start, --scaling and --memory exclude one another");
    if (instead && (o->vs || o->dump))
        return fail(err, EXIT_USAGE,
                    "--vs and --dump do not go with --start, --scaling or --memory");
    if (o->json && o->memory)
        return fail(err, EXIT_USAGE, "--json does not go with --memory");
    if (o->vs && b->sizes.count > 1)
        return fail(err, EXIT_USAGE, "--vs compares at one --size");
    if (o->dump && b->sizes.count > 1)
        return fail(err, EXIT_USAGE, "--dump writes one --size");
    if ((o->start || o->scaling) && b->sizes.count > 1)
        return fail(err, EXIT_USAGE, "--start and --scaling take one --size");
    if (o->scaling && b->configs.count > 1)
        return fail(err, EXIT_USAGE, "--scaling takes one setting");
    return check_unread(o, err);
}

static bool prepare(struct bench *b, struct tool_error *err)
{
    const struct speed_options *o = b->options;
    const char *sizes = o->memory ? "720p,1080p,2160p,8k" : "1080p";
    if (!sizes_choose(o->size ? o->size : sizes, &b->sizes, err) || !choose_configs(b, err) ||
        !check(b, err))
        return false;
    if (o->threads != THREADS_AS_THEY_ARE) {
        char number[16];
        snprintf(number, sizeof number, "%u", o->threads);
        setenv("LP_NUM_THREADS", number, 1); /* lavapipe reads it when it starts */
    }
    b->timings.runs = o->runs;
    b->timings.radius = o->radius;
    b->rivals.command = o->vs;
    return true;
}

static bool add_report(const struct bench *b, bool markdown, struct text *text,
                       struct tool_error *err)
{
    const struct speed_options *o = b->options;
    if (o->memory)
        return memory_report(o->device, b->sizes.sizes, b->sizes.count, markdown, text, err);
    if (o->start)
        start_report(b->starts, b->configs.count, b->timings.device, b->sizes.sizes[0], o->runs,
                     markdown, text);
    else if (o->scaling)
        scaling_report(&b->timings, markdown, text);
    else if (markdown)
        timings_markdown(&b->timings, text);
    else
        timings_text(&b->timings, &b->rivals, text);
    return true;
}

static bool put_out(const struct bench *b, struct tool_error *err)
{
    const struct speed_options *o = b->options;
    const bool json_on_stdout = o->json && strcmp(o->json, "-") == 0;
    struct text text = {0};
    bool ok = true;
    if (o->text || !(o->markdown || json_on_stdout))
        ok = add_report(b, false, &text, err);
    if (ok && o->markdown)
        ok = add_report(b, true, &text, err);
    if (text.out_of_memory)
        ok = fail(err, EXIT_MEMORY, "out of memory");
    if (ok && text.data)
        ok = report_text(text.data, err);
    text_free(&text);
    const unsigned begun = json_begin();
    if (ok && o->json)
        ok = json_write(o->json,
                        o->start ? start_json(b->starts, b->configs.count, o->runs)
                                 : timings_json(&b->timings, &b->rivals),
                        begun, err);
    return ok;
}

int command_speed(int argc, char **argv)
{
    struct speed_options options = default_options;
    struct bench b = {.options = &options};
    struct tool_error err = {0};
    bool ok = arguments_take(&arguments, argc, argv, &options, NULL, &err);
    b.report.verbosity = options.quiet ? REPORT_QUIET : REPORT_NORMAL;
    ok = ok && prepare(&b, &err) && (options.memory || measure(&b, &err)) && put_out(&b, &err);
    engine_destroy(&b.engine);
    rivals_free(&b.rivals);
    timings_free(&b.timings);
    return arguments_end(&arguments, ok, &err);
}
