/* SPDX-License-Identifier: MIT
 *
 * Whether depth is a distance, or was squeezed as colours are for a display: to a z / (a + z), to
 * an exponential, a logarithm. Planes may still be flat then, since 1/z differs by 1/a alone, but
 * they are others than the stored normals say, and the camera that is estimated is wrong. */
#include "camera_fit_internal.h"

#include <math.h>

enum { ENOUGH_SAMPLES = 1000, TONES = 3, WIDTHS = 3 };

/* From the field of view of the best that is none, since squeezed depth looks narrower; of parallel
 * cameras from the slope of depth, which is too small as well. */
static struct fit_solution start(const struct fit_samples *s, const struct fit_solution *best,
                                 enum fit_model curve, int tone, int width)
{
    static const double tones[TONES] = {0.1, 0.3, 0.6}, wider[WIDTHS] = {0, 0.4, 1.0};
    struct fit_solution t = *best;
    t.model = curve;
    t.free[FIT_C] = true;
    t.p[FIT_C] = tones[tone];
    if (fit_model_is_ortho(curve)) {
        t.p[FIT_LN_K] = s->log_slope;
        t.free[FIT_CX] = t.free[FIT_CY] = t.shifted = false;
    } else if (fit_model_is_ortho(best->model)) {
        t.p[FIT_LN_K] = -1.0;
    }
    t.p[FIT_LN_K] += wider[width];
    t.rotation = fit_start_rotation(s, &t);
    t.cost = fit_cost(s, &t, 0.1);
    return t;
}

static struct fit_solution find_best_of(const struct fit_samples *s,
                                        const struct fit_solution *best, enum fit_model curve,
                                        double sigma)
{
    struct fit_solution found = start(s, best, curve, 0, 0);
    for (int i = 1; i < TONES * WIDTHS; i++) {
        const struct fit_solution t = start(s, best, curve, i % TONES, i / TONES);
        found = t.cost < found.cost ? t : found;
    }
    fit_descend(s, &found, 0.1, FIT_NEARLY);
    fit_refine(s, &found, sigma);
    return found;
}

static struct fit_solution find_best(const struct fit_samples *s, const struct fit_solution *best,
                                     double sigma)
{
    static const enum fit_model curves[] = {FIT_TONED, FIT_EXPONENTIAL, FIT_ORTHO_TONED,
                                            FIT_ORTHO_EXPONENTIAL};
    struct fit_solution found = {.cost = INFINITY};
    for (size_t i = 0; i < sizeof curves / sizeof *curves; i++) {
        const struct fit_solution t = find_best_of(s, best, curves[i], sigma);
        found = t.cost < found.cost ? t : found;
    }
    return found;
}

bool fit_find_tone(const struct fit_samples *all, const struct fit_solution *best,
                   struct fit_tone *tone)
{
    static const double least = 0.03;
    const double sigma = fmax(best->sigma, 0.02);
    struct fit_samples s;
    *tone = (struct fit_tone){.cost = INFINITY};
    if (!fit_samples_thin(all, ENOUGH_SAMPLES, &s))
        return false;
    const struct fit_solution without = fit_refined(&s, best, sigma),
                              with = find_best(&s, best, sigma);
    const double c = with.p[FIT_C], ratio = with.cost / fmax(without.cost, 1e-12);
    const double gain = without.cost - with.cost, z = fit_paired_z(&with, &without);
    /* Of clean renders c is 0.002 at most, and nothing is gained. */
    const bool is_other = c > fmax(least, 5.0 * with.deviation[FIT_C]) && gain > 0.01;
    /* Rough things keep their own error, whatever depth is. */
    const bool is_exact = c > 10.0 * with.deviation[FIT_C] && gain > 0.03 && z > 2;
    if (is_other && (ratio < 0.3 || (ratio < 0.7 && z > 1.5) || (ratio < 0.9 && is_exact))) {
        *tone = (struct fit_tone){.share = c,
                                  .curve = with.model,
                                  .cost = with.cost,
                                  .agreement = 1.0 - fit_cost(&s, &with, FIT_HALF_AGREEMENT)};
    }
    fit_samples_free(&s);
    return true;
}
