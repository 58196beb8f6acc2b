/* SPDX-License-Identifier: MIT */
#include "view.h"

#include "formats.h"

#include <float.h>
#include <math.h>

/* Affine use of the projection: clip = scale * view + offset per axis, w = w_z * z + w_1. */
struct projection {
    double x_scale, x_z, x_1;
    double y_scale, y_z, y_1;
    double z_z, z_1;
    double forward; /* +1 or -1: view z times it grows away from the eye */
    bool orthographic;
};

static vkao_result check_finite(const struct vkao_logger *log, const char *name,
                                const float *values, int count)
{
    for (int i = 0; i < count; ++i) {
        if (!isfinite(values[i]))
            return vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT,
                               "view.%s[%d] is %g, want a finite number", name, i,
                               (double)values[i]);
    }
    return VKAO_SUCCESS;
}

static vkao_result orthographic_forward(const struct vkao_logger *log, const vkao_view *view,
                                        struct projection *p)
{
    if (view->axis != VKAO_VIEW_AXIS_FROM_MATRIX) {
        p->forward = view->axis == VKAO_VIEW_AXIS_NEGATIVE_Z ? -1.0 : 1.0;
        return VKAO_SUCCESS;
    }
    /* Depth 0 and 1 lie at these view z; a camera sees more in front of the eye than behind it. */
    double z0 = -p->z_1 / p->z_z, z1 = (1.0 - p->z_1) / p->z_z;
    if (fabs(z0 + z1) <= 1e-6 * fabs(z0 - z1))
        return vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT,
                           "view.axis must be set: near and far plane of this orthographic "
                           "view.projection lie equally far on both sides of the eye");
    p->forward = z0 + z1 < 0.0 ? -1.0 : 1.0;
    return VKAO_SUCCESS;
}

/* Is any device depth of a perspective matrix in front of the eye? Those on one side of the depth
 * at infinity are. That may lie between 0 and 1, where a range of depth is folded in. */
static bool shows_depth(const float *m)
{
    const float at_infinity = m[10] / m[11];
    return m[14] > 0.0f ? at_infinity < 1.0f : at_infinity > 0.0f;
}

static vkao_result read_projection(const struct vkao_logger *log, const vkao_view *view,
                                   struct projection *p)
{
    const float *m = view->projection;
    static const int zero[] = {1, 2, 3, 4, 6, 7}; /* no shear, no rotation, w from z or constant */
    vkao_result result = check_finite(log, "projection", m, 16);
    if (result != VKAO_SUCCESS)
        return result;
    for (size_t i = 0; i < sizeof zero / sizeof zero[0]; ++i) {
        if (m[zero[i]] != 0.0f)
            return vkao_refuse(
                log, VKAO_ERROR_INVALID_ARGUMENT, "view.projection[%d] is %g, want 0: %s", zero[i],
                (double)m[zero[i]],
                zero[i] == 2 || zero[i] == 6
                    ? "the near plane is oblique, or rows stand where columns should; of an "
                      "oblique "
                      "view give VIEW_Z, which does not depend on planes, with the plain matrix"
                    : "sheared and rotated projections are not supported, and m[column * 4 + row] "
                      "holds columns");
    }
    /* -near far / (far - near), or near, stands where w's factor of z should, and that where the
     * former should. */
    if (m[15] == 0.0f && fabsf(m[11]) != 1.0f && fabsf(m[14]) == 1.0f)
        return vkao_refuse(
            log, VKAO_ERROR_INVALID_ARGUMENT,
            "view.projection is transposed or inverse: [11] is %g and [14] is %g, want "
            "[11] 1 or -1 in perspective, as m[column * 4 + row] holds columns",
            (double)m[11], (double)m[14]);
    bool perspective = m[11] != 0.0f && m[15] == 0.0f,
         orthographic = m[11] == 0.0f && m[15] != 0.0f;
    if ((!perspective && !orthographic) || m[0] == 0.0f || m[5] == 0.0f ||
        (orthographic && m[10] == 0.0f) || (perspective && m[14] == 0.0f))
        return vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT,
                           "view.projection is neither a perspective nor an orthographic matrix "
                           "(column-major, [0] %g [5] %g [10] %g [11] %g [14] %g [15] %g)",
                           (double)m[0], (double)m[5], (double)m[10], (double)m[11], (double)m[14],
                           (double)m[15]);
    if (perspective && !shows_depth(m))
        return vkao_refuse(
            log, VKAO_ERROR_INVALID_ARGUMENT,
            "view.projection puts depths 0 to 1 behind the eye ([10] %g [11] %g [14] %g): "
            "is it transposed, or the sign of one of these wrong? m[column * 4 + row] holds "
            "columns",
            (double)m[10], (double)m[11], (double)m[14]);
    /* Scale so that w is distance along the axis, or 1. */
    double w = perspective ? fabs((double)m[11]) : (double)m[15];
    *p = (struct projection){
        .x_scale = m[0] / w,
        .x_z = m[8] / w,
        .x_1 = m[12] / w,
        .y_scale = m[5] / w,
        .y_z = m[9] / w,
        .y_1 = m[13] / w,
        .z_z = m[10] / w,
        .z_1 = m[14] / w,
        .orthographic = orthographic,
        .forward = m[11] > 0.0f ? 1.0 : -1.0,
    };
    if (perspective && (m[12] != 0.0f || m[13] != 0.0f))
        return vkao_refuse(
            log, VKAO_ERROR_INVALID_ARGUMENT,
            "view.projection[12], [13] are %g, %g, want 0 in a perspective matrix: an "
            "off-centre frustum has its offset in [8], [9]",
            (double)m[12], (double)m[13]);
    if (orthographic && (m[8] != 0.0f || m[9] != 0.0f))
        return vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT,
                           "view.projection[8], [9] are %g, %g, want 0 in an orthographic matrix: "
                           "oblique projections are not supported",
                           (double)m[8], (double)m[9]);
    const double axis = view->axis == VKAO_VIEW_AXIS_NEGATIVE_Z ? -1.0 : 1.0;
    if (perspective && view->axis && axis * p->forward < 0.0)
        return vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT,
                           "view.axis is %d, but view.projection looks along %cz ([11] is %g): "
                           "leave it FROM_MATRIX in perspective",
                           (int)view->axis, p->forward < 0.0 ? '-' : '+', (double)m[11]);
    return orthographic ? orthographic_forward(log, view, p) : VKAO_SUCCESS;
}

