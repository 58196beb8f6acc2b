/* SPDX-License-Identifier: MIT
 *
 * Contexts: what creation asks for, refuses, builds and gives back when any step of it fails. */
#include "world.h"

#include <stdio.h>
#include <string.h>

static void destroying_returns_everything(void **state)
{
    (void)state;
    for (int callbacks = 0; callbacks < 2; ++callbacks) {
        struct world w;
        world_init(&w, callbacks);
        assert_int_equal(vkao_context_create(&w.info, &w.ctx), VKAO_SUCCESS);
        assert_int_equal(w.log.lines, 0);
        assert_int_equal(fake_live(&w.fake), 0); /* a context is cheap */
        assert_true(callbacks ? w.host.live > 0 : host_calloc.live > 0);
        assert_true(callbacks ? host_calloc.total == 0 : w.host.total == 0);
        world_close(&w);
    }
}

static void destroy_ignores_null(void **state)
{
    (void)state;
    vkao_context_destroy(NULL);
}

static void missing_function_is_unsupported_and_named(void **state)
{
    (void)state;
    struct world complete;
    world_open(&complete);
    assert_true(complete.fake.asked_count >= 28);
    for (size_t i = 0; i < complete.fake.asked_count; ++i) {
        struct world w;
        world_init(&w, i % 2);
        const size_t views = w.fake.object_count; /* of the test */
        w.fake.missing = complete.fake.asked[i];
        vkao_result result = vkao_context_create(&w.info, &w.ctx);
        assert_null(w.ctx);
        expect_refused(&w, VKAO_ERROR_UNSUPPORTED, result, w.fake.missing, "");
        assert_int_equal(w.fake.object_count, views);
        world_close(&w);
    }
    world_close(&complete);
}

static void missing_feature_is_unsupported_and_named(void **state)
{
    (void)state;
    struct world w;
    world_init(&w, true);
    w.features.features.shaderStorageImageWriteWithoutFormat = VK_FALSE;
    expect_refused(&w, VKAO_ERROR_UNSUPPORTED, vkao_context_create(&w.info, &w.ctx),
                   "shaderStorageImageWriteWithoutFormat", "enabled_features");
    assert_null(w.ctx);
    assert_int_equal(w.fake.call_count, 0);
    world_close(&w);
}

static void required_features_are_added_and_others_left(void **state)
{
    (void)state;
    VkPhysicalDeviceFeatures features, want;
    memset(&features, 0, sizeof features);
    features.geometryShader = VK_TRUE;
    want = features;
    want.shaderStorageImageWriteWithoutFormat = VK_TRUE;
    vkao_add_required_features(&features);
    assert_memory_equal(&features, &want, sizeof want);
}

static void old_api_version_is_unsupported(void **state)
{
    (void)state;
    static const struct {
        uint32_t version;
        vkao_result want;
    } cases[] = {
        {VK_API_VERSION_1_0, VKAO_ERROR_UNSUPPORTED},
        {VK_MAKE_API_VERSION(0, 1, 0, 300), VKAO_ERROR_UNSUPPORTED},
        {VK_API_VERSION_1_1, VKAO_SUCCESS},
        {VK_API_VERSION_1_3, VKAO_SUCCESS},
    };
    for (size_t i = 0; i < COUNT(cases); ++i) {
        struct world w;
        world_init(&w, true);
        w.fake.api_version = cases[i].version;
        vkao_result result = vkao_context_create(&w.info, &w.ctx);
        if (cases[i].want == VKAO_SUCCESS)
            assert_int_equal(result, VKAO_SUCCESS);
        else
            expect_refused(&w, cases[i].want, result, "Vulkan 1.0", "1.1");
        world_close(&w);
    }
}

enum required { INSTANCE, PHYSICAL_DEVICE, DEVICE, INSTANCE_PROC, DEVICE_PROC, FEATURES, REQUIRED };

static void clear(vkao_context_info *info, enum required which)
{
    switch (which) {
    case INSTANCE:
        info->instance = VK_NULL_HANDLE;
        break;
    case PHYSICAL_DEVICE:
        info->physical_device = VK_NULL_HANDLE;
        break;
    case DEVICE:
        info->device = VK_NULL_HANDLE;
        break;
    case INSTANCE_PROC:
        info->get_instance_proc_addr = NULL;
        break;
    case DEVICE_PROC:
        info->get_device_proc_addr = NULL;
        break;
    default:
        info->enabled_features = NULL;
        break;
    }
}

