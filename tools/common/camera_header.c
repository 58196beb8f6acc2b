/* SPDX-License-Identifier: MIT
 *
 * Cameras in OpenEXR headers: the standard matrices, and what renderers add. */
#include "camera.h"

#include "text.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double degree = 3.14159265358979323846 / 180.0;

/* --- Attributes --- */

/* name may hold one '*', for the part of a name that the user chose. */
static bool name_fits(const char *name, const char *pattern)
{
    const char *star = strchr(pattern, '*');
    size_t before = star ? (size_t)(star - pattern) : 0;
    if (!star)
        return strcmp(name, pattern) == 0;
    return strlen(name) >= strlen(pattern) && strncmp(name, pattern, before) == 0 &&
           text_ends_with(name, star + 1);
}

static const struct exr_attribute *find(const struct exr_part *part, const char *pattern)
{
    for (size_t i = 0; i < part->attribute_count; i++)
        if (name_fits(part->attributes[i].name, pattern))
            return &part->attributes[i];
    return NULL;
}

/* The index-th number of a float, double, vector or text attribute ("36.0,24.0"); 0 if there is
 * none. Unreal writes all of its numbers as text. */
static double number(const struct exr_part *part, const char *pattern, size_t index)
{
    const struct exr_attribute *a = find(part, pattern);
    if (!a)
        return 0;
    if (a->numbers && index < a->number_count)
        return isfinite(a->numbers[index]) ? a->numbers[index] : 0;
    const char *text = a->text;
    for (size_t i = 0; text && i < index; i++) {
        text = strchr(text, ',');
        text = text ? text + 1 : NULL;
    }
    char word[64];
    double value;
    if (!text)
        return 0;
    while (*text == ' ')
        text++;
    snprintf(word, sizeof word, "%.*s", (int)strcspn(text, ", "), text);
    return text_to_number(word, &value) && isfinite(value) ? value : 0;
}

/* --- worldToCamera and worldToNDC --- */

/* Matrices for row vectors, as OpenEXR specifies: p' = p m, m[row][column]. */
struct matrix {
    double m[4][4];
};

static bool read_matrix(const struct exr_part *part, const char *name, struct matrix *matrix)
{
    const struct exr_attribute *a = find(part, name);
    if (!a || !a->numbers || a->number_count != 16)
        return false;
    for (size_t i = 0; i < 16; i++) {
        if (!isfinite(a->numbers[i]))
            return false;
        matrix->m[i / 4][i % 4] = a->numbers[i];
    }
    return true;
}

static struct matrix transposed(const struct matrix *a)
{
    struct matrix t;
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            t.m[i][j] = a->m[j][i];
    return t;
}

static struct matrix product(const struct matrix *a, const struct matrix *b)
{
    struct matrix p = {{{0}}};
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            for (int k = 0; k < 4; k++)
                p.m[i][j] += a->m[i][k] * b->m[k][j];
    return p;
}

/* Gauss-Jordan with row pivots. */
static bool inverse(struct matrix a, struct matrix *out)
{
    struct matrix r = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
    for (int c = 0; c < 4; c++) {
        int pivot = c;
        for (int i = c + 1; i < 4; i++)
            if (fabs(a.m[i][c]) > fabs(a.m[pivot][c]))
                pivot = i;
        if (!(fabs(a.m[pivot][c]) > 1e-12))
            return false;
        for (int j = 0; j < 4; j++) {
            double x = a.m[c][j], y = r.m[c][j];
            a.m[c][j] = a.m[pivot][j];
            r.m[c][j] = r.m[pivot][j];
            a.m[pivot][j] = x;
            r.m[pivot][j] = y;
        }
        double scale = 1.0 / a.m[c][c];
        for (int j = 0; j < 4; j++) {
            a.m[c][j] *= scale;
            r.m[c][j] *= scale;
        }
        for (int i = 0; i < 4; i++) {
            double factor = a.m[i][c];
            for (int j = 0; i != c && j < 4; j++) {
                a.m[i][j] -= factor * a.m[c][j];
                r.m[i][j] -= factor * r.m[c][j];
            }
        }
    }
    *out = r;
    return true;
}

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

/* camera space to NDC. What NDC is, [0,1] with y down as specified or [-1,1] with y up as others
 * write, shows on the optical axis. */
static bool take_ndc(const struct matrix *m, struct camera *camera)
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
    camera->shift_x = -axis_x / 2.0;
    camera->shift_y = (y_down ? axis_y : -axis_y) / 2.0;
    snprintf(camera->source, sizeof camera->source, "worldToNDC");
    return true;
}

