/* SPDX-License-Identifier: MIT
 *
 * The blur alone: noisy AO in, AO out. */
#include "fixture.h"
#include "ref_blur.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* By which Vulkan lets a quotient of 1 be off: 2.5 units in the last place. */
#define DIVISION (2.5 * 0x1p-23)

/* A picture that the blur reads noise from, or one value if it is not negative. Single-precision
 * images. */
static void make(struct picture *p, const struct scene *scene, double value)
{
    uint32_t seed = 12345;
    picture_make(p, VKAO_STAGE_BLUR, scene);
    picture_set(p, SLOT_NOISY, VK_FORMAT_R32_SFLOAT, NULL);
    for (size_t i = 0; i < picture_texels(p); ++i) {
        seed = seed * 1664525u + 1013904223u;
        p->values[SLOT_NOISY][i] = value < 0.0 ? (double)(seed >> 16) / 65535.0 : value;
    }
    /* As its R32F image will hold it. */
    for (size_t i = 0; i < picture_texels(p); ++i)
        p->values[SLOT_NOISY][i] = (double)(float)p->values[SLOT_NOISY][i];
}

/* What lies between the two directions has 11 bits: a step of the upper half of [0,1] is 4.9e-4,
 * and some drivers cut rather than round. Intensity and power amplify it. */
static void check_against_reference(struct picture *p, const char *what)
{
    struct ref_scene reference;
    double *expected = test_alloc(picture_texels(p), sizeof *expected);
    picture_run(p);
    picture_reference_scene(p, &reference);
    ref_blur(&reference, &p->blur, p->view.normal_encoding, p->values[SLOT_NORMALS],
             p->values[SLOT_NOISY], (double)p->ssao.bias * (double)p->ssao.radius, expected);
    check_close(what, p->values[SLOT_AO], expected, picture_texels(p), 3e-4, 2e-3, 0.02);
    ref_scene_free(&reference);
    free(expected);
}

static void agrees_with_reference_for_every_parameter(void **state)
{
    (void)state;
    static const struct {
        uint32_t radius;
        float sharpness, normal_power, intensity, power;
        vkao_normal_encoding normals;
        bool orthographic;
    } rows[] = {
        {4, 200.0f, 8.0f, 1.0f, 1.0f, VKAO_NORMALS_XYZ_SNORM, false},
        {4, 200.0f, 8.0f, 1.0f, 1.0f, VKAO_NORMALS_FROM_DEPTH, false},
        {1, 50.0f, 0.0f, 1.0f, 1.0f, VKAO_NORMALS_XYZ_SNORM, false},
        {16, 10.0f, 128.0f, 1.0f, 1.0f, VKAO_NORMALS_XYZ_SNORM, false},
        {6, 0.0f, 0.0f, 1.0f, 1.0f, VKAO_NORMALS_XYZ_SNORM, false},
        {3, 10000.0f, 1.0f, 0.5f, 2.5f, VKAO_NORMALS_XYZ_SNORM, false},
        {4, 200.0f, 8.0f, 1.5f, 0.5f, VKAO_NORMALS_XYZ_SNORM, true},
        {8, 30.0f, 0.0f, 1.0f, 1.0f, VKAO_NORMALS_FROM_DEPTH, true},
    };
    const struct scene scenes[] = {scene_corner(), scene_steps(), scene_open_sky()};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; ++i) {
        for (size_t s = 0; s < sizeof scenes / sizeof scenes[0]; ++s) {
            struct picture p;
            char what[80];
            make(&p, &scenes[s], -1.0);
            if (rows[i].orthographic) {
                struct lens lens = lens_orthographic(1.6, 1.2);
                picture_render_scene(&p, &scenes[s], &lens, VK_FORMAT_R32_SFLOAT,
                                     VK_FORMAT_R32G32B32A32_SFLOAT);
            }
            p.view.normal_encoding = rows[i].normals;
            p.blur.radius = rows[i].radius;
            p.blur.sharpness = rows[i].sharpness;
            p.blur.normal_power = rows[i].normal_power;
            p.blur.intensity = rows[i].intensity;
            p.blur.power = rows[i].power;
            snprintf(what, sizeof what, "row %zu, scene %zu", i, s);
            check_against_reference(&p, what);
            picture_free(&p);
        }
    }
}

