/* SPDX-License-Identifier: MIT
 *
 * One scene, one AO, whatever the camera's conventions; walls are open at every tilt. */
#include "fixture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct method {
    const char *name;
    vkao_ssao_method method;
    vkao_sphere_form form;
};

static const struct method methods[] = {
    {"hemisphere", VKAO_SSAO_HEMISPHERE, VKAO_SPHERE_RESCALED},
    {"sphere", VKAO_SSAO_SPHERE, VKAO_SPHERE_RESCALED},
    {"hbao", VKAO_SSAO_HBAO, VKAO_SPHERE_RESCALED},
    {"gtao", VKAO_SSAO_GTAO, VKAO_SPHERE_RESCALED},
    {"vbao", VKAO_SSAO_VBAO, VKAO_SPHERE_RESCALED},
    {"raymarch", VKAO_SSAO_RAYMARCH, VKAO_SPHERE_RESCALED},
    {"literal", VKAO_SSAO_SPHERE, VKAO_SPHERE_LITERAL}, /* greys every wall */
};
enum {
    METHODS = sizeof methods / sizeof methods[0],
    OPEN_METHODS = METHODS - 1,
};

static void set_method(struct picture *p, const struct method *method)
{
    p->ssao.method = method->method;
    p->ssao.sphere_form = method->form;
    p->ssao.blocking_scale = 10.0f;
    p->ssao.slice_count = 2;
}

static void check_open(struct picture *p, const char *what)
{
    picture_run(p);
    for (size_t i = 0; i < picture_texels(p); ++i) {
        if (!(fabs(p->values[SLOT_AO][i] - 1.0) <= 0.002))
            fail_msg("%s: texel %zu,%zu is %g, want 1 within 0.002", what, i % p->width,
                     i / p->width, p->values[SLOT_AO][i]);
    }
}

static void check_tilted_planes(bool orthographic, bool given_normals, float bias,
                                VkFormat other_format)
{
    const VkFormat formats[] = {VK_FORMAT_D32_SFLOAT, other_format};
    for (int i = 0; i < 5 * 4 * 2 * OPEN_METHODS; ++i) {
        struct picture p;
        char what[120];
        const struct method *method = &methods[i / 40];
        double tilt = 20.0 * (i / 2 % 5), azimuth = 25.0 + 90.0 * (i / 10 % 4);
        struct lens lens = orthographic ? lens_orthographic(1.6, 1.2) : lens_perspective(0.6, 0.45);
        struct scene wall = scene_tilted_plane(tilt, azimuth);
        if (given_normals) {
            /* Off the axis, so that steep walls turn their back on the origin, but not on an
             * orthographic camera. The near plane cuts them there, and leaves texels without
             * neighbours, which could not take a normal from depth. */
            wall.shapes[0].center[0] = orthographic ? 1.2 : 0.0;
            lens.near = 1.0; /* what 16 bits of depth need */
        }
        picture_init(&p, 64, 48, VKAO_STAGE_SSAO);
        p.view.normal_encoding = given_normals ? VKAO_NORMALS_XYZ_SNORM : VKAO_NORMALS_FROM_DEPTH;
        VkFormat normals =
            bias > 0.0f ? VK_FORMAT_R16G16B16A16_SFLOAT : VK_FORMAT_R32G32B32A32_SFLOAT;
        picture_render_scene(&p, &wall, &lens, formats[i % 2],
                             given_normals ? normals : VK_FORMAT_UNDEFINED);
        picture_set(&p, SLOT_AO, VK_FORMAT_R32_SFLOAT, NULL);
        set_method(&p, method);
        p.ssao.bias = bias;
        /* Near its horizon a steep wall is seen at more than 89 degrees, and few slices err. */
        for (uint32_t noise = 0; noise < (tilt > 60.0 ? 8 : 1); ++noise) {
            p.ssao.noise_index = noise;
            snprintf(what, sizeof what,
                     "%s, %s, %s normals, format %d, %g degrees towards %g, noise %u", method->name,
                     orthographic ? "orthographic" : "perspective", given_normals ? "given" : "no",
                     (int)formats[i % 2], tilt, azimuth, noise);
            check_open(&p, what);
        }
        picture_free(&p);
    }
}

