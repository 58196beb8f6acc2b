/* SPDX-License-Identifier: MIT
 *
 * Times the stages of a recording: a context calls stage_clock_mark where a stage begins or ends,
 * and a timestamp is written there. */
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

enum { STAGE_CLOCK_MARKS = 64 };

struct stage_clock {
    struct gpu *gpu;
    VkQueryPool pool;                    /* VK_NULL_HANDLE: the queue has no timestamps */
    VkCommandBuffer cmd;                 /* while it runs */
    int marks;                           /* written so far */
    enum stage after[STAGE_CLOCK_MARKS]; /* whose time begins at that mark */
};

/* vkao_context_info.mark, with the clock as mark_user_data. */
void stage_clock_mark(void *user_data, VkCommandBuffer cmd, const char *name, VkBool32 begins);

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
