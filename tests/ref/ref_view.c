/* SPDX-License-Identifier: MIT */
#include "ref_view.h"

#include <math.h>
#include <string.h>

/* Further than any scene: an infinite far plane comes out of the inverse as some huge or infinite
 * number. */
static const double endless = 1.0e12;

static bool ref_invert(const double m[16], double out[16])
{
    double a[4][8] = {{0}};
    for (int row = 0; row < 4; ++row) {
        for (int column = 0; column < 4; ++column)
            a[row][column] = m[column * 4 + row];
        a[row][4 + row] = 1.0;
    }
    for (int column = 0; column < 4; ++column) {
        int pivot = column;
        for (int row = column + 1; row < 4; ++row)
            pivot = fabs(a[row][column]) > fabs(a[pivot][column]) ? row : pivot;
        if (a[pivot][column] == 0.0)
            return false;
        for (int k = 0; k < 8; ++k) {
            double t = a[column][k];
            a[column][k] = a[pivot][k];
            a[pivot][k] = t;
        }
        double scale = a[column][column];
        for (int k = 0; k < 8; ++k)
            a[column][k] /= scale;
        for (int row = 0; row < 4; ++row) {
            double factor = a[row][column];
            for (int k = 0; row != column && k < 8; ++k)
                a[row][k] -= factor * a[column][k];
        }
    }
    for (int row = 0; row < 4; ++row) {
        for (int column = 0; column < 4; ++column)
            out[column * 4 + row] = a[row][4 + column];
    }
    return true;
}

static double row_times(const double m[16], int row, const double p[4])
{
    return m[row] * p[0] + m[4 + row] * p[1] + m[8 + row] * p[2] + m[12 + row] * p[3];
}

static void transform(const double m[16], const double p[4], double out[4])
{
    for (int row = 0; row < 4; ++row)
        out[row] = row_times(m, row, p);
}

static void texel_to_ndc(const struct ref_view *view, double x, double y, double ndc[2])
{
    ndc[0] = (x + 0.5 - view->viewport[0]) / view->viewport[2] * 2.0 - 1.0;
    ndc[1] = (y + 0.5 - view->viewport[1]) / view->viewport[3] * 2.0 - 1.0;
}

/* The point at this depth on the ray through ndc, +z away from the eye. */
static void unproject(const struct ref_view *view, const double ndc[2], double depth, double out[3])
{
    double p[4];
    transform(view->inverse, (const double[4]){ndc[0], ndc[1], depth, 1.0}, p);
    out[0] = p[0] / p[3];
    out[1] = p[1] / p[3];
    out[2] = view->forward * p[2] / p[3];
}

static double plane_z(const struct ref_view *view, double depth)
{
    double p[3];
    unproject(view, (const double[2]){0.0, 0.0}, depth, p);
    bool past = !view->orthographic && (!(p[2] > 0.0) || p[2] > endless);
    return past ? INFINITY : p[2];
}

static VkRect2D or_else(VkRect2D given, VkRect2D otherwise)
{
    return given.extent.width ? given : otherwise;
}

void ref_view_init(struct ref_view *view, const struct ao_view *from, uint32_t width,
                   uint32_t height, VkFormat depth_format)
{
    memset(view, 0, sizeof *view);
    for (int i = 0; i < 16; ++i)
        view->matrix[i] = (double)from->projection[i];
    if (!ref_invert(view->matrix, view->inverse))
        return;
    view->encoding = from->depth_encoding;
    view->depth_format = depth_format;
    view->valid = or_else(from->valid, (VkRect2D){{0, 0}, {width, height}});
    view->rect = or_else(from->rect, view->valid);
    VkRect2D viewport = or_else(from->viewport, view->valid);
    view->viewport[0] = viewport.offset.x;
    view->viewport[1] = viewport.offset.y;
    view->viewport[2] = viewport.extent.width;
    view->viewport[3] = viewport.extent.height;
    /* A projection is orthographic if w of a point does not depend on the point. */
    double at_one[4], at_two[4], middle[3];
    transform(view->matrix, (const double[4]){0.0, 0.0, 1.0, 1.0}, at_one);
    transform(view->matrix, (const double[4]){0.0, 0.0, 2.0, 1.0}, at_two);
    view->orthographic = at_one[3] == at_two[3];
    view->forward = 1.0;
    unproject(view, (const double[2]){0.0, 0.0}, 0.5, middle);
    view->forward = middle[2] < 0.0 ? -1.0 : 1.0;
    if (view->orthographic && from->axis != VKAO_VIEW_AXIS_FROM_MATRIX)
        view->forward = from->axis == VKAO_VIEW_AXIS_NEGATIVE_Z ? -1.0 : 1.0;
    double z0 = plane_z(view, 0.0), z1 = plane_z(view, 1.0);
    view->far_depth = z1 > z0 ? 1.0 : 0.0;
    view->far_z = fmax(z0, z1);
}

