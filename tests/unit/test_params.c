/* SPDX-License-Identifier: MIT
 *
 * Every member of vkao_effect_info and vkao_params at and beyond the ends of its range, by the
 * table that the header exports, and the ranges that the header's comments state. */
#include "world.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static vkao_result try_all(struct world *w)
{
    vkao_result result = world_try_frame(w);
    return result == VKAO_SUCCESS ? world_record_all(w) : result;
}

/* A world whose other settings suit any value of the parameter. */
static void open_world(struct world *w)
{
    world_open_frame(w, VKAO_STAGE_SSAO | VKAO_STAGE_BLUR);
    world_use_scratch_noise(w);
}

static void set_word(struct world *w, const vkao_parameter *p, size_t at, const void *word)
{
    char *structure = p->is_compiled ? (char *)&w->effect_info : (char *)&w->params;
    memcpy(structure + p->offset + at, word, 4);
}

static void expect_tried(const vkao_parameter *p, const void *word, bool fits, const char *value)
{
    struct world w;
    open_world(&w);
    /* depth_bits takes few of its range. */
    set_word(&w, p, 0, word);
    vkao_result result = try_all(&w);
    if (fits && result != VKAO_SUCCESS)
        fail_msg("%s %s refused: %s", p->name, value, w.log.last_error);
    if (!fits)
        expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT, result, p->name, value);
    world_close(&w);
}

static void check_float(const vkao_parameter *p)
{
    const float least = (float)p->least, most = (float)p->most;
    const struct {
        float v;
        bool fits;
    } tries[] = {
        {least, !p->above_least},
        {nextafterf(least, INFINITY), true},
        {nextafterf(least, -INFINITY), false},
        {most, true},
        {nextafterf(most, INFINITY), false},
        {NAN, false},
        {-INFINITY, false},
    };
    for (size_t i = 0; i < COUNT(tries); ++i) {
        char value[32];
        snprintf(value, sizeof value, "%g", (double)tries[i].v);
        expect_tried(p, &tries[i].v, tries[i].fits, value);
    }
}

/* Rules between members refuse some words that are in range. */
static bool depends_on_others(const vkao_parameter *p)
{
    static const char *const names[] = {"depth_bits",      "noisy_ao",   "bent_normals",
                                        "normal_encoding", "projection", "thickness_input",
                                        "second_layer"};
    for (size_t i = 0; i < COUNT(names); ++i) {
        if (strcmp(p->name, names[i]) == 0)
            return true;
    }
    return false;
}

static void check_word(const vkao_parameter *p)
{
    const uint32_t most = (uint32_t)p->most, beyond = most + 1u, huge = UINT32_MAX, zero = 0;
    char value[32];
    if (!depends_on_others(p)) {
        expect_tried(p, &most, true, "most");
        expect_tried(p, &zero, true, "0");
    }
    if (most == UINT32_MAX)
        return;
    snprintf(value, sizeof value, "is %u,", beyond);
    expect_tried(p, &beyond, false, value);
    snprintf(value, sizeof value, "is %u,", huge);
    expect_tried(p, &huge, false, value);
}

static void nobody_needs_to_count(void **state)
{
    (void)state;
    uint32_t count;
    assert_ptr_equal(vkao_parameters(NULL), vkao_parameters(&count));
    assert_ptr_equal(vkao_methods(NULL), vkao_methods(&count));
    vkao_add_required_features(NULL);
}

static void value_out_of_range_is_refused_and_named(void **state)
{
    (void)state;
    uint32_t count;
    const vkao_parameter *table = vkao_parameters(&count);
    assert_true(count >= 30);
    for (uint32_t i = 0; i < count; ++i) {
        if (table[i].type == VKAO_PARAMETER_FLOAT || table[i].type == VKAO_PARAMETER_COLOR)
            check_float(&table[i]);
        else
            check_word(&table[i]);
    }
}

