/* SPDX-License-Identifier: MIT
 *
 * The mathematics of views, against the caller's 4x4 matrix in double precision: whatever the
 * projection, a texel and its depth lead back to the point that was projected there. */
#include "view.h"
#include "world.h"

#include <float.h>
#include <math.h>
#include <string.h>

static const struct vkao_logger silent;
static const VkExtent2D extent = {640, 360};

struct camera {
    bool orthographic, left_handed, reversed, infinite, off_centre, flipped;
    double near, far;
    double depth_min, depth_max; /* of the viewport */
    float scale;                 /* of the whole matrix: clip space is homogeneous */
};

/* The viewport's minDepth and maxDepth, as an engine folds them into the matrix. */
static const double ranges[][2] = {{0.0, 1.0}, {0.5, 1.0}, {0.1, 0.9}, {0.0, 0.4},
                                   {1.0, 0.0}, {0.9, 0.1}, {1.0, 0.6}, {0.3, 0.35}};

enum { PLAIN_CAMERAS = 128, CAMERAS = PLAIN_CAMERAS * COUNT(ranges) };

/* Every combination; an infinite orthographic one falls back to finite. */
static struct camera camera_of(unsigned index)
{
    struct camera c = {
        .orthographic = index & 1u,
        .left_handed = index >> 1 & 1u,
        .reversed = index >> 2 & 1u,
        .infinite = index >> 3 & 1u,
        .off_centre = index >> 4 & 1u,
        .flipped = index >> 5 & 1u,
        .near = 0.25,
        .far = 50.0,
        .scale = index >> 6 & 1u ? 2.5f : 1.0f,
        .depth_min = ranges[index / PLAIN_CAMERAS][0],
        .depth_max = ranges[index / PLAIN_CAMERAS][1],
    };
    if (c.orthographic)
        c.infinite = false;
    return c;
}

/* depth(distance) = a + b / distance, or a + b * distance in orthographic views. */
static void depth_terms(const struct camera *c, double *a, double *b)
{
    const double n = c->near, f = c->far;
    double at_near = c->reversed ? 1.0 : 0.0, at_far = 1.0 - at_near;
    if (c->orthographic)
        *b = (at_far - at_near) / (f - n);
    else if (c->infinite)
        *b = (at_near - at_far) * n;
    else
        *b = (at_near - at_far) / (1.0 / n - 1.0 / f);
    if (c->orthographic)
        *a = at_near - *b * n;
    else
        *a = c->infinite ? at_far : at_far - *b / f;
    *a = c->depth_min + *a * (c->depth_max - c->depth_min);
    *b *= c->depth_max - c->depth_min;
}

/* Is depth the greater the nearer it is? */
static bool falls(const struct camera *c)
{
    return c->reversed != (c->depth_min > c->depth_max);
}

/* Do depths 0 and 1 lie at the planes? Else they lie before, beyond, or on the other side of the
 * eye. */
static bool has_planes_at_zero_and_one(const struct camera *c)
{
    return fabs(c->depth_max - c->depth_min) == 1.0;
}

static vkao_view view_of(const struct camera *c)
{
    vkao_view view = vkao_view_default();
    const double forward = c->left_handed ? 1.0 : -1.0;
    double a, b;
    if (c->orthographic && !has_planes_at_zero_and_one(c))
        view.axis = c->left_handed ? VKAO_VIEW_AXIS_POSITIVE_Z : VKAO_VIEW_AXIS_NEGATIVE_Z;
    depth_terms(c, &a, &b);
    double m[16] = {0};
    m[0] = c->orthographic ? 0.2 : 1.3;
    m[5] = (c->flipped ? -1.0 : 1.0) * (c->orthographic ? 0.35 : 2.1);
    if (c->orthographic) {
        m[10] = b * forward;
        m[14] = a;
        m[15] = 1.0;
        m[12] = c->off_centre ? 0.3 : 0.0;
        m[13] = c->off_centre ? -0.2 : 0.0;
    } else {
        m[10] = a * forward;
        m[14] = b;
        m[11] = forward;
        m[8] = c->off_centre ? 0.3 : 0.0;
        m[9] = c->off_centre ? -0.2 : 0.0;
    }
    for (int i = 0; i < 16; ++i)
        view.projection[i] = (float)m[i] * c->scale;
    return view;
}

