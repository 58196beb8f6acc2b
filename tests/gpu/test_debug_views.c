/* SPDX-License-Identifier: MIT
 *
 * Composite modes that show what the stages saw. */
#include "fixture.h"
#include "ref_normal.h"
#include "ref_upsample.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static void make(struct picture *p, bool half, bool normals, vkao_composite_mode mode)
{
    const struct scene scene = scene_open_sky();
    struct lens lens = lens_perspective(0.6, 0.45);
    picture_init(p, 79, 59, VKAO_STAGE_ALL);
    p->half_resolution = half;
    p->view.normal_encoding = normals ? VKAO_NORMALS_OCT_SNORM : VKAO_NORMALS_FROM_DEPTH;
    p->view.depth_encoding = VKAO_DEPTH_VIEW_Z;
    picture_render_scene(p, &scene, &lens, VK_FORMAT_R32_SFLOAT,
                         normals ? VK_FORMAT_R32G32B32A32_SFLOAT : VK_FORMAT_UNDEFINED);
    picture_set(p, SLOT_AO, VK_FORMAT_R32_SFLOAT, NULL);
    picture_set(p, SLOT_OUTPUT, VK_FORMAT_R32G32B32A32_SFLOAT, NULL);
    p->composite.mode = mode;
    p->composite.debug_distance = 5.0f;
}

/* At half resolution four texels show the one that the stages had. */
static void view_z_and_normals_are_those_of_the_grid(void **state)
{
    (void)state;
    for (int i = 0; i < 8; ++i) {
        struct picture p;
        struct ref_scene full, half;
        double *stored = NULL;
        bool is_half = i & 1, show_normals = i & 2;
        make(&p, is_half, i & 4, show_normals ? VKAO_COMPOSITE_NORMALS : VKAO_COMPOSITE_VIEW_Z);
        p.ssao.method = VKAO_SSAO_GTAO; /* vbao leaves a thickness in the last bits of view z */
        double *want = test_alloc(picture_texels(&p) * 4, sizeof *want);
        picture_reference_scene(&p, &full);
        ref_scene_half(&full, &p.view, p.values[SLOT_NORMALS], &half, &stored);
        for (size_t t = 0; t < picture_texels(&p); ++t) {
            size_t x = t % p.width, y = t / p.width;
            size_t at = is_half ? y / 2 * half.width + x / 2 : t;
            double z = is_half ? half.z[at] : full.z[at];
            const double *n = is_half ? &half.normals[at * 3] : &full.normals[at * 3];
            for (size_t c = 0; c < 3; ++c) {
                double shown = isnan(z) ? 0.0 : z / 5.0;
                if (show_normals)
                    shown = isnan(z) ? 0.5 : (c == 2 ? -n[c] : n[c]) * 0.5 + 0.5;
                want[t * 4 + c] = shown;
            }
            want[t * 4 + 3] = 1.0;
        }
        picture_run(&p);
        check_close(show_normals ? "normals" : "view z", p.values[SLOT_OUTPUT], want,
                    picture_texels(&p) * 4, 1e-6, 1e-5, 1e-5);
        ref_scene_free(&full);
        ref_scene_free(&half);
        free(stored);
        free(want);
        picture_free(&p);
    }
}

static void noisy_ao_is_what_the_blur_read(void **state)
{
    (void)state;
    struct picture p, ssao;
    make(&p, false, true, VKAO_COMPOSITE_NOISY_AO);
    make(&ssao, false, true, VKAO_COMPOSITE_MULTIPLY);
    ssao.stages = VKAO_STAGE_SSAO;
    picture_set(&p, SLOT_NOISY, VK_FORMAT_R32_SFLOAT, NULL);
    picture_run(&p);
    picture_run(&ssao);
    for (size_t t = 0; t < picture_texels(&p) * 4; ++t)
        assert_true(p.values[SLOT_OUTPUT][t] == (t % 4 == 3 ? 1.0 : ssao.values[SLOT_AO][t / 4]));
    picture_free(&p);
    picture_free(&ssao);
}

/* Where nobody else sees it, it is a code of .01: what is shown is off by half of that. */
static void noisy_ao_in_scratch_is_what_its_code_says(void **state)
{
    (void)state;
    const struct scene corner = scene_corner();
    const struct lens lens = lens_perspective(0.6, 0.45);
    struct picture p, ssao;
    make(&p, false, true, VKAO_COMPOSITE_NOISY_AO);
    make(&ssao, false, true, VKAO_COMPOSITE_MULTIPLY);
    ssao.stages = VKAO_STAGE_SSAO;
    picture_render_scene(&p, &corner, &lens, VK_FORMAT_R32_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT);
    picture_render_scene(&ssao, &corner, &lens, VK_FORMAT_R32_SFLOAT,
                         VK_FORMAT_R32G32B32A32_SFLOAT);
    picture_run(&p);
    picture_run(&ssao);
    size_t dark = 0;
    for (size_t t = 0; t < picture_texels(&p) * 4; ++t) {
        const double want = t % 4 == 3 ? 1.0 : ssao.values[SLOT_AO][t / 4];
        dark += want < 0.9;
        if (!(fabs(p.values[SLOT_OUTPUT][t] - want) <= 0.005 + 1e-6))
            fail_msg("texel %zu is %.9g, want %.9g", t / 4, p.values[SLOT_OUTPUT][t], want);
    }
    assert_true(dark > 100);
    picture_free(&p);
    picture_free(&ssao);
}

static void bent_normals_are_the_image(void **state)
{
    (void)state;
    for (int i = 0; i < 2; ++i) {
        struct picture p;
        make(&p, i, true, VKAO_COMPOSITE_BENT_NORMALS);
        p.view.bent_encoding = VKAO_NORMALS_OCT_SNORM;
        picture_set(&p, SLOT_BENT, VK_FORMAT_R32G32B32A32_SFLOAT, NULL);
        picture_run(&p);
        for (size_t t = 0; t < picture_texels(&p); ++t) {
            /* Also on background, where octahedral codes are those of (0, 0, 1). The lens is
             * right-handed: +z is towards the eye there. */
            double n[3];
            ref_normal_decode(VKAO_NORMALS_OCT_SNORM, &p.values[SLOT_BENT][t * 4], n);
            if (!isfinite(p.values[SLOT_DEPTH][t]))
                assert_true(n[2] > 0.9999);
            for (size_t c = 0; c < 3; ++c)
                if (!(fabs(p.values[SLOT_OUTPUT][t * 4 + c] - (n[c] * 0.5 + 0.5)) < 1e-5))
                    fail_msg("half %d: texel %zu is %g, want %g", i, t,
                             p.values[SLOT_OUTPUT][t * 4 + c], n[c] * 0.5 + 0.5);
        }
        picture_free(&p);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        gpu_test(view_z_and_normals_are_those_of_the_grid),
        gpu_test(noisy_ao_is_what_the_blur_read),
        gpu_test(noisy_ao_in_scratch_is_what_its_code_says),
        gpu_test(bent_normals_are_the_image),
    };
    return fixture_run(tests);
}