static void every_channel_of_a_colour_is_checked(void **state)
{
    (void)state;
    static const char *const names[] = {"params.tint[0]", "params.tint[1]", "params.tint[2]"};
    for (int i = 0; i < 3; ++i) {
        struct world w;
        open_world(&w);
        w.params.tint[i] = 1.5f;
        expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT, try_all(&w), names[i], "1.5");
        world_close(&w);
    }
}

/* The header's comments, in other words. */
static void ranges_are_those_of_the_header(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double least, most, standard;
        VkBool32 above;
    } rows[] = {
        {"sample_count", 0, 1024, 16, 0},
        {"slice_count", 0, 64, 1, 0},
        {"step_count", 0, 256, 9, 0},
        {"blur_radius", 0, 16, 3, 0},
        {"blur_normal_power", 0, 128, 0, 0},
        {"radius", 0, FLT_MAX, 0.5, 1},
        {"bias", 0, 1, 0.005, 0},
        {"thickness", 0, 8, 1, 0},
        {"blocking_scale", 0, FLT_MAX, 50, 1},
        {"sharpness", 0, 10000, 200, 0},
        {"intensity", 0, 8, 1, 0},
        {"power", 0, 8, 1, 1},
        {"strength", 0, 1, 1, 0},
        {"tint", 0, 1, 0, 0},
        {"debug_distance", 0, FLT_MAX, 100, 0},
        {"method", 0, 5, VKAO_SSAO_VBAO, 0},
    };
    uint32_t count;
    const vkao_parameter *table = vkao_parameters(&count);
    for (size_t i = 0; i < COUNT(rows); ++i) {
        uint32_t k = 0;
        while (k < count && strcmp(table[k].name, rows[i].name) != 0)
            ++k;
        assert_true(k < count);
        assert_true(table[k].least == rows[i].least && table[k].most == rows[i].most);
        assert_true(table[k].standard == rows[i].standard);
        assert_int_equal(table[k].above_least, rows[i].above);
    }
}

static void tables_are_complete(void **state)
{
    (void)state;
    uint32_t count, method_count;
    const vkao_parameter *table = vkao_parameters(&count);
    const vkao_method *methods = vkao_methods(&method_count);
    assert_int_equal(method_count, 6);
    for (uint32_t i = 0; i < count; ++i) {
        assert_true(table[i].name[0] && table[i].help[0]);
        assert_non_null(table[i].unit);
        assert_true(table[i].stages != 0);
        assert_int_equal(table[i].choices != NULL, table[i].type == VKAO_PARAMETER_CHOICE);
        for (uint32_t k = 0; table[i].choices && k <= (uint32_t)table[i].most; ++k)
            assert_true(table[i].choices[k][0]);
        for (uint32_t k = 0; k < i; ++k)
            assert_string_not_equal(table[i].name, table[k].name);
    }
    for (uint32_t i = 0; i < method_count; ++i)
        assert_true(methods[i].name[0] && methods[i].help[0]);
}

static void zero_means_the_default(void **state)
{
    (void)state;
    struct world w;
    open_world(&w);
    w.effect_info.slice_count = w.effect_info.step_count = w.effect_info.sample_count = 0;
    w.effect_info.ao_format = VK_FORMAT_UNDEFINED;
    world_create_effect(&w);
    const vkao_effect_info settings = settings_of(w.effect);
    assert_int_equal(settings.slice_count, 1);
    assert_int_equal(settings.step_count, 9);
    assert_int_equal(settings.sample_count, 16);
    assert_int_equal(settings.ao_format, VK_FORMAT_R8_UNORM);
    assert_int_equal(settings.bent_encoding, VKAO_NORMALS_XYZ_SNORM);
    world_close(&w);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nobody_needs_to_count),
        cmocka_unit_test(value_out_of_range_is_refused_and_named),
        cmocka_unit_test(every_channel_of_a_colour_is_checked),
        cmocka_unit_test(ranges_are_those_of_the_header),
        cmocka_unit_test(tables_are_complete),
        cmocka_unit_test(zero_means_the_default),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
