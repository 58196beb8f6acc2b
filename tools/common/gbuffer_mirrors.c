/* SPDX-License-Identifier: MIT
 *
 * Which way round normals point: what the camera sees faces it. */
#include "gbuffer_internal.h"
#include "median.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool gbuffer_measure_facing(const struct gbuffer *g, const float matrix[9],
                            struct normal_facing *facing)
{
    size_t step = gbuffer_sample_step(g), count = 0, towards = 0;
    double *z = malloc((gbuffer_texels(g) / step + 1) * sizeof *z);
    if (!z)
        return false;
    for (size_t i = 0; i < gbuffer_texels(g); i += step) {
        if (!gbuffer_is_foreground(g, i) || !(gbuffer_length(g->normals + i * 4) > 0.5))
            continue;
        double n[3], x = 0, y = 0;
        gbuffer_turn_normal(matrix, g->normals + i * 4, n);
        if (g->camera.type == CAMERA_PERSPECTIVE)
            camera_ray(&g->camera, &g->display_window, &g->data_window, (double)(i % g->width),
                       (double)(i / g->width), &x, &y);
        towards += n[0] * x + n[1] * y - n[2] < 0;
        z[count++] = n[2];
    }
    facing->away = count - towards;
    facing->share = count ? (double)towards / (double)count : 1.0;
    facing->median_z = median_of(z, count);
    free(z);
    return true;
}

void gbuffer_turn_round(float m[9])
{
    for (int i = 0; i < 9; i++)
        m[i] = -m[i];
}

/* --- Mirrors --- */

/* The axes of the stored normals and those of view space, any of them the other way round; the
 * direction that the fewest normals have, which those of two directions leave open; and what takes
 * the stored normals nearest to those of depth. */
enum { AXES = 7, MIRROR_SEEN = AXES, MIRROR_VIEW, MIRROR_FITTED = MIRROR_VIEW + AXES, MIRRORS };

static void mirror_axes(const float from[9], int stored_axes, int view_axes, float m[9])
{
    for (int c = 0; c < 3; c++)
        for (int row = 0; row < 3; row++) {
            const bool is_turned = (stored_axes >> c & 1) != (view_axes >> row & 1);
            m[c * 3 + row] = is_turned ? -from[c * 3 + row] : from[c * 3 + row];
        }
}

static void mirror_seen(const float from[9], const double weakest[3], float m[9])
{
    for (int c = 0; c < 3; c++) {
        const float *column = from + c * 3;
        const double along = (double)column[0] * weakest[0] + (double)column[1] * weakest[1] +
                             (double)column[2] * weakest[2];
        for (int row = 0; row < 3; row++)
            m[c * 3 + row] = (float)((double)column[row] - 2.0 * along * weakest[row]);
    }
}

/* Cofactors: the inverse, transposed, times the determinant, which is returned. */
static double cofactors(const double m[9], double out[9])
{
    for (int c = 0; c < 3; c++)
        for (int row = 0; row < 3; row++) {
            const int a = (c + 1) % 3 * 3, b = (c + 2) % 3 * 3;
            const int i = (row + 1) % 3, j = (row + 2) % 3;
            out[c * 3 + row] = m[a + i] * m[b + j] - m[a + j] * m[b + i];
        }
    return m[0] * out[0] + m[1] * out[1] + m[2] * out[2];
}

/* The rotation or mirror nearest to a matrix, by Newton's iteration (Higham 1986). False if the
 * matrix has none. */
static bool make_orthogonal(double m[9])
{
    enum { STEPS = 40 };
    for (int k = 0; k < STEPS; k++) {
        double other[9];
        const double determinant = cofactors(m, other);
        /* Scaled, so that the determinants of both are 1. */
        const double scale = cbrt(fabs(determinant));
        if (!(scale > 0) || !isfinite(scale))
            return false;
        for (int i = 0; i < 9; i++)
            m[i] = 0.5 * (m[i] / scale + other[i] / determinant * scale);
    }
    return true;
}

/* Pairs that the matrix turns the same way count most: the others are bumps and borders. */
static double weight_of(const struct normal_pair *p, const float m[9])
{
    static const double half_agreement = 0.12;
    double apart = 0;
    for (int row = 0; row < 3; row++) {
        const double n = (double)m[row] * p->stored[0] + (double)m[3 + row] * p->stored[1] +
                         (double)m[6 + row] * p->stored[2];
        apart += (n - p->depth[row]) * (n - p->depth[row]);
    }
    return p->weight / (1.0 + apart / (half_agreement * half_agreement));
}

