/* SPDX-License-Identifier: MIT
 *
 * The CPU's passes: where they are chosen, how the blur goes down the image in strips, which tiles
 * are looked at, when AO is copied, and what becomes of frames that its buffers cannot hold. */
#include "cpu/cpu.h"
#include "pipelines.h"
#include "world.h"

#include "cpu/layout.h"

#include <pthread.h>
#include <stdio.h>
#include <string.h>

static void open_cpu(struct world *w)
{
    world_init(w, true);
    world_be_cpu(w);
    assert_int_equal(vkao_context_create(&w->info, &w->ctx), VKAO_SUCCESS);
    w->effect_info.stages = VKAO_STAGE_SSAO | VKAO_STAGE_BLUR;
    world_use_scratch_noise(w);
}

/* The AO image behind the view. */
static void give_image(struct world *w)
{
    w->images.ao.image =
        fake_caller_image(&w->fake, &(VkImageCreateInfo){.format = VK_FORMAT_R16_UNORM,
                                                         .extent = {4096, 4096, 1},
                                                         .mipLevels = 1,
                                                         .arrayLayers = 1});
}

static void cpus_have_it_and_others_do_not(void **state)
{
    (void)state;
    static const struct {
        VkPhysicalDeviceType type;
        VkFormat lacking;
        bool want;
    } rows[] = {
        {VK_PHYSICAL_DEVICE_TYPE_CPU, VK_FORMAT_UNDEFINED, true},
        {VK_PHYSICAL_DEVICE_TYPE_CPU, VK_FORMAT_R8_UINT, false},
        {VK_PHYSICAL_DEVICE_TYPE_CPU, VK_FORMAT_R16_UINT, false},
        {VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU, VK_FORMAT_UNDEFINED, false},
        {VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU, VK_FORMAT_UNDEFINED, false},
        {VK_PHYSICAL_DEVICE_TYPE_OTHER, VK_FORMAT_UNDEFINED, false},
    };
    for (size_t i = 0; i < COUNT(rows); ++i) {
        struct world w;
        world_init(&w, true);
        w.fake.device_type = rows[i].type;
        w.fake.no_texel_buffer = rows[i].lacking;
        assert_int_equal(vkao_context_create(&w.info, &w.ctx), VKAO_SUCCESS);
        w.effect_info.stages = VKAO_STAGE_SSAO | VKAO_STAGE_BLUR;
        world_use_scratch_noise(&w);
        world_create_frame(&w);
        assert_int_equal(fake_live_of(&w.fake, VK_OBJECT_TYPE_BUFFER_VIEW) > 0, rows[i].want);
        assert_int_equal(fake_live_of(&w.fake, VK_OBJECT_TYPE_IMAGE) == 0, rows[i].want);
        assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
        world_close(&w);
    }
}

static struct vkao_strip nth_strip(struct world *w, size_t push)
{
    struct vkao_strip strip;
    memcpy(&strip, fake_nth(&w->fake, "vkCmdPushConstants", push)->push, sizeof strip);
    return strip;
}

/* Normals are decoded of the rows that rows are blurred of, and of the columns that they reach, on
 * the way. */
static void check_normals_of(struct vkao_strip normals, struct vkao_strip rows)
{
    assert_int_equal(normals.rect[0] >> 16, rows.rect[0] >> 16);
    assert_int_equal(normals.rect[1] >> 16, rows.rect[1] >> 16);
    assert_int_equal(normals.rect[0] & 0xffffu, 0);
    assert_int_equal(normals.rect[1] & 0xffffu, 65);
    assert_int_equal(normals.ring_row, rows.ring_row);
}

/* Those of a strip: normals among them if the blur looks at any, and its rows, if the strip before
 * has not added all that there is. Returns the first dispatch after them. */
static uint32_t check_rows(struct world *w, uint32_t first, bool normals, uint32_t *halfway,
                           struct vkao_strip columns)
{
    const uint32_t at = normals ? first + 1 : first;
    const struct vkao_strip rows = nth_strip(w, at);
    if (normals)
        check_normals_of(nth_strip(w, first), rows);
    assert_int_equal(rows.rect[0] >> 16, *halfway);
    assert_true(rows.rect[1] >> 16 > *halfway);
    assert_int_equal(rows.ring_row, columns.ring_row);
    *halfway = rows.rect[1] >> 16;
    return at + 1;
}

