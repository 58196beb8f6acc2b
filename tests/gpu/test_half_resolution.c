/* SPDX-License-Identifier: MIT
 *
 * SSAO and BLUR on every second texel, and the upsampling that ends them. */
#include "fixture.h"
#include "ref_blur.h"
#include "ref_methods.h"
#include "ref_normal.h"
#include "ref_upsample.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double degrees = 57.29577951308232;

static void make(struct picture *p, uint32_t width, uint32_t height, const struct scene *scene,
                 const struct lens *lens, bool normals)
{
    picture_init(p, width, height, VKAO_STAGE_SSAO | VKAO_STAGE_BLUR);
    p->half_resolution = true;
    p->view.depth_encoding = VKAO_DEPTH_VIEW_Z;
    p->view.normal_encoding = normals ? VKAO_NORMALS_XYZ_SNORM : VKAO_NORMALS_FROM_DEPTH;
    picture_render_scene(p, scene, lens, VK_FORMAT_R32_SFLOAT,
                         normals ? VK_FORMAT_R32G32B32A32_SFLOAT : VK_FORMAT_UNDEFINED);
    picture_set(p, SLOT_AO, VK_FORMAT_R32_SFLOAT, NULL);
}

/* GTAO on every second texel, blurred, brought back and finished; 4 a texel: mean direction and
 * visibility. */
static void reference(const struct picture *p, double *out)
{
    struct ref_scene full, half;
    double *stored;
    picture_reference_scene(p, &full);
    ref_scene_half(&full, &p->view, p->values[SLOT_NORMALS], &half, &stored);
    size_t texels = (size_t)half.width * half.height;
    double *ao = test_alloc(texels, sizeof *ao), *bent = test_alloc(texels * 3, sizeof *bent);
    double *channel = test_alloc(texels, sizeof *channel),
           *blurred = test_alloc(texels, sizeof *blurred);
    double *result = test_alloc(picture_texels(p), sizeof *result);
    ref_gtao_bent(&half, &p->ssao, ao, bent);
    double bias = (double)p->ssao.bias * (double)p->ssao.radius;
    for (size_t c = 0; c < 4; ++c) {
        for (size_t i = 0; i < texels; ++i)
            channel[i] = c == 3 ? ao[i] : bent[i * 3 + c];
        ref_blur_channel(&half, &p->blur, p->view.normal_encoding, stored, channel, bias, c == 3,
                         blurred);
        ref_upsample(&full, &half, &p->blur, p->view.normal_encoding, p->values[SLOT_NORMALS],
                     c == 3 ? 1.0 : 0.0, blurred, result);
        for (size_t i = 0; i < picture_texels(p); ++i)
            out[i * 4 + c] = c == 3 ? ref_blur_finish(&p->blur, result[i]) : result[i];
    }
    ref_scene_free(&full);
    ref_scene_free(&half);
    free(stored);
    free(ao);
    free(bent);
    free(channel);
    free(blurred);
    free(result);
}

static void check_against_reference(struct picture *p, const char *what)
{
    size_t texels = picture_texels(p);
    double *want = test_alloc(texels * 4, sizeof *want), *ao = test_alloc(texels, sizeof *ao);
    double *angles = test_alloc(texels, sizeof *angles), *zeros = test_alloc(texels, sizeof *zeros);
    picture_run(p);
    reference(p, want);
    for (size_t i = 0; i < texels; ++i) {
        double got[3];
        ao[i] = want[i * 4 + 3];
        double length = sqrt(ref_dot(&want[i * 4], &want[i * 4]));
        bool known = p->formats[SLOT_BENT] && isfinite(p->values[SLOT_DEPTH][i]);
        if (known && length > 0.0) {
            assert_true(
                ref_normal_decode(VKAO_NORMALS_XYZ_SNORM, &p->values[SLOT_BENT][i * 4], got));
            got[2] = -got[2];
            angles[i] = acos(fmin(1.0, ref_dot(got, &want[i * 4]) / length)) * degrees;
        } else if (p->formats[SLOT_BENT] && !known) {
            const double *zero = &p->values[SLOT_BENT][i * 4];
            assert_true(zero[0] == 0.0 && zero[1] == 0.0 && zero[2] == 0.0);
            assert_true(p->values[SLOT_AO][i] == 1.0);
        }
    }
    /* 11 bits in between, three times, see test_blur.c; intensity and power make more of it. */
    double scale = (double)p->blur.intensity * (double)p->blur.power;
    /* Half a step of the byte that noisy AO is in buffers, where no rows are left to average. */
    double p99 = p->height == 1 ? 5e-3 : 3e-3;
    check_close(what, p->values[SLOT_AO], ao, texels, 8e-4 * scale, p99 * scale, 0.03 * scale);
    if (p->formats[SLOT_BENT])
        check_close("    its bent normals, degrees", angles, zeros, texels, 0.1, 0.5, 2.0);
    free(want);
    free(ao);
    free(angles);
    free(zeros);
}

