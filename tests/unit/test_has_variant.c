/* SPDX-License-Identifier: MIT
 *
 * vkao_context_has_variant: which members of the settings decide whether a pipeline serves them. */
#include "settings.h"

#include <stdio.h>
#include <string.h>

/* Values of one word. */
#define U(v)                                                                                       \
    {                                                                                              \
        .u = (v)                                                                                   \
    }
#define F(v)                                                                                       \
    {                                                                                              \
        .f = (v)                                                                                   \
    }
union word {
    uint32_t u;
    float f;
};

enum counts { FREE, COUNTS, IN_BUFFERS }; /* IN_BUFFERS: not for images */

/* A context that is compiled for `from` serves `to`, or does not. */
static const struct {
    vkao_ssao_method method;
    const char *name;
    size_t offset; /* in struct settings */
    union word from, to;
    enum counts counts;
} members[] = {
#define ROW(method, member, from, to, counts)                                                      \
    {                                                                                              \
        VKAO_SSAO_##method, #member, offsetof(struct settings, member), from, to, counts           \
    }
    ROW(GTAO, ssao.method, U(VKAO_SSAO_GTAO), U(VKAO_SSAO_HBAO), COUNTS),
    ROW(GTAO, ssao.falloff, U(0), U(VKAO_FALLOFF_THRESHOLD), COUNTS),
    ROW(SPHERE, ssao.sphere_form, U(0), U(VKAO_SPHERE_LITERAL), COUNTS),
    ROW(SPHERE, ssao.sample_count, U(16), U(32), COUNTS),
    ROW(HEMISPHERE, ssao.sample_count, U(16), U(17), COUNTS),
    ROW(HEMISPHERE, ssao.sample_count, U(65), U(1024), FREE), /* too many to unroll */
    ROW(GTAO, ssao.sample_count, U(16), U(17), FREE),
    ROW(GTAO, ssao.slice_count, U(3), U(4), COUNTS),
    ROW(HBAO, ssao.slice_count, U(3), U(4), COUNTS),
    ROW(VBAO, ssao.step_count, U(6), U(7), COUNTS),
    ROW(VBAO, ssao.step_count, U(0), U(8), FREE), /* the same */
    ROW(VBAO, ssao.step_count, U(22), U(23), COUNTS), /* of 3 slices: looped over, but constants */
    ROW(VBAO, ssao.step_count, U(65), U(200), FREE),
    ROW(GTAO, ssao.step_count, U(22), U(200), FREE),
    ROW(SPHERE, ssao.slice_count, U(3), U(4), FREE),
    ROW(HEMISPHERE, ssao.step_count, U(6), U(7), FREE),
    ROW(GTAO, ssao.radius, F(0.5f), F(2.0f), FREE),
    ROW(GTAO, ssao.bias, F(0.005f), F(0.0f), FREE),
    ROW(VBAO, ssao.thickness, F(1.0f), F(3.0f), FREE),
    ROW(GTAO, ssao.noise_index, U(0), U(7), FREE),
    ROW(SPHERE, ssao.blocking_scale, F(50.0f), F(1.0f), FREE),
    ROW(GTAO, blur.radius, U(3), U(4), IN_BUFFERS),
    ROW(GTAO, blur.sharpness, F(200.0f), F(0.0f), FREE),
    ROW(GTAO, blur.normal_power, F(0.0f), F(3.0f), COUNTS),
    ROW(GTAO, blur.normal_power, F(0.0f), F(8.0f), COUNTS),
    ROW(GTAO, blur.normal_power, F(8.0f), F(9.0f), COUNTS),
    ROW(GTAO, blur.normal_power, F(3.0f), F(9.0f), FREE),
    ROW(GTAO, blur.intensity, F(1.0f), F(1.5f), COUNTS),
    ROW(GTAO, blur.intensity, F(1.2f), F(1.5f), FREE),
    ROW(GTAO, blur.power, F(1.0f), F(2.0f), COUNTS),
    ROW(GTAO, blur.power, F(3.0f), F(2.0f), FREE),
    ROW(GTAO, variant.half_resolution, U(0), U(1), COUNTS),
    ROW(GTAO, variant.half_resolution, U(1), U(0), COUNTS),
    ROW(GTAO, variant.bent_normals, U(0), U(1), COUNTS),
    ROW(GTAO, variant.bent_normals, U(1), U(0), COUNTS),
    ROW(GTAO, view.depth_encoding, U(0), U(VKAO_DEPTH_DISTANCE), COUNTS),
    ROW(GTAO, view.normal_encoding, U(0), U(VKAO_NORMALS_OCT_SNORM), COUNTS),
    ROW(GTAO, view.normal_encoding, U(1), U(VKAO_NORMALS_XYZ_UNORM), COUNTS),
    ROW(GTAO, view.bent_encoding, U(0), U(VKAO_NORMALS_OCT_UNORM), COUNTS),
    ROW(GTAO, view.normal_to_view[0], F(1.0f), F(-1.0f), FREE),
    ROW(GTAO, view.normal_to_view[1], F(0.0f), F(0.1f), COUNTS),
    ROW(GTAO, view.normal_to_view[6], F(0.1f), F(0.0f), COUNTS),
    ROW(GTAO, view.projection[0], F(1.0f), F(1.7f), FREE),
    ROW(GTAO, view.projection[9], F(0.0f), F(0.1f), FREE),
    ROW(GTAO, view.projection[10], F(-1.01f), F(-1.1f), FREE),
#undef ROW
};

