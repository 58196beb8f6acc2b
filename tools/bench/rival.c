/* SPDX-License-Identifier: MIT */
#include "rival.h"

#include "clock.h"
#include "text.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

/* What the command prints, and how long it ran. */
static bool run_command(const char *command, struct text *output, double *ms,
                        struct tool_error *err)
{
    char buffer[4096];
    size_t length;
    double start = now_ms();
    FILE *pipe = popen(command, "r");
    if (!pipe)
        return fail(err, EXIT_INPUT, "--vs: '%s': %s", command, strerror(errno));
    while ((length = fread(buffer, 1, sizeof buffer, pipe)) > 0)
        text_add(output, "%.*s", (int)length, buffer);
    int status = pclose(pipe);
    *ms = now_ms() - start;
    if (status < 0)
        return fail(err, EXIT_INPUT, "--vs: '%s': %s", command, strerror(errno));
    if (WIFSIGNALED(status))
        return fail(err, EXIT_INPUT, "--vs: '%s' ended by signal %d", command, WTERMSIG(status));
    if (WEXITSTATUS(status) != 0)
        return fail(err, EXIT_INPUT, "--vs: '%s' ended with exit code %d", command,
                    WEXITSTATUS(status));
    return !output->out_of_memory || fail(err, EXIT_MEMORY, "--vs: out of memory");
}

const struct rival *rivals_find(const struct rivals *rivals, const char *name)
{
    for (size_t i = 0; i < rivals->count; i++)
        if (strcmp(rivals->list[i].name, name) == 0)
            return &rivals->list[i];
    return NULL;
}

/* The one of that name, which may be new. Names beyond MAX_RIVALS are left out, as no table could
 * show them: then NULL. */
static struct rival *rival_named(struct rivals *rivals, const char *name)
{
    const struct rival *known = rivals_find(rivals, name);
    if (known)
        return &rivals->list[known - rivals->list];
    if (rivals->count == MAX_RIVALS)
        return NULL;
    struct rival *rival = &rivals->list[rivals->count++];
    snprintf(rival->name, sizeof rival->name, "%s", name);
    for (unsigned r = 0; r < MAX_RUNS; r++)
        rival->ms[r] = NAN;
    return rival;
}

static void take(struct rivals *rivals, const char *name, unsigned run, double ms)
{
    struct rival *rival = rival_named(rivals, name);
    if (!rival)
        return;
    rival->ms[run] = (float)ms;
    rival->median = runs_median(rival->ms, run + 1);
}

static void take_line(struct rivals *rivals, const char *line, unsigned run)
{
    char name[RIVAL_NAME];
    double ms;
    if (sscanf(line, "%47s med %lf ms", name, &ms) == 2 && isfinite(ms))
        take(rivals, name, run, ms);
}

static void take_json(struct rivals *rivals, const cJSON *list, unsigned run)
{
    const cJSON *row;
    cJSON_ArrayForEach(row, list)
    {
        const cJSON *config = cJSON_GetObjectItemCaseSensitive(row, "config");
        const cJSON *stage = cJSON_GetObjectItemCaseSensitive(row, "stage");
        const cJSON *ms = cJSON_GetObjectItemCaseSensitive(row, "median_ms");
        char name[RIVAL_NAME];
        if (!cJSON_IsString(config) || !cJSON_IsString(stage) || !cJSON_IsNumber(ms))
            continue;
        snprintf(name, sizeof name, "%s %s", config->valuestring, stage->valuestring);
        take(rivals, name, run, ms->valuedouble);
    }
}

static void take_output(struct rivals *rivals, char *output, unsigned run)
{
    cJSON *json = cJSON_Parse(output);
    if (cJSON_IsArray(json)) {
        take_json(rivals, json, run);
    } else {
        char *rest = output;
        for (char *line = strtok_r(rest, "\n", &rest); line; line = strtok_r(NULL, "\n", &rest))
            take_line(rivals, line, run);
    }
    cJSON_Delete(json);
}

bool rivals_run(struct rivals *rivals, unsigned run, struct tool_error *err)
{
    struct text output = {0};
    double ms;
    if (!rivals->list)
        rivals->list = calloc(MAX_RIVALS, sizeof *rivals->list);
    if (!rivals->list)
        return fail(err, EXIT_MEMORY, "out of memory");
    bool ok = run_command(rivals->command, &output, &ms, err);
    if (ok) {
        take(rivals, "process", run, ms);
        if (output.data)
            take_output(rivals, output.data, run);
    }
    text_free(&output);
    return ok;
}

void rivals_free(struct rivals *rivals)
{
    free(rivals->list);
    *rivals = (struct rivals){0};
}
