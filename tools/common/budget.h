/* SPDX-License-Identifier: MIT
 *
 * What one frame may cost, asked before anything is allocated for it: a file of a few bytes can ask
 * for as much as a film frame does. */
#ifndef VKAO_TOOLS_BUDGET_H_
#define VKAO_TOOLS_BUDGET_H_

#include "error.h"

#include <stdbool.h>
#include <stdint.h>

#define BUDGET_DEFAULT_PIXELS (UINT64_C(1) << 28)

/* Zero members stand for the defaults. */
struct budget {
    /* Bytes, of host and device together. Default: three quarters of the machine's, or
     * of what control groups and resource limits leave of them */
    uint64_t memory;
    uint64_t pixels; /* of one image. Default: BUDGET_DEFAULT_PIXELS, 16384 x 16384 */
};

/* Whether an image of the file at path fits. Errors: EXIT_INPUT, with --max-pixels as the
 * remedy. */
bool budget_allows_pixels(const struct budget *budget, const char *path, uint64_t width,
                          uint64_t height, struct tool_error *err);
/* Whether bytes do, for the image of that size and what is made of it. Errors: EXIT_MEMORY, with
 * --max-memory as the remedy. */
bool budget_allows_memory(const struct budget *budget, const char *path, uint64_t width,
                          uint64_t height, uint64_t bytes, struct tool_error *err);

/* "800M", "4G", "1.5g", "1073741824": K, M, G and T are powers of 1024. False if it is none, or
 * less than one byte. */
bool budget_parse_bytes(const char *text, uint64_t *bytes);

#endif