/* Normals are compared where both texels have one. What has none counts by depth alone, and so does
 * all around it. */
static void texels_without_a_normal_count_by_depth(void **state)
{
    (void)state;
    static const uint32_t radii[] = {3, 6};
    const struct scene scenes[] = {scene_corner(), scene_open_sky()};
    for (size_t i = 0; i < 2 * 2; ++i) {
        struct picture p;
        char what[80];
        make(&p, &scenes[i / 2], -1.0);
        p.blur.radius = radii[i % 2];
        p.blur.normal_power = 8.0f;
        for (size_t t = 0; t < picture_texels(&p); ++t)
            for (size_t c = 0; c < 4 && (t % p.width + 2 * (t / p.width)) % 5 == 0; ++c)
                p.values[SLOT_NORMALS][t * 4 + c] = 0.0;
        snprintf(what, sizeof what, "radius %u, scene %zu", radii[i % 2], i / 2);
        check_against_reference(&p, what);
        picture_free(&p);
    }
}

/* Leaves before the sky: most of a window is background, which gives nothing in either direction,
 * and is nothing that rows leave to columns. */
static void lone_texels_before_the_sky_agree_with_reference(void **state)
{
    (void)state;
    static const uint32_t radii[] = {3, 6};
    const struct scene wall = scene_tilted_plane(30.0, 70.0);
    for (size_t i = 0; i < 2 * 2; ++i) {
        struct picture p;
        uint32_t seed = 77;
        char what[80];
        make(&p, &wall, -1.0);
        p.blur.radius = radii[i % 2];
        p.blur.normal_power = i / 2 ? 8.0f : 0.0f;
        for (size_t t = 0; t < picture_texels(&p); ++t) {
            seed = seed * 1664525u + 1013904223u;
            if (seed >> 24 < 170)
                p.values[SLOT_DEPTH][t] = INFINITY;
        }
        snprintf(what, sizeof what, "radius %u, %s", radii[i % 2], i / 2 ? "normals" : "depth");
        check_against_reference(&p, what);
        picture_free(&p);
    }
}

/* Texels need not be as high as they are wide, nor parallel views as wide as things are far:
 * lengths of rows and of columns differ, and what sharpness is relative to. */
static void agrees_with_reference_in_oblong_and_narrow_views(void **state)
{
    (void)state;
    static const struct {
        uint32_t radius;
        bool orthographic;
        double half_width, half_height;
    } rows[] = {{3, false, 0.6, 0.15},
                {3, false, 0.15, 0.45},
                {6, false, 0.6, 0.15},
                {6, false, 0.15, 0.45},
                {3, true, 0.4, 1.2}};
    const struct scene scenes[] = {scene_corner(), scene_sphere_on_plane()};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0] * 2; ++i) {
        const size_t r = i / 2;
        const struct lens lens = rows[r].orthographic
                                     ? lens_orthographic(rows[r].half_width, rows[r].half_height)
                                     : lens_perspective(rows[r].half_width, rows[r].half_height);
        struct picture p;
        char what[80];
        make(&p, &scenes[i % 2], -1.0);
        picture_render_scene(&p, &scenes[i % 2], &lens, VK_FORMAT_R32_SFLOAT,
                             VK_FORMAT_R32G32B32A32_SFLOAT);
        p.view.normal_encoding = VKAO_NORMALS_FROM_DEPTH;
        p.blur.radius = rows[r].radius;
        p.blur.normal_power = 0.0f;
        p.blur.sharpness = 20.0f;
        snprintf(what, sizeof what, "radius %u, %s, %g by %g, scene %zu", rows[r].radius,
                 rows[r].orthographic ? "orthographic" : "perspective", rows[r].half_width,
                 rows[r].half_height, i % 2);
        check_against_reference(&p, what);
        picture_free(&p);
    }
}

