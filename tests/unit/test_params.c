/* SPDX-License-Identifier: MIT
 *
 * Ranges of every field of every params struct. A value out of range is refused by the stage's own
 * call and by vkao_cmd_all, with one line that names field and value, and nothing is recorded. */
#include "world.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum stage { SSAO, BLUR, COMPOSITE };

static unsigned char *params_of(struct world *w, enum stage stage)
{
    return stage == SSAO   ? (unsigned char *)&w->ssao
           : stage == BLUR ? (unsigned char *)&w->blur
                           : (unsigned char *)&w->composite;
}

static vkao_result record(struct world *w, enum stage stage)
{
    VkCommandBuffer cmd = world_cmd(w);
    return stage == SSAO   ? vkao_cmd_ssao(w->frame, cmd, &w->view, &w->ssao)
           : stage == BLUR ? vkao_cmd_blur(w->frame, cmd, &w->view, &w->blur)
                           : vkao_cmd_composite(w->frame, cmd, &w->view, &w->composite);
}

static void expect_both_refuse(struct world *w, enum stage stage, const char *name,
                               const char *value)
{
    fake_forget_calls(&w->fake);
    expect_refused(w, VKAO_ERROR_INVALID_ARGUMENT, record(w, stage), name, value);
    expect_refused(w, VKAO_ERROR_INVALID_ARGUMENT, world_record_all(w), name, value);
    expect_nothing_recorded(w);
}

static void expect_both_accept(struct world *w, enum stage stage, const char *name)
{
    if (record(w, stage) != VKAO_SUCCESS || world_record_all(w) != VKAO_SUCCESS)
        fail_msg("%s refused: %s", name, w->log.last_error);
    assert_int_equal(w->log.lines, 0);
}

#define S(field) SSAO, "ssao." #field, offsetof(vkao_ssao_params, field)
#define B(field) BLUR, "blur." #field, offsetof(vkao_blur_params, field)
#define C(field) COMPOSITE, "composite." #field, offsetof(vkao_composite_params, field)

static const struct {
    enum stage stage;
    const char *name;
    size_t offset;
    float in[3], out[3]; /* beside NaN and the infinities, which are always out */
} floats[] = {
    {S(radius), {FLT_MIN, 1.0f, FLT_MAX}, {0.0f, -0.0f, -1.0f}},
    {S(bias), {0.0f, 0.5f, 1.0f}, {-FLT_MIN, 1.0000001f, 7.0f}},
    {S(blocking_scale), {FLT_MIN, 50.0f, FLT_MAX}, {0.0f, -0.0f, -50.0f}},
    {B(sharpness), {0.0f, 200.0f, 10000.0f}, {-1.0f, 10000.001f, 20000.0f}},
    {B(normal_power), {0.0f, 8.0f, 128.0f}, {-0.5f, 128.00002f, 1000.0f}},
    {B(intensity), {0.0f, 1.0f, 8.0f}, {-0.5f, 8.000001f, 9.0f}},
    {B(power), {FLT_MIN, 1.0f, 8.0f}, {0.0f, 8.000001f, -1.0f}},
    {C(strength), {0.0f, 0.5f, 1.0f}, {-0.25f, 1.0000001f, 2.0f}},
    {C(tint[0]), {0.0f, 0.5f, 1.0f}, {-0.25f, 1.0000001f, 2.0f}},
    {C(tint[1]), {0.0f, 0.5f, 1.0f}, {-0.25f, 1.0000001f, 2.0f}},
    {C(tint[2]), {0.0f, 0.5f, 1.0f}, {-0.25f, 1.0000001f, 2.0f}},
};

static const struct {
    enum stage stage;
    const char *name;
    size_t offset;
    uint32_t min, max;
} integers[] = {
    {S(method), 0, VKAO_SSAO_HEMISPHERE},
    {S(falloff), 0, VKAO_FALLOFF_THRESHOLD},
    {S(sphere_form), 0, VKAO_SPHERE_LITERAL},
    {S(sample_count), 1, 64},
    {S(noise_index), 0, UINT32_MAX},
    {S(reserved), 0, 0},
    {B(radius), 0, 16},
    {B(reserved), 0, 0},
    {C(mode), 0, VKAO_COMPOSITE_AO_ONLY},
    {C(reserved), 0, 0},
};

static void float_out_of_range_is_refused_and_named(void **state)
{
    (void)state;
    struct world w;
    world_open_frame(&w, VKAO_STAGE_ALL);
    for (size_t i = 0; i < COUNT(floats); ++i) {
        unsigned char *at = params_of(&w, floats[i].stage) + floats[i].offset;
        const float odd[] = {NAN, INFINITY, -INFINITY};
        float was;
        memcpy(&was, at, sizeof was);
        for (size_t k = 0; k < 6; ++k) {
            const float v = k < 3 ? floats[i].out[k] : odd[k - 3];
            char value[64];
            snprintf(value, sizeof value, "is %g,", (double)v);
            memcpy(at, &v, sizeof v);
            expect_both_refuse(&w, floats[i].stage, floats[i].name, isnan(v) ? "nan" : value);
        }
        memcpy(at, &was, sizeof was);
    }
    world_close(&w);
}

