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
        assert_true(fake_live(&w.fake) > 0);
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

static void failing_nth_call_leaks_nothing(void **state)
{
    (void)state;
    static const struct {
        VkResult vulkan;
        vkao_result vkao;
    } failures[] = {
        {VK_ERROR_OUT_OF_HOST_MEMORY, VKAO_ERROR_OUT_OF_HOST_MEMORY},
        {VK_ERROR_OUT_OF_DEVICE_MEMORY, VKAO_ERROR_OUT_OF_DEVICE_MEMORY},
        {VK_ERROR_DEVICE_LOST, VKAO_ERROR_VULKAN},
        {VK_ERROR_INITIALIZATION_FAILED, VKAO_ERROR_VULKAN},
        {VK_ERROR_UNKNOWN, VKAO_ERROR_VULKAN},
    };
    for (size_t f = 0; f < COUNT(failures) * 2; ++f) {
        unsigned n = 0;
        for (;;) {
            struct world w;
            world_init(&w, f % 2);
            w.fake.fail_at = ++n;
            w.fake.fail_result = failures[f / 2].vulkan;
            w.ctx = (vkao_context *)&w;
            vkao_result result = vkao_context_create(&w.info, &w.ctx);
            if (!w.fake.failed) {
                assert_int_equal(result, VKAO_SUCCESS);
                world_close(&w);
                break;
            }
            assert_null(w.ctx);
            char value[32];
            snprintf(value, sizeof value, "%d", (int)w.fake.fail_result);
            expect_refused(&w, failures[f / 2].vkao, result, w.fake.failed, value);
            world_close(&w);
        }
        assert_true(n > 38); /* two layouts, a module for each of 18 pipelines */
    }
}

static void failing_nth_host_allocation_leaks_nothing(void **state)
{
    (void)state;
    unsigned failed = 0;
    for (unsigned n = 1;; ++n) {
        struct world w;
        world_init(&w, true);
        w.host.fail_at = n;
        vkao_result result = vkao_context_create(&w.info, &w.ctx);
        if (w.host.total < n) {
            assert_int_equal(result, VKAO_SUCCESS);
            world_close(&w);
            break;
        }
        ++failed;
        assert_null(w.ctx);
        assert_int_equal(result, VKAO_ERROR_OUT_OF_HOST_MEMORY);
        assert_int_equal(w.log.errors, 1);
        world_close(&w);
    }
    /* The context, its list of pipelines, two layouts, a module and a pipeline for each of 18. */
    assert_int_equal(failed, 2 + 2 + 2 * 18);

    struct world w;
    world_init(&w, false);
    host_calloc.fail_at = 1;
    expect_refused(&w, VKAO_ERROR_OUT_OF_HOST_MEMORY, vkao_context_create(&w.info, &w.ctx),
                   "context", "memory");
    world_close(&w);
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
    w.features.shaderStorageImageWriteWithoutFormat = VK_FALSE;
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
    assert_int_equal(vkao_frame_create(w.ctx, &w.frame_info, &w.frame), VKAO_SUCCESS);
    world_close(&w);
}

static void method_mask_builds_only_what_was_asked(void **state)
{
    (void)state;
    static const struct {
        uint32_t mask;
        size_t pipelines;
    } cases[] = {
        /* Prepare, composite and debug; blur x, blur y and upsample without and with bent normals;
         * the methods, of which gtao, vbao and raymarch come without and with them. */
        {0u, 18},       {1u << VKAO_SSAO_SPHERE, 10}, {1u << VKAO_SSAO_HEMISPHERE, 10},
        {3u, 11},       {1u << VKAO_SSAO_HBAO, 10},   {1u << VKAO_SSAO_GTAO, 11},
        {0x3fu, 18},    {1u << VKAO_SSAO_VBAO, 11},   {1u << VKAO_SSAO_RAYMARCH, 11},
    };
    for (size_t i = 0; i < COUNT(cases); ++i) {
        struct world w;
        world_init(&w, true);
        w.info.method_mask = cases[i].mask;
        assert_int_equal(vkao_context_create(&w.info, &w.ctx), VKAO_SUCCESS);
        assert_int_equal(fake_live_of(&w.fake, VK_OBJECT_TYPE_PIPELINE), cases[i].pipelines);
        world_close(&w);
    }
}

static void unknown_method_is_refused(void **state)
{
    (void)state;
    static const struct {
        uint32_t mask;
        const char *value;
    } cases[] = {{0x40u, "0x40"}, {0x7fu, "0x7f"}, {0x80000000u, "0x80000000"}};
    for (size_t i = 0; i < COUNT(cases); ++i) {
        struct world w;
        world_init(&w, true);
        w.info.method_mask = cases[i].mask;
        expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT, vkao_context_create(&w.info, &w.ctx),
                       "context.method_mask", cases[i].value);
        assert_int_equal(w.fake.call_count, 0);
        world_close(&w);
    }
}

