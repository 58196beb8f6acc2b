/* SPDX-License-Identifier: MIT
 *
 * Whether borders of things are ramps. Where one thing ends before another, depth steps at once;
 * where images were averaged, as by motion, by a lens or by enlarging, it rises from one to the
 * other in several texels. A face that is seen at a slant does so too, but then its normals say so:
 * they are upright on the way from a texel to the next. Those of a mean face the eye.
 */
#include "gbuffer_internal.h"
#include "text.h"

#include <math.h>

enum { AXES = 2, MOST = 1 << 20, FEW = 20 };

/* A texel as a place in view space. */
struct point {
    size_t texel;
    double place[3];
    bool is_there;
};

/* How depth goes on from one texel to the next. */
struct stride {
    double rise, sine; /* the least between it and the surfaces that it joins */
    bool is_step;      /* that normals do not explain */
    double normals[2][3];
};

struct borders {
    size_t steps, ramps, others;
    size_t slanted; /* ramps that a coarse image makes of flutes and mouldings, too */
};

static struct point point_at(const struct gbuffer *g, size_t texel)
{
    struct point p = {.texel = texel, .is_there = gbuffer_is_foreground(g, texel)};
    const double z = gbuffer_view_z(g, g->depth[texel], texel);
    const double scale = g->camera.type == CAMERA_ORTHOGRAPHIC ? 1.0 : z;
    double x, y;
    camera_ray(&g->camera, &g->display_window, &g->data_window, (double)(texel % g->width),
               (double)(texel / g->width), &x, &y);
    p.place[0] = x * scale;
    p.place[1] = y * scale;
    p.place[2] = -z;
    return p;
}

/* False if there is nothing, or if it has no normal: means of both sides of an edge are shorter
 * than 1, and less than this points nowhere. */
static bool find_normal(const struct gbuffer *g, const struct point *p, double normal[3])
{
    double square = 0;
    gbuffer_view_normal(g, p->texel, normal);
    for (int c = 0; c < 3; c++)
        square += normal[c] * normal[c];
    for (int c = 0; c < 3; c++)
        normal[c] /= sqrt(square);
    return p->is_there && square > 0.04;
}

/* The sine of the angle between a way and a surface. */
static double leaves(const double way[3], const double normal[3])
{
    double dot = 0, square = 0;
    for (int c = 0; c < 3; c++) {
        dot += way[c] * normal[c];
        square += way[c] * way[c];
    }
    return fabs(dot) / sqrt(square);
}

/* Most rise so little that normals need not be asked. */
static struct stride stride_between(const struct gbuffer *g, const struct point *a,
                                    const struct point *b)
{
    static const double least_sine = 0.2; /* 12 degrees: bumps and round things turn less */
    static const double least_rise = 0.01;
    struct stride s = {.rise = a->place[2] - b->place[2]};
    double way[3];
    if (!(fabs(s.rise) > least_rise * fmin(-a->place[2], -b->place[2])) ||
        !find_normal(g, a, s.normals[0]) || !find_normal(g, b, s.normals[1]))
        return s;
    for (int c = 0; c < 3; c++)
        way[c] = b->place[c] - a->place[c];
    s.sine = fmin(leaves(way, s.normals[0]), leaves(way, s.normals[1]));
    s.is_step = s.sine > least_sine;
    return s;
}

/* What is not known rises without end. */
static double known_rise(const struct gbuffer *g, const struct point *a, const struct point *b)
{
    double normal[3];
    return find_normal(g, a, normal) && find_normal(g, b, normal) ? a->place[2] - b->place[2]
                                                                  : INFINITY;
}

/* Steps of one sign, one after the other, and the normals where they begin, after the first and at
 * the end. */
struct run {
    double sum, most, before, nearest, sines;
    double first[3], second[3], last[3];
    size_t length;
};

static double angle(const double a[3], const double b[3])
{
    return acos(fmin(fmax(a[0] * b[0] + a[1] * b[1] + a[2] * b[2], -1.0), 1.0));
}

/* A mean of two normals lies on the way from one to the other. What does not is a thing of its
 * own, of a texel. */
static bool is_third(const struct run *run, const double last[3])
{
    static const double most_detour = 0.3; /* 17 degrees */
    const double by_way = angle(run->first, run->second) + angle(run->second, last);
    return run->length == 2 && by_way > angle(run->first, last) + most_detour;
}

