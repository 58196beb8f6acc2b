/* SPDX-License-Identifier: MIT
 *
 * Sphere SSAO, rescaled and literal, against its double-precision reference. */
#include "ref_sphere.h"
#include "ssao_checks.h"

#include <stdio.h>

static struct ao_ssao sphere(vkao_sphere_form form)
{
    struct ao_ssao params = ao_ssao_default();
    params.method = VKAO_SSAO_SPHERE;
    params.sphere_form = form;
    params.blocking_scale = 10.0f;
    return params;
}

static void agrees_with_reference_for_every_form_count_falloff_and_noise(void **state)
{
    (void)state;
    static const struct {
        vkao_sphere_form form;
        uint32_t samples, noise;
        vkao_falloff falloff;
        float radius, blocking_scale;
    } rows[] = {
        {VKAO_SPHERE_RESCALED, 2, 0, VKAO_FALLOFF_SMOOTH, 0.5f, 50.0f},
        {VKAO_SPHERE_RESCALED, 16, 7, VKAO_FALLOFF_THRESHOLD, 0.5f, 50.0f},
        {VKAO_SPHERE_RESCALED, 31, 0, VKAO_FALLOFF_SMOOTH, 0.2f, 50.0f},
        {VKAO_SPHERE_RESCALED, 64, 0xffffffffu, VKAO_FALLOFF_SMOOTH, 1.5f, 50.0f},
        {VKAO_SPHERE_LITERAL, 1, 0, VKAO_FALLOFF_SMOOTH, 0.5f, 50.0f},
        {VKAO_SPHERE_LITERAL, 16, 9, VKAO_FALLOFF_SMOOTH, 0.5f, 50.0f},
        {VKAO_SPHERE_LITERAL, 49, 0, VKAO_FALLOFF_SMOOTH, 0.3f, 5.0f},
        {VKAO_SPHERE_LITERAL, 64, 0xffffffffu, VKAO_FALLOFF_SMOOTH, 1.5f, 1.0f},
    };
    const struct scene scene = scene_corner();
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; ++i) {
        struct picture p;
        char what[80];
        picture_make(&p, VKAO_STAGE_SSAO, &scene);
        p.ssao = sphere(rows[i].form);
        p.ssao.sample_count = rows[i].samples;
        p.ssao.noise_index = rows[i].noise;
        p.ssao.falloff = rows[i].falloff;
        p.ssao.radius = rows[i].radius;
        p.ssao.blocking_scale = rows[i].blocking_scale;
        snprintf(what, sizeof what, "form %d, %u samples, falloff %d, radius %g", (int)rows[i].form,
                 rows[i].samples, (int)rows[i].falloff, (double)rows[i].radius);
        check_ssao(&p, ref_sphere, what);
        picture_free(&p);
    }
}

static void agrees_with_reference_for_every_normal_encoding(void **state)
{
    (void)state;
    struct ao_ssao params = sphere(VKAO_SPHERE_RESCALED);
    check_every_normal_encoding(&params, ref_sphere);
}

static void agrees_with_reference_for_world_space_normals(void **state)
{
    (void)state;
    struct ao_ssao params = sphere(VKAO_SPHERE_RESCALED);
    check_world_space_normals(&params, ref_sphere);
}

static void agrees_with_reference_for_every_projection(void **state)
{
    (void)state;
    for (int form = 0; form < 2; ++form) {
        struct ao_ssao params = sphere((vkao_sphere_form)form);
        check_every_projection(&params, ref_sphere);
    }
}

static void bad_normals_are_replaced_or_turned(void **state)
{
    (void)state;
    struct ao_ssao params = sphere(VKAO_SPHERE_RESCALED);
    check_bad_normals_are_replaced(&params, ref_sphere);
}

static void limits_give_numbers(void **state)
{
    (void)state;
    for (int form = 0; form < 2; ++form) {
        struct ao_ssao params = sphere((vkao_sphere_form)form);
        check_no_nan_at_the_limits(&params);
    }
}

/* Runs both and compares bit for bit. */
static void check_same(const struct ao_ssao *a, const struct ao_ssao *b,
                       vkao_normal_encoding b_normals)
{
    struct picture p, q;
    const struct scene scene = scene_corner();
    picture_make(&p, VKAO_STAGE_SSAO, &scene);
    picture_make(&q, VKAO_STAGE_SSAO, &scene);
    p.ssao = *a;
    q.ssao = *b;
    q.view.normal_encoding = b_normals;
    picture_run(&p);
    picture_run(&q);
    check_equal("ao", p.values[SLOT_AO], q.values[SLOT_AO], picture_texels(&p));
    picture_free(&p);
    picture_free(&q);
}

static void rescaled_form_rounds_odd_counts_up(void **state)
{
    (void)state;
    struct ao_ssao odd = sphere(VKAO_SPHERE_RESCALED), even = odd;
    odd.sample_count = 15;
    even.sample_count = 16;
    check_same(&odd, &even, VKAO_NORMALS_XYZ_SNORM);
}

static void literal_form_ignores_falloff_bias_and_normals(void **state)
{
    (void)state;
    struct ao_ssao plain = sphere(VKAO_SPHERE_LITERAL), other = plain;
    other.falloff = VKAO_FALLOFF_THRESHOLD;
    other.bias = 0.5f;
    check_same(&plain, &other, VKAO_NORMALS_FROM_DEPTH);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        gpu_test(agrees_with_reference_for_every_form_count_falloff_and_noise),
        gpu_test(agrees_with_reference_for_every_normal_encoding),
        gpu_test(agrees_with_reference_for_world_space_normals),
        gpu_test(agrees_with_reference_for_every_projection),
        gpu_test(bad_normals_are_replaced_or_turned),
        gpu_test(limits_give_numbers),
        gpu_test(rescaled_form_rounds_odd_counts_up),
        gpu_test(literal_form_ignores_falloff_bias_and_normals),
    };
    return fixture_run(tests);
}
