/* SPDX-License-Identifier: MIT
 *
 * What depth measures, told by the flat things that it shows. Of three texels in a row on a plane
 * the one in the middle is the harmonic mean of the others if depth is a distance along the view
 * axis, and the arithmetic mean if it is one over that, or of a depth buffer, or seen without
 * perspective. Where depth was moved by an offset c, as normalised depth is, it is something in
 * between which tells c. Where it was bent, as by gamma, it is the same anywhere: of the square
 * root of a distance 3/2. Of its logarithm it grows with depth. Distances from the eye are the
 * first once they are divided by the length of their ray. Curved things tell anything, each
 * something else. */
#include "gbuffer_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    MOST_TRIPLES = 1 << 15,
    FEW_TRIPLES = 60,
    OFFSETS = 48 /* that are tried */
};

/* How far a triple may be from where a model wants it. */
static const double tolerance = 0.05;

struct triple {
    double planar; /* 1: harmonic mean, 0: arithmetic mean */
    double radial; /* the same of depth divided by the length of its ray */
    double depth;
};

/* Where the middle stands between the arithmetic (0) and the harmonic mean (1), unless it is stored
 * too coarsely to tell. On planes neither neighbour is much nearer to it than the other: that is so
 * across a step. */
static bool place_between(double a, double m, double b, double noise, double *place)
{
    const double arithmetic = (a + b) / 2.0, harmonic = 2.0 * a * b / (a + b);
    const double between = arithmetic - harmonic;
    *place = (arithmetic - m) / between;
    return between > 0 && noise < 0.02 * between && fabs(arithmetic - m) < 0.3 * fabs(b - a);
}

/* Sizes of the steps in which depth is stored, relative and absolute: half values, or 24 bits of
 * noise; 8 or 16 bits. */
struct storage {
    double relative, step;
};

static bool find_storage(const struct gbuffer *g, struct storage *s)
{
    s->relative = g->depth_is_half ? ldexp(1.0, -11) : 2e-6;
    s->step = 0;
    return g->depth_is_half || gbuffer_find_step(g, &s->step);
}

/* Parts of a range are no distances, but what they stand for once a gamma is undone. */
static double as_measured(const struct gbuffer *g, double gamma, size_t texel)
{
    return g->depth_type == DEPTH_NORMALIZED
               ? gbuffer_distance(g, (float)pow((double)g->depth[texel], gamma))
               : (double)g->depth[texel];
}

static size_t collect(const struct gbuffer *g, double gamma, const struct storage *storage,
                      struct triple *triples)
{
    const bool is_coarse = g->depth_is_half || storage->step > 0;
    const size_t reach = is_coarse ? 10 : 4, width = g->width, texels = gbuffer_texels(g);
    const size_t step = texels * 2 / MOST_TRIPLES + 1;
    size_t count = 0;
    for (size_t i = 0; i < texels && count + 2 <= MOST_TRIPLES; i += step) {
        const size_t x = i % width, y = i / width;
        const bool fits[2] = {x >= reach && x + reach < width, y >= reach && y + reach < g->height};
        const size_t offset[2] = {reach, reach * width};
        for (int axis = 0; axis < 2; axis++) {
            if (!fits[axis])
                continue;
            const size_t at[3] = {i - offset[axis], i, i + offset[axis]};
            double d[3], r[3];
            bool ok = true;
            for (int k = 0; k < 3; k++) {
                d[k] = as_measured(g, gamma, at[k]);
                ok &= gbuffer_is_measurable(d[k]) && d[k] < g->background.limit;
                r[k] = d[k] / gbuffer_ray_length(g, at[k]);
            }
            /* Beyond these slopes lie edges. */
            if (!ok || d[0] > 2.0 * d[2] || d[2] > 2.0 * d[0])
                continue;
            struct triple *t = &triples[count];
            const double noise = fmax(d[1] * storage->relative, storage->step);
            t->depth = d[1];
            if (!place_between(d[0], d[1], d[2], noise, &t->planar))
                continue;
            if (!place_between(r[0], r[1], r[2], noise, &t->radial))
                t->radial = NAN;
            count++;
        }
    }
    return count;
}

static double share_near(const struct triple *triples, size_t count, double place, bool radial)
{
    size_t near_it = 0;
    for (size_t i = 0; i < count; i++)
        near_it += fabs((radial ? triples[i].radial : triples[i].planar) - place) < tolerance;
    return (double)near_it / (double)count;
}

/* Of depth + c being the distance. */
static double share_with_offset(const struct triple *triples, size_t count, double c)
{
    size_t near_it = 0;
    for (size_t i = 0; i < count; i++) {
        const double place = triples[i].depth / (triples[i].depth + c);
        near_it += fabs(triples[i].planar - place) < tolerance * fmin(1.0, fabs(place));
    }
    return (double)near_it / (double)count;
}

/* May so much be missing from a depth? None is longer than the distance, or all count down from 1
 * or from a far plane. A range whose ends are told, or NULL, lies before the eye as a whole. */
static bool is_likely(const struct depth_range *range, double depth, double offset)
{
    if (!isfinite(offset) || !range)
        return isfinite(offset) && (offset > 0 || depth + offset < 0);
    return fmin(range->zero, range->one) + offset >= 0 ||
           fmax(range->zero, range->one) + offset <= 0;
}