/* Of a run that lies between two surfaces, whether one step is nearly all of it. */
static void end_run(struct borders *borders, const struct run *run, double after)
{
    static const double least_sum = 0.1, upright = 0.5;
    const double sum = fabs(run->sum), mean = sum / (double)run->length;
    const bool is_slanted = run->sines < upright * (double)run->length;
    if (!(sum > least_sum * run->nearest) || !(fabs(run->before) < 0.5 * mean) ||
        !(fabs(after) < 0.5 * mean))
        return;
    if (run->most > 0.85 * sum || is_third(run, run->last))
        borders->steps++;
    else if (run->length >= 3 && run->most < 0.6 * sum)
        *(is_slanted ? &borders->slanted : &borders->ramps) += 1;
    else
        borders->others++;
}

static void look_along(struct borders *borders, const struct gbuffer *g, size_t first, size_t axis,
                       size_t count)
{
    struct point before = {0}, here = point_at(g, first);
    struct run run = {.length = 0};
    for (size_t i = 1; i < count; i++) {
        const struct point next = point_at(g, first + i * axis);
        const struct stride s = stride_between(g, &here, &next);
        if (run.length > 0 && !(s.is_step && (s.rise > 0) == (run.sum > 0))) {
            end_run(borders, &run, known_rise(g, &here, &next));
            run.length = 0;
        }
        if (s.is_step && run.length == 0) {
            run = (struct run){.before = i > 1 ? known_rise(g, &before, &here) : INFINITY,
                               .nearest = INFINITY};
            memcpy(run.first, s.normals[0], sizeof run.first);
            memcpy(run.second, s.normals[1], sizeof run.second);
        }
        if (s.is_step) {
            run.sum += s.rise;
            run.sines += s.sine;
            run.most = fmax(run.most, fabs(s.rise));
            run.nearest = fmin(run.nearest, fmin(-here.place[2], -next.place[2]));
            run.length++;
            memcpy(run.last, s.normals[1], sizeof run.last);
        }
        before = here;
        here = next;
    }
}

/* Of clean renders, of fur and grass too, at most 1 of 100 borders is a ramp, and 11 have a texel
 * in between. Of blur and of what was enlarged 8 and more are ramps along one axis at least,
 * mostly 40 and more; of what was made smaller half have a texel in between. Where every fifth
 * texel of columns and mouldings is left, 8 are slanted ramps; of slanted things that were blurred
 * 80 and more. */
static const double most_ramps = 0.05, most_slanted = 0.2, most_between = 0.35;

/* Share of borders that are no steps; 0: it may be that of a clean render. */
static double share_between(const struct borders *b)
{
    const size_t ramps = b->ramps + b->slanted, betweens = ramps + b->others;
    const double between = (double)betweens, all = (double)b->steps + between;
    const bool is_ramped = b->ramps >= FEW && (double)b->ramps > most_ramps * all;
    const bool is_slanted = ramps >= FEW && (double)ramps > most_slanted * all;
    const bool is_filtered = betweens >= FEW && between > most_between * all;
    return is_ramped || is_slanted || is_filtered ? between / all : 0;
}

void gbuffer_warn_of_ramps(struct gbuffer *g, const char *path, struct report *report)
{
    const size_t sizes[AXES] = {g->width, g->height}, strides[AXES] = {1, g->width};
    const size_t skip = gbuffer_texels(g) / MOST + 1;
    double share = 0;
    char words[PERCENT_BYTES];
    if (!g->normals || g->block_size > 1 || g->filtered_share > GBUFFER_MOST_FILTERED)
        return;
    /* Motion blurs one way. */
    for (int axis = 0; axis < AXES; axis++) {
        struct borders b = {0};
        for (size_t line = 0; line < sizes[!axis]; line += skip)
            look_along(&b, g, line * strides[!axis], strides[axis], sizes[axis]);
        share = fmax(share, share_between(&b));
    }
    if (!(share > 0))
        return;
    g->filtered_share = fmax(g->filtered_share, share);
    text_percent(words, share);
    report_warn(report, "ramps of depth",
                "%s: depth is filtered (blurred by motion or a lens, or resized): %s of its "
                "borders are ramps where normals '%s' show no surface; AO is wrong there; render "
                "it unfiltered, of one sample in the centre of the pixel",
                path, words, g->roles.kind[ROLE_NORMAL].label);
}
