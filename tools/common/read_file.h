/* SPDX-License-Identifier: MIT
 *
 * Small files whole: settings that somebody wrote by hand. */
#ifndef VKAO_TOOLS_READ_FILE_H_
#define VKAO_TOOLS_READ_FILE_H_

#include "error.h"

#include <stddef.h>

/* malloc'ed and zero-terminated; NULL on errors, which name the path. Pipes, devices and sockets
 * are refused before anything waits for them, and so is what is larger than most bytes. Errors:
 * EXIT_INPUT, EXIT_MEMORY. */
char *read_file(const char *path, size_t most, struct tool_error *err);

#endif
