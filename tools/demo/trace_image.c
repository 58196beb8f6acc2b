/* SPDX-License-Identifier: MIT
 *
 * What trace.h computes for whole pictures: the G-buffer and the ambient occlusion truth. */
#include "trace.h"

uint32_t trace_hash(uint32_t x)
{
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    x ^= x >> 16;
    return x;
}

struct vec3 trace_cosine(struct vec3 n, double u, double v)
{
    double r = sqrt(u), phi = 2.0 * PI * v;
    struct mat3 frame = mat3_around(n);
    return mul_transposed(frame, vec3(r * cos(phi), sqrt(fmax(0.0, 1.0 - u)), r * sin(phi)));
}

/* How far a ray starts off the surface it leaves: beyond the rounding of the position, far below
 * any detail. */
static double lift(struct vec3 position)
{
    return 1e-9 * (1.0 + length(position));
}

struct trace_ao trace_ao(const struct trace_scene *scene, struct vec3 position, struct vec3 normal,
                         double radius, int rays, uint32_t seed)
{
    double u = trace_hash(seed * 2u) * 0x1p-32, v = trace_hash(seed * 2u + 1u) * 0x1p-32;
    double threshold = 0, falloff = 0;
    struct vec3 origin = mad(normal, lift(position), position);
    for (int i = 0; i < rays; i++) {
        u += 0.7548776662466927; /* 1/g and 1/g^2, g the plastic number */
        v += 0.5698402909980532;
        u -= floor(u);
        v -= floor(v);
        struct trace_hit hit;
        if (!trace_closest(scene, origin, trace_cosine(normal, u, v), 0.0, radius, &hit))
            continue;
        double s = hit.t / radius;
        threshold += 1.0;
        falloff += 1.0 - s * s;
    }
    return (struct trace_ao){1.0 - threshold / rays, 1.0 - falloff / rays};
}

bool trace_primary(const struct trace_scene *scene, const struct trace_camera *camera, double x,
                   double y, int width, int height, struct trace_hit *hit, struct trace_ray *ray)
{
    *ray = trace_camera_ray(camera, x, y, width, height);
    return trace_closest(scene, ray->origin, ray->direction, camera->near / ray->z_per_t,
                         camera->far / ray->z_per_t, hit);
}

static void store3(float *out, size_t texel, struct vec3 v)
{
    if (!out)
        return;
    out[texel * 3] = (float)v.x;
    out[texel * 3 + 1] = (float)v.y;
    out[texel * 3 + 2] = (float)v.z;
}

void trace_gbuffer(const struct trace_scene *scene, const struct trace_camera *camera, int width,
                   int height, int row, int row_end, const struct trace_gbuffer *out)
{
    for (int y = row; y < row_end; y++) {
        for (int x = 0; x < width; x++) {
            size_t texel = (size_t)y * (size_t)width + (size_t)x;
            double z = 0;
            struct vec3 normal = {0, 0, 0}, albedo = {0, 0, 0};
            struct trace_hit hit;
            struct trace_ray ray;
            if (trace_primary(scene, camera, x + 0.5, y + 0.5, width, height, &hit, &ray)) {
                z = hit.t * ray.z_per_t;
                normal = trace_facing(&hit, ray.direction);
                albedo = trace_albedo(scene, &hit);
            }
            if (out->z)
                out->z[texel] = (float)z;
            store3(out->normal, texel, normal);
            store3(out->albedo, texel, albedo);
        }
    }
}

void trace_ao_image(const struct trace_scene *scene, const struct trace_camera *camera, int width,
                    int height, int row, int row_end, double radius, int rays, float *threshold,
                    float *falloff)
{
    for (int y = row; y < row_end; y++) {
        for (int x = 0; x < width; x++) {
            size_t texel = (size_t)y * (size_t)width + (size_t)x;
            struct trace_ao ao = {1.0, 1.0};
            struct trace_hit hit;
            struct trace_ray ray;
            if (trace_primary(scene, camera, x + 0.5, y + 0.5, width, height, &hit, &ray)) {
                struct vec3 normal = trace_facing(&hit, ray.direction);
                ao = trace_ao(scene, hit.position, normal, radius, rays,
                              trace_hash((uint32_t)texel));
            }
            threshold[texel] = (float)ao.threshold;
            falloff[texel] = (float)ao.falloff;
        }
    }
}
