/* SPDX-License-Identifier: MIT
 *
 * Cameras in OpenEXR headers: the standard matrices, and what renderers add. Where two attributes
 * speak of the same thing, the surer one is taken, and a contradiction is kept as a remark. */
#include "camera.h"

#include "matrix.h"
#include "text.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static const double degree = 3.14159265358979323846 / 180.0;

/* --- Attributes --- */

/* pattern may hold one '*', for the part of a name that the user chose. */
static bool name_fits(const char *name, const char *pattern)
{
    const char *star = strchr(pattern, '*');
    size_t before = star ? (size_t)(star - pattern) : 0;
    if (!star)
        return strcmp(name, pattern) == 0;
    return strlen(name) + 1 >= strlen(pattern) && strncmp(name, pattern, before) == 0 &&
           text_ends_with(name, star + 1);
}

static const struct exr_attribute *find(const struct exr_part *part, const char *pattern)
{
    for (size_t i = 0; i < part->attribute_count; i++)
        if (name_fits(part->attributes[i].name, pattern))
            return &part->attributes[i];
    return NULL;
}

/* The index-th number of a float, double, vector or text attribute ("36.0,24.0"). Unreal writes
 * all of its numbers as text. */
static bool read_number(const struct exr_part *part, const char *pattern, size_t index,
                        double *value)
{
    const struct exr_attribute *a = find(part, pattern);
    if (!a)
        return false;
    if (a->numbers) {
        *value = index < a->number_count ? a->numbers[index] : NAN;
        return isfinite(*value);
    }
    const char *text = a->text;
    for (size_t i = 0; text && i < index; i++) {
        text = strchr(text, ',');
        text = text ? text + 1 : NULL;
    }
    if (!text)
        return false;
    char word[64];
    text += strspn(text, " ([");
    snprintf(word, sizeof word, "%.*s", (int)strcspn(text, ", )]"), text);
    return text_to_number(word, value) && isfinite(*value);
}

/* The same; 0 if there is none. */
static double number(const struct exr_part *part, const char *pattern, size_t index)
{
    double value;
    return read_number(part, pattern, index, &value) ? value : 0;
}

static bool read_matrix(const struct exr_part *part, const char *name, struct matrix *matrix)
{
    for (size_t i = 0; i < 16; i++)
        if (!read_number(part, name, i, &matrix->m[i / 4][i % 4]))
            return false;
    return true;
}

/* --- Remarks --- */

TOOL_PRINTF(2, 3) static void remark(struct camera *camera, const char *format, ...)
{
    size_t length = strlen(camera->remark);
    va_list arguments;
    if (length > 0 && length + 2 < sizeof camera->remark) {
        memcpy(camera->remark + length, "; ", 3);
        length += 2;
    }
    va_start(arguments, format);
    vsnprintf(camera->remark + length, sizeof camera->remark - length, format, arguments);
    va_end(arguments);
}

static double box_aspect(const struct exr_part *part)
{
    const struct exr_box *box = &part->display_window;
    return ((double)box->x_max - box->x_min + 1.0) / ((double)box->y_max - box->y_min + 1.0) *
           (double)part->pixel_aspect;
}

static double fov_of(double half_width)
{
    return 2.0 * atan(half_width) / degree;
}

/* --- Projections from matrices --- */

/* pbrt writes matrices for column vectors, with the translation in the last column. */
static bool is_for_columns(const struct matrix *m)
{
    double row = fabs(m->m[3][0]) + fabs(m->m[3][1]) + fabs(m->m[3][2]);
    double column = fabs(m->m[0][3]) + fabs(m->m[1][3]) + fabs(m->m[2][3]);
    return row == 0 && column > 0;
}

static bool has_translation(const struct matrix *m)
{
    double sum = 0;
    for (int i = 0; i < 3; i++)
        sum += fabs(m->m[3][i]) + fabs(m->m[i][3]);
    return sum > 0;
}

/* What float matrices leave of none at all is none. */
static double rounded_shift(double shift)
{
    return fabs(shift) < 1e-6 ? 0 : shift;
}

/* Where z of NDC is 0 and 1, which is what writers of matrices mean by their planes. */
static void take_ndc_planes(const struct matrix *m, struct camera *camera)
{
    const double sign = m->m[2][3] < 0 ? -1.0 : 1.0, w = fabs(m->m[2][3]);
    const double near_plane = -m->m[3][2] / (m->m[2][2] * sign);
    const double far_plane = m->m[3][2] / (w - m->m[2][2] * sign);
    if (isfinite(near_plane) && isfinite(far_plane) && near_plane > 0 && far_plane > near_plane) {
        camera->near_plane = near_plane;
        camera->far_plane = far_plane;
    }
}

