/* SPDX-License-Identifier: MIT
 *
 * Whether single things have normals that are not those of their depth: what is left in the space
 * of an object, what was turned from one pass to the other, what is transparent to one of the two.
 * All else agrees, so no camera and no space is wrong. Normals of such a thing are those of its
 * depth turned by one rotation, or they are across what depth shows. Normals that are interpolated
 * over the faces of a coarse mesh, or that a map bends, are neither: they are turned every way, and
 * the less the larger the part that one looks at.
 */
#include "gbuffer_internal.h"
#include "text.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>

enum { MOST_NODES = 1 << 16, NO_REGION = -1 };

/* The cosine of 70 degrees: no map turns normals by more, on the whole. */
static const double most_turned = 0.34;

/* A texel of those that are looked at, where depth is smooth; view space. */
struct node {
    bool is_known;
    int32_t region;
    float z, ray[2], depth[3], stored[3]; /* stored: turned round if it is the other way */
};

/* Every step-th texel of every step-th row. */
struct lattice {
    struct node *nodes;
    int32_t *queue; /* of a region, all of it once that is found */
    ptrdiff_t columns, rows, step;
    double width; /* from one to the next, at distance 1 unless orthographic */
    size_t known, agreeing;
};

/* Of normals that go on from node to node, on surfaces that do. */
struct region {
    size_t nodes, deep;     /* deep: well inside */
    size_t borders, breaks; /* to other nodes, and those where depth goes on as it does within */
    double products[3][3];  /* of the normals of depth with the stored ones, summed */
    double cosines, x, y;
};

static double dot(const float a[3], const float b[3])
{
    return (double)a[0] * (double)b[0] + (double)a[1] * (double)b[1] + (double)a[2] * (double)b[2];
}

/* --- Nodes --- */

static struct node node_at(const struct gbuffer *g, size_t texel)
{
    static const double unit = 0.1;
    struct node n = {.region = NO_REGION};
    double depth[3], stored[3], x, y;
    const double length = gbuffer_length(g->normals + texel * 4);
    if (!(fabs(length - 1.0) < unit) || !gbuffer_smooth_normal(g, texel, depth))
        return n;
    gbuffer_view_normal(g, texel, stored);
    const double cosine = depth[0] * stored[0] + depth[1] * stored[1] + depth[2] * stored[2];
    camera_ray(&g->camera, &g->display_window, &g->data_window, (double)(texel % g->width),
               (double)(texel / g->width), &x, &y);
    n.is_known = true;
    n.z = (float)gbuffer_view_z(g, g->depth[texel], texel);
    n.ray[0] = (float)x;
    n.ray[1] = (float)y;
    for (int c = 0; c < 3; c++) {
        n.depth[c] = (float)depth[c];
        n.stored[c] = (float)(stored[c] / (cosine < -most_turned * length ? -length : length));
    }
    return n;
}

static bool build(const struct gbuffer *g, struct lattice *l)
{
    static const double same = 0.99; /* 8 degrees */
    double x[2], y[2];
    l->step = (ptrdiff_t)ceil(sqrt((double)gbuffer_texels(g) / MOST_NODES));
    l->columns = (ptrdiff_t)g->width / l->step;
    l->rows = (ptrdiff_t)g->height / l->step;
    const size_t count = (size_t)l->columns * (size_t)l->rows;
    l->nodes = malloc((count + 1) * sizeof *l->nodes);
    l->queue = malloc((count + 1) * sizeof *l->queue);
    if (!l->nodes || !l->queue)
        return false;
    camera_ray(&g->camera, &g->display_window, &g->data_window, 0, 0, &x[0], &y[0]);
    camera_ray(&g->camera, &g->display_window, &g->data_window, (double)l->step, 0, &x[1], &y[1]);
    l->width = fabs(x[1] - x[0]);
    for (size_t i = 0; i < count; i++) {
        const size_t column = i % (size_t)l->columns, row = i / (size_t)l->columns;
        l->nodes[i] = node_at(g, (row * g->width + column) * (size_t)l->step);
        l->known += l->nodes[i].is_known;
        l->agreeing += l->nodes[i].is_known && dot(l->nodes[i].depth, l->nodes[i].stored) > same;
    }
    return true;
}

/* --- Regions --- */

/* How far one lies beside the plane of the other, along the view axis. */
static double miss(const struct gbuffer *g, const struct node *plane, const struct node *n)
{
    const float *d = plane->depth, *a = plane->ray, *b = n->ray;
    const double slope[2] = {(double)d[0] * (double)a[0] + (double)d[1] * (double)a[1],
                             (double)d[0] * (double)b[0] + (double)d[1] * (double)b[1]};
    const double z = (double)plane->z, facing = (double)d[2];
    const double expected = g->camera.type == CAMERA_ORTHOGRAPHIC
                                ? z + (slope[1] - slope[0]) / facing
                                : z * (facing - slope[0]) / (facing - slope[1]);
    return fabs(expected - (double)n->z);
}

