/* SPDX-License-Identifier: MIT
 *
 * The errors of another program: {"scene": RMSE, ...}. */
#ifndef VKAO_BENCH_REFERENCE_H_
#define VKAO_BENCH_REFERENCE_H_

#include "error.h"

#include <cjson/cJSON.h>

/* For cJSON_Delete; NULL on errors: EXIT_INPUT naming the file and what is no number > 0,
 * EXIT_MEMORY. */
cJSON *reference_read(const char *path, struct tool_error *err);
/* NAN if it does not name the scene. */
double reference_rmse(const cJSON *reference, const char *scene);

#endif
