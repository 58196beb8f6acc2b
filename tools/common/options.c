/* SPDX-License-Identifier: MIT */
#include "options.h"

#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char options_example[] = "example: vkao beauty.####.exr -o ao.####.exr --frames 1001-1100";

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
    fail_hint(err, "%s", best ? options_example : "'vkao --help' lists the options");
    if (best)
        return fail(err, EXIT_USAGE, "unknown option '--%s' (did you mean --%s?)", name, best);
    return fail(err, EXIT_USAGE, "unknown option '--%s'", name);
}

/* Long options carry it and their row, so that those without a letter differ. */
enum { FIRST_LONG = 256 };

/* getopt says '?' for unknown and for ambiguous names, and leaves optopt at 0 for long ones. A word
 * of several letters it has not passed yet. */
static bool fail_option(char **argv, struct tool_error *err)
{
    if (optopt == 0)
        return fail_unknown(argv[optind - 1], err);
    if (optopt >= FIRST_LONG) {
        fail_hint(err, "%s", options_example);
        return fail(err, EXIT_USAGE, "option '%s' takes no argument", argv[optind - 1]);
    }
    fail_hint(err, "'vkao --help' lists the options");
    return fail(err, EXIT_USAGE, "unknown option '-%c'", optopt);
}

static bool fail_argument(char **argv, struct tool_error *err)
{
    fail_hint(err, "%s", options_example);
    return fail(err, EXIT_USAGE, "option '%s' needs an argument", argv[optind - 1]);
}

static void build_getopt(struct option *longs, char *shorts)
{
    size_t s = 0;
    shorts[s++] = ':';
    for (size_t i = 0; i < option_table_count; i++) {
        const struct option_row *row = &option_table[i];
        longs[i] = (struct option){.name = row->name,
                                   .has_arg = row->argument ? required_argument : no_argument,
                                   .val = FIRST_LONG + (int)i};
        if (row->letter) {
            shorts[s++] = row->letter;
            if (row->argument)
                shorts[s++] = ':';
        }
    }
    longs[option_table_count] = (struct option){0};
    shorts[s] = '\0';
}

static const struct option_row *row_of(int code)
{
    if (code >= FIRST_LONG)
        return &option_table[code - FIRST_LONG];
    for (size_t i = 0; i < option_table_count; i++)
        if (option_table[i].letter == code)
            return &option_table[i];
    return NULL;
}

static bool apply_defaults(struct options *options, struct tool_error *err)
{
    *options = (struct options){.command = COMMAND_RENDER, .asked = setting_default()};
    for (size_t i = 0; i < option_table_count; i++) {
        const struct option_row *row = &option_table[i];
        if (row->fallback && !row->apply(options, row, row->fallback, err))
            return false;
    }
    return true;
}

static bool fail_command(const struct option_row *row, enum command command, struct tool_error *err)
{
    if (command == COMMAND_INSPECT)
        fail_hint(err, "'vkao inspect' takes the options that say what the file holds");
    return fail(err, EXIT_USAGE, "option '--%s' has no meaning for 'vkao %s'", row->name,
                command_name(command));
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
            return fail_command(row, options->command, err);
        if (!row->apply(options, row, optarg, err)) {
            fail_hint(err, "'vkao --help' explains the options");
            return false;
        }
        options->given[row - option_table] = true;
    }
    return true;
}

static bool fail_positional(const char *first, const char *second, struct tool_error *err)
{
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++)
        if (text_distance(first, commands[i].name) <= 2)
            return fail(err, EXIT_USAGE, "unknown command '%s' (did you mean %s?)", first,
                        commands[i].name);
    fail_hint(err, "quote patterns, so that the shell leaves them alone; %s", options_example);
    return fail(err, EXIT_USAGE, "one INPUT at a time, got '%s' and '%s'", first, second);
}

static bool check_together(const struct options *o, struct tool_error *err)
{
    if (o->command != COMMAND_DEVICES && !o->input) {
        fail_hint(err, "%s", options_example);
        return fail(err, EXIT_USAGE, "no INPUT given");
    }
    if (o->input && !*o->input)
        return fail(err, EXIT_USAGE, "INPUT is empty");
    if (o->command == COMMAND_DEVICES && o->input)
        return fail(err, EXIT_USAGE, "'vkao devices' takes no INPUT, got '%s'", o->input);
    if (o->command == COMMAND_RENDER && !o->output) {
        fail_hint(err, "%s", options_example);
        return fail(err, EXIT_USAGE, "no output given: -o FILE");
    }
    if (o->gbuffer.camera.fov_deg > 0 && o->gbuffer.camera.ortho_width > 0)
        return fail(err, EXIT_USAGE, "--fov and --ortho exclude each other");
    if (o->gbuffer.roles.name[ROLE_THICKNESS] && o->gbuffer.roles.name[ROLE_BACK_DEPTH])
        return fail(err, EXIT_USAGE, "--thickness-channel and --back-depth exclude each other");
    return true;
}

