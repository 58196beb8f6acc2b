/* SPDX-License-Identifier: MIT */
#ifndef VKAO_TOOLS_PNG_FILE_H_
#define VKAO_TOOLS_PNG_FILE_H_

#include "error.h"

#include <stdbool.h>
#include <stdint.h>

/* Writes 8-bit rows, tightly packed: grey (1 channel) or RGB (3). The file appears whole or not at
 * all. Errors: EXIT_OUTPUT. */
bool png_file_write(const char *path, uint32_t width, uint32_t height, unsigned channels,
                    const uint8_t *pixels, bool replace, struct tool_error *err);

#endif
