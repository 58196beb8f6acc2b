/* SPDX-License-Identifier: MIT
 *
 * What of a depth is background. Renderers write zero, infinity, some huge number, the end of the
 * clip range or the largest half where there is nothing; compression and units change the number.
 * What it has in common is that it is far away from all else and always the same. So is a wall seen
 * straight on: what tells them apart is that floors meet walls, and that walls have normals and
 * alpha. So is the last row of a floor that a level camera sees, but it goes on from the rows
 * before. */
#include "gbuffer_internal.h"
#include "median.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Far more than walls are farther away than what stands before them: no other sign is needed. */
static const double clear_gap = 20.0;
/* Less than that may be a wall. */
static const double least_gap = 3.0;
/* Of texels: below it a repeated value changes nothing. */
static const double least_share = 0.002;
/* What lossy compression makes of one value. */
static const double same_value = 0.99;

enum { MAX_CLUSTERS = 4, MOST_VALUES = 1 << 16 };

/* Far values that are alike. */
struct cluster {
    double value; /* the most frequent of them, which is nearly the largest */
    double share; /* of the texels with a distance */
    double gap;   /* how many times as far as nearly all else */
    double rest;  /* that else: 98 % of it is nearer */
    bool is_repeated;
};

/* What is seen where the cluster is. */
struct surroundings {
    size_t texels;
    size_t normals, transparent; /* of these, with a normal, and with alpha 0 */
    size_t borders, touching;    /* borders to something else, and those without a jump */
    size_t continued;            /* those from which it goes on as it came */
    double mean[3];              /* normal */
};

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