static void transform(const double m[16], const double v[4], double out[4])
{
    for (int row = 0; row < 4; ++row) {
        out[row] = 0.0;
        for (int column = 0; column < 4; ++column)
            out[row] += m[column * 4 + row] * v[column];
    }
}

/* Gauss-Jordan with pivoting; the reference knows nothing of the form of a projection. */
static void invert(const double in[16], double out[16])
{
    double a[4][8];
    for (int row = 0; row < 4; ++row) {
        for (int column = 0; column < 4; ++column) {
            a[row][column] = in[column * 4 + row];
            a[row][column + 4] = row == column ? 1.0 : 0.0;
        }
    }
    for (int k = 0; k < 4; ++k) {
        int pivot = k;
        for (int row = k + 1; row < 4; ++row) {
            if (fabs(a[row][k]) > fabs(a[pivot][k]))
                pivot = row;
        }
        assert_true(a[pivot][k] != 0.0);
        for (int column = 0; column < 8; ++column) {
            double t = a[k][column];
            a[k][column] = a[pivot][column];
            a[pivot][column] = t;
        }
        double d = a[k][k];
        for (int column = 0; column < 8; ++column)
            a[k][column] /= d;
        for (int row = 0; row < 4; ++row) {
            double f = row == k ? 0.0 : a[row][k];
            for (int column = 0; column < 8; ++column)
                a[row][column] -= f * a[k][column];
        }
    }
    for (int row = 0; row < 4; ++row) {
        for (int column = 0; column < 4; ++column)
            out[column * 4 + row] = a[row][column + 4];
    }
}

static void promote(const vkao_view *view, double m[16])
{
    for (int i = 0; i < 16; ++i)
        m[i] = view->projection[i];
}

/* As shaders/prepare.comp does it. */
static double linearize(const struct view_constants *k, double depth)
{
    return k->orthographic ? k->linearize[0] + k->linearize[1] * depth
                           : k->linearize[0] / (k->linearize[1] - depth);
}

/* What is added to view z: an orthographic eye stands behind all depths from 0 to 1. */
static double shift_of(const struct view_constants *k, const struct camera *c)
{
    double a, b;
    depth_terms(c, &a, &b);
    return c->orthographic ? linearize(k, a) : 0.0;
}

static void expect_near(double got, double want, double tolerance, const char *what, unsigned index)
{
    if (!(fabs(got - want) <= tolerance))
        fail_msg("%s of camera 0x%x is %.9g, want %.9g", what, index, got, want);
}

/* What the view's images hold: device depth until a test says otherwise. */
static vkao_effect_info effect_of(const vkao_view *view)
{
    vkao_effect_info effect = vkao_effect_info_default();
    effect.projection =
        view->projection[15] != 0.0f ? VKAO_PROJECTION_ORTHOGRAPHIC : VKAO_PROJECTION_PERSPECTIVE;
    return effect;
}

static struct view_constants read_off(const vkao_view *view)
{
    const vkao_effect_info effect = effect_of(view);
    struct view_constants k;
    assert_int_equal(
        vkao_view_constants_init(&silent, view, &effect, extent, VK_FORMAT_D32_SFLOAT, &k),
        VKAO_SUCCESS);
    return k;
}

static void check_round_trip(vkao_view view, const struct camera *c, unsigned index)
{
    static const double points[][3] = {
        {0.0, 0.0, 1.0}, {0.4, -0.3, 1.0}, {-2.0, 1.5, 7.0}, {0.1, 0.05, 0.26}, {9.0, -6.0, 40.0},
    };
    const double forward = c->left_handed ? 1.0 : -1.0;
    VkRect2D port = view.viewport.extent.width ? view.viewport
                                               : (VkRect2D){{0, 0}, {extent.width, extent.height}};
    const struct view_constants k = read_off(&view);
    double m[16];
    promote(&view, m);
    for (size_t i = 0; i < COUNT(points); ++i) {
        const double *p = points[i];
        double clip[4];
        transform(m, (double[4]){p[0], p[1], p[2] * forward, 1.0}, clip);
        double x = (clip[0] / clip[3] + 1.0) / 2.0 * port.extent.width + port.offset.x - 0.5;
        double y = (clip[1] / clip[3] + 1.0) / 2.0 * port.extent.height + port.offset.y - 0.5;
        double reach = k.orthographic ? 1.0 : p[2];
        expect_near((x * k.unproject[0] + k.unproject[2]) * reach, p[0], 1e-5 * p[2] + 1e-5, "x",
                    index);
        expect_near((y * k.unproject[1] + k.unproject[3]) * reach, p[1], 1e-5 * p[2] + 1e-5, "y",
                    index);
        expect_near(linearize(&k, clip[2] / clip[3]) - shift_of(&k, c), p[2], 1e-3 * p[2], "z",
                    index);
    }
}

