/* SPDX-License-Identifier: MIT
 *
 * The first frame of a process. Drivers compile shaders when a pipeline is made or first used, and
 * keep the result on disk; so every figure comes from a process of its own, whose cache is a fresh
 * directory (cold) or the same one again (warm). */
#ifndef VKAO_BENCH_START_H_
#define VKAO_BENCH_START_H_

#include "configs.h"
#include "error.h"
#include "text.h"
#include "vkao.h"

#include <cjson/cJSON.h>
#include <stdbool.h>
#include <stddef.h>

struct start {
    const struct config *config;
    struct start_times {
        /* milliseconds: instance and device, context and effect, two frames */
        double device, context, first, second;
    } cold, warm;
};

/* device: as of --device. Nothing in this process may have used Vulkan before. */
bool start_measure(const char *device, const struct config *config, VkExtent2D extent,
                   unsigned runs, char device_name[256], struct start *start,
                   struct tool_error *err);

/* device: its name, as the report shows it. */
void start_report(const struct start *starts, size_t count, const char *device, VkExtent2D extent,
                  unsigned runs, bool markdown, struct text *text);
/* For json_write, which deletes it. */
cJSON *start_json(const struct start *starts, size_t count, unsigned runs);

#endif
