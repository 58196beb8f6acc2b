/* SPDX-License-Identifier: MIT
 *
 * An analytic ray tracer in double precision: it draws the demo's G-buffer and gives the tests
 * ambient occlusion whose true value is known. Scenes hold up to a few thousand primitives.
 *
 *     struct trace_scene scene = {0};
 *     trace_add(&scene, trace_plane(vec3(0, 0, 0), vec3(0, 1, 0)));
 *     trace_add(&scene, trace_sphere(vec3(0, 1, 0), 1));
 *     if (!trace_build(&scene)) ...out of memory...
 *     trace_gbuffer(&scene, &camera, 64, 36, 0, 36, &gbuffer);
 *     trace_scene_free(&scene);
 *
 * A built scene is constant: any number of threads may trace it. */
#ifndef VKAO_DEMO_TRACE_H_
#define VKAO_DEMO_TRACE_H_

#include "trace_camera.h"
#include "vec3.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* In its own coordinates a primitive sits at the origin. Boxes, spheres and cylinders are solid. */
enum trace_kind {
    TRACE_PLANE,     /* y = 0, endless */
    TRACE_DISK,      /* y = 0, x^2 + z^2 <= size.x^2 */
    TRACE_SPHERE,    /* radius size.x */
    TRACE_BOX,       /* half extents size */
    TRACE_CYLINDER,  /* radius size.x about y, |y| <= size.y */
    TRACE_BORED_BOX, /* box less an endless cylinder along z, radius bore, through (0, bore_y) */
    TRACE_BORED_CYLINDER, /* cylinder less an endless one about y, radius bore */
};

struct trace_primitive {
    enum trace_kind kind;
    struct vec3 position; /* of the local origin, world */
    struct mat3 axes;     /* rows: the local x, y and z in world space, orthonormal */
    struct vec3 size;
    double bore, bore_y;
    struct vec3 albedo; /* [0,1]. Default of the functions below: 0.8 */
    int pattern;        /* for trace_scene.albedo; 0 */
};

struct trace_hit {
    double t;             /* distance along the unit direction */
    struct vec3 position; /* world */
    struct vec3
        normal; /* unit, world; out of the solid, or +y of planes and disks. See trace_facing() */
    struct vec3 local; /* position in the primitive's coordinates */
    struct vec3 local_normal;
    size_t primitive;
};

struct trace_node;

struct trace_scene {
    struct trace_primitive *primitives;
    size_t count, capacity;
    /* Surface colour; NULL = the primitive's own. */
    struct vec3 (*albedo)(const struct trace_scene *scene, const struct trace_hit *hit);
    /* Private: set by trace_build(). */
    struct trace_node *nodes;
    uint32_t *order;
    size_t node_count, unbounded; /* order[0..unbounded) are planes: outside of the tree */
    bool failed;
};

struct trace_primitive trace_plane(struct vec3 point, struct vec3 normal);
struct trace_primitive trace_disk(struct vec3 center, struct vec3 normal, double radius);
struct trace_primitive trace_sphere(struct vec3 center, double radius);
struct trace_primitive trace_box(struct vec3 center, struct vec3 half);
/* Capped, from a to b. */
struct trace_primitive trace_cylinder(struct vec3 a, struct vec3 b, double radius);

/* Running out of memory is remembered and reported by trace_build(). Adding unbuilds the scene. */
void trace_add(struct trace_scene *scene, struct trace_primitive primitive);
bool trace_build(struct trace_scene *scene);
void trace_scene_free(struct trace_scene *scene);

/* The nearest surface with t_min < t < t_max; direction is unit. */
bool trace_closest(const struct trace_scene *scene, struct vec3 origin, struct vec3 direction,
                   double t_min, double t_max, struct trace_hit *hit);
/* Whether there is any. */
bool trace_any(const struct trace_scene *scene, struct vec3 origin, struct vec3 direction,
               double t_min, double t_max);
/* The hit's normal, turned against the ray that came along `direction`. */
struct vec3 trace_facing(const struct trace_hit *hit, struct vec3 direction);
struct vec3 trace_albedo(const struct trace_scene *scene, const struct trace_hit *hit);

/* What the camera sees at image position (x, y), between its near and far planes. */
bool trace_primary(const struct trace_scene *scene, const struct trace_camera *camera, double x,
                   double y, int width, int height, struct trace_hit *hit, struct trace_ray *ray);

/* Arrays of width * height texels, row 0 at the top; any may be NULL. */
struct trace_gbuffer {
    float *z;      /* planar, 0 = background */
    float *normal; /* 3 per texel, unit, world, towards the viewer; 0 = background */
    float *albedo; /* 3 per texel; 0 = background */
};

/* Fills rows [row, row_end) from the texel centres. */
void trace_gbuffer(const struct trace_scene *scene, const struct trace_camera *camera, int width,
                   int height, int row, int row_end, const struct trace_gbuffer *out);

/* Ambient visibility, 1 = open: threshold counts any hit nearer than the radius, falloff weighs it
 * 1-(t/R)^2. */
struct trace_ao {
    double threshold, falloff;
};

/* At a surface point, cosine-weighted about a unit normal, by `rays` points of the R2 sequence
 * (Roberts 2018) shifted at random by seed. The error is about 0.5 / rays^0.75: 0.003 for 1024. */
struct trace_ao trace_ao(const struct trace_scene *scene, struct vec3 position, struct vec3 normal,
                         double radius, int rays, uint32_t seed);

/* Fills rows [row, row_end) of two arrays of width * height; background is 1. */
void trace_ao_image(const struct trace_scene *scene, const struct trace_camera *camera, int width,
                    int height, int row, int row_end, double radius, int rays, float *threshold,
                    float *falloff);

/* A well mixed 32-bit hash (Wellons' lowbias32), and the direction of a cosine lobe about n at (u,
 * v). */
uint32_t trace_hash(uint32_t x);
struct vec3 trace_cosine(struct vec3 n, double u, double v);

#endif
