/* SPDX-License-Identifier: MIT
 *
 * Infinite planes: open at any tilt, at any field of view, and under normals that lean away from
 * them by as much as they hide. */
#include "fixture.h"
#include "ref_scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

static const char *const names[] = {"sphere", "hemisphere", "hbao", "gtao", "vbao", "raymarch"};
enum { METHODS = sizeof names / sizeof names[0], WIDTH = 384, HEIGHT = 288 };

/* A plane whose normal has this cosine to the view direction. */
static struct scene plane_of(double facing)
{
    const double aside = sqrt(1.0 - facing * facing);
    return (struct scene){{{SHAPE_PLANE, {0.0, 0.0, 4.0}, {0.6 * aside, 0.8 * aside, -facing}}}};
}

static void make(struct picture *p, int method, uint32_t width, uint32_t height,
                 const struct scene *scene, const struct lens *lens)
{
    picture_init(p, width, height, VKAO_STAGE_SSAO | VKAO_STAGE_BLUR);
    p->view.depth_encoding = VKAO_DEPTH_VIEW_Z;
    p->view.normal_encoding = VKAO_NORMALS_XYZ_SNORM;
    picture_render_scene(p, scene, lens, VK_FORMAT_R32_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT);
    picture_set(p, SLOT_AO, VK_FORMAT_R32_SFLOAT, NULL);
    p->ssao.method = (vkao_ssao_method)method;
}

/* Normals of all texels, at an angle to that of the plane, towards an azimuth around it. Returns
 * the least cosine to the eye. */
static double tilt(struct picture *p, const double plane[3], double angle, double azimuth)
{
    const double length = hypot(plane[0], plane[1]);
    const double a[3] = {-plane[1] / length, plane[0] / length, 0.0};
    const double b[3] = {plane[1] * a[2] - plane[2] * a[1], plane[2] * a[0] - plane[0] * a[2],
                         plane[0] * a[1] - plane[1] * a[0]};
    double n[3];
    for (int i = 0; i < 3; ++i)
        n[i] = cos(angle) * plane[i] + sin(angle) * (cos(azimuth) * a[i] + sin(azimuth) * b[i]);
    for (size_t t = 0; t < picture_texels(p); ++t)
        for (int i = 0; i < 3; ++i)
            p->values[SLOT_NORMALS][t * 4 + (size_t)i] = i == 2 ? -n[2] : n[i];
    return -n[2];
}

/* Where all of the radius lies in the image. */
static const VkRect2D middle = {{176, 136}, {32, 16}};

static double middle_of(const struct picture *p)
{
    double sum = 0.0;
    for (int y = 0; y < 16; ++y)
        sum += mean_of(&p->values[SLOT_AO][(136 + y) * WIDTH + 176], 32) / 16.0;
    return sum;
}

/* Settings whose AO is cosine-weighted: gtao, and the presets. */
enum { SETTINGS = 5 };

static const char *use_setting(struct picture *p, int i)
{
    static const char *const words[] = {"fast", "default", "high", "best"};
    if (i < 4)
        picture_preset(p, (vkao_quality)i);
    else
        p->ssao.method = VKAO_SSAO_GTAO;
    return i < 4 ? words[i] : "gtao";
}

static double lean(int setting, double facing, double angle, double azimuth, const char **name)
{
    const struct lens lens = lens_perspective(0.012, 0.009);
    const struct scene scene = plane_of(facing);
    struct picture p;
    double off = 0.0;
    make(&p, VKAO_SSAO_VBAO, WIDTH, HEIGHT, &scene, &lens);
    p.ssao.radius = 0.03f; /* 120 texels */
    p.view.rect = middle;
    *name = use_setting(&p, setting);
    if (tilt(&p, scene.shapes[0].size, angle, azimuth) > 0.01) {
        picture_run(&p);
        off = middle_of(&p) - (1.0 + cos(angle)) / 2.0;
    }
    picture_free(&p);
    return off;
}

/* The plane hides all that is below it, so that (1 + cos tilt) / 2 of the hemisphere is seen. */
static void leaning_normals_lose_what_the_plane_hides(void **state)
{
    (void)state;
    /* Up a slope of cosine .05 the radius is 6 texels, of which the last degrees are not seen. gtao
     * takes there what its first sample hides by that sample's distance, a sixth of the radius. */
    static const struct {
        double facing, angles[3];
    } rows[] = {
        {0.95, {10, 40, 70}}, {0.6, {10, 36, 70}}, {0.285, {8, 15, 70}}, {0.05, {10, 30, 50}}};
    for (int setting = 0; setting < SETTINGS; ++setting) {
        const char *name = "";
        double worst = 0.0, at[3] = {0};
        for (int i = 0; i < 4 * 3 * 8; ++i) {
            const double facing = rows[i / 24].facing, angle = rows[i / 24].angles[i / 8 % 3];
            const double off = lean(setting, facing, angle * pi / 180.0, i % 8 * pi / 4.0, &name);
            if (fabs(off) <= fabs(worst))
                continue;
            worst = off;
            at[0] = facing;
            at[1] = angle;
            at[2] = i % 8 * 45;
        }
        print_message("    %-10s off by %+.4f at cosine %g, %g degrees to azimuth %g\n", name,
                      worst, at[0], at[1], at[2]);
        assert_true(fabs(worst) <= (setting < 4 ? 0.02 : 0.08));
    }
}

