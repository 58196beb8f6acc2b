/* SPDX-License-Identifier: MIT
 *
 * Another program beside the library: run in turn with it, so that what disturbs the machine
 * disturbs both, and compared run by run. */
#include "speed.h"

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
    double start = speed_now_ms();
    FILE *pipe = popen(command, "r");
    if (!pipe)
        return fail(err, EXIT_INPUT, "--vs: '%s': %s", command, strerror(errno));
    while ((length = fread(buffer, 1, sizeof buffer, pipe)) > 0)
        text_add(output, "%.*s", (int)length, buffer);
    int status = pclose(pipe);
    *ms = speed_now_ms() - start;
    if (status < 0)
        return fail(err, EXIT_INPUT, "--vs: '%s': %s", command, strerror(errno));
    if (WIFSIGNALED(status))
        return fail(err, EXIT_INPUT, "--vs: '%s' ended by signal %d", command, WTERMSIG(status));
    if (WEXITSTATUS(status) != 0)
        return fail(err, EXIT_INPUT, "--vs: '%s' ended with exit code %d", command,
                    WEXITSTATUS(status));
    return !output->out_of_memory || fail(err, EXIT_MEMORY, "--vs: out of memory");
}

/* Names beyond MAX_RIVALS are left out: no table could show them. */
static void take(struct speed_vs *vs, const char *name, unsigned run, double ms)
{
    size_t i = 0;
    while (i < vs->count && strcmp(vs->rivals[i].name, name) != 0)
        i++;
    if (i == MAX_RIVALS)
        return;
    struct rival *rival = &vs->rivals[i];
    if (i == vs->count) {
        vs->count++;
        snprintf(rival->name, sizeof rival->name, "%s", name);
        for (unsigned r = 0; r < MAX_RUNS; r++)
            rival->ms[r] = NAN;
    }
    rival->ms[run] = (float)ms;
    rival->median = speed_median(rival->ms, run + 1);
}

static void take_line(struct speed_vs *vs, const char *line, unsigned run)
{
    char name[SPEED_NAME];
    double ms;
    if (sscanf(line, "%47s med %lf ms", name, &ms) == 2 && isfinite(ms))
        take(vs, name, run, ms);
}

static void take_json(struct speed_vs *vs, const cJSON *list, unsigned run)
{
    const cJSON *row;
    cJSON_ArrayForEach(row, list)
    {
        const cJSON *config = cJSON_GetObjectItemCaseSensitive(row, "config");
        const cJSON *stage = cJSON_GetObjectItemCaseSensitive(row, "stage");
        const cJSON *ms = cJSON_GetObjectItemCaseSensitive(row, "median_ms");
        char name[SPEED_NAME];
        if (!cJSON_IsString(config) || !cJSON_IsString(stage) || !cJSON_IsNumber(ms))
            continue;
        snprintf(name, sizeof name, "%s %s", config->valuestring, stage->valuestring);
        take(vs, name, run, ms->valuedouble);
    }
}

static void take_output(struct speed_vs *vs, char *output, unsigned run)
{
    cJSON *json = cJSON_Parse(output);
    if (cJSON_IsArray(json)) {
        take_json(vs, json, run);
    } else {
        char *rest = output;
        for (char *line = strtok_r(rest, "\n", &rest); line; line = strtok_r(NULL, "\n", &rest))
            take_line(vs, line, run);
    }
    cJSON_Delete(json);
}

bool speed_vs_run(struct speed_vs *vs, unsigned run, struct tool_error *err)
{
    struct text output = {0};
    double ms;
    if (!vs->rivals)
        vs->rivals = calloc(MAX_RIVALS, sizeof *vs->rivals);
    if (!vs->rivals)
        return fail(err, EXIT_MEMORY, "out of memory");
    bool ok = run_command(vs->command, &output, &ms, err);
    if (ok) {
        take(vs, "process", run, ms);
        if (output.data)
            take_output(vs, output.data, run);
    }
    text_free(&output);
    return ok;
}

double speed_vs_ratio(const struct speed_row *row, enum stage stage, const struct rival *rival,
                      unsigned runs)
{
    float ratios[MAX_RUNS];
    for (unsigned r = 0; r < runs; r++)
        ratios[r] = rival->ms[r] > 0 ? row->ms[stage][r] / rival->ms[r] : NAN;
    return speed_median(ratios, runs);
}

const struct rival *speed_vs_namesake(const struct speed_vs *vs, const struct speed_row *row,
                                      enum stage stage)
{
    char name[SPEED_NAME + 16];
    snprintf(name, sizeof name, "%s %s", row->name, stage_name(stage));
    for (size_t i = 0; i < vs->count; i++)
        if (strcmp(vs->rivals[i].name, name) == 0)
            return &vs->rivals[i];
    return NULL;
}

void speed_vs_free(struct speed_vs *vs)
{
    free(vs->rivals);
    *vs = (struct speed_vs){0};
}
