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

struct scene scene_groove(void)
{
    return (struct scene){{
        {SHAPE_PLANE, {0.0, 0.0, 4.0}, {0.0, -1.0, -1.0}},
        {SHAPE_PLANE, {0.0, 0.0, 4.0}, {0.0, 1.0, -1.0}},
    }};
}

struct scene scene_staircase(void)
{
    return (struct scene){{
        {SHAPE_BOX, {0.0, 2.0, 5.0}, {9.0, 1.0, 2.5}},
        {SHAPE_BOX, {0.0, 1.6, 5.5}, {9.0, 1.0, 2.3}},
        {SHAPE_BOX, {0.0, 1.2, 6.0}, {9.0, 1.0, 2.1}},
        {SHAPE_BOX, {0.0, 0.8, 6.5}, {9.0, 1.0, 1.9}},
        {SHAPE_PLANE, {0.0, 0.0, 7.0}, {0.0, 0.0, -1.0}},
    }};
}

struct scene scene_board(void)
{
    return (struct scene){{
        {SHAPE_PLANE, {0.0, 1.0, 4.0}, {0.0, -1.0, -0.7}},
        {SHAPE_BOX, {0.0, 0.1, 3.8}, {0.8, 0.03, 0.5}},
    }};
}

struct scene scene_fence(void)
{
    return (struct scene){{
        {SHAPE_PLANE, {0.0, 0.0, 4.0}, {0.0, 0.2, -1.0}},
        {SHAPE_BOX, {-1.2, 0.0, 3.5}, {0.05, 9.0, 0.05}},
        {SHAPE_BOX, {-0.6, 0.0, 3.5}, {0.05, 9.0, 0.05}},
        {SHAPE_BOX, {0.0, 0.0, 3.5}, {0.05, 9.0, 0.05}},
        {SHAPE_BOX, {0.6, 0.0, 3.5}, {0.05, 9.0, 0.05}},
        {SHAPE_BOX, {1.2, 0.0, 3.5}, {0.05, 9.0, 0.05}},
        {SHAPE_BOX, {0.0, -0.6, 3.5}, {9.0, 0.05, 0.04}},
    }};
}

struct scene scene_open_sky(void)
{
    return (struct scene){{
        {SHAPE_SPHERE, {-0.3, 0.0, 4.0}, {0.9, 0.0, 0.0}},
        {SHAPE_BOX, {0.6, 0.2, 3.8}, {0.5, 0.4, 0.4}},
    }};
}

