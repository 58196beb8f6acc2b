/* SPDX-License-Identifier: MIT */
#include "ref_horizon.h"

#include "params.h"
#include "ref_normal.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

static void normalize(double v[3])
{
    double length = sqrt(ref_dot(v, v));
    for (int i = 0; i < 3; ++i)
        v[i] /= length;
}

void ref_slice_turn(struct ref_slice *slice, double angle)
{
    const double *v = slice->to_eye;
    double *o = slice->outward, *a = slice->across, in_slice[3];
    slice->direction[0] = cos(angle);
    slice->direction[1] = sin(angle);
    for (int i = 0; i < 3; ++i)
        o[i] = i < 2 ? slice->direction[i] : 0.0;
    double along = ref_dot(o, v);
    for (int i = 0; i < 3; ++i)
        o[i] -= along * v[i];
    normalize(o);
    a[0] = o[1] * v[2] - o[2] * v[1];
    a[1] = o[2] * v[0] - o[0] * v[2];
    a[2] = o[0] * v[1] - o[1] * v[0];
    double off = ref_dot(slice->n, a);
    for (int i = 0; i < 3; ++i)
        in_slice[i] = slice->n[i] - off * a[i];
    slice->length = sqrt(ref_dot(in_slice, in_slice));
    slice->angle = atan2(ref_dot(in_slice, o), ref_dot(in_slice, v));
    slice->fall = ref_dot(slice->plane, o) / fmax(ref_dot(slice->plane, v), VKAO_STEEPEST);
}

/* Without a neighbour in its row, or in its column, a texel has no plane. */
static bool is_alone(const struct ref_scene *scene, int x, int y)
{
    return (isnan(ref_scene_z(scene, x - 1, y)) && isnan(ref_scene_z(scene, x + 1, y))) ||
           (isnan(ref_scene_z(scene, x, y - 1)) && isnan(ref_scene_z(scene, x, y + 1)));
}

/* Depth that goes on in a straight line in rows and columns has a plane. */
static bool is_straight(const struct ref_scene *scene, int x, int y)
{
    double z = ref_scene_z(scene, x, y);
    for (int axis = 0; axis < 2; ++axis) {
        int dx = axis == 0, dy = axis == 1;
        double before = ref_scene_z(scene, x - dx, y - dy);
        double after = ref_scene_z(scene, x + dx, y + dy);
        if (!(fabs(before + after - 2.0 * z) <= VKAO_PLANE_BEND * fabs(after - before) + 4e-6 * z))
            return false;
    }
    return true;
}

void ref_slice_init(struct ref_slice *slice, const struct ref_scene *scene,
                    const struct ao_ssao *params, int x, int y, const double p[3],
                    const double n[3], uint32_t k)
{
    *slice = (struct ref_slice){.scene = scene, .params = params, .x = x, .y = y};
    memcpy(slice->p, p, sizeof slice->p);
    memcpy(slice->n, n, sizeof slice->n);
    const double *own = &scene->planes[((size_t)y * scene->width + (size_t)x) * 3];
    double agreement = is_alone(scene, x, y) ? 1.0 : ref_dot(own, n);
    bool holds = is_straight(scene, x, y) || agreement > VKAO_PLANE_AGREES;
    ref_view_eye(&scene->view, p, slice->to_eye);
    bool edge_on = VKAO_PLANE_EDGE_ON * ref_dot(own, slice->to_eye) < fabs(slice->to_eye[2]);
    bool is_own = agreement <= VKAO_PLANE_EQUALS && (holds || !edge_on);
    memcpy(slice->plane, is_own ? own : n, sizeof slice->plane);
    slice->steepest = holds ? VKAO_STEEPEST : VKAO_PLANE_STEEPEST;
    double error = ref_view_depth_error(&scene->view, p[2]);
    if (params->method == VKAO_SSAO_VBAO)
        error +=
            VKAO_THICKNESS_DEPTH_ERROR * p[2] * (scene->thickness ? 1 << VKAO_THICKNESS_FINER : 1);
    /* Of both ends of v, along the directions in which they are seen. */
    slice->guard = 2.0 * error / fabs(slice->to_eye[2]);
    slice->noise = ref_noise(x, y, params->slice_count, params->noise_index);
    ref_slice_turn(slice, pi * (k + slice->noise.turn) / params->slice_count);
    double from[2], to[2];
    const double unit[3] = {p[0] + slice->direction[0], p[1] + slice->direction[1], p[2]};
    ref_view_project(&scene->view, p, from);
    ref_view_project(&scene->view, unit, to);
    for (int i = 0; i < 2; ++i)
        slice->per_unit[i] = to[i] - from[i];
}

