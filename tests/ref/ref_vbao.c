/* SPDX-License-Identifier: MIT */
#include "ref_methods.h"

#include "params.h"
#include "ref_horizon.h"
#include "ref_normal.h"
#include "ref_ssao.h"
#include "ref_width.h"

#include <math.h>
#include <stdlib.h>

enum { SECTORS = 31 };
static const double half_pi = 1.57079632679489661923;

/* With c = cos theta the measure is (cos n c + sin n sqrt(1 - c^2)) dc; this is its integral from
 * 0. */
static double mass_below(double n, double c)
{
    return cos(n) * c * c / 2.0 + sin(n) * (c * sqrt(1.0 - c * c) + asin(c)) / 2.0;
}

/* On its own side a slice runs from the tangent plane, theta = n + pi/2, up to V, theta = 0. */
struct measure {
    double n, low, all;
};

static struct measure measure_of(double n)
{
    const double low = mass_below(n, cos(n + half_pi));
    return (struct measure){n, low, fmax(mass_below(n, 1.0) - low, 1.0e-4)};
}

static double share_of(const struct measure *m, double theta)
{
    return theta >= m->n + half_pi ? 0.0 : (mass_below(m->n, cos(theta)) - m->low) / m->all;
}

static int sector_of(const struct measure *m, double theta, double less)
{
    if (theta >= m->n + half_pi)
        return 0;
    const double sectors = share_of(m, theta) * SECTORS + VKAO_VBAO_ROUND - less;
    return (int)fmax(0.0, fmin(SECTORS, floor(sectors)));
}

double ref_vbao_share(double n, double theta)
{
    const struct measure m = measure_of(n);
    return share_of(&m, theta);
}

int ref_vbao_sector(double n, double theta, double less)
{
    const struct measure m = measure_of(n);
    return sector_of(&m, theta, less);
}

struct side {
    const struct ref_slice *slice;
    double sign;
    struct measure measure;
    bool hidden[SECTORS];
    double lost, moment[2]; /* of the measure, and along O and V */
};

/* Hides the sectors between the angles of the back and the front edge; those that were not hidden
 * yet count. */
static void hide(struct side *s, double front, double less, double back, double weight)
{
    int high = sector_of(&s->measure, front, less), low = sector_of(&s->measure, back, 0.0),
        fresh = 0;
    for (int i = low < high ? low : high; i < high; ++i) {
        fresh += !s->hidden[i];
        s->hidden[i] = true;
    }
    double share = weight * fresh * s->measure.all / SECTORS;
    double middle = (cos(front) + fmax(cos(back), cos(s->measure.n + half_pi))) / 2.0;
    middle = fmax(-1.0, fmin(1.0, middle));
    s->lost += share;
    s->moment[0] += share * s->sign * sqrt(1.0 - middle * middle);
    s->moment[1] += share * middle;
}

static double lowered(double theta, double bias)
{
    return acos(fmax(-1.0, cos(theta) - bias));
}

/* The sample before, of one layer. */
struct trail {
    double out, height, angle;
    bool all_joined;
};

/* How far back a sample goes. Where thickness is given the second layer has none of its own. */
static double depth_of(const struct side *s, const struct ref_scene *layer,
                       const struct ref_sample *p, double unseen)
{
    const struct ref_scene *first = s->slice->scene;
    const struct ao_ssao *params = s->slice->params;
    const double radius = (double)params->radius, scale = ref_thickness_scale(params);
    if (first->thickness && layer != first)
        return fmax(scale * radius * ldexp(1.0, -7), VKAO_VBAO_THICKNESS_GIVEN_GAP * unseen);
    double thickness = layer->seen[(size_t)p->y * layer->width + (size_t)p->x];
    if (first->thickness)
        return fmax(scale * thickness, VKAO_VBAO_THICKNESS_GIVEN_GAP * unseen);
    thickness *= VKAO_VBAO_THICKNESS_SEEN + VKAO_VBAO_THICKNESS_MISSED / params->step_count;
    double least =
        (first->is_half ? VKAO_VBAO_THICKNESS_GAP_HALF : VKAO_VBAO_THICKNESS_GAP) * unseen;
    return scale * fmin(fmax(thickness, least),
                        VKAO_VBAO_THICKNESS_BASE * radius + VKAO_VBAO_THICKNESS_SLOPE * p->out);
}

