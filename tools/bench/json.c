/* SPDX-License-Identifier: MIT */
#include "json.h"

#include "atomic_file.h"
#include "json_text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void json_add_number(cJSON *object, const char *name, double value)
{
    char digits[32];
    snprintf(digits, sizeof digits, "%.6g", value);
    cJSON_AddRawToObject(object, name, isfinite(value) ? digits : "null");
}

static bool write_file(const char *path, const char *content, struct tool_error *err)
{
    struct atomic_file file = {0};
    if (!atomic_file_open(&file, path, true, err))
        return false;
    if (atomic_file_write(&file, content, strlen(content), err) &&
        atomic_file_write(&file, "\n", 1, err))
        return atomic_file_commit(&file, err);
    atomic_file_abort(&file);
    return false;
}

bool json_write(const char *path, cJSON *root, unsigned begun, struct tool_error *err)
{
    char *json = json_text(root, true, begun);
    bool ok = true;
    cJSON_Delete(root);
    if (!json)
        return fail(err, EXIT_MEMORY, "%s: out of memory", path);
    if (strcmp(path, "-") == 0)
        puts(json); /* whether it arrived shows when main flushes */
    else
        ok = write_file(path, json, err);
    free(json);
    return ok;
}
