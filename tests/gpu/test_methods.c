/* SPDX-License-Identifier: MIT
 *
 * HBAO, GTAO, VBAO and ray marching against their double-precision references. */
#include "ref_methods.h"
#include "ref_normal.h"
#include "ssao_checks.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

typedef void bent_reference(const struct ref_scene *scene, const struct ao_ssao *params, double *ao,
                            double *bent);

static const struct method {
    const char *name;
    vkao_ssao_method method;
    ssao_reference *reference;
    bent_reference *bent; /* NULL = has none */
    double bent_degrees;  /* mean deviation that single precision explains */
} methods[] = {
    {"hbao", VKAO_SSAO_HBAO, ref_hbao, NULL, 0.0},
    {"gtao", VKAO_SSAO_GTAO, ref_gtao, ref_gtao_bent, 0.1},
    {"vbao", VKAO_SSAO_VBAO, ref_vbao, ref_vbao_bent, 0.3},
    {"raymarch", VKAO_SSAO_RAYMARCH, ref_raymarch, ref_raymarch_bent, 0.1},
};
enum { METHODS = sizeof methods / sizeof methods[0] };

static struct ao_ssao params_of(const struct method *method)
{
    struct ao_ssao params = ao_ssao_default();
    params.method = method->method;
    params.slice_count = 2;
    params.step_count = 6;
    return params;
}

static void agrees_with_reference_for_every_count_falloff_and_noise(void **state)
{
    (void)state;
    static const struct {
        uint32_t slices, steps, samples, noise;
        vkao_falloff falloff;
        float radius, bias, thickness;
    } rows[] = {
        {1, 1, 1, 0, VKAO_FALLOFF_SMOOTH, 2.0f, 0.01f, 1.0f},
        {1, 8, 16, 0, VKAO_FALLOFF_SMOOTH, 0.5f, 0.01f, 1.0f},
        {1, 8, 16, 3, VKAO_FALLOFF_THRESHOLD, 0.5f, 0.01f, 0.3f},
        {3, 5, 7, 12345, VKAO_FALLOFF_SMOOTH, 0.4f, 0.0f, 1.0f},
        {2, 16, 33, 0xffffffffu, VKAO_FALLOFF_THRESHOLD, 1.5f, 0.1f, 8.0f},
        {4, 24, 64, 7, VKAO_FALLOFF_SMOOTH, 0.35f, 0.02f, 2.0f},
        {1, 9, 9, 1, VKAO_FALLOFF_THRESHOLD, 0.6f, 0.01f, 1.0f},
        {1, 10, 10, 2, VKAO_FALLOFF_SMOOTH, 0.7f, 0.01f, 1.0f},
        {2, 13, 13, 6, VKAO_FALLOFF_SMOOTH, 0.5f, 0.02f, 2.0f},
        {2, 70, 70, 5, VKAO_FALLOFF_SMOOTH, 0.8f, 0.01f, 1.0f}, /* not known when compiled */
    };
    const struct scene scene = scene_corner();
    for (size_t i = 0; i < METHODS * sizeof rows / sizeof rows[0]; ++i) {
        const struct method *m = &methods[i % METHODS];
        const size_t r = i / METHODS;
        struct picture p;
        char what[80];
        picture_make(&p, VKAO_STAGE_SSAO, &scene);
        p.ssao.method = m->method;
        p.ssao.slice_count = rows[r].slices;
        p.ssao.step_count = rows[r].steps;
        p.ssao.sample_count = rows[r].samples;
        p.ssao.noise_index = rows[r].noise;
        p.ssao.falloff = rows[r].falloff;
        p.ssao.radius = rows[r].radius;
        p.ssao.bias = rows[r].bias;
        p.ssao.thickness = rows[r].thickness;
        snprintf(what, sizeof what, "%s %ux%u, %u rays, falloff %d, R %g", m->name, rows[r].slices,
                 rows[r].steps, rows[r].samples, (int)rows[r].falloff, (double)rows[r].radius);
        check_ssao(&p, m->reference, what);
        picture_free(&p);
    }
}

/* What ends nowhere is only as thick as it is seen to be wide. Everything occludes, so that more
 * sector bounds round the other way than at smaller radii. */
static void vbao_agrees_with_its_reference_where_the_radius_exceeds_the_view(void **state)
{
    (void)state;
    const struct scene scene = scene_corner();
    struct picture p;
    struct ref_scene view;
    picture_make(&p, VKAO_STAGE_SSAO, &scene);
    p.ssao.method = VKAO_SSAO_VBAO;
    p.ssao.slice_count = 4;
    p.ssao.step_count = 24;
    p.ssao.radius = 6.0f;
    picture_run(&p);
    picture_reference_scene(&p, &view);
    double *want = test_alloc(picture_texels(&p), sizeof *want);
    ref_vbao(&view, &p.ssao, want);
    check_close("vbao, R 6", p.values[SLOT_AO], want, picture_texels(&p), 2e-3, 0.0125, 0.035);
    free(want);
    ref_scene_free(&view);
    picture_free(&p);
}

