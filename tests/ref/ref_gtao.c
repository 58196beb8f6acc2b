/* SPDX-License-Identifier: MIT */
#include "ref_horizon.h"
#include "ref_methods.h"
#include "ref_normal.h"
#include "ref_ssao.h"

#include <math.h>

static const double half_pi = 1.57079632679489661923;

/* The largest cosine to V on one side, each faded towards that of the tangent plane by the falloff.
 */
static double horizon(const struct ref_slice *s, double side)
{
    double tangent = cos(side * s->angle + half_pi), best = tangent;
    struct ref_sample sample;
    for (uint32_t t = 0; t < s->params->step_count; ++t) {
        if (!ref_slice_sample(s, side, t, (double)s->params->radius, &sample))
            continue;
        double c = sample.up / sample.distance - (double)s->params->bias;
        double w = ref_falloff(s->params, sample.distance);
        best = fmax(best, tangent * (1.0 - w) + c * w);
    }
    return side * acos(fmax(-1.0, fmin(1.0, best)));
}

/* Visible in a slice is what lies between the two horizons, integrated as it stands. What is lost
 * is counted, so that the mean over few slices is right where nothing is. */
static void visibility(const struct ref_scene *scene, const struct ao_ssao *params, int x, int y,
                       const double p[3], const double n[3], double out[4])
{
    out[0] = out[1] = out[2] = 0.0;
    out[3] = 1.0;
    for (uint32_t k = 0; k < params->slice_count; ++k) {
        struct ref_slice s;
        double moment[2];
        ref_slice_init(&s, scene, params, x, y, p, n, k);
        double h0 = fmax(horizon(&s, -1.0), s.angle - half_pi),
               h1 = fmin(horizon(&s, 1.0), s.angle + half_pi);
        double open = ref_slice_integral(s.angle, s.angle - half_pi, s.angle + half_pi);
        out[3] -= s.length * (open - ref_slice_integral(s.angle, h0, h1)) / params->slice_count;
        ref_slice_moment(s.angle, h0, h1, moment);
        for (int i = 0; i < 3; ++i)
            out[i] += s.length * (moment[0] * s.outward[i] + moment[1] * s.to_eye[i]) /
                      params->slice_count;
    }
}

void ref_gtao(const struct ref_scene *scene, const struct ao_ssao *params, double *ao)
{
    ref_ssao_directed(scene, params, visibility, ao, NULL);
}

void ref_gtao_bent(const struct ref_scene *scene, const struct ao_ssao *params, double *ao,
                   double *bent)
{
    ref_ssao_directed(scene, params, visibility, ao, bent);
}
