/* SPDX-License-Identifier: MIT
 *
 * What is odd about a frame only beside those before it: depth of another kind, or in another
 * unit. Each is right by itself, and AO of both is not the same. */
#include "gbuffer_internal.h"

#include <math.h>

/* Things that come near or leave change one end of the distances or the other; all of them are
 * other ones after a cut, or in another unit. Millimetres are 10 times as many as centimetres. */
static double change_of_unit(const double before[3], const double now[3])
{
    static const double least = 8.0;
    double smallest = INFINITY, largest = 0;
    for (int i = 0; i < 3; i++) {
        smallest = fmin(smallest, now[i] / before[i]);
        largest = fmax(largest, now[i] / before[i]);
    }
    return smallest > least || largest < 1.0 / least ? now[1] / before[1] : 1.0;
}

static void tell_type(const struct gbuffer *g, const struct frame_memory *memory, const char *path,
                      struct report *report)
{
    report_warn_of_frame(report, "depth of a frame",
                         "%s: depth '%s' is taken as %s, and as %s in the frames before: is one of "
                         "them of another kind? (--depth-type says it for all)",
                         path, g->roles.kind[ROLE_DEPTH].label, depth_type_name(g->depth_type),
                         depth_type_name(memory->usual_type));
}

static void tell_unit(const struct gbuffer *g, double times, const char *path,
                      struct report *report)
{
    report_warn_of_frame(report, "unit of a frame",
                         "%s: all distances in depth '%s' are about %.3g times those of the frames "
                         "before: in another unit? One radius is not the same in both; write all "
                         "frames in one",
                         path, g->roles.kind[ROLE_DEPTH].label, times);
}

void gbuffer_warn_of_frame(const struct gbuffer *g, struct frame_memory *memory, const char *path,
                           struct report *report)
{
    const double z[3] = {g->min_z, g->median_z, g->max_z};
    if (!memory || !(g->median_z > 0))
        return;
    if (g->background.reason != BACKGROUND_NONE && g->background.reason != BACKGROUND_DOUBT)
        memory->background = g->background.value;
    if (!memory->has_depth) {
        memory->has_depth = true;
        memory->usual_type = g->depth_type;
        memcpy(memory->usual_z, z, sizeof z);
        return;
    }
    const bool is_odd_type = g->depth_type != memory->usual_type;
    const double times = change_of_unit(memory->usual_z, z);
    const bool is_odd_unit = fabs(times - 1.0) > 0;
    if (is_odd_type && !memory->is_odd_type)
        tell_type(g, memory, path, report);
    if (is_odd_unit && !memory->is_odd_unit)
        tell_unit(g, times, path, report);
    memory->is_odd_type = is_odd_type;
    memory->is_odd_unit = is_odd_unit;
    if (!is_odd_unit)
        memcpy(memory->usual_z, z, sizeof z);
}
