/* SPDX-License-Identifier: MIT
 *
 * Depth has normals of its own: those of the planes that neighbouring texels span. Where depth is
 * smooth they are nearly the stored ones, once these are decoded and turned as they should be, and
 * far from them otherwise. So agreement tells what no name does. */
#include "gbuffer_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CELLS = 6 };

/* Bumps and smooth shading turn stored normals by some degrees: this much, as a sine, halves what
 * a pair counts. */
static const double half_agreement = 0.12;

static bool normalize(double n[3])
{
    const double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int c = 0; c < 3; c++)
        n[c] /= length;
    return length > 0 && isfinite(length);
}

/* What is linear in the image on a plane: 1/z, or z without perspective. */
static double linear_depth(const struct gbuffer *g, size_t texel)
{
    const double z = gbuffer_view_z(g, g->depth[texel], texel);
    return g->camera.type == CAMERA_ORTHOGRAPHIC ? z : 1.0 / z;
}

/* By how much linear depth changes over so many texels to the right and down. */
static bool normal_of_slopes(const struct gbuffer *g, size_t texel, size_t reach, double w,
                             const double slopes[2], double n[3])
{
    const double column = (double)(texel % g->width), row = (double)(texel / g->width);
    const bool is_parallel = g->camera.type == CAMERA_ORTHOGRAPHIC;
    double x[2], y[2];
    camera_ray(&g->camera, &g->display_window, &g->data_window, column, row, &x[0], &y[0]);
    camera_ray(&g->camera, &g->display_window, &g->data_window, column + (double)reach,
               row + (double)reach, &x[1], &y[1]);
    const double by_x = slopes[0] / (x[1] - x[0]), by_y = slopes[1] / (y[1] - y[0]);
    n[0] = is_parallel ? by_x : -by_x;
    n[1] = is_parallel ? by_y : -by_y;
    n[2] = is_parallel ? 1.0 : w - x[0] * by_x - y[0] * by_y;
    return normalize(n);
}

/* In view space, facing the eye. False where depth has an edge or bends by more than this share of
 * its slope. */
static bool normal_of_depth(const struct gbuffer *g, size_t texel, size_t reach, double most_bend,
                            double n[3])
{
    const size_t at[5] = {texel, texel - reach, texel + reach, texel - reach * g->width,
                          texel + reach * g->width};
    double w[5];
    for (int i = 0; i < 5; i++) {
        if (!gbuffer_is_foreground(g, at[i]))
            return false;
        w[i] = linear_depth(g, at[i]);
    }
    const double bend = fabs(w[1] + w[2] - 2 * w[0]) + fabs(w[3] + w[4] - 2 * w[0]);
    const double slope = fabs(w[2] - w[1]) + fabs(w[4] - w[3]);
    if (!(bend < most_bend * slope + (g->depth_is_half ? 1e-3 : 1e-6) * w[0]))
        return false;
    return normal_of_slopes(g, texel, reach, w[0],
                            (const double[2]){(w[2] - w[1]) / 2.0, (w[4] - w[3]) / 2.0}, n);
}

/* Nearer to 0: the other may be across an edge. */
static double smaller(double a, double b)
{
    return fabs(a) < fabs(b) ? a : b;
}

bool gbuffer_rough_normal(const struct gbuffer *g, size_t texel, double n[3])
{
    const size_t x = texel % g->width, y = texel / g->width;
    double slopes[2];
    if (x == 0 || x + 1 == g->width || y == 0 || y + 1 == g->height ||
        !gbuffer_is_foreground(g, texel))
        return false;
    const double w = linear_depth(g, texel);
    for (int k = 0; k < 2; k++) {
        const size_t step = k ? g->width : 1;
        const double before =
            gbuffer_is_foreground(g, texel - step) ? w - linear_depth(g, texel - step) : INFINITY;
        const double after =
            gbuffer_is_foreground(g, texel + step) ? linear_depth(g, texel + step) - w : INFINITY;
        slopes[k] = smaller(before, after);
        if (!isfinite(slopes[k]))
            return false;
    }
    return normal_of_slopes(g, texel, 1, w, slopes, n);
}