double ref_view_z(const struct ref_view *view, double x, double y, double stored)
{
    double ndc[2], p[3], z;
    texel_to_ndc(view, x, y, ndc);
    if (view->encoding == VKAO_DEPTH_PROJECTED) {
        if (!(view->far_depth > 0.5 ? stored < 1.0 : stored > 0.0))
            return NAN;
        unproject(view, ndc, stored, p);
        return isfinite(p[2]) && (view->orthographic || p[2] > 0.0) ? p[2] : NAN;
    }
    z = stored;
    if (view->encoding == VKAO_DEPTH_INVERSE_Z)
        z = 1.0 / stored;
    if (view->encoding == VKAO_DEPTH_DISTANCE && !view->orthographic) {
        /* Along the ray, z keeps its share of the distance. */
        unproject(view, ndc, 0.5, p);
        z = stored * p[2] / sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    }
    return z > 0.0 && z < view->far_z && isfinite(z) ? z : NAN;
}

/* Between two points of the texel's ray. References ask for this more than for anything else: what
 * both points share is found once. */
void ref_view_position(const struct ref_view *view, double x, double y, double z, double out[3])
{
    const double depths[2] = {0.25, 0.75}, *by_depth = &view->inverse[8];
    double ndc[2], base[4], ends[2][3];
    texel_to_ndc(view, x, y, ndc);
    transform(view->inverse, (const double[4]){ndc[0], ndc[1], 0.0, 1.0}, base);
    for (int end = 0; end < 2; ++end) {
        const double scale = 1.0 / (base[3] + depths[end] * by_depth[3]);
        for (int i = 0; i < 3; ++i)
            ends[end][i] = (base[i] + depths[end] * by_depth[i]) * scale;
        ends[end][2] *= view->forward;
    }
    const double t = (z - ends[0][2]) / (ends[1][2] - ends[0][2]);
    for (int i = 0; i < 3; ++i)
        out[i] = ends[0][i] + t * (ends[1][i] - ends[0][i]);
}

void ref_view_project(const struct ref_view *view, const double p[3], double out[2])
{
    const double point[4] = {p[0], p[1], view->forward * p[2], 1.0};
    const double scale = 0.5 / row_times(view->matrix, 3, point);
    for (int i = 0; i < 2; ++i)
        out[i] = (row_times(view->matrix, i, point) * scale + 0.5) * view->viewport[2 + i] +
                 view->viewport[i] - 0.5;
}

void ref_view_eye(const struct ref_view *view, const double p[3], double out[3])
{
    double length = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    for (int i = 0; i < 3; ++i)
        out[i] = view->orthographic ? (i == 2 ? -1.0 : 0.0) : -p[i] / length;
}

/* Moves the stored depth by one step of its format and sees how far z goes. */
double ref_view_depth_error(const struct ref_view *view, double z)
{
    double rounding = fabs(z) * 0x1p-22;
    bool half = view->depth_format == VK_FORMAT_R16_SFLOAT;
    bool short_fixed =
        view->depth_format == VK_FORMAT_D16_UNORM || view->depth_format == VK_FORMAT_R16_UNORM;
    bool fixed = short_fixed || view->depth_format == VK_FORMAT_X8_D24_UNORM_PACK32;
    double step = short_fixed ? 0x1p-16 : half ? 0x1p-11 : 0x1p-24;
    if (view->encoding != VKAO_DEPTH_PROJECTED)
        return rounding + fabs(z) * step;
    double clip[4];
    transform(view->matrix, (const double[4]){0.0, 0.0, view->forward * z, 1.0}, clip);
    double depth = clip[2] / clip[3];
    /* A floating step is the larger the nearer the depth is to 1. */
    double h = fixed || view->far_depth > 0.5 ? step : step * depth;
    double p[3], q[3];
    unproject(view, (const double[2]){0.0, 0.0}, depth + 0.01 * h, p);
    unproject(view, (const double[2]){0.0, 0.0}, depth - 0.01 * h, q);
    return rounding + fabs(p[2] - q[2]) / 0.02;
}

double ref_scene_z(const struct ref_scene *scene, int x, int y)
{
    const VkRect2D *valid = &scene->view.valid;
    bool inside = x >= valid->offset.x && y >= valid->offset.y &&
                  x < valid->offset.x + (int)valid->extent.width &&
                  y < valid->offset.y + (int)valid->extent.height;
    return inside ? scene->z[(size_t)y * scene->width + (size_t)x] : NAN;
}

bool ref_scene_lookup(const struct ref_scene *scene, const double p[3], double occluder[3])
{
    double at[2];
    if (!scene->view.orthographic && p[2] <= 0.0)
        return false;
    ref_view_project(&scene->view, p, at);
    if (fabs(at[0]) > 1.0e6 || fabs(at[1]) > 1.0e6)
        return false;
    int x = (int)floor(at[0] + 0.5), y = (int)floor(at[1] + 0.5);
    double z = ref_scene_z(scene, x, y);
    if (isnan(z))
        return false;
    ref_view_position(&scene->view, x, y, z, occluder);
    return true;
}
