/* SPDX-License-Identifier: MIT */
#include "ref_hemisphere.h"

#include "ref_noise.h"
#include "ref_normal.h"
#include "ref_ssao.h"

#include <math.h>

static double visibility(const struct ref_scene *scene, const vkao_ssao_params *params, int x,
                         int y, const double p[3], const double n[3])
{
    const double golden_angle = 2.39996322972865332, two_pi = 6.28318530717958647692;
    const struct ref_noise noise = ref_noise(x, y, 1, params->noise_index);
    double turn = two_pi * noise.turn, shift = noise.jitter;
    double bias = ref_guard(scene, params, p[2]), blocked = 0.0;
    double t[3], b[3];
    ref_basis(n, t, b);
    for (uint32_t k = 0; k < params->sample_count; ++k) {
        /* Point k of the Fibonacci disk, lifted onto the hemisphere: directions follow the cosine.
         */
        double r = sqrt((k + 0.5) / params->sample_count), height = sqrt(1.0 - r * r);
        double angle = k * golden_angle + turn;
        double length = ref_point_length(params, ref_fract(ref_golden(k) + shift));
        double point[3], q[3];
        for (int i = 0; i < 3; ++i)
            point[i] =
                p[i] + length * (r * cos(angle) * t[i] + r * sin(angle) * b[i] + height * n[i]);
        if (!ref_scene_lookup(scene, point, q))
            continue;
        double v[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
        if (ref_dot(n, v) > length * height + bias)
            blocked += ref_range_weight(params, v[2]);
    }
    return 1.0 - blocked / params->sample_count;
}

void ref_hemisphere(const struct ref_scene *scene, const vkao_ssao_params *params, double *ao)
{
    ref_ssao(scene, params, visibility, ao);
}
