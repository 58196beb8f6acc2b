/* SPDX-License-Identifier: MIT
 *
 * Frames: scratch memory, what creation refuses, and what is left when any step of it fails. */
#include "passes.h"
#include "world.h"

#include <stdio.h>
#include <string.h>

/* Optional slots unused, so that the frame needs all the scratch it can. */
static void use_most_scratch(struct world *w)
{
    w->images.normals = (vkao_image){0};
    w->effect_info.noisy_ao = VK_FALSE;
    if ((w->effect_info.stages & VKAO_STAGE_SSAO) && (w->effect_info.stages & VKAO_STAGE_BLUR))
        w->images.ao_noisy = (vkao_image){0};
    if ((w->effect_info.stages & VKAO_STAGE_COMPOSITE) &&
        w->effect_info.stages != VKAO_STAGE_COMPOSITE)
        w->images.ao = (vkao_image){0};
}

static void open_for(struct world *w, vkao_stage_flags stages, bool callbacks)
{
    world_init(w, callbacks);
    assert_int_equal(vkao_context_create(&w->info, &w->ctx), VKAO_SUCCESS);
    w->effect_info.stages = stages;
    use_most_scratch(w);
    world_create_effect(w);
    fake_forget_calls(&w->fake);
}

static void destroying_returns_everything(void **state)
{
    (void)state;
    for (unsigned i = 0; i < 14; ++i) {
        struct world w;
        open_for(&w, i / 2 + 1, i % 2);
        size_t before = fake_live(&w.fake);
        assert_int_equal(vkao_frame_create(w.effect, &w.frame_info, &w.frame), VKAO_SUCCESS);
        assert_true(fake_live(&w.fake) > before);
        vkao_frame_destroy(w.frame);
        w.frame = NULL;
        assert_int_equal(fake_live(&w.fake), before);
        world_close(&w);
    }
}

static void destroy_ignores_null(void **state)
{
    (void)state;
    vkao_frame_destroy(NULL);
}

/* Fails each call of one creation in turn; returns how many there were. */
static unsigned fail_each_call(vkao_stage_flags stages, bool callbacks, bool callers_memory,
                               VkResult failure, vkao_result want)
{
    for (unsigned n = 1;; ++n) {
        struct world w;
        open_for(&w, stages, callbacks);
        if (callers_memory)
            w.frame_info.scratch_memory = fake_caller_memory(&w.fake);
        size_t before = fake_live(&w.fake);
        w.fake.fail_at = w.fake.result_calls + n;
        w.fake.fail_result = failure;
        w.frame = (vkao_frame *)&w;
        vkao_result result = vkao_frame_create(w.effect, &w.frame_info, &w.frame);
        if (!w.fake.failed) {
            assert_int_equal(result, VKAO_SUCCESS);
            world_close(&w);
            return n - 1;
        }
        assert_null(w.frame);
        assert_int_equal(fake_live(&w.fake), before);
        char value[32];
        snprintf(value, sizeof value, "%d", (int)failure);
        expect_refused(&w, want, result, w.fake.failed, value);
        world_close(&w);
    }
}

static void failing_nth_call_leaks_nothing(void **state)
{
    (void)state;
    static const struct {
        VkResult vulkan;
        vkao_result want;
    } failures[] = {
        {VK_ERROR_OUT_OF_HOST_MEMORY, VKAO_ERROR_OUT_OF_HOST_MEMORY},
        {VK_ERROR_OUT_OF_DEVICE_MEMORY, VKAO_ERROR_OUT_OF_DEVICE_MEMORY},
        {VK_ERROR_DEVICE_LOST, (vkao_result)(VKAO_ERROR_VULKAN + VK_ERROR_DEVICE_LOST)},
    };
    for (size_t f = 0; f < COUNT(failures); ++f) {
        for (vkao_stage_flags stages = 1; stages <= VKAO_STAGE_ALL; ++stages) {
            unsigned owned =
                fail_each_call(stages, true, false, failures[f].vulkan, failures[f].want);
            unsigned plain =
                fail_each_call(stages, false, false, failures[f].vulkan, failures[f].want);
            unsigned lent =
                fail_each_call(stages, true, true, failures[f].vulkan, failures[f].want);
            assert_int_equal(owned, plain);
            /* The one allocation is all that lent memory saves. */
            assert_int_equal(owned - lent, 1);
        }
    }
}

