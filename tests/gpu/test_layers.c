/* SPDX-License-Identifier: MIT
 *
 * What a thickness image and a second layer of depth are worth: how much closer to rays cast into
 * the scene AO comes with them. */
#include "fixture.h"
#include "ref_methods.h"
#include "ref_scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 192, HEIGHT = 144 };

/* Three cards, one behind the other, before a wall. */
static struct scene scene_cards(void)
{
    return (struct scene){{
        {SHAPE_PLANE, {0.0, 0.0, 4.6}, {0.1, 0.3, -1.0}},
        {SHAPE_BOX, {-0.5, 0.1, 3.4}, {0.5, 0.3, 0.01}},
        {SHAPE_BOX, {0.1, -0.1, 3.7}, {0.4, 0.5, 0.01}},
        {SHAPE_BOX, {0.6, 0.2, 4.0}, {0.5, 0.3, 0.02}},
    }};
}

/* Beams that go far back, side by side. */
static struct scene scene_beams(void)
{
    return (struct scene){{
        {SHAPE_PLANE, {0.0, 0.9, 4.0}, {0.0, -1.0, -0.3}},
        {SHAPE_BOX, {-0.7, 0.5, 4.0}, {0.06, 0.06, 0.9}},
        {SHAPE_BOX, {-0.2, 0.2, 4.0}, {0.08, 0.08, 1.0}},
        {SHAPE_BOX, {0.3, 0.5, 4.0}, {0.05, 0.2, 0.8}},
        {SHAPE_BOX, {0.8, 0.1, 4.2}, {0.1, 0.05, 1.0}},
    }};
}

struct row {
    const char *name;
    struct scene scene;
};

static struct picture make(const struct scene *scene, vkao_ssao_method method,
                           vkao_thickness_input input, bool has_second)
{
    struct lens lens = lens_perspective(0.6, 0.45);
    struct picture p;
    picture_init(&p, WIDTH, HEIGHT, VKAO_STAGE_SSAO | VKAO_STAGE_BLUR);
    p.view.depth_encoding = VKAO_DEPTH_VIEW_Z;
    p.view.normal_encoding = VKAO_NORMALS_XYZ_SNORM;
    picture_render_scene(&p, scene, &lens, VK_FORMAT_R32_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT);
    picture_set(&p, SLOT_AO, VK_FORMAT_R32_SFLOAT, NULL);
    p.thickness_input = input;
    picture_render_behind(&p, scene, &lens);
    if (input == VKAO_THICKNESS_AS_SEEN)
        p.formats[SLOT_THICKNESS] = VK_FORMAT_UNDEFINED;
    if (!has_second)
        p.formats[SLOT_SECOND] = VK_FORMAT_UNDEFINED;
    p.ssao.method = method;
    p.ssao.slice_count = 4;
    p.ssao.step_count = method == VKAO_SSAO_VBAO ? 16 : 32;
    p.ssao.sample_count = 32;
    p.ssao.radius = 1.0f;
    p.blur.radius = 1;
    return p;
}

/* Every sixth texel of every sixth row, less those near the border. */
static void truth_of(const struct picture *p, const struct scene *scene, double *truth)
{
    struct ref_scene view;
    picture_reference_scene(p, &view);
    for (int y = 0; y < HEIGHT / 6; ++y) {
        for (int x = 0; x < WIDTH / 6; ++x) {
            size_t i = (size_t)(y * 6 + 3) * WIDTH + (size_t)(x * 6 + 3);
            double at[3];
            truth[y * (WIDTH / 6) + x] = NAN;
            if (x < 3 || x >= WIDTH / 6 - 3 || y < 3 || y >= HEIGHT / 6 - 3 || isnan(view.z[i]))
                continue;
            ref_view_position(&view.view, x * 6 + 3, y * 6 + 3, view.z[i], at);
            truth[y * (WIDTH / 6) + x] =
                scene_ambient(scene, at, &view.normals[i * 3], (double)p->ssao.radius, 512).falloff;
        }
    }
    ref_scene_free(&view);
}

static double rmse_of(struct picture *p, const double *truth)
{
    double sum = 0.0;
    int count = 0;
    picture_run(p);
    for (int y = 0; y < HEIGHT / 6; ++y) {
        for (int x = 0; x < WIDTH / 6; ++x) {
            double want = truth[y * (WIDTH / 6) + x];
            if (isnan(want))
                continue;
            sum += pow(p->values[SLOT_AO][(y * 6 + 3) * WIDTH + x * 6 + 3] - want, 2.0);
            ++count;
        }
    }
    picture_free(p);
    return sqrt(sum / count);
}