enum link { APART, TOUCHING, ON_ONE_PLANE };

static enum link link_of(const struct gbuffer *g, const struct lattice *l, const struct node *a,
                         const struct node *b)
{
    static const double edge = 2.0, flat = 0.25; /* widths from node to node */
    static const double same = 0.995;            /* 6 degrees */
    const bool is_parallel = g->camera.type == CAMERA_ORTHOGRAPHIC;
    const double width = l->width * (is_parallel ? 1.0 : fmin((double)a->z, (double)b->z));
    const double one = miss(g, a, b), other = miss(g, b, a);
    if (!(fmin(one, other) < edge * width))
        return APART;
    return fmax(one, other) < flat * width && dot(a->depth, b->depth) > same ? ON_ONE_PLANE
                                                                             : TOUCHING;
}

static void add_node(struct region *r, const struct node *n, ptrdiff_t x, ptrdiff_t y)
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            r->products[i][j] += (double)n->depth[i] * (double)n->stored[j];
    r->nodes++;
    r->cosines += dot(n->depth, n->stored);
    r->x += (double)x;
    r->y += (double)y;
}

/* Whether the neighbour is of the same region; where it is not, the border is counted. */
static bool goes_on(const struct gbuffer *g, const struct lattice *l, const struct node *n,
                    const struct node *to, struct region *r)
{
    static const double alike = 0.985; /* 10 degrees */
    const enum link link = to->is_known ? link_of(g, l, n, to) : APART;
    if (link != APART && dot(n->stored, to->stored) > alike)
        return true;
    r->borders++;
    r->breaks += link == ON_ONE_PLANE;
    return false;
}

static bool is_of_region(const struct lattice *l, ptrdiff_t x, ptrdiff_t y, int32_t region)
{
    return x >= 0 && y >= 0 && x < l->columns && y < l->rows &&
           l->nodes[y * l->columns + x].region == region;
}

static size_t count_deep(const struct lattice *l, size_t count, int32_t region)
{
    static const double share = 0.03; /* of the height, from the border */
    const ptrdiff_t far = (ptrdiff_t)(share * (double)l->rows) + 1;
    size_t deep = 0;
    for (size_t i = 0; i < count; i++) {
        const ptrdiff_t x = l->queue[i] % l->columns, y = l->queue[i] / l->columns;
        bool is_deep = true;
        for (int k = 0; k < 9; k++)
            is_deep &= is_of_region(l, x + (k % 3 - 1) * far, y + (k / 3 - 1) * far, region);
        deep += is_deep;
    }
    return deep;
}

static struct region grow(const struct gbuffer *g, struct lattice *l, ptrdiff_t seed,
                          int32_t region)
{
    static const ptrdiff_t across[4] = {-1, 1, 0, 0}, down[4] = {0, 0, -1, 1};
    struct region r = {0};
    size_t count = 0;
    l->queue[count++] = (int32_t)seed;
    l->nodes[seed].region = region;
    for (size_t head = 0; head < count; head++) {
        const struct node *n = &l->nodes[l->queue[head]];
        const ptrdiff_t x = l->queue[head] % l->columns, y = l->queue[head] / l->columns;
        add_node(&r, n, x, y);
        for (int k = 0; k < 4; k++) {
            const ptrdiff_t to_x = x + across[k], to_y = y + down[k];
            if (to_x < 0 || to_y < 0 || to_x >= l->columns || to_y >= l->rows)
                continue;
            const ptrdiff_t to = to_y * l->columns + to_x;
            if (!goes_on(g, l, n, &l->nodes[to], &r) || l->nodes[to].region != NO_REGION)
                continue;
            l->nodes[to].region = region;
            l->queue[count++] = (int32_t)to;
        }
    }
    r.deep = count_deep(l, count, region);
    return r;
}

/* --- What is wrong --- */

/* The mean cosine that is left once normals of depth are turned to the stored ones as well as one
 * rotation can: the largest eigenvalue of Horn's matrix (Closed-form solution of absolute
 * orientation using unit quaternions, JOSA A 4(4), 1987), by its powers. */
