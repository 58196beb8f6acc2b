/* SPDX-License-Identifier: MIT
 *
 * What options do with their arguments. */
#include "options.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void *member(struct options *options, const struct option_row *row)
{
    return (char *)options + row->offset;
}

bool apply_flag(struct options *options, const struct option_row *row, const char *argument,
                struct tool_error *err)
{
    (void)argument;
    (void)err;
    *(bool *)member(options, row) = true;
    return true;
}

bool apply_text(struct options *options, const struct option_row *row, const char *argument,
                struct tool_error *err)
{
    if (!*argument)
        return fail(err, EXIT_USAGE, "--%s is empty", row->name);
    *(const char **)member(options, row) = argument;
    return true;
}

bool apply_word(struct options *options, const struct option_row *row, const char *argument,
                struct tool_error *err)
{
    _Static_assert(sizeof(enum depth_type) == sizeof(int) && sizeof(vkao_falloff) == sizeof(int),
                   "enums are written as int");
    struct text wanted = {0};
    for (const struct option_word *w = row->words; w->word; w++) {
        if (strcmp(w->word, argument) == 0) {
            memcpy(member(options, row), &w->value, sizeof w->value);
            text_free(&wanted);
            return true;
        }
        text_add(&wanted, "%s%s", w == row->words ? "" : w[1].word ? ", " : " or ", w->word);
    }
    fail(err, EXIT_USAGE, "--%s is '%s', want %s", row->name, argument,
         wanted.data ? wanted.data : "");
    text_free(&wanted);
    return false;
}

static bool fail_range(const struct option_row *row, const char *argument, bool whole,
                       struct tool_error *err)
{
    const struct option_range *r = &row->range;
    const char *noun = whole ? "whole number" : r->infinity_is_allowed ? "number" : "finite number";
    char wanted[96];
    if (isinf(r->high))
        snprintf(wanted, sizeof wanted, "%s %g", r->low_is_excluded ? ">" : ">=", r->low);
    else
        snprintf(wanted, sizeof wanted, "%s %.10g and <= %.10g",
                 r->low_is_excluded ? ">" : ">=", r->low, r->high);
    return fail(err, EXIT_USAGE, "--%s is %s, want a %s %s", row->name, argument, noun, wanted);
}

static bool in_range(const struct option_range *range, double value)
{
    bool low = range->low_is_excluded ? value > range->low : value >= range->low;
    bool high =
        isinf(range->high) ? range->infinity_is_allowed || isfinite(value) : value <= range->high;
    return low && high;
}

static bool read_number(const struct option_row *row, const char *argument, double *value,
                        struct tool_error *err)
{
    if (!text_to_number(argument, value) || !in_range(&row->range, *value))
        return fail_range(row, argument, false, err);
    return true;
}

bool apply_double(struct options *options, const struct option_row *row, const char *argument,
                  struct tool_error *err)
{
    return read_number(row, argument, member(options, row), err);
}

bool apply_float(struct options *options, const struct option_row *row, const char *argument,
                 struct tool_error *err)
{
    double value;
    if (!read_number(row, argument, &value, err))
        return false;
    /* 1e-50 is in the range of double only. */
    float narrow = (float)value;
    if (!in_range(&row->range, (double)narrow))
        return fail_range(row, argument, false, err);
    *(float *)member(options, row) = narrow;
    return true;
}

static bool read_integer(const struct option_row *row, const char *argument, int64_t *value,
                         struct tool_error *err)
{
    if (!text_to_integer(argument, value) || !in_range(&row->range, (double)*value))
        return fail_range(row, argument, true, err);
    return true;
}

bool apply_uint(struct options *options, const struct option_row *row, const char *argument,
                struct tool_error *err)
{
    int64_t value;
    if (!read_integer(row, argument, &value, err))
        return false;
    *(uint32_t *)member(options, row) = (uint32_t)value;
    return true;
}

bool apply_count(struct options *options, const struct option_row *row, const char *argument,
                 struct tool_error *err)
{
    int64_t value;
    if (!read_integer(row, argument, &value, err))
        return false;
    *(uint64_t *)member(options, row) = (uint64_t)value;
    return true;
}