/* The dispatches: prepare, tiles and ssao, then those of each strip in turns. */
static void check_strips(uint32_t height, bool normals)
{
    struct world w;
    open_cpu(&w);
    w.fake.max_dimension = 8192;
    w.effect_info.blur_normal_power = normals ? 4.0f : 0.0f;
    w.frame_info.extent = (VkExtent2D){65, height};
    world_create_frame(&w);
    assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
    uint32_t blurred = 0, halfway = 0, next = 3;
    while (blurred < height) {
        const uint32_t rows = halfway < height ? (normals ? 2 : 1) : 0;
        const struct vkao_strip columns = nth_strip(&w, next + rows);
        if (rows)
            next = check_rows(&w, next, normals, &halfway, columns);
        ++next;
        assert_int_equal(columns.rect[0] >> 16, blurred);
        assert_true(columns.rect[1] >> 16 > blurred);
        blurred = columns.rect[1] >> 16;
        assert_int_equal(halfway, blurred + 3 < height ? blurred + 3 : height);
        assert_true((int32_t)columns.ring_row <= (int32_t)(columns.rect[0] >> 16) - 3);
        assert_true((int32_t)halfway <= (int32_t)columns.ring_row + 2 * VKAO_RING_ROWS);
    }
    assert_int_equal(blurred, height);
    assert_int_equal(fake_count(&w.fake, "vkCmdDispatch"), next);
    world_close(&w);
}

/* Every row of the rect is blurred once, each strip after the rows that it reads. */
static void strips_cover_the_rect_once(void **state)
{
    (void)state;
    for (uint32_t height = 1; height < 700; height += 37) {
        check_strips(height, false);
        check_strips(height, true);
    }
    /* The last strip has no more rows than the one before has reached down to. */
    for (uint32_t height = 2 * VKAO_STRIP_ROWS + 1; height < 2 * VKAO_STRIP_ROWS + 5; ++height) {
        check_strips(height, false);
        check_strips(height, true);
    }
}

/* The list that SSAO's dispatch reads begins with its size, and holds as many tiles as there
 * are. */
static void tiles_are_those_of_the_rect(void **state)
{
    (void)state;
    static const VkExtent2D extents[] = {{1, 1}, {64, 8}, {65, 9}, {640, 480}, {1921, 1081}};
    for (size_t i = 0; i < COUNT(extents); ++i) {
        struct world w;
        struct vkao_tiling push;
        struct vkao_tiles_head head;
        open_cpu(&w);
        w.frame_info.extent = extents[i];
        world_create_frame(&w);
        assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
        memcpy(&push, fake_nth(&w.fake, "vkCmdPushConstants", 1)->push, sizeof push);
        const struct fake_call *update = fake_nth(&w.fake, "vkCmdUpdateBuffer", 1);
        const struct fake_call *indirect = fake_nth(&w.fake, "vkCmdDispatchIndirect", 0);
        memcpy(&head, update->update, sizeof head);
        assert_int_equal(push.tile_width, VKAO_ROW_GROUP_WIDTH * VKAO_SSAO_TEXELS);
        assert_int_equal(push.tiles[0], (extents[i].width + 159) / 160);
        assert_int_equal(push.tiles[1], (extents[i].height + 7) / 8);
        assert_int_equal(head.group_rows, push.tile_height);
        assert_int_equal(head.count, 0);
        assert_int_equal(head.one, 1);
        assert_int_equal(update->offset, indirect->offset);
        VkDeviceSize parts[VKAO_RESOURCE_COUNT] = {0};
        struct vkao_rows rows;
        vkao_cpu_parts(w.frame->program, extents[i], false, &rows, parts);
        assert_true(parts[VKAO_PART_TILES] >=
                    sizeof head + 4 * (VkDeviceSize)push.tiles[0] * push.tiles[1]);
        world_close(&w);
    }
}

