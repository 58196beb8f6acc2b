/* SPDX-License-Identifier: MIT */
#include "reference.h"

#include "json_text.h"
#include "read_file.h"

#include <math.h>
#include <stdlib.h>

static bool check(const cJSON *reference, const char *path, struct tool_error *err)
{
    const cJSON *item;
    if (!cJSON_IsObject(reference))
        return fail(err, EXIT_INPUT, "%s: want {\"scene\": RMSE, ...}", path);
    cJSON_ArrayForEach(item, reference)
    {
        if (!cJSON_IsNumber(item) || !(item->valuedouble > 0) || !isfinite(item->valuedouble))
            return fail(err, EXIT_INPUT, "%s: '%s' must be a number > 0", path, item->string);
    }
    return true;
}

cJSON *reference_read(const char *path, struct tool_error *err)
{
    enum { MOST_BYTES = 1 << 20 };
    const unsigned begun = json_begin();
    char *json = read_file(path, MOST_BYTES, err);
    if (!json)
        return NULL;
    cJSON *reference = cJSON_ParseWithOpts(json, NULL, true);
    free(json);
    if (!reference && json_is_whole(begun))
        fail(err, EXIT_INPUT, "%s: not JSON", path);
    else if (!reference)
        fail(err, EXIT_MEMORY, "%s: out of memory", path);
    if (reference && check(reference, path, err))
        return reference;
    cJSON_Delete(reference);
    return NULL;
}

double reference_rmse(const cJSON *reference, const char *scene)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(reference, scene);
    return item ? item->valuedouble : NAN;
}
