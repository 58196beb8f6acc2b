/* SPDX-License-Identifier: MIT */
#include "camera.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double degree = 3.14159265358979323846 / 180.0;
static const double assumed_fov_deg = 40.0;

static double box_width(const struct exr_box *box)
{
    return (double)box->x_max - (double)box->x_min + 1.0;
}

static double box_height(const struct exr_box *box)
{
    return (double)box->y_max - (double)box->y_min + 1.0;
}

const struct camera *camera_set_find(const struct camera_set *set, const char *view)
{
    if (set->count == 1 && !set->views[0].name[0])
        return &set->views[0].camera;
    for (size_t i = 0; i < set->count; i++)
        if (strcmp(set->views[i].name, view) == 0)
            return &set->views[i].camera;
    return NULL;
}

void camera_set_free(struct camera_set *set)
{
    for (size_t i = 0; i < set->count; i++)
        free(set->views[i].name);
    free(set->views);
    *set = (struct camera_set){0};
}

static void take_projection(struct camera *camera, const struct camera *from)
{
    if (from->type == CAMERA_UNKNOWN)
        return;
    camera->type = from->type;
    camera->is_assumed = from->is_assumed;
    camera->half_width = from->half_width;
    camera->half_height = from->half_height;
    camera->shift_x = from->shift_x;
    camera->shift_y = from->shift_y;
    memcpy(camera->source, from->source, sizeof camera->source);
    camera->remark[0] = camera->unsupported[0] = '\0'; /* of what is not taken */
}

static void take_planes(struct camera *camera, double near_plane, double far_plane)
{
    if (near_plane > 0)
        camera->near_plane = near_plane;
    if (far_plane > 0)
        camera->far_plane = far_plane;
}

static void take_rotation(struct camera *camera, const struct camera *from)
{
    if (!from->has_rotation)
        return;
    camera->has_rotation = true;
    camera->axis_certain = from->axis_certain;
    memcpy(camera->world_to_view, from->world_to_view, sizeof camera->world_to_view);
    memcpy(camera->rotation_source, from->rotation_source, sizeof camera->rotation_source);
    camera->has_translation = from->has_translation;
    memcpy(camera->translation, from->translation, sizeof camera->translation);
}

/* The lens shift of a file stays: the flags only say how wide the view is. */
static void take_flags(struct camera *camera, const struct camera_flags *flags)
{
    if (flags->fov_deg > 0 || flags->ortho_width > 0)
        camera->remark[0] = camera->unsupported[0] = '\0';
    if (flags->fov_deg > 0) {
        double half = tan(flags->fov_deg * degree / 2.0);
        camera->type = CAMERA_PERSPECTIVE;
        camera->is_assumed = false;
        camera->half_width = flags->fov_is_vertical ? 0 : half;
        camera->half_height = flags->fov_is_vertical ? half : 0;
        snprintf(camera->source, sizeof camera->source, "--fov");
    } else if (flags->ortho_width > 0) {
        camera->type = CAMERA_ORTHOGRAPHIC;
        camera->is_assumed = false;
        camera->half_width = flags->ortho_width / 2.0;
        camera->half_height = 0;
        snprintf(camera->source, sizeof camera->source, "--ortho");
    }
    take_planes(camera, flags->near_plane, flags->far_plane);
}

void camera_resolve(const struct camera_flags *flags, const struct camera *file,
                    const struct exr_info *info, size_t part_index, struct camera *camera)
{
    const struct exr_part *part = &info->parts[part_index];
    camera_from_header(part, camera);
    if (camera->type == CAMERA_UNKNOWN && part_index > 0) { /* many fill the first header only */
        struct camera first;
        camera_from_header(&info->parts[0], &first);
        if (first.type != CAMERA_UNKNOWN || first.unsupported[0] || !camera->has_rotation)
            *camera = first;
    }
    if (file) {
        take_projection(camera, file);
        take_planes(camera, file->near_plane, file->far_plane);
        take_rotation(camera, file);
    }
    take_flags(camera, flags);
    if (camera->type == CAMERA_UNKNOWN) {
        camera->type = CAMERA_PERSPECTIVE;
        camera->half_width = tan(assumed_fov_deg * degree / 2.0);
        camera->source[0] = '\0';
    }
    const struct exr_box *display = &part->display_window;
    double aspect = box_width(display) * (double)part->pixel_aspect / box_height(display);
    if (!(camera->half_height > 0))
        camera->half_height = camera->half_width / aspect;
    if (!(camera->half_width > 0))
        camera->half_width = camera->half_height * aspect;
}