static void tilted_planes_are_open_with_given_normals(void **state)
{
    (void)state;
    check_tilted_planes(false, true, ao_ssao_default().bias, VK_FORMAT_R32_SFLOAT);
}

static void tilted_planes_are_open_with_normals_from_depth(void **state)
{
    (void)state;
    check_tilted_planes(false, false, ao_ssao_default().bias, VK_FORMAT_R32_SFLOAT);
}

static void orthographic_tilted_planes_are_open(void **state)
{
    (void)state;
    check_tilted_planes(true, true, ao_ssao_default().bias, VK_FORMAT_R32_SFLOAT);
    check_tilted_planes(true, false, ao_ssao_default().bias, VK_FORMAT_R32_SFLOAT);
}

/* Without a bias only the guard that knows the precision of the depth stands between a wall and
 * acne; it does not know the precision of normals, which must be exact then. */
static void tilted_planes_are_open_without_a_bias(void **state)
{
    (void)state;
    check_tilted_planes(false, true, 0.0f, VK_FORMAT_D16_UNORM);
    check_tilted_planes(true, true, 0.0f, VK_FORMAT_R32_SFLOAT);
}

/* The step of half precision just above z = 4 is 4e-3, and the lens is so long that a texel is as
 * small. */
static void walls_of_half_precision_depth_are_open_without_a_bias(void **state)
{
    (void)state;
    for (int i = 0; i < OPEN_METHODS * 4; ++i) {
        struct picture p;
        char what[80];
        const struct method *method = &methods[i % OPEN_METHODS];
        struct lens lens = lens_perspective(0.05, 0.0375);
        struct scene wall = scene_tilted_plane(20.0 * (i / OPEN_METHODS), 25.0);
        wall.shapes[0].center[2] = 4.0;
        picture_init(&p, 64, 48, VKAO_STAGE_SSAO);
        p.view.depth_encoding = VKAO_DEPTH_VIEW_Z;
        p.view.normal_encoding = VKAO_NORMALS_XYZ_SNORM;
        picture_render_scene(&p, &wall, &lens, VK_FORMAT_R16_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT);
        picture_set(&p, SLOT_AO, VK_FORMAT_R32_SFLOAT, NULL);
        set_method(&p, method);
        p.ssao.bias = 0.0f;
        p.ssao.radius = 0.05f;
        p.ssao.sample_count = 64;
        snprintf(what, sizeof what, "%s, %g degrees", method->name, 20.0 * (i / OPEN_METHODS));
        check_open(&p, what);
        picture_free(&p);
    }
}

struct convention {
    const char *name;
    bool reversed;
    double far, forward;
    vkao_depth_encoding encoding;
    VkFormat format;
    double depth_min, depth_max; /* of the viewport; both 0: 0 and 1 */
};

#define D32 VK_FORMAT_D32_SFLOAT

/* All hold the same depths, to the precision of the encoding: what differs is a point here and
 * there at the edge of blocking, worth 1/32. D32 with standard Z is exact to 2e-5 of z here, the
 * others to 1e-7. */
