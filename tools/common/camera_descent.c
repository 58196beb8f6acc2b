/* SPDX-License-Identifier: MIT
 *
 * Models of depth held against the stored normals. The residual is e = n x q, n by the depth, q the
 * stored normal turned into view space, either way round: the sine of the angle between them. Its
 * weight is that of Geman and McClure, (sigma^2 / (e^2 + sigma^2))^2. */
#include "camera_fit_internal.h"

#include <string.h>

/* --- Rotations --- */

/* a = u diag(s) v^T of 3 x 3 by one-sided Jacobi rotations; s descends, u and v are orthogonal. */
static void decompose(const double a[3][3], struct vec3 u[3], double s[3], struct vec3 v[3])
{
    struct vec3 column[3];
    for (int i = 0; i < 3; i++) {
        column[i] = vec3(a[0][i], a[1][i], a[2][i]);
        v[i] = vec3(i == 0, i == 1, i == 2);
    }
    for (int sweep = 0; sweep < 30; sweep++) {
        double off = 0;
        for (int i = 0; i < 2; i++)
            for (int j = i + 1; j < 3; j++) {
                const double p = dot(column[i], column[i]), q = dot(column[j], column[j]);
                const double r = dot(column[i], column[j]);
                if (!(fabs(r) > 1e-15 * sqrt(p * q)))
                    continue;
                off = fmax(off, fabs(r) / sqrt(p * q));
                const double tau = (q - p) / (2.0 * r);
                const double t = copysign(1.0, tau) / (fabs(tau) + sqrt(1.0 + tau * tau));
                const double c = 1.0 / sqrt(1.0 + t * t), sine = c * t;
                struct vec3 *const pairs[2][2] = {{&column[i], &column[j]}, {&v[i], &v[j]}};
                for (int k = 0; k < 2; k++) {
                    const struct vec3 first = *pairs[k][0], second = *pairs[k][1];
                    *pairs[k][0] = sub(scale(first, c), scale(second, sine));
                    *pairs[k][1] = mad(second, c, scale(first, sine));
                }
            }
        if (off < 1e-14)
            break;
    }
    for (int i = 0; i < 3; i++)
        s[i] = length(column[i]);
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2 - i; j++)
            if (s[j] < s[j + 1]) {
                const struct vec3 x = column[j], y = v[j];
                const double size = s[j];
                column[j] = column[j + 1], v[j] = v[j + 1], s[j] = s[j + 1];
                column[j + 1] = x, v[j + 1] = y, s[j + 1] = size;
            }
    u[0] = s[0] > 0 ? scale(column[0], 1.0 / s[0]) : vec3(1, 0, 0);
    u[1] = s[1] > 1e-9 * s[0] ? scale(column[1], 1.0 / s[1]) : mat3_around(u[0]).x;
    /* What the data leave open makes no mirror. */
    const double side = dot(cross(v[0], v[1]), v[2]);
    u[2] = s[2] > 1e-9 * s[0] ? scale(column[2], 1.0 / s[2]) : scale(cross(u[0], u[1]), side);
}

/* The orthogonal matrix nearest to b (Wahba's problem); mirrors too. */
static struct mat3 nearest_rotation(const double b[3][3])
{
    struct vec3 u[3], v[3], row[3];
    double s[3];
    decompose(b, u, s, v);
    for (int i = 0; i < 3; i++) {
        row[i] = vec3(0, 0, 0);
        for (int k = 0; k < 3; k++) {
            const double component = i == 0 ? u[k].x : i == 1 ? u[k].y : u[k].z;
            row[i] = mad(v[k], component, row[i]);
        }
    }
    return (struct mat3){row[0], row[1], row[2]};
}

static void add_outer(double b[3][3], struct vec3 n, struct vec3 m, double weight)
{
    const double left[3] = {n.x * weight, n.y * weight, n.z * weight};
    for (int i = 0; i < 3; i++) {
        b[i][0] += left[i] * m.x;
        b[i][1] += left[i] * m.y;
        b[i][2] += left[i] * m.z;
    }
}

static double robust_weight(double e2, double sigma)
{
    const double s2 = sigma * sigma, r = s2 / (e2 + s2);
    return r * r;
}

