/* SPDX-License-Identifier: MIT
 *
 * Checks of a G-buffer as prepared. None changes it, so that none waits for another: one core would
 * take longer for those of a large frame than many cores for its AO. What they have to say waits
 * until all are done, so that it is always said in one order. */
#include "gbuffer_internal.h"
#include "parallel.h"

struct paths {
    const char *depth, *normals;
};

/* False if memory ran out. */
typedef bool check_fn(const struct gbuffer *g, const struct paths *paths, struct report *report);

static bool check_view(const struct gbuffer *g, const struct paths *paths, struct report *report)
{
    return gbuffer_warn_of_view(g, paths->depth, report);
}

static bool check_move(const struct gbuffer *g, const struct paths *paths, struct report *report)
{
    return gbuffer_warn_of_move(g, paths->depth, report);
}

static bool check_limits(const struct gbuffer *g, const struct paths *paths, struct report *report)
{
    return gbuffer_warn_of_limits(g, paths->depth, report);
}

static bool check_holes(const struct gbuffer *g, const struct paths *paths, struct report *report)
{
    gbuffer_warn_of_holes(g, paths->depth, report);
    return true;
}

static bool check_opacity(const struct gbuffer *g, const struct paths *paths, struct report *report)
{
    gbuffer_warn_of_opacity(g, paths->normals, report);
    return true;
}

static bool check_borders(const struct gbuffer *g, const struct paths *paths, struct report *report)
{
    gbuffer_warn_of_borders(g, paths->depth, report);
    return true;
}

static bool check_breaks(const struct gbuffer *g, const struct paths *paths, struct report *report)
{
    gbuffer_warn_of_breaks(g, paths->depth, report);
    return true;
}

static bool check_strangers(const struct gbuffer *g, const struct paths *paths,
                            struct report *report)
{
    return gbuffer_warn_of_strangers(g, paths->depth, report);
}

/* In the order of what they say. */
static const struct check {
    check_fn *run;
    bool is_of_same_places; /* has nothing to say where normals are moved against depth */
} checks[] = {
    {check_view, false},    {check_move, false},   {check_limits, false}, {check_holes, false},
    {check_opacity, false}, {check_borders, true}, {check_breaks, true},  {check_strangers, true},
};
enum { CHECKS = sizeof checks / sizeof *checks };

struct run {
    const struct gbuffer *g;
    struct paths paths;
    struct report_queue queues[CHECKS];
};

static void run_check(void *data, uint32_t i)
{
    struct run *run = data;
    struct report report = {.queue = &run->queues[i]};
    if (!checks[i].run(run->g, &run->paths, &report))
        run->queues[i].out_of_memory = true;
}

bool gbuffer_run_checks(const struct gbuffer *g, const char *normals_path, struct report *report,
                        struct tool_error *err)
{
    struct run run = {g, {g->roles.kind[ROLE_DEPTH].info->path, normals_path}, {{0}}};
    bool is_moved = false, ok = true;
    parallel_run(NULL, CHECKS, run_check, &run);
    for (int i = 0; i < CHECKS; i++) {
        struct report_queue *queue = &run.queues[i];
        ok &= !queue->out_of_memory;
        is_moved |= checks[i].run == check_move && queue->count > 0;
        if (ok && !(is_moved && checks[i].is_of_same_places))
            report_warn_of_queue(report, queue);
        report_free_queue(queue);
    }
    return ok || fail(err, EXIT_MEMORY, "%s: out of memory", run.paths.depth);
}
