/* SPDX-License-Identifier: MIT
 *
 * Where normals have borders, depth has them too, and at the same place. A renderer that stores the
 * nearest or the farthest of a pixel's samples moves those of depth by half a texel towards what
 * lies behind or before, a filter of minima or maxima by more. Blur bends flat things near their
 * borders, and makes normals change little by little.
 */
#include "gbuffer_internal.h"

#include <math.h>

enum {
    REACH = 5,       /* texels to either side that are looked at */
    MOST = 1 << 18,  /* texels, spread evenly */
    FEW_STEPS = 30,  /* borders between near and far */
    FEW_SIDES = 12,  /* those that face one way */
    FEW_BENDS = 100, /* flat places beside borders */
    WAYS = 4
};

/* Two texels of one flat thing, as the square of the difference of their normals: 6 degrees. */
static const double alike = 0.01;
/* Two things: 18 degrees. */
static const double other = 0.1;
/* The last texel of a thing, if depth bends before it by so many widths of a texel, is its rim. */
static const double rim = 0.1;

/* Steps in depth from near to far that face one way, by where the normals change. */
struct steps {
    size_t count, before, behind; /* the last two: on the near, on the far side of the step */
};

/* Steps in depth to something that faces elsewhere, and those along which normals turn slowly. */
struct turns {
    size_t count, slow;
};

/* Flat places beside borders of normals, and those where depth bends. */
struct bends {
    size_t count, bent;
};

static const float *normal_at(const struct gbuffer *g, size_t texel, ptrdiff_t step)
{
    return g->normals + ((ptrdiff_t)texel + step) * 4;
}

static double depth_at(const struct gbuffer *g, size_t texel, ptrdiff_t step)
{
    static const double endless = 1e30;
    const size_t at = (size_t)((ptrdiff_t)texel + step);
    return gbuffer_is_foreground(g, at) ? gbuffer_view_z(g, g->depth[at], at) : endless;
}

/* What is linear in the image on a plane bends by so many widths of a texel, at the second of the
 * texels before a border. */
static double bend_before(const struct gbuffer *g, size_t last, ptrdiff_t way, bool is_row)
{
    const bool is_parallel = g->camera.type == CAMERA_ORTHOGRAPHIC;
    const double column = (double)(last % g->width), row = (double)(last / g->width);
    double w[3], x[2], y[2];
    for (int k = 0; k < 3; k++) {
        const double z = depth_at(g, last, -(k + 1) * way);
        w[k] = is_parallel ? z : 1.0 / z;
    }
    camera_ray(&g->camera, &g->display_window, &g->data_window, column, row, &x[0], &y[0]);
    camera_ray(&g->camera, &g->display_window, &g->data_window, column + is_row, row + !is_row,
               &x[1], &y[1]);
    return fabs(w[0] + w[2] - 2.0 * w[1]) / (fabs(x[1] - x[0]) + fabs(y[1] - y[0])) /
           (is_parallel ? 1.0 : w[1]);
}

/* --- Steps --- */

/* A surface that goes on from here: both steps of it are small beside the one in question. */
static bool goes_on(const double z[REACH], double step)
{
    for (int k = 0; k < 3; k++)
        if (!(fabs(z[k] - z[k + 1]) < 0.15 * step) ||
            !(fabs(z[k] - 2.0 * z[k + 1] + z[k + 2]) < 0.05 * step))
            return false;
    return true;
}

/* By how many texels the normals change behind a step in depth, if they change from one to another
 * and nothing else. */
static bool find_change(const struct gbuffer *g, size_t near_texel, ptrdiff_t way, double *place)
{
    const float *first = normal_at(g, near_texel, -2 * way);
    const float *last = normal_at(g, near_texel, 3 * way);
    const double all = gbuffer_apart(first, last);
    if (!(all > other) || !(gbuffer_apart(first, normal_at(g, near_texel, -3 * way)) < alike) ||
        !(gbuffer_apart(first, normal_at(g, near_texel, -4 * way)) < alike) ||
        !(gbuffer_apart(last, normal_at(g, near_texel, 4 * way)) < alike) ||
        !(gbuffer_apart(last, normal_at(g, near_texel, 5 * way)) < alike))
        return false;
    double sum = 0;
    for (int k = -1; k <= 2; k++) {
        const float *n = normal_at(g, near_texel, k * way);
        /* 0: the first, 1: the last; and what is neither. */
        const double part = ((gbuffer_apart(n, first) - gbuffer_apart(n, last)) / all + 1.0) / 2.0;
        if (!(fabs(part - 0.5) < 0.65) || !(gbuffer_apart(n, first) / all - part * part < 0.1))
            return false;
        sum += part;
    }
    *place = 2.0 - sum;
    return true;
}

