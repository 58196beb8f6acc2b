/* SPDX-License-Identifier: MIT */
#define _XOPEN_SOURCE 700 /* nftw */
#include "start.h"

#include "clock.h"
#include "engine.h"
#include "json.h"
#include "runs.h"

#include <errno.h>
#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* What the child sends through a pipe. */
struct message {
    struct start_times times;
    struct tool_error err;
    char device[256];
};

/* Frames with their recording and waiting, but without images, which an engine has anyway. */
static bool run_frames(struct engine *e, const struct config *config, const struct room *room,
                       struct start_times *times, struct tool_error *err)
{
    struct engine_images images;
    double ms[STAGES], start;
    if (!engine_images_create(e, room, &images, err))
        return false;
    start = now_ms();
    bool ok = engine_run(e, &images, config, ROOM_RADIUS, ms, err);
    times->first = now_ms() - start;
    start = now_ms();
    ok = ok && engine_run(e, &images, config, ROOM_RADIUS, ms, err);
    times->second = now_ms() - start;
    engine_images_destroy(e, &images);
    return ok;
}

static void run_child(const char *device, const struct config *config, VkExtent2D extent,
                      struct message *m)
{
    const struct engine_features none = {0};
    struct engine e;
    struct room room = {0};
    const double start = now_ms();
    bool ok = engine_create(device, none, &e, &m->err);
    m->times.device = now_ms() - start;
    if (ok && engine_compile(&e, config, 1, &m->err) && engine_check_size(&e, extent, &m->err) &&
        room_create(extent.width, extent.height, 0, &room, &m->err)) {
        snprintf(m->device, sizeof m->device, "%s", e.gpu.properties.deviceName);
        m->times.context = e.compile_ms;
        run_frames(&e, config, &room, &m->times, &m->err);
    }
    engine_destroy(&e);
    room_free(&room);
}

static bool receive(int fd, pid_t child, struct message *m, struct tool_error *err)
{
    size_t got = 0;
    ssize_t n = 1;
    int status;
    while (got < sizeof *m && (n > 0 || errno == EINTR)) {
        n = read(fd, (char *)m + got, sizeof *m - got);
        got += n > 0 ? (size_t)n : 0;
        if (n == 0)
            break;
    }
    while (waitpid(child, &status, 0) < 0 && errno == EINTR)
        ;
    if (got < sizeof *m)
        return fail(err, EXIT_DEVICE, "a process for --start ended early");
    if (m->err.code == EXIT_OK)
        return true;
    *err = m->err;
    return false;
}

/* In a process of its own; cache: its directory of compiled shaders. */
static bool run_apart(const char *cache, const char *device, const struct config *config,
                      VkExtent2D extent, struct message *m, struct tool_error *err)
{
    int ends[2];
    *m = (struct message){0};
    fflush(stdout);
    if (pipe(ends) != 0)
        return fail(err, EXIT_DEVICE, "pipe: %s", strerror(errno));
    pid_t child = fork();
    if (child == 0) {
        setenv("MESA_SHADER_CACHE_DIR", cache, 1);
        setenv("__GL_SHADER_DISK_CACHE_PATH", cache, 1); /* NVIDIA's */
        run_child(device, config, extent, m);
        ssize_t sent = write(ends[1], m, sizeof *m); /* less than a pipe holds: all or nothing */
        _exit(sent == (ssize_t)sizeof *m ? 0 : 1);
    }
    close(ends[1]);
    bool ok = child > 0 ? receive(ends[0], child, m, err)
                        : fail(err, EXIT_MEMORY, "fork: %s", strerror(errno));
    close(ends[0]);
    return ok;
}

static int remove_entry(const char *path, const struct stat *status, int type, struct FTW *where)
{
    (void)status;
    (void)type;
    (void)where;
    return remove(path);
}

enum { TIMES = 4 }; /* members of start_times */

static struct start_times median_of(float values[TIMES][MAX_RUNS], unsigned runs)
{
    return (struct start_times){.device = runs_median(values[0], runs),
                                .context = runs_median(values[1], runs),
                                .first = runs_median(values[2], runs),
                                .second = runs_median(values[3], runs)};
}

