/* SPDX-License-Identifier: MIT
 *
 * Effects: exactly the passes that their settings ask for, on a device with the least that Vulkan
 * 1.1 has, and nothing left when any step of the creation fails. */
#include "effect.h"
#include "world.h"

#include <pthread.h>
#include <stdio.h>
#include <string.h>

/* A context of a GPU or of a CPU, and the info of an effect of these stages. */
static void open_for(struct world *w, vkao_stage_flags stages, bool cpu, bool callbacks)
{
    world_init(w, callbacks);
    if (cpu)
        world_be_cpu(w);
    assert_int_equal(vkao_context_create(&w->info, &w->ctx), VKAO_SUCCESS);
    w->effect_info.stages = stages;
    w->effect_info.noisy_ao = VK_FALSE;
    fake_forget_calls(&w->fake);
}

static vkao_result create(struct world *w)
{
    return vkao_effect_create(w->ctx, &w->effect_info, &w->effect);
}

/* The fake device has the required minimum of every limit, and refuses more. */
static void every_effect_stays_within_the_limits_of_vulkan_1_1(void **state)
{
    (void)state;
    for (unsigned i = 0; i < 6 * 7 * 2 * 2 * 2 * 2; ++i) {
        struct world w;
        const bool cpu = i % 2, half = i / 2 % 2, bent = i / 4 % 2, bits = i / 8 % 2;
        world_init(&w, true);
        if (cpu)
            world_be_cpu(&w);
        if (bits)
            w.features.pNext = &w.storage_features;
        assert_int_equal(vkao_context_create(&w.info, &w.ctx), VKAO_SUCCESS);
        w.effect_info.noisy_ao = VK_FALSE;
        w.effect_info.half_resolution = half;
        w.effect_info.method = (vkao_ssao_method)(i / 16 % 6);
        w.effect_info.composite_mode = (vkao_composite_mode)(i / 96);
        w.effect_info.bent_normals = bent && w.effect_info.method > VKAO_SSAO_HBAO;
        if (create(&w) == VKAO_SUCCESS) {
            w.images.ao_noisy = (vkao_image){0};
            w.images.bent_normals = w.bent_normals;
            assert_int_equal(vkao_frame_create(w.effect, &w.frame_info, &w.frame), VKAO_SUCCESS);
            assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
        } else {
            assert_non_null(strstr(w.log.last_error, "composite_mode"));
        }
        world_close(&w);
    }
}

static void stages_compile_their_own_passes_only(void **state)
{
    (void)state;
    /* prepare, ssao, blur, composite; a CPU has tiles too, and two of the blur. */
    static const unsigned passes[VKAO_STAGE_ALL + 1][2] = {{0, 0}, {2, 3}, {2, 3}, {3, 5},
                                                           {1, 1}, {3, 4}, {3, 4}, {4, 6}};
    for (vkao_stage_flags stages = 1; stages <= VKAO_STAGE_ALL; ++stages) {
        for (int cpu = 0; cpu < 2; ++cpu) {
            struct world w;
            open_for(&w, stages, cpu, true);
            assert_int_equal(create(&w), VKAO_SUCCESS);
            assert_int_equal(fake_live_of(&w.fake, VK_OBJECT_TYPE_PIPELINE_LAYOUT),
                             passes[stages][cpu]);
            assert_int_equal(fake_live_of(&w.fake, VK_OBJECT_TYPE_SHADER_MODULE), 0);
            assert_int_equal(fake_count(&w.fake, "vkAllocateMemory"), 0);
            world_close(&w);
        }
    }
}

