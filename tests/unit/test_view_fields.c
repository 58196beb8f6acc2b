/* SPDX-License-Identifier: MIT
 *
 * Every field of vkao_view out of range, through every recording call: refused, named, nothing
 * recorded. */
#include "world.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static vkao_result record(struct world *w, int call)
{
    VkCommandBuffer cmd = world_cmd(w);
    static const vkao_stage_flags stages[] = {VKAO_STAGE_PREPARE, VKAO_STAGE_SSAO, VKAO_STAGE_BLUR,
                                              VKAO_STAGE_COMPOSITE};
    return call < 4 ? vkao_cmd_stage(w->frame, cmd, stages[call], &w->view, &w->params)
                    : world_record_all(w);
}

static void expect_all_refuse(struct world *w, const char *name, const char *value)
{
    fake_forget_calls(&w->fake);
    for (int call = 0; call < 5; ++call)
        expect_refused(w, VKAO_ERROR_INVALID_ARGUMENT, record(w, call), name, value);
    expect_nothing_recorded(w);
}

static void expect_all_accept(struct world *w, const char *name)
{
    fake_forget_calls(&w->fake);
    for (int call = 0; call < 5; ++call) {
        if (record(w, call) != VKAO_SUCCESS)
            fail_msg("%s refused: %s", name, w->log.last_error);
    }
}

#define V(field) "view." #field, offsetof(vkao_view, field)

static const struct {
    const char *name;
    size_t offset;
    uint32_t max;
} integers[] = {
    {V(axis), VKAO_VIEW_AXIS_POSITIVE_Z},
    {V(padding), 0},
};

/* The world's view, or an orthographic one, the only kind that may name an axis. */
static void set_view(struct world *w, bool orthographic)
{
    static const float matrix[16] = {
        [0] = 0.1f, [5] = 0.1f, [10] = -0.05f, [14] = -0.05f, [15] = 1.0f,
    };
    if (!orthographic)
        return;
    memcpy(w->view.projection, matrix, sizeof matrix);
    w->effect_info.projection = VKAO_PROJECTION_ORTHOGRAPHIC;
    world_create_frame(w);
}

static void integer_out_of_range_is_refused_and_named(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT(integers); ++i) {
        struct world w;
        world_open_frame(&w, VKAO_STAGE_ALL);
        set_view(&w, integers[i].offset == offsetof(vkao_view, axis));
        unsigned char *at = (unsigned char *)&w.view + integers[i].offset;
        const uint32_t tries[] = {integers[i].max + 1u, 0x7fffffffu};
        for (size_t k = 0; k < COUNT(tries); ++k) {
            char value[32];
            snprintf(value, sizeof value, "is %u,", tries[k]);
            memcpy(at, &tries[k], sizeof tries[k]);
            expect_all_refuse(&w, integers[i].name, value);
        }
        for (uint32_t v = 0; v <= integers[i].max; ++v) {
            memcpy(at, &v, sizeof v);
            expect_all_accept(&w, integers[i].name);
        }
        world_close(&w);
    }
}

static void not_finite_number_is_refused_and_named(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        size_t offset;
        size_t count;
    } arrays[] = {{V(projection), 16}, {V(normal_to_view), 9}};
    const float odd[] = {NAN, INFINITY, -INFINITY};
    struct world w;
    world_open_frame(&w, VKAO_STAGE_ALL);
    for (size_t a = 0; a < COUNT(arrays); ++a) {
        for (size_t i = 0; i < arrays[a].count * COUNT(odd); ++i) {
            unsigned char *at = (unsigned char *)&w.view + arrays[a].offset + i / 3 * sizeof(float);
            const float v = odd[i % 3];
            float was;
            char name[64], value[32];
            snprintf(name, sizeof name, "%s[%zu]", arrays[a].name, i / 3);
            snprintf(value, sizeof value, "%s", isnan(v) ? "nan" : v < 0.0f ? "-inf" : "inf");
            memcpy(&was, at, sizeof was);
            memcpy(at, &v, sizeof v);
            expect_all_refuse(&w, name, value);
            memcpy(at, &was, sizeof was);
        }
    }
    world_close(&w);
}

/* Rows for columns: what is 1 or -1 in w's factor of z lands in [14]. */
static void transposed_projection_is_refused(void **state)
{
    (void)state;
    struct world w;
    world_open_frame(&w, VKAO_STAGE_ALL);
    expect_all_accept(&w, "view.projection");
    float transposed[16];
    for (int i = 0; i < 16; ++i)
        transposed[i] = w.view.projection[i % 4 * 4 + i / 4];
    memcpy(w.view.projection, transposed, sizeof transposed);
    expect_all_refuse(&w, "view.projection", "transposed");
    /* Infinite and reversed, with a near plane at 1: both are 1 then. */
    static const float infinite[16] = {[0] = 1.0f, [5] = 1.0f, [11] = -1.0f, [14] = 1.0f},
                       across[16] = {[0] = 1.0f, [5] = 1.0f, [11] = 1.0f, [14] = -1.0f};
    memcpy(w.view.projection, infinite, sizeof infinite);
    expect_all_accept(&w, "view.projection");
    memcpy(w.view.projection, across, sizeof across);
    expect_all_refuse(&w, "view.projection", "transposed");
    world_close(&w);
}

