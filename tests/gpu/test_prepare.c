/* SPDX-License-Identifier: MIT
 *
 * Depth of any format and encoding to view z, and background. Prepare writes scratch, which tests
 * do not read: the literal sphere form shows it, whose result is a smooth function of view z
 * differences. */
#include "fixture.h"
#include "ref_sphere.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static void probe(struct picture *p, const struct scene *scene, const struct lens *lens,
                  VkFormat format, vkao_depth_encoding encoding)
{
    picture_make(p, VKAO_STAGE_SSAO, scene);
    p->view.normal_encoding = VKAO_NORMALS_FROM_DEPTH;
    p->view.depth_encoding = encoding;
    p->ssao.method = VKAO_SSAO_SPHERE;
    p->ssao.sphere_form = VKAO_SPHERE_LITERAL;
    p->ssao.blocking_scale = 3.0f;
    picture_render_scene(p, scene, lens, format, VK_FORMAT_UNDEFINED);
}

/* 16-bit fixed point with the near plane at 0.1 is too coarse to be worth a test: 1.5 is what one
 * would choose. */
static struct lens test_lens(bool orthographic, bool reversed, double far)
{
    struct lens lens = orthographic ? lens_orthographic(1.6, 1.2) : lens_perspective(0.6, 0.45);
    lens.near = 1.5;
    lens.far = far;
    lens.reversed = reversed;
    return lens;
}

/* Devices have 24 bits of depth or 32. */
static bool has(VkFormat format)
{
    VkFormatProperties can;
    vkGetPhysicalDeviceFormatProperties(fixture.gpu.physical_device, format, &can);
    const bool has = can.optimalTilingFeatures & VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT;
    if (!has)
        print_message("    the device has no format %d\n", (int)format);
    return has;
}

/* The reference decodes the same rounded depths, so the tolerance is that of single precision: the
 * rounding of the matrix and of z/w near 1 moves z by 1e-5, and a few points over an edge. */
static void view_z_agrees_with_reference_for_every_format_encoding_and_far_plane(void **state)
{
    (void)state;
    static const VkFormat formats[] = {VK_FORMAT_R32_SFLOAT, VK_FORMAT_R16_SFLOAT,
                                       VK_FORMAT_R16_UNORM,  VK_FORMAT_D32_SFLOAT,
                                       VK_FORMAT_D16_UNORM,  VK_FORMAT_X8_D24_UNORM_PACK32};
    static const struct {
        const char *name;
        bool orthographic, reversed;
        double far;
    } lenses[] = {
        {"standard", false, false, 10.0},
        {"reversed", false, true, 10.0},
        {"infinite", false, false, (double)INFINITY},
        {"reversed infinite", false, true, (double)INFINITY},
        {"orthographic", true, false, 10.0},
        {"orthographic reversed", true, true, 10.0},
    };
    const struct scene scene = scene_corner();
    for (size_t l = 0; l < sizeof lenses / sizeof lenses[0]; ++l) {
        struct lens lens = test_lens(lenses[l].orthographic, lenses[l].reversed, lenses[l].far);
        for (size_t f = 0; f < sizeof formats / sizeof formats[0] * 4; ++f) {
            vkao_depth_encoding encoding = (vkao_depth_encoding)(f % 4);
            struct picture p;
            struct ref_scene reference;
            char what[80];
            VkFormat format = formats[f / 4];
            /* Fixed point holds [0,1]: device depth, or 1/z. */
            bool fits = format == VK_FORMAT_R32_SFLOAT || format == VK_FORMAT_R16_SFLOAT ||
                        encoding == VKAO_DEPTH_PROJECTED || encoding == VKAO_DEPTH_INVERSE_Z;
            if (!fits || (format == VK_FORMAT_X8_D24_UNORM_PACK32 && !has(format)))
                continue;
            probe(&p, &scene, &lens, format, encoding);
            double *expected = test_alloc(picture_texels(&p), sizeof *expected);
            picture_run(&p);
            picture_reference_scene(&p, &reference);
            ref_sphere(&reference, &p.ssao, expected);
            snprintf(what, sizeof what, "%s, format %d, encoding %d", lenses[l].name, (int)format,
                     (int)encoding);
            check_close(what, p.values[SLOT_AO], expected, picture_texels(&p), 2e-4, 2e-3, 0.02);
            assert_true(mean_of(expected, picture_texels(&p)) < 0.9);
            free(expected);
            ref_scene_free(&reference);
            picture_free(&p);
        }
    }
}