bool apply_bytes(struct options *options, const struct option_row *row, const char *argument,
                 struct tool_error *err)
{
    return budget_parse_bytes(argument, member(options, row)) ||
           fail(err, EXIT_USAGE, "--%s is %s, want bytes, as 800M or 4G", row->name, argument);
}

bool apply_radius(struct options *options, const struct option_row *row, const char *argument,
                  struct tool_error *err)
{
    options->radius_is_auto = strcmp(argument, "auto") == 0;
    return options->radius_is_auto || apply_float(options, row, argument, err);
}

/* The default comes through here as well, before any argument. */
bool apply_bias(struct options *options, const struct option_row *row, const char *argument,
                struct tool_error *err)
{
    options->bias_is_given = argument != row->fallback;
    return apply_float(options, row, argument, err);
}

bool apply_blur(struct options *options, const struct option_row *row, const char *argument,
                struct tool_error *err)
{
    if (strcmp(argument, "auto") == 0) {
        *(uint32_t *)member(options, row) = BLUR_BY_QUALITY;
        return true;
    }
    return apply_uint(options, row, strcmp(argument, "off") == 0 ? "0" : argument, err);
}

bool apply_normal_power(struct options *options, const struct option_row *row, const char *argument,
                        struct tool_error *err)
{
    if (strcmp(argument, "auto") == 0) {
        *(float *)member(options, row) = NORMAL_POWER_BY_QUALITY;
        return true;
    }
    return apply_float(options, row, argument, err);
}

bool apply_tint(struct options *options, const struct option_row *row, const char *argument,
                struct tool_error *err)
{
    float *tint = member(options, row);
    const char *from = argument;
    for (int i = 0; i < 3; i++) {
        char number[64];
        double value;
        int length = (int)strcspn(from, ",");
        snprintf(number, sizeof number, "%.*s", length, from);
        from += length;
        bool ends_well = i < 2 ? *from++ == ',' : !*from;
        if (!ends_well || !text_to_number(number, &value) || !in_range(&row->range, value))
            return fail(err, EXIT_USAGE, "--%s is %s, want R,G,B, each >= 0 and <= 1", row->name,
                        argument);
        tint[i] = (float)value;
    }
    return true;
}

bool apply_fov(struct options *options, const struct option_row *row, const char *argument,
               struct tool_error *err)
{
    const char *colon = strchr(argument, ':');
    char number[64];
    double value;
    snprintf(number, sizeof number, "%.*s", colon ? (int)(colon - argument) : (int)strlen(argument),
             argument);
    bool axis = !colon || strcmp(colon, ":h") == 0 || strcmp(colon, ":v") == 0;
    if (!axis || !text_to_number(number, &value) || !(value > 0 && value < 180))
        return fail(err, EXIT_USAGE,
                    "--%s is %s, want degrees > 0 and < 180, followed by :h or :v or nothing",
                    row->name, argument);
    options->gbuffer.camera.fov_deg = value;
    options->gbuffer.camera.fov_is_vertical = colon && colon[1] == 'v';
    return true;
}

bool apply_normal(struct options *options, const struct option_row *row, const char *argument,
                  struct tool_error *err)
{
    options->gbuffer.roles.no_normals = strcmp(argument, "none") == 0;
    if (!options->gbuffer.roles.no_normals)
        return apply_text(options, row, argument, err);
    *(const char **)member(options, row) = NULL;
    return true;
}

bool apply_compression(struct options *options, const struct option_row *row, const char *argument,
                       struct tool_error *err)
{
    static const char *const names[] = {"none",  "rle", "zips", "zip",  "piz",
                                        "pxr24", "b44", "b44a", "dwaa", "dwab"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strcmp(names[i], argument) == 0)
            return apply_text(options, row, argument, err);
    return fail(err, EXIT_USAGE, "--%s is '%s', want %s", row->name, argument, row->help);
}

bool apply_verbose(struct options *options, const struct option_row *row, const char *argument,
                   struct tool_error *err)
{
    (void)row;
    (void)argument;
    (void)err;
    options->verbosity = REPORT_VERBOSE;
    return true;
}

bool apply_quiet(struct options *options, const struct option_row *row, const char *argument,
                 struct tool_error *err)
{
    (void)row;
    (void)argument;
    (void)err;
    options->verbosity = REPORT_QUIET;
    return true;
}
