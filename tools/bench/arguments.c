/* SPDX-License-Identifier: MIT */
#include "arguments.h"

#include "report.h"
#include "text.h"

#include <getopt.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

/* Long options carry FIRST_LONG and their row. */
enum { MAX_ARGUMENTS = 32, COLUMNS = 80, HELP_COLUMN = 26, FIRST_LONG = 256 };

static const struct argument help = {"help", NULL, "print this", ARGUMENT_FLAG, 0, 0, 0, NULL};

static void add_option(const struct argument *row, struct text *text)
{
    struct text left = {0};
    text_add(&left, "  --%s%s%s", row->name, row->value ? " " : "", row->value ? row->value : "");
    text_add(text, "%-*s", HELP_COLUMN, left.data ? left.data : "");
    if (left.length >= HELP_COLUMN)
        text_add(text, "\n%*s", HELP_COLUMN, "");
    text_free(&left);
    text_add_wrapped(text, row->help, HELP_COLUMN, COLUMNS);
}

static void print_help(const struct argument_list *list)
{
    struct text text = {0};
    text_add(&text, "%s", list->usage);
    for (size_t i = 0; i < list->count; i++)
        add_option(&list->rows[i], &text);
    add_option(&help, &text);
    if (text.data && !text.out_of_memory)
        fputs(text.data, stdout);
    text_free(&text);
}

static bool apply_word(const struct argument *row, const char *value, void *member,
                       struct tool_error *err)
{
    struct text wanted = {0};
    for (const struct argument_word *w = row->words; w->word; w++) {
        if (strcmp(w->word, value) == 0) {
            memcpy(member, &w->value, sizeof w->value);
            text_free(&wanted);
            return true;
        }
        text_add(&wanted, "%s%s", w == row->words ? "" : w[1].word ? ", " : " or ", w->word);
    }
    fail(err, EXIT_USAGE, "--%s is '%s', want %s", row->name, value,
         wanted.data ? wanted.data : "another word");
    text_free(&wanted);
    return false;
}

static bool apply_count(const struct argument *row, const char *value, void *member,
                        struct tool_error *err)
{
    int64_t count;
    if (!text_to_integer(value, &count) || (double)count < row->low || (double)count > row->high)
        return fail(err, EXIT_USAGE, "--%s is %s, want a whole number from %g to %g", row->name,
                    value, row->low, row->high);
    *(unsigned *)member = (unsigned)count;
    return true;
}

static bool apply_number(const struct argument *row, const char *value, void *member,
                         struct tool_error *err)
{
    double number;
    if (!text_to_number(value, &number) || !((double)(float)number > row->low) ||
        !isfinite((float)number))
        return fail(err, EXIT_USAGE, "--%s is %s, want a finite number > %g", row->name, value,
                    row->low);
    *(float *)member = (float)number;
    return true;
}

static bool apply(const struct argument *row, const char *value, void *target,
                  struct tool_error *err)
{
    void *member = (char *)target + row->offset;
    switch (row->kind) {
    case ARGUMENT_FLAG:
        *(bool *)member = true;
        return true;
    case ARGUMENT_WORD:
        return apply_word(row, value, member, err);
    case ARGUMENT_COUNT:
        return apply_count(row, value, member, err);
    case ARGUMENT_NUMBER:
        return apply_number(row, value, member, err);
    default:
        break;
    }
    if (!*value)
        return fail(err, EXIT_USAGE, "--%s is empty", row->name);
    *(const char **)member = value;
    return true;
}

/* getopt leaves optopt at 0 for unknown names, and has not passed a word of several letters yet. */
static bool fail_option(char **argv, struct tool_error *err)
{
    if (optopt == 0)
        return fail(err, EXIT_USAGE, "unknown option '%s'", argv[optind - 1]);
    if (optopt >= FIRST_LONG)
        return fail(err, EXIT_USAGE, "option '%s' takes no argument", argv[optind - 1]);
    return fail(err, EXIT_USAGE, "unknown option '-%c'", optopt);
}

/* The words that are no options are left, from optind on. */
static bool parse_options(const struct argument_list *list, int argc, char **argv, void *target,
                          bool *wants_help, struct tool_error *err)
{
    struct option longs[MAX_ARGUMENTS + 2] = {0};
    int code;
    *wants_help = false;
    if (list->count > MAX_ARGUMENTS)
        return fail(err, EXIT_BUG, "too many options");
    for (size_t i = 0; i < list->count; i++)
        longs[i] = (struct option){
            .name = list->rows[i].name,
            .has_arg = list->rows[i].value ? required_argument : no_argument,
            .val = FIRST_LONG + (int)i,
        };
    longs[list->count] = (struct option){.name = help.name, .val = FIRST_LONG + (int)list->count};
    optind = 0; /* glibc and musl: start afresh */
    opterr = 0;
    while ((code = getopt_long(argc, argv, ":", longs, NULL)) != -1) {
        if (code == ':')
            return fail(err, EXIT_USAGE, "option '%s' needs an argument", argv[optind - 1]);
        if (code == '?')
            return fail_option(argv, err);
        if (code - FIRST_LONG == (int)list->count)
            *wants_help = true;
        else if (!apply(&list->rows[code - FIRST_LONG], optarg, target, err))
            return false;
    }
    return true;
}

bool arguments_take(const struct argument_list *list, int argc, char **argv, void *target,
                    const char **folder, struct tool_error *err)
{
    bool wants_help;
    if (!parse_options(list, argc, argv, target, &wants_help, err))
        return false;
    if (wants_help) {
        print_help(list);
        return false;
    }
    const int words = argc - optind;
    if (!folder)
        return words == 0 || fail(err, EXIT_USAGE, "'%s' is no option", argv[optind]);
    if (words > 1)
        return fail(err, EXIT_USAGE, "one FOLDER at a time, got '%s' and '%s'", argv[optind],
                    argv[optind + 1]);
    *folder = words > 0 ? argv[optind] : NULL;
    return words > 0 || fail(err, EXIT_USAGE, "no FOLDER given");
}

int arguments_end(const struct argument_list *list, bool ok, struct tool_error *err)
{
    if (ok || err->code == EXIT_OK)
        return EXIT_OK;
    if (err->code == EXIT_USAGE)
        fail_hint(err, "'vkao-bench %s --help' explains the options", list->command);
    report_error(err);
    return err->code;
}