/* Copies cover the rect, each texel once. */
static void ao_is_copied_if_its_image_is_given(void **state)
{
    (void)state;
    for (int i = 0; i < 4; ++i) {
        const bool half = i & 1, given = i & 2;
        struct world w;
        open_cpu(&w);
        w.effect_info.half_resolution = half;
        w.frame_info.extent = (VkExtent2D){300, 400};
        const size_t strips = (391 + VKAO_STRIP_ROWS - 1) / VKAO_STRIP_ROWS;
        if (given)
            give_image(&w);
        /* Effects are compiled for frames with it; the first one without adds what it lacks. */
        world_create_effect(&w);
        const size_t compiled = fake_count(&w.fake, "vkCreateComputePipelines");
        for (int frame = 0; frame < 2; ++frame) {
            vkao_frame_destroy(w.frame);
            assert_int_equal(vkao_frame_create(w.effect, &w.frame_info, &w.frame), VKAO_SUCCESS);
            const size_t more = fake_count(&w.fake, "vkCreateComputePipelines") - compiled;
            assert_int_equal(more, given ? 0 : 1);
        }
        fake_forget_calls(&w.fake);
        w.view.rect = (VkRect2D){{13, 5}, {205, 391}};
        assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
        int32_t y = 5;
        size_t copies = 0;
        for (const struct fake_call *c; (c = fake_nth(&w.fake, "vkCmdCopyBufferToImage", copies));
             ++copies) {
            assert_int_equal(c->copy.imageOffset.x, 13);
            assert_int_equal(c->copy.imageOffset.y, y);
            assert_int_equal(c->copy.imageExtent.width, 205);
            y += (int32_t)c->copy.imageExtent.height;
        }
        assert_int_equal(copies, given ? strips : 0);
        assert_int_equal(y, given ? 5 + 391 : 5);
        world_close(&w);
    }
}

/* What the first frame without the image adds fails at each call in turn; then it does not. */
static void late_passes_that_fail_leave_a_whole_effect(void **state)
{
    (void)state;
    unsigned failures = 0;
    for (unsigned nth = 1;; ++nth) {
        struct world w;
        open_cpu(&w);
        world_create_effect(&w);
        const size_t live = fake_live_of(&w.fake, VK_OBJECT_TYPE_PIPELINE);
        w.fake.fail_at = w.fake.result_calls + nth;
        w.fake.failed = NULL;
        const vkao_result result = vkao_frame_create(w.effect, &w.frame_info, &w.frame);
        w.fake.fail_at = 0;
        const bool has_failed = w.fake.failed;
        assert_int_equal(result == VKAO_SUCCESS, !has_failed);
        if (has_failed) {
            assert_null(w.frame);
            failures++;
            assert_int_equal(vkao_frame_create(w.effect, &w.frame_info, &w.frame), VKAO_SUCCESS);
        }
        assert_int_equal(fake_live_of(&w.fake, VK_OBJECT_TYPE_PIPELINE), live + 1);
        assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
        world_close(&w);
        if (!has_failed)
            break;
    }
    /* A module and a pipeline are not all that a frame makes. */
    assert_true(failures > 3);
}

static size_t commands_of(const struct world *w)
{
    return fake_count(&w->fake, "vkCmdDispatch") + fake_count(&w->fake, "vkCmdPipelineBarrier") +
           fake_count(&w->fake, "vkCmdBindPipeline");
}

/* The first recording with intensity or power compiles the last pass for it, whatever AO it ends
 * with, or says why it cannot and has recorded nothing. A GPU has both before. */
