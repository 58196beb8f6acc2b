/* SPDX-License-Identifier: MIT
 *
 * Thickness as seen does not depend on how many texels show it, nor much on what stands before. */
#include "ref_methods.h"
#include "ssao_checks.h"

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

static void set_up(struct picture *p, const struct scene *scene, vkao_quality quality,
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
}

static void render(struct picture *p, const struct scene *scene, vkao_quality quality,
                   uint32_t scale)
{
    set_up(p, scene, quality, scale);
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

/* Each word of breaks is put together by several invocations: what one of them loses makes things
 * wider or narrower than they are. */
static void things_are_as_thick_as_the_reference_has_them(void **state)
{
    (void)state;
    const struct scene scenes[] = {things, scene_fence(), scene_posts()};
    for (size_t i = 0; i < sizeof scenes / sizeof scenes[0]; ++i) {
        struct picture p;
        char what[80];
        picture_make(&p, VKAO_STAGE_SSAO, &scenes[i]);
        p.ssao.radius = 0.6f;
        snprintf(what, sizeof what, "scene %zu against the reference", i);
        check_ssao(&p, ref_vbao, what);
        picture_free(&p);
    }
}

/* What bars of a texel hide of a wall behind them that ends where they do, before the sky. The wall
 * is half the picture; so many columns of sky lie between two bars. */
static double hidden_by_bars(size_t gap, vkao_quality quality)
{
    static const struct scene wall = {{{SHAPE_PLANE, {0.0, 0.0, 6.0}, {0.0, 0.0, -1.0}}}};
    enum { NEAR_BARS = 30 }; /* columns; a radius has 60 */
    struct picture p;
    set_up(&p, &wall, quality, 1);
    const size_t first = p.width / 2;
    for (size_t y = 0; y < p.height; ++y)
        for (size_t x = 0; x < first; ++x)
            p.values[SLOT_DEPTH][y * p.width + x] =
                (first - 1 - x) % (gap + 1) == 0 ? 5.7 : (double)INFINITY;
    picture_run(&p);
    double sum = 0.0;
    for (size_t y = 0; y < p.height; ++y)
        for (size_t x = first; x < first + NEAR_BARS; ++x)
            sum += 1.0 - p.values[SLOT_AO][y * p.width + x];
    const double mean = sum / (double)(p.height * NEAR_BARS);
    picture_free(&p);
    return mean;
}

/* Beside a lone column of sky depth changes as much as into it: without more than that all bars
 * would be one thing, as thick as they are wide together. */
static void bars_before_the_sky_are_thin(void **state)
{
    (void)state;
    for (int quality = 0; quality < 4; ++quality) {
        const double close = hidden_by_bars(1, (vkao_quality)quality),
                     apart_by_two = hidden_by_bars(2, (vkao_quality)quality);
        print_message("    preset %d: a column of sky between bars hides %.4f, two %.4f\n", quality,
                      close, apart_by_two);
        assert_true(apart_by_two > 0.03);
        /* There are half as many more of them; at half resolution none is seen. */
        assert_true(close < 1.8 * apart_by_two);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {gpu_test(resolution_does_not_matter),
                                       gpu_test(things_are_as_thick_as_the_reference_has_them),
                                       gpu_test(what_is_hidden_goes_on),
                                       gpu_test(bars_before_the_sky_are_thin)};
    return fixture_run(tests);
}
