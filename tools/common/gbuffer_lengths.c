/* SPDX-License-Identifier: MIT
 *
 * Whether a matrix was applied to normals, as transforms of colours apply one to all that is not
 * said to be data. Vectors of one length are all on a sphere, and a matrix makes an ellipsoid of
 * it: their lengths vary with their directions, and with nothing else. Normals of filters are of
 * all lengths, and those of other programs of one. */
#include "gbuffer_internal.h"

#include <math.h>
#include <string.h>

enum { CELLS = 8, TERMS = 6 };

struct cells {
    size_t count[CELLS * CELLS * CELLS];
};

/* The terms of a quadric about the origin. */
static void terms_of(const float *n, double t[TERMS])
{
    const double x = (double)n[0], y = (double)n[1], z = (double)n[2];
    const double terms[TERMS] = {x * x, y * y, z * z, 2.0 * y * z, 2.0 * x * z, 2.0 * x * y};
    memcpy(t, terms, sizeof terms);
}

/* Of a direction; that which is opposite has the same. */
static size_t cell_of(const float *n, double length)
{
    const double most = fabs((double)n[0]) > 1e-3 * length   ? (double)n[0]
                        : fabs((double)n[1]) > 1e-3 * length ? (double)n[1]
                                                             : (double)n[2];
    const double by = (most < 0 ? -0.5 : 0.5) / length;
    size_t cell = 0;
    for (int c = 0; c < 3; c++) {
        const int at = (int)(((double)n[c] * by + 0.5) * CELLS);
        cell = cell * CELLS + (size_t)(at < 0 ? 0 : at >= CELLS ? CELLS - 1 : at);
    }
    return cell;
}

/* Large flat things have many normals that all say the same. */
static double weight_of(const struct cells *cells, const float *n)
{
    enum { FEW = 4 };
    const double length = gbuffer_length(n);
    const size_t count = length > 0 ? cells->count[cell_of(n, length)] : 0;
    return count >= FEW ? 1.0 / (double)count : 0;
}

/* Gauss and Jordan; false if directions are too few for the equations. */
static bool solve(double a[TERMS][TERMS + 1], double q[TERMS])
{
    double most = 0;
    for (int i = 0; i < TERMS; i++)
        most = fmax(most, a[i][i]);
    for (int k = 0; k < TERMS; k++) {
        if (!(a[k][k] > 1e-4 * most))
            return false;
        for (int i = 0; i < TERMS; i++) {
            const double by = a[i][k] / a[k][k];
            for (int j = k; i != k && j <= TERMS; j++)
                a[i][j] -= by * a[k][j];
        }
    }
    for (int k = 0; k < TERMS; k++)
        q[k] = a[k][TERMS] / a[k][k];
    return true;
}

static double quadric_at(const double q[TERMS], const float *n)
{
    double t[TERMS], sum = 0;
    terms_of(n, t);
    for (int i = 0; i < TERMS; i++)
        sum += q[i] * t[i];
    return sum;
}

/* The ellipsoid of those that the one before is near, or of all. */
static bool fit_ellipsoid(const struct gbuffer *g, const struct cells *cells, const double *before,
                          double q[TERMS])
{
    static const double outlier = 0.1;
    double a[TERMS][TERMS + 1] = {{0}};
    for (size_t i = 0; i < gbuffer_texels(g); i += gbuffer_sample_step(g)) {
        const float *n = g->normals + i * 4;
        const double weight = weight_of(cells, n);
        double t[TERMS];
        if (!(weight > 0) || (before && !(fabs(quadric_at(before, n) - 1.0) < outlier)))
            continue;
        terms_of(n, t);
        for (int row = 0; row < TERMS; row++) {
            for (int column = 0; column < TERMS; column++)
                a[row][column] += weight * t[row] * t[column];
            a[row][TERMS] += weight * t[row];
        }
    }
    return solve(a, q);
}

/* Of normals, each direction counting once. */
static double share_near(const struct gbuffer *g, const struct cells *cells, const double q[TERMS])
{
    static const double tolerance = 0.03; /* of squares */
    double near_it = 0, all = 0;
    for (size_t i = 0; i < gbuffer_texels(g); i += gbuffer_sample_step(g)) {
        const float *n = g->normals + i * 4;
        const double weight = weight_of(cells, n);
        all += weight;
        near_it += fabs(quadric_at(q, n) - 1.0) < tolerance ? weight : 0;
    }
    return all > 0 ? near_it / all : 0;
}

/* False if most are of one length, as normals are. */
static bool fill_cells(const struct gbuffer *g, struct cells *cells)
{
    static const double most = 0.9;
    size_t count = 0, ones = 0;
    *cells = (struct cells){{0}};
    for (size_t i = 0; i < gbuffer_texels(g); i += gbuffer_sample_step(g)) {
        const float *n = g->normals + i * 4;
        const double length = gbuffer_length(n);
        if (!(length > 0) || !isfinite(length))
            continue;
        cells->count[cell_of(n, length)]++;
        count++;
        ones += fabs(length - 1.0) < 0.03;
    }
    return (double)ones < most * (double)count;
}

static size_t count_cells(const struct cells *cells)
{
    enum { FEW = 4 };
    size_t count = 0;
    for (size_t i = 0; i < sizeof cells->count / sizeof *cells->count; i++)
        count += cells->count[i] >= FEW;
    return count;
}

void gbuffer_warn_of_matrix(const struct gbuffer *g, const char *path, struct report *report)
{
    enum { LEAST_CELLS = 16 };
    static const double nearly_all = 0.95, half = 0.5;
    struct cells cells;
    double first[TERMS], q[TERMS];
    if (!fill_cells(g, &cells) || count_cells(&cells) < LEAST_CELLS ||
        !fit_ellipsoid(g, &cells, NULL, first) || !fit_ellipsoid(g, &cells, first, q))
        return;
    const double mean = (q[0] + q[1] + q[2]) / 3.0, sphere[TERMS] = {mean, mean, mean, 0, 0, 0};
    if (share_near(g, &cells, q) > nearly_all && share_near(g, &cells, sphere) < half)
        report_warn(report, "transformed normals",
                    "%s: normals '%s' look as if a colour transform had been applied to them: "
                    "their lengths are those of vectors that a matrix stretched; camera and AO "
                    "are wrong; write them as data (raw, non-colour)",
                    path, g->roles.kind[ROLE_NORMAL].label);
}