const struct fit_residual *fit_find_residuals(const struct fit_samples *s,
                                              const struct fit_solution *at)
{
    fit_find_normals(s, at, s->normals);
    for (size_t i = 0; i < s->count; i++) {
        /* 1 - cos^2 would lose all the digits of small angles. */
        const struct vec3 n = s->normals[i], q = mul_mat(at->rotation, s->list[i].m);
        const struct vec3 e = cross(n, q);
        s->residuals[i] = (struct fit_residual){.e2 = dot(e, e), .cosine = dot(n, q)};
    }
    return s->residuals;
}

static void improve_rotation(const struct fit_samples *s, double sigma, struct mat3 *rotation)
{
    double b[3][3] = {{0}};
    for (size_t i = 0; i < s->count; i++) {
        const struct fit_sample *p = &s->list[i];
        const struct vec3 n = s->normals[i], q = mul_mat(*rotation, p->m), e = cross(n, q);
        const double sign = dot(n, q) < 0 ? -1.0 : 1.0;
        add_outer(b, n, p->m, sign * p->weight * robust_weight(dot(e, e), sigma));
    }
    *rotation = nearest_rotation((const double(*)[3])b);
}

/* At each of the scales twice. */
static void improve_at_scales(const struct fit_samples *s, const double *sigmas, size_t count,
                              struct mat3 *rotation)
{
    for (size_t i = 0; i < 2 * count; i++)
        improve_rotation(s, sigmas[i / 2], rotation);
}

struct mat3 fit_improve_rotation(const struct fit_samples *s, const struct fit_solution *at,
                                 const double *sigmas, size_t count)
{
    struct mat3 rotation = at->rotation;
    fit_find_normals(s, at, s->normals);
    improve_at_scales(s, sigmas, count, &rotation);
    return rotation;
}

struct mat3 fit_start_rotation(const struct fit_samples *s, const struct fit_solution *at)
{
    static const double sigmas[] = {0.5, 0.25, 0.12, 0.06};
    double b[3][3] = {{0}};
    fit_find_normals(s, at, s->normals);
    for (size_t i = 0; i < s->count; i++)
        add_outer(b, s->normals[i], s->list[i].m, s->list[i].weight);
    struct mat3 rotation = nearest_rotation((const double(*)[3])b);
    improve_at_scales(s, sigmas, sizeof sigmas / sizeof *sigmas, &rotation);
    return rotation;
}

void fit_directions(const struct fit_samples *s, const struct fit_solution *at, double values[3],
                    struct vec3 *weakest)
{
    double b[3][3] = {{0}}, of_depth[3][3] = {{0}};
    struct vec3 u[3], v[3];
    const struct fit_residual *residuals = fit_find_residuals(s, at);
    for (size_t i = 0; i < s->count; i++) {
        const double weight = s->list[i].weight * robust_weight(residuals[i].e2, at->sigma);
        const struct vec3 n = s->normals[i];
        add_outer(b, n, s->list[i].m, residuals[i].cosine < 0 ? -weight : weight);
        add_outer(of_depth, n, n, weight);
    }
    decompose((const double(*)[3])of_depth, u, values, v);
    *weakest = u[2];
    decompose((const double(*)[3])b, u, values, v);
    const double sum = fmax(values[0] + values[1] + values[2], 1e-30);
    for (int i = 0; i < 3; i++)
        values[i] /= sum;
}

bool fit_has_directions(const struct fit_samples *s, const struct fit_solution *at,
                        struct vec3 *weakest)
{
    static const double least_beside = 0.035; /* share of them: of fewer no rotation is told */
    double values[3];
    fit_directions(s, at, values, weakest);
    return values[1] > least_beside;
}

/* --- Descent --- */

double fit_cost(const struct fit_samples *s, const struct fit_solution *at, double sigma)
{
    const struct fit_residual *residuals = fit_find_residuals(s, at);
    double sum = 0;
    for (size_t i = 0; i < s->count; i++) {
        const double e2 = residuals[i].e2;
        sum += s->list[i].weight * e2 / (e2 + sigma * sigma);
    }
    return sum / s->total_weight;
}