static void failing_nth_host_allocation_leaks_nothing(void **state)
{
    (void)state;
    unsigned failed = 0;
    for (unsigned n = 1;; ++n) {
        struct world w;
        open_for(&w, VKAO_STAGE_ALL, true);
        w.host.fail_at = w.host.total + n;
        vkao_result result = vkao_frame_create(w.effect, &w.frame_info, &w.frame);
        bool done = w.host.total < w.host.fail_at;
        assert_int_equal(result, done ? VKAO_SUCCESS : VKAO_ERROR_OUT_OF_HOST_MEMORY);
        assert_int_equal(w.log.errors, done ? 0 : 1);
        assert_true(done == (w.frame != NULL));
        world_close(&w);
        if (done)
            break;
        ++failed;
    }
    assert_true(failed >= 8);

    struct world w;
    open_for(&w, VKAO_STAGE_ALL, false);
    host_calloc.fail_at = host_calloc.total + 1;
    expect_refused(&w, VKAO_ERROR_OUT_OF_HOST_MEMORY,
                   vkao_frame_create(w.effect, &w.frame_info, &w.frame), "frame", "memory");
    world_close(&w);
}

static void scratch_images_are_those_the_stages_need(void **state)
{
    (void)state;
    /* view z; noisy AO between ssao and blur; AO before composite */
    static const struct {
        size_t most, least; /* without and with the caller's ao_noisy and ao */
    } want[VKAO_STAGE_ALL + 1] = {{0, 0}, {1, 1}, {1, 1}, {2, 1}, {0, 0}, {2, 1}, {2, 1}, {3, 1}};
    for (vkao_stage_flags stages = 1; stages <= VKAO_STAGE_ALL; ++stages) {
        struct world w;
        open_for(&w, stages, true);
        assert_int_equal(vkao_frame_create(w.effect, &w.frame_info, &w.frame), VKAO_SUCCESS);
        assert_int_equal(fake_live_of(&w.fake, VK_OBJECT_TYPE_IMAGE), want[stages].most);
        assert_int_equal(fake_count(&w.fake, "vkAllocateMemory"), 1);
        for (size_t i = 0; i < want[stages].most; ++i) {
            const VkImageCreateInfo *image = &fake_nth(&w.fake, "vkCreateImage", i)->image;
            /* View z has a border, a texel in each of four blocks of columns. */
            const bool is_view_z = image->extent.width > 100;
            assert_int_equal(image->extent.width, is_view_z ? 108 : 100);
            assert_int_equal(image->extent.height, is_view_z ? 62 : 60);
            assert_int_equal(image->usage, VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT);
        }
        world_close(&w);
        world_open_frame(&w, stages);
        assert_int_equal(fake_live_of(&w.fake, VK_OBJECT_TYPE_IMAGE), want[stages].least);
        world_close(&w);
    }
}

