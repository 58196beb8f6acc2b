/* SPDX-License-Identifier: MIT
 *
 * What recording leaves in the command buffer: barriers, dispatches, push constants, and nothing
 * else. */
#include "pipelines.h"
#include "recording.h"
#include "world.h"

#include <string.h>

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

/* The pass whose pipeline was bound. */
static const struct vkao_step *step_of(const struct world *w, uint64_t pipeline)
{
    const struct vkao_program *program = w->frame->program;
    for (uint32_t i = 0; i < program->count; ++i) {
        for (uint32_t form = 0; form < VKAO_MOST_FORMS; ++form) {
            if (pipeline && (uint64_t)program->steps[i].pipelines->forms[form] == pipeline)
                return &program->steps[i];
        }
    }
    fail_msg("dispatch without a pipeline of the effect");
    return NULL;
}

/* Accesses that no barrier has followed yet, as synchronization validation keeps them. */
static void check_dispatch(const struct world *w, const struct fake_call *dispatch, uint64_t set,
                           struct views *read, struct views *written)
{
    const struct vkao_step *step = step_of(w, dispatch->handle);
    const struct fake_object *object = fake_find(&w->fake, set);
    assert_non_null(object);
    for (uint32_t i = 0; i < step->use_count; ++i) {
        const struct vkao_use *use = &step->uses[i];
        const uint64_t view = object->views[use->binding];
        if (use->resource == VKAO_RESOURCE_SAMPLER)
            continue;
        if (!view)
            fail_msg("%s names binding %u, which holds nothing", step->row->name, use->binding);
        if (!vkao_use_is_touched(w->frame->program, use))
            continue; /* a stand-in */
        if (!use->writes && holds(written, view))
            fail_msg("%s reads binding %u: no barrier after its producer", step->row->name,
                     use->binding);
        if (use->writes && (holds(written, view) || holds(read, view)))
            fail_msg("%s writes binding %u: no barrier after its last use", step->row->name,
                     use->binding);
    }
    for (uint32_t i = 0; i < step->use_count; ++i) {
        const struct vkao_use *use = &step->uses[i];
        struct views *v = use->writes ? written : read;
        if (vkao_use_is_touched(w->frame->program, use))
            v->list[v->count++] = object->views[use->binding];
    }
}

