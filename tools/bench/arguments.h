/* SPDX-License-Identifier: MIT
 *
 * The command line of one sub-command, as a table: parsing, ranges and --help come from it. */
#ifndef VKAO_BENCH_ARGUMENTS_H_
#define VKAO_BENCH_ARGUMENTS_H_

#include "error.h"

#include <stdbool.h>
#include <stddef.h>

enum argument_kind {
    ARGUMENT_FLAG,   /* bool */
    ARGUMENT_TEXT,   /* const char *, into argv */
    ARGUMENT_WORD,   /* int, one of words */
    ARGUMENT_COUNT,  /* unsigned, low..high */
    ARGUMENT_NUMBER, /* float, above low and finite */
};

struct argument_word {
    const char *word;
    int value;
};

struct argument {
    const char *name;  /* without dashes */
    const char *value; /* as --help shows it; NULL for flags */
    const char *help;
    enum argument_kind kind;
    size_t offset; /* of the member of the target struct */
    double low, high;
    const struct argument_word *words; /* ends with a NULL word */
};

struct argument_list {
    const struct argument *rows;
    size_t count;
};

/* argv[0] is skipped. One word that is no option becomes *positional, NULL if there is none.
 * Errors: EXIT_USAGE. */
bool arguments_parse(const struct argument_list *list, int argc, char **argv, void *target,
                     const char **positional, struct tool_error *err);
/* The usage, and a line for each option, to standard output. */
void arguments_print_help(const struct argument_list *list, const char *usage);

#endif
