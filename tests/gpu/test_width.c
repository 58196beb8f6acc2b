/* SPDX-License-Identifier: MIT
 *
 * Thickness as seen does not depend on how many texels show it, nor much on what stands before. */
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

/* A board before a wall, and the same behind a post that is more than a radius nearer: all but the
 * right quarter of the board is hidden. */
static const struct scene board = {{
    {SHAPE_PLANE, {0.0, 0.0, 6.0}, {0.0, 0.0, -1.0}},
    {SHAPE_BOX, {0.0, 0.0, 5.6}, {0.5, 9.0, 0.2}},
}};
static const struct scene hidden_board = {{
    {SHAPE_PLANE, {0.0, 0.0, 6.0}, {0.0, 0.0, -1.0}},
    {SHAPE_BOX, {0.0, 0.0, 5.6}, {0.5, 9.0, 0.2}},
    {SHAPE_BOX, {-0.35, 0.0, 4.0}, {0.54, 9.0, 0.05}},
}};

static void render(struct picture *p, const struct scene *scene, vkao_quality quality,
                   uint32_t scale)
{
    const struct lens lens = lens_perspective(0.4, 0.225);
    picture_init(p, 480 * scale, 270 * scale, VKAO_STAGE_SSAO | VKAO_STAGE_BLUR);
    p->view.depth_encoding = VKAO_DEPTH_VIEW_Z;
    p->view.normal_encoding = VKAO_NORMALS_XYZ_SNORM;
    picture_render_scene(p, scene, &lens, VK_FORMAT_R32_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT);
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
        render(&small, &things, (vkao_quality)quality, 1);
        for (uint32_t scale = 2; scale <= 4; scale *= 2) {
            render(&large, &things, (vkao_quality)quality, scale);
            const double off = apart(&small, &large, scale);
            print_message("    preset %d, %u times the texels: %.4f apart\n", quality,
                          scale * scale, off);
            assert_true(off <= 0.015);
            picture_free(&large);
        }
        picture_free(&small);
    }
}

/* The wall to the right of the board, up to half a radius away. */
static double beside_the_board(const struct scene *scene, vkao_quality quality)
{
    struct picture p;
    render(&p, scene, quality, 1);
    double sum = 0.0;
    size_t count = 0;
    for (size_t y = 0; y < p.height; ++y)
        for (size_t x = (size_t)((1.0 + 0.5 / 5.4 / 0.4) * p.width / 2.0) + 2;
             x < (size_t)((1.0 + 0.8 / 6.0 / 0.4) * p.width / 2.0); ++x) {
            sum += p.values[SLOT_AO][y * p.width + x];
            ++count;
        }
    picture_free(&p);
    return sum / (double)count;
}

static void what_is_hidden_goes_on(void **state)
{
    (void)state;
    for (int quality = 0; quality < 4; ++quality) {
        const double seen = beside_the_board(&board, (vkao_quality)quality),
                     hidden = beside_the_board(&hidden_board, (vkao_quality)quality);
        print_message("    preset %d: %.4f beside the board, %.4f beside what is seen of it\n",
                      quality, seen, hidden);
        assert_true(seen < 0.95);
        assert_true(fabs(hidden - seen) < 0.01);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {gpu_test(resolution_does_not_matter),
                                       gpu_test(what_is_hidden_goes_on)};
    return fixture_run(tests);
}
