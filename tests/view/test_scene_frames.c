/* SPDX-License-Identifier: MIT
 *
 * Live scenes from frame to frame: in flight, resized, at a part of their targets' size. */
#include "live_rig.h"

#include <vulkan/vulkan.h>

static const VkExtent2D whole = {320, 180};

static void frames_in_flight_equal_frames_one_by_one(void **state)
{
    (void)state;
    enum { FRAMES = 6 };
    for (int kind = 0; kind < LIVE_KIND_COUNT; ++kind) {
        struct rig rig;
        struct orbit camera = live_scene_camera((enum live_kind)kind);
        struct shot flying[RIG_FLIGHTS], alone;
        rig_open(&rig, (enum live_kind)kind, whole.width, whole.height);
        /* Each submit waits for the one before the last. */
        for (int i = 0; i < FRAMES; ++i) {
            camera.orthographic = i % 3 == 1;
            rig_submit(&rig, i % RIG_FLIGHTS, &camera, i * 0.25, whole);
        }
        for (int i = FRAMES - RIG_FLIGHTS; i < FRAMES; ++i) {
            camera.orthographic = i % 3 == 1;
            rig_take(&rig, i % RIG_FLIGHTS, &camera, whole, &flying[i % RIG_FLIGHTS]);
        }
        for (int i = FRAMES - RIG_FLIGHTS; i < FRAMES; ++i) {
            camera.orthographic = i % 3 == 1;
            rig_shoot(&rig, &camera, i * 0.25, &alone);
            shot_check_equal(&flying[i % RIG_FLIGHTS], &alone);
            shot_free(&flying[i % RIG_FLIGHTS]);
            shot_free(&alone);
        }
        rig_close(&rig);
    }
}

/* What the render pass itself orders: no fence and no barrier of the caller's between two uses, in
 * one command buffer and in two submits, with readers in between and without. */
static void target_may_follow_itself_at_once(void **state)
{
    (void)state;
    struct rig rig;
    struct orbit camera = live_scene_camera(LIVE_ROOM);
    struct shot after, alone;
    VkCommandBuffer first = gpu_begin(&fixture.gpu, &fixture.error);
    check(first != NULL);
    rig_open(&rig, LIVE_ROOM, whole.width, whole.height);
    live_scene_record(rig.scene, &rig.flights[0].target, first, &camera, 1.0, whole);
    rig_record(&rig, 0, first, &camera, 2.0, whole);
    rig_record(&rig, 0, first, &camera, 3.0, whole);
    assert_int_equal(vkEndCommandBuffer(first), VK_SUCCESS);
    assert_int_equal(vkQueueSubmit(fixture.gpu.queue, 1,
                                   &(VkSubmitInfo){
                                       .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                                       .commandBufferCount = 1,
                                       .pCommandBuffers = &first,
                                   },
                                   VK_NULL_HANDLE),
                     VK_SUCCESS);
    rig_submit(&rig, 0, &camera, 4.0, whole);
    rig_take(&rig, 0, &camera, whole, &after);
    vkFreeCommandBuffers(fixture.gpu.device, fixture.gpu.command_pool, 1, &first);
    rig_shoot(&rig, &camera, 4.0, &alone);
    shot_check_equal(&after, &alone);
    shot_free(&after);
    shot_free(&alone);
    rig_close(&rig);
}

static void resized_targets_equal_new_ones(void **state)
{
    (void)state;
    static const VkExtent2D sizes[] = {{200, 150}, {1, 1}, {333, 77}, {64, 301}};
    struct rig resized;
    struct orbit camera = live_scene_camera(LIVE_CUBES);
    rig_open(&resized, LIVE_CUBES, whole.width, whole.height);
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; ++i) {
        struct rig fresh;
        struct shot a, b;
        /* Both flights have work pending when the resize comes. */
        for (int f = 0; f < RIG_FLIGHTS; ++f)
            rig_submit(&resized, f, &camera, 0.5, resized.flights[f].target.extent);
        rig_resize(&resized, sizes[i].width, sizes[i].height);
        rig_shoot(&resized, &camera, 1.0, &a);
        rig_open(&fresh, LIVE_CUBES, sizes[i].width, sizes[i].height);
        rig_shoot(&fresh, &camera, 1.0, &b);
        assert_int_equal(a.width, sizes[i].width);
        shot_check_equal(&a, &b);
        shot_free(&a);
        shot_free(&b);
        rig_close(&fresh);
    }
    rig_close(&resized);
}

/* Dynamic resolution: a part of a large target looks as a small target does. */
static void used_part_equals_a_target_of_that_size(void **state)
{
    (void)state;
    static const VkExtent2D parts[] = {{200, 113}, {320, 64}, {17, 180}, {1, 1}};
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; ++i) {
        struct rig large, small;
        enum live_kind kind = i % 2 ? LIVE_ROOM : LIVE_CUBES;
        struct orbit camera = live_scene_camera(kind);
        struct shot part, all;
        camera.orthographic = i / 2 % 2 != 0;
        rig_open(&large, kind, whole.width, whole.height);
        rig_open(&small, kind, parts[i].width, parts[i].height);
        /* First the whole of it, so that the rest holds something. */
        rig_submit(&large, 0, &camera, 3.0, whole);
        rig_submit(&large, 0, &camera, 1.0, parts[i]);
        rig_take(&large, 0, &camera, parts[i], &part);
        rig_shoot(&small, &camera, 1.0, &all);
        shot_check_equal(&part, &all);
        shot_free(&part);
        shot_free(&all);
        rig_close(&large);
        rig_close(&small);
    }
}

static void empty_targets_and_no_scene_are_destroyed_in_peace(void **state)
{
    (void)state;
    struct live_target target = {0};
    live_target_destroy(&target);
    live_scene_destroy(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        gpu_test(frames_in_flight_equal_frames_one_by_one),
        gpu_test(target_may_follow_itself_at_once),
        gpu_test(resized_targets_equal_new_ones),
        gpu_test(used_part_equals_a_target_of_that_size),
        gpu_test(empty_targets_and_no_scene_are_destroyed_in_peace),
    };
    return fixture_run(tests);
}