/* What a pipeline was compiled for. */
static void settings_reach_the_shaders(void **state)
{
    (void)state;
    struct world w;
    open_for(&w, VKAO_STAGE_ALL, false, true);
    w.effect_info.slice_count = 3;
    w.effect_info.step_count = 5;
    w.effect_info.blur_radius = 7;
    w.effect_info.normal_encoding = VKAO_NORMALS_OCT_UNORM;
    w.effect_info.blur_normal_power = 8.0f;
    w.effect_info.falloff = VKAO_FALLOFF_THRESHOLD;
    assert_int_equal(create(&w), VKAO_SUCCESS);
    const float power = 8.0f;
    uint32_t power_bits;
    memcpy(&power_bits, &power, sizeof power_bits);
    const uint32_t wanted[][2] = {
        {VKAO_SETTING_SLICES, 3},      {VKAO_SETTING_STEPS, 5},
        {VKAO_SETTING_BLUR_RADIUS, 7}, {VKAO_SETTING_NORMAL_ENCODING, VKAO_NORMALS_OCT_UNORM},
        {VKAO_SETTING_THRESHOLD, 1},   {VKAO_SETTING_BLUR_NORMAL_POWER, power_bits},
    };
    for (size_t k = 0; k < sizeof wanted / sizeof wanted[0]; ++k) {
        unsigned given = 0;
        for (size_t i = 0; i < w.fake.object_count; ++i) {
            const struct fake_object *o = &w.fake.objects[i];
            if (o->type != VK_OBJECT_TYPE_PIPELINE || !(o->given >> wanted[k][0] & 1u))
                continue;
            ++given;
            assert_int_equal(o->constants[wanted[k][0]], wanted[k][1]);
        }
        assert_true(given > 0);
    }
    /* the last of the blur in two forms */
    assert_int_equal(fake_live_of(&w.fake, VK_OBJECT_TYPE_PIPELINE), 6);
    world_close(&w);
}

/* A driver compiles what two effects want alike once, and keeps it for as long as either lives. */
static void effects_share_what_they_want_alike(void **state)
{
    (void)state;
    for (int cpu = 0; cpu < 2; ++cpu) {
        struct world w;
        vkao_effect *other, *same;
        open_for(&w, VKAO_STAGE_ALL, cpu, true);
        assert_int_equal(create(&w), VKAO_SUCCESS);
        const size_t all = fake_live_of(&w.fake, VK_OBJECT_TYPE_PIPELINE);
        const size_t layouts = fake_live_of(&w.fake, VK_OBJECT_TYPE_PIPELINE_LAYOUT);
        assert_int_equal(vkao_effect_create(w.ctx, &w.effect_info, &same), VKAO_SUCCESS);
        assert_int_equal(fake_live_of(&w.fake, VK_OBJECT_TYPE_PIPELINE), all);
        w.effect_info.composite_mode = VKAO_COMPOSITE_AO_ONLY; /* of the last pass alone */
        assert_int_equal(vkao_effect_create(w.ctx, &w.effect_info, &other), VKAO_SUCCESS);
        assert_int_equal(fake_live_of(&w.fake, VK_OBJECT_TYPE_PIPELINE), all + 1);
        assert_int_equal(fake_live_of(&w.fake, VK_OBJECT_TYPE_PIPELINE_LAYOUT), layouts + 1);
        assert_int_equal(fake_count(&w.fake, "vkCreateComputePipelines"), all + 1);
        vkao_effect_destroy(w.effect);
        assert_int_equal(fake_live_of(&w.fake, VK_OBJECT_TYPE_PIPELINE), all + 1);
        vkao_effect_destroy(same);
        assert_int_equal(fake_live_of(&w.fake, VK_OBJECT_TYPE_PIPELINE), all);
        w.effect = other;
        world_close(&w);
    }
}

struct maker {
    struct world *world;
    vkao_effect *effect;
    vkao_result result;
};

static void *make(void *data)
{
    struct maker *maker = data;
    maker->result =
        vkao_effect_create(maker->world->ctx, &maker->world->effect_info, &maker->effect);
    return NULL;
}

/* Neither waits for what the other compiles: that of one of them goes. */
static void two_threads_compile_the_same(void **state)
{
    (void)state;
    struct world w;
    pthread_barrier_t compiling;
    assert_int_equal(pthread_barrier_init(&compiling, NULL, 2), 0);
    open_for(&w, VKAO_STAGE_ALL, false, true);
    w.fake.compiling = &compiling;
    struct maker makers[2] = {{&w, NULL, VKAO_SUCCESS}, {&w, NULL, VKAO_SUCCESS}};
    pthread_t threads[2];
    for (int i = 0; i < 2; ++i)
        assert_int_equal(pthread_create(&threads[i], NULL, make, &makers[i]), 0);
    for (int i = 0; i < 2; ++i) {
        pthread_join(threads[i], NULL);
        assert_int_equal(makers[i].result, VKAO_SUCCESS);
    }
    w.fake.compiling = NULL;
    pthread_barrier_destroy(&compiling);
    const size_t live = fake_live_of(&w.fake, VK_OBJECT_TYPE_PIPELINE);
    assert_int_equal(fake_count(&w.fake, "vkCreateComputePipelines"), 2 * live);
    vkao_effect_destroy(makers[0].effect);
    assert_int_equal(fake_live_of(&w.fake, VK_OBJECT_TYPE_PIPELINE), live);
    w.effect = makers[1].effect;
    world_close(&w);
}