/* A wall at z = 3 beside one at z = 4, each with its own AO. The walls face the eye, or are tilted
 * so that the slope is not 0. */
static void depth_edges_do_not_leak(void **state)
{
    (void)state;
    static const double tilts[] = {0.0, 0.02};
    static const uint32_t radii[] = {1, 4, 16};
    for (size_t i = 0; i < 2 * 3 * 2; ++i) {
        struct picture p;
        const struct scene wall = scene_tilted_plane(0.0, 0.0);
        bool vertical = i >= 6;
        make(&p, &wall, 0.0);
        p.view.normal_encoding = VKAO_NORMALS_FROM_DEPTH;
        p.blur.radius = radii[i % 3];
        for (size_t texel = 0; texel < picture_texels(&p); ++texel) {
            double along =
                vertical ? (double)(texel / p.width) - 30.0 : (double)(texel % p.width) - 40.0;
            p.values[SLOT_DEPTH][texel] = (along < 0.0 ? 3.0 : 4.0) + tilts[i / 3 % 2] * along;
            p.values[SLOT_NOISY][texel] = along < 0.0 ? 0.0 : 1.0;
        }
        picture_run(&p);
        for (size_t texel = 0; texel < picture_texels(&p); ++texel) {
            double want = p.values[SLOT_NOISY][texel], got = p.values[SLOT_AO][texel];
            if (!(fabs(got - want) <= (want == 1.0 ? 0.0 : DIVISION)))
                fail_msg("case %zu: texel %zu is %.9g, want %g", i, texel, got, want);
        }
        picture_free(&p);
    }
}

/* The same between surfaces at the same depth whose normals stand at right angles. */
static void normal_edges_do_not_leak(void **state)
{
    (void)state;
    struct picture p;
    const struct scene wall = scene_tilted_plane(0.0, 0.0);
    make(&p, &wall, 0.0);
    p.blur.normal_power = 8.0f;
    for (size_t i = 0; i < picture_texels(&p); ++i) {
        double *normal = &p.values[SLOT_NORMALS][i * 4];
        normal[0] = i % p.width < 40 ? sqrt(0.5) : -sqrt(0.5);
        normal[1] = 0.0;
        normal[2] = sqrt(0.5);
        p.values[SLOT_NOISY][i] = i % p.width < 40 ? 0.0 : 1.0;
    }
    picture_run(&p);
    for (size_t i = 0; i < picture_texels(&p); ++i)
        assert_true(fabs(p.values[SLOT_AO][i] - p.values[SLOT_NOISY][i]) < 1e-6);
    picture_free(&p);
}

/* A bar two texels wide before a wall, dark where the wall is open: it takes a share of what is
 * beside it, and the wall takes nothing of it. The last bar stands before background, which has
 * nothing to give. */
static void narrow_things_take_a_share_of_the_window(void **state)
{
    (void)state;
    static const struct {
        uint32_t radius;
        double own, all; /* blur_weight of the other texel of the bar, and of the whole window */
        double behind;   /* depth */
    } rows[] = {{3, 0.75, 3.0, 4.0}, {4, 1.0, 5.0, 4.0}, {3, 0.75, 3.0, INFINITY}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; ++i) {
        struct picture p;
        const struct scene wall = scene_tilted_plane(0.0, 0.0);
        make(&p, &wall, 0.0);
        p.view.normal_encoding = VKAO_NORMALS_FROM_DEPTH;
        p.blur.radius = rows[i].radius;
        for (size_t texel = 0; texel < picture_texels(&p); ++texel) {
            bool is_bar = texel % p.width / 2 == 20;
            p.values[SLOT_DEPTH][texel] = is_bar ? 3.0 : rows[i].behind;
            p.values[SLOT_NOISY][texel] = is_bar ? 0.0 : 1.0;
        }
        picture_run(&p);
        double leak = 0.15 * (1.0 - rows[i].own / (0.45 * rows[i].all)), want = 0.0;
        if (isfinite(rows[i].behind))
            want = leak * (rows[i].all - rows[i].own) /
                   (1.0 + rows[i].own / 1.35 + leak * rows[i].all);
        for (size_t texel = 0; texel < picture_texels(&p); ++texel) {
            bool is_bar = texel % p.width / 2 == 20;
            double got = p.values[SLOT_AO][texel];
            if (!(fabs(got - (is_bar ? want : 1.0)) <= (is_bar ? 1e-3 : 0.0)))
                fail_msg("row %zu: texel %zu is %.9g, want %g", i, texel, got, is_bar ? want : 1.0);
        }
        picture_free(&p);
    }
}

