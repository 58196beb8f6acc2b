/* SPDX-License-Identifier: MIT
 *
 * Whether depth breaks where normals go on. Across the border of a thing normals mostly change with
 * depth. Where halves are of two cameras or units, where a line of a sensor or of a file is bad,
 * and around a bucket that is of another frame, depth breaks along a straight line of the image, on
 * all that lies there. The front edge of one thing before another that faces the same way does so
 * too, but is seldom as straight, and faces one way. But ledges at the height of the eye are one
 * line of the image on all walls of a street or a room.
 */
#include "gbuffer_internal.h"

#include <math.h>

enum {
    REACH = 2,        /* texels on either side of a border that tell */
    MOST_ALONG = 512, /* texels of a line, spread evenly */
    LEAST_BUCKET = 16,
    MOST_BUCKET = 128 /* texels; in between are powers of two */
};

/* Places along a border between two rows or columns. */
struct side {
    size_t alike, broken; /* of one normal on both sides; and with a break in depth */
    size_t upright;       /* of these, on what stands on the plane of the border and the eye */
    size_t nearer_behind; /* of these */
    double sum[3];        /* of the normals at breaks */
};

/* A border between two rows or two columns: that before `at`, from `begin` to `end` along it. */
struct border {
    bool is_row;
    size_t at, begin, end;
    double normal[3]; /* in view space, of the plane that it and the eye are in */
};

static struct border border_at(const struct gbuffer *g, bool is_row, size_t at, size_t begin,
                               size_t end)
{
    struct border b = {is_row, at, begin, end, {!is_row, is_row, 0}};
    const double line = (double)at - 0.5;
    double x, y;
    camera_ray(&g->camera, &g->display_window, &g->data_window, is_row ? 0 : line,
               is_row ? line : 0, &x, &y);
    if (g->camera.type != CAMERA_ORTHOGRAPHIC) {
        const double slope = is_row ? y : x, length = sqrt(1.0 + slope * slope);
        b.normal[is_row] = 1.0 / length;
        b.normal[2] = slope / length;
    }
    return b;
}

/* What lies at the place behind the last two if they are of a plane: w is linear in the image. */
static double go_on(const struct gbuffer *g, double before, double last)
{
    const bool is_parallel = g->camera.type == CAMERA_ORTHOGRAPHIC;
    return is_parallel ? 2.0 * last - before : 1.0 / (2.0 / last - 1.0 / before);
}

/* At the first texel behind a border. */
static void look_across(const struct gbuffer *g, const struct border *b, size_t texel,
                        struct side *side)
{
    static const double alike = 0.01, length = 0.1; /* 6 degrees; squares */
    static const double least_break = 0.01;         /* of the distance */
    static const double upright = 0.1;              /* 6 degrees */
    const size_t across = b->is_row ? g->width : 1;
    static const float zero[3] = {0};
    double z[2 * REACH];
    for (size_t k = 0; k < 2 * REACH; k++) {
        const size_t at = texel + k * across - REACH * across;
        const float *n = g->normals + at * 4;
        if (!gbuffer_is_foreground(g, at) || !(fabs(gbuffer_apart(n, zero) - 1.0) < length) ||
            (k > 0 && !(gbuffer_apart(n, n - across * 4) < alike)))
            return;
        z[k] = gbuffer_view_z(g, g->depth[at], at);
    }
    const double least = fmax(least_break * fmin(z[1], z[2]), 4.0 * g->depth_step);
    side->alike++;
    if (fabs(go_on(g, z[0], z[1]) - z[2]) < least || fabs(go_on(g, z[3], z[2]) - z[1]) < least)
        return;
    double v[3];
    gbuffer_view_normal(g, texel, v);
    const bool is_upright =
        fabs(v[0] * b->normal[0] + v[1] * b->normal[1] + v[2] * b->normal[2]) < upright;
    side->broken++;
    side->upright += is_upright;
    side->nearer_behind += is_upright && z[2] < z[1];
    for (int c = 0; c < 3; c++)
        side->sum[c] += (double)g->normals[texel * 4 + (size_t)c];
}

static void look_along(const struct gbuffer *g, const struct border *b, struct side *side)
{
    const size_t across = b->is_row ? g->width : 1, along = b->is_row ? 1 : g->width;
    const size_t step = (b->end - b->begin) / MOST_ALONG + 1;
    if (b->at < REACH || b->at + REACH > (b->is_row ? g->height : g->width))
        return;
    for (size_t k = b->begin; k < b->end; k += step)
        look_across(g, b, b->at * across + k * along, side);
}

/* What is of one kind is all nearer on one side of the border, where ledges or what is above them
 * stand out, and edges that lie in a plane with the eye are upright on it. Not all walls have them
 * at that height. */
static bool are_ledges(const struct side *s)
{
    static const double nearly_all = 0.95, most_broken = 0.85;
    const double upright = nearly_all * (double)s->broken, behind = (double)s->nearer_behind;
    return (double)s->broken < most_broken * (double)s->alike && (double)s->upright > upright &&
           (behind > nearly_all * (double)s->upright ||
            behind < (1.0 - nearly_all) * (double)s->upright);
}