static void take(struct side *s, struct trail *last, const struct ref_scene *layer, uint32_t t)
{
    const struct ao_ssao *params = s->slice->params;
    const double radius = (double)params->radius, fall = s->sign * s->slice->fall;
    double reach =
        params->falloff == VKAO_FALLOFF_SMOOTH ? VKAO_VBAO_REACH_SMOOTH : VKAO_VBAO_REACH_THRESHOLD;
    struct ref_slice slice = *s->slice;
    struct ref_sample p;
    slice.scene = layer;
    bool known = ref_slice_sample(&slice, s->sign, t, reach * radius, &p);
    double gap = p.out - last->out, height = known ? p.up + p.out * fall : 0.0;
    double joined_angle = last->angle;
    double rise = height - last->height, unseen = gap - VKAO_VBAO_GAP_RISE * rise;
    bool joined = fabs(rise) <= VKAO_VBAO_JOIN * gap, above = height > 0.0;
    last->all_joined = last->all_joined && joined;
    last->out = p.out;
    last->height = height;
    last->angle = known ? fabs(atan2(p.out, p.up)) : INFINITY;
    if (!known)
        return;
    double front_out =
        !joined && above ? fmax(p.out - VKAO_VBAO_GAP_FRONT * unseen, 1.0e-4 * radius) : p.out;
    double front = fabs(atan2(front_out, p.up));
    if (joined)
        front = fmin(front, joined_angle);
    double thickness = depth_of(s, layer, &p, unseen);
    double back = fabs(atan2(p.out + VKAO_VBAO_GAP_BACK * gap, p.up - thickness));
    /* The slab's point nearest to P is on P's own height if the slab spans that. */
    double near_up = p.up < 0.0 ? p.up : fmax(0.0, p.up - thickness);
    hide(s, lowered(front, (double)params->bias), last->all_joined ? VKAO_VBAO_ROUND_LESS : 0.0,
         back, ref_falloff(params, hypot(p.out - VKAO_VBAO_GAP_FRONT * unseen, near_up)));
}

static void march(struct side *s)
{
    struct trail first = {.angle = INFINITY, .all_joined = true}, second = {.angle = INFINITY};
    for (uint32_t t = 0; t < s->slice->params->step_count; ++t) {
        take(s, &first, s->slice->scene, t);
        if (s->slice->scene->second)
            take(s, &second, s->slice->scene->second, t);
    }
}

static void visibility(const struct ref_scene *scene, const struct ao_ssao *params, int x, int y,
                       const double p[3], const double n[3], double out[4])
{
    for (int i = 0; i < 3; ++i)
        out[i] = 2.0 / 3.0 * n[i]; /* what an open hemisphere has */
    out[3] = 1.0;
    struct ref_slice slice;
    for (uint32_t i = 0; i < 2 * params->slice_count; ++i) {
        if (i % 2 == 0)
            ref_slice_init(&slice, scene, params, x, y, p, n, i / 2);
        double sign = i % 2 ? -1.0 : 1.0;
        struct side s = {.slice = &slice, .sign = sign, .measure = measure_of(sign * slice.angle)};
        march(&s);
        double weight = slice.length / params->slice_count;
        out[3] -= weight * s.lost;
        for (int c = 0; c < 3; ++c)
            out[c] -= weight * (s.moment[0] * slice.outward[c] + s.moment[1] * slice.to_eye[c]);
    }
}

void ref_vbao(const struct ref_scene *scene, const struct ao_ssao *params, double *ao)
{
    ref_vbao_bent(scene, params, ao, NULL);
}

void ref_vbao_bent(const struct ref_scene *scene, const struct ao_ssao *params, double *ao,
                   double *bent)
{
    struct ref_scene first = *scene, second;
    double *seen = ref_width_image(scene, (double)params->radius), *seen_second = NULL;
    first.seen = seen;
    if (scene->second) {
        second = *scene->second;
        second.seen = seen_second = ref_width_image(scene->second, (double)params->radius);
        first.second = &second;
    }
    ref_ssao_directed(&first, params, visibility, ao, bent);
    free(seen);
    free(seen_second);
}
