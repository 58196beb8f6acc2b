/* SPDX-License-Identifier: MIT
 *
 * Whether depth is a distance, or was squeezed as colours are for a display: to a z / (a + z), to
 * an exponential, a logarithm. Planes may still be flat then, since 1/z differs by 1/a alone, but
 * they are others than the stored normals say, and the camera that is estimated is wrong. */
#include "camera_fit_internal.h"

#include <math.h>

enum { ENOUGH_SAMPLES = 1000, STARTS = 9 };

/* From the field of view of the best that is none, since squeezed depth looks narrower. */
static struct fit_solution start(const struct fit_samples *s, const struct fit_solution *best,
                                 int i)
{
    static const double tones[] = {0.1, 0.3, 0.6}, wider[] = {0, 0.4, 1.0};
    struct fit_solution t = *best;
    t.model = FIT_TONED;
    t.free[FIT_C] = true;
    t.p[FIT_C] = tones[i % 3];
    if (fit_model_is_ortho(best->model))
        t.p[FIT_LN_K] = -1.0;
    t.p[FIT_LN_K] += wider[i / 3];
    t.rotation = fit_start_rotation(s, &t);
    t.cost = fit_cost(s, &t, 0.1);
    return t;
}

static struct fit_solution find_best(const struct fit_samples *s, const struct fit_solution *best,
                                     double sigma)
{
    struct fit_solution found = start(s, best, 0);
    for (int i = 1; i < STARTS; i++) {
        const struct fit_solution t = start(s, best, i);
        found = t.cost < found.cost ? t : found;
    }
    fit_descend(s, &found, 0.1, 12);
    fit_refine(s, &found, sigma);
    return found;
}

bool fit_find_tone(const struct fit_samples *all, const struct fit_solution *best, double *tone,
                   double *cost)
{
    static const double least = 0.03;
    const double sigma = fmax(best->sigma, 0.02);
    struct fit_samples s;
    *tone = 0;
    *cost = INFINITY;
    if (!fit_samples_thin(all, ENOUGH_SAMPLES, &s))
        return false;
    struct fit_solution without = *best;
    fit_refine(&s, &without, sigma);
    const struct fit_solution with = find_best(&s, best, sigma);
    const double c = with.p[FIT_C], ratio = with.cost / fmax(without.cost, 1e-12);
    /* Of clean renders c is 0.002 at most, and nothing is gained. */
    if (c > fmax(least, 5.0 * with.deviation[FIT_C]) && without.cost - with.cost > 0.01 &&
        ratio < 0.7 && (ratio < 0.3 || fit_paired_z(&with, &without) > 1.5)) {
        *tone = c;
        *cost = with.cost;
    }
    fit_samples_free(&s);
    return true;
}