/* Normals of large flat things are many, and all say the same. */
static size_t cell_of(const double n[3])
{
    size_t cell = 0;
    for (int c = 0; c < 3; c++) {
        const int step = (int)((n[c] * 0.5 + 0.5) * CELLS);
        cell = cell * CELLS + (size_t)(step < 0 ? 0 : step >= CELLS ? CELLS - 1 : step);
    }
    return cell;
}

static void weigh(struct normal_pairs *pairs)
{
    size_t counts[CELLS * CELLS * CELLS] = {0};
    for (size_t i = 0; i < pairs->count; i++)
        counts[cell_of(pairs->pair[i].stored)]++;
    for (size_t i = 0; i < pairs->count; i++)
        pairs->pair[i].weight = 1.0 / sqrt((double)counts[cell_of(pairs->pair[i].stored)]);
}

/* Shares of the slope by which depth bends from one texel to the next: of what is flat, or nearly,
 * and of what is round but for its rim. */
static const double flat_bend = 0.15, round_bend = 0.5;

bool gbuffer_smooth_normal(const struct gbuffer *g, size_t texel, double n[3])
{
    const size_t reach = g->depth_is_half ? 4 : 1, x = texel % g->width, y = texel / g->width;
    return x >= reach && x + reach < g->width && y >= reach && y + reach < g->height &&
           normal_of_depth(g, texel, reach, round_bend, n);
}

static bool pair_normals(const struct gbuffer *g, size_t most, double most_bend,
                         struct normal_pairs *pairs)
{
    /* Steps of half values are slopes where differences are small. */
    const size_t reach = g->depth_is_half ? 4 : 1, step = gbuffer_texels(g) / most + 1;
    *pairs = (struct normal_pairs){
        .pair = malloc((gbuffer_texels(g) / step + 1) * sizeof *pairs->pair), .reach = reach};
    if (!pairs->pair)
        return false;
    for (size_t i = 0; i < gbuffer_texels(g); i += step) {
        const size_t x = i % g->width, y = i / g->width;
        struct normal_pair *pair = &pairs->pair[pairs->count];
        const float *n = g->normals + i * 4;
        if (x < reach || x + reach >= g->width || y < reach || y + reach >= g->height)
            continue;
        pair->texel = i;
        for (int c = 0; c < 3; c++)
            pair->stored[c] = (double)n[c];
        const double *s = pair->stored;
        if (s[0] * s[0] + s[1] * s[1] + s[2] * s[2] > 0.25 && normalize(pair->stored) &&
            normal_of_depth(g, i, reach, most_bend, pair->depth))
            pairs->count++;
    }
    weigh(pairs);
    return true;
}

bool gbuffer_pair_normals(const struct gbuffer *g, size_t most, struct normal_pairs *pairs)
{
    return pair_normals(g, most, flat_bend, pairs);
}

bool gbuffer_pair_round_normals(const struct gbuffer *g, size_t most, struct normal_pairs *pairs)
{
    return pair_normals(g, most, round_bend, pairs);
}

void gbuffer_free_pairs(struct normal_pairs *pairs)
{
    free(pairs->pair);
    *pairs = (struct normal_pairs){0};
}

struct agreement gbuffer_agreement(const struct normal_pairs *pairs, const float m[9])
{
    double sum = 0, facing = 0, weights = 0;
    for (size_t i = 0; i < pairs->count; i++) {
        const struct normal_pair *p = &pairs->pair[i];
        double cosine = 0;
        for (int row = 0; row < 3; row++)
            cosine +=
                p->depth[row] * ((double)m[row] * p->stored[0] + (double)m[3 + row] * p->stored[1] +
                                 (double)m[6 + row] * p->stored[2]);
        const double sine2 = fmax(1.0 - cosine * cosine, 0);
        sum += p->weight / (1.0 + sine2 / (half_agreement * half_agreement));
        facing += cosine > 0 ? p->weight : 0;
        weights += p->weight;
    }
    return weights > 0 ? (struct agreement){sum / weights, facing / weights}
                       : (struct agreement){0};
}