static void toned_recordings_use_their_own_form(void **state)
{
    (void)state;
    /* A large blur takes a pass for each direction, and a small one does both at once. */
    for (size_t count = 3; count <= 4; ++count) {
        struct world w;
        world_open(&w);
        w.effect_info.stages = VKAO_STAGE_SSAO | VKAO_STAGE_BLUR;
        w.effect_info.blur_radius = count == 3 ? VKAO_BLUR_TILE_RADIUS : VKAO_BLUR_TILE_RADIUS + 1;
        world_create_frame(&w);
        assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
        w.params.intensity = 2.0f;
        assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
        for (size_t i = 0; i < 2 * count; ++i) {
            const struct fake_call *call = fake_nth(&w.fake, "vkCmdDispatch", i);
            const uint32_t *constants = fake_find(&w.fake, call->handle)->constants;
            assert_int_equal(constants[VKAO_SETTING_TONED], i == 2 * count - 1 ? 1 : 0);
            assert_int_equal(constants[VKAO_SETTING_VERTICAL], i % 4 == 3 && count == 4 ? 1 : 0);
        }
        assert_int_equal(fake_count(&w.fake, "vkCmdDispatch"), 2 * count);
        world_close(&w);
    }
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
        {VK_ERROR_UNKNOWN, (vkao_result)(VKAO_ERROR_VULKAN + VK_ERROR_UNKNOWN)},
    };
    for (size_t f = 0; f < COUNT(failures) * 4; ++f) {
        unsigned n = 0;
        for (;;) {
            struct world w;
            open_for(&w, VKAO_STAGE_ALL, f % 2, f / 2 % 2);
            w.fake.fail_at = w.fake.result_calls + ++n;
            w.fake.fail_result = failures[f / 4].vulkan;
            w.effect = (vkao_effect *)&w;
            vkao_result result = create(&w);
            if (!w.fake.failed) {
                assert_int_equal(result, VKAO_SUCCESS);
                world_close(&w);
                break;
            }
            assert_null(w.effect);
            char value[32];
            snprintf(value, sizeof value, "%d", (int)w.fake.fail_result);
            expect_refused(&w, failures[f / 4].vkao, result, w.fake.failed, value);
            world_close(&w);
        }
        assert_true(n > 4 * 4);
    }
}

static void failing_nth_host_allocation_leaks_nothing(void **state)
{
    (void)state;
    unsigned failed = 0;
    for (unsigned n = 1;; ++n) {
        struct world w;
        open_for(&w, VKAO_STAGE_ALL, false, true);
        w.host.fail_at = w.host.total + n;
        vkao_result result = create(&w);
        const bool done = w.host.total < w.host.fail_at;
        assert_int_equal(result, done ? VKAO_SUCCESS : VKAO_ERROR_OUT_OF_HOST_MEMORY);
        world_close(&w);
        if (done)
            break;
        ++failed;
    }
    assert_true(failed > 16);
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
            world_be_cpu(&w);
        if (has_it)
            w.features.pNext = &w.storage_features;
        assert_int_equal(vkao_context_create(&w.info, &w.ctx), VKAO_SUCCESS);
        world_use_scratch_noise(&w);
        world_create_effect(&w);
        int count = 0;
        for (size_t o = 0; o < w.fake.object_count; ++o) {
            if (w.fake.objects[o].type == VK_OBJECT_TYPE_PIPELINE)
                count += stores_16_bits(w.fake.objects[o].code);
        }
        assert_int_equal(count, has_it && cpu ? 1 : 0);
        world_close(&w);
    }
}