static void float_in_range_is_accepted(void **state)
{
    (void)state;
    struct world w;
    world_open_frame(&w, VKAO_STAGE_ALL);
    for (size_t i = 0; i < COUNT(floats); ++i) {
        unsigned char *at = params_of(&w, floats[i].stage) + floats[i].offset;
        float was;
        memcpy(&was, at, sizeof was);
        for (size_t k = 0; k < 3; ++k) {
            fake_forget_calls(&w.fake);
            memcpy(at, &floats[i].in[k], sizeof was);
            expect_both_accept(&w, floats[i].stage, floats[i].name);
        }
        memcpy(at, &was, sizeof was);
    }
    world_close(&w);
}

static void integer_out_of_range_is_refused_and_named(void **state)
{
    (void)state;
    struct world w;
    world_open_frame(&w, VKAO_STAGE_ALL);
    for (size_t i = 0; i < COUNT(integers); ++i) {
        unsigned char *at = params_of(&w, integers[i].stage) + integers[i].offset;
        const uint32_t tries[] = {integers[i].min - 1u, integers[i].max + 1u, 0x7fffffffu,
                                  UINT32_MAX};
        uint32_t was;
        memcpy(&was, at, sizeof was);
        for (size_t k = 0; k < COUNT(tries); ++k) {
            if (tries[k] >= integers[i].min && tries[k] <= integers[i].max)
                continue;
            char value[32];
            snprintf(value, sizeof value, "is %u,", tries[k]);
            memcpy(at, &tries[k], sizeof was);
            expect_both_refuse(&w, integers[i].stage, integers[i].name, value);
        }
        memcpy(at, &was, sizeof was);
    }
    world_close(&w);
}

static void integer_in_range_is_accepted(void **state)
{
    (void)state;
    struct world w;
    world_open_frame(&w, VKAO_STAGE_ALL);
    for (size_t i = 0; i < COUNT(integers); ++i) {
        unsigned char *at = params_of(&w, integers[i].stage) + integers[i].offset;
        uint32_t was;
        memcpy(&was, at, sizeof was);
        for (uint32_t k = 0; k < 2; ++k) {
            const uint32_t v = k ? integers[i].max : integers[i].min;
            fake_forget_calls(&w.fake);
            memcpy(at, &v, sizeof v);
            expect_both_accept(&w, integers[i].stage, integers[i].name);
        }
        memcpy(at, &was, sizeof was);
    }
    world_close(&w);
}

/* Each struct, less its size, consists of four-byte fields: none may be missing above. */
static void every_field_is_in_the_tables(void **state)
{
    (void)state;
    static const size_t sizes[] = {
        [SSAO] = sizeof(vkao_ssao_params),
        [BLUR] = sizeof(vkao_blur_params),
        [COMPOSITE] = sizeof(vkao_composite_params),
    };
    for (size_t stage = 0; stage < COUNT(sizes); ++stage) {
        size_t fields = 1;
        for (size_t i = 0; i < COUNT(floats); ++i)
            fields += (size_t)floats[i].stage == stage;
        for (size_t i = 0; i < COUNT(integers); ++i)
            fields += (size_t)integers[i].stage == stage;
        assert_int_equal(fields * 4, sizes[stage]);
    }
}

static void composite_modes_need_their_images(void **state)
{
    (void)state;
    static const struct {
        bool color, direct;
        const char *missing[3]; /* by vkao_composite_mode; NULL = accepted */
    } cases[] = {
        {true, true, {NULL, NULL, NULL}},
        {true, false, {NULL, "images.direct", NULL}},
        {false, true, {"images.color", "images.color", NULL}},
        {false, false, {"images.color", "images.color", NULL}},
    };
    for (size_t i = 0; i < COUNT(cases) * 3; ++i) {
        const size_t which = i / 3, mode = i % 3;
        struct world w;
        world_open(&w);
        if (!cases[which].color)
            w.images.color = (vkao_image){0};
        if (!cases[which].direct)
            w.images.direct = (vkao_image){0};
        assert_int_equal(vkao_frame_create(w.ctx, &w.frame_info, &w.frame), VKAO_SUCCESS);
        fake_forget_calls(&w.fake);
        w.composite.mode = (vkao_composite_mode)mode;
        if (cases[which].missing[mode])
            expect_both_refuse(&w, COMPOSITE, cases[which].missing[mode], "composite.mode");
        else
            expect_both_accept(&w, COMPOSITE, "composite.mode");
        world_close(&w);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(float_out_of_range_is_refused_and_named),
        cmocka_unit_test(float_in_range_is_accepted),
        cmocka_unit_test(integer_out_of_range_is_refused_and_named),
        cmocka_unit_test(integer_in_range_is_accepted),
        cmocka_unit_test(every_field_is_in_the_tables),
        cmocka_unit_test(composite_modes_need_their_images),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
