/* SPDX-License-Identifier: MIT
 *
 * A camera that circles a point. Pure functions: no device, no window.
 *
 * World and view space are right-handed with +y up; the camera looks along -z of view space.
 * Matrices are column-major and lead to Vulkan's clip space (+y down) with reversed depth: 1 at the
 * near plane, 0 at the far plane, which in perspective is infinitely far. */
#ifndef VKAO_VIEW_ORBIT_H_
#define VKAO_VIEW_ORBIT_H_

#include <stdbool.h>

struct orbit {
    double target[3];    /* world; the point that is circled */
    double yaw;          /* radians; 0 = the eye is on +z of the target, pi/2 = on +x */
    double pitch;        /* radians in (-pi/2,pi/2); positive = the eye is above the target */
    double distance;     /* (0,inf) scene units from the target to the eye */
    double distance_min; /* (0,distance] where orbit_zoom() stops */
    double distance_max; /* [distance,inf) */
    double fov_y;        /* (0,pi) radians over the whole height */
    double near;         /* (0,inf) scene units, the perspective near plane */
    /* (0,inf) scene units. An orthographic view holds what lies less than this in front of or
     * beyond the target: its eye is moved back that far, so that zooming cuts nothing off. */
    double reach;
    /* What lies at the target is as large as in perspective: switching is seamless. */
    bool orthographic;
};

/* Moves of a pointer across the window, as fractions of the window's height, +x right, +y down. A
 * drag turns the scene as if it was grabbed, by half a turn per window height; a pan moves it along
 * with the pointer. */
void orbit_drag(struct orbit *orbit, double dx, double dy);
void orbit_pan(struct orbit *orbit, double dx, double dy);
/* Positive steps (notches of a wheel) approach: each takes a tenth of the distance. */
void orbit_zoom(struct orbit *orbit, double steps);

/* World position of the eye of the view matrix. */
void orbit_eye(const struct orbit *orbit, double eye[3]);
/* World to view space. */
void orbit_view_matrix(const struct orbit *orbit, float matrix[16]);
/* View to clip space, as struct ao_view.projection wants it. aspect: width / height. */
void orbit_projection(const struct orbit *orbit, double aspect, float matrix[16]);
/* The rotation alone, m[column * 3 + row], as struct ao_view.normal_to_view wants it for
 * world-space normals. */
void orbit_rotation(const struct orbit *orbit, float matrix[9]);

#endif
