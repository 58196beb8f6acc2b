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
    {S(thickness), {0.0f, 1.0f, 8.0f}, {-FLT_MIN, 8.000001f, 9.0f}},
    {B(sharpness), {0.0f, 200.0f, 10000.0f}, {-1.0f, 10000.001f, 20000.0f}},
    {B(normal_power), {0.0f, 8.0f, 128.0f}, {-0.5f, 128.00002f, 1000.0f}},
    {B(intensity), {0.0f, 1.0f, 8.0f}, {-0.5f, 8.000001f, 9.0f}},
    {B(power), {FLT_MIN, 1.0f, 8.0f}, {0.0f, 8.000001f, -1.0f}},
    {C(strength), {0.0f, 0.5f, 1.0f}, {-0.25f, 1.0000001f, 2.0f}},
    {C(tint[0]), {0.0f, 0.5f, 1.0f}, {-0.25f, 1.0000001f, 2.0f}},
    {C(tint[1]), {0.0f, 0.5f, 1.0f}, {-0.25f, 1.0000001f, 2.0f}},
    {C(tint[2]), {0.0f, 0.5f, 1.0f}, {-0.25f, 1.0000001f, 2.0f}},
    {C(debug_distance), {0.0f, FLT_MIN, FLT_MAX}, {-FLT_MIN, -1.0f, -100.0f}},
};

