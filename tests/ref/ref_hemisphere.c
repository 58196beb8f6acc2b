/* SPDX-License-Identifier: MIT */
#include "ref_hemisphere.h"

#include "ref_noise.h"
#include "ref_normal.h"
#include "ref_ssao.h"

#include <math.h>
#include <stdbool.h>

/* What the scene hides of one point, height being that over the tangent plane; guard: ref_guard. */
static double hidden(const struct ref_scene *scene, const struct ao_ssao *params, const double p[3],
                     const double n[3], const double offset[3], double height, double guard)
{
    const double point[3] = {p[0] + offset[0], p[1] + offset[1], p[2] + offset[2]};
    double q[3];
    if (!ref_scene_lookup(scene, point, q))
        return 0.0;
    double v[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
    bool hides = ref_dot(n, v) > height + guard;
    return hides ? ref_range_weight(params, v[2]) : 0.0;
}

/* Within the stratum that begins at u and is width wide, from one end to the other. */
static double stratum_length(const struct ao_ssao *params, double u, double width, double jitter)
{
    double low = ref_point_length(params, u), high = ref_point_length(params, u + width);
    return low + (high - low) * jitter;
}

/* Pair k is the point k of the Fibonacci disk and the one across it, lifted onto the hemisphere:
 * directions follow the cosine. */
static double visibility(const struct ref_scene *scene, const struct ao_ssao *params, int x, int y,
                         const double p[3], const double n[3])
{
    const double golden_angle = 2.39996322972865332, two_pi = 6.28318530717958647692;
    const struct ref_noise noise = ref_noise(x, y, 1, params->noise_index);
    const uint32_t pairs = (params->sample_count + 1) / 2;
    const double guard = ref_guard(scene, params, p[2]);
    double blocked = 0.0, t[3], b[3];
    ref_basis(n, t, b);
    for (uint32_t k = 0; k < pairs; ++k) {
        double r = sqrt((k + 0.5) / pairs), height = sqrt(1.0 - r * r);
        for (int far = 0; far < 2; ++far) {
            double angle = k * golden_angle + two_pi * (noise.turn + 0.5 * far);
            double u = 0.5 * (far + ref_golden(k) * (pairs - 1.0) / pairs);
            double length = stratum_length(params, u, 0.5 / pairs, noise.jitter), offset[3];
            for (int i = 0; i < 3; ++i)
                offset[i] =
                    length * (r * cos(angle) * t[i] + r * sin(angle) * b[i] + height * n[i]);
            blocked += hidden(scene, params, p, n, offset, length * height, guard);
        }
    }
    return 1.0 - blocked / (2.0 * pairs);
}

void ref_hemisphere(const struct ref_scene *scene, const struct ao_ssao *params, double *ao)
{
    ref_ssao(scene, params, visibility, ao);
}
