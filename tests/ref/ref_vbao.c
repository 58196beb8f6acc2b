/* SPDX-License-Identifier: MIT */
#include "ref_methods.h"

#include "params.h"
#include "ref_horizon.h"
#include "ref_normal.h"
#include "ref_ssao.h"
#include "ref_width.h"

#include <math.h>

enum { SECTORS = 31 };
static const double half_pi = 1.57079632679489661923;

/* With c = cos theta the measure is (cos n c + sin n sqrt(1 - c^2)) dc; this is its integral from
 * 0. */
static double mass_below(double n, double c)
{
    return cos(n) * c * c / 2.0 + sin(n) * (c * sqrt(1.0 - c * c) + asin(c)) / 2.0;
}

/* On its own side a slice runs from the tangent plane, theta = n + pi/2, up to V, theta = 0. */
double ref_vbao_share(double n, double theta)
{
    double low = mass_below(n, cos(n + half_pi)), all = mass_below(n, 1.0) - low;
    if (theta >= n + half_pi)
        return 0.0;
    return (mass_below(n, cos(theta)) - low) / fmax(all, 1.0e-4);
}

int ref_vbao_sector(double n, double theta, double less)
{
    double share = ref_vbao_share(n, theta);
    if (theta >= n + half_pi)
        return 0;
    return (int)fmax(0.0, fmin(SECTORS, floor(share * SECTORS + VKAO_VBAO_ROUND - less)));
}

struct side {
    const struct ref_slice *slice;
    double sign, n, mass;
    bool hidden[SECTORS];
    double lost, moment[2]; /* of the measure, and along O and V */
};

/* Hides the sectors between the angles of the back and the front edge; those that were not hidden
 * yet count. */
static void hide(struct side *s, double front, double less, double back, double weight)
{
    int high = ref_vbao_sector(s->n, front, less), low = ref_vbao_sector(s->n, back, 0.0),
        fresh = 0;
    for (int i = low < high ? low : high; i < high; ++i) {
        fresh += !s->hidden[i];
        s->hidden[i] = true;
    }
    double share = weight * fresh * s->mass / SECTORS;
    double middle = (cos(front) + fmax(cos(back), cos(s->n + half_pi))) / 2.0;
    middle = fmax(-1.0, fmin(1.0, middle));
    s->lost += share;
    s->moment[0] += share * s->sign * sqrt(1.0 - middle * middle);
    s->moment[1] += share * middle;
}

static double lowered(double theta, double bias)
{
    return acos(fmax(-1.0, cos(theta) - bias));
}

static void march(struct side *s)
{
    const struct ao_ssao *params = s->slice->params;
    const double radius = (double)params->radius;
    double reach =
        params->falloff == VKAO_FALLOFF_SMOOTH ? VKAO_VBAO_REACH_SMOOTH : VKAO_VBAO_REACH_THRESHOLD;
    const double fall = s->sign * s->slice->fall;
    double last_out = 0.0, last_height = 0.0, last_angle = INFINITY;
    bool all_joined = true;
    struct ref_sample p;
    for (uint32_t t = 0; t < params->step_count; ++t) {
        bool known = ref_slice_sample(s->slice, s->sign, t, reach * radius, &p);
        double dx = p.out - last_out, height = known ? p.up + p.out * fall : 0.0;
        double joined_angle = last_angle;
        bool joined = fabs(height - last_height) < VKAO_VBAO_JOIN * fabs(dx);
        bool above = height > 0.0;
        all_joined = all_joined && joined;
        last_out = p.out;
        last_height = height;
        last_angle = known ? fabs(atan2(p.out, p.up)) : INFINITY;
        if (!known)
            continue;
        double front_out =
            !joined && above ? fmax(p.out - VKAO_VBAO_GAP_FRONT * dx, 1.0e-4 * radius) : p.out;
        double front = fabs(atan2(front_out, p.up));
        if (joined)
            front = fmin(front, joined_angle);
        double thickness = fmax(ref_width_thickness(s->slice->scene, radius, p.x, p.y),
                                VKAO_VBAO_THICKNESS_GAP * dx);
        thickness =
            ref_thickness_scale(params) *
            fmin(thickness, VKAO_VBAO_THICKNESS_BASE * radius + VKAO_VBAO_THICKNESS_SLOPE * p.out);
        double back = fabs(atan2(p.out + VKAO_VBAO_GAP_BACK * dx, p.up - thickness));
        /* The slab's point nearest to P is on P's own height if the slab spans that. */
        double near_up = p.up < 0.0 ? p.up : fmax(0.0, p.up - thickness);
        hide(s, lowered(front, (double)params->bias), all_joined ? VKAO_VBAO_ROUND_LESS : 0.0, back,
             ref_falloff(params, hypot(p.out - VKAO_VBAO_GAP_FRONT * dx, near_up)));
    }
}

static void visibility(const struct ref_scene *scene, const struct ao_ssao *params, int x, int y,
                       const double p[3], const double n[3], double out[4])
{
    for (int i = 0; i < 3; ++i)
        out[i] = 2.0 / 3.0 * n[i]; /* what an open hemisphere has */
    out[3] = 1.0;
    for (uint32_t i = 0; i < 2 * params->slice_count; ++i) {
        struct ref_slice slice;
        ref_slice_init(&slice, scene, params, x, y, p, n, i / 2);
        double sign = i % 2 ? -1.0 : 1.0, angle = sign * slice.angle;
        struct side s = {.slice = &slice, .sign = sign, .n = angle};
        s.mass = fmax(mass_below(angle, 1.0) - mass_below(angle, cos(angle + half_pi)), 1.0e-4);
        march(&s);
        double weight = slice.length / params->slice_count;
        out[3] -= weight * s.lost;
        for (int c = 0; c < 3; ++c)
            out[c] -= weight * (s.moment[0] * slice.outward[c] + s.moment[1] * slice.to_eye[c]);
    }
}

void ref_vbao(const struct ref_scene *scene, const struct ao_ssao *params, double *ao)
{
    ref_ssao_directed(scene, params, visibility, ao, NULL);
}

void ref_vbao_bent(const struct ref_scene *scene, const struct ao_ssao *params, double *ao,
                   double *bent)
{
    ref_ssao_directed(scene, params, visibility, ao, bent);
}