/* The picture is a wall that faces the eye; this leaves a 12x12 block of it in the middle and makes
 * the rest background. The rest must be 1, in the literal form too, which greys every surface. The
 * block must be 1 in the rescaled forms, as the rest occludes nothing, and darker than 1 in the
 * literal form, or it was not seen at all. */
static void check_background(struct picture *p, const char *what, double background)
{
    for (size_t i = 0; i < picture_texels(p); ++i) {
        size_t x = i % p->width, y = i / p->width;
        if (x < 34 || x >= 46 || y < 24 || y >= 36)
            p->values[SLOT_DEPTH][i] = background;
    }
    for (int method = 0; method < 3; ++method) {
        size_t grey = 0;
        p->ssao.method = method == 0 ? VKAO_SSAO_HEMISPHERE : VKAO_SSAO_SPHERE;
        p->ssao.sphere_form = method == 2 ? VKAO_SPHERE_LITERAL : VKAO_SPHERE_RESCALED;
        picture_run(p);
        for (size_t i = 0; i < picture_texels(p); ++i) {
            size_t x = i % p->width, y = i / p->width;
            bool block = x >= 34 && x < 46 && y >= 24 && y < 36;
            double ao = p->values[SLOT_AO][i];
            grey += ao < 0.9;
            if (!(ao == 1.0) && !(block && method == 2))
                fail_msg("%s, method %d: texel %zu is %.9g, want 1", what, method, i, ao);
        }
        if (method == 2)
            assert_true(grey > 100);
    }
}

/* minDepth 0.25 and maxDepth 0.75 of the viewport, folded into the matrix */
enum { REVERSED = 1, INFINITE = 2, ORTHOGRAPHIC = 4, RANGE = 8 };

#define PROJECTED VKAO_DEPTH_PROJECTED
#define VIEW_Z VKAO_DEPTH_VIEW_Z
#define D32 VK_FORMAT_D32_SFLOAT
#define R32 VK_FORMAT_R32_SFLOAT

