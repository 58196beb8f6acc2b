/* SPDX-License-Identifier: MIT
 *
 * What is known beside the depth: how thick things are, where they end, what lies next behind them.
 * Nothing in the file tells whether a channel that somebody names is of that kind, but what lies
 * behind the first surface is behind it, of the same sign, and in part not far from it. */
#include "gbuffer_internal.h"
#include "median.h"
#include "text.h"

#include <math.h>
#include <stdlib.h>

/* Of texels that have both. */
struct layer {
    size_t surface;                /* those with depth */
    size_t both, nearer, as_depth; /* of the surface: with both, in front of depth, and equal */
    size_t close;                  /* less than this many times as far */
    double min_z;
};
static const double times_as_far = 4.0;

enum { FEW = 64 };

static bool mostly(size_t part, size_t whole)
{
    return whole > 0 && (double)part > 0.95 * (double)whole;
}

/* --- As stored --- */

struct layer_signs gbuffer_look_at_signs(const struct gbuffer *g, const float *values,
                                         bool is_negated)
{
    struct layer_signs s = {.low = INFINITY, .high = -INFINITY};
    for (size_t i = 0; i < gbuffer_texels(g); i++) {
        if (!gbuffer_is_measurable(fabs((double)values[i])))
            continue;
        s.values++;
        if ((values[i] < 0) == is_negated)
            continue;
        s.opposite++;
        s.low = fmin(s.low, (double)values[i]);
        s.high = fmax(s.high, (double)values[i]);
    }
    return s;
}

/* --- Depths --- */

/* Rounding of what is stored, relative. */
static double rounding_of(const struct gbuffer *g, const struct role *role)
{
    const bool is_half = g->depth_is_half || role->channels[0]->type == EXR_HALF;
    return is_half ? ldexp(1.0, -9) : 1e-5;
}

static struct layer look_behind(const struct gbuffer *g, const struct role *role,
                                const float *values)
{
    const double rounding = rounding_of(g, role);
    struct layer l = {0};
    for (size_t i = 0; i < gbuffer_texels(g); i++) {
        const bool is_surface = gbuffer_is_foreground(g, i);
        l.surface += is_surface;
        if (values[i] >= g->background_depth && values[i] <= g->background_depth)
            continue;
        const double behind = gbuffer_view_z(g, values[i], i);
        l.min_z = l.min_z > 0 ? fmin(l.min_z, behind) : behind;
        if (!is_surface)
            continue;
        const double z = gbuffer_view_z(g, g->depth[i], i);
        l.both++;
        l.nearer += behind < z * (1.0 - rounding);
        l.as_depth += fabs(behind - z) <= z * rounding;
        l.close += behind < z * times_as_far;
    }
    return l;
}

static bool check_depth(const struct gbuffer *g, enum role_kind kind, const char *option,
                        const struct layer *l, const struct layer_signs *signs,
                        struct report *report, struct tool_error *err)
{
    const struct role *role = &g->roles.kind[kind], *depth = &g->roles.kind[ROLE_DEPTH];
    const char *path = role->info->path;
    char share[PERCENT_BYTES];
    text_percent(share, l->both ? (double)l->nearer / (double)l->both : 0);
    if (l->surface == 0)
        return true;
    if (l->both >= FEW && mostly(l->nearer, l->both)) {
        fail_hint(
            err, "are the two exchanged, in other units or of other types? Write both alike%s",
            kind == ROLE_BACK_DEPTH ? "; if it is how thick things are: --thickness-channel" : "");
        return fail(err, EXIT_CHANNELS,
                    "%s: --%s '%s' is nearer than depth '%s' at %s of the texels that have both: "
                    "it should lie behind",
                    path, option, role->label, depth->label, share);
    }
    if (2 * signs->opposite > signs->values)
        report_warn(report, option,
                    "%s: --%s '%s' has the other sign than depth '%s', and what is behind the eye "
                    "counts as nothing: write both as distances",
                    path, option, role->label, depth->label);
    else if (l->both == 0)
        report_warn(report, option,
                    "%s: --%s '%s' has no value wherever depth '%s' has one: it changes nothing; "
                    "is it the right channel?",
                    path, option, role->label, depth->label);
    else if (mostly(l->as_depth + l->nearer, l->both))
        report_warn(report, option,
                    "%s: --%s '%s' is nowhere behind depth '%s', but the same: it changes nothing; "
                    "is it the right channel?",
                    path, option, role->label, depth->label);
    else if (10 * l->nearer > l->both)
        report_warn(report, option,
                    "%s: --%s '%s' is nearer than depth '%s' at %s of the texels that have both: "
                    "it should lie behind; is it filtered, of another unit or of another frame?",
                    path, option, role->label, depth->label, share);
    else if (l->both >= FEW && 100 * l->close < l->both)
        report_warn(report, option,
                    "%s: --%s '%s' is more than %g times as far as depth '%s' nearly everywhere: "
                    "in another unit? Write both alike",
                    path, option, role->label, times_as_far, depth->label);
    return true;
}