static void texel_and_depth_lead_back_to_the_point(void **state)
{
    (void)state;
    for (unsigned i = 0; i < CAMERAS; ++i) {
        const struct camera c = camera_of(i);
        check_round_trip(view_of(&c), &c, i);
    }
}

static void viewport_moves_and_scales_ndc(void **state)
{
    (void)state;
    for (unsigned i = 0; i < CAMERAS; ++i) {
        const struct camera c = camera_of(i);
        vkao_view view = view_of(&c);
        view.viewport = (VkRect2D){{-37, 11}, {1000, 200}};
        check_round_trip(view, &c, i);
    }
}

/* As the header folds it in: texel x + 1 then shows what texel x did. */
static void jitter_of_a_texel_moves_the_image_by_one(void **state)
{
    (void)state;
    for (unsigned i = 0; i < PLAIN_CAMERAS; ++i) {
        const struct camera c = camera_of(i);
        vkao_view view = view_of(&c);
        float *m = view.projection;
        const float x = 2.0f / (float)extent.width, y = 2.0f / (float)extent.height;
        const struct view_constants still = read_off(&view);
        if (c.orthographic) {
            m[12] += x * m[15];
            m[13] += y * m[15];
        } else {
            m[8] += x * m[11];
            m[9] += y * m[11];
        }
        const struct view_constants moved = read_off(&view);
        for (int k = 0; k < 2; ++k)
            expect_near(moved.unproject[k] + moved.unproject[2 + k], still.unproject[2 + k], 1e-5,
                        "unprojected texel", i);
    }
}

/* z from -w to w, for depths of z / w / 2 + 1/2. */
static void opengl_matrix_is_folded_like_a_range(void **state)
{
    (void)state;
    const double n = 0.25, f = 50.0;
    vkao_view view = vkao_view_default();
    float *m = view.projection;
    m[0] = m[5] = 1.5f;
    m[10] = (float)(-(f + n) / (f - n));
    m[11] = -1.0f;
    m[14] = (float)(-2.0 * f * n / (f - n));
    m[10] = (1.0f - 0.5f) * m[10] + 0.5f * m[11];
    m[14] = (1.0f - 0.5f) * m[14] + 0.5f * m[15];
    const struct view_constants k = read_off(&view);
    expect_near(linearize(&k, 0.0), n, 1e-5, "near plane", 0);
    expect_near(linearize(&k, 1.0), f, 1e-2, "far plane", 0);
    expect_near(k.far_depth, 1.0, 0.0, "far depth", 0);
}

static void linear_depth_is_the_matrix_inverse(void **state)
{
    (void)state;
    for (unsigned i = 0; i < CAMERAS; ++i) {
        const struct camera c = camera_of(i);
        const vkao_view view = view_of(&c);
        const struct view_constants k = read_off(&view);
        double m[16], inverse[16];
        promote(&view, m);
        invert(m, inverse);
        for (int step = 1; step < 20; ++step) {
            double depth = step / 20.0, v[4];
            transform(inverse, (double[4]){0.2, -0.4, depth, 1.0}, v);
            double want = v[2] / v[3] * (c.left_handed ? 1.0 : -1.0);
            double shift = shift_of(&k, &c), got = linearize(&k, depth) - shift;
            /* Less the depth at infinity, which only ranges have between 0 and 1. */
            if (fabs(want) < 1e4)
                expect_near(got, want,
                            1e-5 / fabs(c.depth_max - c.depth_min) * fmax(fabs(want), shift),
                            "linearised depth", i);
        }
    }
}