static const struct convention conventions[] = {
    {"standard D32", false, 100.0, -1.0, VKAO_DEPTH_PROJECTED, VK_FORMAT_D32_SFLOAT, 0, 0},
    {"standard R32F", false, 100.0, -1.0, VKAO_DEPTH_PROJECTED, VK_FORMAT_R32_SFLOAT, 0, 0},
    {"standard, left-handed", false, 100.0, 1.0, VKAO_DEPTH_PROJECTED, VK_FORMAT_D32_SFLOAT, 0, 0},
    {"reversed", true, 100.0, -1.0, VKAO_DEPTH_PROJECTED, VK_FORMAT_D32_SFLOAT, 0, 0},
    {"reversed, left-handed", true, 100.0, 1.0, VKAO_DEPTH_PROJECTED, VK_FORMAT_D32_SFLOAT, 0, 0},
    {"infinite", false, (double)INFINITY, -1.0, VKAO_DEPTH_PROJECTED, VK_FORMAT_D32_SFLOAT, 0, 0},
    {"reversed infinite", true, (double)INFINITY, -1.0, VKAO_DEPTH_PROJECTED, VK_FORMAT_D32_SFLOAT,
     0, 0},
    {"reversed infinite, left-handed", true, (double)INFINITY, 1.0, VKAO_DEPTH_PROJECTED,
     VK_FORMAT_D32_SFLOAT, 0, 0},
    {"view z", false, 100.0, -1.0, VKAO_DEPTH_VIEW_Z, VK_FORMAT_R32_SFLOAT, 0, 0},
    {"view z, left-handed, infinite", false, (double)INFINITY, 1.0, VKAO_DEPTH_VIEW_Z,
     VK_FORMAT_R32_SFLOAT, 0, 0},
    {"distance", false, 100.0, -1.0, VKAO_DEPTH_DISTANCE, VK_FORMAT_R32_SFLOAT, 0, 0},
    {"distance, reversed infinite", true, (double)INFINITY, -1.0, VKAO_DEPTH_DISTANCE,
     VK_FORMAT_R32_SFLOAT, 0, 0},
    {"1/z", false, 100.0, -1.0, VKAO_DEPTH_INVERSE_Z, VK_FORMAT_R32_SFLOAT, 0, 0},
    {"standard in [.5,1]", false, 100.0, -1.0, VKAO_DEPTH_PROJECTED, D32, 0.5, 1.0},
    {"standard in [0,.4]", false, 100.0, 1.0, VKAO_DEPTH_PROJECTED, D32, 0.0, 0.4},
    {"infinite in [.1,.9]", false, (double)INFINITY, -1.0, VKAO_DEPTH_PROJECTED, D32, 0.1, 0.9},
    {"infinite in [.9,.1]", false, (double)INFINITY, 1.0, VKAO_DEPTH_PROJECTED, D32, 0.9, 0.1},
    {"reversed in [.1,.9]", true, 100.0, 1.0, VKAO_DEPTH_PROJECTED, D32, 0.1, 0.9},
    {"reversed in [1,.6]", true, 100.0, 1.0, VKAO_DEPTH_PROJECTED, D32, 1.0, 0.6},
    {"reversed infinite in [.5,1]", true, (double)INFINITY, -1.0, VKAO_DEPTH_PROJECTED, D32, 0.5,
     1.0},
    {"reversed infinite in [0,.3]", true, (double)INFINITY, -1.0, VKAO_DEPTH_PROJECTED, D32, 0.0,
     0.3},
    {"view z, matrix in [.6,1]", true, (double)INFINITY, -1.0, VKAO_DEPTH_VIEW_Z,
     VK_FORMAT_R32_SFLOAT, 0.6, 1.0},
};

static void render(struct picture *p, const struct lens *base, const struct convention *c,
                   const struct method *m, bool given_normals)
{
    struct lens lens = *base;
    const struct scene scene = scene_corner();
    lens.reversed = c->reversed;
    lens.forward = c->forward;
    lens.far = base->orthographic ? 100.0 : c->far;
    lens.depth_min = c->depth_min;
    lens.depth_max = c->depth_max;
    picture_init(p, 80, 60, VKAO_STAGE_SSAO);
    if (lens.orthographic && c->depth_min != c->depth_max) {
        /* Depths 0 and 1 may lie equally far on both sides of the eye; and a part of [0,1] for what
         * lies between near planes and 100 would leave steps of 1e-5. */
        p->view.axis = c->forward < 0.0 ? VKAO_VIEW_AXIS_NEGATIVE_Z : VKAO_VIEW_AXIS_POSITIVE_Z;
        lens.far = 10.0;
    }
    p->view.depth_encoding = c->encoding;
    p->view.normal_encoding = given_normals ? VKAO_NORMALS_XYZ_SNORM : VKAO_NORMALS_FROM_DEPTH;
    picture_render_scene(p, &scene, &lens, c->format,
                         given_normals ? VK_FORMAT_R32G32B32A32_SFLOAT : VK_FORMAT_UNDEFINED);
    picture_set(p, SLOT_AO, VK_FORMAT_R32_SFLOAT, NULL);
    set_method(p, m);
    p->ssao.sample_count = 32;
    p->ssao.step_count = 10; /* with fewer, gtao finds little in the orthographic corner */
    p->ssao.radius = 0.8f;
    picture_run(p);
}