/* Normal equations at a solution. */
struct equations {
    int count;                /* of unknowns: three of the rotation, and what is free of p */
    int parameter[FIT_SHAPE]; /* which of p */
    double matrix[FIT_PARAMETERS][FIT_PARAMETERS], gradient[FIT_PARAMETERS];
    double weight, error; /* of all samples: sums, the second of squares */
    double curvature;     /* of the robust cost, against that of least squares: (0,1] */
};

/* The gradient by groups of samples, whose errors hang together. */
struct gradients {
    double by_tile[FIT_TILES][FIT_PARAMETERS], by_cell[FIT_CELLS][FIT_PARAMETERS];
};

static const double moved_by = 1e-5;

/* Normals as a little more of each unknown in p makes them: rows, behind those at the solution. */
static void find_moved_normals(const struct fit_samples *s, const struct fit_solution *at,
                               const struct equations *eq)
{
    for (int i = 0; i < eq->count - 3; i++) {
        struct fit_solution moved = *at;
        moved.p[eq->parameter[i]] += moved_by;
        fit_find_normals(s, &moved, s->normals + (size_t)(i + 1) * s->count);
    }
}

/* de of the i-th sample for each unknown. A turn by w: d(n x q) = n x (w x q) = w (n.q) - q (n.w).
 */
static void differentiate(const struct fit_samples *s, size_t i, int count, struct vec3 q,
                          struct vec3 *de)
{
    const struct vec3 n = s->normals[i];
    const double nq = dot(n, q);
    de[0] = sub(vec3(nq, 0, 0), scale(q, n.x));
    de[1] = sub(vec3(0, nq, 0), scale(q, n.y));
    de[2] = sub(vec3(0, 0, nq), scale(q, n.z));
    for (int a = 3; a < count; a++) {
        const struct vec3 moved = s->normals[(size_t)(a - 2) * s->count + i];
        de[a] = cross(scale(sub(moved, n), 1.0 / moved_by), q);
    }
}

/* The normals at the solution are those of the last question. groups: NULL, or wanted too. */
static void linearise(const struct fit_samples *s, const struct fit_solution *at, double sigma,
                      struct equations *eq, struct gradients *groups)
{
    const double s2 = sigma * sigma;
    double slope = 0, bend = 0;
    memset(eq, 0, sizeof *eq);
    if (groups)
        memset(groups, 0, sizeof *groups);
    eq->count = 3;
    for (int i = 0; i < FIT_SHAPE; i++)
        if (at->free[i])
            eq->parameter[eq->count++ - 3] = i;
    find_moved_normals(s, at, eq);
    for (size_t i = 0; i < s->count; i++) {
        const struct fit_sample *sample = &s->list[i];
        const struct vec3 n = s->normals[i];
        struct vec3 q = mul_mat(at->rotation, sample->m), de[FIT_PARAMETERS];
        if (dot(n, q) < 0)
            q = scale(q, -1.0);
        const struct vec3 e = cross(n, q);
        const double e2 = dot(e, e), weight = sample->weight * robust_weight(e2, sigma);
        slope += weight;
        eq->error += weight * e2;
        bend += weight * (s2 - 3.0 * e2) / (e2 + s2);
        differentiate(s, i, eq->count, q, de);
        for (int a = 0; a < eq->count; a++) {
            const struct vec3 weighted = scale(de[a], weight);
            const double score = dot(weighted, e);
            eq->gradient[a] += score;
            if (groups) {
                groups->by_tile[sample->tile][a] += score;
                groups->by_cell[sample->cell][a] += score;
            }
            for (int b = 0; b <= a; b++)
                eq->matrix[a][b] += dot(weighted, de[b]);
        }
    }
    for (int a = 0; a < eq->count; a++)
        for (int b = 0; b < a; b++)
            eq->matrix[b][a] = eq->matrix[a][b];
    eq->weight = slope;
    eq->curvature = fmin(fmax(bend / fmax(slope, 1e-300), 0.2), 1.0);
}

