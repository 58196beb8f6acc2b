/* SPDX-License-Identifier: MIT
 *
 * vkao-bench cost: what every pass costs on GPUs that are not there, by the instructions that
 * Mesa's compiler for AMD makes of it. A model, but the same on every machine: a change that makes
 * a shader longer shows before anybody has run it. */
#include "commands.h"

#include "arguments.h"
#include "assembly.h"
#include "cost_device.h"
#include "driver.h"
#include "engine.h"
#include "json.h"
#include "report.h"
#include "text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct cost_options {
    const char *configs, *family, *json;
    bool bent_normals, text;
};

#define AT(member) offsetof(struct cost_options, member)

static const struct argument arguments_rows[] = {
    {"configs", "LIST",
     "comma-separated: names, methods or METHOD-SLICESxSTEPS, as of 'speed'. Default: the presets "
     "and a setting of every other method",
     ARGUMENT_TEXT, AT(configs), 0, 0, NULL},
    {"family", "LIST", "comma-separated: navi21, gfx1100, vega10, polaris10 (all)", ARGUMENT_TEXT,
     AT(family), 0, 0, NULL},
    {"bent-normals", NULL, "also write bent normals: gtao, vbao, raymarch", ARGUMENT_FLAG,
     AT(bent_normals), 0, 0, NULL},
    {"text", NULL, "print a table (default, unless JSON goes there)", ARGUMENT_FLAG, AT(text), 0, 0,
     NULL},
    {"json", "FILE", "write the same for programs; - = standard output", ARGUMENT_TEXT, AT(json), 0,
     0, NULL},
};

static const char usage[] =
    "Usage: vkao-bench cost [OPTION]...\n\n"
    "Compiles the passes of GPUs with Mesa's RADV, which needs no GPU for that, and\n"
    "counts their instructions. Cycles are a model: waves of 64, no cache misses, both\n"
    "sides of every branch. Counts are exact and the same wherever Mesa is.\n\n";

static const struct argument_list arguments = {"cost", usage, arguments_rows,
                                               sizeof arguments_rows / sizeof arguments_rows[0]};

static const struct cost_options default_options = {
    .configs = "fast,default,high,best,gtao-3x6,hbao-4x6,hemisphere-16,sphere-48,raymarch-8x8",
    .family = "navi21,gfx1100,vega10,polaris10",
};

/* Cycles that one SIMD is busy with an instruction of a wave of 64. */
static const struct family {
    const char *name;
    bool is_gcn;
    double vector, transcendental, image;
} families[] = {
    /* RDNA: 32 lanes wide; transcendental ones are done beside the others, 8 lanes at a time. The
     * texture unit takes a quad a clock and serves two SIMDs. */
    {"navi21", false, 2, 8, 32},
    {"gfx1100", false, 2, 8, 32},
    /* GCN: 16 lanes wide, transcendental ones at a quarter of that; four SIMDs share a unit. */
    {"vega10", true, 4, 16, 64},
    {"polaris10", true, 4, 16, 64},
};
enum { FAMILIES = sizeof families / sizeof families[0] };

static const VkExtent2D extent = {1920, 1080};

/* A pass of a setting, or the sum of all of them. */
struct cost_row {
    const struct family *family;
    struct config config;
    char pass[32];
    double threads;      /* a texel of the image; 0 = the device decides */
    double instructions; /* of the pass; of a sum: those run for a texel of the image */
    unsigned registers, waves, shared_bytes;
    struct assembly_counts counts;
    double arithmetic, texture, cycles; /* of a SIMD for 64 texels of the image */
};

struct cost_bench {
    const struct cost_options *options;
    struct report report;
    struct config_list configs;
    const struct family *chosen[FAMILIES];
    size_t chosen_count;
    struct cost_row *rows;
    size_t count;
    struct driver_name driver;
};

/* --- One pass --- */

/* What the loops of SSAO run over, from the outermost in; those with one turn are no loops. */
static void trips_of(const struct config *config, unsigned trips[ASSEMBLY_NEST])
{
    struct ao_job job = {0};
    unsigned depth = 0;
    config_apply(config, &job);
    const vkao_effect_info *e = &job.setting.effect;
    const unsigned counts[] = {
        config_reads(config->method, "slice_count") ? e->slice_count : e->sample_count,
        config_reads(config->method, "step_count") ? e->step_count : 1,
    };
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++)
        if (counts[i] > 1)
            trips[depth++] = counts[i];
}

static void weigh(struct cost_row *row)
{
    const struct family *f = row->family;
    const struct assembly_counts *c = &row->counts;
    const double beside = f->transcendental * c->transcendental;
    row->arithmetic = f->is_gcn ? f->vector * (c->vector - c->transcendental) + beside
                                : fmax(f->vector * c->vector, beside);
    row->arithmetic *= row->threads;
    row->texture = f->image * c->image * row->threads;
    row->cycles = fmax(row->arithmetic, row->texture);
}