static double best_offset(const struct triple *triples, size_t count,
                          const struct depth_range *range, double *offset)
{
    double best = 0;
    *offset = 0;
    for (size_t k = 0; k < OFFSETS; k++) {
        const struct triple *t = &triples[k * count / OFFSETS];
        const double c = t->depth * (1.0 / t->planar - 1.0);
        const double share =
            is_likely(range, t->depth, c) ? share_with_offset(triples, count, c) : 0;
        if (share > best) {
            best = share;
            *offset = c;
        }
    }
    return best;
}

/* The mean of those that say nearly this. */
static double mean_near(const struct triple *triples, size_t count, double place)
{
    double sum = 0;
    size_t near_it = 0;
    for (size_t i = 0; i < count; i++)
        if (fabs(triples[i].planar - place) < tolerance) {
            sum += triples[i].planar;
            near_it++;
        }
    return near_it ? sum / (double)near_it : place;
}

/* Depth that is a power of the distance, or its logarithm: place is then the same, or a multiple of
 * depth. */
static void read_curves(const struct triple *triples, size_t count, struct depth_planes *planes)
{
    for (size_t k = 0; k < OFFSETS; k++) {
        const struct triple *t = &triples[k * count / OFFSETS];
        const double exponent = 1.0 / (2.0 * t->planar - 1.0), slope = t->planar / t->depth;
        size_t near_it = 0;
        const double share = share_near(triples, count, t->planar, false);
        /* What is nearly 1 is 1, and nobody bends depth as much as this. */
        if (exponent > 0.2 && exponent < 5.0 && fabs(t->planar - 1.0) > 2.0 * tolerance &&
            share > planes->power_share) {
            planes->power_share = share;
            planes->power = 1.0 / (2.0 * mean_near(triples, count, t->planar) - 1.0);
        }
        for (size_t i = 0; slope > 0 && i < count; i++)
            near_it += fabs(triples[i].planar - slope * triples[i].depth) < tolerance;
        planes->logarithm_share = fmax(planes->logarithm_share, (double)near_it / (double)count);
    }
}

static bool read_planes(const struct gbuffer *g, double gamma, struct depth_planes *planes)
{
    struct triple *triples = malloc(MOST_TRIPLES * sizeof *triples);
    struct storage storage;
    *planes = (struct depth_planes){0};
    if (!triples || !find_storage(g, &storage)) {
        free(triples);
        return false;
    }
    const size_t count = collect(g, gamma, &storage, triples);
    if (count >= FEW_TRIPLES) {
        planes->planar = share_near(triples, count, 1.0, false);
        planes->linear = share_near(triples, count, 0.0, false);
        planes->radial = share_near(triples, count, 1.0, true);
        planes->offset_share =
            best_offset(triples, count, g->depth_type == DEPTH_NORMALIZED ? &g->depth_range : NULL,
                        &planes->offset);
        read_curves(triples, count, planes);
    }
    planes->count = count;
    free(triples);
    return true;
}

bool gbuffer_read_planes(const struct gbuffer *g, struct depth_planes *planes)
{
    return read_planes(g, 1.0, planes);
}

bool gbuffer_find_gamma(const struct gbuffer *g, double *gamma)
{
    /* Those of pictures, either way, and what else people do by hand. */
    static const double gammas[] = {1 / 3.0, 1 / 2.2, 1 / 1.8, 1 / 1.5, 1.5, 1.8, 2.2, 3.0};
    static const double least = 0.25, more = 1.5;
    const struct depth_planes *p = &g->planes;
    double best = more * fmax(fmax(p->planar, p->linear), fmax(p->radial, p->offset_share));
    *gamma = 1.0;
    for (size_t i = 0; best < 1.0 && i < sizeof gammas / sizeof *gammas; i++) {
        struct depth_planes other;
        if (!read_planes(g, gammas[i], &other))
            return false;
        const double share = fmax(other.planar, other.radial);
        if (other.count >= GBUFFER_ENOUGH_TRIPLES && share >= least && share > best) {
            best = share;
            *gamma = gammas[i];
        }
    }
    return true;
}

/* Steps of halves leave only what bends most, which says nothing of all else: one in SPARSE of what
 * is looked at is not enough. */
static size_t few_of(const struct gbuffer *g)
{
    enum { SPARSE = 200 };
    const size_t all = gbuffer_texels(g) * 2;
    return (all < MOST_TRIPLES ? all : MOST_TRIPLES) / SPARSE;
}

bool gbuffer_warn_of_curve(struct gbuffer *g, const char *path, struct report *report)
{
    static const double least = 0.25, least_of_logarithm = 0.4, more = 1.5;
    struct depth_planes *p = &g->planes;
    char what[64] = "";
    if (p->count == 0 && !gbuffer_read_planes(g, p))
        return false;
    const bool is_told = g->depth_source == DEPTH_BY_OPTION || g->depth_source == DEPTH_BY_CAMERA ||
                         g->depth_source == DEPTH_BY_ENDS;
    if (p->count < (is_told ? GBUFFER_ENOUGH_TRIPLES : few_of(g)))
        return true;
    const double other = more * fmax(fmax(p->planar, p->linear), fmax(p->radial, p->offset_share));
    if (p->power_share >= least && p->power_share > other && p->power_share >= p->logarithm_share)
        snprintf(what, sizeof what, "a distance to the power of about %.2g", p->power);
    else if (p->logarithm_share >= least_of_logarithm && p->logarithm_share > other)
        snprintf(what, sizeof what, "the logarithm of a distance");
    if (what[0])
        report_warn(report, "curved depth",
                    "%s: depth '%s' looks like %s: flat things are flat only then, and camera and "
                    "AO are wrong; write it as a distance, without any curve",
                    path, g->roles.kind[ROLE_DEPTH].label, what);
    return true;
}