/* A texel that covers both things leaves half of the turn to one step, a quarter in squares. */
static void look_at_turn(const struct gbuffer *g, size_t near_texel, ptrdiff_t way,
                         struct turns *turns)
{
    static const double at_once = 0.21;
    const ptrdiff_t from = -REACH + 1, to = REACH;
    const double all =
        gbuffer_apart(normal_at(g, near_texel, from * way), normal_at(g, near_texel, to * way));
    double most = 0;
    for (ptrdiff_t k = from; k < to; k++)
        most = fmax(most, gbuffer_apart(normal_at(g, near_texel, k * way),
                                        normal_at(g, near_texel, (k + 1) * way)));
    turns->count += all > other;
    turns->slow += all > other && most < at_once * all;
}

static void look_at_step(const struct gbuffer *g, size_t near_texel, ptrdiff_t way,
                         struct steps *steps, struct turns *turns)
{
    double z_near[REACH], z_far[REACH], place;
    for (int k = 0; k < REACH; k++) {
        z_near[k] = depth_at(g, near_texel, -k * way);
        z_far[k] = depth_at(g, near_texel, (k + 1) * way);
    }
    const double step = z_far[0] - z_near[0];
    if (!goes_on(z_near, step) || !goes_on(z_far, step))
        return;
    look_at_turn(g, near_texel, way, turns);
    if (!find_change(g, near_texel, way, &place))
        return;
    /* The top of a thing, a texel wide, faces as the floor behind it does; but depth bends there.
     * What a renderer moved lies on the surface before. In depth of steps that is not seen. */
    if (place < -0.5 && !(g->depth_step > 0) &&
        bend_before(g, (size_t)((ptrdiff_t)near_texel + way), way, way == 1 || way == -1) > rim)
        return;
    steps->count++;
    steps->before += place < -0.5;
    steps->behind += place > 0.5;
}

/* --- Bends --- */

static void look_at_border(const struct gbuffer *g, size_t last, ptrdiff_t way, bool is_row,
                           struct bends *bends)
{
    static const double flat = 1e-3;       /* 1.8 degrees */
    static const double least_bend = 0.05; /* rounding leaves a thousandth */
    const float *here = normal_at(g, last, -way), *there = normal_at(g, last, 2 * way);
    static const float zero[3] = {0};
    if (!(gbuffer_apart(here, zero) > 0.9) || !(gbuffer_apart(here, there) > 2.0 * other) ||
        !(gbuffer_apart(there, normal_at(g, last, 3 * way)) < flat))
        return;
    for (int k = 1; k <= REACH; k++)
        if (!gbuffer_is_foreground(g, (size_t)((ptrdiff_t)last - k * way)) ||
            !(gbuffer_apart(here, normal_at(g, last, -k * way)) < flat))
            return;
    bends->count++;
    bends->bent += bend_before(g, last, way, is_row) > least_bend;
}

/* --- Both --- */

struct borders {
    struct steps steps[WAYS]; /* to the right, left, down, up */
    struct turns turns;
    struct bends bends[2]; /* along rows, along columns */
};

static struct borders look(const struct gbuffer *g)
{
    struct borders b = {0};
    const size_t sizes[2] = {g->width, g->height}, strides[2] = {1, g->width};
    /* Odd, so that not all lie in the same columns. */
    const size_t stride = (gbuffer_texels(g) / MOST + 1) | 1;
    for (size_t i = 0; i < gbuffer_texels(g); i += stride) {
        const size_t at[2] = {i % g->width, i / g->width};
        for (int axis = 0; axis < 2; axis++) {
            if (at[axis] < REACH || at[axis] + REACH + 1 >= sizes[axis])
                continue;
            const ptrdiff_t way = (ptrdiff_t)strides[axis];
            const double here = depth_at(g, i, 0), next = depth_at(g, i, way);
            if (fabs(next - here) > 0.1 * fmin(here, next)) {
                const bool is_near = here < next;
                look_at_step(g, is_near ? i : i + strides[axis], is_near ? way : -way,
                             &b.steps[axis * 2 + !is_near], &b.turns);
            }
            look_at_border(g, i, way, axis == 0, &b.bends[axis]);
            look_at_border(g, i + strides[axis], -way, axis == 0, &b.bends[axis]);
        }
    }
    return b;
}