/* camera space to NDC. What NDC is, [0,1] with y down as specified or [-1,1] with y up as others
 * write, shows on the optical axis. */
static bool take_ndc(const struct matrix *m, const char *name, struct camera *camera)
{
    double z_to_w = m->m[2][3], one_to_w = m->m[3][3];
    bool perspective = fabs(z_to_w) > 1e-6 * fabs(one_to_w);
    double w = perspective ? z_to_w : one_to_w;
    if (!(fabs(w) > 0) || fabs(m->m[0][3]) + fabs(m->m[1][3]) > 1e-3 * fabs(w))
        return false;
    const double *at_axis = perspective ? m->m[2] : m->m[3];
    double scale_x = m->m[0][0] / w, scale_y = m->m[1][1] / w;
    double axis_x = at_axis[0] / w, axis_y = at_axis[1] / w;
    if (!(fabs(scale_x) > 0) || !(fabs(scale_y) > 0))
        return false;
    bool y_down = (scale_y * (perspective && z_to_w < 0 ? -1.0 : 1.0)) < 0;
    if (fabs(axis_x - 0.5) + fabs(axis_y - 0.5) < fabs(axis_x) + fabs(axis_y)) {
        scale_x *= 2.0;
        scale_y *= 2.0;
        axis_x = axis_x * 2.0 - 1.0;
        axis_y = axis_y * 2.0 - 1.0;
    }
    camera->type = perspective ? CAMERA_PERSPECTIVE : CAMERA_ORTHOGRAPHIC;
    camera->half_width = 1.0 / fabs(scale_x);
    camera->half_height = 1.0 / fabs(scale_y);
    camera->shift_x = rounded_shift(-axis_x / 2.0);
    camera->shift_y = rounded_shift((y_down ? axis_y : -axis_y) / 2.0);
    if (perspective)
        take_ndc_planes(m, camera);
    snprintf(camera->source, sizeof camera->source, "%s", name);
    return true;
}

/* OpenEXR's camera space looks along +z, ours along -z: turn its z round, unless w says that it
 * looks along -z. */
static void take_world_to_camera(const struct matrix *m, bool looks_along_minus_z,
                                 const char *source, struct camera *camera)
{
    for (int row = 0; row < 3; row++) {
        double length = sqrt(m->m[0][row] * m->m[0][row] + m->m[1][row] * m->m[1][row] +
                             m->m[2][row] * m->m[2][row]);
        if (!(length > 1e-12))
            return;
        double sign = row == 2 && !looks_along_minus_z ? -1.0 : 1.0;
        for (int column = 0; column < 3; column++)
            camera->world_to_view[row * 3 + column] = sign * m->m[column][row] / length;
        camera->translation[row] = sign * m->m[3][row] / length;
    }
    camera->has_rotation = camera->has_translation = true;
    snprintf(camera->rotation_source, sizeof camera->rotation_source, "%s", source);
}

/* The world's projection by a matrix of this name, given where the camera is. Turns to_camera if
 * only that makes sense of it. */
static bool take_projection(const struct exr_part *part, const char *name, bool columns,
                            struct matrix *to_camera, struct matrix *projection,
                            struct camera *camera)
{
    struct matrix to_ndc, to_world, inverted;
    if (!read_matrix(part, name, &to_ndc) || !matrix_inverse(*to_camera, &to_world))
        return false;
    struct matrix rows = columns ? matrix_transposed(&to_ndc) : to_ndc;
    struct matrix m = matrix_product(&to_world, &rows);
    /* A camera at the origin does not tell rows from columns, but its w does: it is z alone. */
    if (!has_translation(to_camera) && fabs(fabs(m.m[2][3]) - 1.0) > 1e-3 &&
        matrix_inverse(matrix_transposed(to_camera), &inverted)) {
        struct matrix turned = matrix_transposed(&to_ndc);
        struct matrix other = matrix_product(&inverted, &turned);
        if (fabs(fabs(other.m[2][3]) - 1.0) < 1e-3) {
            *to_camera = matrix_transposed(to_camera);
            m = other;
        }
    }
    *projection = m;
    /* Karma writes worldToCamera once more under this name. */
    if (matrix_is_rigid(&m)) {
        remark(camera, "%s is no projection and not believed", name);
        return false;
    }
    if (!take_ndc(&m, name, camera)) {
        remark(camera, "%s and worldToCamera make no projection and are not believed", name);
        return false;
    }
    double aspect = camera->half_width / camera->half_height;
    if (fabs(log(aspect / box_aspect(part))) > 0.02) {
        remark(camera, "%s has an aspect ratio of %.4g, the image %.4g: its width is taken", name,
               aspect, box_aspect(part));
        camera->half_height = 0;
    }
    return true;
}

