/* SPDX-License-Identifier: MIT
 *
 * Infinite planes: open at any tilt, at any field of view, and under normals that lean away from
 * them by as much as they hide. */
#include "fixture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

static const char *const names[] = {"sphere", "hemisphere", "hbao", "gtao", "vbao", "raymarch"};
enum { METHODS = sizeof names / sizeof names[0], WIDTH = 192, HEIGHT = 144 };

/* A plane whose normal has this cosine to the view direction. */
static struct scene plane_of(double facing)
{
    const double aside = sqrt(1.0 - facing * facing);
    return (struct scene){{{SHAPE_PLANE, {0.0, 0.0, 4.0}, {0.6 * aside, 0.8 * aside, -facing}}}};
}

static void make(struct picture *p, int method, const struct scene *scene, const struct lens *lens)
{
    picture_init(p, WIDTH, HEIGHT, VKAO_STAGE_SSAO | VKAO_STAGE_BLUR);
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
        n[i] = cos(angle) * plane[i] +
               sin(angle) * (cos(azimuth) * a[i] + sin(azimuth) * b[i]);
    for (size_t t = 0; t < picture_texels(p); ++t)
        for (int i = 0; i < 3; ++i)
            p->values[SLOT_NORMALS][t * 4 + (size_t)i] = i == 2 ? -n[2] : n[i];
    return -n[2];
}

/* Mean AO where all of the radius lies in the image. */
static double middle_of(const struct picture *p)
{
    double sum = 0.0;
    for (int y = 64; y < 80; ++y)
        sum += mean_of(&p->values[SLOT_AO][y * WIDTH + 80], 32) / 16.0;
    return sum;
}

static void leaning_normals_lose_what_the_plane_hides(void **state)
{
    (void)state;
    static const double facings[] = {0.95, 0.6, 0.285, 0.05}, angles[] = {10, 20, 35, 50, 70};
    const struct lens lens = lens_perspective(0.012, 0.009);
    for (int method = 0; method < METHODS; ++method) {
        double worst = 0.0, at[3] = {0};
        for (size_t f = 0; f < 4; ++f)
            for (size_t a = 0; a < 5; ++a)
                for (int k = 0; k < 8; ++k) {
                    const struct scene scene = plane_of(facings[f]);
                    const double *plane = scene.shapes[0].size;
                    struct picture p;
                    make(&p, method, &scene, &lens);
                    p.ssao.radius = 0.03f;
                    const double angle = angles[a] * pi / 180.0;
                    if (tilt(&p, plane, angle, k * pi / 4.0) > 0.01) {
                        picture_run(&p);
                        const double off = middle_of(&p) - (1.0 + cos(angle)) / 2.0;
                        if (fabs(off) > fabs(worst)) {
                            worst = off;
                            at[0] = facings[f];
                            at[1] = angles[a];
                            at[2] = k;
                        }
                        if (getenv("ALL"))
                            print_message("  %s g.v %g tilt %g az %d: %+.4f\n", names[method], facings[f], angles[a], k, off);
                    }
                    picture_free(&p);
                }
        print_message("    %-10s off by %+.4f at g.v %g, %g degrees, azimuth %g\n", names[method],
                      worst, at[0], at[1], at[2]);
    }
}

static void planes_are_open_at_any_field_of_view(void **state)
{
    (void)state;
    static const double degrees[] = {60, 90, 120, 150, 170};
    for (int method = 0; method < METHODS; ++method)
        for (size_t d = 0; d < 5; ++d)
            for (int tilted = 0; tilted < 2; ++tilted) {
                const double half = tan(degrees[d] * pi / 360.0);
                const struct lens lens = lens_perspective(half * WIDTH / HEIGHT, half);
                const struct scene scene = plane_of(tilted ? 0.95 : 1.0 - 1e-9);
                struct picture p;
                make(&p, method, &scene, &lens);
                p.ssao.radius = 1.0f;
                picture_run(&p);
                double least = 1.0;
                for (size_t t = 0; t < picture_texels(&p); ++t)
                    least = fmin(least, p.values[SLOT_AO][t]);
                print_message("    %-10s %3.0f degrees, %s: %.4f\n", names[method], degrees[d],
                              tilted ? "tilted" : "straight", least);
                picture_free(&p);
            }
}

int main(void)
{
    const struct CMUnitTest tests[] = {gpu_test(leaning_normals_lose_what_the_plane_hides),
                                       gpu_test(planes_are_open_at_any_field_of_view)};
    return fixture_run(tests);
}