static double best_cosine(const struct region *r)
{
    enum { ROUNDS = 100 };
    const double(*p)[3] = r->products, all = (double)r->nodes;
    const double m[4][4] = {
        {p[0][0] + p[1][1] + p[2][2], p[1][2] - p[2][1], p[2][0] - p[0][2], p[0][1] - p[1][0]},
        {p[1][2] - p[2][1], p[0][0] - p[1][1] - p[2][2], p[0][1] + p[1][0], p[2][0] + p[0][2]},
        {p[2][0] - p[0][2], p[0][1] + p[1][0], p[1][1] - p[0][0] - p[2][2], p[1][2] + p[2][1]},
        {p[0][1] - p[1][0], p[2][0] + p[0][2], p[1][2] + p[2][1], p[2][2] - p[0][0] - p[1][1]}};
    double q[4] = {1.0, 0.1, 0.2, 0.3}, length = 1;
    for (int round = 0; round < ROUNDS; round++) {
        double next[4], square = 0;
        for (int i = 0; i < 4; i++) {
            next[i] = all * q[i]; /* no eigenvalue is below -all */
            for (int j = 0; j < 4; j++)
                next[i] += m[i][j] * q[j];
            square += next[i] * next[i];
        }
        length = sqrt(square);
        for (int i = 0; i < 4; i++)
            q[i] = next[i] / length;
    }
    return length / all - 1.0;
}

/* Root mean square distance of unit vectors, nearly an angle. */
static double distance_of(double mean_cosine)
{
    return sqrt(2.0 * fmax(1.0 - mean_cosine, 0));
}

/* Of clean renders, with bumps and of coarse meshes that are shaded smoothly, one rotation leaves a
 * quarter of the distance, and mostly all of it; faces that a map bends have others on the same
 * plane beside them. Chosen by hand on three ray-traced scenes with things of other normals; of 192
 * other views and a hundred coarse, bumped or bent ones none is said. */
static bool is_strange(const struct lattice *l, const struct region *r)
{
    static const double least_share = 0.008, least_distance = 0.19, most_left = 0.04;
    enum { FEW_DEEP = 30 };
    const double mean = r->cosines / (double)r->nodes, distance = distance_of(mean);
    if ((double)r->nodes < least_share * (double)(l->columns * l->rows) || r->deep < FEW_DEEP ||
        distance < least_distance)
        return false;
    const double left = distance_of(best_cosine(r));
    return left < most_left &&
           (mean < most_turned || (left < distance / 6.0 && r->breaks * 5 < r->borders));
}

struct strangers {
    size_t nodes;
    double cosines;
    struct region largest;
};

static struct strangers find(const struct gbuffer *g, struct lattice *l)
{
    struct strangers s = {0};
    int32_t regions = 0;
    for (ptrdiff_t i = 0; i < l->columns * l->rows; i++) {
        if (!l->nodes[i].is_known || l->nodes[i].region != NO_REGION)
            continue;
        const struct region r = grow(g, l, i, regions++);
        if (!is_strange(l, &r))
            continue;
        s.nodes += r.nodes;
        s.cosines += r.cosines;
        if (r.nodes > s.largest.nodes)
            s.largest = r;
    }
    return s;
}

static void warn(const struct gbuffer *g, const struct lattice *l, const struct strangers *s,
                 const char *path, struct report *report)
{
    static const double degrees = 57.29577951308232;
    const double count = (double)s->largest.nodes;
    const int64_t x = (int64_t)(s->largest.x / count * (double)l->step);
    const int64_t y = (int64_t)(s->largest.y / count * (double)l->step);
    char share[PERCENT_BYTES];
    text_percent(share, (double)s->nodes / (double)(l->columns * l->rows));
    report_warn(report, "strange normals",
                "%s: normals '%s' and depth disagree on %s of the image by %.0f degrees, on most "
                "of it around (%td %td), and agree elsewhere: something turned, moved, transparent "
                "or in a space of its own? AO is wrong there; write both of the same surfaces",
                path, g->roles.kind[ROLE_NORMAL].label, share,
                acos(s->cosines / (double)s->nodes) * degrees,
                (ptrdiff_t)(g->data_window.x_min + x), (ptrdiff_t)(g->data_window.y_min + y));
}

/* Where less agrees, camera or space are wrong, or nothing is sure. */
bool gbuffer_warn_of_strangers(const struct gbuffer *g, const char *path, struct report *report)
{
    static const double most_agree = 0.6;
    struct lattice l = {0};
    bool ok = true;
    if (!g->normals || g->block_size > 1 || g->depth_step > 0 || g->is_camera_doubted)
        return true;
    ok = build(g, &l);
    if (ok && (double)l.agreeing > most_agree * (double)l.known) {
        const struct strangers s = find(g, &l);
        if (s.nodes > 0)
            warn(g, &l, &s, path, report);
    }
    free(l.nodes);
    free(l.queue);
    return ok;
}