/* Distances crowd towards the point, but lie at least 1 + least t texels out, and none farther than
 * VKAO_STEP_FARTHEST has it. Where the point at
 * that distance along the slice's direction on screen lies is for the projection to say. */
static void step_texel(const struct ref_slice *s, double side, uint32_t step, double reach,
                       int at[2])
{
    bool is_vbao = s->params->method == VKAO_SSAO_VBAO;
    double linear = is_vbao ? VKAO_VBAO_STEP_LINEAR : VKAO_STEP_LINEAR;
    double least = is_vbao ? VKAO_VBAO_STEP_LEAST : VKAO_STEP_LEAST;
    double q = (step + s->noise.jitter) / s->params->step_count;
    const double *per_unit = s->per_unit;
    double length = sqrt(per_unit[0] * per_unit[0] + per_unit[1] * per_unit[1]);
    double farthest = VKAO_STEP_FARTHEST * fmax(s->scene->width, s->scene->height) / length;
    double distance = fmin(reach, farthest) * q * (linear + (1.0 - linear) * q);
    double texels = distance * length;
    double scale = fmax(1.0, (1.0 + least * step) / texels) * distance * side;
    at[0] = (int)floor(fmax(-1e6, fmin(1e6, s->x + per_unit[0] * scale)) + 0.5);
    at[1] = (int)floor(fmax(-1e6, fmin(1e6, s->y + per_unit[1] * scale)) + 0.5);
}

bool ref_slice_sample(const struct ref_slice *s, double side, uint32_t step, double reach,
                      struct ref_sample *sample)
{
    int at[2];
    double q[3];
    step_texel(s, side, step, reach, at);
    double z = ref_scene_z(s->scene, at[0], at[1]);
    bool known = !isnan(z);
    ref_view_position(&s->scene->view, at[0], at[1], known ? z : s->p[2], q);
    for (int i = 0; i < 3; ++i)
        sample->v[i] = q[i] - s->p[i];
    sample->x = at[0];
    sample->y = at[1];
    /* Into the slice along the depth image's plane: the height over that plane stays what it is. */
    double off = ref_dot(sample->v, s->across);
    double facing = fmax(ref_dot(s->plane, s->to_eye), s->steepest);
    sample->out = side * ref_dot(sample->v, s->outward);
    /* The depth may be off by a step of its format. */
    sample->up =
        ref_dot(sample->v, s->to_eye) + off * ref_dot(s->plane, s->across) / facing - s->guard;
    sample->distance = sqrt(sample->out * sample->out + sample->up * sample->up);
    /* Far off the axis a texel beside the slice may lie behind the shaded point. */
    return known && sample->out > 0.0;
}

double ref_thickness_scale(const struct ao_ssao *params)
{
    double scale = params->falloff == VKAO_FALLOFF_THRESHOLD ? VKAO_THICKNESS_THRESHOLD : 1.0;
    return scale * (double)params->thickness;
}

double ref_falloff(const struct ao_ssao *params, double distance)
{
    double x = distance / (double)params->radius;
    if (x > 1.0)
        return 0.0;
    return params->falloff == VKAO_FALLOFF_SMOOTH ? 1.0 - x * x : 1.0;
}

/* Of one sign of theta, where the integrand is smooth: by Gauss and Legendre with ten points, which
 * for three waves over half a turn is off by 1e-10. */
static void smooth(double n, double a, double b, double sums[3])
{
    static const struct {
        double at, weight;
    } points[] = {
        {0.1488743389816312, 0.2955242247147529}, {0.4333953941292472, 0.2692667193099963},
        {0.6794095682990244, 0.2190863625159820}, {0.8650633666889845, 0.1494513491505806},
        {0.9739065285171717, 0.0666713443086881},
    };
    const double middle = (a + b) / 2.0, half = (b - a) / 2.0;
    for (size_t i = 0; i < 2 * sizeof points / sizeof points[0]; ++i) {
        double theta = middle + (i % 2 ? half : -half) * points[i / 2].at;
        double w = half * points[i / 2].weight * cos(theta - n) * fabs(sin(theta));
        sums[0] += w;
        sums[1] += w * sin(theta);
        sums[2] += w * cos(theta);
    }
}

static void integrate(double n, double a, double b, double sums[3])
{
    sums[0] = sums[1] = sums[2] = 0.0;
    if (a < 0.0 && b > 0.0) {
        smooth(n, a, 0.0, sums);
        smooth(n, 0.0, b, sums);
    } else {
        smooth(n, a, b, sums);
    }
}

double ref_slice_integral(double n, double a, double b)
{
    double sums[3];
    integrate(n, a, b, sums);
    return sums[0];
}

void ref_slice_moment(double n, double a, double b, double out[2])
{
    double sums[3];
    integrate(n, a, b, sums);
    out[0] = sums[1];
    out[1] = sums[2];
}