static const struct {
    const char *name;
    vkao_depth_encoding encoding;
    VkFormat format;
    double value;
    unsigned camera;
} backgrounds[] = {
    {"far plane, D32", PROJECTED, D32, 1.0, 0},
    {"far plane, D16", PROJECTED, VK_FORMAT_D16_UNORM, 1.0, 0},
    {"infinite far plane", PROJECTED, D32, 1.0, INFINITE},
    {"reversed far plane", PROJECTED, D32, 0.0, REVERSED},
    {"reversed infinite far plane", PROJECTED, D32, 0.0, REVERSED | INFINITE},
    {"orthographic far plane", PROJECTED, D32, 1.0, ORTHOGRAPHIC},
    {"orthographic reversed far plane", PROJECTED, D32, 0.0, ORTHOGRAPHIC | REVERSED},
    {"beyond 1", PROJECTED, R32, 1.5, 0},
    {"below 0, reversed", PROJECTED, R32, -0.5, REVERSED},
    {"cleared to 1, range of depth", PROJECTED, D32, 1.0, RANGE},
    {"cleared to 1, range of depth, infinite", PROJECTED, D32, 1.0, RANGE | INFINITE},
    {"cleared to 0, range of depth, reversed", PROJECTED, D32, 0.0, RANGE | REVERSED},
    {"cleared to 0, range of depth, reversed infinite", PROJECTED, D32, 0.0,
     RANGE | REVERSED | INFINITE},
    {"end of the range, infinite", PROJECTED, D32, 0.75, RANGE | INFINITE},
    {"beyond the range, infinite", PROJECTED, D32, 0.9, RANGE | INFINITE},
    {"end of the range, reversed infinite", PROJECTED, D32, 0.25, RANGE | REVERSED | INFINITE},
    {"cleared to 1, range of depth, orthographic", PROJECTED, D32, 1.0, RANGE | ORTHOGRAPHIC},
    {"cleared to 0, range of depth, orthographic reversed", PROJECTED, D32, 0.0,
     RANGE | ORTHOGRAPHIC | REVERSED},
    {"projected NaN", PROJECTED, R32, (double)NAN, 0},
    {"projected NaN, orthographic", PROJECTED, R32, (double)NAN, ORTHOGRAPHIC},
    {"projected infinity", PROJECTED, R32, (double)INFINITY, 0},
    {"view z 0", VIEW_Z, R32, 0.0, 0},
    {"view z negative", VIEW_Z, R32, -4.0, 0},
    {"view z NaN", VIEW_Z, R32, (double)NAN, 0},
    {"view z infinity", VIEW_Z, R32, (double)INFINITY, INFINITE},
    {"view z half infinity", VIEW_Z, VK_FORMAT_R16_SFLOAT, (double)INFINITY, INFINITE},
    {"view z -infinity", VIEW_Z, R32, -(double)INFINITY, 0},
    {"view z past the far plane", VIEW_Z, R32, 100.0, 0},
    {"view z 1e10", VIEW_Z, R32, 1e10, 0},
    {"distance infinity", VKAO_DEPTH_DISTANCE, R32, (double)INFINITY, INFINITE},
    {"distance NaN", VKAO_DEPTH_DISTANCE, R32, (double)NAN, 0},
    {"distance 0", VKAO_DEPTH_DISTANCE, R32, 0.0, 0},
    {"1/z 0", VKAO_DEPTH_INVERSE_Z, R32, 0.0, INFINITE},
    {"1/z -0", VKAO_DEPTH_INVERSE_Z, R32, -0.0, INFINITE},
    {"1/z negative", VKAO_DEPTH_INVERSE_Z, R32, -0.25, 0},
    {"1/z NaN", VKAO_DEPTH_INVERSE_Z, R32, (double)NAN, 0},
    {"1/z infinity", VKAO_DEPTH_INVERSE_Z, R32, (double)INFINITY, 0},
};

static void background_is_exactly_one_and_occludes_nothing(void **state)
{
    (void)state;
    const struct scene wall = scene_tilted_plane(0.0, 0.0);
    for (size_t i = 0; i < sizeof backgrounds / sizeof backgrounds[0]; ++i) {
        struct picture p;
        struct lens lens = (backgrounds[i].camera & ORTHOGRAPHIC) ? lens_orthographic(2.4, 1.8)
                                                                  : lens_perspective(0.6, 0.45);
        lens.reversed = (backgrounds[i].camera & REVERSED) != 0;
        if (backgrounds[i].camera & INFINITE)
            lens.far = INFINITY;
        if (backgrounds[i].camera & RANGE) {
            lens.depth_min = 0.25;
            lens.depth_max = 0.75;
        }
        picture_make(&p, VKAO_STAGE_SSAO, &wall);
        if (backgrounds[i].camera & ORTHOGRAPHIC)
            p.view.axis = VKAO_VIEW_AXIS_NEGATIVE_Z;
        p.view.depth_encoding = backgrounds[i].encoding;
        picture_render_scene(&p, &wall, &lens, backgrounds[i].format,
                             VK_FORMAT_R32G32B32A32_SFLOAT);
        check_background(&p, backgrounds[i].name, backgrounds[i].value);
        p.view.normal_encoding = VKAO_NORMALS_FROM_DEPTH;
        check_background(&p, backgrounds[i].name, backgrounds[i].value);
        picture_free(&p);
    }
}

/* What the composite shows as view z of a depth image that holds one value, in scene units. */
static double shown_z(const struct lens *lens, VkFormat format, double depth)
{
    struct picture p;
    picture_init(&p, 16, 12, VKAO_STAGE_ALL);
    p.view.depth_encoding = VKAO_DEPTH_PROJECTED;
    p.view.normal_encoding = VKAO_NORMALS_FROM_DEPTH;
    p.view.axis = lens->orthographic ? VKAO_VIEW_AXIS_NEGATIVE_Z : VKAO_VIEW_AXIS_FROM_MATRIX;
    p.ssao.method = VKAO_SSAO_GTAO; /* vbao leaves a thickness in the last bits of view z */
    p.composite.mode = VKAO_COMPOSITE_VIEW_Z;
    p.composite.debug_distance = 1.0f;
    lens_matrix(lens, p.view.projection);
    picture_fill(&p, SLOT_DEPTH, format, depth);
    picture_set(&p, SLOT_AO, VK_FORMAT_R32_SFLOAT, NULL);
    picture_set(&p, SLOT_OUTPUT, VK_FORMAT_R32G32B32A32_SFLOAT, NULL);
    picture_run(&p);
    const double z = p.values[SLOT_OUTPUT][(6 * 16 + 8) * 4];
    picture_free(&p);
    return z;
}