static void tone_is_compiled_once_and_where_it_is_asked_for(void **state)
{
    (void)state;
    for (int i = 0; i < 8; ++i) {
        const bool is_cpu = i & 1, given = i & 2, fails = i & 4;
        struct world w;
        if (is_cpu)
            open_cpu(&w);
        else
            world_open(&w);
        w.effect_info.stages = VKAO_STAGE_SSAO | VKAO_STAGE_BLUR;
        if (given)
            give_image(&w);
        world_create_frame(&w);
        assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
        const size_t compiled = fake_count(&w.fake, "vkCreateComputePipelines");
        const size_t recorded = commands_of(&w);
        w.params.power = 2.0f;
        if (is_cpu && fails) {
            for (unsigned nth = 1; nth <= 2; ++nth) { /* the module, the pipeline */
                w.fake.fail_at = w.fake.result_calls + nth;
                w.fake.fail_result = VK_ERROR_OUT_OF_HOST_MEMORY;
                assert_int_equal(world_record_all(&w), VKAO_ERROR_OUT_OF_HOST_MEMORY);
                assert_int_equal(commands_of(&w), recorded);
            }
            w.fake.fail_at = 0;
        }
        const size_t before = fake_count(&w.fake, "vkCreateComputePipelines");
        assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
        w.params.intensity = 3.0f;
        assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
        assert_int_equal(fake_count(&w.fake, "vkCreateComputePipelines") - before, is_cpu);
        assert_int_equal(before - compiled, is_cpu && fails);
        world_close(&w);
    }
}

static void *complete(void *effect)
{
    const vkao_result result = vkao_program_complete(((vkao_effect *)effect)->passes, 0);
    return result == VKAO_SUCCESS ? effect : NULL;
}

/* Each compiles what is missing, and one of two that are alike is destroyed. */
static void frames_of_two_threads_add_late_passes_once(void **state)
{
    (void)state;
    struct world w;
    open_cpu(&w);
    world_create_effect(&w);
    const size_t compiled = fake_count(&w.fake, "vkCreateComputePipelines");
    const size_t live = fake_live_of(&w.fake, VK_OBJECT_TYPE_PIPELINE);
    pthread_barrier_t compiling;
    assert_int_equal(pthread_barrier_init(&compiling, NULL, 2), 0);
    w.fake.compiling = &compiling;
    pthread_t threads[2];
    for (int i = 0; i < 2; ++i)
        assert_int_equal(pthread_create(&threads[i], NULL, complete, w.effect), 0);
    for (int i = 0; i < 2; ++i) {
        void *done;
        pthread_join(threads[i], &done);
        assert_non_null(done);
    }
    w.fake.compiling = NULL;
    pthread_barrier_destroy(&compiling);
    assert_int_equal(fake_count(&w.fake, "vkCreateComputePipelines"), compiled + 2);
    assert_int_equal(fake_live_of(&w.fake, VK_OBJECT_TYPE_PIPELINE), live + 1);
    assert_int_equal(vkao_frame_create(w.effect, &w.frame_info, &w.frame), VKAO_SUCCESS);
    assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
    world_close(&w);
}

/* The directions of the blur take turns: what either needs is needed until both have ended. */
static void parts_that_are_needed_together_do_not_overlap(void **state)
{
    (void)state;
    for (int i = 0; i < 8; ++i) {
        struct world w;
        open_cpu(&w);
        w.effect_info.half_resolution = i & 1;
        w.effect_info.blur_normal_power = i & 4 ? 2.0f : 0.0f;
        if (i & 2)
            give_image(&w);
        world_create_frame(&w);
        const struct vkao_block *blocks = w.frame->scratch.blocks;
        /* Normals are decoded in turns with both directions. */
        const struct vkao_block *last = &blocks[i & 1 ? VKAO_PART_BLURRED : VKAO_PART_COPIED];
        if (i & 4 && i != 4)
            assert_int_equal(last->first, blocks[VKAO_PART_RING_NORMALS].first);
        for (int a = VKAO_RESOURCE_CONSTANTS; a < VKAO_RESOURCE_COUNT; ++a) {
            for (int b = VKAO_RESOURCE_CONSTANTS; b < a; ++b) {
                /* Tiles alone are done with before the blur begins. */
                if (a == VKAO_PART_TILES)
                    continue;
                /* Noisy AO ends where upsampling begins, and copies only then. */
                if ((i & 1) && b == VKAO_PART_PACKED)
                    continue;
                assert_true(blocks[a].offset + blocks[a].size <= blocks[b].offset ||
                            blocks[b].offset + blocks[b].size <= blocks[a].offset);
            }
        }
        world_close(&w);
    }
}

