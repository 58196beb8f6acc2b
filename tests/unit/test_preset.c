/* SPDX-License-Identifier: MIT
 *
 * Presets: what they set, and that they leave the rest alone. */
#include "world.h"

#include <string.h>

static const struct {
    VkBool32 half;
    uint32_t slices, steps, radius;
    float normal_power, sharpness;
} want[] = {
    [VKAO_QUALITY_FAST] = {VK_TRUE, 1, 10, 3, 0.0f, 200.0f},
    [VKAO_QUALITY_DEFAULT] = {VK_FALSE, 1, 9, 3, 0.0f, 200.0f},
    [VKAO_QUALITY_HIGH] = {VK_FALSE, 2, 9, 3, 8.0f, 400.0f},
    [VKAO_QUALITY_BEST] = {VK_FALSE, 5, 16, 1, 8.0f, 400.0f},
};

static void presets_set_what_they_decide_and_nothing_else(void **state)
{
    (void)state;
    for (unsigned q = 0; q < COUNT(want); ++q) {
        vkao_effect_info effect, was_effect;
        vkao_params params, was_params;
        memset(&effect, 0x11, sizeof effect);
        memset(&params, 0x11, sizeof params);
        was_effect = effect;
        was_params = params;
        assert_int_equal(vkao_preset((vkao_quality)q, &effect, &params), VKAO_SUCCESS);
        assert_int_equal(effect.half_resolution, want[q].half);
        assert_int_equal(effect.method, VKAO_SSAO_VBAO);
        assert_int_equal(effect.slice_count, want[q].slices);
        assert_int_equal(effect.step_count, want[q].steps);
        assert_int_equal(effect.blur_radius, want[q].radius);
        assert_true(effect.blur_normal_power == want[q].normal_power);
        assert_true(params.bias == 0.005f && params.thickness == 1.0f);
        assert_true(params.sharpness == want[q].sharpness);
        was_effect.half_resolution = effect.half_resolution;
        was_effect.method = effect.method;
        was_effect.slice_count = effect.slice_count;
        was_effect.step_count = effect.step_count;
        was_effect.blur_radius = effect.blur_radius;
        was_effect.blur_normal_power = effect.blur_normal_power;
        was_params.bias = params.bias;
        was_params.sharpness = params.sharpness;
        was_params.thickness = params.thickness;
        assert_memory_equal(&effect, &was_effect, sizeof effect);
        assert_memory_equal(&params, &was_params, sizeof params);
    }
}

static void each_pointer_may_be_null(void **state)
{
    (void)state;
    vkao_effect_info effect = vkao_effect_info_default();
    vkao_params params = vkao_params_default();
    assert_int_equal(vkao_preset(VKAO_QUALITY_BEST, NULL, NULL), VKAO_SUCCESS);
    assert_int_equal(vkao_preset(VKAO_QUALITY_BEST, &effect, NULL), VKAO_SUCCESS);
    assert_int_equal(vkao_preset(VKAO_QUALITY_BEST, NULL, &params), VKAO_SUCCESS);
}

static void unknown_quality_is_refused_and_changes_nothing(void **state)
{
    (void)state;
    vkao_effect_info effect = vkao_effect_info_default();
    const vkao_effect_info was = effect;
    assert_int_equal(vkao_preset((vkao_quality)4, &effect, NULL), VKAO_ERROR_INVALID_ARGUMENT);
    assert_int_equal(vkao_preset((vkao_quality)-1, &effect, NULL), VKAO_ERROR_INVALID_ARGUMENT);
    assert_memory_equal(&effect, &was, sizeof was);
}

static void presets_are_effects(void **state)
{
    (void)state;
    for (unsigned q = 0; q < COUNT(want); ++q) {
        struct world w;
        world_open(&w);
        world_use_scratch_noise(&w);
        assert_int_equal(vkao_preset((vkao_quality)q, &w.effect_info, &w.params), VKAO_SUCCESS);
        world_create_frame(&w);
        assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
        /* A caller can learn what a preset became. */
        assert_int_equal(settings_of(w.effect).step_count, want[q].steps);
        world_close(&w);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(presets_set_what_they_decide_and_nothing_else),
        cmocka_unit_test(each_pointer_may_be_null),
        cmocka_unit_test(unknown_quality_is_refused_and_changes_nothing),
        cmocka_unit_test(presets_are_effects),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