static void far_depth_is_the_far_planes(void **state)
{
    (void)state;
    for (unsigned i = 0; i < CAMERAS; ++i) {
        const struct camera c = camera_of(i);
        vkao_view view = view_of(&c);
        struct view_constants k = read_off(&view);
        expect_near(k.far_depth, falls(&c) ? 0.0 : 1.0, 0.0, "far depth", i);
        expect_near(k.far_z, FLT_MAX, 0.0, "far z of device depth", i);
        vkao_effect_info effect = effect_of(&view);
        effect.depth_encoding = VKAO_DEPTH_VIEW_Z;
        assert_int_equal(
            vkao_view_constants_init(&silent, &view, &effect, extent, VK_FORMAT_D32_SFLOAT, &k),
            VKAO_SUCCESS);
        if (has_planes_at_zero_and_one(&c))
            expect_near(k.far_z, c.infinite ? FLT_MAX : c.far, c.far * 1e-3, "far z", i);
        else if (!(k.far_z >= c.far * 0.999))
            fail_msg("far z of camera 0x%x is %g, before its far plane", i, (double)k.far_z);
    }
}

static void depth_error_covers_one_step_of_the_format(void **state)
{
    (void)state;
    static const struct {
        VkFormat format;
        double levels; /* 0: of floats */
    } formats[] = {{VK_FORMAT_D16_UNORM, 65535.0},
                   {VK_FORMAT_X8_D24_UNORM_PACK32, 16777215.0},
                   {VK_FORMAT_D32_SFLOAT, 0.0}};
    for (size_t f = 0; f < COUNT(formats); ++f) {
        for (unsigned i = 0; i < CAMERAS; ++i) {
            const struct camera c = camera_of(i);
            const vkao_view view = view_of(&c);
            const vkao_effect_info effect = effect_of(&view);
            struct view_constants k;
            assert_int_equal(
                vkao_view_constants_init(&silent, &view, &effect, extent, formats[f].format, &k),
                VKAO_SUCCESS);
            for (double z = 1.0; z < 45.0; z *= 1.5) {
                double a, b;
                depth_terms(&c, &a, &b);
                double depth = c.orthographic ? a + b * z : a + b / z;
                double step = formats[f].levels > 0.0
                                  ? 1.0 / formats[f].levels
                                  : nextafterf((float)depth, 2.0f) - (float)depth;
                double moved = linearize(&k, depth + 0.5 * step) - linearize(&k, depth);
                double bound = z * (k.depth_error[0] + k.depth_error[1] * z);
                /* An orthographic view states one bound, relative to the far plane. */
                if (c.orthographic)
                    bound = c.far * k.depth_error[0];
                if (!(fabs(moved) <= bound * 1.01))
                    fail_msg("camera 0x%x at %g: a rounding moves z by %g, bound %g", i, z, moved,
                             bound);
            }
        }
    }
}

static void orthographic_width_is_the_reference(void **state)
{
    (void)state;
    for (unsigned i = 0; i < CAMERAS; ++i) {
        const struct camera c = camera_of(i);
        const vkao_view view = view_of(&c);
        const struct view_constants k = read_off(&view);
        assert_int_equal(k.orthographic, c.orthographic);
        expect_near(k.reference_z, c.orthographic ? 10.0 : 0.0, 1e-5, "reference z", i);
    }
}

static void normals_turn_with_the_hand(void **state)
{
    (void)state;
    for (unsigned i = 0; i < 4; ++i) {
        const struct camera c = camera_of(i);
        vkao_view view = view_of(&c);
        for (int e = 0; e < 9; ++e)
            view.normal_to_view[e] = (float)(e + 1);
        const struct view_constants k = read_off(&view);
        for (int row = 0; row < 3; ++row) {
            for (int column = 0; column < 3; ++column) {
                double sign = row == 2 && !c.left_handed ? -1.0 : 1.0;
                expect_near(k.normal_rows[row][column], sign * (column * 3 + row + 1), 0.0,
                            "normal row", i);
            }
        }
    }
}