static void tilted_walls_are_blurred_in_one_piece(void **state)
{
    (void)state;
    struct picture p;
    const struct scene wall = scene_tilted_plane(60.0, 30.0);
    make(&p, &wall, -1.0);
    p.view.normal_encoding = VKAO_NORMALS_FROM_DEPTH;
    picture_run(&p);
    double before = 0.0, after = 0.0;
    for (size_t i = 0; i < picture_texels(&p); ++i) {
        before += pow(p.values[SLOT_NOISY][i] - 0.5, 2.0) / (double)picture_texels(&p);
        after += pow(p.values[SLOT_AO][i] - 0.5, 2.0) / (double)picture_texels(&p);
    }
    print_message("    variance of noise %.4f, blurred %.5f\n", before, after);
    assert_true(after < before / 5.0);
    picture_free(&p);
}

/* A wall, and a dark floor that meets it and comes nearer within what sharpness allows: without
 * normals slopes keep most of the edge, unless depth is ignored. */
static void inner_edges_are_kept_without_normals(void **state)
{
    (void)state;
    for (int is_ignored = 0; is_ignored < 2; ++is_ignored) {
        struct picture p;
        const struct scene wall = scene_tilted_plane(0.0, 0.0);
        make(&p, &wall, 0.0);
        p.view.normal_encoding = VKAO_NORMALS_FROM_DEPTH;
        p.blur.sharpness = is_ignored ? 0.0f : 1.0f;
        for (size_t i = 0; i < picture_texels(&p); ++i) {
            double y = (double)(i / p.width) - 29.5;
            p.values[SLOT_DEPTH][i] = 4.0 - fmax(0.0, y) * 0.1;
            p.values[SLOT_NOISY][i] = y > 0.0 ? 0.0 : 1.0;
        }
        picture_run(&p);
        double above = p.values[SLOT_AO][29 * p.width + 40],
               below = p.values[SLOT_AO][30 * p.width + 40];
        print_message("    %.3f above the edge, %.3f below\n", above, below);
        if (is_ignored)
            assert_true(above - below < 0.3);
        else
            assert_true(above - below > 0.5);
        picture_free(&p);
    }
}

/* Halfway between its two directions the blur stores 11 bits, and drivers may round them either
 * way: a step of the upper half of [0,1] is 1/2048. Open stays so exactly. */
static void constants_are_kept(void **state)
{
    (void)state;
    static const double values[] = {0.0, 0.25, 0.5, 0.75, 1.0};
    const struct scene scene = scene_open_sky();
    for (size_t v = 0; v < sizeof values / sizeof values[0]; ++v) {
        struct picture p;
        make(&p, &scene, values[v]);
        picture_run(&p);
        for (size_t i = 0; i < picture_texels(&p); ++i) {
            double want = isfinite(p.values[SLOT_DEPTH][i]) ? values[v] : 1.0;
            double tolerance = want == 1.0 ? 0.0 : want == 0.0 ? DIVISION : 1.0 / 1024.0;
            if (!(fabs(p.values[SLOT_AO][i] - want) <= tolerance))
                fail_msg("texel %zu is %.9g, want %.9g", i, p.values[SLOT_AO][i], want);
        }
        picture_free(&p);
    }
}