static void scratch_query_is_the_one_allocation(void **state)
{
    (void)state;
    for (vkao_stage_flags stages = 1; stages <= VKAO_STAGE_ALL; ++stages) {
        struct world w;
        open_for(&w, stages, true);
        w.frame_info.extent = (VkExtent2D){37, 23}; /* sizes that need alignment */
        vkao_images without_views = w.images;
        for (size_t i = 0; i < SLOT_COUNT; ++i) {
            world_slot(&without_views, i)->view = VK_NULL_HANDLE;
            world_slot(&without_views, i)->layout = VK_IMAGE_LAYOUT_UNDEFINED;
        }
        w.frame_info.images = &without_views;
        size_t before = fake_live(&w.fake);
        VkMemoryRequirements query;
        assert_int_equal(vkao_frame_scratch(w.effect, &w.frame_info, &query), VKAO_SUCCESS);
        assert_int_equal(fake_live(&w.fake), before);
        assert_int_equal(fake_count(&w.fake, "vkAllocate"), 0);
        assert_int_equal(fake_count(&w.fake, "vkBind"), 0);
        w.frame_info.images = &w.images;
        assert_int_equal(vkao_frame_create(w.effect, &w.frame_info, &w.frame), VKAO_SUCCESS);
        const struct fake_call *allocation = fake_nth(&w.fake, "vkAllocateMemory", 0);
        assert_null(fake_nth(&w.fake, "vkAllocateMemory", 1));
        assert_int_equal(query.size, allocation ? allocation->size : 0);
        if (allocation) {
            assert_int_equal(query.alignment, 256);
            assert_true(query.memoryTypeBits >> allocation->memory_type & 1u);
            assert_true(w.fake.memory.memoryTypes[allocation->memory_type].propertyFlags &
                        VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
        }
        world_close(&w);
    }
}

static void scratch_query_leaks_nothing_when_a_call_fails(void **state)
{
    (void)state;
    for (unsigned n = 1; n <= 4; ++n) {
        struct world w;
        open_for(&w, VKAO_STAGE_ALL, true);
        size_t before = fake_live(&w.fake);
        w.fake.fail_at = w.fake.result_calls + n;
        VkMemoryRequirements out = {77, 77, 77};
        expect_refused(&w, (vkao_result)(VKAO_ERROR_VULKAN - 4),
                       vkao_frame_scratch(w.effect, &w.frame_info, &out),
                       n == 1 ? "vkCreateBuffer" : "vkCreateImage", "-4");
        assert_int_equal(out.size, 77);
        assert_int_equal(fake_live(&w.fake), before);
        world_close(&w);
    }
}

/* Noisy AO is read for the last time, by the first direction of a large blur, before AO for the
 * composite is written. */
static void scratch_whose_lifetimes_meet_does_not_overlap(void **state)
{
    (void)state;
    struct world w;
    open_for(&w, VKAO_STAGE_ALL, true);
    w.effect_info.blur_radius = VKAO_BLUR_TILE_RADIUS + 1;
    world_create_effect(&w);
    fake_forget_calls(&w.fake);
    assert_int_equal(vkao_frame_create(w.effect, &w.frame_info, &w.frame), VKAO_SUCCESS);
    VkDeviceSize begins[4], ends[4];
    size_t shared = 0;
    for (size_t i = 0; i < 4; ++i) {
        const struct fake_call *bind = fake_nth(&w.fake, "vkBindImageMemory", i);
        const VkImageCreateInfo *image = &fake_find(&w.fake, bind->handle)->image;
        begins[i] = bind->offset;
        ends[i] = bind->offset + image->extent.width * image->extent.height *
                                     (image->format == VK_FORMAT_R8_UNORM     ? 1u
                                      : image->format == VK_FORMAT_R16_SFLOAT ? 2u
                                                                              : 4u);
        assert_true(ends[i] <= fake_nth(&w.fake, "vkAllocateMemory", 0)->size);
        for (size_t k = 0; k < i; ++k)
            shared += begins[i] < ends[k] && begins[k] < ends[i];
    }
    assert_int_equal(shared, 1);
    world_close(&w);
}

static void callers_scratch_is_used_at_its_offset_and_not_freed(void **state)
{
    (void)state;
    struct world w;
    open_for(&w, VKAO_STAGE_ALL, true);
    w.frame_info.scratch_memory = fake_caller_memory(&w.fake);
    w.frame_info.scratch_offset = 256 * 5;
    assert_int_equal(vkao_frame_create(w.effect, &w.frame_info, &w.frame), VKAO_SUCCESS);
    assert_int_equal(fake_count(&w.fake, "vkAllocateMemory"), 0);
    assert_int_equal(fake_count(&w.fake, "vkBindImageMemory"), 3);
    for (size_t i = 0; i < 3; ++i) {
        const struct fake_call *bind = fake_nth(&w.fake, "vkBindImageMemory", i);
        assert_int_equal(bind->memory, (uint64_t)w.frame_info.scratch_memory);
        assert_true(bind->offset >= 256 * 5);
    }
    vkao_frame_destroy(w.frame);
    w.frame = NULL;
    assert_int_equal(fake_count(&w.fake, "vkFreeMemory"), 0);
    world_close(&w);
}

static void misaligned_scratch_offset_is_refused(void **state)
{
    (void)state;
    static const struct {
        VkDeviceSize offset;
        const char *value;
    } cases[] = {{1, " 1,"}, {255, " 255,"}, {300, " 300,"}};
    for (size_t i = 0; i < COUNT(cases); ++i) {
        struct world w;
        open_for(&w, VKAO_STAGE_ALL, true);
        w.frame_info.scratch_memory = fake_caller_memory(&w.fake);
        w.frame_info.scratch_offset = cases[i].offset;
        size_t before = fake_live(&w.fake);
        vkao_result result = vkao_frame_create(w.effect, &w.frame_info, &w.frame);
        assert_null(w.frame);
        assert_int_equal(fake_live(&w.fake), before);
        assert_int_equal(fake_count(&w.fake, "vkBind"), 0);
        expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT, result, "frame.scratch_offset",
                       cases[i].value);
        world_close(&w);
    }
}

