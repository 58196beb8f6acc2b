/* SPDX-License-Identifier: MIT
 *
 * Against truth: closed forms, and rays cast into the scene itself. The depth image shows one layer
 * of it, so that the methods cannot agree with truth everywhere; the limits are what they reach,
 * with a little room. */
#include "fixture.h"
#include "ref_normal.h"
#include "ref_scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846, degrees = 57.29577951308232;

static const vkao_ssao_method methods[] = {VKAO_SSAO_HBAO, VKAO_SSAO_GTAO, VKAO_SSAO_VBAO,
                                           VKAO_SSAO_RAYMARCH};
static const char *const names[] = {"hbao", "gtao", "vbao", "raymarch"};
enum { METHODS = sizeof methods / sizeof methods[0] };

/* Many samples, noise blurred by nothing. */
static void make(struct picture *p, const struct scene *scene, const struct lens *lens, int method,
                 vkao_falloff falloff)
{
    picture_init(p, 96, 72, VKAO_STAGE_SSAO | VKAO_STAGE_BLUR);
    p->view.depth_encoding = VKAO_DEPTH_VIEW_Z;
    p->view.normal_encoding = VKAO_NORMALS_XYZ_SNORM;
    picture_render_scene(p, scene, lens, VK_FORMAT_R32_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT);
    picture_set(p, SLOT_AO, VK_FORMAT_R32_SFLOAT, NULL);
    if (methods[method] != VKAO_SSAO_HBAO)
        picture_set(p, SLOT_BENT, VK_FORMAT_R32G32B32A32_SFLOAT, NULL);
    p->ssao.method = methods[method];
    p->ssao.falloff = falloff;
    p->ssao.slice_count = 16;
    p->ssao.step_count = 32;
    p->ssao.sample_count = 128;
    p->ssao.radius = 1.0f;
    p->ssao.bias = 0.005f;
    p->blur.radius = 0;
}

/* A point of a floor at distance d from an endless wall: the wall within reach R is a half disk of
 * radius r = sqrt(R^2 - d^2), whose form factor is (atan(r / d) - d r / R^2) / pi. The smooth
 * falloff takes away 2 d (r - d atan(r / d)) / (pi R^2) of it. */
static double beside_a_wall(double d, double reach, vkao_falloff falloff)
{
    if (d >= reach)
        return 1.0;
    double r = sqrt(reach * reach - d * d), occluded = (atan(r / d) - d * r / (reach * reach)) / pi;
    if (falloff == VKAO_FALLOFF_SMOOTH)
        occluded -= 2.0 * d * (r - d * atan(r / d)) / (pi * reach * reach);
    return 1.0 - occluded;
}

static void rays_agree_with_the_closed_form(void **state)
{
    (void)state;
    const struct scene groove = scene_groove();
    for (int i = 1; i <= 12; ++i) {
        double d = i * 0.1, s = d * sqrt(0.5);
        const double point[3] = {0.3, s, 4.0 - s}, normal[3] = {0.0, -sqrt(0.5), -sqrt(0.5)};
        struct scene_ambient a = scene_ambient(&groove, point, normal, 1.0, 20000);
        assert_true(fabs(a.threshold - beside_a_wall(d, 1.0, VKAO_FALLOFF_THRESHOLD)) < 1e-3);
        assert_true(fabs(a.falloff - beside_a_wall(d, 1.0, VKAO_FALLOFF_SMOOTH)) < 1e-3);
    }
}

/* Two endless walls at a right angle, seen along the bisector: each shades the other. Means of
 * rows, as the distance to the edge is that of the row. */
static void floor_beside_a_wall_is_as_dark_as_it_should_be(void **state)
{
    (void)state;
    static const double limits[METHODS][2] = {
        {0.14, 0.15}, {0.15, 0.015}, {0.045, 0.04}, {0.02, 0.015}};
    const struct scene groove = scene_groove();
    struct lens lens = lens_orthographic(1.6, 1.2);
    for (int i = 0; i < METHODS * 2; ++i) {
        struct picture p;
        vkao_falloff falloff = (vkao_falloff)(i / METHODS);
        double worst = 0.0, mean = 0.0;
        int rows = 0;
        make(&p, &groove, &lens, i % METHODS, falloff);
        picture_run(&p);
        for (uint32_t y = 4; y < 68; ++y) {
            double sum = 0.0, d = fabs((y + 0.5) / 36.0 - 1.0) * 1.2 * sqrt(2.0);
            for (uint32_t x = 30; x < 66; ++x) /* a reach away from the borders */
                sum += p.values[SLOT_AO][y * 96 + x] / 36.0;
            double error = sum - beside_a_wall(d, 1.0, falloff);
            worst = fmax(worst, fabs(error));
            mean += error;
            ++rows;
        }
        print_message("    %-8s falloff %d: largest error of a row %.4f, mean %+.4f\n",
                      names[i % METHODS], (int)falloff, worst, mean / rows);
        assert_true(worst < limits[i % METHODS][falloff]);
        picture_free(&p);
    }
}