static void radius_0_copies(void **state)
{
    (void)state;
    struct picture p;
    const struct scene wall = scene_tilted_plane(0.0, 0.0);
    make(&p, &wall, -1.0);
    p.blur.radius = 0;
    for (size_t i = 0; i < picture_texels(&p); ++i) /* multiples of 1/1024 survive half precision */
        p.values[SLOT_NOISY][i] = floor(p.values[SLOT_NOISY][i] * 1024.0) / 1024.0;
    picture_run(&p);
    check_equal("copied ao", p.values[SLOT_AO], p.values[SLOT_NOISY], picture_texels(&p));
    picture_free(&p);
}

static void intensity_and_power_follow_the_formula(void **state)
{
    (void)state;
    static const float intensities[] = {0.0f, 0.5f, 1.0f, 3.0f, 8.0f},
                       powers[] = {0.25f, 1.0f, 2.0f, 8.0f};
    const struct scene wall = scene_tilted_plane(0.0, 0.0);
    for (size_t i = 0; i < sizeof intensities / sizeof intensities[0] * 4; ++i) {
        struct picture p;
        make(&p, &wall, -1.0);
        p.blur.radius = 0;
        p.blur.intensity = intensities[i / 4];
        p.blur.power = powers[i % 4];
        for (size_t texel = 0; texel < picture_texels(&p); ++texel)
            p.values[SLOT_NOISY][texel] = floor(p.values[SLOT_NOISY][texel] * 1024.0) / 1024.0;
        picture_run(&p);
        for (size_t texel = 0; texel < picture_texels(&p); ++texel) {
            double scaled = 1.0 - (double)p.blur.intensity * (1.0 - p.values[SLOT_NOISY][texel]);
            double want = pow(fmin(1.0, fmax(0.0, scaled)), (double)p.blur.power);
            if (!(fabs(p.values[SLOT_AO][texel] - want) < 1e-5))
                fail_msg("intensity %g, power %g: %g becomes %g, want %g", (double)p.blur.intensity,
                         (double)p.blur.power, p.values[SLOT_NOISY][texel],
                         p.values[SLOT_AO][texel], want);
        }
        picture_free(&p);
    }
}

/* Nothing was cut off: the nearest half float below 1 is at most 2^-12 away, and above as often as
 * below. */
static void check_nearest(const char *what, const double *halves, const double *exact, size_t count)
{
    const struct difference d = difference_of(halves, exact, count);
    const double bias = mean_of(halves, count) - mean_of(exact, count);
    printf("    %-32s max %.2e  bias %.2e\n", what, d.max, bias);
    if (!(d.max <= 0x1p-12 * 1.01) || !(fabs(bias) <= 2e-5))
        fail_msg("%s: half floats are off by up to %g, in the mean by %g", what, d.max, bias);
}

/* Corners and open walls, their AO in images of this format. */
static void make_ao(struct picture *p, vkao_stage_flags stages, VkFormat format)
{
    const struct scene scene = scene_corner();
    picture_make(p, stages, &scene);
    picture_set(p, SLOT_AO, format, NULL);
}

