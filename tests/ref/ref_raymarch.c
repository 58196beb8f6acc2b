/* SPDX-License-Identifier: MIT */
#include "ref_methods.h"

#include "params.h"
#include "ref_horizon.h"
#include "ref_noise.h"
#include "ref_normal.h"
#include "ref_ssao.h"
#include "ref_width.h"

#include <math.h>

static const double golden_angle = 2.39996322972865332, two_pi = 6.28318530717958647692;

struct ray {
    double p[3], n[3], eye[3], direction[3], jitter;
    double guard; /* ref_guard of p */
};

/* The ray is hit where it is under the scene's surface, which stands over the tangent plane, by
 * less than the scene is thick there. */
static bool hit(const struct ref_scene *layer, const struct ao_ssao *params, const struct ray *ray,
                const double point[3])
{
    const double *eye = ray->eye, radius = (double)params->radius;
    double surface[3], v[3], under[3], at[2];
    if (!ref_scene_lookup(layer, point, surface))
        return false;
    for (int i = 0; i < 3; ++i) {
        v[i] = surface[i] - ray->p[i];
        under[i] = surface[i] - point[i];
    }
    double along = ref_dot(v, eye), lateral = sqrt(fmax(0.0, ref_dot(v, v) - along * along));
    double thickness = ref_thickness_scale(params) * (VKAO_THICKNESS_BASE * radius +
                                                      VKAO_THICKNESS_SLOPE * fmin(lateral, radius));
    if (layer->thickness) {
        ref_view_project(&layer->view, point, at);
        int x = (int)floor(at[0] + 0.5), y = (int)floor(at[1] + 0.5);
        thickness = ref_thickness_scale(params) * ref_width_thickness(layer, radius, x, y);
    }
    /* What stands behind the point, as the eye sees it, may be higher over the tangent plane and
     * hides nothing. */
    double behind = ref_dot(eye, under);
    return ref_dot(ray->n, under) > ray->guard && behind > 0.0 && behind < thickness;
}

static double first_hit(const struct ref_scene *scene, const struct ao_ssao *params,
                        const struct ray *ray)
{
    for (uint32_t t = 0; t < params->step_count; ++t) {
        double d = (double)params->radius * (t + ray->jitter) / params->step_count, point[3];
        for (int i = 0; i < 3; ++i)
            point[i] = ray->p[i] + d * ray->direction[i];
        if (point[2] <= 0.0)
            return 0.0;
        if (hit(scene, params, ray, point) ||
            (scene->second && hit(scene->second, params, ray, point)))
            return ref_falloff(params, d);
    }
    return 0.0;
}

static void visibility(const struct ref_scene *scene, const struct ao_ssao *params, int x, int y,
                       const double p[3], const double n[3], double out[4])
{
    const struct ref_noise noise = ref_noise(x, y, 1, params->noise_index);
    const double guard = ref_guard(scene, params, p[2]);
    double eye[3], t[3], b[3];
    ref_view_eye(&scene->view, p, eye);
    ref_basis(n, t, b);
    out[0] = out[1] = out[2] = out[3] = 0.0;
    for (uint32_t k = 0; k < params->sample_count; ++k) {
        /* Malley's method: uniform in the disk, lifted onto the hemisphere. */
        double r = sqrt((k + noise.jitter) / params->sample_count), height = sqrt(1.0 - r * r);
        double angle = k * golden_angle + two_pi * noise.turn;
        struct ray ray = {.jitter = ref_fract(ref_golden(k) + noise.jitter), .guard = guard};
        for (int i = 0; i < 3; ++i) {
            ray.p[i] = p[i];
            ray.n[i] = n[i];
            ray.eye[i] = eye[i];
            ray.direction[i] = r * cos(angle) * t[i] + r * sin(angle) * b[i] + height * n[i];
        }
        double seen = (1.0 - first_hit(scene, params, &ray)) / params->sample_count;
        out[3] += seen;
        for (int i = 0; i < 3; ++i)
            out[i] += seen * ray.direction[i];
    }
}

void ref_raymarch(const struct ref_scene *scene, const struct ao_ssao *params, double *ao)
{
    ref_ssao_directed(scene, params, visibility, ao, NULL);
}

void ref_raymarch_bent(const struct ref_scene *scene, const struct ao_ssao *params, double *ao,
                       double *bent)
{
    ref_ssao_directed(scene, params, visibility, ao, bent);
}