static struct cost_row *add_row(struct cost_bench *b, const struct cost_row *row,
                                struct tool_error *err)
{
    struct cost_row *rows = realloc(b->rows, (b->count + 1) * sizeof *rows);
    if (!rows) {
        fail(err, EXIT_MEMORY, "out of memory");
        return NULL;
    }
    b->rows = rows;
    rows[b->count] = *row;
    return &rows[b->count++];
}

/* "vkao blur x" becomes "blur-x", one word of a table. */
static void name_pass(const char *label, char pass[32])
{
    static const char prefix[] = "vkao ";
    const size_t skip = strncmp(label, prefix, sizeof prefix - 1) == 0 ? sizeof prefix - 1 : 0;
    snprintf(pass, 32, "%s", label + skip);
    for (char *at = pass; *at; at++)
        *at = *at == ' ' ? '-' : *at;
}

static bool add_pass(struct cost_bench *b, const struct cost_pipeline *p, uint64_t groups,
                     struct cost_row *total, struct tool_error *err)
{
    const uint64_t waves = groups * ((p->group_size + 63) / 64);
    unsigned trips[ASSEMBLY_NEST] = {0};
    struct cost_row row = *total;
    if (!p->assembly)
        return fail(err, EXIT_DEVICE, "%s gives no assembly of pass '%s'", b->driver.text, p->pass);
    name_pass(p->pass, row.pass);
    if (strncmp(row.pass, "ssao", 4) == 0)
        trips_of(&row.config, trips);
    row.threads = (double)waves * 64 / ((double)extent.width * extent.height);
    row.instructions = p->instructions;
    row.registers = p->registers;
    row.waves = p->waves;
    row.shared_bytes = p->shared_bytes;
    row.counts = assembly_count(p->assembly, trips);
    weigh(&row);
    total->instructions += row.counts.all * row.threads;
    total->arithmetic += row.arithmetic;
    total->texture += row.texture;
    total->cycles += row.cycles;
    return add_row(b, &row, err) != NULL;
}

/* --- One setting --- */

static vkao_result record_frame(const vkao_effect *effect, struct engine_features features,
                                const struct config *config)
{
    struct engine_images images = {.extent = extent};
    struct gpu_image *all[] = {&images.depth, &images.normals, &images.ao, &images.bent};
    vkao_images slots;
    vkao_frame_info info;
    vkao_frame *frame = NULL;
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++)
        all[i]->view = cost_device_view();
    engine_image_formats(&images);
    engine_frame_info(features, extent, &images, &slots, &info);
    vkao_result result = vkao_frame_create(effect, &info, &frame);
    if (result == VKAO_SUCCESS)
        result = engine_record(frame, extent, config, ROOM_RADIUS, cost_device_command_buffer());
    vkao_frame_destroy(frame);
    return result;
}

static bool add_setting(struct cost_bench *b, const vkao_context *ctx, const struct family *family,
                        const struct config *config, struct tool_error *err)
{
    const struct engine_features features = {.bent_normals = b->options->bent_normals};
    const vkao_effect_info info = engine_effect_info(features, config);
    const struct cost_record *record = cost_device_record();
    struct cost_row total = {.family = family, .config = *config, .pass = "total"};
    vkao_effect *effect = NULL;
    cost_device_forget();
    vkao_result result = vkao_effect_create(ctx, &info, &effect);
    if (result == VKAO_SUCCESS)
        result = record_frame(effect, features, config);
    bool ok = result == VKAO_SUCCESS || gpu_library_failed(err, "vkao_cmd_record", result);
    for (size_t i = 0; ok && i < record->dispatch_count; i++)
        ok = add_pass(b, &record->pipelines[record->dispatches[i].pipeline],
                      record->dispatches[i].groups, &total, err);
    vkao_effect_destroy(effect);
    return ok && add_row(b, &total, err);
}

static bool measure_family(struct cost_bench *b, const struct family *family,
                           struct tool_error *err)
{
    struct gpu gpu;
    report_note(&b->report, "%s: %zu setting%s", family->name, b->configs.count,
                b->configs.count == 1 ? "" : "s");
    if (!cost_device_create(family->name, &gpu, err))
        return false;
    b->driver = driver_name(&gpu);
    const vkao_context_info info = cost_device_context_info(&gpu);
    vkao_context *ctx = gpu_context_create(&info, err);
    bool ok = ctx != NULL;
    for (size_t i = 0; ok && i < b->configs.count; i++)
        ok = add_setting(b, ctx, family, &b->configs.rows[i], err);
    vkao_context_destroy(ctx);
    cost_device_destroy(&gpu);
    return ok;
}

/* --- Results --- */

static void add_line(const struct cost_row *row, struct text *text)
{
    text_add(text, "%-10s%-15s%-16s", row->family->name, row->config.name, row->pass);
    if (strcmp(row->pass, "total") == 0)
        text_add(text, "%7s%6.0f%6s%6s%6s%5s%5s%6s%6s", "", row->instructions, "", "", "", "", "",
                 "", "");
    else
        text_add(text, "%7.4f%6.0f%6.0f%6.0f%6.0f%5u%5u%6u%6u", row->threads, row->instructions,
                 row->counts.vector, row->counts.transcendental, row->counts.image,
                 row->counts.loops, row->registers, row->waves, row->shared_bytes);
    text_add(text, "%7.0f%8.0f%7.0f\n", row->arithmetic, row->texture, row->cycles);
}