/* With bent normals images follow the parts that tell thickness, in their memory, and no others. */
static void images_follow_parts_that_have_ended(void **state)
{
    (void)state;
    struct world w;
    open_cpu(&w);
    w.effect_info.method = VKAO_SSAO_VBAO;
    world_use_bent_normals(&w);
    world_create_frame(&w);
    const struct vkao_scratch *scratch = &w.frame->scratch;
    int following = 0;
    for (int a = 0; a < VKAO_IMAGE_COUNT; ++a) {
        if (!scratch->images[a].image)
            continue;
        const struct vkao_block *image = &scratch->blocks[a];
        for (int b = VKAO_RESOURCE_CONSTANTS; b < VKAO_RESOURCE_COUNT; ++b) {
            const struct vkao_block *part = &scratch->blocks[b];
            const VkDeviceSize at = scratch->kept.offset + part->offset;
            if (!part->size || image->offset + image->size <= at ||
                at + part->size <= image->offset)
                continue;
            assert_true(image->first > part->last);
            assert_true(image->follows);
            ++following;
        }
    }
    assert_true(following > 0);
    world_close(&w);
}

static void images_of_other_slots_are_refused(void **state)
{
    (void)state;
    struct world w;
    open_cpu(&w);
    give_image(&w);
    w.images.depth.image = w.images.ao.image;
    expect_refused(&w, VKAO_ERROR_INVALID_ARGUMENT, world_try_frame(&w), "images.depth.image",
                   "images.ao");
    world_close(&w);
}

/* What another path can do is not refused. */
static void frames_too_large_for_buffers_use_images(void **state)
{
    (void)state;
    struct world w;
    open_cpu(&w);
    w.fake.max_buffer = 200000;
    w.ctx->max_buffer = 200000;
    w.frame_info.extent = (VkExtent2D){400, 300};
    world_create_effect(&w);
    VkMemoryRequirements query;
    assert_int_equal(vkao_frame_scratch(w.effect, &w.frame_info, &query), VKAO_SUCCESS);
    world_create_frame(&w);
    assert_true(fake_live_of(&w.fake, VK_OBJECT_TYPE_IMAGE) > 0);
    assert_int_equal(fake_live_of(&w.fake, VK_OBJECT_TYPE_BUFFER_VIEW), 0);
    assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
    w.frame_info.extent = (VkExtent2D){100, 60};
    world_create_frame(&w);
    assert_int_equal(fake_live_of(&w.fake, VK_OBJECT_TYPE_IMAGE), 0);
    world_close(&w);
}

static void bent_normals_and_noisy_ao_go_through_images(void **state)
{
    (void)state;
    for (int i = 0; i < 3; ++i) {
        struct world w;
        open_cpu(&w);
        if (i == 0)
            world_use_bent_normals(&w);
        if (i == 1) {
            w.effect_info.noisy_ao = VK_TRUE;
            w.images.ao_noisy = (vkao_image){fake_caller_view(&w.fake), VK_IMAGE_LAYOUT_GENERAL,
                                             VK_FORMAT_R8_UNORM, VK_NULL_HANDLE};
        }
        world_create_frame(&w);
        assert_int_equal(w.frame->program->is_packed, i == 2);
        assert_int_equal(world_record_all(&w), VKAO_SUCCESS);
        world_close(&w);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cpus_have_it_and_others_do_not),
        cmocka_unit_test(strips_cover_the_rect_once),
        cmocka_unit_test(tiles_are_those_of_the_rect),
        cmocka_unit_test(ao_is_copied_if_its_image_is_given),
        cmocka_unit_test(late_passes_that_fail_leave_a_whole_effect),
        cmocka_unit_test(tone_is_compiled_once_and_where_it_is_asked_for),
        cmocka_unit_test(frames_of_two_threads_add_late_passes_once),
        cmocka_unit_test(parts_that_are_needed_together_do_not_overlap),
        cmocka_unit_test(images_follow_parts_that_have_ended),
        cmocka_unit_test(images_of_other_slots_are_refused),
        cmocka_unit_test(frames_too_large_for_buffers_use_images),
        cmocka_unit_test(bent_normals_and_noisy_ao_go_through_images),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