/* Odd sizes too: a texel that nobody writes still holds the canary, which is not what the reference
 * has. */
static void agrees_with_the_reference_at_every_size(void **state)
{
    (void)state;
    static const struct {
        uint32_t width, height, radius;
        bool orthographic, normals, bent;
        float intensity, power;
    } rows[] = {
        {80, 60, 4, false, true, false, 1.0f, 1.0f},  {79, 59, 3, false, true, true, 1.0f, 1.0f},
        {65, 47, 4, false, false, false, 1.0f, 1.0f}, {48, 33, 2, true, true, true, 1.0f, 1.0f},
        {33, 48, 0, true, false, true, 1.0f, 1.0f},   {79, 59, 3, false, true, false, 1.5f, 2.5f},
        {1, 1, 4, false, true, false, 1.0f, 1.0f},    {2, 3, 4, false, true, true, 1.0f, 1.0f},
        {3, 2, 4, false, true, true, 1.0f, 1.0f},     {80, 1, 4, false, true, false, 1.0f, 1.0f},
    };
    const struct scene scenes[] = {scene_corner(), scene_open_sky(), scene_steps()};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0] * 3; ++i) {
        const size_t r = i / 3;
        struct picture p;
        char what[80];
        struct lens lens =
            rows[r].orthographic ? lens_orthographic(1.6, 1.2) : lens_perspective(0.6, 0.45);
        make(&p, rows[r].width, rows[r].height, &scenes[i % 3], &lens, rows[r].normals);
        p.ssao.method = VKAO_SSAO_GTAO;
        p.ssao.radius = 0.8f;
        p.blur.radius = rows[r].radius;
        p.blur.intensity = rows[r].intensity;
        p.blur.power = rows[r].power;
        if (rows[r].bent)
            picture_set(&p, SLOT_BENT, VK_FORMAT_R32G32B32A32_SFLOAT, NULL);
        p.view.bent_encoding = VKAO_NORMALS_XYZ_SNORM;
        snprintf(what, sizeof what, "%ux%u, scene %zu", rows[r].width, rows[r].height, i % 3);
        check_against_reference(&p, what);
        picture_free(&p);
    }
}

/* With normals in the blur and on the way back, some of them missing; of a parallel view less wide
 * than things are far, whose texels are not square. */
static void agrees_with_the_reference_with_normals_in_the_blur(void **state)
{
    (void)state;
    static const struct {
        uint32_t radius;
        bool orthographic, bent;
        float normal_power;
    } rows[] = {{4, false, true, 8.0f}, {3, true, false, 8.0f}, {3, true, true, 0.0f}};
    const struct scene scenes[] = {scene_corner(), scene_open_sky()};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0] * 2; ++i) {
        const size_t r = i / 2;
        const struct lens lens =
            rows[r].orthographic ? lens_orthographic(0.4, 1.2) : lens_perspective(0.6, 0.45);
        struct picture p;
        char what[80];
        make(&p, 79, 59, &scenes[i % 2], &lens, true);
        for (size_t t = 0; t < picture_texels(&p); ++t)
            for (size_t c = 0; c < 4 && (t % p.width + 3 * (t / p.width)) % 7 == 0; ++c)
                p.values[SLOT_NORMALS][t * 4 + c] = 0.0;
        p.ssao.method = VKAO_SSAO_GTAO;
        p.ssao.radius = 0.8f;
        p.blur.radius = rows[r].radius;
        p.blur.normal_power = rows[r].normal_power;
        p.blur.sharpness = rows[r].orthographic ? 20.0f : p.blur.sharpness;
        if (rows[r].bent)
            picture_set(&p, SLOT_BENT, VK_FORMAT_R32G32B32A32_SFLOAT, NULL);
        p.view.bent_encoding = VKAO_NORMALS_XYZ_SNORM;
        snprintf(what, sizeof what, "row %zu, scene %zu", r, i % 2);
        check_against_reference(&p, what);
        picture_free(&p);
    }
}