void camera_ray(const struct camera *camera, const struct exr_box *display,
                const struct exr_box *data, double column, double row, double *x, double *y)
{
    double left = (double)data->x_min - (double)display->x_min;
    double top = (double)data->y_min - (double)display->y_min;
    double raster_x = (column + left + 0.5) / box_width(display) * 2.0 - 1.0;
    double raster_y = 1.0 - (row + top + 0.5) / box_height(display) * 2.0;
    *x = camera->half_width * (raster_x + 2.0 * camera->shift_x);
    *y = camera->half_height * (raster_y + 2.0 * camera->shift_y);
}

/* Row 2 for z in [0,1] between the planes. Infinite planes are the limits of the same expression.
 */
static void project_depth(const struct camera *camera, const struct camera_planes *planes,
                          float m[16])
{
    double n = planes->near_plane, f = planes->far_plane;
    if (camera->type == CAMERA_ORTHOGRAPHIC) {
        m[10] = (float)(-1.0 / (f - n));
        m[14] = (float)(-n / (f - n));
    } else if (isinf(f)) {
        m[10] = -1.0f;
        m[14] = (float)-n;
    } else if (isinf(n)) {
        m[10] = 0.0f;
        m[14] = (float)f;
    } else {
        m[10] = (float)(-f / (f - n));
        m[14] = (float)(-f * n / (f - n));
    }
}

void camera_project(const struct camera *camera, const struct camera_planes *planes,
                    const struct exr_box *display, const struct exr_box *data, struct ao_view *view)
{
    float *m = view->projection;
    memset(m, 0, sizeof view->projection);
    m[0] = (float)(1.0 / camera->half_width);
    m[5] = (float)(-1.0 / camera->half_height);
    if (camera->type == CAMERA_ORTHOGRAPHIC) {
        m[12] = (float)(-2.0 * camera->shift_x);
        m[13] = (float)(2.0 * camera->shift_y);
        m[15] = 1.0f;
        view->axis = VKAO_VIEW_AXIS_NEGATIVE_Z;
    } else {
        m[8] = (float)(2.0 * camera->shift_x);
        m[9] = (float)(-2.0 * camera->shift_y);
        m[11] = -1.0f;
        view->axis = VKAO_VIEW_AXIS_FROM_MATRIX;
    }
    project_depth(camera, planes, m);
    view->viewport = (VkRect2D){
        .offset = {display->x_min - data->x_min, display->y_min - data->y_min},
        .extent = {(uint32_t)box_width(display), (uint32_t)box_height(display)},
    };
    static const float identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    memcpy(view->normal_to_view, identity, sizeof identity);
}

bool camera_can_project(const struct ao_view *view)
{
    /* A tenth of what vkao.h allows a texel to span: the place in the display may move it a
     * little. */
    static const double least = 1e-14, most = 1e14;
    const float *m = view->projection;
    const bool perspective = m[11] < 0.0f;
    const double size[2] = {view->viewport.extent.width, view->viewport.extent.height};
    const double offset[2] = {view->viewport.offset.x, view->viewport.offset.y};
    for (int i = 0; i < 16; i++)
        if (!(fabsf(m[i]) <= 1e18f)) /* squares must be finite, and a NaN is no number */
            return false;
    for (int i = 0; i < 2; i++) {
        const double scale = (double)m[i * 5], shift = (double)(perspective ? m[8 + i] : m[12 + i]);
        const double span = fabs(2.0 / size[i] / scale);
        const double corner =
            (fabs((0.5 - offset[i]) * 2.0 / size[i]) + 1.0 + fabs(shift)) / fabs(scale);
        if (!(span >= least && span <= most && corner <= most))
            return false;
    }
    return isnormal(perspective ? m[14] : m[10]);
}

void camera_normal_to_view(const struct camera *camera, float matrix[9])
{
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++)
            matrix[column * 3 + row] = (float)camera->world_to_view[row * 3 + column];
}

bool camera_is_mirrored(const struct camera *camera)
{
    const double *m = camera->world_to_view;
    return m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) +
               m[2] * (m[3] * m[7] - m[4] * m[6]) <
           0;
}

double camera_fov_x_deg(const struct camera *camera)
{
    return 2.0 * atan(camera->half_width) / degree;
}
