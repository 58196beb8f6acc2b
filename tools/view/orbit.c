/* SPDX-License-Identifier: MIT */
#include "orbit.h"

#include "vec3.h"

#include <string.h>

/* At the pole itself the drag direction would flip. */
static const double pitch_limit = PI / 2 - 0.01;
static const double zoom_per_step = 0.9;

/* Rows: right, up and backward in world space. */
static struct mat3 axes_of(const struct orbit *orbit)
{
    double cy = cos(orbit->yaw), sy = sin(orbit->yaw);
    double cp = cos(orbit->pitch), sp = sin(orbit->pitch);
    struct vec3 right = vec3(cy, 0, -sy), back = vec3(cp * sy, sp, cp * cy);
    return (struct mat3){right, cross(back, right), back};
}

/* Half of what the window's height spans at the target. */
static double half_height(const struct orbit *orbit)
{
    return orbit->distance * tan(0.5 * orbit->fov_y);
}

static struct vec3 target_of(const struct orbit *orbit)
{
    return vec3(orbit->target[0], orbit->target[1], orbit->target[2]);
}

static struct vec3 eye_of(const struct orbit *orbit)
{
    double distance = orbit->orthographic ? orbit->near + orbit->reach : orbit->distance;
    return mad(axes_of(orbit).z, distance, target_of(orbit));
}

static double clamp(double x, double low, double high)
{
    return fmin(fmax(x, low), high);
}

void orbit_drag(struct orbit *orbit, double dx, double dy)
{
    orbit->yaw = remainder(orbit->yaw - PI * dx, 2 * PI);
    orbit->pitch = clamp(orbit->pitch + PI * dy, -pitch_limit, pitch_limit);
}

void orbit_pan(struct orbit *orbit, double dx, double dy)
{
    struct mat3 axes = axes_of(orbit);
    double height = 2 * half_height(orbit);
    struct vec3 target = mad(axes.x, -dx * height, mad(axes.y, dy * height, target_of(orbit)));
    orbit->target[0] = target.x;
    orbit->target[1] = target.y;
    orbit->target[2] = target.z;
}

void orbit_zoom(struct orbit *orbit, double steps)
{
    orbit->distance = clamp(orbit->distance * pow(zoom_per_step, steps), orbit->distance_min,
                            orbit->distance_max);
}

void orbit_eye(const struct orbit *orbit, double eye[3])
{
    struct vec3 e = eye_of(orbit);
    eye[0] = e.x;
    eye[1] = e.y;
    eye[2] = e.z;
}

void orbit_rotation(const struct orbit *orbit, float matrix[9])
{
    const struct mat3 axes = axes_of(orbit);
    const struct vec3 rows[3] = {axes.x, axes.y, axes.z};
    for (int row = 0; row < 3; ++row) {
        matrix[row] = (float)rows[row].x;
        matrix[3 + row] = (float)rows[row].y;
        matrix[6 + row] = (float)rows[row].z;
    }
}

void orbit_view_matrix(const struct orbit *orbit, float matrix[16])
{
    float rotation[9];
    struct vec3 eye = mul_mat(axes_of(orbit), eye_of(orbit));
    orbit_rotation(orbit, rotation);
    memset(matrix, 0, 16 * sizeof *matrix);
    for (int column = 0; column < 3; ++column)
        memcpy(matrix + 4 * column, rotation + 3 * column, 3 * sizeof *matrix);
    matrix[12] = (float)-eye.x;
    matrix[13] = (float)-eye.y;
    matrix[14] = (float)-eye.z;
    matrix[15] = 1.0f;
}

void orbit_projection(const struct orbit *orbit, double aspect, float matrix[16])
{
    memset(matrix, 0, 16 * sizeof *matrix);
    if (orbit->orthographic) {
        double half = half_height(orbit), depth = 2 * orbit->reach;
        matrix[0] = (float)(1 / (half * aspect));
        matrix[5] = (float)(-1 / half);
        matrix[10] = (float)(1 / depth);
        matrix[14] = (float)((orbit->near + depth) / depth);
        matrix[15] = 1.0f;
    } else {
        double scale_y = 1 / tan(0.5 * orbit->fov_y);
        matrix[0] = (float)(scale_y / aspect);
        matrix[5] = (float)-scale_y;
        matrix[11] = -1.0f;
        matrix[14] = (float)orbit->near;
    }
}