/* The same depths, whatever they are encoded as: what differs is rounding, and by it a sample on
 * another texel here and there, whose texel the blur shares with its neighbours. */
static void every_depth_encoding_gives_the_same_ao(void **state)
{
    (void)state;
    const struct scene scene = scene_corner();
    const struct lens lens = lens_perspective(0.6, 0.45);
    struct picture p[VKAO_DEPTH_INVERSE_Z + 1];
    for (int i = 0; i <= VKAO_DEPTH_INVERSE_Z; ++i) {
        make(&p[i], 79, 59, &scene, &lens, true);
        p[i].view.depth_encoding = (vkao_depth_encoding)i;
        picture_render_scene(&p[i], &scene, &lens, VK_FORMAT_R32_SFLOAT,
                             VK_FORMAT_R32G32B32A32_SFLOAT);
        p[i].ssao.method = VKAO_SSAO_GTAO;
        p[i].ssao.radius = 0.8f;
        picture_run(&p[i]);
    }
    for (int i = 0; i <= VKAO_DEPTH_INVERSE_Z; ++i) {
        char what[80];
        snprintf(what, sizeof what, "depth encoding %d", i);
        check_close(what, p[i].values[SLOT_AO], p[VKAO_DEPTH_VIEW_Z].values[SLOT_AO],
                    picture_texels(&p[i]), 1e-4, 1e-3, 0.02);
    }
    for (int i = 0; i <= VKAO_DEPTH_INVERSE_Z; ++i)
        picture_free(&p[i]);
}

/* Any split, with odd borders too, and also at full resolution, adds up to the whole, bit for bit.
 * Each part runs in a frame of its own, so that none finds in scratch what another left there. */
static void split_rects_equal_the_whole(void **state)
{
    (void)state;
    static const VkRect2D parts[] = {
        {{0, 0}, {33, 59}}, {{33, 0}, {46, 17}}, {{33, 17}, {1, 42}}, {{34, 17}, {45, 42}}};
    const struct scene scene = scene_open_sky();
    struct lens lens = lens_perspective(0.6, 0.45);
    for (int i = 0; i < 4; ++i) {
        struct picture whole, split;
        for (int k = 0; k < 2; ++k) {
            struct picture *p = k ? &split : &whole;
            make(p, 79, 59, &scene, &lens, true);
            p->half_resolution = i & 1;
            p->ssao.method = i & 2 ? VKAO_SSAO_GTAO : VKAO_SSAO_VBAO;
            p->ssao.radius = 0.8f;
            picture_set(p, SLOT_BENT, VK_FORMAT_R32G32B32A32_SFLOAT, NULL);
        }
        picture_run(&whole);
        for (size_t part = 0; part < sizeof parts / sizeof parts[0]; ++part) {
            split.view.rect = parts[part];
            picture_run(&split); /* uploads what the parts before wrote */
        }
        check_equal(i & 1 ? "ao at half resolution" : "ao", split.values[SLOT_AO],
                    whole.values[SLOT_AO], picture_texels(&whole));
        check_equal(i & 1 ? "bent normals at half resolution" : "bent normals",
                    split.values[SLOT_BENT], whole.values[SLOT_BENT], picture_texels(&whole) * 4);
        picture_free(&whole);
        picture_free(&split);
    }
}