/* What is nearest to `from` where the normals leave a direction open. */
static bool fit_mirror(const struct normal_pairs *pairs, const float from[9], float m[9])
{
    enum { ROUNDS = 6 };
    static const double little = 1e-6;
    for (int k = 0; k < ROUNDS; k++) {
        double sum[9], weights = 0;
        for (int i = 0; i < 9; i++)
            sum[i] = 0;
        for (size_t i = 0; i < pairs->count; i++) {
            const struct normal_pair *p = &pairs->pair[i];
            const double weight = k ? weight_of(p, m) : p->weight;
            weights += weight;
            for (int j = 0; j < 9; j++)
                sum[j] += weight * p->depth[j % 3] * p->stored[j / 3];
        }
        for (int i = 0; i < 9; i++)
            sum[i] += little * weights * (double)from[i];
        if (!make_orthogonal(sum))
            return false;
        for (int i = 0; i < 9; i++)
            m[i] = (float)sum[i];
    }
    return true;
}

static bool is_mirror(const float m[9])
{
    double as_read[9], unused[9];
    for (int i = 0; i < 9; i++)
        as_read[i] = (double)m[i];
    return cofactors(as_read, unused) < 0;
}

/* False if there is no such mirror. */
static bool find_mirror(const struct gbuffer *g, const struct normal_pairs *pairs, int which,
                        float m[9])
{
    const float *told = g->view.normal_to_view;
    if (which == MIRROR_FITTED)
        return fit_mirror(pairs, told, m) && is_mirror(m) != is_mirror(told);
    if (which == MIRROR_SEEN && !g->has_seen_rotation)
        return false;
    if (which == MIRROR_SEEN)
        mirror_seen(told, g->seen_weakest, m);
    else
        mirror_axes(told, which < AXES ? which + 1 : 0,
                    which >= MIRROR_VIEW ? which - MIRROR_VIEW + 1 : 0, m);
    return true;
}

enum { HOW_BYTES = 64 };

static void describe_mirror(int which, char how[HOW_BYTES])
{
    static const char *const axes[AXES] = {"x is",        "y is",        "x and y are",   "z is",
                                           "x and z are", "y and z are", "x, y and z are"};
    if (which == MIRROR_SEEN || which == MIRROR_FITTED)
        snprintf(how, HOW_BYTES, "one direction of them is");
    else if (which < AXES)
        snprintf(how, HOW_BYTES, "their %s turned round", axes[which]);
    else
        snprintf(how, HOW_BYTES, "their %s turned round in view space", axes[which - MIRROR_VIEW]);
}

/* Of a small image few texels tell, and they do if none is left. */
static bool all_face(const struct normal_facing *as_told, const struct normal_facing *mirrored)
{
    static const double most_facing = 0.98, least_facing = 0.99;
    enum { FEW = 8, TIMES = 8 };
    if (mirrored->share < least_facing)
        return false;
    return as_told->share < most_facing ||
           (as_told->away >= FEW && mirrored->away * TIMES <= as_told->away);
}

static double cosine_of(const struct normal_pair *p, const float m[9])
{
    double cosine = 0;
    for (int row = 0; row < 3; row++)
        cosine +=
            p->depth[row] * ((double)m[row] * p->stored[0] + (double)m[3 + row] * p->stored[1] +
                             (double)m[6 + row] * p->stored[2]);
    return cosine;
}

/* How many more places the mirror turns as depth has them, and not merely parallel to that; 0 if
 * that is no clear answer. Most of an image may be a floor that any mirror leaves as it is: then
 * the few other places tell. Of leaves that point anywhere as many are lost. Chosen by hand: of 129
 * right renders of Blender, Mitsuba and others at most 15 places are gained, and a thousand and
 * more lost; of 60 bumpy floors none is gained. */