struct error {
    double square, bias, angle;
    size_t count;
};

/* Every fifth texel of every fifth row, less the outermost, which know nothing of the scene on one
 * side. */
static struct error compare(const struct picture *p, const struct scene *scene)
{
    struct error e = {0.0, 0.0, 0.0, 0};
    struct ref_scene view;
    picture_reference_scene(p, &view);
    for (uint32_t y = 10; y < p->height - 10; y += 5) {
        for (uint32_t x = 10; x < p->width - 10; x += 5) {
            size_t i = (size_t)y * p->width + x;
            double at[3], bent[3];
            if (isnan(view.z[i]))
                continue;
            ref_view_position(&view.view, x, y, view.z[i], at);
            struct scene_ambient a =
                scene_ambient(scene, at, &view.normals[i * 3], (double)p->ssao.radius, 512);
            double truth = p->ssao.falloff == VKAO_FALLOFF_SMOOTH ? a.falloff : a.threshold;
            e.square += pow(p->values[SLOT_AO][i] - truth, 2.0);
            e.bias += p->values[SLOT_AO][i] - truth;
            ++e.count;
            if (!p->formats[SLOT_BENT])
                continue;
            assert_true(
                ref_normal_decode(VKAO_NORMALS_XYZ_SNORM, &p->values[SLOT_BENT][i * 4], bent));
            bent[2] *= view.view.forward;
            e.angle += acos(fmin(1.0, ref_dot(bent, a.bent))) * degrees;
        }
    }
    ref_scene_free(&view);
    return e;
}

static void scenes_are_as_dark_as_they_should_be(void **state)
{
    (void)state;
    const struct {
        const char *name;
        struct scene scene;
        float thickness[METHODS];
        double limits[METHODS][2]; /* RMSE, smooth and threshold */
        double degrees[METHODS];   /* mean angle between bent normals, smooth */
    } rows[] = {
        {"corner",
         scene_corner(),
         {1.0f, 1.0f, 1.0f, 1.0f},
         {{0.045, 0.060}, {0.065, 0.060}, {0.030, 0.032}, {0.035, 0.055}},
         {0.0, 2.7, 1.4, 1.6}},
        {"sphere on plane",
         scene_sphere_on_plane(),
         {1.0f, 1.0f, 1.0f, 1.0f},
         {{0.015, 0.045}, {0.040, 0.020}, {0.010, 0.010}, {0.030, 0.015}},
         {0.0, 2.3, 0.5, 1.5}},
        {"staircase",
         scene_staircase(),
         {1.0f, 1.0f, 1.0f, 1.0f},
         {{0.090, 0.125}, {0.125, 0.115}, {0.075, 0.110}, {0.080, 0.115}},
         {0.0, 5.9, 3.0, 3.5}},
        /* Seen by its edge: vbao takes it to be as deep as that is high, and light to pass. */
        {"under a board",
         scene_board(),
         {1.0f, 1.0f, 1.0f, 1.0f},
         {{0.025, 0.050}, {0.025, 0.040}, {0.019, 0.039}, {0.015, 0.025}},
         {0.0, 1.4, 0.3, 0.5}},
        {"fence",
         scene_fence(),
         {0.2f, 0.2f, 0.6f, 0.2f},
         {{0.230, 0.390}, {0.115, 0.340}, {0.025, 0.035}, {0.035, 0.045}},
         {0.0, 7.4, 1.1, 2.0}},
    };
    struct lens lens = lens_perspective(0.6, 0.45);
    size_t failures = 0;
    for (size_t i = 0; i < sizeof rows / sizeof rows[0] * METHODS * 2; ++i) {
        size_t row = i / (METHODS * 2), m = i % METHODS, falloff = i / METHODS % 2;
        struct picture p;
        make(&p, &rows[row].scene, &lens, (int)m, (vkao_falloff)falloff);
        p.ssao.thickness = rows[row].thickness[m];
        picture_run(&p);
        struct error e = compare(&p, &rows[row].scene);
        double rmse = sqrt(e.square / (double)e.count), angle = e.angle / (double)e.count;
        bool good =
            rmse < rows[row].limits[m][falloff] && (falloff || angle <= rows[row].degrees[m]);
        print_message("    %-16s %-8s falloff %zu: RMSE %.4f, mean %+.4f, bent normals off by %.2f "
                      "degrees%s\n",
                      rows[row].name, names[m], falloff, rmse, e.bias / (double)e.count, angle,
                      good ? "" : " TOO MUCH");
        failures += !good;
        picture_free(&p);
    }
    assert_int_equal(failures, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        gpu_test(rays_agree_with_the_closed_form),
        gpu_test(floor_beside_a_wall_is_as_dark_as_it_should_be),
        gpu_test(scenes_are_as_dark_as_they_should_be),
    };
    return fixture_run(tests);
}
