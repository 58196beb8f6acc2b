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

struct png_picture {
    uint32_t width, height;
    unsigned channels;     /* 1: grey, 3: RGB */
    const uint8_t *pixels; /* 8-bit rows, tightly packed */
    char *key;             /* up to 79 Latin letters, of the text; NULL: none */
    char *text;            /* UTF-8 */
};

/* Writes a new file that its caller commits or aborts. Errors: EXIT_OUTPUT, EXIT_MEMORY; there is
 * nothing to abort then. */
bool png_file_prepare(struct atomic_file *file, const char *path, const struct png_picture *picture,
                      bool replace, struct tool_error *err);
/* Both at once: the file appears whole or not at all. */
bool png_file_write(const char *path, const struct png_picture *picture, bool replace,
                    struct tool_error *err);
/* The text of a key that stands before the pixels, malloc'ed; NULL if there is none, or no PNG. */
char *png_file_read_text(const char *path, const char *key);

#endif
