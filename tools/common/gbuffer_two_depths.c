/* SPDX-License-Identifier: MIT
 *
 * Two depths in one file. Z and depth.Z are mostly one thing under two names. Where they are two,
 * only the user knows which is meant, unless one is in no unit. */
#include "gbuffer_internal.h"

#include <math.h>
#include <stdlib.h>

/* Halves end at 65504. Of what the other lacks nothing is known. */
static bool is_same_depth(float depth, float other, bool is_half)
{
    static const float most_half = 65504.0f, tolerance = 0.01f;
    const float a = fabsf(depth), b = fabsf(other);
    const float x = is_half ? fminf(a, most_half) : a, y = is_half ? fminf(b, most_half) : b;
    const bool is_nothing = !gbuffer_is_measurable((double)a) && !gbuffer_is_measurable((double)b);
    return isnan(other) || is_nothing || fabsf(x - y) <= tolerance * fmaxf(x, y);
}

static bool lies_within_one(const float *depth, size_t texels)
{
    bool is_within = true;
    for (size_t i = 0; is_within && i < texels; i++)
        is_within = isnan(depth[i]) || (depth[i] >= 0 && depth[i] <= 1);
    return is_within;
}

/* Most of what is there is farther than 1. */
static bool lies_beyond_one(const float *depth, size_t texels)
{
    size_t beyond = 0, count = 0;
    for (size_t i = 0; i < texels; i++) {
        const double d = fabs((double)depth[i]);
        count += gbuffer_is_measurable(d);
        beyond += gbuffer_is_measurable(d) && d > 1;
    }
    return beyond * 2 > count;
}

/* A range of 0 to 1, or what fog makes of it, is no distance where another depth is. Who tells a
 * type or a range means the one that is so. */
static bool is_better(const struct gbuffer *g, const struct gbuffer_options *options,
                      const struct role *other, const float *values)
{
    const struct exr_part *part = &other->info->parts[other->part];
    return options->depth_type == DEPTH_AUTO && !options->depth_range.is_given &&
           gbuffer_same_box(&part->data_window, &g->data_window) &&
           lies_within_one(g->depth, gbuffer_texels(g)) &&
           lies_beyond_one(values, gbuffer_texels(g));
}

/* The other is not needed: if it cannot be read, nothing is said. */
void gbuffer_compare_depths(struct gbuffer *g, const struct gbuffer_options *options,
                            struct report *report)
{
    struct role *depth = &g->roles.kind[ROLE_DEPTH], other;
    struct tool_error unread = {0};
    size_t different = 0;
    if (!roles_other_depth(&options->roles, &g->roles, &other))
        return;
    const struct exr_channel *a = depth->channels[0], *b = other.channels[0];
    if (b->x_sampling != 1 || b->y_sampling != 1)
        return;
    const bool is_half = a->type == EXR_HALF || b->type == EXR_HALF;
    float *values = gbuffer_read_role(g, &other, 1, NAN, &unread);
    for (size_t i = 0; values && i < gbuffer_texels(g); i++)
        different += !is_same_depth(g->depth[i], values[i], is_half);
    if (different * 100 > gbuffer_texels(g)) {
        const bool is_other = is_better(g, options, &other, values);
        if (is_other) {
            const struct role first = *depth;
            float *const first_values = g->depth;
            *depth = other;
            g->depth = values;
            other = first;
            values = first_values;
        }
        report_warn(
            report, "two depths",
            "%s: depth '%s' and '%s' differ: '%s' is taken%s (--depth '%s' takes the other, "
            "--depth '%s' says that it is right)",
            depth->info->path, depth->label, other.label, depth->label,
            is_other ? ", since the other is from 0 to 1" : "", other.label, depth->label);
    }
    free(values);
}