/* minDepth and maxDepth of a viewport: z' = (max - min) z + min w. What leaves no depth from 0 to 1
 * in front of the eye is refused: one of the signs is wrong. */
static void depth_range_may_be_folded_into_the_projection(void **state)
{
    (void)state;
    static const float ranges[][2] = {{0.5f, 1.0f}, {0.7f, 1.0f}, {0.1f, 0.9f}, {0.0f, 0.3f},
                                      {1.0f, 0.5f}, {1.0f, 0.0f}, {0.0f, 0.5f}};
    /* [10] and [14] for near 0.1: far 100 or none, standard and reversed */
    static const float planes[][2] = {
        {-1.001001f, -0.1001001f}, {0.001001f, 0.1001001f}, {-1.0f, -0.1f}, {0.0f, 0.1f}};
    struct world w;
    world_open_frame(&w, VKAO_STAGE_ALL);
    for (size_t i = 0; i < COUNT(ranges) * COUNT(planes); ++i) {
        const float *plane = planes[i / COUNT(ranges)], *range = ranges[i % COUNT(ranges)];
        float *m = w.view.projection, size = range[1] - range[0];
        char name[80];
        snprintf(name, sizeof name, "[10] %g [14] %g in [%g,%g]", (double)plane[0],
                 (double)plane[1], (double)range[0], (double)range[1]);
        memset(m, 0, sizeof w.view.projection);
        m[0] = m[5] = 1.5f;
        m[11] = -1.0f;
        m[10] = size * plane[0] + range[0] * m[11];
        m[14] = size * plane[1];
        expect_all_accept(&w, name);
        /* Standard depth, or one above a least of 0, with w turned round. */
        m[11] = 1.0f;
        if (m[10] < 0.0f && m[14] < 0.0f)
            expect_all_refuse(&w, "view.projection", "behind the eye");
    }
    world_close(&w);
}

static void projection_that_is_none_is_refused(void **state)
{
    (void)state;
    static const struct {
        bool orthographic;
        int index;
        float v;
        const char *value; /* in the log beside view.projection */
    } cases[] = {
        {false, 1, 0.5f, "columns"},      {false, 2, 0.5f, "oblique"},
        {false, 3, 0.5f, "[3] is 0.5"},   {false, 4, 0.5f, "[4] is 0.5"},
        {false, 6, -0.5f, "[6] is -0.5"}, {false, 7, 0.5f, "[7] is 0.5"},
        {true, 1, 0.5f, "[1] is 0.5"},    {true, 4, 0.5f, "[4] is 0.5"},
        {true, 7, 0.5f, "[7] is 0.5"},    {false, 0, 0.0f, "[0] 0 "},
        {false, 5, 0.0f, "[5] 0 "},       {false, 11, 0.0f, "[11] 0 "},
        {false, 14, 0.0f, "[14] 0 "},     {false, 15, 1.0f, "[15] 1"},
        {true, 0, 0.0f, "[0] 0 "},        {true, 5, 0.0f, "[5] 0 "},
        {true, 10, 0.0f, "[10] 0 "},      {true, 15, 0.0f, "[15] 0"},
        {true, 11, 1.0f, "[11] 1 "},      {false, 12, 0.25f, "0.25"},
        {false, 13, 0.25f, "0.25"},       {true, 8, 0.25f, "0.25"},
        {true, 9, 0.25f, "0.25"},
    };
    for (size_t i = 0; i < COUNT(cases); ++i) {
        struct world w;
        world_open_frame(&w, VKAO_STAGE_ALL);
        set_view(&w, cases[i].orthographic);
        expect_all_accept(&w, "view.projection");
        w.view.projection[cases[i].index] = cases[i].v;
        expect_all_refuse(&w, "view.projection", cases[i].value);
        world_close(&w);
    }
}

static void default_view_wants_a_projection(void **state)
{
    (void)state;
    struct world w;
    world_open_frame(&w, VKAO_STAGE_ALL);
    w.view = vkao_view_default();
    expect_all_refuse(&w, "view.projection", "perspective");
    world_close(&w);
}