/* Options that change nothing are mistakes; a record may bring the mode. */
static bool check_light(const struct options *o, struct tool_error *err)
{
    static const enum role_kind kinds[] = {ROLE_INDIRECT, ROLE_ALBEDO, ROLE_SPECULAR,
                                           ROLE_ROUGHNESS};
    static const char *const names[] = {"indirect", "albedo", "specular", "roughness"};
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        if (o->command == COMMAND_RENDER && !o->like && o->gbuffer.roles.name[kinds[i]] &&
            o->mode != OUTPUT_COMP)
            return fail(err, EXIT_USAGE, "--%s needs --mode comp", names[i]);
    if (o->gbuffer.roles.name[ROLE_ROUGHNESS] && !o->gbuffer.roles.name[ROLE_SPECULAR] && !o->like)
        return fail(err, EXIT_USAGE, "--roughness needs --specular");
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
    return check_together(options, err) && check_light(options, err) &&
           options_settle(options, NULL, err);
}

/* --- Options, preset and record together --- */

bool option_is_given(const struct options *options, const char *name)
{
    for (size_t i = 0; i < option_table_count; i++)
        if (strcmp(option_table[i].name, name) == 0)
            return options->given[i];
    return false;
}

/* The preset decides how much is computed, and how it is blurred, not what: only vbao was chosen
 * with it, and the other methods take its samples and its blur as they are. */
static void apply_quality(struct setting *s, int quality)
{
    const struct setting before = *s;
    setting_apply_preset(s, (vkao_quality)quality);
    s->effect.method = before.effect.method;
    s->params.bias = before.params.bias;
}

static bool is_left(const struct options *o, const char *name)
{
    for (size_t i = 0; i < option_table_count; i++)
        if (strcmp(option_table[i].name, name) == 0)
            return !o->given[i] || o->automatic[i];
    return true;
}

/* Whether the method reads a parameter that an option has set. */
static bool check_method(const struct options *o, const char *option, const char *parameter,
                         struct tool_error *err)
{
    const uint32_t methods = parameter_named(parameter)->methods;
    if (methods >> o->setting.effect.method & 1u)
        return true;
    struct text list = {0};
    text_add_list(&list, parameter_named("method")->choices, methods, "or");
    fail(err, EXIT_USAGE, "--%s needs --method %s", option, list.data ? list.data : "");
    text_free(&list);
    return false;
}

static bool check_methods(const struct options *o, struct tool_error *err)
{
    const vkao_effect_info *e = &o->setting.effect;
    const bool is_given = e->thickness_input == VKAO_THICKNESS_GIVEN;
    return (!e->bent_normals || check_method(o, "bent-normals", "bent_normals", err)) &&
           (!e->thickness_input || check_method(o, is_given ? "thickness-channel" : "back-depth",
                                                "thickness_input", err)) &&
           (!e->second_layer || check_method(o, "layer2", "second_layer", err));
}

bool options_settle(struct options *options, const struct setting *like, struct tool_error *err)
{
    struct options *o = options;
    struct setting standard = setting_default();
    apply_quality(&standard, o->quality);
    o->setting = like ? *like : standard;
    if (like && option_is_given(o, "quality"))
        apply_quality(&o->setting, o->quality);
    for (size_t i = 0; i < option_table_count; i++) {
        const vkao_parameter *p = o->given[i] ? option_parameter(&option_table[i]) : NULL;
        if (p)
            parameter_copy(p, &o->setting, o->automatic[i] ? &standard : &o->asked);
    }
    o->radius_is_auto = is_left(o, "radius") && (!like || option_is_given(o, "radius"));
    o->bias_is_given = like || !is_left(o, "bias");
    o->gbuffer.want_color = o->mode == OUTPUT_COMP;
    const char *const *names = o->gbuffer.roles.name;
    o->setting.effect.thickness_input = names[ROLE_THICKNESS]    ? VKAO_THICKNESS_GIVEN
                                        : names[ROLE_BACK_DEPTH] ? VKAO_THICKNESS_BACK_DEPTH
                                                                 : VKAO_THICKNESS_AS_SEEN;
    o->setting.effect.second_layer = names[ROLE_LAYER2] != NULL;
    o->setting.effect.multi_bounce = names[ROLE_ALBEDO] && o->gbuffer.want_color;
    o->setting.effect.specular = !names[ROLE_SPECULAR] || !o->gbuffer.want_color
                                     ? VKAO_SPECULAR_NONE
                                 : o->setting.effect.bent_normals ? VKAO_SPECULAR_FROM_BENT
                                                                  : VKAO_SPECULAR_FROM_AO;
    /* A record may bring another method. */
    const bool all_is_known = like || !o->like;
    return !all_is_known || check_methods(o, err);
}