/* All zero stands for a default; a place without a size is one that was forgotten. */
static bool is_none(VkRect2D given)
{
    return !given.extent.width && !given.extent.height && !given.offset.x && !given.offset.y;
}

static vkao_result resolve_rect(const struct vkao_logger *log, const char *name, VkRect2D given,
                                struct vkao_rect bounds, struct vkao_rect *out)
{
    *out = bounds;
    if (is_none(given))
        return VKAO_SUCCESS;
    int64_t x1 = (int64_t)given.offset.x + given.extent.width,
            y1 = (int64_t)given.offset.y + given.extent.height;
    if (given.extent.width == 0 || given.extent.height == 0 ||
        given.offset.x < (int64_t)bounds.x0 || given.offset.y < (int64_t)bounds.y0 ||
        x1 > (int64_t)bounds.x1 || y1 > (int64_t)bounds.y1)
        return vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT,
                           "view.%s is %ux%u at (%d,%d), want a rectangle inside (%u,%u)..(%u,%u)",
                           name, given.extent.width, given.extent.height, given.offset.x,
                           given.offset.y, bounds.x0, bounds.y0, bounds.x1, bounds.y1);
    *out = (struct vkao_rect){(uint32_t)given.offset.x, (uint32_t)given.offset.y, (uint32_t)x1,
                              (uint32_t)y1};
    return VKAO_SUCCESS;
}

static vkao_result resolve_rects(const struct vkao_logger *log, const vkao_view *view,
                                 VkExtent2D extent, struct vkao_rect *valid, struct vkao_rect *rect)
{
    struct vkao_rect image = {0, 0, extent.width, extent.height};
    vkao_result result = resolve_rect(log, "valid", view->valid, image, valid);
    return result == VKAO_SUCCESS ? resolve_rect(log, "rect", view->rect, *valid, rect) : result;
}

/* What a texel spans, and where the viewport lies, in the range that squares leave floats. */
static vkao_result check_unproject(const struct vkao_logger *log, const struct projection *p,
                                   const struct view_constants *view)
{
    const double least = 1e-15, most = 1e15;
    const double scale[2] = {p->x_scale, p->y_scale};
    for (int i = 0; i < 2; ++i) {
        const double size = fabs((double)view->unproject[i]),
                     offset = fabs((double)view->unproject[2 + i]);
        if (!(size >= least && size <= most && offset <= most))
            return vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT,
                               "view.projection[%d] is %g: a texel spans %g scene units%s, want "
                               "%g..%g, and the image no more",
                               i * 5, scale[i], size, p->orthographic ? "" : " at distance 1",
                               least, most);
    }
    return VKAO_SUCCESS;
}