static void ambiguous_orthographic_view_wants_an_axis(void **state)
{
    (void)state;
    struct world w;
    world_open_frame(&w, VKAO_STAGE_ALL);
    set_view(&w, true);
    w.view.projection[14] = 0.5f; /* planes at -10 and 10 */
    expect_all_refuse(&w, "view.axis", "orthographic");
    w.view.axis = VKAO_VIEW_AXIS_NEGATIVE_Z;
    expect_all_accept(&w, "view.axis");
    world_close(&w);
}

static void rectangles_are_refused_and_named(void **state)
{
    (void)state;
    static const struct {
        VkRect2D valid, viewport, rect; /* in 100x60 */
        const char *name, *value;       /* NULL = accepted */
    } cases[] = {
        {{{0, 0}, {100, 60}}, {{0, 0}, {0, 0}}, {{0, 0}, {100, 60}}, NULL, NULL},
        {{{99, 59}, {1, 1}}, {{0, 0}, {0, 0}}, {{99, 59}, {1, 1}}, NULL, NULL},
        {{{0, 0}, {0, 0}}, {{-500, -500}, {5000, 5000}}, {{0, 0}, {0, 0}}, NULL, NULL},
        {{{0, 0}, {101, 60}}, {{0, 0}, {0, 0}}, {{0, 0}, {0, 0}}, "view.valid", "101x60"},
        {{{0, 0}, {100, 61}}, {{0, 0}, {0, 0}}, {{0, 0}, {0, 0}}, "view.valid", "100x61"},
        {{{1, 0}, {100, 60}}, {{0, 0}, {0, 0}}, {{0, 0}, {0, 0}}, "view.valid", "(1,0)"},
        {{{-1, 0}, {10, 10}}, {{0, 0}, {0, 0}}, {{0, 0}, {0, 0}}, "view.valid", "(-1,0)"},
        {{{0, -2}, {10, 10}}, {{0, 0}, {0, 0}}, {{0, 0}, {0, 0}}, "view.valid", "(0,-2)"},
        {{{0, 0}, {0, 10}}, {{0, 0}, {0, 0}}, {{0, 0}, {0, 0}}, "view.valid", "0x10"},
        {{{0, 0}, {10, 0}}, {{0, 0}, {0, 0}}, {{0, 0}, {0, 0}}, "view.valid", "10x0"},
        {{{INT32_MAX, 0}, {UINT32_MAX, 1}},
         {{0, 0}, {0, 0}},
         {{0, 0}, {0, 0}},
         "view.valid",
         "4294967295x1"},
        {{{2, 2}, {UINT32_MAX, UINT32_MAX}},
         {{0, 0}, {0, 0}},
         {{0, 0}, {0, 0}},
         "view.valid",
         "4294967295x4294967295"},
        {{{0, 0}, {0, 0}}, {{0, 0}, {0, 0}}, {{0, 0}, {101, 1}}, "view.rect", "101x1"},
        {{{10, 10}, {20, 20}}, {{0, 0}, {0, 0}}, {{9, 10}, {5, 5}}, "view.rect", "(9,10)"},
        {{{10, 10}, {20, 20}}, {{0, 0}, {0, 0}}, {{10, 10}, {20, 21}}, "view.rect", "20x21"},
        {{{10, 10}, {20, 20}}, {{0, 0}, {0, 0}}, {{30, 10}, {1, 1}}, "view.rect", "(30,10)"},
        {{{0, 0}, {0, 0}}, {{0, 0}, {0, 0}}, {{5, 5}, {0, 1}}, "view.rect", "0x1"},
        {{{0, 0}, {0, 0}},
         {{0, 0}, {0, 0}},
         {{5, 5}, {UINT32_MAX - 4, 1}},
         "view.rect",
         "4294967291x1"},
        {{{8, 4}, {0, 0}}, {{0, 0}, {0, 0}}, {{0, 0}, {0, 0}}, "view.valid", "0x0 at (8,4)"},
        {{{0, 0}, {0, 0}}, {{0, 0}, {0, 0}}, {{0, 7}, {0, 0}}, "view.rect", "0x0 at (0,7)"},
        {{{0, 0}, {0, 0}}, {{-9, 0}, {0, 0}}, {{0, 0}, {0, 0}}, "view.viewport", "0x0 at (-9,0)"},
        {{{0, 0}, {0, 0}}, {{0, 0}, {10, 0}}, {{0, 0}, {0, 0}}, "view.viewport", "10x0"},
        {{{0, 0}, {0, 0}}, {{0, 0}, {0, 10}}, {{0, 0}, {0, 0}}, "view.viewport", "0x10"},
        /* A data window may lie beside the display window. */
        {{{0, 0}, {0, 0}}, {{-10, 0}, {10, 60}}, {{0, 0}, {0, 0}}, NULL, NULL},
        {{{0, 0}, {0, 0}},
         {{0, 0}, {1, UINT32_MAX}},
         {{0, 0}, {0, 0}},
         "view.viewport",
         "1x4294967295"},
    };
    struct world w;
    world_open_frame(&w, VKAO_STAGE_ALL);
    for (size_t i = 0; i < COUNT(cases); ++i) {
        w.view.valid = cases[i].valid;
        w.view.viewport = cases[i].viewport;
        w.view.rect = cases[i].rect;
        if (cases[i].name)
            expect_all_refuse(&w, cases[i].name, cases[i].value);
        else
            expect_all_accept(&w, "rectangles");
    }
    world_close(&w);
}