struct scene scene_posts(void)
{
    return (struct scene){{
        {SHAPE_BOX, {0.0, 0.9, 4.0}, {1.5, 0.1, 1.5}},
        {SHAPE_BOX, {0.35, 0.0, 3.5}, {0.25, 0.8, 0.25}},
        {SHAPE_BOX, {-0.35, 0.1, 3.8}, {0.25, 0.7, 0.25}},
        {SHAPE_BOX, {1.1, -0.1, 3.7}, {0.25, 0.9, 0.25}},
        {SHAPE_BOX, {-1.1, 0.2, 3.3}, {0.25, 0.6, 0.25}},
        {SHAPE_BOX, {0.0, -0.4, 3.7}, {1.5, 0.1, 0.15}},
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
        const double scale = 1.0 / ray[i];
        const double a = (shape->center[i] - shape->size[i] - origin[i]) * scale,
                     b = (shape->center[i] + shape->size[i] - origin[i]) * scale;
        /* Parallel rays give infinities of one sign outside the slab, of both signs inside. Not by
         * fmin, which is a call each time. */
        const double near = a < b ? a : b, far = a < b ? b : a;
        side = near > enter ? i : side;
        enter = near > enter ? near : enter;
        leave = far < leave ? far : leave;
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

/* Where the ray that has hit a shape leaves it; INFINITY for a plane, which has no other side. */
static double exit_of(const struct shape *shape, const double origin[3], const double ray[3],
                      double enter)
{
    double back[3], away[3], ignored[3];
    if (shape->kind == SHAPE_PLANE || enter == INFINITY)
        return INFINITY;
    /* The same shape, hit from far behind. */
    const double far = enter + 100.0;
    for (int i = 0; i < 3; ++i) {
        back[i] = origin[i] + far * ray[i];
        away[i] = -ray[i];
    }
    return far - hit(shape, back, away, ignored);
}

/* What a texel sees: the ray advances 1 in z for 1 in t. */
struct sight {
    double z, normal[3];
    double back, second; /* where the first shape ends, where the next one begins */
};

static struct sight cast(const struct scene *scene, const struct lens *lens, double x, double y)
{
    const double axis[3] = {0.0, 0.0, 1.0};
    double at[3] = {lens->x0 + (lens->x1 - lens->x0) * (x + 1.0) / 2.0,
                    lens->y0 + (lens->y1 - lens->y0) * (y + 1.0) / 2.0, 0.0};
    const double ray[3] = {at[0], at[1], 1.0}, eye[3] = {0.0, 0.0, 0.0};
    const double *origin = lens->orthographic ? at : eye,
                 *direction = lens->orthographic ? axis : ray;
    struct sight s = {INFINITY, {0.0, 0.0, -1.0}, INFINITY, INFINITY};
    int first = -1;
    for (int i = 0; i < SCENE_SHAPES && scene->shapes[i].kind != SHAPE_NONE; ++i) {
        double candidate[3], t = hit(&scene->shapes[i], origin, direction, candidate);
        if (!(t > lens->near && t < lens->far))
            continue;
        s.second = fmin(s.second, t < s.z ? s.z : t);
        if (t < s.z) {
            s.z = t;
            first = i;
            memcpy(s.normal, candidate, sizeof s.normal);
        }
    }
    if (first >= 0)
        s.back = exit_of(&scene->shapes[first], origin, direction, s.z);
    double length = sqrt(dot(s.normal, s.normal)) * (dot(s.normal, direction) > 0.0 ? -1.0 : 1.0);
    for (int i = 0; i < 3; ++i)
        s.normal[i] /= length;
    return s;
}

static struct sight cast_texel(const struct scene *scene, const struct lens *lens,
                               VkRect2D viewport, size_t column, size_t row)
{
    double x = ((double)column + 0.5 - viewport.offset.x) / viewport.extent.width * 2.0 - 1.0;
    double y = ((double)row + 0.5 - viewport.offset.y) / viewport.extent.height * 2.0 - 1.0;
    return cast(scene, lens, x, y);
}

void scene_render(const struct scene *scene, const struct lens *lens, VkRect2D viewport,
                  uint32_t width, uint32_t height, double *z, double *normals)
{
    for (size_t i = 0; i < (size_t)width * height; ++i) {
        const struct sight s = cast_texel(scene, lens, viewport, i % width, i / width);
        z[i] = s.z;
        memcpy(&normals[i * 4], s.normal, sizeof s.normal);
        normals[i * 4 + 2] *= lens->forward;
        normals[i * 4 + 3] = 0.0;
    }
}

void scene_render_behind(const struct scene *scene, const struct lens *lens, VkRect2D viewport,
                         uint32_t width, uint32_t height, double *back, double *second)
{
    for (size_t i = 0; i < (size_t)width * height; ++i) {
        const struct sight s = cast_texel(scene, lens, viewport, i % width, i / width);
        back[i] = s.back;
        second[i] = s.second;
    }
}

/* How near to the point a shape begins, at least. */
static double least_distance(const struct shape *shape, const double point[3])
{
    double v[3], beyond[3];
    for (int i = 0; i < 3; ++i) {
        v[i] = shape->center[i] - point[i];
        beyond[i] = fmax(0.0, fabs(v[i]) - shape->size[i]);
    }
    if (shape->kind == SHAPE_PLANE)
        return fabs(dot(v, shape->size)) / sqrt(dot(shape->size, shape->size));
    return shape->kind == SHAPE_BOX ? sqrt(dot(beyond, beyond))
                                    : fabs(sqrt(dot(v, v)) - shape->size[0]);
}

struct scene_ambient scene_ambient(const struct scene *scene, const double point[3],
                                   const double normal[3], double radius, unsigned rays)
{
    struct scene_ambient result = {1.0, 1.0, {0.0, 0.0, 0.0}};
    double s = normal[2] >= 0.0 ? 1.0 : -1.0, a = -1.0 / (s + normal[2]),
           c = normal[0] * normal[1] * a;
    const double t[3] = {1.0 + s * normal[0] * normal[0] * a, s * c, -s * normal[0]};
    const double b[3] = {c, s + normal[1] * normal[1] * a, -normal[1]};
    const double golden = 2.39996322972865332, step[2] = {cos(golden), sin(golden)};
    double origin[3], ray[3], ignored[3], turn[2] = {1.0, 0.0};
    for (int i = 0; i < 3; ++i)
        origin[i] = point[i] + 1e-6 * normal[i];
    const struct shape *near[SCENE_SHAPES]; /* others are out of reach */
    int count = 0;
    for (int i = 0; i < SCENE_SHAPES && scene->shapes[i].kind != SHAPE_NONE; ++i) {
        if (least_distance(&scene->shapes[i], origin) < radius)
            near[count++] = &scene->shapes[i];
    }
    for (unsigned k = 0; k < rays; ++k) {
        double r2 = (k + 0.5) / rays, nearest = INFINITY, x = sqrt(r2) * turn[0],
               y = sqrt(r2) * turn[1], up = sqrt(1.0 - r2);
        for (int i = 0; i < 3; ++i)
            ray[i] = x * t[i] + y * b[i] + up * normal[i];
        x = turn[0];
        turn[0] = x * step[0] - turn[1] * step[1];
        turn[1] = x * step[1] + turn[1] * step[0];
        for (int i = 0; i < count; ++i) {
            double at = hit(near[i], origin, ray, ignored);
            nearest = at > 0.0 && at < nearest ? at : nearest;
        }
        double reach = nearest / radius, weight = reach < 1.0 ? 1.0 - reach * reach : 0.0;
        result.threshold -= reach < 1.0 ? 1.0 / rays : 0.0;
        result.falloff -= weight / rays;
        for (int i = 0; i < 3; ++i)
            result.bent[i] += (1.0 - weight) * ray[i];
    }
    double length = sqrt(dot(result.bent, result.bent));
    for (int i = 0; i < 3; ++i)
        result.bent[i] /= length;
    return result;
}