static void keep(float values[TIMES][MAX_RUNS], unsigned run, const struct start_times *times)
{
    values[0][run] = (float)times->device;
    values[1][run] = (float)times->context;
    values[2][run] = (float)times->first;
    values[3][run] = (float)times->second;
}

/* One cold and one warm start. */
static bool run_pair(const char *device, const struct config *config, VkExtent2D extent,
                     struct message *cold, struct message *warm, struct tool_error *err)
{
    const char *base = getenv("TMPDIR");
    struct text cache = {0};
    text_add(&cache, "%s/vkao-bench-XXXXXX", base && *base ? base : "/tmp");
    if (cache.out_of_memory || !mkdtemp(cache.data)) {
        fail(err, EXIT_OUTPUT, "%s: cannot create: %s", cache.data ? cache.data : "cache",
             strerror(errno));
        text_free(&cache);
        return false;
    }
    bool ok = run_apart(cache.data, device, config, extent, cold, err) &&
              run_apart(cache.data, device, config, extent, warm, err);
    nftw(cache.data, remove_entry, 16, FTW_DEPTH | FTW_PHYS);
    text_free(&cache);
    return ok;
}

bool start_measure(const char *device, const struct config *config, VkExtent2D extent,
                   unsigned runs, char device_name[256], struct start *start,
                   struct tool_error *err)
{
    static float cold_ms[TIMES][MAX_RUNS], warm_ms[TIMES][MAX_RUNS];
    for (unsigned run = 0; run < runs; run++) {
        struct message cold, warm;
        if (!run_pair(device, config, extent, &cold, &warm, err))
            return false;
        keep(cold_ms, run, &cold.times);
        keep(warm_ms, run, &warm.times);
        snprintf(device_name, 256, "%s", cold.device);
    }
    start->config = config;
    start->cold = median_of(cold_ms, runs);
    start->warm = median_of(warm_ms, runs);
    return true;
}

/* --- Reports --- */

static void add_start(const struct start *start, bool is_warm, bool markdown, struct text *text)
{
    const struct start_times *t = is_warm ? &start->warm : &start->cold;
    text_add(text,
             markdown ? "| %s | %s | %.1f | %.1f | %.1f | %.1f | %.1f |\n"
                      : "%-18s%-6s%11.1f%12.1f%14.1f%14.1f%12.1f\n",
             start->config->name, is_warm ? "warm" : "cold", t->device, t->context, t->first,
             t->second, t->context + t->first - t->second);
}

void start_report(const struct start *starts, size_t count, const char *device, VkExtent2D extent,
                  unsigned runs, bool markdown, struct text *text)
{
    text_add(text,
             "%s, %u x %u, milliseconds, medians of %u processes; cold: with an empty shader "
             "cache%s\n",
             device, extent.width, extent.height, runs, markdown ? ":" : "");
    text_add(text, markdown
                       ? "\n| setting | cache | device | context | first frame | second frame | "
                         "overhead |\n|---|---|---:|---:|---:|---:|---:|\n"
                       : "\nsetting           cache      device     context   first frame  second "
                         "frame    overhead\n");
    for (size_t i = 0; i < count; i++)
        for (int warm = 0; warm < 2; warm++)
            add_start(&starts[i], warm, markdown, text);
}

cJSON *start_json(const struct start *starts, size_t count, unsigned runs)
{
    cJSON *list = cJSON_CreateArray();
    for (size_t i = 0; i < 2 * count; i++) {
        const struct start *start = &starts[i / 2];
        const struct start_times *t = i % 2 ? &start->warm : &start->cold;
        char name[64];
        cJSON *object = cJSON_CreateObject();
        cJSON_AddItemToArray(list, object);
        snprintf(name, sizeof name, "%s start-%s", start->config->name, i % 2 ? "warm" : "cold");
        cJSON_AddStringToObject(object, "config", name);
        cJSON_AddStringToObject(object, "stage", stage_name(STAGE_TOTAL));
        json_add_number(object, "median_ms", t->context + t->first);
        cJSON_AddNumberToObject(object, "runs", runs);
        json_add_number(object, "device_ms", t->device);
        json_add_number(object, "context_ms", t->context);
        json_add_number(object, "first_ms", t->first);
        json_add_number(object, "second_ms", t->second);
    }
    return list;
}
