/* SPDX-License-Identifier: MIT */
#include "options.h"

#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_OPTIONS = 96, COLUMNS = 80, HELP_COLUMN = 30 };

static const char example[] = "example: vkao beauty.####.exr -o ao.####.exr --frames 1001-1100";

static const struct {
    const char *name;
    enum command command;
} commands[] = {
    {"render", COMMAND_RENDER}, {"inspect", COMMAND_INSPECT}, {"devices", COMMAND_DEVICES}};

static const char *command_name(enum command command)
{
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++)
        if (commands[i].command == command)
            return commands[i].name;
    return "";
}

/* --- Help --- */

static void add_option(struct text *text, const struct option_row *row)
{
    char left[80], help[512];
    char letter[8] = "    ";
    if (row->letter)
        snprintf(letter, sizeof letter, "-%c, ", row->letter);
    int used = snprintf(left, sizeof left, "  %s--%s%s%s", letter, row->name,
                        row->argument ? " " : "", row->argument ? row->argument : "");
    bool tell = row->fallback && strcmp(row->fallback, "auto") != 0 && row->apply != apply_text;
    snprintf(help, sizeof help, "%s%s%s%s", row->help, tell ? " (default: " : "",
             tell ? row->fallback : "", tell ? ")" : "");
    if (used + 2 > HELP_COLUMN)
        text_add(text, "%s\n%*s", left, HELP_COLUMN, "");
    else
        text_add(text, "%-*s", HELP_COLUMN, left);
    text_add_wrapped(text, help, HELP_COLUMN, COLUMNS);
}

void options_help(struct text *text)
{
    text_add(text, "Usage: vkao [render] INPUT.exr -o OUTPUT.exr [OPTION]...\n"
                   "       vkao inspect INPUT.exr [--json] [OPTION]...\n"
                   "       vkao devices [--json]\n"
                   "\n"
                   "Ambient occlusion from the depth and the normals of OpenEXR files. INPUT and\n"
                   "OUTPUT may hold a frame token: ####, %%04d or $F4.\n");
    for (size_t i = 0; i < option_table_count; i++) {
        if (option_table[i].heading)
            text_add(text, "\n%s:\n", option_table[i].heading);
        add_option(text, &option_table[i]);
    }
    text_add(text,
             "\nExit status: 0 done, 1 some frames failed, 2 usage, 3 input, 4 channels or\n"
             "conventions, 5 Vulkan device, 6 output, 33 out of memory.\n\n%s\n",
             example);
}

/* --- Parsing --- */

static bool fail_unknown(const char *argument, struct tool_error *err)
{
    char name[64];
    const char *dashless = argument + strspn(argument, "-"), *best = NULL;
    snprintf(name, sizeof name, "%.*s", (int)strcspn(dashless, "="), dashless);
    unsigned nearest = 4;
    for (size_t i = 0; i < option_table_count; i++) {
        unsigned distance = text_distance(name, option_table[i].name);
        if (distance < nearest && distance < strlen(name)) {
            nearest = distance;
            best = option_table[i].name;
        }
    }
    fail_hint(err, "%s", best ? example : "'vkao --help' lists the options");
    if (best)
        return fail(err, EXIT_USAGE, "unknown option '--%s' (did you mean --%s?)", name, best);
    return fail(err, EXIT_USAGE, "unknown option '--%s'", name);
}

/* getopt says '?' for unknown and for ambiguous names, and leaves optopt at 0 for long ones. */
static bool fail_option(char **argv, struct tool_error *err)
{
    if (optopt == 0 || optopt >= MAX_OPTIONS * 256)
        return fail_unknown(argv[optind - 1], err);
    if (strncmp(argv[optind - 1], "--", 2) == 0) {
        fail_hint(err, "%s", example);
        return fail(err, EXIT_USAGE, "option '%s' takes no argument", argv[optind - 1]);
    }
    fail_hint(err, "'vkao --help' lists the options");
    return fail(err, EXIT_USAGE, "unknown option '-%c'", optopt);
}

static bool fail_argument(char **argv, struct tool_error *err)
{
    fail_hint(err, "%s", example);
    return fail(err, EXIT_USAGE, "option '%s' needs an argument", argv[optind - 1]);
}

/* Long options carry 256 + their row, so that those without a letter differ. */
static size_t build_getopt(struct option *longs, char *shorts)
{
    size_t s = 0;
    shorts[s++] = ':';
    for (size_t i = 0; i < option_table_count; i++) {
        const struct option_row *row = &option_table[i];
        longs[i] = (struct option){.name = row->name,
                                   .has_arg = row->argument ? required_argument : no_argument,
                                   .val = 256 + (int)i};
        if (row->letter) {
            shorts[s++] = row->letter;
            if (row->argument)
                shorts[s++] = ':';
        }
    }
    longs[option_table_count] = (struct option){0};
    shorts[s] = '\0';
    return option_table_count;
}

static const struct option_row *row_of(int code)
{
    if (code >= 256)
        return &option_table[code - 256];
    for (size_t i = 0; i < option_table_count; i++)
        if (option_table[i].letter == code)
            return &option_table[i];
    return NULL;
}