/* Exactly 0 and 1: one is the near plane, where a surface may lie, the other background. With a
 * range of depth the planes are at its ends, and what is before the near one is in front of it. */
static void depths_of_zero_and_one_are_the_planes(void **state)
{
    (void)state;
    static const VkFormat formats[] = {D32, R32, VK_FORMAT_D16_UNORM, VK_FORMAT_R16_UNORM};
    for (unsigned i = 0; i < 16 * sizeof formats / sizeof formats[0]; ++i) {
        const unsigned camera = i % 16;
        const bool reversed = camera & REVERSED;
        if ((camera & ORTHOGRAPHIC) && (camera & INFINITE))
            continue;
        struct lens lens =
            test_lens(camera & ORTHOGRAPHIC, reversed, camera & INFINITE ? (double)INFINITY : 10.0);
        double ends[2] = {0.0, 1.0};
        if (camera & RANGE) {
            ends[0] = lens.depth_min = 0.25;
            ends[1] = lens.depth_max = 0.75;
        }
        const VkFormat format = formats[i / 16];
        /* An orthographic eye stands behind all depths from 0 to 1: these are at -2.75 and
         * 14.25. */
        const double shift =
            (camera & ORTHOGRAPHIC) && (camera & RANGE) ? 2.75 + 0.001 * 17.0 : 0.0;
        const double near = shown_z(&lens, format, ends[reversed]),
                     background = shown_z(&lens, format, reversed ? 0.0 : 1.0);
        if (!(fabs(near - lens.near - shift) < 2e-4) || background != 0.0)
            fail_msg("camera 0x%x, format %d: near plane at %g, background %g", camera, (int)format,
                     near, background);
        if (camera & RANGE)
            assert_true(shown_z(&lens, format, reversed ? 1.0 : 0.0) < lens.near + shift - 0.01);
    }
}

/* Behind the blur, the intensity and the power too. */
static void background_is_exactly_one_in_every_ao_format(void **state)
{
    (void)state;
    static const VkFormat formats[] = {VK_FORMAT_R8_UNORM, VK_FORMAT_R16_UNORM,
                                       VK_FORMAT_R16_SFLOAT, VK_FORMAT_R32_SFLOAT};
    const struct scene scene = scene_open_sky();
    for (size_t i = 0; i < sizeof formats / sizeof formats[0]; ++i) {
        struct picture p;
        size_t background = 0, darkened = 0;
        picture_make(&p, VKAO_STAGE_SSAO | VKAO_STAGE_BLUR, &scene);
        picture_set(&p, SLOT_AO, formats[i], NULL);
        picture_set(&p, SLOT_NOISY, formats[i], NULL);
        p.blur.intensity = 3.0f;
        p.blur.power = 2.0f;
        picture_run(&p);
        for (size_t texel = 0; texel < picture_texels(&p); ++texel) {
            bool is_background = !isfinite(p.values[SLOT_DEPTH][texel]);
            background += is_background;
            darkened += p.values[SLOT_AO][texel] < 1.0;
            if (is_background)
                assert_true(p.values[SLOT_AO][texel] == 1.0 && p.values[SLOT_NOISY][texel] == 1.0);
        }
        assert_true(background > 100 && darkened > 100);
        picture_free(&p);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        gpu_test(view_z_agrees_with_reference_for_every_format_encoding_and_far_plane),
        gpu_test(background_is_exactly_one_and_occludes_nothing),
        gpu_test(depths_of_zero_and_one_are_the_planes),
        gpu_test(background_is_exactly_one_in_every_ao_format),
    };
    return fixture_run(tests);
}
