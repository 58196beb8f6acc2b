/* SPDX-License-Identifier: MIT
 *
 * Where one of depth and normals shows a surface and the other shows none. What is left out of
 * normals is derived from depth, which is less accurate. What is left out of depth is open, and
 * light falls through it. Renders have a few such texels, at the borders of things, but no lines
 * from one side to the other.
 */
#include "gbuffer_internal.h"
#include "text.h"

#include <math.h>
#include <stdio.h>

static double square_of(const float *n)
{
    return (double)n[0] * (double)n[0] + (double)n[1] * (double)n[1] + (double)n[2] * (double)n[2];
}

/* --- Of normals --- */

/* A surface, by the depth. */
struct surface {
    size_t texels, bare, outside; /* bare: without normal; outside: of the window of normals */
};

static struct surface look_for_bare(const struct gbuffer *g, const struct exr_box *window)
{
    struct surface s = {0};
    for (size_t i = 0; i < gbuffer_texels(g); i++) {
        if (!gbuffer_is_foreground(g, i))
            continue;
        s.texels++;
        if (square_of(g->normals + i * 4) > 0)
            continue;
        const int64_t x = (int64_t)g->data_window.x_min + (int64_t)(i % g->width);
        const int64_t y = (int64_t)g->data_window.y_min + (int64_t)(i / g->width);
        s.bare++;
        s.outside +=
            x < window->x_min || x > window->x_max || y < window->y_min || y > window->y_max;
    }
    return s;
}

static void warn_of_bare(const struct gbuffer *g, struct report *report)
{
    static const double least_share = 0.01;
    const struct role *normal = &g->roles.kind[ROLE_NORMAL];
    const struct exr_box *window = &normal->info->parts[normal->part].data_window;
    const struct surface s = look_for_bare(g, window);
    char share[PERCENT_BYTES], where[128] = "they are 0 or no numbers";
    if (!((double)s.bare > least_share * (double)s.texels))
        return;
    if (s.outside * 2 > s.bare)
        snprintf(where, sizeof where, "their data window (%d %d) - (%d %d) covers a part only",
                 window->x_min, window->y_min, window->x_max, window->y_max);
    text_percent(share, (double)s.bare / (double)s.texels);
    report_warn(report, "bare surface",
                "%s: %s of the surface has no normals '%s': %s; derived from depth there (edges "
                "less accurate); write them for all that depth shows",
                normal->info->path, share, normal->label, where);
}

/* --- Of depth --- */

enum { LONGEST_HOLE = 16 }; /* texels */

/* Nothing by the depth as stored, and of the length of a normal. */
static bool may_be_hole(const struct gbuffer *g, size_t texel)
{
    const bool is_transparent = g->background.is_transparent && g->alpha && !(g->alpha[texel] > 0);
    const double square = square_of(g->normals + texel * 4);
    return !gbuffer_is_foreground(g, texel) && !is_transparent && square > 0.9 && square < 1.1;
}

/* Of one surface: as far away, and facing the same way. */
static bool is_one_surface(const struct gbuffer *g, size_t first, size_t last)
{
    static const double alike = 0.1, near_by = 0.05; /* 18 degrees; and of the distance */
    const double a = gbuffer_view_z(g, g->depth[first], first);
    const double b = gbuffer_view_z(g, g->depth[last], last);
    return fabs(a - b) < near_by * fmin(a, b) &&
           gbuffer_apart(g->normals + first * 4, g->normals + last * 4) < alike;
}

/* Texels of a row or a column without depth between two of one surface, whose normals go on in
 * between. Where the sky has normals, they are others. */
static size_t count_holes(const struct gbuffer *g, size_t begin, size_t step, size_t length)
{
    static const double alike = 0.1;
    size_t holes = 0, run = 0;
    for (size_t k = 0; k < length; k++) {
        const size_t at = begin + k * step;
        const bool is_surface = gbuffer_is_foreground(g, at);
        if (is_surface && run > 0 && run < k && run <= LONGEST_HOLE &&
            is_one_surface(g, at - (run + 1) * step, at))
            holes += run;
        const bool goes_on =
            !is_surface && k > run && may_be_hole(g, at) &&
            gbuffer_apart(g->normals + at * 4, g->normals + (at - (run + 1) * step) * 4) < alike;
        run = goes_on ? run + 1 : is_surface ? 0 : length;
    }
    return holes;
}

