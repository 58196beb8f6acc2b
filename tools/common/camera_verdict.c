/* SPDX-License-Identifier: MIT
 *
 * How surely what was found is the camera, and why not. The limits are those that neither crops of
 * real G-buffers nor made-up ones led astray. */
#include "camera_fit_internal.h"

#include <stdio.h>
#include <stdlib.h>

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static bool is_to_scale(enum fit_model model)
{
    return model == FIT_PLANAR || model == FIT_RADIAL || model == FIT_RADIAL_NEAR ||
           model == FIT_ORTHO;
}

/* By how much two solutions differ as geometry: ln of what a texel spans, 90th percentile. False if
 * memory runs out. */
static bool difference(const struct fit_samples *s, const struct fit_solution *a,
                       const struct fit_solution *b, double *most)
{
    double *logs = malloc(2 * s->count * sizeof *logs), middle = 0;
    if (!logs)
        return false;
    double *others = logs + s->count;
    fit_find_scales(s, a, logs);
    fit_find_scales(s, b, others);
    for (size_t i = 0; i < s->count; i++)
        logs[i] = log(logs[i] / others[i]);
    qsort(logs, s->count, sizeof *logs, compare);
    if (!is_to_scale(a->model) || !is_to_scale(b->model))
        middle = logs[s->count / 2];
    for (size_t i = 0; i < s->count; i++)
        logs[i] = fabs(logs[i] - middle);
    qsort(logs, s->count, sizeof *logs, compare);
    *most = logs[s->count * 9 / 10];
    free(logs);
    return true;
}

static void tell_rival(const struct fit_solution *rival, struct fit *fit)
{
    const double half_width = exp(rival->p[FIT_LN_K]);
    const char *name = fit_model_name(rival->model);
    if (fit_model_is_ortho(rival->model))
        snprintf(fit->why, sizeof fit->why, "%s depth of a view %.4g wide fits as well", name,
                 2.0 * half_width);
    else
        snprintf(fit->why, sizeof fit->why, "%s depth of %.4g degrees fits as well", name,
                 2.0 * atan(half_width) * 180.0 / PI);
}

/* Another solution that fits as well and is not the same geometry; fit->why says which. */
static bool find_rival(const struct fit_samples *s, const struct fit_found *f, double sigma,
                       const struct fit_solution *best, struct fit *fit)
{
    const struct fit_solution at = fit_refined(s, best, sigma);
    for (size_t i = 0; i < f->count; i++) {
        struct fit_solution rival = f->list[i];
        double apart;
        if (fit_model_without_offset(rival.model) == fit_model_without_offset(best->model) &&
            fabs(rival.p[FIT_LN_K] - best->p[FIT_LN_K]) < 0.05)
            continue; /* the same, or its near plane */
        if (best->shifted) {
            rival.free[FIT_CX] = rival.free[FIT_CY] = !fit_model_is_ortho(rival.model);
            fit_refine(s, &rival, sigma);
        }
        const double worse = rival.cost - at.cost;
        if (!(worse < 0.03 || (worse < 0.15 && fit_paired_z(&at, &rival) < 3)))
            continue;
        if (!difference(s, best, &rival, &apart))
            return false;
        if (apart > 0.03 && !fit->why[0])
            tell_rival(&rival, fit);
    }
    return true;
}

/* Shares of the weight: within 10 degrees; of flat faces, and of those within 3 degrees. */
struct shares {
    double near, flat, flat_near;
};

static struct shares find_shares(const struct fit_samples *s, const struct fit_solution *at)
{
    struct shares shares = {0};
    const struct fit_residual *residuals = fit_find_residuals(s, at);
    double flat = 0;
    for (size_t i = 0; i < s->count; i++) {
        const struct fit_sample *p = &s->list[i];
        const double e2 = residuals[i].e2;
        shares.near += e2 < 0.03 ? p->weight : 0;
        flat += p->flat ? p->weight : 0;
        shares.flat_near += p->flat && e2 < 0.0027 ? p->weight : 0;
    }
    shares.near /= s->total_weight;
    shares.flat = flat / s->total_weight;
    shares.flat_near = flat > 0 ? shares.flat_near / flat : 1.0;
    return shares;
}

