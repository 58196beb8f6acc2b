/* SPDX-License-Identifier: MIT */
#include "matrix.h"

#include <math.h>

struct matrix matrix_transposed(const struct matrix *a)
{
    struct matrix t;
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            t.m[i][j] = a->m[j][i];
    return t;
}

struct matrix matrix_product(const struct matrix *a, const struct matrix *b)
{
    struct matrix p = {{{0}}};
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            for (int k = 0; k < 4; k++)
                p.m[i][j] += a->m[i][k] * b->m[k][j];
    return p;
}

/* Gauss-Jordan with row pivots. */
bool matrix_inverse(struct matrix a, struct matrix *out)
{
    struct matrix r = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
    for (int c = 0; c < 4; c++) {
        int pivot = c;
        for (int i = c + 1; i < 4; i++)
            if (fabs(a.m[i][c]) > fabs(a.m[pivot][c]))
                pivot = i;
        if (!(fabs(a.m[pivot][c]) > 1e-12))
            return false;
        for (int j = 0; j < 4; j++) {
            double x = a.m[c][j], y = r.m[c][j];
            a.m[c][j] = a.m[pivot][j];
            r.m[c][j] = r.m[pivot][j];
            a.m[pivot][j] = x;
            r.m[pivot][j] = y;
        }
        double scale = 1.0 / a.m[c][c];
        for (int j = 0; j < 4; j++) {
            a.m[c][j] *= scale;
            r.m[c][j] *= scale;
        }
        for (int i = 0; i < 4; i++) {
            double factor = a.m[i][c];
            for (int j = 0; i != c && j < 4; j++) {
                a.m[i][j] -= factor * a.m[c][j];
                r.m[i][j] -= factor * r.m[c][j];
            }
        }
    }
    *out = r;
    return true;
}

bool matrix_is_rigid(const struct matrix *a)
{
    double off = 0;
    for (int i = 0; i < 4; i++) {
        off = fmax(off, fabs(a->m[i][3] - (i == 3 ? 1.0 : 0.0)));
        for (int j = 0; i < 3 && j < 3; j++) {
            double dot = 0;
            for (int k = 0; k < 3; k++)
                dot += a->m[i][k] * a->m[j][k];
            off = fmax(off, fabs(dot - (i == j ? 1.0 : 0.0)));
        }
    }
    return off < 1e-3;
}