static void take_matrices(const struct exr_part *part, struct camera *camera)
{
    static const char *const names[] = {"worldToNDC", "worldToScreen"};
    struct matrix to_camera, m = {{{0}}};
    if (!read_matrix(part, "worldToCamera", &to_camera))
        return;
    bool columns = is_for_columns(&to_camera), projected = false;
    if (columns)
        to_camera = matrix_transposed(&to_camera);
    for (size_t i = 0; !projected && i < sizeof names / sizeof *names; i++)
        projected = take_projection(part, names[i], columns, &to_camera, &m, camera);
    camera->axis_certain = projected && camera->type == CAMERA_PERSPECTIVE;
    take_world_to_camera(&to_camera, camera->axis_certain && m.m[2][3] < 0, "worldToCamera",
                         camera);
}

/* --- Rotations that renderers write in their own ways --- */

/* camera to world; the rows of its rotation are the axes of the camera, whether the translation
 * stands in the last row or in the last column. */
static void take_camera_transform(const struct exr_part *part, const char *name,
                                  struct camera *camera)
{
    struct matrix to_world, to_camera;
    if (camera->has_rotation || !read_matrix(part, name, &to_world))
        return;
    if (is_for_columns(&to_world))
        to_world = matrix_transposed(&to_world);
    if (matrix_inverse(to_world, &to_camera))
        take_world_to_camera(&to_camera, true, name, camera);
}

/* Unreal's world is left-handed: x forwards, y to the right, z up. Roll turns round x, pitch
 * round y, yaw round z, in this order. */
static void take_unreal_rotation(const struct exr_part *part, struct camera *camera)
{
    double pitch, yaw, roll;
    if (camera->has_rotation || !read_number(part, "unreal/camera/*curRot/pitch", 0, &pitch) ||
        !read_number(part, "unreal/camera/*curRot/yaw", 0, &yaw) ||
        !read_number(part, "unreal/camera/*curRot/roll", 0, &roll))
        return;
    const double cp = cos(pitch * degree), sp = sin(pitch * degree), cy = cos(yaw * degree),
                 sy = sin(yaw * degree), cr = cos(roll * degree), sr = sin(roll * degree);
    const double rows[9] = {
        sr * sp * cy - cr * sy,
        sr * sp * sy + cr * cy,
        -sr * cp, /* right */
        -(cr * sp * cy + sr * sy),
        cy * sr - cr * sp * sy,
        cr * cp, /* up */
        -cp * cy,
        -cp * sy,
        -sp, /* backwards */
    };
    memcpy(camera->world_to_view, rows, sizeof rows);
    camera->has_rotation = camera->axis_certain = true;
    snprintf(camera->rotation_source, sizeof camera->rotation_source, "unreal/camera/curRot");
}

/* --- Fields of view --- */

struct fov_row {
    const char *fov;            /* degrees, horizontal */
    const char *focal, *sensor; /* of one unit, if fov is NULL */
    bool sensor_may_be_inches;  /* or of millimetres and inches */
};

/* In this order: V-Ray's fov includes focus breathing, so it comes before its lens. */
static const struct fov_row fov_table[] = {
    {.fov = "cameraFov"},
    {.fov = "CameraFov"},
    {.fov = "rs/camera/fov"},
    {.fov = "unreal/camera/*/fov"},
    {.fov = "arnold/camera/fov"},
    {.focal = "unreal/camera/*/focalLength", .sensor = "unreal/camera/*/sensorWidth"},
    {.focal = "CameraFocalLength",
     .sensor = "CameraFilmApertureHorizontal",
     .sensor_may_be_inches = true},
    {.focal = "pinholeFocalLength", .sensor = "sensorOverallDimensions"},
    {.focal = "cameraFocalLength", .sensor = "cameraAperture"},
};

/* Half widths by one row, 0 if it has none. Arnold 7 has one unit for both; Maya has inches and
 * millimetres (1.417 = 36 mm), and no lens of 8 mm has a film of 3 mm. */
