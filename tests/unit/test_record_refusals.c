/* SPDX-License-Identifier: MIT
 *
 * Calls that cannot be recorded: refused, named, and nothing left in the command buffer. */
#include "world.h"

#include <stdio.h>

static void stage_that_the_effect_lacks_is_refused(void **state)
{
    (void)state;
    for (vkao_stage_flags stages = 1; stages <= VKAO_STAGE_ALL; ++stages) {
        struct world w;
        world_open_frame(&w, stages);
        const vkao_stage_flags has = stages | (stages & 3u ? VKAO_STAGE_PREPARE : 0u);
        for (vkao_stage_flags asked = 0; asked < 32; ++asked) {
            char value[32];
            snprintf(value, sizeof value, "0x%x", asked);
            fake_forget_calls(&w.fake);
            vkao_result result = vkao_cmd_stage(w.frame, world_cmd(&w), asked, &w.view, &w.params);
            if (asked && !(asked & ~has)) {
                assert_int_equal(result, VKAO_SUCCESS);
                continue;
            }
            expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT, result, "stages", value);
            expect_nothing_recorded(&w);
        }
        world_close(&w);
    }
}

static void every_required_null_is_refused_and_named(void **state)
{
    (void)state;
    struct world w;
    world_open_frame(&w, VKAO_STAGE_ALL);
    VkCommandBuffer cmd = world_cmd(&w);
    const vkao_result invalid = VKAO_ERROR_INVALID_ARGUMENT;
    /* There is no log to name it in. */
    assert_int_equal(vkao_cmd_record(NULL, cmd, &w.view, &w.params), invalid);
    assert_int_equal(vkao_cmd_stage(NULL, cmd, VKAO_STAGE_SSAO, &w.view, &w.params), invalid);
    expect_refused(&w, invalid, vkao_cmd_record(w.frame, NULL, &w.view, &w.params),
                   "vkao_cmd_record", "cmd is NULL");
    expect_refused(&w, invalid, vkao_cmd_stage(w.frame, NULL, VKAO_STAGE_SSAO, &w.view, &w.params),
                   "vkao_cmd_stage", "cmd is NULL");
    expect_refused(&w, invalid, vkao_cmd_record(w.frame, cmd, NULL, &w.params), "vkao_cmd_record",
                   "view is NULL");
    expect_refused(&w, invalid, vkao_cmd_record(w.frame, cmd, &w.view, NULL), "vkao_cmd_record",
                   "params is NULL");
    expect_nothing_recorded(&w);
    world_close(&w);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stage_that_the_effect_lacks_is_refused),
        cmocka_unit_test(every_required_null_is_refused_and_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