static void pipeline_cache_reaches_the_driver(void **state)
{
    (void)state;
    struct world w;
    open_for(&w, VKAO_STAGE_ALL, false, true);
    w.effect_info.pipeline_cache = (VkPipelineCache)(uintptr_t)0x1234;
    assert_int_equal(create(&w), VKAO_SUCCESS);
    for (size_t i = 0; i < 5; ++i)
        assert_true(fake_nth(&w.fake, "vkCreateComputePipelines", i)->cache ==
                    w.effect_info.pipeline_cache);
    assert_true(settings_of(w.effect).pipeline_cache == VK_NULL_HANDLE);
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
        world_create_effect(&w);
        assert_int_equal(fake_count(&w.fake, "vkSetDebugUtilsObjectNameEXT"),
                         present && wanted ? 5 : 0);
        world_close(&w);
    }
}

static void combinations_that_make_no_sense_are_refused_and_named(void **state)
{
    (void)state;
    static const struct {
        vkao_stage_flags stages;
        size_t offset;
        uint32_t value;
        const char *name, *said;
    } rows[] = {
        {VKAO_STAGE_SSAO, offsetof(vkao_effect_info, half_resolution), 1, "half_resolution",
         "stages is 0x1 (SSAO)"},
        {VKAO_STAGE_BLUR, offsetof(vkao_effect_info, half_resolution), 1, "half_resolution",
         "want"},
        {VKAO_STAGE_SSAO, offsetof(vkao_effect_info, noisy_ao), 1, "noisy_ao", "want"},
        {VKAO_STAGE_BLUR, offsetof(vkao_effect_info, bent_normals), 1, "bent_normals", "want"},
        {VKAO_STAGE_COMPOSITE, offsetof(vkao_effect_info, composite_mode), VKAO_COMPOSITE_VIEW_Z,
         "composite_mode", "is 6 (view-z), want"},
        {VKAO_STAGE_ALL, offsetof(vkao_effect_info, composite_mode), VKAO_COMPOSITE_BENT_NORMALS,
         "composite_mode", "is 5 (bent-normals), want"},
        {VKAO_STAGE_ALL, offsetof(vkao_effect_info, specular), VKAO_SPECULAR_FROM_AO, "specular",
         "want"},
        {VKAO_STAGE_ALL, offsetof(vkao_effect_info, specular), VKAO_SPECULAR_FROM_BENT, "specular",
         "want"},
        {VKAO_STAGE_ALL, offsetof(vkao_effect_info, depth_bits), 17, "depth_bits", "want"},
        {VKAO_STAGE_ALL, offsetof(vkao_effect_info, ao_format), VK_FORMAT_R8G8B8A8_UNORM,
         "ao_format", "want"},
        {0, offsetof(vkao_effect_info, noisy_ao), 0, "stages", "want"},
        {8, offsetof(vkao_effect_info, noisy_ao), 0, "stages",
         "is 0x8 (PREPARE), want bits of 0x7 (SSAO | BLUR | COMPOSITE)"},
    };
    for (size_t i = 0; i < COUNT(rows); ++i) {
        struct world w;
        open_for(&w, rows[i].stages, false, true);
        memcpy((char *)&w.effect_info + rows[i].offset, &rows[i].value, sizeof rows[i].value);
        expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT, create(&w), rows[i].name, rows[i].said);
        assert_null(w.effect);
        world_close(&w);
    }
}