/* Barriers between shaders, and around the update of the constants. */
static void check_barrier(const struct fake_call *call)
{
    const VkPipelineStageFlags known =
        VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT;
    assert_int_equal(call->src_stages & ~known, 0);
    assert_int_equal(call->dst_stages & ~known, 0);
    assert_true(call->dst_stages & VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT);
    assert_int_equal(call->memory_barrier_count, 1);
    if (call->src_stages == VK_PIPELINE_STAGE_TRANSFER_BIT) {
        assert_int_equal(call->memory_barrier.srcAccessMask, VK_ACCESS_TRANSFER_WRITE_BIT);
        assert_int_equal(call->memory_barrier.dstAccessMask, VK_ACCESS_UNIFORM_READ_BIT);
        return;
    }
    assert_true(call->memory_barrier.srcAccessMask & VK_ACCESS_SHADER_WRITE_BIT);
    assert_int_equal(call->memory_barrier.dstAccessMask &
                         (VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT),
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
            if (call->src_stages == VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT)
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
    w->effect_info.stages = stages;
    w->effect_info.noisy_ao = VK_FALSE;
    if ((stages & VKAO_STAGE_SSAO) && (stages & VKAO_STAGE_BLUR))
        world_use_scratch_noise(w);
    if ((stages & VKAO_STAGE_COMPOSITE) && stages != VKAO_STAGE_COMPOSITE)
        w->images.ao = (vkao_image){0};
    world_create_frame(w);
}

static void barrier_stands_between_producer_and_consumer(void **state)
{
    (void)state;
    static const unsigned dispatches[VKAO_STAGE_ALL + 1] = {0, 2, 2, 3, 1, 3, 3, 4};
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

/* Half resolution with and without bent normals, and the composites that read more. */
static void barriers_stand_in_every_kind_of_frame(void **state)
{
    (void)state;
    for (int i = 0; i < 2 * 2 * 2 * 7; ++i) {
        const bool half = i & 1, bent = i & 2, scratch = i & 4;
        struct world w;
        world_open(&w);
        world_use_scratch_noise(&w);
        w.effect_info.normal_encoding = VKAO_NORMALS_XYZ_SNORM;
        if (scratch)
            w.images.ao = (vkao_image){0};
        if (bent)
            world_use_bent_normals(&w);
        w.effect_info.half_resolution = half;
        w.effect_info.composite_mode = (vkao_composite_mode)(i / 8);
        if (w.effect_info.composite_mode < VKAO_COMPOSITE_AO_ONLY) {
            w.effect_info.multi_bounce = VK_TRUE;
            w.effect_info.specular = bent ? VKAO_SPECULAR_FROM_BENT : VKAO_SPECULAR_FROM_AO;
        }
        if ((w.effect_info.composite_mode == VKAO_COMPOSITE_NOISY_AO && (bent || half)) ||
            (w.effect_info.composite_mode == VKAO_COMPOSITE_BENT_NORMALS && !bent))
            w.effect_info.composite_mode = VKAO_COMPOSITE_NORMALS;
        world_create_frame(&w);
        fake_forget_calls(&w.fake);
        assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
        assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
        assert_int_equal(check_recording(&w), 2 * (half ? 5 : 4));
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
    w.effect_info.stages = VKAO_STAGE_COMPOSITE;
    w.effect_info.noisy_ao = VK_FALSE;
    w.images.normals = w.images.specular = (vkao_image){0};
    w.images.depth.view = VK_NULL_HANDLE;
    w.images.depth.layout = VK_IMAGE_LAYOUT_UNDEFINED;
    world_create_frame(&w);
    assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
    world_close(&w);
}

static void every_call_begins_with_a_barrier(void **state)
{
    (void)state;
    struct world w;
    world_open_frame(&w, VKAO_STAGE_ALL);
    for (int call = 0; call < 5; ++call) {
        static const vkao_stage_flags stages[] = {VKAO_STAGE_PREPARE, VKAO_STAGE_SSAO,
                                                  VKAO_STAGE_BLUR, VKAO_STAGE_COMPOSITE};
        fake_forget_calls(&w.fake);
        vkao_result result =
            call < 4 ? vkao_cmd_stage(w.frame, world_cmd(&w), stages[call], &w.view, &w.params)
                     : world_record_all(&w);
        assert_int_equal(result, VKAO_SUCCESS);
        assert_string_equal(w.fake.calls[0].name, "vkCmdPipelineBarrier");
        check_recording(&w);
    }
    world_close(&w);
}

/* Memory that was another image's begins anew where the image is first written. */
static void each_scratch_image_begins_anew_once(void **state)
{
    (void)state;
    for (vkao_stage_flags stages = 1; stages <= VKAO_STAGE_ALL; ++stages) {
        struct world w;
        open_with_scratch(&w, stages);
        assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
        uint64_t begun[8];
        size_t count = 0;
        const struct fake_call *call;
        for (size_t n = 0; (call = fake_nth(&w.fake, "vkCmdPipelineBarrier", n)); ++n) {
            for (uint32_t i = 0; i < call->image_barrier_count; ++i) {
                const VkImageMemoryBarrier *b = &call->image_barriers[i];
                assert_int_equal(b->oldLayout, VK_IMAGE_LAYOUT_UNDEFINED);
                assert_int_equal(b->newLayout, VK_IMAGE_LAYOUT_GENERAL);
                assert_int_equal(b->dstAccessMask,
                                 VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT);
                assert_int_equal(b->srcQueueFamilyIndex, b->dstQueueFamilyIndex);
                for (size_t k = 0; k < count; ++k)
                    assert_true(begun[k] != (uint64_t)b->image);
                begun[count++] = (uint64_t)b->image;
            }
        }
        assert_int_equal(count, fake_live_of(&w.fake, VK_OBJECT_TYPE_IMAGE));
        world_close(&w);
    }
}

/* vbao takes thickness from the depth image: where it breaks, and what lies between. */
static void vbao_has_two_passes_more(void **state)
{
    (void)state;
    size_t dispatches[2], bytes[2];
    for (int i = 0; i < 2; ++i) {
        struct world w;
        world_open(&w);
        w.effect_info.method = i ? VKAO_SSAO_VBAO : VKAO_SSAO_GTAO;
        world_create_frame(&w);
        fake_forget_calls(&w.fake);
        assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
        dispatches[i] = check_recording(&w);
        bytes[i] = w.frame->scratch.kept.size + w.frame->scratch.tail.size;
        world_close(&w);
    }
    assert_int_equal(dispatches[1], dispatches[0] + 2);
    assert_true(bytes[1] >= bytes[0]);
}

/* Groups of that size cover the rect and a border, and not one more; the rect that shaders test is
 * the rect itself. */
static void check_cover(const struct world *w, size_t index, struct vkao_rect want,
                        VkExtent2D border, VkExtent2D group)
{
    const struct fake_call *dispatch = fake_nth(&w->fake, "vkCmdDispatch", index);
    const struct fake_call *push = fake_nth(&w->fake, "vkCmdPushConstants", index);
    assert_non_null(dispatch);
    const uint32_t width = want.x1 - want.x0 + border.width,
                   height = want.y1 - want.y0 + border.height;
    assert_true(dispatch->groups[0] * group.width >= width);
    assert_true((dispatch->groups[0] - 1) * group.width < width);
    assert_true(dispatch->groups[1] * group.height >= height);
    assert_true((dispatch->groups[1] - 1) * group.height < height);
    assert_int_equal(dispatch->groups[2], 1);
    uint32_t packed[2];
    vkao_rect_pack(want, packed);
    assert_int_equal(push->push_bytes, sizeof packed);
    assert_memory_equal(push->push, packed, sizeof packed);
}

static void dispatch_covers_the_rect_exactly(void **state)
{
    (void)state;
    static const struct {
        VkRect2D valid, rect;
        struct vkao_rect ssao, blur_x, rest;
    } cases[] = {
        /* blur radius 4 */
        {{{0, 0}, {0, 0}}, {{0, 0}, {0, 0}}, {0, 0, 100, 60}, {0, 0, 100, 60}, {0, 0, 100, 60}},
        {{{0, 0}, {64, 32}}, {{0, 0}, {0, 0}}, {0, 0, 64, 32}, {0, 0, 64, 32}, {0, 0, 64, 32}},
        {{{3, 5}, {65, 33}}, {{0, 0}, {0, 0}}, {3, 5, 68, 38}, {3, 5, 68, 38}, {3, 5, 68, 38}},
        {{{0, 0}, {0, 0}},
         {{50, 30}, {1, 1}},
         {46, 26, 55, 35},
         {50, 26, 51, 35},
         {50, 30, 51, 31}},
        {{{10, 10}, {60, 40}},
         {{12, 12}, {16, 8}},
         {10, 10, 32, 24},
         {12, 10, 28, 24},
         {12, 12, 28, 20}},
        {{{10, 10}, {60, 40}},
         {{53, 41}, {17, 9}},
         {49, 37, 70, 50},
         {53, 37, 70, 50},
         {53, 41, 70, 50}},
    };
    for (size_t i = 0; i < COUNT(cases); ++i) {
        struct world w;
        world_open(&w);
        w.effect_info.blur_radius = 4;
        world_create_frame(&w);
        w.view.valid = cases[i].valid;
        w.view.rect = cases[i].rect;
        assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
        /* What is not valid is background for all that samples. */
        const VkExtent2D none = {0, 0}, group = {VKAO_GROUP_WIDTH, VKAO_GROUP_HEIGHT},
                         prepare_group = {2 * VKAO_GROUP_WIDTH, 2 * VKAO_GROUP_HEIGHT},
                         ssao_group = {VKAO_SSAO_GROUP_WIDTH, VKAO_SSAO_GROUP_HEIGHT};
        check_cover(&w, 0, (struct vkao_rect){0, 0, 100, 60}, (VkExtent2D){8, 2}, prepare_group);
        check_cover(&w, 1, cases[i].ssao, none, ssao_group);
        check_cover(&w, 2, cases[i].blur_x, none, group);
        check_cover(&w, 3, cases[i].rest, none, group);
        check_cover(&w, 4, cases[i].rest, none, group);
        world_close(&w);
    }
}

/* But for the constants, which every call writes. */
static void all_records_what_the_stages_record(void **state)
{
    (void)state;
    struct world w;
    world_open_frame(&w, VKAO_STAGE_ALL);
    assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
    const size_t count = fake_count(&w.fake, "vkCmdDispatch");
    const vkao_stage_flags stages[] = {VKAO_STAGE_PREPARE, VKAO_STAGE_SSAO, VKAO_STAGE_BLUR,
                                       VKAO_STAGE_COMPOSITE};
    for (size_t i = 0; i < COUNT(stages); ++i)
        assert_int_equal(vkao_cmd_stage(w.frame, world_cmd(&w), stages[i], &w.view, &w.params),
                         VKAO_SUCCESS);
    assert_int_equal(fake_count(&w.fake, "vkCmdDispatch"), 2 * count);
    for (size_t i = 0; i < count; ++i) {
        static const char *const calls[] = {"vkCmdDispatch", "vkCmdPushConstants",
                                            "vkCmdBindDescriptorSets", "vkCmdBindPipeline"};
        for (size_t c = 0; c < COUNT(calls); ++c) {
            const struct fake_call *a = fake_nth(&w.fake, calls[c], i),
                                   *b = fake_nth(&w.fake, calls[c], count + i);
            assert_int_equal(a->handle, b->handle);
            assert_int_equal(a->push_bytes, b->push_bytes);
            assert_memory_equal(a->push, b->push, sizeof a->push);
            assert_memory_equal(a->groups, b->groups, sizeof a->groups);
        }
    }
    const struct fake_call *first = fake_nth(&w.fake, "vkCmdUpdateBuffer", 0);
    for (size_t i = 1; i < 5; ++i)
        assert_memory_equal(fake_nth(&w.fake, "vkCmdUpdateBuffer", i)->update, first->update,
                            sizeof first->update);
    world_close(&w);
}

struct marks {
    unsigned begun, ended;
    char names[8][16];
};

static void keep_mark(void *user_data, VkCommandBuffer cmd, const char *name, VkBool32 begins)
{
    struct marks *marks = user_data;
    assert_non_null(cmd);
    if (begins) {
        assert_int_equal(marks->begun, marks->ended);
        strncpy(marks->names[marks->begun++ % 8], name, 15);
    } else {
        assert_string_equal(marks->names[marks->ended++ % 8], name);
    }
}

static void marks_name_each_stage_in_order(void **state)
{
    (void)state;
    static const char *const want[] = {"prepare", "ssao", "blur", "upsample", "composite"};
    for (int half = 0; half < 2; ++half) {
        struct world w;
        struct marks marks = {0};
        world_init(&w, true);
        w.info.mark = keep_mark;
        w.info.mark_user_data = &marks;
        assert_int_equal(vkao_context_create(&w.info, &w.ctx), VKAO_SUCCESS);
        world_use_scratch_noise(&w);
        w.effect_info.half_resolution = (VkBool32)half;
        world_create_frame(&w);
        assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
        assert_int_equal(marks.begun, half ? 5 : 4);
        assert_int_equal(marks.ended, marks.begun);
        for (unsigned i = 0; i < marks.begun; ++i)
            assert_string_equal(marks.names[i], want[!half && i == 3 ? 4 : i]);
        world_close(&w);
    }
}

static void recording_allocates_nothing(void **state)
{
    (void)state;
    for (int callbacks = 0; callbacks < 2; ++callbacks) {
        struct world w;
        world_init(&w, callbacks);
        assert_int_equal(vkao_context_create(&w.info, &w.ctx), VKAO_SUCCESS);
        world_create_frame(&w);
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
    world_create_frame(&w);
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
        cmocka_unit_test(vbao_has_two_passes_more),
        cmocka_unit_test(unread_depth_does_not_reach_the_descriptors),
        cmocka_unit_test(every_call_begins_with_a_barrier),
        cmocka_unit_test(each_scratch_image_begins_anew_once),
        cmocka_unit_test(dispatch_covers_the_rect_exactly),
        cmocka_unit_test(all_records_what_the_stages_record),
        cmocka_unit_test(marks_name_each_stage_in_order),
        cmocka_unit_test(recording_allocates_nothing),
        cmocka_unit_test(only_compute_set_zero_and_push_constants_change),
        cmocka_unit_test(labels_begin_and_end_in_pairs),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
