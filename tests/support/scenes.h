/* SPDX-License-Identifier: MIT
 *
 * Analytic scenes, ray cast: depths and normals as a renderer would write them. */
#ifndef VKAO_TESTS_SCENES_H_
#define VKAO_TESTS_SCENES_H_

#include "lens.h"

#include <stdint.h>

/* In scene space x and y are the view's, +z is away from the eye. */
struct shape {
    enum { SHAPE_NONE, SHAPE_PLANE, SHAPE_SPHERE, SHAPE_BOX } kind;
    double center[3]; /* a point of a plane */
    double size[3];   /* PLANE: normal. SPHERE: [0] = radius. BOX: half extents */
};

#define SCENE_SHAPES 8
struct scene {
    struct shape shapes[SCENE_SHAPES];
};

/* A plane through (0, 0, 4), turned by degrees towards azimuth (degrees in x, y). */
struct scene scene_tilted_plane(double degrees, double azimuth);
/* Floor, wall and a sphere in the corner. */
struct scene scene_corner(void);
/* A sphere in front of a plane. */
struct scene scene_sphere_on_plane(void);
/* Three boxes at different depths before a wall. */
struct scene scene_steps(void);
/* Two walls that meet at a right angle in the plane x = any, y = 0, z = 4, and open towards the
 * eye. */
struct scene scene_groove(void);
/* Four steps, going up away from the eye. */
struct scene scene_staircase(void);
/* A board hovering over a floor, seen from above at a slant. */
struct scene scene_board(void);
/* Thin bars before a wall. */
struct scene scene_fence(void);
/* A sphere and a box before nothing. */
struct scene scene_open_sky(void);

/* Posts and a rail on a board, before nothing and with nothing between them. */
struct scene scene_posts(void);

/* Ray cast into width * height texels, rows from the top; the lens spans the viewport. z is view z,
 * INFINITY for background; normals are 4 a texel in the lens' view space (z by its hand), facing
 * the eye. */
void scene_render(const struct scene *scene, const struct lens *lens, VkRect2D viewport,
                  uint32_t width, uint32_t height, double *z, double *normals);

/* What the first layer hides: view z where each texel's shape ends, INFINITY for planes and
 * background, and where the next shape begins, INFINITY for none. */
void scene_render_behind(const struct scene *scene, const struct lens *lens, VkRect2D viewport,
                         uint32_t width, uint32_t height, double *back, double *second);

/* Ambient visibility of a surface point, ray cast: threshold counts any hit within the radius,
 * falloff weighs it 1 - (t / R)^2; bent is the unit mean of the directions by the falloff's
 * visibility. */
struct scene_ambient {
    double threshold, falloff, bent[3];
};
/* rays: cosine-distributed about the unit normal, stratified, the same for every point. */
struct scene_ambient scene_ambient(const struct scene *scene, const double point[3],
                                   const double normal[3], double radius, unsigned rays);

#endif
