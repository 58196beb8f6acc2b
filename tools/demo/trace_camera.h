/* SPDX-License-Identifier: MIT
 *
 * The camera of the command line tool's --camera JSON: view space has +x right, +y up and looks
 * along -z. */
#ifndef VKAO_DEMO_TRACE_CAMERA_H_
#define VKAO_DEMO_TRACE_CAMERA_H_

#include "vec3.h"

#include <stdbool.h>

struct trace_camera {
    bool orthographic;
    double fov_x_deg;        /* (0,180) degrees, perspective: over the whole width */
    double ortho_width;      /* (0,inf) scene units across, orthographic */
    double near, far;        /* planar z; what lies outside is not seen. far may be INFINITY */
    struct mat3 rotation;    /* rows: right, up and backward in world space */
    struct vec3 translation; /* view = rotation * world + translation */
};

struct trace_ray {
    struct vec3 origin;    /* the eye, or for orthographic cameras on the plane through it */
    struct vec3 direction; /* unit */
    double z_per_t;        /* planar z gained for each unit of distance */
};

/* Eye at `eye`, looking at `target`, +y of the world up. Projection fields are left as they are. */
void trace_camera_look_at(struct trace_camera *camera, struct vec3 eye, struct vec3 target);

/* The ray through image position (x, y) in texels, row 0 at the top; texel centres are at +0.5. */
struct trace_ray trace_camera_ray(const struct trace_camera *camera, double x, double y, int width,
                                  int height);

/* Row by row as OpenEXR stores them, for row vectors p * M. worldToCamera is left-handed and looks
 * along +z; worldToNDC has (0,0) in the upper left corner of the display window and (1,1) in the
 * lower right. */
void trace_camera_exr_matrices(const struct trace_camera *camera, int width, int height,
                               float world_to_camera[16], float world_to_ndc[16]);

#endif