/* Memory that was forgotten. */
static void scratch_offset_without_memory_is_refused(void **state)
{
    (void)state;
    struct world w;
    open_for(&w, VKAO_STAGE_ALL, true);
    w.frame_info.scratch_offset = 256;
    size_t before = fake_live(&w.fake);
    expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT,
                   vkao_frame_create(w.effect, &w.frame_info, &w.frame), "frame.scratch_offset",
                   " 256, want 0 without scratch_memory");
    assert_null(w.frame);
    assert_int_equal(fake_live(&w.fake), before);
    world_close(&w);
}

static void memory_is_device_local_or_unsupported(void **state)
{
    (void)state;
    static const struct {
        uint32_t bits;
        uint32_t type; /* UINT32_MAX = none */
    } cases[] = {{0x7, 1}, {0x6, 1}, {0x5, 2}, {0x1, UINT32_MAX}, {0x8, UINT32_MAX}};
    for (size_t i = 0; i < COUNT(cases); ++i) {
        struct world w;
        open_for(&w, VKAO_STAGE_ALL, true);
        w.fake.image_type_bits = cases[i].bits;
        vkao_result result = vkao_frame_create(w.effect, &w.frame_info, &w.frame);
        if (cases[i].type == UINT32_MAX) {
            assert_null(w.frame);
            expect_refused(&w, VKAO_ERROR_UNSUPPORTED, result, "DEVICE_LOCAL", "0x");
        } else {
            assert_int_equal(result, VKAO_SUCCESS);
            assert_int_equal(fake_nth(&w.fake, "vkAllocateMemory", 0)->memory_type, cases[i].type);
        }
        world_close(&w);
    }
}

/* Noisy AO, and AO before the composite. */
static void scratch_falls_back_to_formats_that_can_be_stored(void **state)
{
    (void)state;
    static const VkFormat want[4][2] = {
        {VK_FORMAT_R8_UNORM, VK_FORMAT_R16_SFLOAT},
        {VK_FORMAT_R16_SFLOAT, VK_FORMAT_R16_SFLOAT},
        {VK_FORMAT_R8_UNORM, VK_FORMAT_R32_SFLOAT},
        {VK_FORMAT_R32_SFLOAT, VK_FORMAT_R32_SFLOAT},
    };
    for (size_t lacking = 0; lacking < 4; ++lacking) {
        struct world w;
        size_t seen = 0;
        world_init(&w, true);
        for (int i = 0; i < 2; ++i) {
            if (lacking >> i & 1)
                fake_limit_format(&w.fake, i ? VK_FORMAT_R16_SFLOAT : VK_FORMAT_R8_UNORM,
                                  VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT, 0);
        }
        assert_int_equal(vkao_context_create(&w.info, &w.ctx), VKAO_SUCCESS);
        use_most_scratch(&w);
        world_create_effect(&w);
        fake_forget_calls(&w.fake);
        assert_int_equal(vkao_frame_create(w.effect, &w.frame_info, &w.frame), VKAO_SUCCESS);
        for (size_t i = 0; i < 3; ++i) {
            const VkImageCreateInfo *image = &fake_nth(&w.fake, "vkCreateImage", i)->image;
            if (image->extent.width > 100)
                continue; /* view z */
            seen |= (size_t)(image->format == want[lacking][0]) |
                    (size_t)(image->format == want[lacking][1]) << 1;
            assert_true(image->format == want[lacking][0] || image->format == want[lacking][1]);
        }
        assert_int_equal(seen, 3);
        world_close(&w);
    }
}

