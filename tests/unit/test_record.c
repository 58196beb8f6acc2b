/* SPDX-License-Identifier: MIT
 *
 * What recording leaves in the command buffer: barriers, dispatches, push constants, and nothing
 * else. */
#include "pipelines.h"
#include "world.h"

#include <string.h>

#define BIT(name) (1u << VKAO_BINDING_##name)

/* What each pipeline does with each binding, as its shader declares it; SSAO stands for every
 * method. */
static const struct use {
    uint32_t reads, writes;
} uses[PIPELINE_SSAO + 1] = {
    [PIPELINE_PREPARE] = {BIT(DEPTH), BIT(VIEW_Z)},
    [PIPELINE_BLUR_X] = {BIT(VIEW_Z) | BIT(NORMALS) | BIT(NOISY_READ), BIT(HALFWAY_WRITE)},
    [PIPELINE_BLUR_Y] = {BIT(VIEW_Z) | BIT(NORMALS) | BIT(HALFWAY_READ), BIT(AO_WRITE)},
    [PIPELINE_UPSAMPLE] = {BIT(DEPTH) | BIT(VIEW_Z) | BIT(NORMALS) | BIT(NOISY_READ),
                           BIT(AO_WRITE)},
    [PIPELINE_COMPOSITE] = {BIT(AO_READ) | BIT(COLOR) | BIT(DIRECT) | BIT(ALBEDO) | BIT(SPECULAR) |
                                BIT(NORMALS) | BIT(BENT_READ),
                            BIT(OUTPUT)},
    [PIPELINE_DEBUG] = {BIT(VIEW_Z) | BIT(NORMALS) | BIT(NOISY_READ) | BIT(BENT_READ), BIT(OUTPUT)},
    [PIPELINE_SSAO] = {BIT(VIEW_Z) | BIT(NORMALS), BIT(NOISY_WRITE)},
};

/* With bent normals the stage that writes AO writes them too; at half resolution the blur ends
 * where it began. */
static struct use use_of(const struct world *w, uint64_t pipeline)
{
    const bool bent = w->frame_info.images->bent_normals.format;
    const struct pipeline_entry *entry = entry_of(w->ctx, pipeline);
    if (!entry || !entry_is_general(entry))
        fail_msg("dispatch without a general pipeline of the context");
    struct use use = uses[entry->which < PIPELINE_SSAO ? entry->which : PIPELINE_SSAO];
    if (entry->which == PIPELINE_BLUR_Y && w->frame_info.half_resolution)
        use.writes = BIT(NOISY_WRITE);
    if (entry->bent && (use.writes & BIT(AO_WRITE)))
        use.writes |= BIT(BENT_WRITE);
    const bool has_both = general_entry(w->ctx, entry->which, true);
    assert_int_equal(entry->bent, has_both && bent && (w->frame_info.stages & VKAO_STAGE_BLUR));
    return use;
}

struct views {
    uint64_t list[64];
    size_t count;
};

static bool holds(const struct views *v, uint64_t view)
{
    for (size_t i = 0; i < v->count; ++i) {
        if (v->list[i] == view)
            return true;
    }
    return false;
}

/* Accesses that no barrier has followed yet, as synchronization validation keeps them. */
static void check_dispatch(const struct world *w, const struct fake_call *dispatch, uint64_t set,
                           struct views *read, struct views *written)
{
    const struct use use = use_of(w, dispatch->handle);
    const struct fake_object *object = fake_find(&w->fake, set);
    assert_non_null(object);
    for (uint32_t binding = 0; binding < VKAO_BINDING_COUNT; ++binding) {
        const uint64_t view = object->views[binding];
        if (((use.reads | use.writes) >> binding & 1u) && !view)
            fail_msg("a pipeline uses binding %u, which holds nothing", binding);
        if ((use.reads >> binding & 1u) && holds(written, view))
            fail_msg("a pipeline reads binding %u: no barrier after its producer", binding);
        if ((use.writes >> binding & 1u) && (holds(written, view) || holds(read, view)))
            fail_msg("a pipeline writes binding %u: no barrier after its last use", binding);
    }
    for (uint32_t binding = 0; binding < VKAO_BINDING_COUNT; ++binding) {
        if (use.reads >> binding & 1u)
            read->list[read->count++] = object->views[binding];
        if (use.writes >> binding & 1u)
            written->list[written->count++] = object->views[binding];
    }
}