/* Cholesky, with a little on the diagonal so that there is a solution. */
static void factorise(const struct equations *eq, double factor, double damping,
                      double l[FIT_PARAMETERS][FIT_PARAMETERS])
{
    double trace = 0;
    for (int i = 0; i < eq->count; i++)
        trace += eq->matrix[i][i] * factor;
    for (int i = 0; i < eq->count; i++)
        for (int j = 0; j <= i; j++) {
            double sum = eq->matrix[i][j] * factor;
            if (i == j)
                sum += damping * sum + 1e-12 * trace + 1e-300;
            for (int k = 0; k < j; k++)
                sum -= l[i][k] * l[j][k];
            l[i][j] = i == j ? sqrt(fmax(sum, 1e-14 * trace + 1e-300)) : sum / l[j][j];
        }
}

static void substitute(int count, double l[FIT_PARAMETERS][FIT_PARAMETERS], double *x)
{
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < i; k++)
            x[i] -= l[i][k] * x[k];
        x[i] /= l[i][i];
    }
    for (int i = count - 1; i >= 0; i--) {
        for (int k = i + 1; k < count; k++)
            x[i] -= l[k][i] * x[k];
        x[i] /= l[i][i];
    }
}

/* Rodrigues: the turn by a rotation vector. */
static struct mat3 turned(struct mat3 m, struct vec3 by)
{
    const double angle = length(by);
    const double a = angle > 1e-9 ? sin(angle) / angle : 1.0;
    const double b = angle > 1e-9 ? (1.0 - cos(angle)) / (angle * angle) : 0.5;
    struct vec3 columns[3] = {vec3(m.x.x, m.y.x, m.z.x), vec3(m.x.y, m.y.y, m.z.y),
                              vec3(m.x.z, m.y.z, m.z.z)};
    for (int i = 0; i < 3; i++) {
        const struct vec3 once = cross(by, columns[i]);
        columns[i] = mad(once, a, mad(cross(by, once), b, columns[i]));
    }
    return (struct mat3){vec3(columns[0].x, columns[1].x, columns[2].x),
                         vec3(columns[0].y, columns[1].y, columns[2].y),
                         vec3(columns[0].z, columns[1].z, columns[2].z)};
}

static struct fit_solution stepped(const struct fit_samples *s, const struct fit_solution *at,
                                   const struct equations *eq, double damping)
{
    struct fit_solution next = *at;
    double step[FIT_PARAMETERS], l[FIT_PARAMETERS][FIT_PARAMETERS], low, high;
    for (int i = 0; i < eq->count; i++)
        step[i] = -eq->gradient[i];
    factorise(eq, 1.0, damping, l);
    substitute(eq->count, l, step);
    for (int i = 0; i < eq->count; i++)
        step[i] = fmin(fmax(step[i], -0.5), 0.5);
    next.rotation = turned(at->rotation, vec3(step[0], step[1], step[2]));
    for (int i = 3; i < eq->count; i++)
        next.p[eq->parameter[i - 3]] += step[i];
    fit_model_range(s, at->model, &low, &high);
    if (at->free[FIT_LN_K])
        next.p[FIT_LN_K] = fmin(fmax(next.p[FIT_LN_K], low), high);
    return next;
}

void fit_descend(const struct fit_samples *s, struct fit_solution *at, double sigma, double enough)
{
    enum { ROUNDS = 12 };
    double damping = 1e-3;
    at->cost = fit_cost(s, at, sigma);
    for (int round = 0; round < ROUNDS; round++) {
        struct equations eq;
        bool better = false, done = true;
        linearise(s, at, sigma, &eq, NULL);
        for (int attempt = 0; attempt < 6 && !better; attempt++) {
            struct fit_solution next = stepped(s, at, &eq, damping);
            next.cost = fit_cost(s, &next, sigma);
            better = next.cost < at->cost;
            done = !better || at->cost - next.cost < enough * fmax(at->cost, 1e-9);
            damping = better ? fmax(damping * 0.2, 1e-9) : damping * 10.0;
            if (better)
                *at = next;
        }
        if (done)
            break;
    }
}

/* The variances of what the scores by groups would have moved: errors of a group are one. l: the
 * factor of the matrix. */
