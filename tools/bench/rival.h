/* SPDX-License-Identifier: MIT
 *
 * Another program beside the library: run in turn with it, so that what disturbs the machine
 * disturbs both, and compared run by run. */
#ifndef VKAO_BENCH_RIVAL_H_
#define VKAO_BENCH_RIVAL_H_

#include "error.h"
#include "runs.h"

#include <stdbool.h>
#include <stddef.h>

enum { MAX_RIVALS = 64, RIVAL_NAME = 48 };

/* A figure that the program printed; the first is the time of the whole process. */
struct rival {
    char name[RIVAL_NAME];
    float ms[MAX_RUNS]; /* by run; NAN where it was not printed */
    double median;
};

struct rivals {
    const char *command; /* for the shell; NULL = none */
    struct rival *list;
    size_t count;
};

/* Runs the command and takes what it prints: lines 'NAME med X ms', or the list that --json of
 * `vkao-bench speed` writes, whose names are 'SETTING STAGE'. Errors: EXIT_INPUT, EXIT_MEMORY. */
bool rivals_run(struct rivals *rivals, unsigned run, struct tool_error *err);
/* NULL if there is none of that name. */
const struct rival *rivals_find(const struct rivals *rivals, const char *name);
void rivals_free(struct rivals *rivals);

#endif
