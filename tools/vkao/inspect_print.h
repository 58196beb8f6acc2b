/* SPDX-License-Identifier: MIT
 *
 * What inspect found of a file, which it keeps as JSON, as people or programs read it. */
#ifndef VKAO_TOOLS_INSPECT_PRINT_H_
#define VKAO_TOOLS_INSPECT_PRINT_H_

#include "error.h"

#include <cjson/cJSON.h>

#include <stdbool.h>

/* To standard output, as JSON or as text, for which the strings of root become printable. False if
 * memory ran out. */
bool inspect_print(cJSON *root, bool json, struct tool_error *err);

#endif