static void extent_is_checked_against_the_device(void **state)
{
    (void)state;
    static const struct {
        uint32_t limit, width, height;
        vkao_result want;
        const char *value;
    } cases[] = {
        {4096, 0, 60, VKAO_ERROR_INVALID_ARGUMENT, "0x60"},
        {4096, 60, 0, VKAO_ERROR_INVALID_ARGUMENT, "60x0"},
        {4096, 0, 0, VKAO_ERROR_INVALID_ARGUMENT, "0x0"},
        {4096, 1, 1, VKAO_SUCCESS, NULL},
        /* view z has a border */
        {4096, 4088, 4094, VKAO_SUCCESS, NULL},
        {4096, 4089, 1, VKAO_ERROR_UNSUPPORTED, "4089x1"},
        {4096, 1, 4095, VKAO_ERROR_UNSUPPORTED, "1x4095"},
        {4096, 4097, 1, VKAO_ERROR_UNSUPPORTED, "4097x1"},
        {4096, 1, 4097, VKAO_ERROR_UNSUPPORTED, "1x4097"},
        {4096, UINT32_MAX, UINT32_MAX, VKAO_ERROR_UNSUPPORTED, "4294967295x4294967295"},
        {100000, 65535, 1, VKAO_SUCCESS, NULL},
        {100000, 65536, 1, VKAO_ERROR_UNSUPPORTED, "65535"}, /* coordinates are packed to 16 bits */
    };
    for (size_t i = 0; i < COUNT(cases); ++i) {
        struct world w;
        world_init(&w, true);
        w.fake.max_dimension = cases[i].limit;
        assert_int_equal(vkao_context_create(&w.info, &w.ctx), VKAO_SUCCESS);
        world_create_effect(&w);
        fake_forget_calls(&w.fake);
        w.frame_info.extent = (VkExtent2D){cases[i].width, cases[i].height};
        vkao_result result = vkao_frame_create(w.effect, &w.frame_info, &w.frame);
        VkMemoryRequirements query;
        if (cases[i].want == VKAO_SUCCESS) {
            assert_int_equal(result, VKAO_SUCCESS);
        } else {
            expect_refused(&w, cases[i].want, result, "frame.extent", cases[i].value);
            assert_null(w.frame);
            expect_refused(&w, cases[i].want, vkao_frame_scratch(w.effect, &w.frame_info, &query),
                           "frame.extent", cases[i].value);
            assert_int_equal(fake_count(&w.fake, "vkCreate"), 0);
        }
        world_close(&w);
    }
}

static void every_required_null_is_refused_and_named(void **state)
{
    (void)state;
    struct world w;
    world_open(&w);
    world_create_effect(&w);
    fake_forget_calls(&w.fake);
    VkMemoryRequirements query;
    const vkao_result invalid = VKAO_ERROR_INVALID_ARGUMENT;
    w.frame = (vkao_frame *)&w;
    assert_int_equal(vkao_frame_create(NULL, &w.frame_info, &w.frame),
                     invalid); /* no log to name it in */
    assert_null(w.frame);
    assert_int_equal(vkao_frame_create(NULL, NULL, NULL), invalid);
    assert_int_equal(vkao_frame_scratch(NULL, &w.frame_info, &query), invalid);
    assert_int_equal(vkao_frame_update(NULL, &w.images), invalid);
    w.frame = (vkao_frame *)&w;
    expect_refused(&w, invalid, vkao_frame_create(w.effect, NULL, &w.frame), "vkao_frame_create",
                   "info is NULL");
    assert_null(w.frame);
    expect_refused(&w, invalid, vkao_frame_scratch(w.effect, NULL, &query), "vkao_frame_scratch",
                   "info is NULL");
    w.frame_info.images = NULL;
    expect_refused(&w, invalid, vkao_frame_create(w.effect, &w.frame_info, &w.frame),
                   "frame.images", "NULL");
    expect_refused(&w, invalid, vkao_frame_scratch(w.effect, &w.frame_info, &query), "frame.images",
                   "NULL");
    w.frame_info.images = &w.images;
    expect_refused(&w, invalid, vkao_frame_create(w.effect, &w.frame_info, NULL), "out", "NULL");
    expect_refused(&w, invalid, vkao_frame_scratch(w.effect, &w.frame_info, NULL), "out", "NULL");
    assert_int_equal(fake_count(&w.fake, "vkCreate"), 0);
    world_close(&w);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(destroying_returns_everything),
        cmocka_unit_test(destroy_ignores_null),
        cmocka_unit_test(failing_nth_call_leaks_nothing),
        cmocka_unit_test(failing_nth_host_allocation_leaks_nothing),
        cmocka_unit_test(scratch_images_are_those_the_stages_need),
        cmocka_unit_test(scratch_query_is_the_one_allocation),
        cmocka_unit_test(scratch_query_leaks_nothing_when_a_call_fails),
        cmocka_unit_test(scratch_whose_lifetimes_meet_does_not_overlap),
        cmocka_unit_test(callers_scratch_is_used_at_its_offset_and_not_freed),
        cmocka_unit_test(misaligned_scratch_offset_is_refused),
        cmocka_unit_test(scratch_offset_without_memory_is_refused),
        cmocka_unit_test(memory_is_device_local_or_unsupported),
        cmocka_unit_test(scratch_falls_back_to_formats_that_can_be_stored),
        cmocka_unit_test(extent_is_checked_against_the_device),
        cmocka_unit_test(every_required_null_is_refused_and_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