static void truth_of_thickness_and_layers_pays(void **state)
{
    (void)state;
    const struct row rows[] = {
        {"fence", scene_fence()},
        {"under a board", scene_board()},
        {"cards", scene_cards()},
        {"beams", scene_beams()},
        {"posts", scene_posts()},
        {"steps", scene_steps()},
        {"staircase", scene_staircase()},
        {"corner", scene_corner()},
        {"sphere", scene_sphere_on_plane()},
    };
    enum { ROWS = sizeof rows / sizeof rows[0], FORMS = 4 };
    static const char *const names[] = {"vbao", "raymarch"};
    static double truths[ROWS][(WIDTH / 6) * (HEIGHT / 6)];
    for (int i = 0; i < ROWS; ++i) {
        struct picture p = make(&rows[i].scene, VKAO_SSAO_VBAO, VKAO_THICKNESS_AS_SEEN, false);
        truth_of(&p, &rows[i].scene, truths[i]);
        picture_free(&p);
    }
    for (int m = 0; m < 2; ++m) {
        double mean[FORMS] = {0};
        for (int i = 0; i < ROWS; ++i) {
            double errors[FORMS];
            for (int f = 0; f < FORMS; ++f) {
                static const vkao_thickness_input inputs[FORMS] = {
                    VKAO_THICKNESS_AS_SEEN, VKAO_THICKNESS_GIVEN, VKAO_THICKNESS_AS_SEEN,
                    VKAO_THICKNESS_BACK_DEPTH};
                struct picture p = make(&rows[i].scene, m ? VKAO_SSAO_RAYMARCH : VKAO_SSAO_VBAO,
                                        inputs[f], f >= 2);
                errors[f] = rmse_of(&p, truths[i]);
                mean[f] += log(errors[f] / errors[0]) / ROWS;
            }
            /* Rays are few, and their noise is that large. */
            const double most = errors[0] + (m ? 0.002 : 0.0);
            assert_true(errors[1] <= most && errors[3] <= most);
            print_message("    %-8s %-14s alone %.4f, with thickness %.4f, second layer %.4f, both "
                          "%.4f\n",
                          names[m], rows[i].name, errors[0], errors[1], errors[2], errors[3]);
        }
        print_message("    %-8s of alone: thickness %.3f, second layer %.3f, both %.3f\n", names[m],
                      exp(mean[1]), exp(mean[2]), exp(mean[3]));
        assert_true(exp(mean[1]) <= 0.6 && exp(mean[2]) <= 0.97 && exp(mean[3]) <= 0.55);
    }
}

/* Both methods, with all inputs, against double precision. */
static void agrees_with_the_reference(void **state)
{
    (void)state;
    const struct scene scene = scene_corner();
    for (int i = 0; i < 2 * 3 * 2; ++i) {
        const bool is_vbao = i % 2, has_second = i >= 6;
        const vkao_thickness_input input = (vkao_thickness_input)(i / 2 % 3);
        struct picture p =
            make(&scene, is_vbao ? VKAO_SSAO_VBAO : VKAO_SSAO_RAYMARCH, input, has_second);
        struct ref_scene first, second;
        const size_t texels = picture_texels(&p);
        double *thickness = test_alloc(texels, sizeof *thickness),
               *want = test_alloc(texels, sizeof *want);
        char what[60];
        p.stages = VKAO_STAGE_SSAO;
        p.ssao.slice_count = 2;
        p.ssao.step_count = 6;
        p.ssao.sample_count = 8;
        picture_reference_scene(&p, &first);
        for (size_t t = 0; t < texels && input; ++t)
            thickness[t] = p.values[SLOT_THICKNESS][t] -
                           (input == VKAO_THICKNESS_BACK_DEPTH ? first.z[t] : 0.0);
        first.thickness = input ? thickness : NULL;
        if (has_second) {
            ref_scene_init(&second, &p.view, p.width, p.height, p.formats[SLOT_SECOND],
                           p.values[SLOT_SECOND], p.values[SLOT_NORMALS]);
            first.second = &second;
        }
        picture_run(&p);
        (is_vbao ? ref_vbao : ref_raymarch)(&first, &p.ssao, want);
        snprintf(what, sizeof what, "%s, input %d%s", is_vbao ? "vbao" : "raymarch", (int)input,
                 has_second ? ", second layer" : "");
        /* Two sectors of 31, or a ray of 8, here and there. */
        check_close(what, p.values[SLOT_AO], want, texels, 1e-3, 0.02, 0.3);
        if (has_second)
            ref_scene_free(&second);
        ref_scene_free(&first);
        free(thickness);
        free(want);
        picture_free(&p);
    }
}

/* Half resolution has the thickness and the second layer of the texels whose depth it has: the even
 * ones. What the others hold makes no difference. */
static void half_resolution_reads_even_texels(void **state)
{
    (void)state;
    const struct scene scene = scene_beams();
    for (int i = 0; i < 2 * 2; ++i) {
        const vkao_thickness_input input = i % 2 ? VKAO_THICKNESS_BACK_DEPTH : VKAO_THICKNESS_GIVEN;
        const vkao_ssao_method method = i / 2 ? VKAO_SSAO_RAYMARCH : VKAO_SSAO_VBAO;
        struct picture p[3];
        for (int k = 0; k < 3; ++k) {
            p[k] = make(&scene, method, input, true);
            p[k].half_resolution = true;
            p[k].ssao.sample_count = 8;
            for (size_t t = 0; t < picture_texels(&p[k]) && k > 0; ++t) {
                const bool is_even = t % WIDTH % 2 == 0 && t / WIDTH % 2 == 0;
                if (is_even == (k == 2)) /* unknown, and nothing */
                    p[k].values[SLOT_THICKNESS][t] = p[k].values[SLOT_SECOND][t] = 0.0;
            }
            picture_run(&p[k]);
        }
        check_equal("odd texels hold nothing", p[1].values[SLOT_AO], p[0].values[SLOT_AO],
                    picture_texels(&p[0]));
        const struct difference even =
            difference_of(p[2].values[SLOT_AO], p[0].values[SLOT_AO], picture_texels(&p[0]));
        print_message("    %s, input %d: without what even texels hold %.4f apart\n",
                      i / 2 ? "raymarch" : "vbao", (int)input, even.mean);
        assert_true(even.mean > 0.002);
        for (int k = 0; k < 3; ++k)
            picture_free(&p[k]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {gpu_test(truth_of_thickness_and_layers_pays),
                                       gpu_test(agrees_with_the_reference),
                                       gpu_test(half_resolution_reads_even_texels)};
    return fixture_run(tests);
}