static void check_barrier(const struct fake_call *call)
{
    assert_int_equal(call->src_stages, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT);
    assert_int_equal(call->dst_stages, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT);
    assert_int_equal(call->memory_barrier_count, 1);
    assert_true(call->memory_barrier.srcAccessMask & VK_ACCESS_SHADER_WRITE_BIT);
    assert_int_equal(call->memory_barrier.dstAccessMask,
                     VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT);
}

/* Walks all that was recorded; returns the number of dispatches. */
static unsigned check_recording(const struct world *w)
{
    struct views read = {0}, written = {0};
    unsigned dispatches = 0;
    uint64_t set = 0;
    for (size_t i = 0; i < w->fake.call_count; ++i) {
        const struct fake_call *call = &w->fake.calls[i];
        if (strcmp(call->name, "vkCmdPipelineBarrier") == 0) {
            check_barrier(call);
            read.count = written.count = 0;
        }
        if (strcmp(call->name, "vkCmdBindDescriptorSets") == 0)
            set = call->handle;
        if (strcmp(call->name, "vkCmdDispatch") == 0) {
            check_dispatch(w, call, set, &read, &written);
            ++dispatches;
        }
    }
    return dispatches;
}

/* As world_open_frame, but with scratch wherever the caller may leave a slot unused. */
static void open_with_scratch(struct world *w, vkao_stage_flags stages)
{
    world_open(w);
    w->frame_info.stages = stages;
    if ((stages & VKAO_STAGE_SSAO) && (stages & VKAO_STAGE_BLUR))
        w->images.ao_noisy = (vkao_image){0};
    if ((stages & VKAO_STAGE_COMPOSITE) && stages != VKAO_STAGE_COMPOSITE)
        w->images.ao = (vkao_image){0};
    assert_int_equal(vkao_frame_create(w->ctx, &w->frame_info, &w->frame), VKAO_SUCCESS);
    fake_forget_calls(&w->fake);
}

static void barrier_stands_between_producer_and_consumer(void **state)
{
    (void)state;
    static const unsigned dispatches[VKAO_STAGE_ALL + 1] = {0, 2, 3, 4, 1, 3, 4, 5};
    for (vkao_stage_flags stages = 1; stages <= VKAO_STAGE_ALL; ++stages) {
        for (int scratch = 0; scratch < 2; ++scratch) {
            struct world w;
            if (scratch)
                open_with_scratch(&w, stages);
            else
                world_open_frame(&w, stages);
            assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
            assert_int_equal(check_recording(&w), dispatches[stages]);
            assert_int_equal(world_record_all(&w),
                             VKAO_SUCCESS); /* again at once: as across submits */
            assert_int_equal(check_recording(&w), 2 * dispatches[stages]);
            world_close(&w);
        }
    }
}

/* What ran before in another submit is unknown: the first command of every call waits for it. */
/* Half resolution with and without bent normals, and the composites that read more. */
static void barriers_stand_in_every_kind_of_frame(void **state)
{
    (void)state;
    for (int i = 0; i < 2 * 2 * 2 * 7; ++i) {
        const bool half = i & 1, bent = i & 2, scratch = i & 4;
        struct world w;
        world_open(&w);
        w.images.ao_noisy = (vkao_image){0};
        if (scratch)
            w.images.ao = (vkao_image){0};
        if (bent)
            world_use_bent_normals(&w);
        w.frame_info.half_resolution = half;
        w.composite.mode = (vkao_composite_mode)(i / 8);
        if (w.composite.mode < VKAO_COMPOSITE_AO_ONLY) {
            w.composite.multi_bounce = VK_TRUE;
            w.composite.specular = bent ? VKAO_SPECULAR_FROM_BENT : VKAO_SPECULAR_FROM_AO;
        }
        if ((w.composite.mode == VKAO_COMPOSITE_NOISY_AO && (bent || half)) ||
            (w.composite.mode == VKAO_COMPOSITE_BENT_NORMALS && !bent))
            w.composite.mode = VKAO_COMPOSITE_NORMALS;
        assert_int_equal(vkao_frame_create(w.ctx, &w.frame_info, &w.frame), VKAO_SUCCESS);
        fake_forget_calls(&w.fake);
        assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
        assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
        assert_int_equal(check_recording(&w), 2 * (half ? 6 : 5));
        world_close(&w);
    }
}