static void check_conventions(const struct lens *lens)
{
    const size_t count = sizeof conventions / sizeof conventions[0];
    for (size_t i = 0; i < METHODS * 2; ++i) {
        struct picture first, p;
        char what[120];
        bool given_normals = i / METHODS;
        render(&first, lens, &conventions[8], &methods[i % METHODS], given_normals);
        assert_true(mean_of(first.values[SLOT_AO], picture_texels(&first)) < 0.985);
        for (size_t c = 0; c < count; ++c) {
            render(&p, lens, &conventions[c], &methods[i % METHODS], given_normals);
            snprintf(what, sizeof what, "%s %s, %s", methods[i % METHODS].name,
                     given_normals ? "normals" : "depth only", conventions[c].name);
            /* Depth 0 or 1 is behind the eye of a parallel camera then, so that the library moves
             * the eye back: the literal form takes points in that were behind it. */
            const bool sees_more = lens->orthographic &&
                                   conventions[c].depth_min != conventions[c].depth_max &&
                                   strcmp(methods[i % METHODS].name, "literal") == 0;
            check_close(what, p.values[SLOT_AO], first.values[SLOT_AO], picture_texels(&p), 1e-4,
                        sees_more ? 5e-4 : 1e-4,
                        0.0626); /* two sectors of 32: a sample on another texel */
            picture_free(&p);
        }
        picture_free(&first);
    }
}

static void every_perspective_convention_gives_the_same_ao(void **state)
{
    (void)state;
    struct lens lens = lens_perspective(0.6, 0.45);
    check_conventions(&lens);
}

static void every_orthographic_convention_gives_the_same_ao(void **state)
{
    (void)state;
    struct lens lens = lens_orthographic(1.6, 1.2);
    check_conventions(&lens);
}

/* A camera with y up shows the same scene upside down. The noise stays where it is in the image, so
 * that only the means of blocks agree: 5x5 texels times 64 points. */
static void y_flip_mirrors_the_picture(void **state)
{
    (void)state;
    for (size_t m = 0; m < METHODS; ++m) {
        struct picture up, down;
        struct lens lens = lens_perspective(0.6, 0.45);
        double blocks[2][16 * 12] = {{0.0}};
        const struct scene scene = scene_corner();
        picture_make(&down, VKAO_STAGE_SSAO, &scene);
        picture_make(&up, VKAO_STAGE_SSAO, &scene);
        lens.y0 = 0.45;
        lens.y1 = -0.45;
        picture_render_scene(&up, &scene, &lens, VK_FORMAT_R32_SFLOAT,
                             VK_FORMAT_R32G32B32A32_SFLOAT);
        set_method(&up, &methods[m]);
        set_method(&down, &methods[m]);
        up.ssao.sample_count = down.ssao.sample_count = 64;
        picture_run(&up);
        picture_run(&down);
        for (size_t y = 0; y < 60; ++y) {
            for (size_t x = 0; x < 80; ++x) {
                blocks[0][y / 5 * 16 + x / 5] += down.values[SLOT_AO][y * 80 + x] / 25.0;
                blocks[1][y / 5 * 16 + x / 5] += up.values[SLOT_AO][(59 - y) * 80 + x] / 25.0;
            }
        }
        check_close(methods[m].name, blocks[0], blocks[1], 16 * 12, 0.004, 0.03, 0.06);
        assert_true(difference_of(down.values[SLOT_AO], up.values[SLOT_AO], 4800).mean > 0.02);
        picture_free(&up);
        picture_free(&down);
    }
}

/* A shift of the window by whole texels moves the picture; by half a texel it changes next to
 * nothing. Overscan: a larger image whose viewport is the smaller one's shows the same there, if
 * the noise is laid on alike. Here the viewport begins at the origin, so it is. */