/* --- Lengths --- */

/* The one that nearly all of the surface has, or 0: things are not all equally thick, and none is
 * along the view axis wherever it is seen. Lossy compression leaves one value nearly so. False if
 * memory ran out. */
static bool find_one_length(const struct gbuffer *g, double *length)
{
    static const double same_value = 0.01;
    const size_t step = gbuffer_sample_step(g);
    double *values = malloc((gbuffer_texels(g) / step + 1) * sizeof *values);
    size_t count = 0, same = 0;
    *length = 0;
    if (!values)
        return false;
    for (size_t i = 0; i < gbuffer_texels(g); i += step)
        if (gbuffer_is_foreground(g, i))
            values[count++] = (double)g->thickness[i];
    const double usual = count >= FEW ? median_of(values, count) : 0;
    for (size_t i = 0; i < count; i++)
        same += fabs(values[i] - usual) <= same_value * usual;
    if (usual > 0 && mostly(same, count))
        *length = usual;
    free(values);
    return true;
}

/* That of the picture, or one without a layer beside other things. */
static bool is_alpha(const struct gbuffer *g, const struct role *role)
{
    const struct role *color = &g->roles.kind[ROLE_COLOR];
    const struct exr_channel *channel = role->channels[0];
    const bool is_alone = role->info->parts[role->part].channel_count == 1;
    return (color->found && color->channels[ROLE_MAX_COMPONENTS] == channel) ||
           (!is_alone &&
            (text_equal_nocase(channel->name, "A") || text_equal_nocase(channel->name, "alpha")));
}

static void check_lengths(const struct gbuffer *g, const struct layer_signs *signs, double one,
                          struct report *report)
{
    const struct role *role = &g->roles.kind[ROLE_THICKNESS];
    size_t surface = 0, known = 0;
    char share[PERCENT_BYTES];
    for (size_t i = 0; i < gbuffer_texels(g); i++) {
        surface += gbuffer_is_foreground(g, i);
        known += gbuffer_is_foreground(g, i) && g->thickness[i] > 0;
    }
    text_percent(share, (double)signs->opposite / (double)gbuffer_texels(g));
    /* One negative value stands for what is not known. */
    if (signs->low < signs->high && 20 * signs->opposite > gbuffer_texels(g))
        report_warn(report, "thickness-channel",
                    "%s: --thickness-channel '%s' is negative at %s of the image, where thickness "
                    "is unknown then: a component of normals or positions?",
                    role->info->path, role->label, share);
    else if (surface > 0 && known == 0)
        report_warn(report, "thickness-channel",
                    "%s: --thickness-channel '%s' is nowhere above 0: no thickness is known, and "
                    "all is taken to be 1.5 radii thick; is it the right channel?",
                    role->info->path, role->label);
    else if (is_alpha(g, role))
        report_warn(report, "thickness-channel",
                    "%s: --thickness-channel '%s' is an alpha by its name, whose values are taken "
                    "for lengths in scene units: name the channel of thickness, or leave the "
                    "option out",
                    role->info->path, role->label);
    else if (one > 0)
        report_warn(report, "thickness-channel",
                    "%s: --thickness-channel '%s' is %.6g on nearly all of the surface: an alpha, "
                    "or a matte? Name the channel of thickness, or leave the option out",
                    role->info->path, role->label, one);
}

bool gbuffer_check_behind(struct gbuffer *g, const struct layer_signs *thickness,
                          const struct layer_signs *second, struct report *report,
                          struct tool_error *err)
{
    const struct role *roles = g->roles.kind;
    if (g->thickness && roles[ROLE_THICKNESS].found) {
        double one;
        if (!find_one_length(g, &one))
            return fail(err, EXIT_MEMORY, "%s: out of memory", roles[ROLE_THICKNESS].info->path);
        check_lengths(g, thickness, one, report);
    } else if (g->thickness) {
        const struct layer l = look_behind(g, &roles[ROLE_BACK_DEPTH], g->thickness);
        if (!check_depth(g, ROLE_BACK_DEPTH, "back-depth", &l, thickness, report, err))
            return false;
    }
    if (!g->second_depth)
        return true;
    const struct layer l = look_behind(g, &roles[ROLE_LAYER2], g->second_depth);
    g->second_min_z = l.min_z;
    return check_depth(g, ROLE_LAYER2, "layer2", &l, second, report, err);
}