/* A slot that no stage reads may hold anything: a frame that only composites has no use for depth.
 */
static void unread_depth_does_not_reach_the_descriptors(void **state)
{
    (void)state;
    struct world w;
    world_open(&w);
    w.frame_info.stages = VKAO_STAGE_COMPOSITE;
    w.images.normals = w.images.specular = (vkao_image){0};
    w.images.depth.view = VK_NULL_HANDLE;
    w.images.depth.layout = VK_IMAGE_LAYOUT_UNDEFINED;
    assert_int_equal(vkao_frame_create(w.ctx, &w.frame_info, &w.frame), VKAO_SUCCESS);
    assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
    world_close(&w);
}

static void every_call_begins_with_a_barrier(void **state)
{
    (void)state;
    struct world w;
    world_open_frame(&w, VKAO_STAGE_ALL);
    for (int call = 0; call < 5; ++call) {
        fake_forget_calls(&w.fake);
        vkao_result result = call == 0   ? vkao_cmd_prepare(w.frame, world_cmd(&w), &w.view)
                             : call == 1 ? vkao_cmd_ssao(w.frame, world_cmd(&w), &w.view, &w.ssao)
                             : call == 2 ? vkao_cmd_blur(w.frame, world_cmd(&w), &w.view, &w.blur)
                             : call == 3
                                 ? vkao_cmd_composite(w.frame, world_cmd(&w), &w.view, &w.composite)
                                 : world_record_all(&w);
        assert_int_equal(result, VKAO_SUCCESS);
        assert_string_equal(w.fake.calls[0].name, "vkCmdPipelineBarrier");
        check_recording(&w);
    }
    world_close(&w);
}

static void prepare_begins_each_scratch_image_anew(void **state)
{
    (void)state;
    for (vkao_stage_flags stages = 1; stages <= VKAO_STAGE_ALL; ++stages) {
        if (stages == VKAO_STAGE_COMPOSITE)
            continue; /* no scratch, no prepare */
        struct world w;
        open_with_scratch(&w, stages);
        assert_int_equal(vkao_cmd_prepare(w.frame, world_cmd(&w), &w.view), VKAO_SUCCESS);
        const struct fake_call *call = fake_nth(&w.fake, "vkCmdPipelineBarrier", 0);
        assert_int_equal(call->image_barrier_count, fake_live_of(&w.fake, VK_OBJECT_TYPE_IMAGE));
        for (uint32_t i = 0; i < call->image_barrier_count; ++i) {
            const VkImageMemoryBarrier *b = &call->image_barriers[i];
            assert_int_equal(b->oldLayout, VK_IMAGE_LAYOUT_UNDEFINED);
            assert_int_equal(b->newLayout, VK_IMAGE_LAYOUT_GENERAL);
            assert_int_equal(b->dstAccessMask,
                             VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT);
            assert_int_equal(b->srcQueueFamilyIndex, b->dstQueueFamilyIndex);
            for (uint32_t k = 0; k < i; ++k)
                assert_true(call->image_barriers[k].image != b->image);
        }
        assert_null(fake_nth(&w.fake, "vkCmdPipelineBarrier", 1));
        world_close(&w);
    }
}

static void only_prepare_changes_layouts(void **state)
{
    (void)state;
    struct world w;
    world_open_frame(&w, VKAO_STAGE_ALL);
    assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
    for (size_t i = 1; fake_nth(&w.fake, "vkCmdPipelineBarrier", i); ++i)
        assert_int_equal(fake_nth(&w.fake, "vkCmdPipelineBarrier", i)->image_barrier_count, 0);
    world_close(&w);
}

/* Groups cover the rect and a border, and not one more; the rect that shaders test is the rect
 * itself. */