static size_t lower_bound(const double *values, size_t count, double limit)
{
    size_t low = 0, high = count;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (values[middle] < limit)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* The most frequent of sorted values. */
static double most_frequent(const double *values, size_t count, size_t *times)
{
    double value = 0;
    *times = 0;
    for (size_t i = 0, run; i < count; i += run) {
        for (run = 1; i + run < count && !(values[i] < values[i + run]);)
            run++;
        if (run >= *times) {
            *times = run;
            value = values[i];
        }
    }
    return value;
}

/* The farthest of sorted distances. */
static struct cluster farthest(const double *values, size_t count)
{
    enum { FEW = 16 };
    struct cluster c = {0};
    const size_t first = lower_bound(values, count, values[count - 1] * same_value);
    size_t times;
    c.value = most_frequent(values + first, count - first, &times);
    c.share = (double)(count - first) / (double)count;
    c.is_repeated = count - first >= FEW && c.share >= least_share && 2 * times >= count - first;
    c.rest = first > 0 ? values[(size_t)((double)(first - 1) * 0.98)] : c.value;
    c.gap = c.value / c.rest;
    return c;
}

static bool has_normal(const struct gbuffer *g, size_t texel)
{
    const float *n = g->normals + texel * 4;
    const double x = (double)n[0], y = (double)n[1], z = (double)n[2];
    /* Grey is zero in colours. */
    const double grey = fabs(x - 0.5) + fabs(y - 0.5) + fabs(z - 0.5);
    return x * x + y * y + z * z > 0.25 && grey > 0.02;
}

static bool is_in(const struct gbuffer *g, size_t texel, double low, double high)
{
    const double d = gbuffer_distance(g, g->depth[texel]);
    return gbuffer_is_measurable(d) && d >= low && d <= high;
}

/* A wall has one normal, but for its bumps. */
static void find_mean_normal(const struct gbuffer *g, double low, double high,
                             struct surroundings *s)
{
    for (size_t i = 0; i < gbuffer_texels(g); i++) {
        const float *n = g->normals + i * 4;
        if (!is_in(g, i, low, high) || !has_normal(g, i))
            continue;
        const double x = (double)n[0], y = (double)n[1], z = (double)n[2];
        const double share = 1.0 / (sqrt(x * x + y * y + z * z) * (double)s->normals);
        s->mean[0] += x * share;
        s->mean[1] += y * share;
        s->mean[2] += z * share;
    }
}

/* Are these depths of three texels of a plane, each farther than the one before? Without
 * perspective the steps between them are equal, with it those of 1/z. A jump takes nearly all of
 * both in the second step. */
static bool is_slope(double near, double middle, double far)
{
    return near > 0 && near < middle && middle < far &&
           1.0 / near - 1.0 / middle > 0.4 * (1.0 / near - 1.0 / far) &&
           middle - near < 0.6 * (far - near);
}

/* Of what lies from low to high, mostly at the value. */
static struct surroundings look_around(const struct gbuffer *g, double value, double low,
                                       double high)
{
    struct surroundings s = {0};
    for (size_t i = 0; i < gbuffer_texels(g); i++) {
        if (!is_in(g, i, low, high))
            continue;
        s.texels++;
        s.normals += g->normals && has_normal(g, i);
        s.transparent += g->alpha && !(g->alpha[i] > 0);
        const size_t x = i % g->width, y = i / g->width;
        const struct {
            bool there, one_more;
            ptrdiff_t step;
        } ways[4] = {{x > 0, x > 1, -1},
                     {x + 1 < g->width, x + 2 < g->width, 1},
                     {y > 0, y > 1, -(ptrdiff_t)g->width},
                     {y + 1 < g->height, y + 2 < g->height, (ptrdiff_t)g->width}};
        for (int k = 0; k < 4; k++) {
            const float *depth = g->depth + i;
            const ptrdiff_t step = ways[k].step;
            const double other = ways[k].there ? gbuffer_distance(g, depth[step]) : value;
            if (other >= low && other <= high)
                continue;
            s.borders++;
            s.touching += other > value * 0.93;
            s.continued += ways[k].one_more && is_slope(gbuffer_distance(g, depth[2 * step]), other,
                                                        gbuffer_distance(g, *depth));
        }
    }
    if (g->normals)
        find_mean_normal(g, low, high, &s);
    return s;
}

static bool mostly(size_t part, size_t whole)
{
    return (double)part > 0.9 * (double)whole;
}

/* What is always as far is a wall that faces the camera, by the rotation that the image shows; if
 * it shows none, normals prove nothing. */
static bool has_normal_of_wall(const struct gbuffer *g, const struct surroundings *s)
{
    static const double least_length = 0.7, facing = 0.96; /* of a mean, and a cosine */
    const double *m = s->mean, *r = g->seen_rotation + 6;
    const double length = sqrt(m[0] * m[0] + m[1] * m[1] + m[2] * m[2]);
    const double along = fabs(r[0] * m[0] + r[1] * m[1] + r[2] * m[2]);
    return !g->has_seen_rotation || (length > least_length && along > facing * length);
}

/* Whether the cluster is background, and why. */
static enum background_reason judge(const struct gbuffer *g, const struct cluster *c)
{
    const double far_plane = g->camera.far_plane;
    if (!c->is_repeated)
        return BACKGROUND_NONE;
    const struct surroundings s =
        look_around(g, c->value, c->value * same_value, c->value / same_value);
    const bool has_normals = g->normals && mostly(s.normals, s.texels);
    if (far_plane > 0 && c->value >= far_plane * same_value && c->value <= far_plane / same_value)
        return BACKGROUND_FAR_PLANE;
    if (g->alpha && mostly(s.transparent, s.texels))
        return BACKGROUND_ALPHA;
    if (g->normals && s.normals < s.texels / 10)
        return c->gap > 1.0 ? BACKGROUND_NO_NORMALS : BACKGROUND_NONE;
    if (c->gap >= clear_gap)
        return BACKGROUND_FAR;
    /* The other side of a row of a floor may be background. */
    if ((double)s.continued > 0.25 * (double)s.borders)
        return BACKGROUND_NONE;
    if (has_normals && g->depth_type != DEPTH_RADIAL && !has_normal_of_wall(g, &s))
        return c->gap > 1.0 ? BACKGROUND_NO_NORMALS : BACKGROUND_NONE;
    /* Colours of normals have some where there is nothing. */
    if (has_normals && c->gap >= least_gap)
        return BACKGROUND_DOUBT;
    if ((double)s.touching > 0.05 * (double)s.borders)
        return BACKGROUND_NONE;
    return c->gap >= least_gap ? BACKGROUND_FAR
           : c->share > 0.005  ? BACKGROUND_DOUBT
                               : BACKGROUND_NONE;
}

/* Distances of the picture that may be geometry, sorted. NULL if memory ran out. */
static double *sorted_distances(const struct gbuffer *g, size_t *count)
{
    const size_t step = gbuffer_texels(g) / MOST_VALUES + 1;
    double *values = malloc((gbuffer_texels(g) / step + 1) * sizeof *values);
    *count = 0;
    for (size_t i = 0; values && i < gbuffer_texels(g); i += step) {
        const double d = gbuffer_distance(g, g->depth[i]);
        if (gbuffer_is_measurable(d))
            values[(*count)++] = d;
    }
    if (values)
        qsort(values, *count, sizeof *values, compare);
    return values;
}

/* Where alpha is 0 and depth always says the same, or says nothing that could be a surface, there
 * is nothing. Shadow catchers and holdouts are surfaces in spite of their alpha, however much sky
 * is known to be behind them. */
static bool transparent_is_background(const struct gbuffer *g)
{
    size_t transparent = 0, surface = 0;
    for (size_t i = g->width; i + g->width < gbuffer_texels(g); i++) {
        const double d = gbuffer_distance(g, g->depth[i]);
        if (g->alpha[i] > 0 || !gbuffer_is_measurable(d) || d >= g->background.limit)
            continue;
        const size_t steps[2] = {1, g->width};
        bool is_smooth = true, varies = false;
        for (int k = 0; k < 2; k++) {
            const double before = gbuffer_distance(g, g->depth[i - steps[k]]);
            const double after = gbuffer_distance(g, g->depth[i + steps[k]]);
            varies |= before < d || before > d || after < d || after > d;
            is_smooth &= fabs(before + after - 2.0 * d) < 0.02 * d;
        }
        transparent++;
        surface += is_smooth && varies;
    }
    return !mostly(transparent, gbuffer_texels(g)) && 2 * surface < transparent;
}

static bool is_bare(const struct gbuffer *g, size_t texel)
{
    const float *n = g->normals + texel * 4;
    const bool is_there = n[0] * n[0] + n[1] * n[1] + n[2] * n[2] > 0;
    return !is_there && gbuffer_is_measurable(gbuffer_distance(g, g->depth[texel]));
}

/* One value where normals are 0, and hardly anywhere else: a sky, though things lie beyond it. The
 * value of most of them is what is left of a vote. */
static void find_point(const struct gbuffer *g, struct background *b)
{
    static const double nearly_all = 0.95, hardly_any = 0.01;
    enum { FEW = 16 };
    const size_t texels = gbuffer_texels(g);
    size_t bare = 0, votes = 0, equal = 0, opaque = 0, others = 0;
    float value = 0;
    for (size_t i = 0; i < texels; i++) {
        if (!is_bare(g, i))
            continue;
        const bool is_same = g->depth[i] <= value && g->depth[i] >= value;
        value = votes == 0 ? g->depth[i] : value;
        votes = votes == 0 || is_same ? votes + 1 : votes - 1;
        bare++;
    }
    for (size_t i = 0; bare > 0 && i < texels; i++) {
        if (!(g->depth[i] <= value && g->depth[i] >= value))
            continue;
        equal += is_bare(g, i);
        others += !is_bare(g, i);
        opaque += g->alpha && g->alpha[i] > 0;
    }
    if (equal < FEW || (double)equal < least_share * (double)texels ||
        (double)equal < nearly_all * (double)bare || (double)others > hardly_any * (double)equal ||
        (double)opaque > 0.5 * (double)equal)
        return;
    b->has_point = true;
    b->point = value;
}

/* From where on distances are those of a sky, whoever tells another limit; INFINITY if there is
 * none. */
static double begin_of_sky(const struct gbuffer *g, const double *values, size_t count)
{
    if (count == 0)
        return INFINITY;
    const struct cluster c = farthest(values, count);
    const enum background_reason reason = judge(g, &c);
    const bool is_sky = reason != BACKGROUND_NONE && reason != BACKGROUND_DOUBT;
    return is_sky ? c.value * same_value : INFINITY;
}

/* What has a distance, but for the given one. Surfaces go on through a distance that is too near;
 * background lies behind a gap, and so does a backdrop: of the borders of skies up to a fiftieth
 * are slopes, and .07 where the sky begins right behind the farthest hill. Of those of a floor, cut
 * behind furniture, they were .19. False if memory ran out. */
static bool find_cut(const struct gbuffer *g, struct background *b)
{
    static const double least_continued = 0.1;
    const struct surroundings s = look_around(g, b->value, b->limit, INFINITY);
    size_t count, surface = 0, cut = 0;
    double *values = sorted_distances(g, &count);
    if (!values)
        return false;
    const double sky = begin_of_sky(g, values, count);
    for (size_t i = 0; i < gbuffer_texels(g); i++) {
        surface += is_in(g, i, 0, sky);
        cut += is_in(g, i, b->limit, sky);
    }
    b->cut = s.texels;
    b->cut_share = cut > 0 ? (double)cut / (double)surface : 0;
    b->is_amid_surface = (double)s.continued > least_continued * (double)s.borders;
    free(values);
    return true;
}

bool gbuffer_find_background(struct gbuffer *g, const struct gbuffer_options *options)
{
    struct background *b = &g->background;
    *b = (struct background){.limit = INFINITY};
    if (options->background == BACKGROUND_GIVEN) {
        b->reason = BACKGROUND_GIVEN_VALUE;
        b->value = options->background_value;
        b->limit = options->background_value * (1.0 - 1e-4);
        return find_cut(g, b);
    }
    if (options->background == BACKGROUND_OFF)
        return true;
    size_t count;
    double *values = sorted_distances(g, &count);
    if (!values)
        return false;
    for (int i = 0; i < MAX_CLUSTERS && count > 0; i++) {
        const struct cluster c = farthest(values, count);
        const enum background_reason reason = judge(g, &c);
        if (reason == BACKGROUND_NONE)
            break;
        b->value = c.value;
        b->gap = c.gap;
        b->share = c.share;
        b->reason = reason;
        b->is_doubtful = reason == BACKGROUND_FAR && c.gap < clear_gap;
        if (reason == BACKGROUND_DOUBT)
            break;
        /* What filters mix of both lies in between. */
        b->limit = c.gap >= clear_gap ? sqrt(c.value * c.rest) : c.value * same_value;
        count = lower_bound(values, count, b->limit);
    }
    /* No scene is so deep. */
    if (count > 0)
        b->limit = fmin(b->limit, values[count / 2] * 1e7);
    free(values);
    b->is_transparent = g->alpha && transparent_is_background(g);
    if (g->normals && (b->reason == BACKGROUND_NONE || b->reason == BACKGROUND_DOUBT))
        find_point(g, b);
    if (b->has_point) {
        b->reason = BACKGROUND_NO_NORMALS;
        b->value = gbuffer_distance(g, b->point);
    }
    return true;
}

/* --- Nothing at all --- */

static bool is_near(double a, double b)
{
    return a >= b * same_value && a <= b / same_value;
}

/* A value that is everywhere. */
static bool is_background_value(const struct gbuffer *g, const struct gbuffer_options *options,
                                double distance, double stored)
{
    static const double most_half = 65504.0;
    const double before = options->memory ? options->memory->background : 0;
    const double far_plane = g->camera.far_plane;
    bool is_transparent = g->alpha != NULL;
    for (size_t i = 0; is_transparent && i < gbuffer_texels(g); i++)
        is_transparent = !(g->alpha[i] > 0);
    return distance < 0 || is_transparent || !(fabs(stored - most_half) > 0) ||
           (far_plane > 0 && is_near(distance, far_plane)) ||
           (before > 0 && is_near(distance, before));
}

bool gbuffer_is_empty(const struct gbuffer *g, const struct gbuffer_options *options)
{
    const bool has_ends = g->depth_type == DEPTH_DEVICE || g->depth_type == DEPTH_NORMALIZED;
    const double limit =
        options->background == BACKGROUND_GIVEN ? options->background_value : INFINITY;
    double low = INFINITY, high = -INFINITY, stored = 0;
    for (size_t i = 0; i < gbuffer_texels(g); i++) {
        const double d = (double)g->depth[i];
        const double distance = g->depth_type == DEPTH_INVERSE ? 1.0 / d : d;
        const bool is_something =
            has_ends ? d > 0 && d < 1 : gbuffer_is_measurable(fabs(distance)) && distance < limit;
        if (!is_something)
            continue;
        low = fmin(low, distance);
        high = fmax(high, distance);
        stored = d;
    }
    return low > high ||
           (!(low < high) && !has_ends && is_background_value(g, options, low, stored));
}

bool gbuffer_is_one_point(const struct gbuffer *g, const float *positions)
{
    for (size_t i = 1; i < gbuffer_texels(g); i++)
        for (size_t c = 0; c < 3; c++)
            if (positions[i * 4 + c] < positions[c] || positions[i * 4 + c] > positions[c])
                return false;
    return true;
}
