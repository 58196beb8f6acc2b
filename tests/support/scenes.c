/* SPDX-License-Identifier: MIT */
#include "scenes.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

static const double degree = 3.14159265358979323846 / 180.0;

struct scene scene_tilted_plane(double degrees, double azimuth)
{
    double s = sin(degrees * degree);
    return (struct scene){{
        {SHAPE_PLANE,
         {0.0, 0.0, 4.0},
         {s * cos(azimuth * degree), s * sin(azimuth * degree), -cos(degrees * degree)}},
    }};
}

struct scene scene_corner(void)
{
    return (struct scene){{
        {SHAPE_PLANE, {0.0, 1.0, 0.0}, {0.0, -1.0, -0.1}},
        {SHAPE_PLANE, {0.0, 0.0, 5.0}, {0.2, 0.0, -1.0}},
        {SHAPE_SPHERE, {0.5, 0.55, 3.9}, {0.5, 0.0, 0.0}},
        {SHAPE_BOX, {-0.9, 0.7, 4.2}, {0.35, 0.6, 0.3}},
    }};
}

struct scene scene_sphere_on_plane(void)
{
    return (struct scene){{
        {SHAPE_PLANE, {0.0, 0.0, 4.0}, {0.1, 0.3, -1.0}},
        {SHAPE_SPHERE, {0.1, -0.1, 3.6}, {0.6, 0.0, 0.0}},
    }};
}

struct scene scene_steps(void)
{
    return (struct scene){{
        {SHAPE_PLANE, {0.0, 0.0, 5.0}, {0.0, 0.0, -1.0}},
        {SHAPE_BOX, {-0.9, 0.2, 3.2}, {0.4, 0.9, 0.2}},
        {SHAPE_BOX, {0.2, -0.5, 4.2}, {0.5, 0.4, 0.3}},
        {SHAPE_BOX, {0.9, 0.6, 2.8}, {0.3, 0.3, 0.1}},
    }};
}

struct scene scene_open_sky(void)
{
    return (struct scene){{
        {SHAPE_SPHERE, {-0.3, 0.0, 4.0}, {0.9, 0.0, 0.0}},
        {SHAPE_BOX, {0.6, 0.2, 3.8}, {0.5, 0.4, 0.4}},
    }};
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double hit_box(const struct shape *shape, const double origin[3], const double ray[3],
                      double normal[3])
{
    double enter = -INFINITY, leave = INFINITY;
    int side = 0;
    for (int i = 0; i < 3; ++i) {
        double a = (shape->center[i] - shape->size[i] - origin[i]) / ray[i];
        double b = (shape->center[i] + shape->size[i] - origin[i]) / ray[i];
        /* Parallel rays give infinities of one sign outside the slab, of both signs inside. */
        if (fmin(a, b) > enter) {
            enter = fmin(a, b);
            side = i;
        }
        leave = fmin(leave, fmax(a, b));
    }
    for (int i = 0; i < 3; ++i)
        normal[i] = i == side ? 1.0 : 0.0;
    return enter < leave ? enter : INFINITY;
}

/* Ray parameter of the first hit, INFINITY for none. */
static double hit(const struct shape *shape, const double origin[3], const double ray[3],
                  double normal[3])
{
    double v[3] = {shape->center[0] - origin[0], shape->center[1] - origin[1],
                   shape->center[2] - origin[2]};
    if (shape->kind == SHAPE_BOX)
        return hit_box(shape, origin, ray, normal);
    if (shape->kind == SHAPE_PLANE) {
        memcpy(normal, shape->size, sizeof shape->size);
        return dot(v, normal) / dot(ray, normal);
    }
    double b = dot(v, ray) / dot(ray, ray);
    double c = (dot(v, v) - shape->size[0] * shape->size[0]) / dot(ray, ray);
    if (b * b < c)
        return INFINITY;
    double t = b - sqrt(b * b - c);
    for (int i = 0; i < 3; ++i)
        normal[i] = t * ray[i] - v[i];
    return t;
}

static double cast(const struct scene *scene, const struct lens *lens, double x, double y,
                   double normal[3])
{
    const double axis[3] = {0.0, 0.0, 1.0};
    double at[3] = {lens->x0 + (lens->x1 - lens->x0) * (x + 1.0) / 2.0,
                    lens->y0 + (lens->y1 - lens->y0) * (y + 1.0) / 2.0, 0.0};
    const double ray[3] = {at[0], at[1], 1.0}, eye[3] = {0.0, 0.0, 0.0};
    const double *origin = lens->orthographic ? at : eye,
                 *direction = lens->orthographic ? axis : ray;
    double nearest = INFINITY, n[3] = {0.0, 0.0, -1.0};
    for (int i = 0; i < SCENE_SHAPES && scene->shapes[i].kind != SHAPE_NONE; ++i) {
        double candidate[3], t = hit(&scene->shapes[i], origin, direction, candidate);
        /* The ray advances 1 in z for 1 in t. */
        if (t > lens->near && t < lens->far && t < nearest) {
            nearest = t;
            memcpy(n, candidate, sizeof n);
        }
    }
    double length = sqrt(dot(n, n)) * (dot(n, direction) > 0.0 ? -1.0 : 1.0);
    for (int i = 0; i < 3; ++i)
        normal[i] = n[i] / length;
    return nearest;
}

void scene_render(const struct scene *scene, const struct lens *lens, VkRect2D viewport,
                  uint32_t width, uint32_t height, double *z, double *normals)
{
    for (uint32_t row = 0; row < height; ++row) {
        for (uint32_t column = 0; column < width; ++column) {
            size_t i = (size_t)row * width + column;
            double x = (column + 0.5 - viewport.offset.x) / viewport.extent.width * 2.0 - 1.0;
            double y = (row + 0.5 - viewport.offset.y) / viewport.extent.height * 2.0 - 1.0;
            z[i] = cast(scene, lens, x, y, &normals[i * 4]);
            normals[i * 4 + 2] *= lens->forward;
            normals[i * 4 + 3] = 0.0;
        }
    }
}
