/* SPDX-License-Identifier: MIT
 *
 * The value of --size: "1080p,64x36". */
#ifndef VKAO_BENCH_SIZES_H_
#define VKAO_BENCH_SIZES_H_

#include "error.h"

#include <stdbool.h>
#include <stddef.h>
#include <vulkan/vulkan_core.h>

enum { MAX_SIZES = 16 };

struct size_list {
    VkExtent2D sizes[MAX_SIZES];
    size_t count;
};

/* names: comma-separated WxH, 1 to 65535 each, 720p, 1080p, 2160p or 8k. Errors: EXIT_USAGE. */
bool sizes_choose(const char *names, struct size_list *list, struct tool_error *err);

#endif