static void check_cover(const struct world *w, size_t index, struct vkao_rect want, uint32_t border,
                        size_t rect_offset)
{
    const struct fake_call *dispatch = fake_nth(&w->fake, "vkCmdDispatch", index);
    const struct fake_call *push = fake_nth(&w->fake, "vkCmdPushConstants", index);
    assert_non_null(dispatch);
    const uint32_t width = want.x1 - want.x0 + 2 * border, height = want.y1 - want.y0 + 2 * border;
    assert_true(dispatch->groups[0] * VKAO_GROUP_WIDTH >= width);
    assert_true((dispatch->groups[0] - 1) * VKAO_GROUP_WIDTH < width);
    assert_true(dispatch->groups[1] * VKAO_GROUP_HEIGHT >= height);
    assert_true((dispatch->groups[1] - 1) * VKAO_GROUP_HEIGHT < height);
    assert_int_equal(dispatch->groups[2], 1);
    uint32_t packed[2];
    rect_pack(want, packed);
    assert_true(rect_offset + sizeof packed <= push->push_bytes);
    assert_memory_equal(push->push + rect_offset, packed, sizeof packed);
}

static void dispatch_covers_the_rect_exactly(void **state)
{
    (void)state;
    static const struct {
        VkRect2D valid, rect;
        struct vkao_rect prepare, ssao, blur_x, rest;
    } cases[] = {
        /* blur radius 4 */
        {{{0, 0}, {0, 0}},
         {{0, 0}, {0, 0}},
         {0, 0, 100, 60},
         {0, 0, 100, 60},
         {0, 0, 100, 60},
         {0, 0, 100, 60}},
        {{{0, 0}, {64, 32}},
         {{0, 0}, {0, 0}},
         {0, 0, 64, 32},
         {0, 0, 64, 32},
         {0, 0, 64, 32},
         {0, 0, 64, 32}},
        {{{3, 5}, {65, 33}},
         {{0, 0}, {0, 0}},
         {3, 5, 68, 38},
         {3, 5, 68, 38},
         {3, 5, 68, 38},
         {3, 5, 68, 38}},
        {{{0, 0}, {0, 0}},
         {{50, 30}, {1, 1}},
         {0, 0, 100, 60},
         {46, 26, 55, 35},
         {50, 26, 51, 35},
         {50, 30, 51, 31}},
        {{{10, 10}, {60, 40}},
         {{12, 12}, {16, 8}},
         {10, 10, 70, 50},
         {10, 10, 32, 24},
         {12, 10, 28, 24},
         {12, 12, 28, 20}},
        {{{10, 10}, {60, 40}},
         {{53, 41}, {17, 9}},
         {10, 10, 70, 50},
         {49, 37, 70, 50},
         {53, 37, 70, 50},
         {53, 41, 70, 50}},
    };
    for (size_t i = 0; i < COUNT(cases); ++i) {
        struct world w;
        world_open_frame(&w, VKAO_STAGE_ALL);
        w.view.valid = cases[i].valid;
        w.view.rect = cases[i].rect;
        w.blur.radius = 4;
        assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
        check_cover(&w, 0, cases[i].prepare, VKAO_VIEW_Z_BORDER,
                    offsetof(struct vkao_prepare_block, valid));
        check_cover(&w, 1, cases[i].ssao, 0, offsetof(struct vkao_ssao_block, rect));
        check_cover(&w, 2, cases[i].blur_x, 0, offsetof(struct vkao_blur_block, rect));
        check_cover(&w, 3, cases[i].rest, 0, offsetof(struct vkao_blur_block, rect));
        check_cover(&w, 4, cases[i].rest, 0, offsetof(struct vkao_composite_block, rect));
        world_close(&w);
    }
}

static void all_records_what_the_stages_record(void **state)
{
    (void)state;
    struct world w;
    world_open_frame(&w, VKAO_STAGE_ALL);
    assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
    const size_t count = w.fake.call_count;
    assert_int_equal(vkao_cmd_prepare(w.frame, world_cmd(&w), &w.view), VKAO_SUCCESS);
    assert_int_equal(vkao_cmd_ssao(w.frame, world_cmd(&w), &w.view, &w.ssao), VKAO_SUCCESS);
    assert_int_equal(vkao_cmd_blur(w.frame, world_cmd(&w), &w.view, &w.blur), VKAO_SUCCESS);
    assert_int_equal(vkao_cmd_composite(w.frame, world_cmd(&w), &w.view, &w.composite),
                     VKAO_SUCCESS);
    assert_int_equal(w.fake.call_count, 2 * count);
    for (size_t i = 0; i < count; ++i) {
        const struct fake_call *a = &w.fake.calls[i], *b = &w.fake.calls[count + i];
        assert_string_equal(a->name, b->name);
        assert_int_equal(a->handle, b->handle);
        assert_int_equal(a->push_bytes, b->push_bytes);
        assert_memory_equal(a->push, b->push, sizeof a->push);
        assert_memory_equal(a->groups, b->groups, sizeof a->groups);
    }
    world_close(&w);
}

