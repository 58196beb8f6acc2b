/* SPDX-License-Identifier: MIT */
#include "ref_horizon.h"
#include "ref_methods.h"
#include "ref_normal.h"
#include "ref_ssao.h"

#include <math.h>

/* sum over the samples that rise over the horizon of W(d) (sin h - sin of the horizon so far),
 * Bavoil et al. 2008; the horizon begins at the bias over the tangent plane. Mean over both sides
 * of every slice. */
static double visibility(const struct ref_scene *scene, const struct ao_ssao *params, int x, int y,
                         const double p[3], const double n[3])
{
    double occluded = 0.0;
    struct ref_slice slice;
    for (uint32_t i = 0; i < 2 * params->slice_count; ++i) {
        struct ref_sample sample;
        const double side = i % 2 ? -1.0 : 1.0;
        double horizon = asin((double)params->bias);
        if (i % 2 == 0)
            ref_slice_init(&slice, scene, params, x, y, p, n, i / 2);
        for (uint32_t t = 0; t < params->step_count; ++t) {
            if (!ref_slice_sample(&slice, side, t, (double)params->radius, &sample))
                continue;
            /* Over the tangent plane, of the point that the sample is taken to be. */
            double height = slice.length *
                            (side * sin(slice.angle) * sample.out + cos(slice.angle) * sample.up);
            double elevation = asin(fmax(-1.0, fmin(1.0, height / sample.distance)));
            double weight = ref_falloff(params, sample.distance);
            if (weight > 0.0 && elevation > horizon) {
                occluded += weight * (sin(elevation) - sin(horizon));
                horizon = elevation;
            }
        }
    }
    return 1.0 - occluded / (2.0 * params->slice_count);
}

void ref_hbao(const struct ref_scene *scene, const struct ao_ssao *params, double *ao)
{
    ref_ssao(scene, params, visibility, ao);
}
