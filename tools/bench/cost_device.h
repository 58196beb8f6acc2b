/* SPDX-License-Identifier: MIT
 *
 * An AMD GPU that is not there: Mesa's RADV compiles for one without having it. Pipelines are real,
 * whatever memory they would work on is not; what is recorded is counted. One at a time. */
#ifndef VKAO_BENCH_COST_DEVICE_H_
#define VKAO_BENCH_COST_DEVICE_H_

#include "gpu.h"

#include <stddef.h>
#include <stdint.h>

struct cost_pipeline {
    VkPipeline pipeline;
    char pass[32];                                         /* the library's name for it */
    unsigned instructions, registers, waves, shared_bytes; /* registers: vector; waves: a SIMD */
    unsigned group_size;
    char *assembly;
};

struct cost_dispatch {
    size_t pipeline; /* index */
    uint64_t groups; /* 0 = the device would decide */
};

enum { MAX_COST_PIPELINES = 64, MAX_COST_DISPATCHES = 64 };

/* What was compiled and recorded since cost_device_forget. */
struct cost_record {
    struct cost_pipeline pipelines[MAX_COST_PIPELINES];
    size_t pipeline_count;
    struct cost_dispatch dispatches[MAX_COST_DISPATCHES];
    size_t dispatch_count;
};

/* family: as RADV_FORCE_FAMILY, which is set to it: "navi21". Errors: EXIT_DEVICE where RADV is not
 * installed. */
bool cost_device_create(const char *family, struct gpu *gpu, struct tool_error *err);
void cost_device_destroy(struct gpu *gpu);
/* For a context on it. */
vkao_context_info cost_device_context_info(struct gpu *gpu);
const struct cost_record *cost_device_record(void);
void cost_device_forget(void);
/* What is nothing on this device, but not NULL. */
VkImageView cost_device_view(void);
VkCommandBuffer cost_device_command_buffer(void);

#endif