static const struct {
    enum stage stage;
    const char *name;
    size_t offset;
    uint32_t min, max;
} integers[] = {
    {S(method), 0, VKAO_SSAO_RAYMARCH},
    {S(falloff), 0, VKAO_FALLOFF_THRESHOLD},
    {S(sphere_form), 0, VKAO_SPHERE_LITERAL},
    {S(sample_count), 1, 1024},
    {S(noise_index), 0, UINT32_MAX},
    {S(slice_count), 0, 64},
    {S(step_count), 0, 256},
    {S(reserved), 0, 0},
    {SSAO, "ssao.reserved", offsetof(vkao_ssao_params, reserved_too), 0, 0},
    {B(radius), 0, 16},
    {B(reserved), 0, 0},
    {C(mode), 0, VKAO_COMPOSITE_VIEW_Z},
    {C(multi_bounce), 0, 1},
    {C(specular), 0, VKAO_SPECULAR_FROM_BENT},
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
    for (size_t i = 0; i < COUNT(integers); ++i) {
        struct world w;
        world_open(&w);
        /* The last kind of specular occlusion wants bent normals, the first methods have none. */
        if (integers[i].stage == COMPOSITE)
            world_use_bent_normals(&w);
        assert_int_equal(vkao_frame_create(w.ctx, &w.frame_info, &w.frame), VKAO_SUCCESS);
        unsigned char *at = params_of(&w, integers[i].stage) + integers[i].offset;
        for (uint32_t k = 0; k < 2; ++k) {
            const uint32_t v = k ? integers[i].max : integers[i].min;
            fake_forget_calls(&w.fake);
            memcpy(at, &v, sizeof v);
            expect_both_accept(&w, integers[i].stage, integers[i].name);
        }
        world_close(&w);
    }
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

enum { COLOR = 4, DIRECT = 5, NORMALS = 1, BENT = SLOT_BENT_NORMALS, ALBEDO = 8, SPECULAR = 9 };

/* Slots that a composite needs, one row each; everything else may be absent. */
static const struct {
    vkao_composite_mode mode;
    vkao_specular specular;
    VkBool32 multi_bounce;
    uint32_t needs; /* bits of slots */
} composites[] = {
    {VKAO_COMPOSITE_MULTIPLY, VKAO_SPECULAR_NONE, VK_FALSE, 1u << COLOR},
    {VKAO_COMPOSITE_INDIRECT, VKAO_SPECULAR_NONE, VK_FALSE, 1u << COLOR | 1u << DIRECT},
    {VKAO_COMPOSITE_AO_ONLY, VKAO_SPECULAR_NONE, VK_FALSE, 0},
    {VKAO_COMPOSITE_MULTIPLY, VKAO_SPECULAR_NONE, VK_TRUE, 1u << COLOR | 1u << ALBEDO},
    {VKAO_COMPOSITE_INDIRECT, VKAO_SPECULAR_NONE, VK_TRUE,
     1u << COLOR | 1u << DIRECT | 1u << ALBEDO},
    {VKAO_COMPOSITE_AO_ONLY, VKAO_SPECULAR_NONE, VK_TRUE, 1u << ALBEDO},
    {VKAO_COMPOSITE_MULTIPLY, VKAO_SPECULAR_FROM_AO, VK_FALSE,
     1u << COLOR | 1u << SPECULAR | 1u << NORMALS},
    {VKAO_COMPOSITE_INDIRECT, VKAO_SPECULAR_FROM_AO, VK_FALSE,
     1u << COLOR | 1u << DIRECT | 1u << SPECULAR | 1u << NORMALS},
    {VKAO_COMPOSITE_MULTIPLY, VKAO_SPECULAR_FROM_BENT, VK_FALSE,
     1u << COLOR | 1u << SPECULAR | 1u << NORMALS | 1u << BENT},
    {VKAO_COMPOSITE_INDIRECT, VKAO_SPECULAR_FROM_BENT, VK_TRUE,
     1u << COLOR | 1u << DIRECT | 1u << SPECULAR | 1u << NORMALS | 1u << BENT | 1u << ALBEDO},
    {VKAO_COMPOSITE_NORMALS, VKAO_SPECULAR_NONE, VK_FALSE, 0},
    {VKAO_COMPOSITE_BENT_NORMALS, VKAO_SPECULAR_NONE, VK_FALSE, 1u << BENT},
    {VKAO_COMPOSITE_VIEW_Z, VKAO_SPECULAR_NONE, VK_FALSE, 0},
};

static void composite_modes_need_their_images(void **state)
{
    (void)state;
    static const size_t slots[] = {COLOR, DIRECT, NORMALS, BENT, ALBEDO, SPECULAR};
    for (size_t i = 0; i < COUNT(composites) * (COUNT(slots) + 1); ++i) {
        const size_t row = i / (COUNT(slots) + 1), absent = i % (COUNT(slots) + 1);
        struct world w;
        world_open(&w);
        world_use_bent_normals(&w);
        w.composite.mode = composites[row].mode;
        w.composite.specular = composites[row].specular;
        w.composite.multi_bounce = composites[row].multi_bounce;
        bool needed = absent < COUNT(slots) && (composites[row].needs >> slots[absent] & 1u);
        if (absent < COUNT(slots))
            *world_slot(&w.images, slots[absent]) = (vkao_image){0};
        assert_int_equal(vkao_frame_create(w.ctx, &w.frame_info, &w.frame), VKAO_SUCCESS);
        if (needed)
            expect_both_refuse(&w, COMPOSITE, world_slot_names[slots[absent]], "composite.mode");
        else
            expect_both_accept(&w, COMPOSITE, "composite.mode");
        world_close(&w);
    }
}

/* The debug modes look at what SSAO left behind, one of them at what BLUR read. */
static void debug_modes_need_their_stages(void **state)
{
    (void)state;
    for (int mode = VKAO_COMPOSITE_NOISY_AO; mode <= VKAO_COMPOSITE_VIEW_Z; ++mode) {
        for (vkao_stage_flags stages = VKAO_STAGE_COMPOSITE; stages <= VKAO_STAGE_ALL; ++stages) {
            struct world w;
            world_open_frame(&w, stages);
            w.composite.mode = (vkao_composite_mode)mode;
            bool fits = stages & VKAO_STAGE_SSAO;
            if (mode == VKAO_COMPOSITE_NOISY_AO)
                fits = stages == VKAO_STAGE_ALL;
            if (mode == VKAO_COMPOSITE_BENT_NORMALS)
                fits = false; /* this frame has none */
            if (fits)
                expect_both_accept(&w, COMPOSITE, "composite.mode");
            else
                expect_both_refuse(&w, COMPOSITE, "composite.mode", "needs");
            world_close(&w);
        }
    }
    struct world w;
    world_open(&w);
    world_use_bent_normals(&w);
    assert_int_equal(vkao_frame_create(w.ctx, &w.frame_info, &w.frame), VKAO_SUCCESS);
    w.composite.mode = VKAO_COMPOSITE_NOISY_AO;
    expect_both_refuse(&w, COMPOSITE, "composite.mode", "without bent normals");
    world_close(&w);
    /* At half resolution the blur puts its result where the noise was. */
    world_open(&w);
    w.images.ao_noisy = (vkao_image){0};
    w.frame_info.half_resolution = VK_TRUE;
    assert_int_equal(vkao_frame_create(w.ctx, &w.frame_info, &w.frame), VKAO_SUCCESS);
    w.composite.mode = VKAO_COMPOSITE_NOISY_AO;
    expect_both_refuse(&w, COMPOSITE, "composite.mode", "");
    world_close(&w);
}

/* Sphere, hemisphere and hbao do not know where the light comes from. */
static void bent_normals_need_a_method_that_has_them(void **state)
{
    (void)state;
    struct world w;
    world_open(&w);
    world_use_bent_normals(&w);
    assert_int_equal(vkao_frame_create(w.ctx, &w.frame_info, &w.frame), VKAO_SUCCESS);
    for (int method = 0; method <= VKAO_SSAO_RAYMARCH; ++method) {
        w.ssao.method = (vkao_ssao_method)method;
        if (method >= VKAO_SSAO_GTAO)
            expect_both_accept(&w, SSAO, "ssao.method");
        else
            expect_both_refuse(&w, SSAO, "ssao.method", "bent normals");
    }
    world_close(&w);
}

/* Zero stands for the behaviour from before a field existed: the same commands as its default. */
static void zero_is_the_default_of_newer_fields(void **state)
{
    (void)state;
    struct world w;
    world_open_frame(&w, VKAO_STAGE_ALL);
    fake_forget_calls(&w.fake);
    assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
    const size_t count = w.fake.call_count;
    w.ssao.slice_count = w.ssao.step_count = 0;
    w.ssao.thickness = w.composite.debug_distance = 0.0f;
    assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
    assert_int_equal(w.fake.call_count, 2 * count);
    for (size_t i = 0; i < count; ++i)
        assert_memory_equal(w.fake.calls[i].push, w.fake.calls[count + i].push, FAKE_PUSH_BYTES);
    world_close(&w);
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
        cmocka_unit_test(debug_modes_need_their_stages),
        cmocka_unit_test(bent_normals_need_a_method_that_has_them),
        cmocka_unit_test(zero_is_the_default_of_newer_fields),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
