/* SPDX-License-Identifier: MIT
 *
 * Texels, depths and view space, by inverting the projection matrix as a 4x4 matrix. View space
 * here has +z away from the eye and the caller's x and y. */
#ifndef VKAO_TESTS_REF_VIEW_H_
#define VKAO_TESTS_REF_VIEW_H_

#include "stage_setting.h"

#include <stdbool.h>

struct ref_view {
    double matrix[16], inverse[16]; /* column-major */
    double forward; /* z of the caller's view space times it grows away from the eye */
    bool orthographic;
    double viewport[4]; /* x, y, width, height in texels */
    VkRect2D valid, rect;
    vkao_depth_encoding encoding;
    double far_depth, far_z; /* INFINITY if there is no far plane */
    VkFormat depth_format;
};

/* A picture as the SSAO methods see it. */
struct ref_scene {
    struct ref_view view;
    uint32_t width, height;
    bool is_half;    /* every other texel of every other row of what is shaded */
    double *z;       /* positive away from the eye; NAN = background or outside the valid texels */
    double *normals; /* 3 a texel, unit, view space, facing the eye */
    double *planes;  /* the same of the depth image */
    /* What the caller knows beyond that, and owns; NULL = nothing. thickness: scene units; what is
     * not above 0 or NAN is unknown. */
    const double *thickness;
    const struct ref_scene *second;
    const double *seen; /* ref_width_image, for what asks for it more than once a texel */
};

void ref_view_init(struct ref_view *view, const struct ao_view *from, uint32_t width,
                   uint32_t height, VkFormat depth_format);
/* View z of a stored depth; NAN = background. Texel centres are integers. */
double ref_view_z(const struct ref_view *view, double x, double y, double stored);
void ref_view_position(const struct ref_view *view, double x, double y, double z, double out[3]);
void ref_view_project(const struct ref_view *view, const double p[3], double out[2]);
/* Unit vector to the eye. */
void ref_view_eye(const struct ref_view *view, const double p[3], double out[3]);
/* How far a view z may be off because of the steps of the depth format and single-precision
 * arithmetic. */
double ref_view_depth_error(const struct ref_view *view, double z);

/* View z of a texel, NAN if there is none. */
double ref_scene_z(const struct ref_scene *scene, int x, int y);
/* The scene at the texel nearest to where p projects. False if p is behind the eye or nothing is
 * known there. */
bool ref_scene_lookup(const struct ref_scene *scene, const double p[3], double occluder[3]);

#endif
