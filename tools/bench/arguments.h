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
    const char *command, *usage; /* usage: what --help prints before the options */
    const struct argument *rows; /* but for --help itself */
    size_t count;
};

/* How a command begins. argv[0] is skipped. folder: the one word that is no option; NULL if there
 * is to be none. False if nothing is left to do: --help was printed, and err->code is EXIT_OK, or
 * something is wrong, which is EXIT_USAGE. */
bool arguments_take(const struct argument_list *list, int argc, char **argv, void *target,
                    const char **folder, struct tool_error *err);
/* How it ends: its exit code. What went wrong, if it is not ok, is reported. */
int arguments_end(const struct argument_list *list, bool ok, struct tool_error *err);

#endif