static void warn_of_holes(const struct gbuffer *g, const char *path, struct report *report)
{
    static const double least_share = 0.0005;
    size_t rows = 0, columns = 0;
    char share[PERCENT_BYTES];
    for (size_t y = 0; y < g->height; y++)
        rows += count_holes(g, y * g->width, 1, g->width);
    for (size_t x = 0; x < g->width; x++)
        columns += count_holes(g, x, g->width, g->height);
    const double holes = (double)(rows > columns ? rows : columns) / (double)gbuffer_texels(g);
    /* Those that are no numbers are said already. */
    if (!(holes - g->invalid_share > least_share))
        return;
    text_percent(share, holes);
    report_warn(
        report, "holes in depth",
        "%s: depth has nothing at %s of the image or more, in the middle of surfaces that normals "
        "'%s' show: treated as background, and AO is too light around; write depth for all "
        "that they show",
        path, share, g->roles.kind[ROLE_NORMAL].label);
}

/* --- Lines --- */

enum { THICKEST_SEAM = 4 }; /* texels */

static bool is_empty(const struct gbuffer *g, size_t begin, size_t step, size_t length)
{
    for (size_t k = 0; k < length; k++)
        if (gbuffer_is_foreground(g, begin + k * step))
            return false;
    return true;
}

/* Whether the lines on both sides show the same things, and several of them: what is seen between
 * the boards of a fence is seen at one distance. */
static bool goes_on(const struct gbuffer *g, size_t before, size_t after, size_t step,
                    size_t length)
{
    static const double near_by = 0.1, several = 1.2;
    enum { FEW = 16 };
    size_t either = 0, both = 0;
    double nearest = INFINITY, farthest = 0;
    for (size_t k = 0; k < length; k++) {
        const size_t i = before + k * step, j = after + k * step;
        const bool is_a = gbuffer_is_foreground(g, i), is_b = gbuffer_is_foreground(g, j);
        either += is_a || is_b;
        if (!is_a || !is_b)
            continue;
        const double a = gbuffer_view_z(g, g->depth[i], i), b = gbuffer_view_z(g, g->depth[j], j);
        if (!(fabs(a - b) < near_by * fmin(a, b)))
            continue;
        both++;
        nearest = fmin(nearest, a);
        farthest = fmax(farthest, a);
    }
    return both >= FEW && 2 * both > either && farthest > several * nearest;
}

/* Rows or columns; across is the step from one to the next. */
static size_t count_seams(const struct gbuffer *g, size_t across, size_t lines, size_t step,
                          size_t length)
{
    size_t seams = 0, run = 0;
    for (size_t line = 0; line < lines; line++) {
        const size_t begin = line * across;
        if (is_empty(g, begin, step, length)) {
            run++;
            continue;
        }
        if (run > 0 && run < line && run <= THICKEST_SEAM &&
            goes_on(g, begin - (run + 1) * across, begin, step, length))
            seams += run;
        run = 0;
    }
    return seams;
}

static void warn_of_seams(const struct gbuffer *g, const char *path, struct report *report)
{
    const size_t rows = count_seams(g, g->width, g->height, 1, g->width);
    const size_t columns = count_seams(g, 1, g->width, g->width, g->height);
    if (rows + columns > 0)
        report_warn(report, "seams in depth",
                    "%s: depth has nothing in %zu rows and %zu columns from one side of the image "
                    "to the other, with the same things on both sides of each: seams of tiles, or "
                    "lines that were lost? AO is too light beside them; write all of the image",
                    path, rows, columns);
}

void gbuffer_warn_of_holes(const struct gbuffer *g, const char *path, struct report *report)
{
    warn_of_seams(g, path, report);
    if (!g->normals)
        return;
    warn_of_bare(g, report);
    if (g->background.reason != BACKGROUND_GIVEN_VALUE)
        warn_of_holes(g, path, report);
}
