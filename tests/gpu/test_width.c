/* SPDX-License-Identifier: MIT
 *
 * Thickness as seen does not depend on how many texels show it. */
#include "fixture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Rods, a slab and a ball before a wall and a floor. */
static const struct scene things = {{
    {SHAPE_PLANE, {0.0, 0.0, 6.0}, {0.0, 0.0, -1.0}},
    {SHAPE_PLANE, {0.0, -1.2, 0.0}, {0.0, 1.0, 0.0}},
    {SHAPE_BOX, {-1.2, 0.2, 5.6}, {0.03, 1.4, 0.03}},
    {SHAPE_BOX, {-0.8, 0.2, 5.5}, {0.06, 1.4, 0.03}},
    {SHAPE_BOX, {0.2, -0.6, 5.2}, {0.5, 0.6, 0.05}},
    {SHAPE_SPHERE, {1.3, -0.7, 5.0}, {0.5}},
}};

static void render(struct picture *p, vkao_quality quality, uint32_t scale)
{
    const struct lens lens = lens_perspective(0.4, 0.225);
    picture_init(p, 480 * scale, 270 * scale, VKAO_STAGE_SSAO | VKAO_STAGE_BLUR);
    p->view.depth_encoding = VKAO_DEPTH_VIEW_Z;
    p->view.normal_encoding = VKAO_NORMALS_XYZ_SNORM;
    picture_render_scene(p, &things, &lens, VK_FORMAT_R32_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT);
    picture_set(p, SLOT_AO, VK_FORMAT_R32_SFLOAT, NULL);
    picture_preset(p, quality);
    p->ssao.radius = 0.6f;
    picture_run(p);
}

/* Root mean square of AO less that of a picture of more texels, averaged. */
static double apart(const struct picture *small, const struct picture *large, uint32_t scale)
{
    const size_t width = 480, height = 270;
    double sum = 0.0;
    for (size_t y = 0; y < height; ++y)
        for (size_t x = 0; x < width; ++x) {
            double mean = 0.0;
            for (size_t i = 0; i < (size_t)scale * scale; ++i)
                mean += large->values[SLOT_AO][(y * scale + i / scale) * width * scale + x * scale +
                                               i % scale];
            sum += pow(mean / (scale * scale) - small->values[SLOT_AO][y * width + x], 2.0);
        }
    return sqrt(sum / (double)(width * height));
}

static void resolution_does_not_matter(void **state)
{
    (void)state;
    for (int quality = 0; quality < 4; ++quality) {
        struct picture small, large;
        render(&small, (vkao_quality)quality, 1);
        for (uint32_t scale = 2; scale <= 4; scale *= 2) {
            render(&large, (vkao_quality)quality, scale);
            const double off = apart(&small, &large, scale);
            print_message("    preset %d, %u times the texels: %.4f apart\n", quality,
                          scale * scale, off);
            assert_true(off <= 0.015);
            picture_free(&large);
        }
        picture_free(&small);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {gpu_test(resolution_does_not_matter)};
    return fixture_run(tests);
}
