/* SPDX-License-Identifier: MIT */
#include "ref_normal.h"

#include <math.h>
#include <string.h>

double ref_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double sign_of(double v)
{
    return v >= 0.0 ? 1.0 : -1.0;
}

/* Meyer et al. 2010: |x| + |y| + |z| = 1, the lower half folded outwards over the diagonals. */
static void octahedral_decode(double u, double v, double out[3])
{
    out[2] = 1.0 - fabs(u) - fabs(v);
    out[0] = out[2] >= 0.0 ? u : (1.0 - fabs(v)) * sign_of(u);
    out[1] = out[2] >= 0.0 ? v : (1.0 - fabs(u)) * sign_of(v);
}

bool ref_normal_decode(vkao_normal_encoding encoding, const double stored[4], double out[3])
{
    double v[3];
    bool unorm = encoding == VKAO_NORMALS_XYZ_UNORM || encoding == VKAO_NORMALS_OCT_UNORM;
    if (encoding == VKAO_NORMALS_FROM_DEPTH)
        return false;
    for (int i = 0; i < 3; ++i)
        v[i] = unorm ? stored[i] * 2.0 - 1.0 : stored[i];
    if (encoding == VKAO_NORMALS_OCT_SNORM || encoding == VKAO_NORMALS_OCT_UNORM)
        octahedral_decode(v[0], v[1], v);
    double length = sqrt(ref_dot(v, v));
    if (!(length >= 0.5) || !(length * length < 3.0e38)) /* what a float holds */
        return false;
    for (int i = 0; i < 3; ++i)
        out[i] = v[i] / length;
    return true;
}

void ref_normal_encode(vkao_normal_encoding encoding, const double normal[3], double stored[4])
{
    bool octahedral = encoding == VKAO_NORMALS_OCT_SNORM || encoding == VKAO_NORMALS_OCT_UNORM;
    double v[4] = {normal[0], normal[1], normal[2], 0.0};
    if (octahedral) {
        double sum = fabs(v[0]) + fabs(v[1]) + fabs(v[2]);
        double x = v[0] / sum, y = v[1] / sum;
        v[0] = normal[2] >= 0.0 ? x : (1.0 - fabs(y)) * sign_of(x);
        v[1] = normal[2] >= 0.0 ? y : (1.0 - fabs(x)) * sign_of(y);
        v[2] = 0.0;
    }
    bool unorm = encoding == VKAO_NORMALS_XYZ_UNORM || encoding == VKAO_NORMALS_OCT_UNORM;
    for (int i = 0; i < 4; ++i)
        stored[i] = unorm ? v[i] * 0.5 + 0.5 : v[i];
}

/* What continues in a straight line on screen over a plane: 1/z in perspective, z in orthographic
 * views. */
static double linear_depth(const struct ref_scene *scene, int x, int y)
{
    double z = ref_scene_z(scene, x, y);
    return scene->view.orthographic ? z : 1.0 / z;
}

/* How badly the pair of neighbours on one side (step = +1 or -1) predicts the centre; INFINITY
 * without a neighbour, and by the neighbour alone where it is the last. */
static double misprediction(const struct ref_scene *scene, int x, int y, int axis, int step)
{
    int dx = axis == 0 ? step : 0, dy = axis == 1 ? step : 0;
    double center = linear_depth(scene, x, y), first = linear_depth(scene, x + dx, y + dy);
    double second = linear_depth(scene, x + 2 * dx, y + 2 * dy);
    if (isnan(first))
        return INFINITY;
    return fabs((isnan(second) ? first : 2.0 * first - second) - center);
}

/* The same by view z of the first neighbour alone. */
static double difference(const struct ref_scene *scene, int x, int y, int axis, int step)
{
    double first = ref_scene_z(scene, axis == 0 ? x + step : x, axis == 1 ? y + step : y);
    double center = ref_scene_z(scene, x, y);
    return isnan(first) ? center : fabs(first - center);
}

typedef double measure(const struct ref_scene *scene, int x, int y, int axis, int step);

static void tangent(const struct ref_scene *scene, int x, int y, int axis, measure *miss,
                    double out[3])
{
    double before = miss(scene, x, y, axis, -1), after = miss(scene, x, y, axis, 1);
    int step = before < after ? -1 : 1;
    double z = ref_scene_z(scene, x, y), neighbour_z = z, p[3], q[3];
    double chosen_z = ref_scene_z(scene, axis == 0 ? x + step : x, axis == 1 ? y + step : y);
    if (!isnan(chosen_z))
        neighbour_z = chosen_z;
    ref_view_position(&scene->view, x, y, z, p);
    ref_view_position(&scene->view, axis == 0 ? x + step : x, axis == 1 ? y + step : y, neighbour_z,
                      q);
    for (int i = 0; i < 3; ++i)
        out[i] = step * (q[i] - p[i]);
}

static void from_depth(const struct ref_scene *scene, int x, int y, measure *miss, double out[3])
{
    double a[3], b[3], p[3], eye[3];
    tangent(scene, x, y, 0, miss, a);
    tangent(scene, x, y, 1, miss, b);
    double n[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    ref_view_position(&scene->view, x, y, ref_scene_z(scene, x, y), p);
    ref_view_eye(&scene->view, p, eye);
    double length = sqrt(ref_dot(n, n)) * (ref_dot(n, eye) < 0.0 ? -1.0 : 1.0);
    for (int i = 0; i < 3; ++i)
        out[i] = n[i] / length;
}

void ref_scene_normal(const struct ref_scene *scene, const struct ao_view *view, int x, int y,
                      const double *stored, double out[3], double facet[3])
{
    double n[3], p[3], eye[3], z = ref_scene_z(scene, x, y);
    for (int i = 0; i < 3; ++i)
        out[i] = facet[i] = NAN;
    if (isnan(z))
        return;
    bool none = !stored || view->normal_encoding == VKAO_NORMALS_FROM_DEPTH;
    from_depth(scene, x, y, none ? misprediction : difference, facet);
    memcpy(out, facet, 3 * sizeof out[0]);
    if (none || !ref_normal_decode(view->normal_encoding, stored, n))
        return;
    for (int row = 0; row < 3; ++row) {
        out[row] = 0.0;
        for (int column = 0; column < 3; ++column)
            out[row] += (double)view->normal_to_view[column * 3 + row] * n[column];
    }
    out[2] *= scene->view.forward;
    ref_view_position(&scene->view, x, y, z, p);
    ref_view_eye(&scene->view, p, eye);
    if (ref_dot(out, eye) >= 0.0)
        return;
    bool back = ref_dot(out, facet) < 0.0; /* of the surface, which is seen from there */
    for (int i = 0; i < 3; ++i)
        out[i] = back ? -out[i] : facet[i];
}
