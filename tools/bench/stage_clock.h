/* SPDX-License-Identifier: MIT
 *
 * Times the stages of a recording from outside of the library: it labels them for debuggers, and a
 * context that was made with stage_clock_hook() calls this clock's label functions instead, which
 * write timestamps where a label begins or ends. A time belongs to the innermost label that the
 * clock knows. One clock runs at a time. */
#ifndef VKAO_BENCH_STAGE_CLOCK_H_
#define VKAO_BENCH_STAGE_CLOCK_H_

#include "error.h"
#include "gpu.h"

#include <stdbool.h>

enum stage {
    STAGE_PREPARE,
    STAGE_SSAO,
    STAGE_BLUR,
    STAGE_UPSAMPLE,
    STAGE_COMPOSITE,
    STAGE_TOTAL, /* from the first to the last: the others and what lies between them */
    STAGES
};

/* "prepare" ... "total" */
const char *stage_name(enum stage stage);

enum { STAGE_CLOCK_MARKS = 64, STAGE_CLOCK_DEPTH = 8 };

struct stage_clock {
    struct gpu *gpu;
    VkQueryPool pool;                     /* VK_NULL_HANDLE: the queue has no timestamps */
    VkCommandBuffer cmd;                  /* while it runs */
    int marks;                            /* written so far */
    enum stage after[STAGE_CLOCK_MARKS];  /* whose time begins at that mark */
    enum stage labels[STAGE_CLOCK_DEPTH]; /* that are open */
    int depth;
};

/* Makes the context of this info call the clock. The device needs no debug extension for it. */
void stage_clock_hook(vkao_context_info *info);

bool stage_clock_create(struct gpu *gpu, struct stage_clock *clock, struct tool_error *err);
void stage_clock_destroy(struct stage_clock *clock);

/* Around what is to be timed, in one command buffer; then read when it has run. */
void stage_clock_start(struct stage_clock *clock, VkCommandBuffer cmd);
void stage_clock_stop(struct stage_clock *clock);
/* Milliseconds; 0 for stages that did not run. wall_ms: the total, where the queue has no
 * timestamps. */
bool stage_clock_read(const struct stage_clock *clock, double wall_ms, double ms[STAGES],
                      struct tool_error *err);

#endif
