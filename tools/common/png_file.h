/* SPDX-License-Identifier: MIT */
#ifndef VKAO_TOOLS_PNG_FILE_H_
#define VKAO_TOOLS_PNG_FILE_H_

#include "atomic_file.h"
#include "error.h"

#include <stdbool.h>
#include <stdint.h>

/* 0..1 as a byte; what is no number is 0. */
uint8_t byte_of(double value);
/* Linear light as sRGB has it, both 0..1 (IEC 61966-2-1). */
double srgb_of(double linear);

/* Writes 8-bit rows, tightly packed: grey (1 channel) or RGB (3), to a new file that its caller
 * commits or aborts. Errors: EXIT_OUTPUT, EXIT_MEMORY; there is nothing to abort then. */
bool png_file_prepare(struct atomic_file *file, const char *path, uint32_t width, uint32_t height,
                      unsigned channels, const uint8_t *pixels, bool replace,
                      struct tool_error *err);
/* Both at once: the file appears whole or not at all. */
bool png_file_write(const char *path, uint32_t width, uint32_t height, unsigned channels,
                    const uint8_t *pixels, bool replace, struct tool_error *err);

#endif
