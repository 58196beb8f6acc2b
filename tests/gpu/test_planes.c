/* SPDX-License-Identifier: MIT
 *
 * Infinite planes are open at any field of view. */
#include "fixture.h"

#include <math.h>
#include <stdio.h>

static const double pi = 3.14159265358979323846;

static const char *const names[] = {"sphere", "hemisphere", "hbao", "gtao", "vbao", "raymarch"};
enum { METHODS = sizeof names / sizeof names[0], WIDTH = 96, HEIGHT = 72 };

/* A plane whose normal has this cosine to the view direction. */
static struct scene plane_of(double facing)
{
    const double aside = sqrt(1.0 - facing * facing);
    return (struct scene){{{SHAPE_PLANE, {0.0, 0.0, 4.0}, {0.6 * aside, 0.8 * aside, -facing}}}};
}

static double darkest_of(int method, double degrees, double facing)
{
    const double half = tan(degrees * pi / 360.0);
    const struct lens lens = lens_perspective(half * WIDTH / HEIGHT, half);
    const struct scene scene = plane_of(facing);
    struct picture p;
    double least = 1.0;
    picture_init(&p, WIDTH, HEIGHT, VKAO_STAGE_SSAO | VKAO_STAGE_BLUR);
    p.view.depth_encoding = VKAO_DEPTH_VIEW_Z;
    p.view.normal_encoding = VKAO_NORMALS_XYZ_SNORM;
    picture_render_scene(&p, &scene, &lens, VK_FORMAT_R32_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT);
    picture_set(&p, SLOT_AO, VK_FORMAT_R32_SFLOAT, NULL);
    p.ssao.method = (vkao_ssao_method)method;
    p.ssao.radius = 1.0f;
    picture_run(&p);
    for (size_t t = 0; t < picture_texels(&p); ++t)
        least = fmin(least, p.values[SLOT_AO][t]);
    picture_free(&p);
    return least;
}

static void planes_are_open_at_any_field_of_view(void **state)
{
    (void)state;
    static const double degrees[] = {60, 120, 150, 170};
    static const double facings[] = {1.0, 0.95, 0.6};
    for (int i = 0; i < METHODS * 4 * 3; ++i) {
        const double angle = degrees[i / 3 % 4], facing = facings[i % 3];
        const double least = darkest_of(i / 12, angle, facing);
        print_message("    %-10s %3.0f degrees, cosine %.2f: darkest %.4f\n", names[i / 12], angle,
                      facing, least);
        assert_true(least >= 0.998);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {gpu_test(planes_are_open_at_any_field_of_view)};
    return fixture_run(tests);
}
