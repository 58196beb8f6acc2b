/* SPDX-License-Identifier: MIT
 *
 * Calls that cannot be recorded: refused, named, and nothing left in the command buffer. */
#include "internal.h"
#include "world.h"

#include <stdio.h>

static void method_that_was_not_prepared_is_refused(void **state)
{
    (void)state;
    for (int method = 0; method < VKAO_METHOD_COUNT; ++method) {
        struct world w;
        world_init(&w, true);
        w.info.method_mask = 1u << method;
        assert_int_equal(vkao_context_create(&w.info, &w.ctx), VKAO_SUCCESS);
        assert_int_equal(vkao_frame_create(w.ctx, &w.frame_info, &w.frame), VKAO_SUCCESS);
        w.ssao.method = (vkao_ssao_method)method;
        assert_int_equal(vkao_cmd_ssao(w.frame, world_cmd(&w), &w.view, &w.ssao), VKAO_SUCCESS);
        fake_forget_calls(&w.fake);
        for (int other = 0; other < VKAO_METHOD_COUNT; ++other) {
            char value[32];
            if (other == method)
                continue;
            snprintf(value, sizeof value, "is %d,", other);
            w.ssao.method = (vkao_ssao_method)other;
            expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT,
                           vkao_cmd_ssao(w.frame, world_cmd(&w), &w.view, &w.ssao), "ssao.method",
                           value);
            expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT, world_record_all(&w), "ssao.method",
                           value);
        }
        expect_nothing_recorded(&w);
        world_close(&w);
    }
}

static void stage_that_the_frame_lacks_is_refused(void **state)
{
    (void)state;
    for (vkao_stage_flags stages = 1; stages <= VKAO_STAGE_ALL; ++stages) {
        struct world w;
        world_open_frame(&w, stages);
        VkCommandBuffer cmd = world_cmd(&w);
        vkao_result results[4] = {vkao_cmd_prepare(w.frame, cmd, &w.view),
                                  vkao_cmd_ssao(w.frame, cmd, &w.view, &w.ssao),
                                  vkao_cmd_blur(w.frame, cmd, &w.view, &w.blur),
                                  vkao_cmd_composite(w.frame, cmd, &w.view, &w.composite)};
        const bool want[4] = {stages & 3u, stages & 1u, stages & 2u, stages & 4u};
        unsigned refused = 0;
        for (int i = 0; i < 4; ++i) {
            assert_int_equal(results[i], want[i] ? VKAO_SUCCESS : VKAO_ERROR_INVALID_ARGUMENT);
            refused += !want[i];
        }
        assert_int_equal(w.log.errors, refused);
        world_close(&w);
    }
}

static void params_are_given_for_present_stages_only(void **state)
{
    (void)state;
    static const char *const names[] = {"ssao", "blur", "composite"};
    for (vkao_stage_flags stages = 1; stages <= VKAO_STAGE_ALL; ++stages) {
        for (vkao_stage_flags given = 0; given <= VKAO_STAGE_ALL; ++given) {
            struct world w;
            world_open_frame(&w, stages);
            vkao_result result =
                vkao_cmd_all(w.frame, world_cmd(&w), &w.view, given & 1u ? &w.ssao : NULL,
                             given & 2u ? &w.blur : NULL, given & 4u ? &w.composite : NULL);
            if (given == stages) {
                assert_int_equal(result, VKAO_SUCCESS);
            } else {
                /* Any of the wrong ones may be named, those that should be absent first. */
                vkao_stage_flags wrong = given & ~stages ? given & ~stages : stages & ~given;
                int first = wrong & 1u ? 0 : wrong & 2u ? 1 : 2;
                expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT, result, names[first], "NULL");
                expect_nothing_recorded(&w);
            }
            world_close(&w);
        }
    }
}

static void every_required_null_is_refused_and_named(void **state)
{
    (void)state;
    struct world w;
    world_open_frame(&w, VKAO_STAGE_ALL);
    VkCommandBuffer cmd = world_cmd(&w);
    const vkao_result invalid = VKAO_ERROR_INVALID_ARGUMENT;
    assert_int_equal(vkao_cmd_prepare(NULL, cmd, &w.view), invalid); /* no log to name it in */
    assert_int_equal(vkao_cmd_ssao(NULL, cmd, &w.view, &w.ssao), invalid);
    assert_int_equal(vkao_cmd_blur(NULL, cmd, &w.view, &w.blur), invalid);
    assert_int_equal(vkao_cmd_composite(NULL, cmd, &w.view, &w.composite), invalid);
    assert_int_equal(vkao_cmd_all(NULL, cmd, &w.view, &w.ssao, &w.blur, &w.composite), invalid);
    expect_refused(&w, invalid, vkao_cmd_prepare(w.frame, NULL, &w.view), "vkao_cmd_prepare",
                   "cmd is NULL");
    expect_refused(&w, invalid, vkao_cmd_ssao(w.frame, NULL, &w.view, &w.ssao), "vkao_cmd_ssao",
                   "cmd");
    expect_refused(&w, invalid, vkao_cmd_blur(w.frame, NULL, &w.view, &w.blur), "vkao_cmd_blur",
                   "cmd");
    expect_refused(&w, invalid, vkao_cmd_composite(w.frame, NULL, &w.view, &w.composite),
                   "vkao_cmd_composite", "cmd is NULL");
    expect_refused(&w, invalid,
                   vkao_cmd_all(w.frame, NULL, &w.view, &w.ssao, &w.blur, &w.composite),
                   "vkao_cmd_all", "cmd is NULL");
    expect_refused(&w, invalid, vkao_cmd_prepare(w.frame, cmd, NULL), "view", "NULL");
    expect_refused(&w, invalid, vkao_cmd_ssao(w.frame, cmd, NULL, &w.ssao), "view", "NULL");
    expect_refused(&w, invalid, vkao_cmd_ssao(w.frame, cmd, &w.view, NULL), "ssao", "NULL");
    expect_refused(&w, invalid, vkao_cmd_blur(w.frame, cmd, NULL, &w.blur), "view", "NULL");
    expect_refused(&w, invalid, vkao_cmd_blur(w.frame, cmd, &w.view, NULL), "blur", "NULL");
    expect_refused(&w, invalid, vkao_cmd_composite(w.frame, cmd, NULL, &w.composite), "view",
                   "NULL");
    expect_refused(&w, invalid, vkao_cmd_composite(w.frame, cmd, &w.view, NULL), "composite",
                   "NULL");
    expect_refused(&w, invalid, vkao_cmd_all(w.frame, cmd, NULL, &w.ssao, &w.blur, &w.composite),
                   "view", "NULL");
    expect_nothing_recorded(&w);
    world_close(&w);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(method_that_was_not_prepared_is_refused),
        cmocka_unit_test(stage_that_the_frame_lacks_is_refused),
        cmocka_unit_test(params_are_given_for_present_stages_only),
        cmocka_unit_test(every_required_null_is_refused_and_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