static size_t clear_gain(const struct normal_pairs *pairs, const float told[9],
                         const float mirrored[9])
{
    static const double same = 0.985, other = 0.94; /* 10 and 20 degrees */
    enum { FEW = 8, TIMES = 8 };
    size_t gains = 0, losses = 0;
    for (size_t i = 0; i < pairs->count; i++) {
        const double before = cosine_of(&pairs->pair[i], told);
        const double after = cosine_of(&pairs->pair[i], mirrored);
        gains += after > same && before < other;
        losses += before > same && after < other;
    }
    return gains >= FEW && gains >= losses * TIMES ? gains - losses : 0;
}

struct mirror {
    int which; /* -1: none */
    float m[9];
    struct normal_facing facing;
};

/* What turns most places as depth has them; or, if none does clearly, what turns most normals
 * towards the eye and is as good for depth. */
static bool find_best_mirror(const struct gbuffer *g, const struct normal_pairs *pairs,
                             const struct normal_pairs *round_pairs,
                             const struct normal_facing *as_told, struct mirror *best)
{
    static const double half = 0.5, less = 0.02;
    const float *told = g->view.normal_to_view;
    const bool agrees = gbuffer_agreement(pairs, told).share > half;
    size_t most = 0;
    *best = (struct mirror){.which = -1};
    for (int which = 0; which < MIRRORS; which++) {
        struct mirror other = {.which = which};
        if (!find_mirror(g, round_pairs, which, other.m))
            continue;
        const double share = gbuffer_agreement(pairs, other.m).share;
        const size_t gain = share > half ? clear_gain(round_pairs, told, other.m) : 0;
        const bool may_face = most == 0 && agrees && share >= g->normal_agreement - less;
        if (!(gain > most || may_face))
            continue;
        if (!gbuffer_measure_facing(g, other.m, &other.facing))
            return false;
        if (gain > most ||
            (all_face(as_told, &other.facing) && other.facing.share > best->facing.share)) {
            most = gain;
            *best = other;
        }
    }
    return true;
}

static void tell_mirror(const struct gbuffer *g, const struct normal_facing *as_told,
                        const struct mirror *mirror, const char *path, struct report *report)
{
    static const double nearly_all = 0.99;
    const char *label = g->roles.kind[ROLE_NORMAL].label;
    char how[HOW_BYTES];
    describe_mirror(mirror->which, how);
    if (mirror->facing.share > nearly_all && mirror->facing.share > as_told->share)
        report_warn(report, "mirrored normals",
                    "%s: %.2g %% of the normals '%s' face away from the camera, and all face it "
                    "once %s: mirrored, as those of a left-handed world are; they are taken so",
                    path, (1.0 - as_told->share) * 100.0, label, how);
    else
        report_warn(report, "mirrored normals",
                    "%s: not all normals '%s' point as depth does, and more do once %s: mirrored, "
                    "as those of a left-handed world are; they are taken so",
                    path, label, how);
}

/* Agreement does not ask which way round a normal points, as leaves do not either. Of what a
 * renderer turned towards the eye more than 99 of 100 face it; of a world with one axis the other
 * way round, as a left-handed one has, 29 to 99, or all where a floor hides the rest. What faces
 * the eye in a mirror alone was mirrored, and leaves that point anywhere face it in none. */
bool gbuffer_ask_mirrors(struct gbuffer *g, const struct normal_pairs *pairs, const char *path,
                         struct report *report)
{
    struct normal_facing as_told;
    struct normal_pairs round_pairs;
    struct mirror best;
    if (!gbuffer_measure_facing(g, g->view.normal_to_view, &as_told) ||
        !gbuffer_pair_round_normals(g, GBUFFER_MOST_PAIRS, &round_pairs))
        return false;
    const bool ok = find_best_mirror(g, pairs, &round_pairs, &as_told, &best);
    gbuffer_free_pairs(&round_pairs);
    if (!ok || best.which < 0)
        return ok;
    memcpy(g->view.normal_to_view, best.m, sizeof best.m);
    g->normal_agreement = gbuffer_agreement(pairs, best.m).share;
    tell_mirror(g, &as_told, &best, path, report);
    return true;
}