/* Relative error of a field of view that is sure. */
static const double sure_bound = 0.02;

/* Of the crops of renders whose field of view was uncertain, these were nearer to the truth than 40
 * degrees; not so what ends where the search does. */
static bool is_likely(const struct fit *fit)
{
    static const double narrowest = 0.09, widest = 1.7;
    if (fit->model == FIT_ORTHO)
        return fit->bound < 0.02;
    return fit->model <= FIT_RADIAL_NEAR && fit->bound < 0.25 && fit->half_width > narrowest &&
           fit->half_width < widest;
}

/* Relative change of half_width that turns normals by less than any are true. Of faces that are
 * square to the view none turns at all. */
static double unseen_change(const struct fit_samples *s, const struct fit_solution *at)
{
    return FIT_SHARPEST_SIGMA / fmax(fit_sensitivity(s, at), 1e-9);
}

bool fit_tells_view(const struct fit_samples *s, const struct fit_solution *at)
{
    return unseen_change(s, at) < sure_bound;
}

double fit_near_share(const struct fit_samples *s, const struct fit_solution *at)
{
    return find_shares(s, at).near;
}

static void tell_uncertain(struct fit *fit)
{
    snprintf(fit->why, sizeof fit->why, "the field of view is uncertain by %.2g %%",
             fit->bound * 100.0);
}

bool fit_judge(const struct fit_samples *s, const struct fit_found *f, double sigma,
               const struct fit_solution *best, struct fit *fit)
{
    const struct shares shares = find_shares(s, best);
    struct vec3 weakest;
    const bool tells_rotation = fit_has_directions(s, best, &weakest);
    /* No less than what the differences of a coarse image leave out of curved surfaces. */
    fit->bound = fmax(2.5 * best->deviation[FIT_LN_K] + best->doubt +
                          (best->sigma > FIT_LEAST_SIGMA ? 0.15 * best->sigma : 0),
                      0.005);
    fit->bound = fmax(fit->bound, unseen_change(s, best));
    if (shares.near < 0.4)
        snprintf(fit->why, sizeof fit->why, "normals do not follow the depth: %.0f %% do",
                 shares.near * 100.0);
    else if (shares.flat > 0.2 && shares.flat_near < 0.7)
        snprintf(fit->why, sizeof fit->why, "flat faces contradict each other: %.0f %% agree",
                 shares.flat_near * 100.0);
    else if (fit->bound > 1.0)
        snprintf(fit->why, sizeof fit->why, "the normals are the same in any field of view");
    else if (fit->bound > sure_bound)
        tell_uncertain(fit);
    else if (best->shifted && fmax(best->deviation[FIT_CX], best->deviation[FIT_CY]) > 0.02)
        snprintf(fit->why, sizeof fit->why, "the lens shift is uncertain");
    if (!fit->why[0] && !find_rival(s, f, sigma, best, fit))
        return false;
    fit->weakest[0] = weakest.x;
    fit->weakest[1] = weakest.y;
    fit->weakest[2] = weakest.z;
    const bool is_vague = shares.near < 0.4 || fit->bound > sure_bound;
    fit->rotation_known = tells_rotation && best->rotation_deviation < 1.0;
    if (!fit->rotation_known && !fit->why[0])
        snprintf(fit->why, sizeof fit->why, "nearly all normals are parallel");
    fit->is_sure = !fit->why[0];
    fit->is_usable = fit->is_sure || (is_vague && tells_rotation && is_likely(fit));
    return true;
}

void fit_doubt(struct fit *fit, double bound)
{
    fit->bound = fmax(fit->bound, bound);
    if (!fit->is_sure || fit->bound <= sure_bound)
        return;
    fit->is_sure = false;
    fit->is_usable = is_likely(fit);
    tell_uncertain(fit);
}