/* OpenEXR's camera space looks along +z, ours along -z: turn its z round, unless w says that it
 * looks along -z. */
static void take_world_to_camera(const struct matrix *m, bool looks_along_minus_z,
                                 struct camera *camera)
{
    for (int row = 0; row < 3; row++) {
        double length = sqrt(m->m[0][row] * m->m[0][row] + m->m[1][row] * m->m[1][row] +
                             m->m[2][row] * m->m[2][row]);
        if (!(length > 1e-12))
            return;
        double sign = row == 2 && !looks_along_minus_z ? -1.0 : 1.0;
        for (int column = 0; column < 3; column++)
            camera->world_to_view[row * 3 + column] = sign * m->m[column][row] / length;
    }
    camera->has_rotation = true;
    snprintf(camera->rotation_source, sizeof camera->rotation_source, "worldToCamera");
}

static void take_matrices(const struct exr_part *part, struct camera *camera)
{
    struct matrix to_camera, to_ndc, to_world;
    if (!read_matrix(part, "worldToCamera", &to_camera))
        return;
    bool columns = is_for_columns(&to_camera), ndc = read_matrix(part, "worldToNDC", &to_ndc);
    if (columns)
        to_camera = transposed(&to_camera);
    bool minus_z = false, projected = false;
    struct matrix inverted;
    if (ndc && inverse(to_camera, &to_world)) {
        struct matrix rows = columns ? transposed(&to_ndc) : to_ndc;
        struct matrix m = product(&to_world, &rows);
        /* A camera at the origin does not tell rows from columns, but its w does: it is z alone. */
        if (!has_translation(&to_camera) && fabs(fabs(m.m[2][3]) - 1.0) > 1e-3 &&
            inverse(transposed(&to_camera), &inverted)) {
            struct matrix turned = transposed(&to_ndc);
            struct matrix other = product(&inverted, &turned);
            if (fabs(fabs(other.m[2][3]) - 1.0) < 1e-3) {
                to_camera = transposed(&to_camera);
                m = other;
            }
        }
        projected = take_ndc(&m, camera);
        minus_z = projected && camera->type == CAMERA_PERSPECTIVE && m.m[2][3] < 0;
    }
    take_world_to_camera(&to_camera, minus_z, camera);
    camera->axis_certain = projected && camera->type == CAMERA_PERSPECTIVE;
}

/* --- Fields of view --- */

struct fov_row {
    const char *fov;            /* degrees, horizontal */
    const char *focal, *sensor; /* millimetres, if fov is NULL */
    bool sensor_may_be_inches;
};

/* In this order: V-Ray's fov includes focus breathing, so it comes before its lens. */
static const struct fov_row fov_table[] = {
    {.fov = "cameraFov"},
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

static void take_fov(const struct exr_part *part, struct camera *camera)
{
    for (size_t i = 0; i < sizeof fov_table / sizeof *fov_table; i++) {
        const struct fov_row *row = &fov_table[i];
        double half = 0;
        if (row->fov) {
            double fov = number(part, row->fov, 0);
            half = fov > 0 && fov < 179.9 ? tan(fov * degree / 2.0) : 0;
        } else {
            double focal = number(part, row->focal, 0), sensor = number(part, row->sensor, 0);
            /* Maya has inches here (1.417 = 36 mm); no film is 5 mm wide. */
            if (row->sensor_may_be_inches && sensor < 5.0)
                sensor *= 25.4;
            half = focal > 0 && sensor > 0 ? sensor / (2.0 * focal) : 0;
        }
        if (half > 0) {
            camera->type = CAMERA_PERSPECTIVE;
            camera->half_width = half;
            snprintf(camera->source, sizeof camera->source, "%s", row->fov ? row->fov : row->focal);
            return;
        }
    }
}

void camera_from_header(const struct exr_part *part, struct camera *camera)
{
    *camera = (struct camera){0};
    take_matrices(part, camera);
    if (camera->type == CAMERA_UNKNOWN)
        take_fov(part, camera);
    static const char *const near_names[] = {"near", "nearPlane", "cameraNearClip",
                                             "arnold/camera/near_clip", "rs/camera/nearPlane"};
    static const char *const far_names[] = {"far", "farPlane", "cameraFarClip",
                                            "arnold/camera/far_clip", "rs/camera/farPlane"};
    for (size_t i = 0; i < sizeof near_names / sizeof *near_names; i++) {
        double n = number(part, near_names[i], 0), f = number(part, far_names[i], 0);
        if (n > 0 && !(camera->near_plane > 0))
            camera->near_plane = n;
        if (f > 0 && !(camera->far_plane > 0))
            camera->far_plane = f;
    }
}