/* All of them away from the eye, and along those of depth: inside out, whatever made them so. */
bool gbuffer_ask_whether_inside_out(struct gbuffer *g, const struct normal_pairs *pairs,
                                    const char *path, struct report *report)
{
    static const double least_away = 0.99, half = 0.5;
    struct normal_facing facing;
    if (!gbuffer_measure_facing(g, g->view.normal_to_view, &facing))
        return false;
    if (1.0 - facing.share < least_away ||
        gbuffer_agreement(pairs, g->view.normal_to_view).share < half)
        return true;
    gbuffer_turn_round(g->view.normal_to_view);
    report_warn(report, "mirrored normals",
                "%s: the normals '%s' face away from the camera, %.0f %% of them, and lie along "
                "those of the depth: they point inwards and are turned round",
                path, g->roles.kind[ROLE_NORMAL].label, (1.0 - facing.share) * 100.0);
    return true;
}

/* --- Single ones --- */

/* How far a normal points away from the eye, as a cosine; not above 0 if it does not. */
static double away_from_eye(const struct gbuffer *g, size_t texel)
{
    double n[3], x = 0, y = 0;
    gbuffer_turn_normal(g->view.normal_to_view, g->normals + texel * 4, n);
    if (g->camera.type == CAMERA_PERSPECTIVE)
        camera_ray(&g->camera, &g->display_window, &g->data_window, (double)(texel % g->width),
                   (double)(texel / g->width), &x, &y);
    return (n[0] * x + n[1] * y - n[2]) / sqrt(1.0 + x * x + y * y);
}

/* Away, and the other way round than depth. What is round faces away a little at its rim, as bumps
 * do, but along the depth. */
static bool is_seen_from_behind(const struct gbuffer *g, size_t texel)
{
    static const double clearly = -0.3;
    double n[3], depth[3];
    if (!(away_from_eye(g, texel) > 0) || !gbuffer_rough_normal(g, texel, depth))
        return false;
    gbuffer_turn_normal(g->view.normal_to_view, g->normals + texel * 4, n);
    return n[0] * depth[0] + n[1] * depth[1] + n[2] * depth[2] < clearly;
}

/* What is away and goes on from what was found is of the same thing: across an edge depth tells
 * little. */
static bool goes_on(const struct gbuffer *g, const uint8_t *is_back, size_t texel)
{
    static const double alike = 0.1; /* 18 degrees */
    const size_t x = texel % g->width, y = texel / g->width;
    const size_t left = x > 0 ? x - 1 : x, right = x + 1 < g->width ? x + 1 : x;
    const size_t above = y > 0 ? y - 1 : y, below = y + 1 < g->height ? y + 1 : y;
    for (size_t row = above; row <= below; row++)
        for (size_t column = left; column <= right; column++) {
            const size_t other = row * g->width + column;
            if (is_back[other] &&
                gbuffer_apart(g->normals + other * 4, g->normals + texel * 4) < alike)
                return away_from_eye(g, texel) > 0;
        }
    return false;
}

static void go_on(const struct gbuffer *g, uint8_t *is_back, bool is_backwards)
{
    const size_t texels = gbuffer_texels(g);
    for (size_t k = 0; k < texels; k++) {
        const size_t i = is_backwards ? texels - 1 - k : k;
        if (!is_back[i] && gbuffer_is_foreground(g, i) && goes_on(g, is_back, i))
            is_back[i] = 1;
    }
}

bool gbuffer_turn_to_eye(struct gbuffer *g, const char *path, struct report *report)
{
    static const double many = 0.01;
    size_t texels = 0, turned = 0;
    uint8_t *is_back = calloc(gbuffer_texels(g), 1);
    if (!is_back)
        return false;
    for (size_t i = 0; i < gbuffer_texels(g); i++) {
        const bool is_there = gbuffer_is_foreground(g, i);
        texels += is_there;
        is_back[i] = is_there && is_seen_from_behind(g, i);
        turned += is_back[i];
    }
    if (turned > 0) {
        go_on(g, is_back, false);
        go_on(g, is_back, true);
    }
    turned = 0;
    for (size_t i = 0; i < gbuffer_texels(g); i++) {
        turned += is_back[i];
        for (size_t c = 0; is_back[i] && c < 3; c++)
            g->normals[i * 4 + c] = -g->normals[i * 4 + c];
    }
    free(is_back);
    if ((double)turned > many * (double)texels)
        report_warn(report, "turned normals",
                    "%s: %.2g %% of the normals '%s' face away from the camera, as those of leaves "
                    "that are seen from behind do: they are turned to it there",
                    path, 100.0 * (double)turned / (double)texels,
                    g->roles.kind[ROLE_NORMAL].label);
    return true;
}