/* What views of the same settings come and go with is there without a word. */
static void settings_that_are_not_used_are_said(void **state)
{
    (void)state;
    static const struct {
        vkao_stage_flags stages;
        uint32_t depth_bits;
        vkao_depth_encoding encoding;
        vkao_specular specular;
        vkao_composite_mode mode;
        const char *said; /* NULL: nothing */
    } rows[] = {
        {VKAO_STAGE_ALL, 24, VKAO_DEPTH_VIEW_Z, VKAO_SPECULAR_NONE, VKAO_COMPOSITE_MULTIPLY,
         "effect.depth_bits is 24, but not used: effect.depth_encoding is 1 (z)"},
        {VKAO_STAGE_SSAO, 16, VKAO_DEPTH_INVERSE_Z, VKAO_SPECULAR_NONE, VKAO_COMPOSITE_MULTIPLY,
         "effect.depth_bits is 16, but not used: effect.depth_encoding is 3 (inverse-z)"},
        {VKAO_STAGE_ALL, 24, VKAO_DEPTH_PROJECTED, VKAO_SPECULAR_NONE, VKAO_COMPOSITE_MULTIPLY,
         NULL},
        {VKAO_STAGE_COMPOSITE, 24, VKAO_DEPTH_VIEW_Z, VKAO_SPECULAR_NONE, VKAO_COMPOSITE_MULTIPLY,
         NULL},
        {VKAO_STAGE_ALL, 0, VKAO_DEPTH_VIEW_Z, VKAO_SPECULAR_FROM_AO, VKAO_COMPOSITE_AO_ONLY,
         "effect.specular is 1 (from-ao), but not used: effect.composite_mode is 2 (ao-only)"},
        {VKAO_STAGE_ALL, 0, VKAO_DEPTH_VIEW_Z, VKAO_SPECULAR_FROM_AO, VKAO_COMPOSITE_INDIRECT,
         NULL},
        {VKAO_STAGE_ALL, 0, VKAO_DEPTH_VIEW_Z, VKAO_SPECULAR_FROM_AO, VKAO_COMPOSITE_NORMALS, NULL},
        {VKAO_STAGE_SSAO, 0, VKAO_DEPTH_VIEW_Z, VKAO_SPECULAR_FROM_AO, VKAO_COMPOSITE_AO_ONLY,
         NULL},
    };
    for (size_t i = 0; i < COUNT(rows); ++i) {
        struct world w;
        open_for(&w, rows[i].stages, false, true);
        w.effect_info.depth_bits = rows[i].depth_bits;
        w.effect_info.depth_encoding = rows[i].encoding;
        w.effect_info.normal_encoding = VKAO_NORMALS_XYZ_SNORM;
        w.effect_info.specular = rows[i].specular;
        w.effect_info.composite_mode = rows[i].mode;
        world_forget_log(&w);
        assert_int_equal(create(&w), VKAO_SUCCESS);
        assert_int_equal(w.log.lines, rows[i].said ? 1 : 0);
        if (rows[i].said) {
            assert_int_equal(w.log.last_level, VKAO_LOG_WARNING);
            assert_string_equal(w.log.last, rows[i].said);
        }
        world_close(&w);
    }
}

static void every_required_null_is_refused(void **state)
{
    (void)state;
    struct world w;
    world_open(&w);
    assert_int_equal(vkao_effect_create(NULL, &w.effect_info, &w.effect),
                     VKAO_ERROR_INVALID_ARGUMENT);
    expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT, vkao_effect_create(w.ctx, NULL, &w.effect),
                   "vkao_effect_create", "info is NULL");
    expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT, vkao_effect_create(w.ctx, &w.effect_info, NULL),
                   "vkao_effect_create", "out is NULL");
    vkao_effect_destroy(NULL);
    world_close(&w);
}

/* Frames would be left with passes that are gone. */
static void effect_with_living_frames_stays(void **state)
{
    (void)state;
    struct world w;
    world_open_frame(&w, VKAO_STAGE_ALL);
    vkao_effect_destroy(w.effect);
    assert_int_equal(w.log.errors, 1);
    assert_non_null(strstr(w.log.last_error, "vkao_effect_destroy: 1 frames"));
    assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
    world_close(&w); /* the frame, then the effect, which goes now */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_effect_stays_within_the_limits_of_vulkan_1_1),
        cmocka_unit_test(stages_compile_their_own_passes_only),
        cmocka_unit_test(settings_reach_the_shaders),
        cmocka_unit_test(effects_share_what_they_want_alike),
        cmocka_unit_test(two_threads_compile_the_same),
        cmocka_unit_test(toned_recordings_use_their_own_form),
        cmocka_unit_test(failing_nth_call_leaks_nothing),
        cmocka_unit_test(failing_nth_host_allocation_leaks_nothing),
        cmocka_unit_test(only_devices_that_store_16_bits_are_asked_to),
        cmocka_unit_test(pipeline_cache_reaches_the_driver),
        cmocka_unit_test(debug_labels_are_optional_in_every_way),
        cmocka_unit_test(combinations_that_make_no_sense_are_refused_and_named),
        cmocka_unit_test(settings_that_are_not_used_are_said),
        cmocka_unit_test(every_required_null_is_refused),
        cmocka_unit_test(effect_with_living_frames_stays),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
