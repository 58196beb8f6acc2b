/* SPDX-License-Identifier: MIT
 *
 * Whether depth ends where things go on. Ranges, of a depth pass that is made to be looked at, of a
 * clip or of a device, leave everything beyond them at one value, as a wall or as nothing; AO is
 * lost there. So is it where something in between was filled with one value, as mattes, plates and
 * the boxes of volumes are. Normals go on: they face all ways and have edges. Those of a wall face
 * the camera, those of a sky face the eye or are all the same.
 */
#include "gbuffer_internal.h"
#include "text.h"

#include <math.h>
#include <stdlib.h>

enum place { AT_NEAREST, AT_FARTHEST, AT_NOTHING, AT_FILL, PLACES, ELSEWHERE };

/* Texels well inside of what is all at one value, and how many of them face neither the camera nor
 * the eye, and lie at an edge; and the sums of their normals and of cosines to the eye. */
struct limit {
    size_t texels, turned, edges;
    double normal[3], to_eye;
};

struct range {
    float low, high; /* of depth where there is something */
    float fill;      /* in between, that of which most texels are; NAN: nearly all differ */
    bool is_rising;  /* not 1/depth nor a reversed depth buffer */
};

static int compare_floats(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return x < y ? -1 : x > y;
}

/* What many texels have in between. Depth in steps says nothing of that. */
static bool find_fill(const struct gbuffer *g, struct range *range)
{
    enum { MOST = 1 << 14, FEW = 64 };
    const size_t step = (gbuffer_texels(g) / MOST + 1) | 1;
    float *values = malloc((gbuffer_texels(g) / step + 1) * sizeof *values);
    size_t count = 0, most = FEW;
    range->fill = NAN;
    for (size_t i = 0; values && i < gbuffer_texels(g); i += step)
        if (gbuffer_is_foreground(g, i) && g->depth[i] > range->low && g->depth[i] < range->high)
            values[count++] = g->depth[i];
    if (values)
        qsort(values, count, sizeof *values, compare_floats);
    for (size_t i = 0, run; i < count && !g->depth_is_half && !(g->depth_step > 0); i += run) {
        for (run = 1; i + run < count && !(values[i] < values[i + run]);)
            run++;
        if (run > most) {
            most = run;
            range->fill = values[i];
        }
    }
    free(values);
    return values != NULL;
}

static struct range range_of(const struct gbuffer *g)
{
    struct range r = {INFINITY, -INFINITY, NAN, true};
    for (size_t i = 0; i < gbuffer_texels(g); i++) {
        if (!gbuffer_is_foreground(g, i))
            continue;
        r.low = fminf(r.low, g->depth[i]);
        r.high = fmaxf(r.high, g->depth[i]);
    }
    r.is_rising = gbuffer_view_z(g, r.low, 0) <= gbuffer_view_z(g, r.high, 0);
    return r;
}

/* Of a texel with a normal; those that are means of something and nothing are shorter. */
static enum place place_of(const struct gbuffer *g, const struct range *range, size_t texel)
{
    const float *n = g->normals + texel * 4, d = g->depth[texel];
    const bool is_something = gbuffer_is_foreground(g, texel);
    const bool is_fill = !(d < range->fill) && !(d > range->fill) && !isnan(range->fill);
    if (is_something && d > range->low && d < range->high && !is_fill)
        return ELSEWHERE;
    const float square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
    if (!(square > 0.9f) || !(square < 1.1f))
        return ELSEWHERE;
    return !is_something                           ? AT_NOTHING
           : is_fill                               ? AT_FILL
           : (d <= range->low) == range->is_rising ? AT_NEAREST
                                                   : AT_FARTHEST;
}

static void add(const struct gbuffer *g, size_t texel, bool is_edge, struct limit *limit)
{
    static const double most_cosine = 0.866; /* 30 degrees */
    double v[3], x = 0, y = 0;
    gbuffer_view_normal(g, texel, v);
    if (g->camera.type != CAMERA_ORTHOGRAPHIC)
        camera_ray(&g->camera, &g->display_window, &g->data_window, (double)(texel % g->width),
                   (double)(texel / g->width), &x, &y);
    const double to_eye = (v[2] - v[0] * x - v[1] * y) / sqrt(1.0 + x * x + y * y);
    limit->texels++;
    limit->turned += fabs(v[2]) < most_cosine && fabs(to_eye) < most_cosine;
    limit->edges += is_edge;
    for (int c = 0; c < 3; c++)
        limit->normal[c] += v[c];
    limit->to_eye += to_eye;
}

/* What is all at one value faces the camera or the eye. Bumps do not turn the mean of a wall. */
static bool is_slanted(const struct limit *limit)
{
    static const double most_cosine = 0.985; /* 10 degrees */
    const double *n = limit->normal, all = (double)limit->texels;
    const double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    return length > 0.9 * all && fabs(n[2]) < most_cosine * length &&
           fabs(limit->to_eye) < most_cosine * all;
}