static void planes_are_open_at_any_field_of_view(void **state)
{
    (void)state;
    static const double degrees[] = {60, 120, 150, 170};
    static const double facings[] = {1.0 - 1e-9, 0.95, 0.6};
    for (int i = 0; i < METHODS * 4 * 3; ++i) {
        const double half = tan(degrees[i / 3 % 4] * pi / 360.0);
        const struct lens lens = lens_perspective(half * 96 / 72, half);
        const struct scene scene = plane_of(facings[i % 3]);
        struct picture p;
        double least = 1.0;
        make(&p, i / 12, 96, 72, &scene, &lens);
        p.ssao.radius = 1.0f;
        picture_run(&p);
        for (size_t t = 0; t < picture_texels(&p); ++t)
            least = fmin(least, p.values[SLOT_AO][t]);
        print_message("    %-10s %3.0f degrees, cosine %.2f: darkest %.4f\n", names[i / 12],
                      degrees[i / 3 % 4], facings[i % 3], least);
        assert_true(least >= 0.998);
        picture_free(&p);
    }
}

/* Root mean square of what changes along a line, less its trend, which perspective has. */
static double ripple_of(const double *values, int count)
{
    double sum = 0.0;
    for (int i = 2; i < count - 2; ++i) {
        double mean = 0.0;
        for (int k = -2; k <= 2; ++k)
            mean += values[i + k] / 5.0;
        sum += pow(values[i] - mean, 2.0) / (count - 4);
    }
    return sqrt(sum);
}

/* The row of the last texel of the wall, above the floor. */
static int last_of_wall(const struct picture *p, int x)
{
    int y = HEIGHT / 4;
    while (p->values[SLOT_NORMALS][((size_t)(y + 1) * WIDTH + (size_t)x) * 4 + 1] ==
           p->values[SLOT_NORMALS][((size_t)y * WIDTH + (size_t)x) * 4 + 1])
        ++y;
    return y;
}

/* Where two walls meet at a slant, texels beside the line are nearer to it and farther in turns:
 * truth has steps there, but no dashes. */
static void a_straight_corner_has_no_dashes(void **state)
{
    (void)state;
    enum { FIRST = 100, COUNT = 180 };
    const struct lens lens = lens_perspective(0.6, 0.45);
    const struct scene scene = {{{SHAPE_PLANE, {0.0, 0.5, 0.0}, {0.05, -1.0, -0.1}},
                                 {SHAPE_PLANE, {0.0, 0.0, 4.0}, {0.2, 0.1, -1.0}}}};
    static double truth[2][COUNT], ao[2][COUNT];
    for (int setting = 0; setting < SETTINGS; ++setting) {
        struct picture p;
        struct ref_scene view;
        make(&p, VKAO_SSAO_VBAO, WIDTH, HEIGHT, &scene, &lens);
        p.ssao.radius = 0.5f;
        const char *name = use_setting(&p, setting);
        picture_reference_scene(&p, &view);
        for (int side = 0; side < 2 && setting == 0; ++side) {
            for (int i = 0; i < COUNT; ++i) {
                int x = FIRST + i, y = last_of_wall(&p, x) + side;
                size_t t = (size_t)y * WIDTH + (size_t)x;
                double at[3];
                ref_view_position(&view.view, x, y, view.z[t], at);
                truth[side][i] =
                    scene_ambient(&scene, at, &view.normals[t * 3], (double)p.ssao.radius, 4096)
                        .falloff;
            }
        }
        picture_run(&p);
        double ripple[2];
        for (int side = 0; side < 2; ++side) {
            for (int i = 0; i < COUNT; ++i) {
                int x = FIRST + i, y = last_of_wall(&p, x) + side;
                ao[side][i] = p.values[SLOT_AO][(size_t)y * WIDTH + (size_t)x];
            }
            ripple[side] = ripple_of(ao[side], COUNT);
        }
        double all = hypot(ripple[0], ripple[1]);
        double most = hypot(ripple_of(truth[0], COUNT), ripple_of(truth[1], COUNT));
        print_message("    %-8s ripple beside the corner %.4f, of truth %.4f\n", name, all, most);
        /* A blur that keeps the walls apart leaves more of the noise of two slices. */
        assert_true(all <= (setting == VKAO_QUALITY_HIGH ? 1.7 : 1.3) * most);
        ref_scene_free(&view);
        picture_free(&p);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {gpu_test(leaning_normals_lose_what_the_plane_hides),
                                       gpu_test(planes_are_open_at_any_field_of_view),
                                       gpu_test(a_straight_corner_has_no_dashes)};
    return fixture_run(tests);
}