static void axis_that_contradicts_the_matrix_is_refused(void **state)
{
    (void)state;
    struct world w;
    world_open_frame(&w, VKAO_STAGE_ALL); /* which looks along -z */
    w.view.axis = VKAO_VIEW_AXIS_NEGATIVE_Z;
    expect_all_accept(&w, "view.axis");
    w.view.axis = VKAO_VIEW_AXIS_POSITIVE_Z;
    expect_all_refuse(&w, "view.axis", "-z");
    world_close(&w);
}

/* No stage of such a frame reads depth, so a projection would be asked for in vain; the rest of the
 * view counts. */
static void composite_alone_needs_no_projection(void **state)
{
    (void)state;
    struct world w;
    world_open(&w);
    w.effect_info.stages = VKAO_STAGE_COMPOSITE;
    w.effect_info.noisy_ao = VK_FALSE;
    world_create_frame(&w);
    w.view = vkao_view_default();
    assert_int_equal(record(&w, 3), VKAO_SUCCESS);
    assert_int_equal(record(&w, 4), VKAO_SUCCESS);
    fake_forget_calls(&w.fake);
    w.view.rect = (VkRect2D){{0, 0}, {101, 60}};
    expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT, record(&w, 3), "view.rect", "101x60");
    w.view.rect = (VkRect2D){{0, 0}, {0, 0}};
    for (size_t i = 0; i < COUNT(integers); ++i) {
        const uint32_t wrong = integers[i].max + 1u, zero = 0;
        char value[32];
        snprintf(value, sizeof value, "is %u,", wrong);
        memcpy((unsigned char *)&w.view + integers[i].offset, &wrong, sizeof wrong);
        expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT, record(&w, 3), integers[i].name, value);
        expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT, record(&w, 4), integers[i].name, value);
        memcpy((unsigned char *)&w.view + integers[i].offset, &zero, sizeof zero);
    }
    expect_nothing_recorded(&w);
    world_close(&w);
}

/* Specular occlusion asks from where the eye looks. */
static void composite_with_specular_light_needs_a_projection(void **state)
{
    (void)state;
    struct world w;
    world_open(&w);
    w.effect_info.stages = VKAO_STAGE_COMPOSITE;
    w.effect_info.noisy_ao = VK_FALSE;
    w.effect_info.specular = VKAO_SPECULAR_FROM_AO;
    w.effect_info.normal_encoding = VKAO_NORMALS_XYZ_SNORM;
    world_create_frame(&w);
    assert_int_equal(record(&w, 3), VKAO_SUCCESS);
    w.view = vkao_view_default();
    fake_forget_calls(&w.fake);
    for (int call = 3; call < 5; ++call)
        expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT, record(&w, call), "view.projection", "");
    expect_nothing_recorded(&w);
    world_close(&w);
}

static void projection_of_the_other_kind_is_refused(void **state)
{
    (void)state;
    struct world w;
    world_open_frame(&w, VKAO_STAGE_ALL);
    w.effect_info.projection = VKAO_PROJECTION_ORTHOGRAPHIC;
    world_create_frame(&w);
    expect_all_refuse(&w, "view.projection", "effect.projection is ORTHOGRAPHIC");
    world_close(&w);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(integer_out_of_range_is_refused_and_named),
        cmocka_unit_test(not_finite_number_is_refused_and_named),
        cmocka_unit_test(transposed_projection_is_refused),
        cmocka_unit_test(depth_range_may_be_folded_into_the_projection),
        cmocka_unit_test(projection_that_is_none_is_refused),
        cmocka_unit_test(default_view_wants_a_projection),
        cmocka_unit_test(ambiguous_orthographic_view_wants_an_axis),
        cmocka_unit_test(rectangles_are_refused_and_named),
        cmocka_unit_test(axis_that_contradicts_the_matrix_is_refused),
        cmocka_unit_test(projection_of_the_other_kind_is_refused),
        cmocka_unit_test(composite_alone_needs_no_projection),
        cmocka_unit_test(composite_with_specular_light_needs_a_projection),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