/* Does a shader say that it stores 16 bits? Validation would refuse it on other devices. */
static bool stores_16_bits(const uint32_t *code)
{
    enum { HEADER = 5, CAPABILITY = 2u << 16 | 17u, STORAGE_BUFFER_16BIT_ACCESS = 4433 };
    for (code += HEADER; code[0] == CAPABILITY; code += 2) {
        if (code[1] == STORAGE_BUFFER_16BIT_ACCESS)
            return true;
    }
    return false;
}

static void only_devices_that_store_16_bits_are_asked_to(void **state)
{
    (void)state;
    for (int i = 0; i < 4; ++i) {
        const bool has_it = i & 1, cpu = i & 2;
        struct world w;
        world_init(&w, true);
        if (cpu)
            w.fake.device_type = VK_PHYSICAL_DEVICE_TYPE_CPU;
        w.info.storage_16bit = has_it;
        assert_int_equal(vkao_context_create(&w.info, &w.ctx), VKAO_SUCCESS);
        int count = 0;
        for (size_t o = 0; o < w.fake.object_count; ++o) {
            if (w.fake.objects[o].type == VK_OBJECT_TYPE_PIPELINE)
                count += stores_16_bits(w.fake.objects[o].code);
        }
        /* hemisphere, hbao, and with and without bent normals gtao and vbao */
        assert_int_equal(count, has_it && cpu ? 6 : 0);
        world_close(&w);
    }
    struct world w;
    world_init(&w, true);
    w.info.storage_16bit = 2;
    expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT, vkao_context_create(&w.info, &w.ctx),
                   "context.", "storage_16bit 2");
    world_close(&w);
}

static void context_owns_no_device_memory_and_no_modules(void **state)
{
    (void)state;
    struct world w;
    world_open(&w);
    assert_int_equal(fake_count(&w.fake, "vkAllocateMemory"), 0);
    assert_int_equal(fake_live_of(&w.fake, VK_OBJECT_TYPE_SHADER_MODULE), 0);
    world_close(&w);
}

static void pipeline_cache_reaches_the_driver(void **state)
{
    (void)state;
    struct world w;
    world_init(&w, true);
    w.info.pipeline_cache = (VkPipelineCache)(uintptr_t)0x1234;
    assert_int_equal(vkao_context_create(&w.info, &w.ctx), VKAO_SUCCESS);
    for (size_t i = 0; i < 18; ++i)
        assert_true(fake_nth(&w.fake, "vkCreateComputePipelines", i)->cache ==
                    w.info.pipeline_cache);
    world_close(&w);
}

static void debug_labels_are_optional_in_every_way(void **state)
{
    (void)state;
    for (int i = 0; i < 4; ++i) {
        const bool present = i & 1, wanted = i & 2;
        struct world w;
        world_init(&w, true);
        w.fake.debug_utils = present;
        w.info.debug_labels = wanted;
        assert_int_equal(vkao_context_create(&w.info, &w.ctx), VKAO_SUCCESS);
        assert_int_equal(fake_count(&w.fake, "vkSetDebugUtilsObjectNameEXT"),
                         present && wanted ? 18 : 0);
        world_close(&w);
    }
}

static void failing_to_name_an_object_is_no_error(void **state)
{
    (void)state;
    unsigned failures = 0, n = 0;
    for (bool done = false; !done;) {
        struct world w;
        world_init(&w, true);
        w.fake.debug_utils = true;
        w.info.debug_labels = VK_TRUE;
        w.fake.fail_at = ++n;
        vkao_result result = vkao_context_create(&w.info, &w.ctx);
        if (w.fake.failed && strcmp(w.fake.failed, "vkSetDebugUtilsObjectNameEXT") == 0) {
            assert_int_equal(result, VKAO_SUCCESS);
            ++failures;
        }
        done = !w.fake.failed;
        world_close(&w);
    }
    assert_int_equal(failures, 18);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(destroying_returns_everything),
        cmocka_unit_test(destroy_ignores_null),
        cmocka_unit_test(failing_nth_call_leaks_nothing),
        cmocka_unit_test(failing_nth_host_allocation_leaks_nothing),
        cmocka_unit_test(missing_function_is_unsupported_and_named),
        cmocka_unit_test(missing_feature_is_unsupported_and_named),
        cmocka_unit_test(required_features_are_added_and_others_left),
        cmocka_unit_test(old_api_version_is_unsupported),
        cmocka_unit_test(every_required_null_is_refused_and_named),
        cmocka_unit_test(null_info_and_null_out_are_refused),
        cmocka_unit_test(incomplete_allocation_callbacks_are_refused),
        cmocka_unit_test(allocation_callbacks_are_copied),
        cmocka_unit_test(method_mask_builds_only_what_was_asked),
        cmocka_unit_test(unknown_method_is_refused),
        cmocka_unit_test(only_devices_that_store_16_bits_are_asked_to),
        cmocka_unit_test(context_owns_no_device_memory_and_no_modules),
        cmocka_unit_test(pipeline_cache_reaches_the_driver),
        cmocka_unit_test(debug_labels_are_optional_in_every_way),
        cmocka_unit_test(failing_to_name_an_object_is_no_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