static void ao_in_half_floats_is_the_nearest(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        vkao_stage_flags stages;
        bool half_resolution, bent;
    } rows[] = {
        {"SSAO", VKAO_STAGE_SSAO, false, false},
        {"blur", VKAO_STAGE_SSAO | VKAO_STAGE_BLUR, false, false},
        {"upsampled", VKAO_STAGE_SSAO | VKAO_STAGE_BLUR, true, false},
        {"with bent normals", VKAO_STAGE_SSAO | VKAO_STAGE_BLUR, false, true},
        {"upsampled, with bent normals", VKAO_STAGE_SSAO | VKAO_STAGE_BLUR, true, true},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; ++i) {
        struct picture p[2]; /* exact, then half floats */
        for (int k = 0; k < 2; ++k) {
            make_ao(&p[k], rows[i].stages, k ? VK_FORMAT_R16_SFLOAT : VK_FORMAT_R32_SFLOAT);
            p[k].half_resolution = rows[i].half_resolution;
            p[k].ssao.method = VKAO_SSAO_GTAO;
            if (rows[i].bent)
                picture_set(&p[k], SLOT_BENT, VK_FORMAT_R32G32B32A32_SFLOAT, NULL);
            picture_run(&p[k]);
        }
        check_nearest(rows[i].name, p[1].values[SLOT_AO], p[0].values[SLOT_AO],
                      picture_texels(&p[0]));
        picture_free(&p[0]);
        picture_free(&p[1]);
    }
}

/* The same of AO that nobody but the next stage sees: before the blur, and before COMPOSITE. */
static void ao_in_scratch_is_the_nearest(void **state)
{
    (void)state;
    struct picture own, scratch;
    const vkao_stage_flags both = VKAO_STAGE_SSAO | VKAO_STAGE_BLUR;
    make_ao(&own, both, VK_FORMAT_R32_SFLOAT);
    picture_set(&own, SLOT_NOISY, VK_FORMAT_R32_SFLOAT, NULL);
    make_ao(&scratch, both, VK_FORMAT_R32_SFLOAT);
    picture_set(&scratch, SLOT_BENT, VK_FORMAT_R32G32B32A32_SFLOAT, NULL);
    own.ssao.method = scratch.ssao.method = VKAO_SSAO_GTAO;
    picture_run(&own);
    picture_run(&scratch);
    /* What the blur keeps between its directions is rounded as well, with bent normals and
     * without. */
    const size_t count = picture_texels(&own);
    const double bias =
        mean_of(scratch.values[SLOT_AO], count) - mean_of(own.values[SLOT_AO], count);
    printf("    %-32s bias %.2e\n", "before the blur", bias);
    assert_true(fabs(bias) <= 2e-5);
    picture_free(&scratch);

    make_ao(&scratch, VKAO_STAGE_ALL, VK_FORMAT_R32_SFLOAT);
    scratch.formats[SLOT_AO] = own.formats[SLOT_NOISY] = VK_FORMAT_UNDEFINED;
    scratch.ssao.method = VKAO_SSAO_GTAO;
    scratch.composite.mode = VKAO_COMPOSITE_AO_ONLY;
    picture_set(&scratch, SLOT_OUTPUT, VK_FORMAT_R32G32B32A32_SFLOAT, NULL);
    picture_run(&scratch);
    picture_run(&own);
    for (size_t i = 0; i < count; ++i)
        scratch.values[SLOT_OUTPUT][i] = scratch.values[SLOT_OUTPUT][i * 4];
    check_nearest("before COMPOSITE", scratch.values[SLOT_OUTPUT], own.values[SLOT_AO], count);
    picture_free(&scratch);
    picture_free(&own);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        gpu_test(agrees_with_reference_for_every_parameter),
        gpu_test(texels_without_a_normal_count_by_depth),
        gpu_test(lone_texels_before_the_sky_agree_with_reference),
        gpu_test(agrees_with_reference_in_oblong_and_narrow_views),
        gpu_test(depth_edges_do_not_leak),
        gpu_test(normal_edges_do_not_leak),
        gpu_test(narrow_things_take_a_share_of_the_window),
        gpu_test(tilted_walls_are_blurred_in_one_piece),
        gpu_test(inner_edges_are_kept_without_normals),
        gpu_test(constants_are_kept),
        gpu_test(radius_0_copies),
        gpu_test(intensity_and_power_follow_the_formula),
        gpu_test(ao_in_half_floats_is_the_nearest),
        gpu_test(ao_in_scratch_is_the_nearest),
    };
    return fixture_run(tests);
}