static void every_required_null_is_refused_and_named(void **state)
{
    (void)state;
    static const char *const names[REQUIRED] = {
        [INSTANCE] = "context.instance",
        [PHYSICAL_DEVICE] = "context.physical_device",
        [DEVICE] = "context.device",
        [INSTANCE_PROC] = "context.get_instance_proc_addr",
        [DEVICE_PROC] = "context.get_device_proc_addr",
        [FEATURES] = "context.enabled_features",
    };
    for (int i = 0; i < REQUIRED; ++i) {
        struct world w;
        world_init(&w, true);
        clear(&w.info, (enum required)i);
        w.ctx = (vkao_context *)&w;
        vkao_result result = vkao_context_create(&w.info, &w.ctx);
        assert_null(w.ctx);
        expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT, result, names[i], "NULL");
        assert_int_equal(w.fake.call_count, 0);
        world_close(&w);
    }
}

static void null_info_and_null_out_are_refused(void **state)
{
    (void)state;
    struct world w;
    world_init(&w, true);
    w.ctx = (vkao_context *)&w;
    assert_int_equal(vkao_context_create(NULL, &w.ctx), VKAO_ERROR_INVALID_ARGUMENT);
    assert_null(w.ctx);
    assert_int_equal(vkao_context_create(NULL, NULL), VKAO_ERROR_INVALID_ARGUMENT);
    expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT, vkao_context_create(&w.info, NULL), "out",
                   "NULL");
    assert_int_equal(w.fake.call_count, 0);
    world_close(&w);
}

static void incomplete_allocation_callbacks_are_refused(void **state)
{
    (void)state;
    for (int i = 0; i < 3; ++i) {
        struct world w;
        world_init(&w, true);
        if (i == 0)
            w.callbacks.pfnAllocation = NULL;
        if (i == 1)
            w.callbacks.pfnReallocation = NULL;
        if (i == 2)
            w.callbacks.pfnFree = NULL;
        expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT, vkao_context_create(&w.info, &w.ctx),
                       "context.allocator", "");
        world_close(&w);
    }
}

static void allocation_callbacks_are_copied(void **state)
{
    (void)state;
    struct world w;
    world_init(&w, true);
    VkAllocationCallbacks passing = w.callbacks;
    w.info.allocator = &passing;
    assert_int_equal(vkao_context_create(&w.info, &w.ctx), VKAO_SUCCESS);
    memset(&passing, 0, sizeof passing);
    world_create_frame(&w);
    world_close(&w);
}

static void host_memory_that_runs_out_is_reported(void **state)
{
    (void)state;
    for (int callbacks = 0; callbacks < 2; ++callbacks) {
        struct world w;
        world_init(&w, callbacks);
        w.host.fail_at = host_calloc.fail_at = 1;
        expect_refused(&w, VKAO_ERROR_OUT_OF_HOST_MEMORY, vkao_context_create(&w.info, &w.ctx),
                       "context", "memory");
        assert_null(w.ctx);
        world_close(&w);
    }
}

static void features_without_their_type_are_refused(void **state)
{
    (void)state;
    struct world w;
    world_init(&w, true);
    w.features.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO;
    expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT, vkao_context_create(&w.info, &w.ctx),
                   "context.enabled_features", "FEATURES_2");
    world_close(&w);
}

/* A context that goes while others stand on it would leave them hanging. */
static void context_with_living_effects_stays(void **state)
{
    (void)state;
    struct world w;
    world_open_frame(&w, VKAO_STAGE_ALL);
    vkao_context_destroy(w.ctx);
    assert_int_equal(w.log.errors, 1);
    assert_non_null(strstr(w.log.last_error, "2 effects and frames"));
    assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
    world_close(&w);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(destroying_returns_everything),
        cmocka_unit_test(destroy_ignores_null),
        cmocka_unit_test(missing_function_is_unsupported_and_named),
        cmocka_unit_test(missing_feature_is_unsupported_and_named),
        cmocka_unit_test(required_features_are_added_and_others_left),
        cmocka_unit_test(old_api_version_is_unsupported),
        cmocka_unit_test(every_required_null_is_refused_and_named),
        cmocka_unit_test(null_info_and_null_out_are_refused),
        cmocka_unit_test(incomplete_allocation_callbacks_are_refused),
        cmocka_unit_test(allocation_callbacks_are_copied),
        cmocka_unit_test(host_memory_that_runs_out_is_reported),
        cmocka_unit_test(features_without_their_type_are_refused),
        cmocka_unit_test(context_with_living_effects_stays),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