static void look_at(const struct gbuffer *g, const struct range *range, size_t texel,
                    struct limit limits[PLACES])
{
    static const double other = 0.1; /* 18 degrees */
    const size_t around[4] = {texel - 1, texel + 1, texel - g->width, texel + g->width};
    const enum place place = place_of(g, range, texel);
    bool is_edge = false;
    if (place == ELSEWHERE)
        return;
    for (int k = 0; k < 4; k++) {
        if (place_of(g, range, around[k]) != place)
            return;
        is_edge |= gbuffer_apart(g->normals + texel * 4, g->normals + around[k] * 4) > other;
    }
    add(g, texel, is_edge, &limits[place]);
}

/* Of clean renders no texel at all is inside of the nearest or the farthest value, but of walls
 * that are seen straight on; those have turned ones by strong bumps alone. Of depth that was
 * clamped to what 70 or 90 % of the image are nearer than, or 20 %, 5 to 100 of 100 are turned;
 * where it was less than 10, the texels at edges were 10 times as many as are in a row across all
 * that is clamped. The sides of a box that is the sky are turned too, and have 3 edges at most.
 * Steps of halves may hold some far things. */
static bool goes_on(const struct gbuffer *g, const struct limit *limit, enum place place)
{
    static const double turned = 0.1, turned_at_edges = 0.04, edges = 6.5;
    enum { FEW = 100 };
    const double all = (double)limit->texels;
    const double least_share = g->depth_is_half || g->depth_step > 0 ? 0.05 : 0.005;
    if (limit->texels < FEW || all < least_share * (double)gbuffer_texels(g))
        return false;
    const bool has_edges = (double)limit->edges > edges * sqrt(all);
    return (place != AT_NOTHING && is_slanted(limit)) ||
           ((double)limit->turned > turned * all && (place != AT_NOTHING || has_edges)) ||
           ((double)limit->turned > turned_at_edges * all && has_edges);
}

/* Whether --background is why there is nothing, and not depth by itself. */
static bool is_by_option(const struct gbuffer *g, const struct limit *limit)
{
    return g->background.reason == BACKGROUND_GIVEN_VALUE && 2 * g->background.cut > limit->texels;
}

static void warn_of_limit(const struct gbuffer *g, const struct range *range,
                          const struct limit *limit, enum place place, const char *path,
                          struct report *report)
{
    const char *normals = g->roles.kind[ROLE_NORMAL].label;
    const bool is_low = range->is_rising == (place == AT_NEAREST);
    char share[PERCENT_BYTES];
    text_percent(share, (double)limit->texels / (double)gbuffer_texels(g));
    if (place == AT_FILL)
        report_warn(report, "filled depth",
                    "%s: %s of the depth are all at %.6g, where normals '%s' face other ways: a "
                    "matte, or the box of a volume? AO is wrong there; write depth of what is seen",
                    path, share, (double)range->fill, normals);
    else if (place == AT_NOTHING && is_by_option(g, limit))
        report_warn(report, "cut depth",
                    "%s: --background %.6g leaves nothing at %s of the image where normals '%s' "
                    "show things: too near, or in another unit than depth '%s'? AO is 1 there; "
                    "give the distance of the background, or --background off",
                    path, g->background.value, share, normals, g->roles.kind[ROLE_DEPTH].label);
    else if (place == AT_NOTHING)
        report_warn(report, "cut depth",
                    "%s: depth has nothing at %s of the image where normals '%s' show things: cut "
                    "off, or clamped? AO is 1 there; write depth without a range",
                    path, share, normals);
    else
        report_warn(report, "clamped depth",
                    "%s: depth is clamped: %s of the image are all at its %s value %.6g, where "
                    "normals '%s' face other ways; AO is wrong there; write depth without a range",
                    path, share, place == AT_NEAREST ? "nearest" : "farthest",
                    (double)(is_low ? range->low : range->high), normals);
}

bool gbuffer_warn_of_limits(const struct gbuffer *g, const char *path, struct report *report)
{
    struct limit limits[PLACES] = {{0}};
    if (!g->normals || g->block_size > 1)
        return true;
    struct range range = range_of(g);
    if (!find_fill(g, &range))
        return false;
    for (size_t y = 1; y + 1 < g->height; y++)
        for (size_t x = 1; x + 1 < g->width; x++)
            look_at(g, &range, y * g->width + x, limits);
    for (int k = 0; k < PLACES; k++)
        if (goes_on(g, &limits[k], (enum place)k))
            warn_of_limit(g, &range, &limits[k], (enum place)k, path, report);
    return true;
}