static bool apply_defaults(struct options *options, struct tool_error *err)
{
    *options = (struct options){.command = COMMAND_RENDER,
                                .ssao = ao_ssao_default(),
                                .blur = ao_blur_default(),
                                .composite = ao_composite_default()};
    /* What --quality fills unless it is given. */
    options->ssao.slice_count = options->ssao.step_count = 0;
    options->ssao.thickness = 0.0f;
    for (size_t i = 0; i < option_table_count; i++) {
        const struct option_row *row = &option_table[i];
        if (row->fallback && !row->apply(options, row, row->fallback, err))
            return false;
    }
    return true;
}

static bool parse_options(int argc, char **argv, struct options *options, struct tool_error *err)
{
    struct option longs[MAX_OPTIONS + 1];
    char shorts[3 * MAX_OPTIONS + 2];
    build_getopt(longs, shorts);
    optind = 0; /* glibc and musl: start afresh */
    opterr = 0;
    int code;
    while ((code = getopt_long(argc, argv, shorts, longs, NULL)) != -1) {
        if (code == '?')
            return fail_option(argv, err);
        if (code == ':')
            return fail_argument(argv, err);
        const struct option_row *row = row_of(code);
        if (!row)
            return fail(err, EXIT_BUG, "option %d is not in the table", code);
        if (!(row->commands & (unsigned)options->command))
            return fail(err, EXIT_USAGE, "option '--%s' has no meaning for 'vkao %s'", row->name,
                        command_name(options->command));
        if (!row->apply(options, row, optarg, err)) {
            fail_hint(err, "'vkao --help' explains the options");
            return false;
        }
    }
    return true;
}

static bool fail_positional(const char *first, const char *second, struct tool_error *err)
{
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++)
        if (text_distance(first, commands[i].name) <= 2)
            return fail(err, EXIT_USAGE, "unknown command '%s' (did you mean %s?)", first,
                        commands[i].name);
    fail_hint(err, "quote patterns, so that the shell leaves them alone; %s", example);
    return fail(err, EXIT_USAGE, "one INPUT at a time, got '%s' and '%s'", first, second);
}

/* The preset fills what was not given. Only vbao was chosen with it; the other methods take their samples as they are. */
static void apply_quality(struct options *o)
{
    VkBool32 half_resolution = VK_FALSE;
    struct ao_ssao ssao = o->ssao;
    struct ao_blur blur = o->blur;
    /* The table knows no other quality. */
    (void)ao_preset((vkao_quality)o->quality, &half_resolution, &ssao, &blur);
    o->half_resolution = half_resolution;
    if (!o->ssao.slice_count)
        o->ssao.slice_count = ssao.slice_count;
    if (!o->ssao.step_count)
        o->ssao.step_count = ssao.step_count;
    if (!(o->ssao.thickness > 0.0f))
        o->ssao.thickness = ssao.thickness;
    if (o->blur.radius == BLUR_BY_QUALITY)
        o->blur.radius = blur.radius;
    if (o->blur.normal_power < 0.0f)
        o->blur.normal_power = blur.normal_power;
}

static bool check_together(const struct options *o, struct tool_error *err)
{
    if (o->command != COMMAND_DEVICES && !o->input) {
        fail_hint(err, "%s", example);
        return fail(err, EXIT_USAGE, "no INPUT given");
    }
    if (o->command == COMMAND_DEVICES && o->input)
        return fail(err, EXIT_USAGE, "'vkao devices' takes no INPUT, got '%s'", o->input);
    if (o->command == COMMAND_RENDER && !o->output) {
        fail_hint(err, "%s", example);
        return fail(err, EXIT_USAGE, "no output given: -o FILE");
    }
    if (o->bent_normals && o->ssao.method != VKAO_SSAO_VBAO && o->ssao.method != VKAO_SSAO_GTAO &&
        o->ssao.method != VKAO_SSAO_RAYMARCH)
        return fail(err, EXIT_USAGE, "--bent-normals needs --method vbao, gtao or raymarch");
    if (o->gbuffer.camera.fov_deg > 0 && o->gbuffer.camera.ortho_width > 0)
        return fail(err, EXIT_USAGE, "--fov and --ortho exclude each other");
    return true;
}

bool options_parse(int argc, char **argv, struct options *options, struct tool_error *err)
{
    if (option_table_count > MAX_OPTIONS)
        return fail(err, EXIT_BUG, "too many options");
    if (!apply_defaults(options, err))
        return false;
    for (size_t i = 0; argc > 1 && i < sizeof commands / sizeof *commands; i++) {
        if (strcmp(argv[1], commands[i].name) != 0)
            continue;
        options->command = commands[i].command;
        argc--;
        argv++;
        break;
    }
    if (!parse_options(argc, argv, options, err))
        return false;
    if (options->help || options->version)
        return true;
    if (optind < argc)
        options->input = argv[optind++];
    if (optind < argc)
        return fail_positional(options->input, argv[optind], err);
    options->gbuffer.want_color = options->mode == OUTPUT_COMP;
    apply_quality(options);
    return check_together(options, err);
}