static void sandwich(const struct equations *eq, double l[FIT_PARAMETERS][FIT_PARAMETERS],
                     const double (*groups)[FIT_PARAMETERS], size_t group_count,
                     double variance[FIT_PARAMETERS])
{
    size_t used = 0;
    memset(variance, 0, FIT_PARAMETERS * sizeof *variance);
    for (size_t g = 0; g < group_count; g++) {
        double moved[FIT_PARAMETERS];
        bool any = false;
        memcpy(moved, groups[g], sizeof moved);
        for (int i = 0; i < eq->count; i++)
            any |= fabs(moved[i]) > 0;
        if (!any)
            continue;
        used++;
        substitute(eq->count, l, moved);
        for (int i = 0; i < eq->count; i++)
            variance[i] += moved[i] * moved[i];
    }
    for (int i = 0; i < eq->count; i++)
        variance[i] *= (double)used / (double)(used > 1 ? used - 1 : 1);
}

static void find_deviations(const struct fit_samples *s, struct fit_solution *at)
{
    struct equations eq;
    struct gradients groups;
    double l[FIT_PARAMETERS][FIT_PARAMETERS], tiles[FIT_PARAMETERS], cells[FIT_PARAMETERS];
    linearise(s, at, at->sigma, &eq, &groups);
    factorise(&eq, eq.curvature, 0, l);
    sandwich(&eq, l, (const double(*)[FIT_PARAMETERS])groups.by_tile, FIT_TILES, tiles);
    sandwich(&eq, l, (const double(*)[FIT_PARAMETERS])groups.by_cell, FIT_CELLS, cells);
    const int decisive = eq.count > 3 ? 3 : 2;
    const double *variance = tiles[decisive] > cells[decisive] ? tiles : cells;
    memset(at->deviation, 0, sizeof at->deviation);
    for (int i = 3; i < eq.count; i++)
        at->deviation[eq.parameter[i - 3]] = sqrt(variance[i]);
    at->rotation_deviation = sqrt(variance[0] + variance[1] + variance[2]) * 180.0 / PI;
}

double fit_sensitivity(const struct fit_samples *s, const struct fit_solution *at)
{
    enum { LN_K = 3 }; /* behind the rotation */
    struct fit_solution t = *at;
    struct equations eq;
    double l[FIT_PARAMETERS][FIT_PARAMETERS], moved[FIT_PARAMETERS] = {0};
    t.free[FIT_LN_K] = true;
    fit_find_normals(s, &t, s->normals);
    linearise(s, &t, fmax(t.sigma, 1e-3), &eq, NULL);
    factorise(&eq, 1.0, 0, l);
    moved[LN_K] = 1.0;
    substitute(eq.count, l, moved);
    /* A normal of depth that is square to the view but for its error turns by as much. */
    const double turn2 = 1.0 / fmax(moved[LN_K], 1e-30) - eq.error;
    return sqrt(fmax(turn2 / fmax(eq.weight, 1e-300), 0));
}

void fit_refine(const struct fit_samples *s, struct fit_solution *at, double sigma)
{
    double inliers = 0;
    fit_descend(s, at, sigma, FIT_FULLY);
    at->sigma = sigma;
    memset(at->tile_cost, 0, sizeof at->tile_cost);
    const struct fit_residual *residuals = fit_find_residuals(s, at);
    for (size_t i = 0; i < s->count; i++) {
        const struct fit_sample *sample = &s->list[i];
        const double e2 = residuals[i].e2;
        at->tile_cost[sample->tile] += sample->weight * e2 / (e2 + sigma * sigma) / s->total_weight;
        inliers += sample->weight * robust_weight(e2, sigma);
    }
    at->inlier_weight = inliers / s->total_weight;
    find_deviations(s, at);
}

struct fit_solution fit_refined(const struct fit_samples *s, const struct fit_solution *from,
                                double sigma)
{
    struct fit_solution t = *from;
    fit_refine(s, &t, sigma);
    return t;
}

double fit_paired_z(const struct fit_solution *better, const struct fit_solution *worse)
{
    double sum = 0, squares = 0;
    for (int i = 0; i < FIT_TILES; i++) {
        const double d = worse->tile_cost[i] - better->tile_cost[i];
        sum += d;
        squares += d * d;
    }
    const double spread = (squares - sum * sum / FIT_TILES) * FIT_TILES / (FIT_TILES - 1.0);
    return sum / sqrt(fmax(spread, 1e-24));
}
