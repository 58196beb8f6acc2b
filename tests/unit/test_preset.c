/* SPDX-License-Identifier: MIT
 *
 * Presets fill what vkao.h says they decide, and nothing else. */
#include "world.h"

#include <stdio.h>
#include <string.h>

enum { KNOWN = VKAO_QUALITY_BEST + 1 };

/* Every byte that a preset must leave alone, by leaving it at two different values. */
static void check_left_alone(const void *before, const void *after, size_t size,
                             const size_t *decided, size_t count, const char *name)
{
    const unsigned char *a = before, *b = after;
    for (size_t i = 0; i < size; ++i) {
        bool may = false;
        for (size_t k = 0; k < count; ++k)
            may = may || (i >= decided[k] && i < decided[k] + 4);
        if (!may && a[i] != b[i])
            fail_msg("%s: byte %zu was changed", name, i);
    }
}

#define FRAME(field) offsetof(vkao_frame_info, field)
#define SSAO(field) offsetof(vkao_ssao_params, field)
#define BLUR(field) offsetof(vkao_blur_params, field)

static void presets_change_what_they_decide_and_nothing_else(void **state)
{
    (void)state;
    static const size_t frame_fields[] = {FRAME(half_resolution)};
    static const size_t ssao_fields[] = {SSAO(method), SSAO(slice_count), SSAO(step_count),
                                         SSAO(bias), SSAO(thickness)};
    static const size_t blur_fields[] = {BLUR(radius), BLUR(sharpness), BLUR(normal_power)};
    for (int q = 0; q < KNOWN; ++q) {
        for (int fill = 0x11; fill <= 0xee; fill += 0xdd) {
            vkao_frame_info frame, frame_was;
            vkao_ssao_params ssao, ssao_was;
            vkao_blur_params blur, blur_was;
            memset(&frame_was, fill, sizeof frame_was);
            memset(&ssao_was, fill, sizeof ssao_was);
            memset(&blur_was, fill, sizeof blur_was);
            memcpy(&frame, &frame_was, sizeof frame);
            memcpy(&ssao, &ssao_was, sizeof ssao);
            memcpy(&blur, &blur_was, sizeof blur);
            assert_int_equal(vkao_preset((vkao_quality)q, &frame, &ssao, &blur), VKAO_SUCCESS);
            check_left_alone(&frame_was, &frame, sizeof frame, frame_fields, 1, "frame");
            check_left_alone(&ssao_was, &ssao, sizeof ssao, ssao_fields, COUNT(ssao_fields),
                             "ssao");
            check_left_alone(&blur_was, &blur, sizeof blur, blur_fields, COUNT(blur_fields),
                             "blur");
            /* And they decide each of them: 0x11111111 and 0xeeeeeeee are nobody's setting. */
            for (size_t i = 0; i < COUNT(ssao_fields); ++i)
                assert_memory_not_equal((char *)&ssao + ssao_fields[i],
                                        (char *)&ssao_was + ssao_fields[i], 4);
            for (size_t i = 0; i < COUNT(blur_fields); ++i)
                assert_memory_not_equal((char *)&blur + blur_fields[i],
                                        (char *)&blur_was + blur_fields[i], 4);
            assert_int_equal(frame.half_resolution, q == VKAO_QUALITY_FAST);
        }
    }
}

static void defaults_are_the_default_preset(void **state)
{
    (void)state;
    const vkao_ssao_params ssao = vkao_ssao_params_default();
    const vkao_blur_params blur = vkao_blur_params_default();
    vkao_ssao_params s = ssao;
    vkao_blur_params b = blur;
    s.method = VKAO_SSAO_SPHERE;
    s.slice_count = s.step_count = b.radius = 7;
    assert_int_equal(vkao_preset(VKAO_QUALITY_DEFAULT, NULL, &s, &b), VKAO_SUCCESS);
    assert_memory_equal(&s, &ssao, sizeof s);
    assert_memory_equal(&b, &blur, sizeof b);
}

static void better_presets_take_more_samples(void **state)
{
    (void)state;
    uint32_t last = 0;
    for (int q = 0; q < KNOWN; ++q) {
        vkao_frame_info frame = {0};
        vkao_ssao_params s = vkao_ssao_params_default();
        assert_int_equal(vkao_preset((vkao_quality)q, &frame, &s, NULL), VKAO_SUCCESS);
        /* in a block of two by two texels */
        uint32_t samples = s.slice_count * s.step_count * (frame.half_resolution ? 1u : 4u);
        assert_true(samples > last);
        last = samples;
    }
}

static void every_pointer_may_be_null(void **state)
{
    (void)state;
    vkao_frame_info frame;
    vkao_ssao_params ssao;
    vkao_blur_params blur;
    for (int given = 0; given < 8; ++given) {
        memset(&frame, 0x11, sizeof frame);
        memset(&ssao, 0x11, sizeof ssao);
        memset(&blur, 0x11, sizeof blur);
        assert_int_equal(vkao_preset(VKAO_QUALITY_HIGH, given & 1 ? &frame : NULL,
                                     given & 2 ? &ssao : NULL, given & 4 ? &blur : NULL),
                         VKAO_SUCCESS);
        assert_true((given & 1) == (frame.half_resolution == VK_FALSE));
        assert_true((given & 2) == 2 * (ssao.method == VKAO_SSAO_VBAO));
        assert_true((given & 4) == 4 * (blur.radius != 0x11111111u));
    }
}

static void unknown_quality_changes_nothing(void **state)
{
    (void)state;
    static const uint32_t unknown[] = {KNOWN, 0x7fffffffu, 0xffffffffu};
    for (size_t i = 0; i < COUNT(unknown); ++i) {
        vkao_quality quality;
        vkao_frame_info frame, frame_was;
        vkao_ssao_params ssao, ssao_was;
        vkao_blur_params blur, blur_was;
        memset(&frame, 0x11, sizeof frame);
        memset(&ssao, 0x11, sizeof ssao);
        memset(&blur, 0x11, sizeof blur);
        memcpy(&frame_was, &frame, sizeof frame);
        memcpy(&ssao_was, &ssao, sizeof ssao);
        memcpy(&blur_was, &blur, sizeof blur);
        memcpy(&quality, &unknown[i], sizeof quality);
        assert_int_equal(vkao_preset(quality, &frame, &ssao, &blur), VKAO_ERROR_INVALID_ARGUMENT);
        assert_memory_equal(&frame, &frame_was, sizeof frame);
        assert_memory_equal(&ssao, &ssao_was, sizeof ssao);
        assert_memory_equal(&blur, &blur_was, sizeof blur);
    }
}

static void presets_are_accepted_by_every_call(void **state)
{
    (void)state;
    for (int q = 0; q < KNOWN; ++q) {
        struct world w;
        world_open(&w);
        w.images.ao_noisy = (vkao_image){0};
        assert_int_equal(vkao_preset((vkao_quality)q, &w.frame_info, &w.ssao, &w.blur),
                         VKAO_SUCCESS);
        assert_int_equal(vkao_frame_create(w.ctx, &w.frame_info, &w.frame), VKAO_SUCCESS);
        assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
        assert_int_equal(w.log.lines, 0);
        world_close(&w);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(presets_change_what_they_decide_and_nothing_else),
        cmocka_unit_test(defaults_are_the_default_preset),
        cmocka_unit_test(better_presets_take_more_samples),
        cmocka_unit_test(every_pointer_may_be_null),
        cmocka_unit_test(unknown_quality_changes_nothing),
        cmocka_unit_test(presets_are_accepted_by_every_call),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