static bool print_table(const struct cost_bench *b, struct tool_error *err)
{
    struct text text = {0};
    text_add(
        &text,
        "%s, %u x %u\n"
        "threads: in waves of 64, a texel of the image. instr: of the shader, in total those "
        "run for a\n"
        "texel. VALU, trans, image: run by one thread, every block once, a loop of ssao as "
        "often as it runs.\n"
        "arith, texture, cycles: of a SIMD for 64 texels; cycles is the larger of the two.\n\n",
        b->driver.text, extent.width, extent.height);
    text_add(&text, "%-10s%-15s%-16s%7s%6s%6s%6s%6s%5s%5s%6s%6s%7s%8s%7s\n", "family", "setting",
             "pass", "threads", "instr", "VALU", "trans", "image", "loop", "VGPR", "waves", "LDS",
             "arith", "texture", "cycles");
    for (size_t i = 0; i < b->count; i++)
        add_line(&b->rows[i], &text);
    const bool ok =
        text.out_of_memory ? fail(err, EXIT_MEMORY, "out of memory") : report_text(text.data, err);
    text_free(&text);
    return ok;
}

static void add_object(cJSON *list, const struct cost_row *row)
{
    cJSON *object = cJSON_CreateObject();
    cJSON_AddItemToArray(list, object);
    cJSON_AddStringToObject(object, "family", row->family->name);
    cJSON_AddStringToObject(object, "config", row->config.name);
    cJSON_AddStringToObject(object, "pass", row->pass);
    json_add_number(object, "instructions", row->instructions);
    json_add_number(object, "arithmetic_cycles", row->arithmetic);
    json_add_number(object, "texture_cycles", row->texture);
    json_add_number(object, "cycles", row->cycles);
    if (strcmp(row->pass, "total") == 0)
        return;
    json_add_number(object, "threads_per_texel", row->threads);
    json_add_number(object, "valu", row->counts.vector);
    json_add_number(object, "transcendental", row->counts.transcendental);
    json_add_number(object, "image", row->counts.image);
    json_add_number(object, "shared", row->counts.shared);
    cJSON_AddNumberToObject(object, "loops", row->counts.loops);
    cJSON_AddNumberToObject(object, "vgprs", row->registers);
    cJSON_AddNumberToObject(object, "waves_per_simd", row->waves);
    cJSON_AddNumberToObject(object, "shared_bytes", row->shared_bytes);
}

static cJSON *to_json(const struct cost_bench *b)
{
    cJSON *root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "driver", b->driver.text);
    cJSON *list = cJSON_AddArrayToObject(root, "passes");
    for (size_t i = 0; i < b->count; i++)
        add_object(list, &b->rows[i]);
    return root;
}

static bool put_out(const struct cost_bench *b, struct tool_error *err)
{
    const struct cost_options *o = b->options;
    const bool json_on_stdout = o->json && strcmp(o->json, "-") == 0;
    if ((o->text || !json_on_stdout) && !print_table(b, err))
        return false;
    const unsigned begun = json_begin();
    return !o->json || json_write(o->json, to_json(b), begun, err);
}

/* --- Command --- */

static bool choose_families(struct cost_bench *b, const char *names, struct tool_error *err)
{
    while (*names) {
        const size_t length = strcspn(names, ",");
        const struct family *found = NULL;
        for (size_t i = 0; i < FAMILIES; i++)
            if (strlen(families[i].name) == length && strncmp(families[i].name, names, length) == 0)
                found = &families[i];
        if (!found || b->chosen_count == FAMILIES)
            return fail(err, EXIT_USAGE,
                        "--family: '%.*s', want navi21, gfx1100, vega10 or polaris10, once each",
                        (int)length, names);
        b->chosen[b->chosen_count++] = found;
        names += length + (names[length] == ',');
    }
    return b->chosen_count > 0 || fail(err, EXIT_USAGE, "--family names nothing");
}

static bool check(const struct cost_bench *b, struct tool_error *err)
{
    for (size_t i = 0; b->options->bent_normals && i < b->configs.count; i++)
        if (!config_reads(b->configs.rows[i].method, "bent_normals"))
            return fail(err, EXIT_USAGE, "--bent-normals: %s has none", b->configs.rows[i].name);
    return true;
}

int command_cost(int argc, char **argv)
{
    struct cost_options options = default_options;
    struct cost_bench b = {.options = &options};
    struct tool_error err = {0};
    bool ok = arguments_take(&arguments, argc, argv, &options, NULL, &err) &&
              configs_choose("--configs", options.configs, &b.configs, &err) &&
              choose_families(&b, options.family, &err) && check(&b, &err);
    for (size_t i = 0; ok && i < b.chosen_count; i++)
        ok = measure_family(&b, b.chosen[i], &err);
    ok = ok && put_out(&b, &err);
    free(b.rows);
    return arguments_end(&arguments, ok, &err);
}
