/* SPDX-License-Identifier: MIT */
#ifndef VKAO_BENCH_JSON_H_
#define VKAO_BENCH_JSON_H_

#include "error.h"
#include "json_text.h"

#include <cjson/cJSON.h>
#include <stdbool.h>

/* Six digits; null if it is not finite. */
void json_add_number(cJSON *object, const char *name, double value);

/* Prints root and deletes it. begun: what json_begin returned before root was made. path: "-" =
 * standard output; else the file appears whole or not at all. Errors: EXIT_OUTPUT, EXIT_MEMORY. */
bool json_write(const char *path, cJSON *root, unsigned begun, struct tool_error *err);

#endif