static double half_width_by(const struct exr_part *part, const struct fov_row *row)
{
    if (row->fov) {
        double fov = number(part, row->fov, 0);
        return fov > 0 && fov < 179.9 ? tan(fov * degree / 2.0) : 0;
    }
    double focal = number(part, row->focal, 0), sensor = number(part, row->sensor, 0);
    if (row->sensor_may_be_inches && sensor < 3.0 && focal > 8.0)
        sensor *= 25.4;
    return focal > 0 && sensor > 0 ? sensor / (2.0 * focal) : 0;
}

/* Unreal's cameras do not know how much more is rendered around what they see. Where the data
 * window says so, theirs is the display window. */
static double overscan_of(const struct exr_part *part, const char *name)
{
    const struct exr_box *data = &part->data_window, *display = &part->display_window;
    double more = number(part, "unreal/camera/*overscanPercentage", 0);
    if (!text_starts_with(name, "unreal/") || !(more > 0 && more <= 100) ||
        data->x_min < display->x_min || data->x_max > display->x_max)
        return 1.0;
    return 1.0 + (more > 1 ? more / 100.0 : more);
}

/* Focus breathing makes a lens some per cent longer than it says. */
static bool agree(const struct fov_row *row, double a, double b)
{
    return fabs(log(a / b)) < (row->fov ? 0.01 : 0.06);
}

/* What the rows say comes before a matrix, which may be for another window, but a matrix that
 * agrees has the lens shift too. */
static void take_fov(const struct exr_part *part, struct camera *camera)
{
    const struct fov_row *taken = NULL;
    const bool by_matrix = camera->type != CAMERA_UNKNOWN;
    for (size_t i = 0; i < sizeof fov_table / sizeof *fov_table; i++) {
        const struct fov_row *row = &fov_table[i];
        const char *name = row->fov ? row->fov : row->focal;
        const double overscan = overscan_of(part, name);
        double half = half_width_by(part, row) * overscan;
        if (!(half > 0))
            continue;
        if (overscan > 1 && !taken)
            remark(camera, "%s is %.4g degrees with an overscan of %.3g %%", name, fov_of(half),
                   (overscan - 1.0) * 100.0);
        if (camera->type == CAMERA_ORTHOGRAPHIC)
            return; /* renderers write a field of view beside it, which means nothing */
        if (camera->type != CAMERA_UNKNOWN && agree(row, half, camera->half_width))
            continue;
        bool take = !taken && (row->fov || !by_matrix);
        if (camera->type != CAMERA_UNKNOWN)
            remark(camera, "%s says %.4g degrees, %s %.4g: %s is taken", name, fov_of(half),
                   camera->source, fov_of(camera->half_width), take ? name : camera->source);
        if (!take)
            continue;
        taken = row;
        camera->type = CAMERA_PERSPECTIVE;
        camera->half_width = half;
        camera->half_height = camera->shift_x = camera->shift_y = 0;
        snprintf(camera->source, sizeof camera->source, "%s", name);
    }
}

/* --- The whole header --- */

/* A panorama's texels are no plane's. */
static void find_unsupported(const struct exr_part *part, struct camera *camera)
{
    double projection = number(part, "cameraProjection", 0);
    if (fabs(projection) > 0)
        snprintf(camera->unsupported, sizeof camera->unsupported, "cameraProjection is %g",
                 projection);
    if (find(part, "envmap"))
        snprintf(camera->unsupported, sizeof camera->unsupported, "envmap is set");
}

void camera_from_header(const struct exr_part *part, struct camera *camera)
{
    *camera = (struct camera){0};
    take_matrices(part, camera);
    take_camera_transform(part, "cameraTransform", camera);
    take_camera_transform(part, "rs/camera/transform", camera);
    take_unreal_rotation(part, camera);
    find_unsupported(part, camera);
    if (!camera->unsupported[0])
        take_fov(part, camera);
    static const char *const near_names[] = {"near",
                                             "nearPlane",
                                             "clipNear",
                                             "cameraNearClip",
                                             "arnold/camera/near_clip",
                                             "rs/camera/nearPlane"};
    static const char *const far_names[] = {"far",
                                            "farPlane",
                                            "clipFar",
                                            "cameraFarClip",
                                            "arnold/camera/far_clip",
                                            "rs/camera/farPlane"};
    double n = 0, f = 0;
    for (size_t i = 0; i < sizeof near_names / sizeof *near_names; i++) {
        n = n > 0 ? n : number(part, near_names[i], 0);
        f = f > 0 ? f : number(part, far_names[i], 0);
    }
    camera->near_plane = n > 0 ? n : camera->near_plane;
    camera->far_plane = f > 0 ? f : camera->far_plane;
}