static void viewport_with_overscan_agrees_where_both_see_the_neighbourhood(void **state)
{
    (void)state;
    for (size_t m = 0; m < METHODS; ++m) {
        struct picture small, large;
        const struct scene scene = scene_corner();
        struct lens lens = lens_perspective(0.6, 0.45);
        size_t agreeing = 0;
        picture_make(&small, VKAO_STAGE_SSAO, &scene);
        picture_init(&large, 96, 76, VKAO_STAGE_SSAO);
        large.view = small.view;
        large.view.viewport = (VkRect2D){{0, 0}, {80, 60}};
        picture_render_scene(&large, &scene, &lens, VK_FORMAT_R32_SFLOAT,
                             VK_FORMAT_R32G32B32A32_SFLOAT);
        picture_set(&large, SLOT_AO, VK_FORMAT_R32_SFLOAT, NULL);
        set_method(&small, &methods[m]);
        set_method(&large, &methods[m]);
        small.ssao.radius = large.ssao.radius = 0.25f;
        picture_run(&small);
        picture_run(&large);
        /* 0.25 at z = 1.6 is 10 texels, at the wall 4: texels further than that from the small
         * image's far edges */
        for (size_t y = 0; y < 44; ++y) {
            for (size_t x = 0; x < 64; ++x) {
                double a = small.values[SLOT_AO][y * 80 + x], b = large.values[SLOT_AO][y * 96 + x];
                if (!(fabs(a - b) < 1e-6))
                    fail_msg("%s: texel %zu,%zu is %g, in the larger image %g", methods[m].name, x,
                             y, a, b);
                agreeing += a < 0.999;
            }
        }
        assert_true(agreeing > 100);
        picture_free(&small);
        picture_free(&large);
    }
}

/* A viewport that begins outside the image, and one inside: against the reference in test_sphere
 * and test_hemisphere's terms, by making the camera of the cropped window off-centre instead. */
static void viewport_equals_the_off_centre_projection_of_the_same_window(void **state)
{
    (void)state;
    const VkRect2D viewports[] = {
        {{-16, -9}, {112, 78}}, {{16, 12}, {40, 30}}, {{-40, 5}, {80, 60}}};
    for (size_t i = 0; i < 3 * METHODS; ++i) {
        struct picture by_viewport, off_centre;
        VkRect2D viewport = viewports[i / METHODS];
        const struct scene scene = scene_corner();
        struct lens lens = lens_perspective(0.6, 0.45), window = lens;
        double dx = 1.2 / viewport.extent.width, dy = 0.9 / viewport.extent.height;
        window.x0 = -0.6 - viewport.offset.x * dx;
        window.x1 = window.x0 + 80.0 * dx;
        window.y0 = -0.45 - viewport.offset.y * dy;
        window.y1 = window.y0 + 60.0 * dy;
        picture_make(&by_viewport, VKAO_STAGE_SSAO, &scene);
        picture_make(&off_centre, VKAO_STAGE_SSAO, &scene);
        by_viewport.view.viewport = viewport;
        picture_render_scene(&by_viewport, &scene, &lens, VK_FORMAT_R32_SFLOAT,
                             VK_FORMAT_R32G32B32A32_SFLOAT);
        picture_render_scene(&off_centre, &scene, &window, VK_FORMAT_R32_SFLOAT,
                             VK_FORMAT_R32G32B32A32_SFLOAT);
        set_method(&by_viewport, &methods[i % METHODS]);
        set_method(&off_centre, &methods[i % METHODS]);
        picture_run(&by_viewport);
        picture_run(&off_centre);
        check_close("viewport and off-centre window", by_viewport.values[SLOT_AO],
                    off_centre.values[SLOT_AO], picture_texels(&off_centre), 1e-4, 1e-3, 0.02);
        picture_free(&by_viewport);
        picture_free(&off_centre);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        gpu_test(tilted_planes_are_open_with_given_normals),
        gpu_test(tilted_planes_are_open_with_normals_from_depth),
        gpu_test(orthographic_tilted_planes_are_open),
        gpu_test(tilted_planes_are_open_without_a_bias),
        gpu_test(walls_of_half_precision_depth_are_open_without_a_bias),
        gpu_test(every_perspective_convention_gives_the_same_ao),
        gpu_test(every_orthographic_convention_gives_the_same_ao),
        gpu_test(y_flip_mirrors_the_picture),
        gpu_test(viewport_with_overscan_agrees_where_both_see_the_neighbourhood),
        gpu_test(viewport_equals_the_off_centre_projection_of_the_same_window),
    };
    return fixture_run(tests);
}
