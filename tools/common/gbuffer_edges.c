/* SPDX-License-Identifier: MIT
 *
 * Whether depth was filtered, as colour is. A renderer that averages the samples of a texel puts
 * surfaces between the silhouette of a thing and what lies behind it where there are none. Blur,
 * as of motion, of a lens or of an enlarged image, makes ramps of them. */
#include "gbuffer_internal.h"

#include <math.h>
#include <stdlib.h>

/* A ramp is looked for so far to either side of where it is steepest. */
enum { FEW_EDGES = 20, REACH = 24, SHORTEST_RAMP = 4, LONGEST_RAMP = 64 };

struct edges {
    size_t sharp, filtered;
};

static double cosine(const float *a, const float *b)
{
    return (double)a[0] * (double)b[0] + (double)a[1] * (double)b[1] + (double)a[2] * (double)b[2];
}

/* What stands between two things may be a third: it has a normal of its own then. */
static bool is_third(const struct gbuffer *g, size_t left, size_t middle, size_t right)
{
    if (!g->normals)
        return false;
    const float *m = g->normals + middle * 4;
    return cosine(m, m) > 0.9 && cosine(g->normals + left * 4, m) < 0.9 &&
           cosine(g->normals + right * 4, m) < 0.9;
}

/* Whatever was left in memory where nothing was drawn. Where alpha is 0 most renderers write one
 * value, and shadow catchers are surfaces. */
static bool has_rubbish(const struct gbuffer *g)
{
    static const double calm = 0.02;
    size_t pairs = 0, wild = 0;
    for (size_t i = 1; g->alpha && i < gbuffer_texels(g); i++) {
        if (g->alpha[i] > 0 || g->alpha[i - 1] > 0 || i % g->width == 0)
            continue;
        const double a = (double)g->depth[i - 1], b = (double)g->depth[i];
        pairs++;
        wild += a < b || a > b ? !(fabs(a - b) < calm * fmin(fabs(a), fabs(b))) : 0;
    }
    return 4 * wild > pairs;
}

/* Of five texels in a row, with something flat on either side of the one in the middle, where that
 * stands between the two: 0 to 1. */
static bool place_between(const struct gbuffer *g, size_t texel, size_t axis, double *place)
{
    double d[5];
    for (size_t k = 0; k < 5; k++)
        d[k] = (double)g->depth[texel + k * axis - 2 * axis];
    const double step = d[3] - d[1], nearer = fmin(fabs(d[1]), fabs(d[3]));
    *place = (d[2] - d[1]) / step;
    return fabs(step) > 0.2 * nearer && isfinite(step) && fabs(d[1] - d[0]) < 0.05 * fabs(step) &&
           fabs(d[4] - d[3]) < 0.05 * fabs(step);
}

/* What is the same in the line before is seen once: an edge that lies along the lines of the image
 * may be that of one narrow thing. */
static void look(struct edges *edges, struct edges *once, const struct gbuffer *g, size_t texel,
                 size_t axis, size_t across)
{
    double place, before;
    if (!place_between(g, texel, axis, &place))
        return;
    const bool is_seen = texel >= across + 2 * axis &&
                         place_between(g, texel - across, axis, &before) &&
                         fabs(place - before) < 0.02;
    if (place > 0.08 && place < 0.92) {
        const bool is_mean = !is_third(g, texel - axis, texel, texel + axis);
        edges->filtered += is_mean;
        once->filtered += is_mean && !is_seen;
    } else if (place > -0.08 && place < 1.08) {
        edges->sharp++;
        once->sharp += !is_seen;
    }
}

static double rise(const float *depth, size_t axis, ptrdiff_t step)
{
    return (double)depth[(step + 1) * (ptrdiff_t)axis] - (double)depth[step * (ptrdiff_t)axis];
}

/* How depth rises from the steepest step to one side. */
struct slope {
    ptrdiff_t length; /* steps until it hardly rises any more; 0: it goes on, or not smoothly */
    double sum, last;
};

static struct slope follow(const float *depth, size_t axis, ptrdiff_t way, double most)
{
    struct slope s = {0, 0, most};
    for (ptrdiff_t k = 1; k < REACH; k++) {
        const double r = rise(depth, axis, k * way);
        if (!isfinite(r) || r / most < 0.05)
            return s;
        /* Steps of stairs and rows of columns swell again. */
        if (fabs(r) > 1.05 * fabs(s.last))
            break;
        s = (struct slope){k, s.sum + r, r};
    }
    return (struct slope){0, 0, most};
}

/* Where depth rises most between this texel and the next, and how far up and down that goes on: all
 * in one step at a silhouette, and in steps that swell and abate alike where it is blurred. Faces
 * seen at a slant rise evenly and begin at once; round things begin slowly and end in a jump. */
static void look_wide(struct edges *edges, const struct gbuffer *g, size_t texel, size_t axis)
{
    const float *depth = g->depth + texel;
    const double most = rise(depth, axis, 0), sign = most < 0 ? -1.0 : 1.0;
    if (!isfinite(most) || !(fabs(most) > 0) || rise(depth, axis, -1) * sign > most * sign ||
        rise(depth, axis, 1) * sign >= most * sign)
        return;
    const struct slope up = follow(depth, axis, -1, most), down = follow(depth, axis, 1, most);
    const size_t left = texel - (size_t)up.length * axis,
                 right = texel + (size_t)(down.length + 1) * axis;
    const double nearer = fmin(fabs((double)g->depth[left]), fabs((double)g->depth[right]));
    const double sum = most + up.sum + down.sum;
    if (!(fabs(sum) > 0.2 * nearer))
        return;
    if (most / sum > 0.7)
        edges->sharp++;
    else if (up.length >= 2 && down.length >= 2 && up.last / most < 0.6 && down.last / most < 0.6 &&
             up.sum / down.sum < 1.6 && down.sum / up.sum < 1.6)
        edges->filtered += !is_third(g, left, texel, right);
}