static void read_unproject(const struct projection *p, const vkao_view *view,
                           struct view_constants *out)
{
    double vx = out->valid.x0, vy = out->valid.y0;
    double vw = out->valid.x1 - out->valid.x0, vh = out->valid.y1 - out->valid.y0;
    if (view->viewport.extent.width) {
        vx = view->viewport.offset.x;
        vy = view->viewport.offset.y;
        vw = view->viewport.extent.width;
        vh = view->viewport.extent.height;
    }
    /* ndc = (texel + 1/2 - viewport) * 2 / size - 1; ndc * w = scale * view + (x_z * z | x_1) */
    double x_offset = p->orthographic ? p->x_1 : p->x_z * p->forward;
    double y_offset = p->orthographic ? p->y_1 : p->y_z * p->forward;
    out->unproject[0] = (float)(2.0 / vw / p->x_scale);
    out->unproject[1] = (float)(2.0 / vh / p->y_scale);
    out->unproject[2] = (float)(((0.5 - vx) * 2.0 / vw - 1.0 - x_offset) / p->x_scale);
    out->unproject[3] = (float)(((0.5 - vy) * 2.0 / vh - 1.0 - y_offset) / p->y_scale);
    out->inverse_unproject[0] = (float)(p->x_scale * vw / 2.0);
    out->inverse_unproject[1] = (float)(p->y_scale * vh / 2.0);
    out->reference_z = p->orthographic ? (float)fabs(2.0 / p->x_scale) : 0.0f;
}

/* The far plane read back from a float matrix is off by up to this much, relative to far / near;
 * what lies that close to it is background too. */
static float far_limit(double near, double far)
{
    double ratio = near > 0.0 ? far / near : 1.0;
    return (float)(far * (1.0 - fmin(0.5, 0x1p-22 * ratio)));
}

/* Of floating depth, relative to that below 1, near the depth of what is far away. */
static double float_step(double at_infinity)
{
    int exponent;
    if (at_infinity <= 0.0)
        return 0.0;
    (void)frexp(at_infinity, &exponent);
    return ldexp(1.0, exponent < 0 ? exponent : 0);
}

/* Device depth to view z. The step of the depth format tells how far z may be off: fixed-point
 * steps are the same everywhere, floating ones shrink towards 0, which is why reversed floating
 * depth is accurate. */
static void read_depth(const struct projection *p, const vkao_effect_info *effect, VkFormat format,
                       struct view_constants *out)
{
    bool floating;
    double step = vkao_format_depth_step(format, &floating);
    if (effect->depth_bits && effect->depth_encoding == VKAO_DEPTH_PROJECTED) {
        floating = effect->depth_bits == 32;
        step = floating ? 0x1p-24 : ldexp(1.0, -(int)effect->depth_bits);
    }
    double rounding = 0x1p-22; /* of the view z that prepare stores, and of the arithmetic on it */
    out->far_z = FLT_MAX;
    out->depth_error[0] = (float)rounding;
    if (p->orthographic) {
        double z0 = p->forward * -p->z_1 / p->z_z, z1 = p->forward * (1.0 - p->z_1) / p->z_z;
        out->far_depth = z1 > z0 ? 1.0f : 0.0f;
        double far = fmax(z0, z1), near = fmin(z0, z1);
        /* Orthographic xy does not depend on z: moving the eye back keeps z positive and changes
         * nothing. */
        double shift = near > 0.0 ? 0.0 : 0.001 * (far - near) - near;
        out->linearize[0] = (float)(z0 + shift);
        out->linearize[1] = (float)(z1 - z0);
        bool projected = effect->depth_encoding == VKAO_DEPTH_PROJECTED;
        out->depth_error[0] = projected ? (float)(step * (far - near)) : 0.0f;
        out->depth_error[1] = (float)(projected ? rounding : rounding + 2.0 * step);
        if (!projected)
            out->far_z = far_limit(near, far);
    } else {
        double add = p->z_z * p->forward, mul = -p->z_1; /* z = mul / (add - depth) */
        double at_one = add == 1.0 ? INFINITY : mul / (add - 1.0),
               at_zero = add == 0.0 ? INFINITY : mul / add;
        bool one_is_far = mul > 0.0;
        /* Negative where the planes of the range that is folded in lie before depth 0 or 1. */
        double far = one_is_far ? at_one : at_zero;
        out->far_depth = one_is_far ? 1.0f : 0.0f;
        out->linearize[0] = (float)mul;
        out->linearize[1] = (float)add;
        if (effect->depth_encoding == VKAO_DEPTH_PROJECTED) {
            out->depth_error[1] = (float)(step * (floating ? float_step(add) : 1.0) / fabs(mul));
        } else if (isfinite(far) && far > 0.0) {
            out->far_z = far_limit(fmin(at_zero, at_one), far);
        }
        /* The point and its occluder err by half a step each; a step is up to twice the format's
         * above a power of two. */
        if (effect->depth_encoding != VKAO_DEPTH_PROJECTED || (floating && !one_is_far))
            out->depth_error[0] += (float)(2.0 * step);
    }
}