/* Of clean renders at no line and around no bucket half of the places are broken, of several things
 * that face different ways, but for ledges. Of seams nearly all are. */
static bool is_seam(const struct side *s, size_t few)
{
    static const double one_way = 0.95; /* length of a mean */
    const double *n = s->sum;
    return s->alike >= few && 2 * s->broken > s->alike && !are_ledges(s) &&
           sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) < one_way * (double)s->broken;
}

/* --- From one side of the image to the other --- */

struct seams {
    size_t count, first; /* the place behind the first */
};

static struct seams find_seams(const struct gbuffer *g, bool is_row)
{
    const size_t size = is_row ? g->height : g->width, length = is_row ? g->width : g->height;
    const size_t texels = length / (length / MOST_ALONG + 1), few = 16 + texels / 5;
    struct seams seams = {0};
    for (size_t at = REACH; at + REACH <= size; at++) {
        struct side side = {0};
        const struct border border = border_at(g, is_row, at, 0, length);
        look_along(g, &border, &side);
        if (is_seam(&side, few) && seams.count++ == 0)
            seams.first = at;
    }
    /* What breaks everywhere is no line, but noise. */
    return seams.count * 8 < size ? seams : (struct seams){0};
}

static bool warn_of_seams(const struct gbuffer *g, bool is_row, const char *path,
                          struct report *report)
{
    const struct seams s = find_seams(g, is_row);
    const int64_t origin = is_row ? g->data_window.y_min : g->data_window.x_min;
    const char *normals = g->roles.kind[ROLE_NORMAL].label;
    if (s.count > 0)
        report_warn(report, "broken depth",
                    "%s: depth breaks along a line of the image, before %s %td, on all that lies "
                    "there, where normals '%s' go on: halves of two cameras or units, or a bad "
                    "line? AO is wrong there; write all of the image from one camera in one unit",
                    path, is_row ? "row" : "column", (ptrdiff_t)(origin + (int64_t)s.first),
                    normals);
    return s.count > 0;
}

/* --- Around buckets --- */

struct bucket {
    size_t size, x, y;
};

/* What is of another frame seldom goes on over a whole side: the ends of things that lie in a line
 * with one side of a bucket are no bucket. */
static bool goes_on_over(const struct side *before, const struct side *after, size_t few)
{
    const size_t alike = after->alike - before->alike, broken = after->broken - before->broken;
    return alike >= few && broken * 4 < alike;
}

static bool is_foreign(const struct gbuffer *g, const struct bucket *b)
{
    const size_t right = b->x + b->size, below = b->y + b->size;
    const size_t x_end = right < g->width ? right : g->width;
    const size_t y_end = below < g->height ? below : g->height;
    const struct border borders[4] = {
        border_at(g, true, b->y, b->x, x_end), border_at(g, true, below, b->x, x_end),
        border_at(g, false, b->x, b->y, y_end), border_at(g, false, right, b->y, y_end)};
    struct side side = {0};
    for (int k = 0; k < 4; k++) {
        const struct side before = side;
        look_along(g, &borders[k], &side);
        if (goes_on_over(&before, &side, b->size / 2))
            return false;
    }
    return is_seam(&side, b->size);
}

static size_t count_foreign(const struct gbuffer *g, size_t size, struct bucket *first)
{
    size_t count = 0;
    for (size_t y = 0; y < g->height; y += size)
        for (size_t x = 0; x < g->width; x += size) {
            const struct bucket b = {size, x, y};
            if (is_foreign(g, &b) && count++ == 0)
                *first = b;
        }
    return count;
}

static void warn_of_buckets(const struct gbuffer *g, const char *path, struct report *report)
{
    struct bucket b;
    size_t count = 0, size = MOST_BUCKET;
    for (; count == 0 && size >= LEAST_BUCKET; size /= 2)
        count = count_foreign(g, size, &b);
    if (count > 0)
        report_warn(report, "foreign bucket",
                    "%s: depth breaks all around a bucket of %zu x %zu pixels at (%td %td)%s, "
                    "where normals '%s' go on: of another frame? AO is wrong there; render it anew",
                    path, b.size, b.size, (ptrdiff_t)(g->data_window.x_min + (int64_t)b.x),
                    (ptrdiff_t)(g->data_window.y_min + (int64_t)b.y),
                    count > 1 ? " and others" : "", g->roles.kind[ROLE_NORMAL].label);
}

void gbuffer_warn_of_breaks(const struct gbuffer *g, const char *path, struct report *report)
{
    if (!g->normals || g->block_size > 1)
        return;
    const bool is_across = warn_of_seams(g, true, path, report);
    const bool is_down = warn_of_seams(g, false, path, report);
    if (!is_across && !is_down)
        warn_of_buckets(g, path, report);
}
