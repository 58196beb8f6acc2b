/* SPDX-License-Identifier: MIT
 *
 * What is said, to whom, and how much of it. */
#include "log.h"
#include "vk.h"
#include "world.h"

#include <string.h>

static void count(void *user_data, vkao_log_level level, const char *message)
{
    unsigned *counts = user_data;
    assert_non_null(message);
    ++counts[level];
}

static void level_filters(void **state)
{
    (void)state;
    static const struct {
        vkao_log_level level;
        unsigned want[4];
    } cases[] = {
        {VKAO_LOG_DEFAULT, {0, 1, 1, 0}},
        {VKAO_LOG_ERROR, {0, 1, 0, 0}},
        {VKAO_LOG_WARNING, {0, 1, 1, 0}},
        {VKAO_LOG_INFO, {0, 1, 1, 1}},
    };
    for (size_t i = 0; i < COUNT(cases); ++i) {
        unsigned counts[4] = {0};
        const struct vkao_logger log = {count, counts, cases[i].level};
        vkao_log(&log, VKAO_LOG_ERROR, "e");
        vkao_log(&log, VKAO_LOG_WARNING, "w");
        vkao_log(&log, VKAO_LOG_INFO, "i");
        assert_memory_equal(counts, cases[i].want, sizeof counts);
    }
}

static void context_log_level_decides_about_info_lines(void **state)
{
    (void)state;
    for (int info = 0; info < 2; ++info) {
        struct world w;
        world_init(&w, true);
        w.info.log_level = info ? VKAO_LOG_INFO : VKAO_LOG_DEFAULT;
        w.images.normals = (vkao_image){0}; /* which the effect would not read: a warning */
        assert_int_equal(vkao_context_create(&w.info, &w.ctx), VKAO_SUCCESS);
        world_create_frame(&w);
        assert_true(info ? w.log.lines > 0 : w.log.lines == 0);
        unsigned at_creation = w.log.lines;
        assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
        assert_int_equal(w.log.lines, at_creation);
        world_close(&w);
    }
}

static void unknown_log_level_is_refused(void **state)
{
    (void)state;
    struct world w;
    world_init(&w, true);
    w.info.log_level = (vkao_log_level)4;
    expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT, vkao_context_create(&w.info, &w.ctx),
                   "context.log_level", "4");
    world_close(&w);
}

static void no_log_is_silent(void **state)
{
    (void)state;
    struct world w;
    world_init(&w, true);
    w.info.log = NULL;
    w.info.padding = 1;
    assert_int_equal(vkao_context_create(&w.info, &w.ctx), VKAO_ERROR_INVALID_ARGUMENT);
    w.info.padding = 0;
    assert_int_equal(vkao_context_create(&w.info, &w.ctx), VKAO_SUCCESS);
    w.effect_info.stages = 0;
    assert_int_equal(world_try_frame(&w), VKAO_ERROR_INVALID_ARGUMENT);
    world_close(&w);
}

static void long_lines_are_cut_not_overrun(void **state)
{
    (void)state;
    struct world w;
    world_init(&w, true);
    char text[2000];
    memset(text, 'x', sizeof text - 1);
    text[sizeof text - 1] = 0;
    const struct vkao_logger log = {w.info.log, w.info.log_user_data, VKAO_LOG_ERROR};
    assert_int_equal(vkao_refuse(&log, VKAO_ERROR_UNSUPPORTED, "%s", text), VKAO_ERROR_UNSUPPORTED);
    assert_true(strlen(w.log.last) > 100 && strlen(w.log.last) < sizeof w.log.last - 1);
    world_close(&w);
}

