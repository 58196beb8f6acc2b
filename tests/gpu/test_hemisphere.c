/* SPDX-License-Identifier: MIT
 *
 * Hemisphere SSAO against its double-precision reference. */
#include "ref_hemisphere.h"
#include "ssao_checks.h"

#include <stdio.h>

static const struct ao_ssao *hemisphere(void)
{
    static struct ao_ssao params;
    params = ao_ssao_default();
    params.method = VKAO_SSAO_HEMISPHERE;
    return &params;
}

static void agrees_with_reference_for_every_count_falloff_and_noise(void **state)
{
    (void)state;
    static const struct {
        uint32_t samples, noise;
        vkao_falloff falloff;
        float radius, bias;
    } rows[] = {
        {1, 0, VKAO_FALLOFF_SMOOTH, 0.5f, 0.01f},
        {7, 3, VKAO_FALLOFF_THRESHOLD, 0.5f, 0.01f},
        {16, 0, VKAO_FALLOFF_SMOOTH, 0.5f, 0.0f},
        {16, 0, VKAO_FALLOFF_THRESHOLD, 0.2f, 0.1f},
        {33, 12345, VKAO_FALLOFF_SMOOTH, 0.3f, 0.02f},
        {64, 0xffffffffu, VKAO_FALLOFF_SMOOTH, 1.5f, 0.01f},
    };
    const struct scene scene = scene_corner();
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; ++i) {
        struct picture p;
        char what[80];
        picture_make(&p, VKAO_STAGE_SSAO, &scene);
        p.ssao = *hemisphere();
        p.ssao.sample_count = rows[i].samples;
        p.ssao.noise_index = rows[i].noise;
        p.ssao.falloff = rows[i].falloff;
        p.ssao.radius = rows[i].radius;
        p.ssao.bias = rows[i].bias;
        snprintf(what, sizeof what, "%u samples, falloff %d, radius %g", rows[i].samples,
                 (int)rows[i].falloff, (double)rows[i].radius);
        check_ssao(&p, ref_hemisphere, what);
        picture_free(&p);
    }
}

/* In a corridor with a radius beyond its nearest texels: points behind the eye are seen nowhere,
 * and hidden by nothing. */
static void points_behind_the_eye_are_open(void **state)
{
    (void)state;
    static const struct scene corridor = {{
        {SHAPE_PLANE, {0.0, 0.5, 0.0}, {0.0, -1.0, 0.0}},
        {SHAPE_PLANE, {0.0, -0.5, 0.0}, {0.0, 1.0, 0.0}},
        {SHAPE_PLANE, {0.0, 0.0, 4.0}, {0.0, 0.0, -1.0}},
    }};
    for (int falloff = 0; falloff < 2; ++falloff) {
        struct picture p;
        picture_make(&p, VKAO_STAGE_SSAO, &corridor);
        p.ssao = *hemisphere();
        p.ssao.sample_count = 64;
        p.ssao.falloff = (vkao_falloff)falloff;
        p.ssao.radius = 3.0f;
        check_ssao(&p, ref_hemisphere, falloff ? "threshold" : "smooth");
        picture_free(&p);
    }
}

static void agrees_with_reference_for_every_normal_encoding(void **state)
{
    (void)state;
    check_every_normal_encoding(hemisphere(), ref_hemisphere);
}

static void agrees_with_reference_for_world_space_normals(void **state)
{
    (void)state;
    check_world_space_normals(hemisphere(), ref_hemisphere);
}

static void agrees_with_reference_for_every_projection(void **state)
{
    (void)state;
    check_every_projection(hemisphere(), ref_hemisphere);
}

static void bad_normals_are_replaced_or_turned(void **state)
{
    (void)state;
    check_bad_normals_are_replaced(hemisphere(), ref_hemisphere);
}

static void limits_give_numbers(void **state)
{
    (void)state;
    check_no_nan_at_the_limits(hemisphere());
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        gpu_test(agrees_with_reference_for_every_count_falloff_and_noise),
        gpu_test(points_behind_the_eye_are_open),
        gpu_test(agrees_with_reference_for_every_normal_encoding),
        gpu_test(agrees_with_reference_for_world_space_normals),
        gpu_test(agrees_with_reference_for_every_projection),
        gpu_test(bad_normals_are_replaced_or_turned),
        gpu_test(limits_give_numbers),
    };
    return fixture_run(tests);
}