/* How many more of the normals change behind the step than before it: [-1,1]; 0: too few tell. */
static double excess(const struct steps *s)
{
    return s->count < FEW_SIDES ? 0 : ((double)s->behind - (double)s->before) / (double)s->count;
}

/* Of clean renders, small ones too, at most 12 of 100 steps that face one way are amiss, and 15 of
 * 100 flat places bend. Of the nearest or the farthest sample 20 and more are amiss, and of blur 40
 * bend. */
static const double amiss = 0.15, bent = 0.3;

/* 1: depth is that of the nearest, -1: of the farthest sample. One way alone may be a floor whose
 * farthest row is taken for sky. */
static int nearest_or_farthest(const struct borders *b)
{
    double sum = 0;
    size_t count = 0;
    int nearest = 0, farthest = 0;
    for (int i = 0; i < WAYS; i++) {
        const double e = excess(&b->steps[i]);
        nearest += e < -amiss;
        farthest += e > amiss;
        sum += e * (double)b->steps[i].count;
        count += b->steps[i].count;
    }
    const double all = amiss * (double)count;
    if (count < FEW_STEPS)
        return 0;
    return nearest >= 2 && sum < -all ? 1 : farthest >= 2 && sum > all ? -1 : 0;
}

static bool is_bent(const struct bends *b)
{
    return b->count >= FEW_BENDS && (double)b->bent > bent * (double)b->count;
}

/* Of clean renders at most 11 of 100 turns are slow. Of normals that are blurred with a deviation
 * of a texel 7 to 60 are, of most more than 20; of two texels 70 and more. Those that Blender
 * averages over a pixel, by a filter somewhat wider than that, are among the former: 10 to 33 of
 * 100 in four of its renders, where a blur of a texel makes 73 to 88. */
static const double slow = 0.16, slower = 0.65;

static double slow_share(const struct turns *t)
{
    return t->count >= FEW_STEPS ? (double)t->slow / (double)t->count : 0;
}

/* Whole millimetres, or parts of 16 bits: between two steps flat things bend. */
static bool has_steps(const struct gbuffer *g)
{
    double step = 0;
    return g->depth_step > 0 || (gbuffer_find_step(g, &step) && step > 0);
}

void gbuffer_warn_of_borders(const struct gbuffer *g, const char *path, struct report *report)
{
    const char *normals = g->roles.kind[ROLE_NORMAL].label;
    if (!g->normals || g->block_size > 1)
        return;
    const double enlargement = gbuffer_enlargement_of_normals(g);
    const struct borders b = look(g);
    const int nearest = nearest_or_farthest(&b);
    if (enlargement > 1.0)
        report_warn(report, "enlarged normals",
                    "%s: normals '%s' are enlarged %.3g times without interpolation: their borders "
                    "lie beside those of depth, where AO is wrong; write them at full size, or "
                    "derive them from depth by --normal none",
                    path, normals, enlargement);
    else if (slow_share(&b.turns) > slower)
        report_warn(report, "blurred normals",
                    "%s: normals '%s' are blurred (denoised, or enlarged): they turn little by "
                    "little where depth steps at once; AO is wrong there; write them unfiltered, "
                    "or derive them from depth by --normal none",
                    path, normals);
    else if (slow_share(&b.turns) > slow)
        report_warn(report, "averaged normals",
                    "%s: normals '%s' are averaged over pixels and their neighbours (antialiased), "
                    "or blurred: they turn over several texels where depth steps at once; AO is "
                    "off along silhouettes; one sample, in the centre of the pixel, has neither",
                    path, normals);
    else if (nearest)
        report_warn(report, "nearest depth",
                    "%s: depth is that of the %s of a pixel's samples, or of its neighbours: its "
                    "borders lie %s those of the normals '%s'; AO is wrong there; take one sample, "
                    "in the centre of the pixel",
                    path, nearest > 0 ? "nearest" : "farthest", nearest > 0 ? "outside" : "inside",
                    normals);
    else if ((is_bent(&b.bends[0]) || is_bent(&b.bends[1])) &&
             !(g->filtered_share > GBUFFER_MOST_FILTERED) && !has_steps(g))
        report_warn(report, "bent depth",
                    "%s: depth is blurred, or filtered: flat things bend where normals '%s' have "
                    "borders; AO is wrong there; render it unfiltered",
                    path, normals);
}
