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
/* A sphere and a box before nothing. */
struct scene scene_open_sky(void);

/* Ray cast into width * height texels, rows from the top; the lens spans the viewport. z is view z,
 * INFINITY for background; normals are 4 a texel in the lens' view space (z by its hand), facing
 * the eye. */
void scene_render(const struct scene *scene, const struct lens *lens, VkRect2D viewport,
                  uint32_t width, uint32_t height, double *z, double *normals);

#endif