static void only_members_that_count_decide(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT(members) * 2; ++i) {
        const size_t m = i / 2;
        const bool cpu = i & 1;
        struct world w;
        struct settings s;
        settings_init(&w, &s, cpu);
        s.ssao.method = members[m].method;
        memcpy((char *)&s + members[m].offset, &members[m].from, sizeof members[m].from);
        settings_open(&w, &s.variant, 1, true);
        assert_int_equal(vkao_context_has_variant(w.ctx, &s.variant), VK_TRUE);
        memcpy((char *)&s + members[m].offset, &members[m].to, sizeof members[m].to);
        const bool serves = members[m].counts == FREE || (members[m].counts == IN_BUFFERS && !cpu);
        if (vkao_context_has_variant(w.ctx, &s.variant) != (serves ? VK_TRUE : VK_FALSE))
            fail_msg("%s, row %zu, %s: a change should %s", members[m].name, m,
                     cpu ? "buffers" : "images", serves ? "be free" : "count");
        assert_int_equal(w.log.lines, 0);
        world_close(&w);
    }
}

static void projections_count_by_their_kind(void **state)
{
    (void)state;
    struct world w;
    struct settings s;
    settings_init(&w, &s, false);
    settings_open(&w, &s.variant, 1, true);
    s.view.projection[10] = 0.01f; /* reversed: 1 is near */
    s.view.projection[14] = 0.101f;
    assert_int_equal(vkao_context_has_variant(w.ctx, &s.variant), VK_FALSE);
    s.view = w.view;
    s.view.projection[10] = -0.01f;
    s.view.projection[14] = -0.001f;
    s.view.projection[11] = 0.0f;
    s.view.projection[15] = 1.0f;
    assert_int_equal(vkao_context_has_variant(w.ctx, &s.variant), VK_FALSE);
    world_close(&w);
}

static void rectangles_are_free(void **state)
{
    (void)state;
    struct world w;
    struct settings s;
    settings_init(&w, &s, true);
    settings_open(&w, &s.variant, 1, true);
    s.view.viewport = (VkRect2D){{-20, 3}, {1000, 700}};
    s.view.valid = (VkRect2D){{10, 12}, {300, 200}};
    s.view.rect = (VkRect2D){{11, 13}, {3, 5}};
    assert_int_equal(vkao_context_has_variant(w.ctx, &s.variant), VK_TRUE);
    world_close(&w);
}

static void a_variant_without_blur_is_for_ssao_alone(void **state)
{
    (void)state;
    struct world w;
    struct settings s;
    settings_init(&w, &s, false);
    s.variant.blur = NULL;
    settings_open(&w, &s.variant, 1, true);
    assert_int_equal(vkao_context_has_variant(w.ctx, &s.variant), VK_TRUE);
    s.variant.blur = &s.blur;
    assert_int_equal(vkao_context_has_variant(w.ctx, &s.variant), VK_FALSE);
    world_close(&w);
}

static void null_is_no_variant(void **state)
{
    (void)state;
    struct world w;
    struct settings s;
    settings_init(&w, &s, false);
    settings_open(&w, &s.variant, 1, false);
    assert_int_equal(vkao_context_has_variant(NULL, &s.variant), VK_FALSE);
    assert_int_equal(vkao_context_has_variant(w.ctx, NULL), VK_FALSE);
    assert_int_equal(w.log.lines, 0);
    world_close(&w);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(only_members_that_count_decide),
        cmocka_unit_test(projections_count_by_their_kind),
        cmocka_unit_test(rectangles_are_free),
        cmocka_unit_test(a_variant_without_blur_is_for_ssao_alone),
        cmocka_unit_test(null_is_no_variant),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