/* The same scene at both resolutions. */
static void half_resolution_looks_like_full_resolution(void **state)
{
    (void)state;
    static const struct {
        vkao_ssao_method method;
        double limit;
    } rows[] = {
        {VKAO_SSAO_SPHERE, 0.08}, {VKAO_SSAO_HEMISPHERE, 0.06}, {VKAO_SSAO_HBAO, 0.05},
        {VKAO_SSAO_GTAO, 0.05},   {VKAO_SSAO_VBAO, 0.05},       {VKAO_SSAO_RAYMARCH, 0.06},
    };
    const struct scene scene = scene_corner();
    struct lens lens = lens_perspective(0.6, 0.45);
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; ++i) {
        struct picture half, full;
        make(&half, 128, 96, &scene, &lens, true);
        make(&full, 128, 96, &scene, &lens, true);
        full.half_resolution = false;
        half.ssao.method = full.ssao.method = rows[i].method;
        half.ssao.sample_count = full.ssao.sample_count = 64;
        half.ssao.slice_count = full.ssao.slice_count = 4;
        picture_run(&half);
        picture_run(&full);
        double square = 0.0, texels = (double)picture_texels(&full);
        for (size_t t = 0; t < picture_texels(&full); ++t)
            square += pow(half.values[SLOT_AO][t] - full.values[SLOT_AO][t], 2.0) / texels;
        double mean = mean_of(half.values[SLOT_AO], picture_texels(&full)) -
                      mean_of(full.values[SLOT_AO], picture_texels(&full));
        print_message("    method %d: RMSE of half to full resolution %.4f, mean %+.4f\n",
                      (int)rows[i].method, sqrt(square), mean);
        assert_true(sqrt(square) < rows[i].limit);
        assert_true(fabs(mean) < 0.006);
        picture_free(&half);
        picture_free(&full);
    }
}

/* A wall with a deep groove far behind a slab: the slab, which nothing occludes, stays open to its
 * last texel, and so does the sky. Slabs begin at odd and even columns. */
static void depth_edges_do_not_leak(void **state)
{
    (void)state;
    for (int edge = 39; edge <= 42; ++edge) {
        struct picture p;
        const struct scene wall = scene_tilted_plane(0.0, 0.0);
        struct lens lens = lens_perspective(0.6, 0.45);
        size_t dark = 0;
        make(&p, 80, 60, &wall, &lens, false);
        for (size_t i = 0; i < picture_texels(&p); ++i) {
            int x = (int)(i % p.width);
            /* comb: at z = 4 and 4.3 by turns of four columns */
            p.values[SLOT_DEPTH][i] = x < edge ? (x / 4 % 2 ? 4.0 : 4.3) : 1.0;
        }
        picture_run(&p);
        for (size_t i = 0; i < picture_texels(&p); ++i) {
            dark += p.values[SLOT_AO][i] < 0.9;
            if ((int)(i % p.width) >= edge && !(p.values[SLOT_AO][i] > 0.999))
                fail_msg("slab from %d: texel %zu,%zu is %g", edge, i % p.width, i / p.width,
                         p.values[SLOT_AO][i]);
        }
        assert_true(dark > 200);
        picture_free(&p);
    }
}

/* AO is upsampled before intensity and power, which are not linear. */
static void intensity_and_power_come_last(void **state)
{
    (void)state;
    struct picture plain, strong;
    const struct scene scene = scene_corner();
    struct lens lens = lens_perspective(0.6, 0.45);
    make(&plain, 80, 60, &scene, &lens, true);
    make(&strong, 80, 60, &scene, &lens, true);
    strong.blur.intensity = 1.5f;
    strong.blur.power = 3.0f;
    picture_run(&plain);
    picture_run(&strong);
    for (size_t i = 0; i < picture_texels(&plain); ++i) {
        double v = plain.values[SLOT_AO][i];
        double want = ref_blur_finish(&strong.blur, v);
        if (v > 0.0 && !(fabs(strong.values[SLOT_AO][i] - want) < 1e-5))
            fail_msg("texel %zu is %g, want %g from %g", i, strong.values[SLOT_AO][i], want, v);
    }
    picture_free(&plain);
    picture_free(&strong);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        gpu_test(agrees_with_the_reference_at_every_size),
        gpu_test(agrees_with_the_reference_with_normals_in_the_blur),
        gpu_test(every_depth_encoding_gives_the_same_ao),
        gpu_test(split_rects_equal_the_whole),
        gpu_test(half_resolution_looks_like_full_resolution),
        gpu_test(depth_edges_do_not_leak),
        gpu_test(intensity_and_power_come_last),
    };
    return fixture_run(tests);
}
