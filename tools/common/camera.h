/* SPDX-License-Identifier: MIT
 *
 * The camera that made an image: from a JSON file, from header attributes or from the command line;
 * and the projection that the library wants. View space is +x right, +y up, looking along -z. */
#ifndef VKAO_TOOLS_CAMERA_H_
#define VKAO_TOOLS_CAMERA_H_

#include "error.h"
#include "exr_file.h"
#include "roles.h"
#include "setting.h"

#include <stdbool.h>
#include <stddef.h>

enum camera_type { CAMERA_UNKNOWN, CAMERA_PERSPECTIVE, CAMERA_ORTHOGRAPHIC };

/* Half sizes are those of the display window, for a perspective camera on the plane at distance 1,
 * for an orthographic one in scene units. One of them may be 0: it follows from the other by the
 * aspect ratio. */
struct camera {
    enum camera_type type;
    double half_width, half_height;
    double shift_x, shift_y; /* in image widths and heights; NDC = raster NDC + 2 * shift, +y up */
    double near_plane, far_plane; /* scene units; 0 = unknown */
    bool is_assumed;              /* of records: nobody knew it then, and what was assumed stays */
    bool has_rotation;
    bool axis_certain; /* false: the header does not say whether the camera looks along +z or -z */
    double world_to_view[9]; /* rotation, m[row * 3 + column], for column vectors */
    bool has_translation;    /* AO does not depend on it, depth from positions may */
    double translation[3];   /* view space, scene units: where the origin of the world is */
    double bound; /* of an estimated one: relative error of half_width, not exceeded; else 0 */
    enum depth_type depth_type; /* of camera files: what depth was found to be; AUTO: not told */
    char source[64]; /* of the projection: "camera file", "cameraFov" ...; "" if there is none */
    char rotation_source[64];
    /* Of headers: what contradicts itself or is not believed; and what makes of it an image that no
     * perspective and no orthographic camera took. "" if nothing does. */
    char remark[256], unsupported[64];
};

/* One camera, or one for each view of a stereo image. */
struct camera_view {
    char *name; /* "" if there is only one */
    struct camera camera;
};
struct camera_set {
    struct camera_view *views;
    size_t count;
};

/* Errors: EXIT_INPUT, naming file and key. */
bool camera_set_read(const char *path, struct camera_set *set, struct tool_error *err);
bool camera_set_parse(const char *json, const char *path, struct camera_set *set,
                      struct tool_error *err);
void camera_set_free(struct camera_set *set);
/* As camera_set_parse takes it; cJSON_Delete it. What memory ran out for is missing. */
struct cJSON *camera_json(const struct camera *camera);
/* The camera of a view, NULL if there is none. A single camera serves all views. */
const struct camera *camera_set_find(const struct camera_set *set, const char *view);

/* Whatever the header says; camera->type stays CAMERA_UNKNOWN if it has no projection.
 * half_height may be 0. */
void camera_from_header(const struct exr_part *part, struct camera *camera);

/* What the command line says. */
struct camera_flags {
    double fov_deg; /* 0 = not given */
    bool fov_is_vertical;
    double ortho_width;           /* 0 = not given */
    double near_plane, far_plane; /* 0 = not given */
};

/* Flags before file before header, each for what it knows. Without any projection it assumes 40
 * degrees and leaves camera->source empty. file may be NULL. The header is that of the part, or of
 * the first part if that one has no camera. Both half sizes of the result are set. */
void camera_resolve(const struct camera_flags *flags, const struct camera *file,
                    const struct exr_info *info, size_t part, struct camera *camera);

/* Where a texel of the data window looks: x and y at z = -1 (perspective), or at the image plane
 * (orthographic). */
void camera_ray(const struct camera *camera, const struct exr_box *display,
                const struct exr_box *data, double column, double row, double *x, double *y);

/* Planes for camera_project. Perspective: far_plane may be INFINITY, near_plane too, to reverse the
 * depth buffer. */
struct camera_planes {
    double near_plane, far_plane;
};

/* Fills projection, axis and viewport; normal_to_view becomes the identity. */
void camera_project(const struct camera *camera, const struct camera_planes *planes,
                    const struct exr_box *display, const struct exr_box *data,
                    struct ao_view *view);
/* Whether the library can use the projection: absurd fields of view and planes make zeros and
 * infinities of it. */
bool camera_can_project(const struct ao_view *view);
/* World-space normals to view space; the camera must have a rotation. */
void camera_normal_to_view(const struct camera *camera, float matrix[9]);

double camera_fov_x_deg(const struct camera *camera);
/* Whether its world is left-handed; the camera must have a rotation. */
bool camera_is_mirrored(const struct camera *camera);

#endif