static void agrees_with_reference_for_every_normal_encoding(void **state)
{
    (void)state;
    for (int m = 0; m < METHODS; ++m) {
        const struct ao_ssao params = params_of(&methods[m]);
        check_every_normal_encoding(&params, methods[m].reference);
    }
}

static void agrees_with_reference_for_world_space_normals(void **state)
{
    (void)state;
    for (int m = 0; m < METHODS; ++m) {
        const struct ao_ssao params = params_of(&methods[m]);
        check_world_space_normals(&params, methods[m].reference);
    }
}

static void agrees_with_reference_for_every_projection(void **state)
{
    (void)state;
    for (int m = 0; m < METHODS; ++m) {
        const struct ao_ssao params = params_of(&methods[m]);
        check_every_projection(&params, methods[m].reference);
    }
}

static void bad_normals_are_replaced_or_turned(void **state)
{
    (void)state;
    for (int m = 0; m < METHODS; ++m) {
        const struct ao_ssao params = params_of(&methods[m]);
        check_bad_normals_are_replaced(&params, methods[m].reference);
    }
}

static void limits_give_numbers(void **state)
{
    (void)state;
    for (int m = 0; m < METHODS; ++m) {
        const struct ao_ssao params = params_of(&methods[m]);
        check_no_nan_at_the_limits(&params);
    }
}

static void check_bent(struct picture *p, const struct method *m, const char *what)
{
    struct ref_scene scene;
    size_t texels = picture_texels(p), seen = 0;
    double *ao = test_alloc(texels, sizeof *ao), *bent = test_alloc(texels * 3, sizeof *bent);
    double *angles = test_alloc(texels, sizeof *angles), *zeros = test_alloc(texels, sizeof *zeros);
    picture_run(p);
    picture_reference_scene(p, &scene);
    m->bent(&scene, &p->ssao, ao, bent);
    for (size_t i = 0; i < texels; ++i) {
        const double *want = &bent[i * 3];
        double got[3], length = sqrt(ref_dot(want, want));
        bool is = ref_normal_decode(p->view.bent_encoding, &p->values[SLOT_BENT][i * 4], got);
        assert_true(is == (length > 0.0)); /* zero where there is background */
        if (!is)
            continue;
        got[2] *= scene.view.forward;
        angles[i] = acos(fmin(1.0, ref_dot(got, want) / length)) * 57.29577951308232;
        ++seen;
    }
    assert_true(seen > texels / 8);
    check_close(what, angles, zeros, texels, m->bent_degrees, 20.0 * m->bent_degrees,
                50.0 * m->bent_degrees);
    ref_scene_free(&scene);
    free(ao);
    free(bent);
    free(angles);
    free(zeros);
}

/* With a blur of radius 0; both hands, and a scene with background. */
static void bent_normals_agree_with_the_reference(void **state)
{
    (void)state;
    for (int i = 0; i < METHODS * 2 * 2 * 2; ++i) {
        const struct method *m = &methods[i % METHODS];
        struct picture p;
        char what[80];
        bool sky = i / METHODS & 1, orthographic = i / METHODS & 2, left = i / METHODS & 4;
        const struct scene scene = sky ? scene_open_sky() : scene_corner();
        struct lens lens = orthographic ? lens_orthographic(1.6, 1.2) : lens_perspective(0.6, 0.45);
        if (!m->bent)
            continue;
        lens.forward = left ? 1.0 : -1.0;
        picture_make(&p, VKAO_STAGE_SSAO | VKAO_STAGE_BLUR, &scene);
        picture_render_scene(&p, &scene, &lens, VK_FORMAT_R32_SFLOAT,
                             VK_FORMAT_R32G32B32A32_SFLOAT);
        picture_set(&p, SLOT_BENT, VK_FORMAT_R32G32B32A32_SFLOAT, NULL);
        p.ssao = params_of(m);
        p.ssao.radius = 0.8f;
        p.blur.radius = 0;
        p.view.bent_encoding = VKAO_NORMALS_XYZ_SNORM;
        snprintf(what, sizeof what, "%s bent normals, degrees, case %d", m->name, i / METHODS);
        check_bent(&p, m, what);
        picture_free(&p);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        gpu_test(agrees_with_reference_for_every_count_falloff_and_noise),
        gpu_test(vbao_agrees_with_its_reference_where_the_radius_exceeds_the_view),
        gpu_test(agrees_with_reference_for_every_normal_encoding),
        gpu_test(agrees_with_reference_for_world_space_normals),
        gpu_test(agrees_with_reference_for_every_projection),
        gpu_test(bad_normals_are_replaced_or_turned),
        gpu_test(limits_give_numbers),
        gpu_test(bent_normals_agree_with_the_reference),
    };
    return fixture_run(tests);
}