static void every_result_has_its_own_text(void **state)
{
    (void)state;
    static const vkao_result results[] = {
        VKAO_SUCCESS,
        VKAO_ERROR_INVALID_ARGUMENT,
        VKAO_ERROR_UNSUPPORTED,
        VKAO_ERROR_OUT_OF_HOST_MEMORY,
        VKAO_ERROR_OUT_OF_DEVICE_MEMORY,
        VKAO_ERROR_VULKAN,
        (vkao_result)-6, /* from here on unknown */
        (vkao_result)1,
        VKAO_RESULT_MAX_ENUM,
    };
    for (size_t i = 0; i < COUNT(results); ++i) {
        const char *text = vkao_result_string(results[i]);
        assert_non_null(text);
        assert_true(text[0]);
        for (size_t k = 0; k < i && k < 6; ++k)
            assert_string_not_equal(text, vkao_result_string(results[k]));
        if (i > 6)
            assert_string_equal(text, vkao_result_string(results[6]));
    }
}

static void vulkan_results_map_to_the_few(void **state)
{
    (void)state;
    static const struct {
        VkResult vulkan;
        vkao_result want;
    } cases[] = {
        {VK_SUCCESS, VKAO_SUCCESS},
        {VK_ERROR_OUT_OF_HOST_MEMORY, VKAO_ERROR_OUT_OF_HOST_MEMORY},
        {VK_ERROR_OUT_OF_DEVICE_MEMORY, VKAO_ERROR_OUT_OF_DEVICE_MEMORY},
        {VK_ERROR_OUT_OF_POOL_MEMORY, VKAO_ERROR_OUT_OF_DEVICE_MEMORY},
        {VK_ERROR_FRAGMENTED_POOL, VKAO_ERROR_OUT_OF_DEVICE_MEMORY},
        {VK_ERROR_DEVICE_LOST, (vkao_result)(VKAO_ERROR_VULKAN + VK_ERROR_DEVICE_LOST)},
        {VK_ERROR_UNKNOWN, (vkao_result)(VKAO_ERROR_VULKAN + VK_ERROR_UNKNOWN)},
        {VK_INCOMPLETE, (vkao_result)(VKAO_ERROR_VULKAN + VK_ERROR_UNKNOWN)},
    };
    for (size_t i = 0; i < COUNT(cases); ++i)
        assert_int_equal(vkao_from_vk(cases[i].vulkan), cases[i].want);
}

static void version_is_the_headers(void **state)
{
    (void)state;
    assert_int_equal(VK_API_VERSION_MAJOR(vkao_version()), VKAO_VERSION_MAJOR);
    assert_int_equal(VK_API_VERSION_MINOR(vkao_version()), VKAO_VERSION_MINOR);
    assert_int_equal(VK_API_VERSION_PATCH(vkao_version()), VKAO_VERSION_PATCH);
    assert_int_equal(VK_API_VERSION_VARIANT(vkao_version()), 0);
}

static void errors_carry_their_vkresult(void **state)
{
    (void)state;
    static const VkResult results[] = {VK_ERROR_DEVICE_LOST, VK_ERROR_UNKNOWN,
                                       VK_ERROR_OUT_OF_HOST_MEMORY, VK_ERROR_OUT_OF_DEVICE_MEMORY,
                                       VK_ERROR_INVALID_SHADER_NV};
    for (size_t i = 0; i < COUNT(results); ++i)
        assert_int_equal(vkao_vk_result(vkao_from_vk(results[i])), results[i]);
    assert_int_equal(vkao_vk_result(VKAO_SUCCESS), VK_SUCCESS);
    assert_int_equal(vkao_vk_result(VKAO_ERROR_INVALID_ARGUMENT), VK_SUCCESS);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(level_filters),
        cmocka_unit_test(context_log_level_decides_about_info_lines),
        cmocka_unit_test(unknown_log_level_is_refused),
        cmocka_unit_test(no_log_is_silent),
        cmocka_unit_test(long_lines_are_cut_not_overrun),
        cmocka_unit_test(every_result_has_its_own_text),
        cmocka_unit_test(vulkan_results_map_to_the_few),
        cmocka_unit_test(errors_carry_their_vkresult),
        cmocka_unit_test(version_is_the_headers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
