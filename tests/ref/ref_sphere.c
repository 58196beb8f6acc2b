/* SPDX-License-Identifier: MIT */
#include "ref_sphere.h"

#include "ref_noise.h"
#include "ref_normal.h"
#include "ref_ssao.h"

#include <math.h>

static const double two_pi = 6.28318530717958647692;
static const double golden_angle = 2.39996322972865332;

/* Equal volumes for equal steps of u (height), v (angle) and w (distance). */
static void ball_point(double u, double v, double w, double out[3])
{
    double z = 1.0 - 2.0 * u, ring = sqrt(1.0 - z * z), r = cbrt(w);
    out[0] = r * ring * cos(two_pi * v);
    out[1] = r * ring * sin(two_pi * v);
    out[2] = r * z;
}

/* mean(1 / (1 + dz^2)), dz = scale * max(0, scene z - point z); the unknown blocks nothing. */
static double literal(const struct ref_scene *scene, const struct ao_ssao *params, int x, int y,
                      const double p[3], const double n[3])
{
    const double g = 1.22074408460575947536; /* g^4 = g + 1 (Roberts 2018, three dimensions) */
    const uint32_t steps[3] = {ref_fixed_point(1.0 / g), ref_fixed_point(1.0 / (g * g)),
                               ref_fixed_point(1.0 / (g * g * g))};
    double turn = two_pi * ref_noise(x, y, 1, params->noise_index).turn;
    double factor = 0.0;
    (void)n;
    for (uint32_t k = 1; k <= params->sample_count; ++k) {
        double s[3], occluder[3];
        ball_point(ref_unit(k * steps[0]), ref_unit(k * steps[1]), ref_unit(k * steps[2]), s);
        double point[3] = {
            p[0] + (double)params->radius * (s[0] * cos(turn) - s[1] * sin(turn)),
            p[1] + (double)params->radius * (s[0] * sin(turn) + s[1] * cos(turn)),
            p[2] + (double)params->radius * s[2],
        };
        if (!ref_scene_lookup(scene, point, occluder))
            continue;
        double dz = (double)params->blocking_scale * fmax(0.0, occluder[2] - point[2]);
        factor += 1.0 / (1.0 + dz * dz);
    }
    return 1.0 - factor / params->sample_count;
}

/* 1 if the scene hides the point; where it is out of reach or unknown, what an endless wall would
 * do. guard: ref_guard. */
static double hidden(const struct ref_scene *scene, const struct ao_ssao *params, const double p[3],
                     const double n[3], const double offset[3], double guard)
{
    double height = ref_dot(n, offset);
    double point[3] = {p[0] + offset[0], p[1] + offset[1], p[2] + offset[2]}, q[3];
    double by_plane = height < 0.0 ? 1.0 : 0.0;
    if (!ref_scene_lookup(scene, point, q))
        return by_plane;
    double v[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
    double weight = ref_range_weight(params, v[2]);
    double by_scene = ref_dot(n, v) > height + guard ? 1.0 : 0.0;
    return weight * by_scene + (1.0 - weight) * by_plane;
}

/* Antipodal pairs on a Fibonacci sphere: heights (k + noise) / pairs, a golden angle apart. */
static double rescaled(const struct ref_scene *scene, const struct ao_ssao *params, int x, int y,
                       const double p[3], const double n[3])
{
    const struct ref_noise noise = ref_noise(x, y, 1, params->noise_index);
    double turn = two_pi * noise.turn, shift = noise.jitter;
    uint32_t pairs = (params->sample_count + 1) / 2;
    double blocked = 0.0, guard = ref_guard(scene, params, p[2]);
    for (uint32_t k = 0; k < pairs; ++k) {
        double z = (k + shift) / pairs, angle = k * golden_angle + turn;
        double length = ref_point_length(params, ref_fract(ref_golden(k) + shift));
        double a[3] = {length * sqrt(1.0 - z * z) * cos(angle),
                       length * sqrt(1.0 - z * z) * sin(angle), length * z};
        double b[3] = {-a[0], -a[1], -a[2]};
        blocked += hidden(scene, params, p, n, a, guard) + hidden(scene, params, p, n, b, guard);
    }
    return fmin(1.0, 2.0 * (1.0 - blocked / (2.0 * pairs)));
}

void ref_sphere(const struct ref_scene *scene, const struct ao_ssao *params, double *ao)
{
    ref_ssao(scene, params, params->sphere_form == VKAO_SPHERE_LITERAL ? literal : rescaled, ao);
}
