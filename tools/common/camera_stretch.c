/* SPDX-License-Identifier: MIT
 *
 * Whether an image is as high as it seems. Pixels of film are twice as wide as high, those of one
 * field of video are half as wide, and files forget it. The camera that is estimated then is
 * wrong, and explains the normals badly; or it has a lens shift that explains them as well. */
#include "camera_fit_internal.h"

#include <math.h>

enum { ENOUGH_SAMPLES = 1500 };

/* Without a lens shift, which may be made up of the stretch. */
static struct fit_solution find_best(const struct fit_samples *s, const struct fit_solution *best,
                                     double sigma)
{
    static const double starts[] = {0, 0.69, -0.69, 0.35, -0.35}, most = 1.2;
    struct fit_solution found = *best;
    found.cost = INFINITY;
    for (size_t i = 0; i < sizeof starts / sizeof *starts; i++) {
        struct fit_solution t = *best;
        if (best->shifted)
            t.free[FIT_CX] = t.free[FIT_CY] = t.shifted = false;
        if (best->shifted)
            t.p[FIT_CX] = t.p[FIT_CY] = 0;
        t.free[FIT_LN_A] = true;
        t.p[FIT_LN_A] = starts[i];
        t.rotation = fit_start_rotation(s, &t);
        fit_descend(s, &t, 0.1, FIT_NEARLY);
        fit_refine(s, &t, sigma);
        if (t.cost < found.cost && fabs(t.p[FIT_LN_A]) < most)
            found = t;
    }
    return found;
}

/* Where nearly all faces are parallel to three axes, a shift along one side of the image turns them
 * as a stretch does. */
static bool is_as_good(const struct fit_solution *stretch, const struct fit_solution *shift)
{
    return stretch->cost < 1.5 * shift->cost + 0.01;
}

bool fit_find_stretch(const struct fit_samples *all, const struct fit_solution *best,
                      struct fit_stretch *stretch)
{
    static const double least = 0.08;
    /* What is exact for a few proves nothing. */
    const double sigma = fmax(best->sigma, 0.02);
    struct fit_samples s;
    *stretch = (struct fit_stretch){.times = 1.0, .cost = INFINITY};
    if (!fit_samples_thin(all, ENOUGH_SAMPLES, &s))
        return false;
    const struct fit_solution without = fit_refined(&s, best, sigma),
                              with = find_best(&s, best, sigma);
    const double change = fabs(with.p[FIT_LN_A]);
    const bool is_other = change > least && change > 5.0 * with.deviation[FIT_LN_A];
    /* Of clean renders none is stretched by more than 1.6 %, and none gains more than 0.0015. */
    const bool is_clear = is_other && with.cost < 0.9 * without.cost &&
                          without.cost - with.cost > 0.0015 && fit_paired_z(&with, &without) > 1.5;
    if (is_clear) {
        stretch->cost = with.cost;
        stretch->agreement = 1.0 - fit_cost(&s, &with, FIT_HALF_AGREEMENT);
    }
    if (is_clear || (is_other && best->shifted && is_as_good(&with, &without)))
        stretch->times = exp(with.p[FIT_LN_A]);
    fit_samples_free(&s);
    return true;
}