static void recording_allocates_nothing(void **state)
{
    (void)state;
    for (int callbacks = 0; callbacks < 2; ++callbacks) {
        struct world w;
        world_init(&w, callbacks);
        assert_int_equal(vkao_context_create(&w.info, &w.ctx), VKAO_SUCCESS);
        assert_int_equal(vkao_frame_create(w.ctx, &w.frame_info, &w.frame), VKAO_SUCCESS);
        fake_forget_calls(&w.fake);
        const unsigned before = w.host.total + host_calloc.total;
        assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
        assert_int_equal(w.host.total + host_calloc.total, before);
        assert_true(w.fake.call_count > 0);
        assert_int_equal(fake_count(&w.fake, "vkCmd"), w.fake.call_count);
        world_close(&w);
    }
}

static void only_compute_set_zero_and_push_constants_change(void **state)
{
    (void)state;
    struct world w;
    world_open_frame(&w, VKAO_STAGE_ALL);
    assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
    for (size_t i = 0; i < w.fake.call_count; ++i) {
        const struct fake_call *call = &w.fake.calls[i];
        bool binds_set = strcmp(call->name, "vkCmdBindDescriptorSets") == 0;
        if (binds_set || strcmp(call->name, "vkCmdBindPipeline") == 0)
            assert_int_equal(call->bind_point, VK_PIPELINE_BIND_POINT_COMPUTE);
        if (binds_set) {
            assert_int_equal(call->first_set, 0);
            assert_int_equal(call->set_count, 1);
        }
        if (strcmp(call->name, "vkCmdPushConstants") == 0)
            assert_int_equal(call->push_stages, VK_SHADER_STAGE_COMPUTE_BIT);
        assert_int_equal(call->buffer_barrier_count, 0);
    }
    world_close(&w);
}

static void labels_begin_and_end_in_pairs(void **state)
{
    (void)state;
    struct world w;
    world_init(&w, true);
    w.fake.debug_utils = true;
    w.info.debug_labels = VK_TRUE;
    assert_int_equal(vkao_context_create(&w.info, &w.ctx), VKAO_SUCCESS);
    assert_int_equal(vkao_frame_create(w.ctx, &w.frame_info, &w.frame), VKAO_SUCCESS);
    fake_forget_calls(&w.fake);
    assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
    int depth = 0;
    for (size_t i = 0; i < w.fake.call_count; ++i) {
        depth += strcmp(w.fake.calls[i].name, "vkCmdBeginDebugUtilsLabelEXT") == 0;
        depth -= strcmp(w.fake.calls[i].name, "vkCmdEndDebugUtilsLabelEXT") == 0;
        assert_true(depth == 0 || depth == 1);
    }
    assert_int_equal(depth, 0);
    assert_int_equal(fake_count(&w.fake, "vkCmdBegin"), 4);
    world_close(&w);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(barrier_stands_between_producer_and_consumer),
        cmocka_unit_test(barriers_stand_in_every_kind_of_frame),
        cmocka_unit_test(unread_depth_does_not_reach_the_descriptors),
        cmocka_unit_test(every_call_begins_with_a_barrier),
        cmocka_unit_test(prepare_begins_each_scratch_image_anew),
        cmocka_unit_test(only_prepare_changes_layouts),
        cmocka_unit_test(dispatch_covers_the_rect_exactly),
        cmocka_unit_test(all_records_what_the_stages_record),
        cmocka_unit_test(recording_allocates_nothing),
        cmocka_unit_test(only_compute_set_zero_and_push_constants_change),
        cmocka_unit_test(labels_begin_and_end_in_pairs),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