/* Depth that was averaged along a line, as motion does, rises evenly between two things, and begins
 * and ends at once. So does a face that is seen at a slant: of that, 1/depth rises evenly. Returns
 * where the ramp ends that begins here, or here. */
static size_t look_along(struct edges *edges, const float *line, size_t axis, size_t begin,
                         size_t count)
{
    const double first = rise(line + begin * axis, axis, 0);
    const double before = rise(line + (begin - 1) * axis, axis, 0);
    size_t end = begin + 1;
    if (!isfinite(first) || !isfinite(before) || !(fabs(before) < 0.3 * fabs(first)))
        return begin;
    double after = 0;
    for (; end + 1 < count; end++) {
        after = rise(line + end * axis, axis, 0);
        if (!(fabs(after - first) < 0.15 * fabs(first)))
            break;
    }
    const double a = (double)line[begin * axis], b = (double)line[end * axis];
    const double nearer = fmin(fabs(a), fabs(b));
    if (!isfinite(after) || !(fabs(after) < 0.3 * fabs(first)) || !(fabs(b - a) > 0.2 * nearer))
        return begin;
    if (end - begin < SHORTEST_RAMP || end - begin > LONGEST_RAMP)
        return begin;
    const size_t middle = (begin + end) / 2;
    const double t = (double)(middle - begin) / (double)(end - begin);
    const double even = a + (b - a) * t, inverse = 1.0 / (1.0 / a + (1.0 / b - 1.0 / a) * t);
    /* 0: even in depth, 1: even in 1/depth. */
    const double bend = ((double)line[middle * axis] - even) / (inverse - even);
    edges->filtered += fabs(bend) < 0.3;
    edges->sharp += bend > 0.6;
    return end - 1;
}

/* No more than what is said, if so few of them may be more by chance. */
static double share_of(const struct edges *edges, double sharp)
{
    const double all = (double)edges->filtered + sharp;
    if (all < FEW_EDGES)
        return 0;
    const double share = (double)edges->filtered / all;
    return share - 2.0 / sqrt(all) > GBUFFER_MOST_FILTERED ? share
                                                           : fmin(share, GBUFFER_MOST_FILTERED);
}

/* Seen without perspective, or as 1/depth, faces rise evenly too. */
static double share_of_ramps(const struct gbuffer *g, size_t axis, size_t sharp)
{
    struct edges ramps = {.sharp = sharp};
    const size_t count = axis == 1 ? g->width : g->height, lines = gbuffer_texels(g) / count;
    const size_t next = axis == 1 ? g->width : 1;
    const bool is_distance = g->depth_type != DEPTH_INVERSE && g->depth_type != DEPTH_DEVICE;
    if (!g->camera.source[0] || g->camera.type != CAMERA_PERSPECTIVE || !is_distance)
        return 0;
    for (size_t line = 0; line < lines; line++)
        for (size_t i = 1; i + SHORTEST_RAMP + 1 < count; i++)
            i = look_along(&ramps, g->depth + line * next, axis, i, count);
    return share_of(&ramps, (double)ramps.sharp);
}

static double filtered_share(const struct gbuffer *g)
{
    struct edges narrow = {0}, once = {0}, wide[2] = {{0}};
    const size_t step[2] = {1, g->width}, size[2] = {g->width, g->height};
    for (size_t i = 0; i < gbuffer_texels(g); i++) {
        const size_t at[2] = {i % g->width, i / g->width};
        for (int axis = 0; axis < 2; axis++) {
            if (at[axis] >= 2 && at[axis] + 2 < size[axis])
                look(&narrow, &once, g, i, step[axis], step[!axis]);
            if (at[axis] >= REACH && at[axis] + REACH < size[axis])
                look_wide(&wide[axis], g, i, step[axis]);
        }
    }
    /* A sharp edge is seen from the texels on both sides of it. Motion blurs one way. */
    double share = fmin(share_of(&narrow, (double)narrow.sharp / 2.0),
                        share_of(&once, (double)once.sharp / 2.0));
    for (int axis = 0; axis < 2; axis++) {
        share = fmax(share, share_of(&wide[axis], (double)wide[axis].sharp));
        share = fmax(share, share_of_ramps(g, step[axis], wide[axis].sharp));
    }
    return share;
}

double gbuffer_filtered_share(const struct gbuffer *g)
{
    struct gbuffer other = *g;
    if (!has_rubbish(g))
        return filtered_share(g);
    other.depth = malloc(gbuffer_texels(g) * sizeof *other.depth);
    if (!other.depth)
        return 0;
    for (size_t i = 0; i < gbuffer_texels(g); i++)
        other.depth[i] = g->alpha[i] > 0 ? g->depth[i] : NAN;
    const double share = filtered_share(&other);
    free(other.depth);
    return share;
}