/* Near and far planes at -10 and 10: nothing says which way the camera looks. */
static vkao_view ambiguous(void)
{
    vkao_view view = vkao_view_default();
    view.projection[0] = view.projection[5] = 0.1f;
    view.projection[10] = 1.0f / 20.0f;
    view.projection[14] = 0.5f;
    view.projection[15] = 1.0f;
    return view;
}

static void ambiguous_orthographic_view_wants_an_axis(void **state)
{
    (void)state;
    struct world w;
    world_init(&w, false);
    const struct vkao_logger log = {w.info.log, w.info.log_user_data, VKAO_LOG_WARNING};
    struct view_constants k;
    vkao_view view = ambiguous();
    const vkao_effect_info effect = effect_of(&view);
    expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT,
                   vkao_view_constants_init(&log, &view, &effect, extent, VK_FORMAT_D32_SFLOAT, &k),
                   "view.axis", "orthographic");
    for (int axis = VKAO_VIEW_AXIS_NEGATIVE_Z; axis <= VKAO_VIEW_AXIS_POSITIVE_Z; ++axis) {
        view.axis = (vkao_view_axis)axis;
        k = read_off(&view);
        /* Depth 1 is at z = +10: far if the camera looks along +z. All of the range lies in front
         * of the eye. */
        bool positive = view.axis == VKAO_VIEW_AXIS_POSITIVE_Z;
        assert_true(k.far_depth == (positive ? 1.0f : 0.0f));
        double at_near = linearize(&k, positive ? 0.0 : 1.0),
               at_far = linearize(&k, positive ? 1.0 : 0.0);
        assert_true(at_near > 0.0);
        expect_near(at_far - at_near, 20.0, 1e-4, "depth range", 0);
    }
    world_close(&w);
}

static void rect_grow_stays_in_bounds(void **state)
{
    (void)state;
    static const struct {
        struct vkao_rect rect;
        uint32_t x, y;
        struct vkao_rect bounds, want;
    } cases[] = {
        {{10, 10, 20, 20}, 3, 5, {0, 0, 100, 100}, {7, 5, 23, 25}},
        {{10, 10, 20, 20}, 0, 0, {0, 0, 100, 100}, {10, 10, 20, 20}},
        {{2, 1, 99, 98}, 4, 4, {0, 0, 100, 100}, {0, 0, 100, 100}},
        {{10, 10, 20, 20}, 16, 16, {10, 10, 20, 20}, {10, 10, 20, 20}},
        {{12, 12, 18, 18}, 3, 1, {10, 10, 20, 20}, {10, 11, 20, 19}},
        {{3, 3, 4, 4}, 3, 3, {0, 0, 7, 7}, {0, 0, 7, 7}},
        {{5, 5, 6, 6}, UINT32_MAX, UINT32_MAX, {1, 2, 30, 40}, {1, 2, 30, 40}},
    };
    for (size_t i = 0; i < COUNT(cases); ++i) {
        struct vkao_rect got =
            vkao_rect_grow(cases[i].rect, cases[i].x, cases[i].y, cases[i].bounds);
        assert_memory_equal(&got, &cases[i].want, sizeof got);
    }
}

static void rect_pack_keeps_sixteen_bits_each(void **state)
{
    (void)state;
    uint32_t packed[2];
    vkao_rect_pack((struct vkao_rect){1, 2, 65535, 65534}, packed);
    assert_int_equal(packed[0], 0x00020001);
    assert_int_equal(packed[1], 0xfffeffff);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(texel_and_depth_lead_back_to_the_point),
        cmocka_unit_test(viewport_moves_and_scales_ndc),
        cmocka_unit_test(jitter_of_a_texel_moves_the_image_by_one),
        cmocka_unit_test(opengl_matrix_is_folded_like_a_range),
        cmocka_unit_test(linear_depth_is_the_matrix_inverse),
        cmocka_unit_test(far_depth_is_the_far_planes),
        cmocka_unit_test(depth_error_covers_one_step_of_the_format),
        cmocka_unit_test(orthographic_width_is_the_reference),
        cmocka_unit_test(normals_turn_with_the_hand),
        cmocka_unit_test(ambiguous_orthographic_view_wants_an_axis),
        cmocka_unit_test(rect_grow_stays_in_bounds),
        cmocka_unit_test(rect_pack_keeps_sixteen_bits_each),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