static vkao_result check_members(const struct vkao_logger *log, const vkao_view *view)
{
    if ((uint32_t)view->axis > VKAO_VIEW_AXIS_POSITIVE_Z)
        return vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT, "view.axis is %d, want 0..%d",
                           (int)view->axis, (int)VKAO_VIEW_AXIS_POSITIVE_Z);
    const VkRect2D *viewport = &view->viewport;
    if (!is_none(*viewport) && (!viewport->extent.width || !viewport->extent.height))
        return vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT,
                           "view.viewport is %ux%u at (%d,%d), want a size, or all 0",
                           viewport->extent.width, viewport->extent.height, viewport->offset.x,
                           viewport->offset.y);
    if (view->viewport.extent.width > INT32_MAX || view->viewport.extent.height > INT32_MAX)
        return vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT,
                           "view.viewport is %ux%u, want at most %d: for a viewport of negative "
                           "height, negate row 1 of view.projection",
                           view->viewport.extent.width, view->viewport.extent.height, INT32_MAX);
    if (view->padding)
        return vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT, "view.padding is %u, want 0",
                           view->padding);
    return VKAO_SUCCESS;
}

vkao_result vkao_view_rects(const struct vkao_logger *log, const vkao_view *view, VkExtent2D extent,
                            struct vkao_rect *valid, struct vkao_rect *rect)
{
    vkao_result result = check_members(log, view);
    return result == VKAO_SUCCESS ? resolve_rects(log, view, extent, valid, rect) : result;
}

vkao_result vkao_view_constants_init(const struct vkao_logger *log, const vkao_view *view,
                                     const vkao_effect_info *effect, VkExtent2D extent,
                                     VkFormat depth_format, struct view_constants *out)
{
    struct projection p = {0};
    vkao_result result = check_members(log, view);
    if (result == VKAO_SUCCESS)
        result = check_finite(log, "normal_to_view", view->normal_to_view, 9);
    if (result == VKAO_SUCCESS)
        result = read_projection(log, view, &p);
    if (result != VKAO_SUCCESS)
        return result;
    if (p.orthographic != (effect->projection == VKAO_PROJECTION_ORTHOGRAPHIC))
        return vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT,
                           "view.projection is %s ([11] is %g, [15] %g), but effect.projection is "
                           "%s: views of the other kind need an effect of their own",
                           p.orthographic ? "orthographic" : "perspective",
                           (double)view->projection[11], (double)view->projection[15],
                           p.orthographic ? "PERSPECTIVE" : "ORTHOGRAPHIC");
    *out = (struct view_constants){.orthographic = p.orthographic};
    result = resolve_rects(log, view, extent, &out->valid, &out->rect);
    if (result != VKAO_SUCCESS)
        return result;
    read_unproject(&p, view, out);
    read_depth(&p, effect, depth_format, out);
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
            float v = view->normal_to_view[column * 3 + row];
            out->normal_rows[row][column] = row == 2 ? v * (float)p.forward : v;
        }
    }
    return check_unproject(log, &p, out);
}

struct view_constants vkao_view_halve(const struct view_constants *view)
{
    struct view_constants half = *view;
    half.unproject[0] *= 2.0f;
    half.unproject[1] *= 2.0f;
    half.inverse_unproject[0] *= 0.5f;
    half.inverse_unproject[1] *= 0.5f;
    half.valid = (struct vkao_rect){view->valid.x0 / 2, view->valid.y0 / 2,
                                    (view->valid.x1 + 1) / 2, (view->valid.y1 + 1) / 2};
    /* upsample.comp reads from one half-resolution texel before to two behind. */
    const uint32_t x1 = (view->rect.x1 - 1) / 2 + 2, y1 = (view->rect.y1 - 1) / 2 + 2;
    half.rect = (struct vkao_rect){view->rect.x0 / 2, view->rect.y0 / 2,
                                   x1 < half.valid.x1 ? x1 : half.valid.x1,
                                   y1 < half.valid.y1 ? y1 : half.valid.y1};
    half.rect = vkao_rect_grow(half.rect, 1, 1, half.valid);
    return half;
}

struct vkao_rect vkao_rect_grow(struct vkao_rect rect, uint32_t x, uint32_t y,
                                struct vkao_rect bounds)
{
    struct vkao_rect grown = {
        .x0 = rect.x0 - bounds.x0 > x ? rect.x0 - x : bounds.x0,
        .y0 = rect.y0 - bounds.y0 > y ? rect.y0 - y : bounds.y0,
        .x1 = bounds.x1 - rect.x1 > x ? rect.x1 + x : bounds.x1,
        .y1 = bounds.y1 - rect.y1 > y ? rect.y1 + y : bounds.y1,
    };
    return grown;
}

void vkao_rect_pack(struct vkao_rect rect, uint32_t out[2])
{
    out[0] = rect.x0 | rect.y0 << 16;
    out[1] = rect.x1 | rect.y1 << 16;
}
