/* SPDX-License-Identifier: MIT
 *
 * How much scratch memory frames take, in the words of vkao_frame_scratch. */
#ifndef VKAO_BENCH_MEMORY_H_
#define VKAO_BENCH_MEMORY_H_

#include "error.h"
#include "text.h"
#include "vkao.h"

#include <stdbool.h>
#include <stddef.h>

/* device: as of --device. Errors: EXIT_DEVICE, EXIT_MEMORY. */
bool memory_report(const char *device, const VkExtent2D *sizes, size_t count, bool markdown,
                   struct text *text, struct tool_error *err);

#endif
