/* SPDX-License-Identifier: MIT
 *
 * Whether depth was filtered, as colour is. A renderer that averages the samples of a texel puts
 * surfaces between the silhouette of a thing and what lies behind it where there are none. Blur,
 * as of motion, of a lens or of an enlarged image, makes ramps of them. */
#include "gbuffer_internal.h"

#include <math.h>

/* A ramp is looked for so far to either side of where it is steepest. */
enum { FEW_EDGES = 40, REACH = 12 };

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

/* Five texels in a row, with something flat on either side of the one in the middle. */
static void look(struct edges *edges, const struct gbuffer *g, size_t texel, size_t axis)
{
    double d[5];
    for (size_t k = 0; k < 5; k++)
        d[k] = (double)g->depth[texel + k * axis - 2 * axis];
    const double step = d[3] - d[1], nearer = fmin(fabs(d[1]), fabs(d[3]));
    if (!(fabs(step) > 0.2 * nearer) || !isfinite(step) ||
        !(fabs(d[1] - d[0]) < 0.05 * fabs(step)) || !(fabs(d[4] - d[3]) < 0.05 * fabs(step)))
        return;
    const double place = (d[2] - d[1]) / step;
    if (place > 0.08 && place < 0.92)
        edges->filtered += !is_third(g, texel - axis, texel, texel + axis);
    else if (place > -0.08 && place < 1.08)
        edges->sharp++;
}

static double rise(const float *depth, size_t axis, ptrdiff_t step)
{
    return (double)depth[(step + 1) * (ptrdiff_t)axis] - (double)depth[step * (ptrdiff_t)axis];
}

/* Where depth rises most between this texel and the next, and how far up and down that goes on: all
 * in one step at a silhouette, and in steps that swell and abate where it is blurred. Faces seen
 * at a slant rise evenly and begin at once; round things begin slowly and end in a jump. */
static void look_wide(struct edges *edges, const struct gbuffer *g, size_t texel, size_t axis)
{
    const float *depth = g->depth + texel;
    const double most = rise(depth, axis, 0), sign = most < 0 ? -1.0 : 1.0;
    double sum = most, ends[2] = {most, most};
    ptrdiff_t length[2] = {0, 0};
    if (!isfinite(most) || !(fabs(most) > 0) || rise(depth, axis, -1) * sign > most * sign ||
        rise(depth, axis, 1) * sign >= most * sign)
        return;
    for (int side = 0; side < 2; side++) {
        const ptrdiff_t way = side ? 1 : -1;
        for (ptrdiff_t k = 1; k < REACH; k++) {
            const double r = rise(depth, axis, k * way);
            if (!isfinite(r) || r * sign < 0.05 * most * sign)
                break;
            sum += r;
            ends[side] = r;
            length[side] = k;
        }
        if (length[side] == REACH - 1)
            return; /* goes on */
    }
    const size_t left = texel - (size_t)length[0] * axis,
                 right = texel + (size_t)(length[1] + 1) * axis;
    const double nearer = fmin(fabs((double)g->depth[left]), fabs((double)g->depth[right]));
    if (!(fabs(sum) > 0.2 * nearer))
        return;
    if (most / sum > 0.7)
        edges->sharp++;
    else if (ends[0] / most < 0.6 && ends[1] / most < 0.6)
        edges->filtered += !is_third(g, left, texel, right);
}

static double share_of(const struct edges *edges, double sharp)
{
    const double all = (double)edges->filtered + sharp;
    return all >= FEW_EDGES ? (double)edges->filtered / all : 0;
}

double gbuffer_filtered_share(const struct gbuffer *g)
{
    struct edges narrow = {0}, wide[2] = {{0}};
    const size_t step[2] = {1, g->width}, size[2] = {g->width, g->height};
    for (size_t i = 0; i < gbuffer_texels(g); i++) {
        const size_t at[2] = {i % g->width, i / g->width};
        for (int axis = 0; axis < 2; axis++) {
            if (at[axis] >= 2 && at[axis] + 2 < size[axis])
                look(&narrow, g, i, step[axis]);
            if (at[axis] >= REACH && at[axis] + REACH < size[axis])
                look_wide(&wide[axis], g, i, step[axis]);
        }
    }
    /* A sharp edge is seen from the texels on both sides of it. Motion blurs one way. */
    const double share = share_of(&narrow, (double)narrow.sharp / 2.0);
    return fmax(share, fmax(share_of(&wide[0], (double)wide[0].sharp),
                            share_of(&wide[1], (double)wide[1].sharp)));
}
