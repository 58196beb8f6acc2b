/* SPDX-License-Identifier: MIT
 *
 * Scratch memory, frames in flight, and whether the validation layers, whose silence every GPU test
 * relies on, are awake. */
#include "fixture.h"

#include <stdlib.h>
#include <string.h>

static void make(struct picture *p, struct scene scene)
{
    picture_make(p, VKAO_STAGE_ALL, &scene);
    picture_fill(p, SLOT_COLOR, VK_FORMAT_R16G16B16A16_SFLOAT, 0.5);
    picture_set(p, SLOT_OUTPUT, VK_FORMAT_R16G16B16A16_SFLOAT, NULL);
}

/* Ends cmd and submits it without waiting. */
static void submit(VkCommandBuffer cmd)
{
    assert_int_equal(vkEndCommandBuffer(cmd), VK_SUCCESS);
    assert_int_equal(vkQueueSubmit(fixture.gpu.queue, 1,
                                   &(VkSubmitInfo){
                                       .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                                       .commandBufferCount = 1,
                                       .pCommandBuffers = &cmd,
                                   },
                                   VK_NULL_HANDLE),
                     VK_SUCCESS);
}

static VkMemoryRequirements requirements_of(const struct picture *p)
{
    vkao_frame_info info;
    VkMemoryRequirements out;
    struct picture_gpu g = {.slots = vkao_images_default()};
    picture_frame_info(p, &g, &info); /* formats are enough, views are not needed */
    for (int i = 0; i < SLOT_COUNT; ++i) {
        *picture_slot_image(&g.slots, (enum picture_slot)i) = (vkao_image){
            .layout = p->formats[i] ? VK_IMAGE_LAYOUT_GENERAL : VK_IMAGE_LAYOUT_UNDEFINED,
            .format = p->formats[i],
        };
    }
    vkao_effect *effect = picture_effect(p, fixture.context);
    check_vkao(vkao_frame_scratch(effect, &info, &out));
    vkao_effect_destroy(effect);
    return out;
}

static void callers_scratch_at_an_offset_gives_the_same_picture(void **state)
{
    (void)state;
    struct picture own, callers;
    make(&own, scene_corner());
    make(&callers, scene_corner());
    VkMemoryRequirements r = requirements_of(&callers);
    callers.scratch_offset = 3 * r.alignment;
    callers.scratch_memory = fixture_allocate(&r, r.size + callers.scratch_offset);
    picture_run(&own);
    picture_run(&callers);
    check_equal("output", callers.values[SLOT_OUTPUT], own.values[SLOT_OUTPUT],
                picture_texels(&own) * 4);
    vkFreeMemory(fixture.gpu.device, callers.scratch_memory, NULL);
    picture_free(&own);
    picture_free(&callers);
}

/* Two frames side by side in one memory, their stages interleaved: each must keep its place. */
static void frames_at_different_offsets_do_not_touch_each_other(void **state)
{
    (void)state;
    struct picture alone[2], p[2];
    struct picture_gpu g[2];
    const struct scene scenes[2] = {scene_corner(), scene_steps()};
    for (int i = 0; i < 2; ++i) {
        make(&alone[i], scenes[i]);
        make(&p[i], scenes[i]);
        picture_run(&alone[i]);
    }
    VkMemoryRequirements r = requirements_of(&p[0]);
    VkDeviceSize second = (r.size + r.alignment - 1) / r.alignment * r.alignment;
    p[0].scratch_memory = p[1].scratch_memory = fixture_allocate(&r, second + r.size);
    p[1].scratch_offset = second;
    for (int i = 0; i < 2; ++i)
        picture_open(&p[i], &g[i]);
    VkCommandBuffer cmd = gpu_begin(&fixture.gpu, &fixture.error);
    for (int i = 0; i < 2; ++i)
        picture_record_stages(&p[i], &g[i], cmd, VKAO_STAGE_PREPARE);
    for (int i = 0; i < 2; ++i)
        picture_record_stages(&p[i], &g[i], cmd, VKAO_STAGE_SSAO);
    for (int i = 0; i < 2; ++i)
        picture_record_stages(&p[i], &g[i], cmd, VKAO_STAGE_BLUR);
    check(gpu_submit(&fixture.gpu, cmd, &fixture.error));
    for (int i = 0; i < 2; ++i) {
        picture_download(&p[i], &g[i]);
        check_equal("ao", p[i].values[SLOT_AO], alone[i].values[SLOT_AO], picture_texels(&p[i]));
        picture_close(&g[i]);
    }
    vkFreeMemory(fixture.gpu.device, p[0].scratch_memory, NULL);
    for (int i = 0; i < 2; ++i) {
        picture_free(&alone[i]);
        picture_free(&p[i]);
    }
}

static void misaligned_scratch_is_refused(void **state)
{
    (void)state;
    struct picture p;
    struct picture_gpu g;
    vkao_frame_info info;
    vkao_frame *frame;
    make(&p, scene_corner());
    VkMemoryRequirements r = requirements_of(&p);
    assert_true(r.alignment > 1);
    picture_open(&p, &g);
    picture_frame_info(&p, &g, &info);
    info.scratch_memory = fixture_allocate(&r, r.size + r.alignment);
    info.scratch_offset = 1;
    assert_int_equal(vkao_frame_create(g.effect, &info, &frame), VKAO_ERROR_INVALID_ARGUMENT);
    assert_null(frame);
    vkFreeMemory(fixture.gpu.device, info.scratch_memory, NULL);
    picture_close(&g);
    picture_free(&p);
}

/* Two frames, one scratch memory, submits without a wait between them: A B A B. */
static void frames_in_flight_share_scratch(void **state)
{
    (void)state;
    struct picture alone[2], shared[2];
    struct picture_gpu g[2];
    VkCommandBuffer cmds[6];
    const struct scene scenes[2] = {scene_corner(), scene_steps()};
    for (int i = 0; i < 2; ++i) {
        make(&alone[i], scenes[i]);
        make(&shared[i], scenes[i]);
        picture_run(&alone[i]);
    }
    VkMemoryRequirements r = requirements_of(&shared[0]);
    VkDeviceMemory memory = fixture_allocate(&r, r.size + r.alignment);
    for (int i = 0; i < 2; ++i) {
        shared[i].scratch_memory = memory;
        shared[i].scratch_offset = r.alignment;
        picture_open(&shared[i], &g[i]);
    }
    for (int i = 0; i < 6; ++i) {
        cmds[i] = gpu_begin(&fixture.gpu, &fixture.error);
        assert_non_null(cmds[i]);
        picture_record(&shared[i % 2], &g[i % 2], cmds[i]);
    }
    for (int i = 0; i < 6; ++i)
        submit(cmds[i]);
    assert_int_equal(vkQueueWaitIdle(fixture.gpu.queue), VK_SUCCESS);
    vkFreeCommandBuffers(fixture.gpu.device, fixture.gpu.command_pool, 6, cmds);
    for (int i = 0; i < 2; ++i) {
        picture_download(&shared[i], &g[i]);
        check_equal("ao", shared[i].values[SLOT_AO], alone[i].values[SLOT_AO],
                    picture_texels(&alone[i]));
        check_equal("output", shared[i].values[SLOT_OUTPUT], alone[i].values[SLOT_OUTPUT],
                    picture_texels(&alone[i]) * 4);
        picture_close(&g[i]);
        picture_free(&alone[i]);
        picture_free(&shared[i]);
    }
    vkFreeMemory(fixture.gpu.device, memory, NULL);
}

/* One command buffer with both frames, several times over. */
static void frames_of_one_command_buffer_share_scratch(void **state)
{
    (void)state;
    struct picture alone[2], shared[2];
    struct picture_gpu g[2];
    const struct scene scenes[2] = {scene_corner(), scene_steps()};
    make(&shared[0], scenes[0]);
    VkMemoryRequirements r = requirements_of(&shared[0]);
    VkDeviceMemory memory = fixture_allocate(&r, r.size);
    VkCommandBuffer cmd = gpu_begin(&fixture.gpu, &fixture.error);
    picture_free(&shared[0]);
    for (int i = 0; i < 2; ++i) {
        make(&alone[i], scenes[i]);
        make(&shared[i], scenes[i]);
        picture_run(&alone[i]);
        shared[i].scratch_memory = memory;
        picture_open(&shared[i], &g[i]);
    }
    for (int i = 0; i < 4; ++i)
        picture_record(&shared[i % 2], &g[i % 2], cmd);
    check(gpu_submit(&fixture.gpu, cmd, &fixture.error));
    for (int i = 0; i < 2; ++i) {
        picture_download(&shared[i], &g[i]);
        check_equal("output", shared[i].values[SLOT_OUTPUT], alone[i].values[SLOT_OUTPUT],
                    picture_texels(&alone[i]) * 4);
        picture_close(&g[i]);
        picture_free(&alone[i]);
        picture_free(&shared[i]);
    }
    vkFreeMemory(fixture.gpu.device, memory, NULL);
}

/* What went through vkAllocateMemory since the counters were reset. */
static uint32_t allocations;
static VkDeviceSize allocated_bytes;

static VKAPI_ATTR VkResult VKAPI_CALL counting_allocate(VkDevice device,
                                                        const VkMemoryAllocateInfo *info,
                                                        const VkAllocationCallbacks *allocator,
                                                        VkDeviceMemory *out)
{
    ++allocations;
    allocated_bytes += info->allocationSize;
    return vkAllocateMemory(device, info, allocator, out);
}

static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL counting_proc_addr(VkDevice device,
                                                                   const char *name)
{
    if (strcmp(name, "vkAllocateMemory") == 0)
        return (PFN_vkVoidFunction)counting_allocate;
    return vkGetDeviceProcAddr(device, name);
}

static void scratch_query_equals_what_create_allocates(void **state)
{
    (void)state;
    static const vkao_stage_flags stages[] = {VKAO_STAGE_SSAO,
                                              VKAO_STAGE_BLUR,
                                              VKAO_STAGE_SSAO | VKAO_STAGE_BLUR,
                                              VKAO_STAGE_COMPOSITE,
                                              VKAO_STAGE_SSAO | VKAO_STAGE_COMPOSITE,
                                              VKAO_STAGE_ALL};
    vkao_context *context;
    vkao_context_info counting = fixture_context_info();
    counting.get_device_proc_addr = counting_proc_addr;
    check_vkao(vkao_context_create(&counting, &context));
    for (size_t i = 0; i < sizeof stages / sizeof stages[0] * 2; ++i) {
        struct picture p;
        struct picture_gpu g;
        vkao_frame_info info;
        vkao_frame *frame;
        make(&p, scene_corner());
        picture_set(&p, SLOT_NOISY, VK_FORMAT_R8_UNORM, NULL);
        p.stages = stages[i / 2];
        bool makes_ao = p.stages & (VKAO_STAGE_SSAO | VKAO_STAGE_BLUR);
        /* Half the rows leave to scratch what may be left to it. */
        if (i % 2 && (p.stages & VKAO_STAGE_SSAO))
            p.formats[SLOT_NOISY] = VK_FORMAT_UNDEFINED;
        if (i % 2 && makes_ao && (p.stages & VKAO_STAGE_COMPOSITE))
            p.formats[SLOT_AO] = VK_FORMAT_UNDEFINED;
        VkMemoryRequirements r = requirements_of(&p);
        picture_open(&p, &g);
        picture_frame_info(&p, &g, &info);
        allocations = 0;
        allocated_bytes = 0;
        vkao_effect *effect = picture_effect(&p, context);
        check_vkao(vkao_frame_create(effect, &info, &frame));
        assert_int_equal(allocations, 1);
        assert_int_equal(allocated_bytes, r.size);
        vkao_frame_destroy(frame);
        vkao_effect_destroy(effect);
        picture_close(&g);
        picture_free(&p);
    }
    vkao_context_destroy(context);
}

/* Clears the image and then copies from it, with nothing in between: a hazard that the layers must
 * see, within one command buffer and from one submit to the next. */
static void check_hazard_is_reported(bool across_submits)
{
    struct gpu_image image;
    VkCommandBuffer cmds[2];
    const VkImageSubresourceRange range = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    const VkClearColorValue black = {{0.0f, 0.0f, 0.0f, 0.0f}};
    check(gpu_image_create(&fixture.gpu, VK_FORMAT_R32_SFLOAT, (VkExtent2D){8, 8},
                           VK_IMAGE_USAGE_STORAGE_BIT, &image, &fixture.error));
    assert_int_equal(fixture.gpu.validation_messages, 0);
    fixture.gpu.print_validation = false;
    for (int i = 0; i < 2; ++i) {
        cmds[i] = gpu_begin(&fixture.gpu, &fixture.error);
        for (int k = 0; k < (across_submits ? 1 : 2); ++k)
            vkCmdClearColorImage(cmds[i], image.image, VK_IMAGE_LAYOUT_GENERAL, &black, 1, &range);
    }
    for (int i = 0; i < 2; ++i)
        submit(cmds[i]);
    assert_int_equal(vkQueueWaitIdle(fixture.gpu.queue), VK_SUCCESS);
    uint32_t messages = fixture.gpu.validation_messages;
    fixture.gpu.validation_messages = 0;
    fixture.gpu.print_validation = true;
    vkFreeCommandBuffers(fixture.gpu.device, fixture.gpu.command_pool, 2, cmds);
    gpu_image_destroy(&fixture.gpu, &image);
    assert_true(messages > 0);
}

static void validation_sees_a_missing_barrier_within_a_command_buffer(void **state)
{
    (void)state;
    check_hazard_is_reported(false);
}

static void validation_sees_a_missing_barrier_between_submits(void **state)
{
    (void)state;
    check_hazard_is_reported(true);
}

/* The hazard that matters here: compute writes ao, compute of the next submit writes it again, and
 * the only thing between them is the library's own barrier. Reading it by a copy without a barrier
 * is the caller's fault, and seen. */
static void validation_sees_a_caller_who_forgets_the_barrier_after_vkao(void **state)
{
    (void)state;
    struct picture p;
    struct picture_gpu g;
    const VkImageSubresourceRange range = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    const VkClearColorValue black = {{0.0f, 0.0f, 0.0f, 0.0f}};
    make(&p, scene_corner());
    picture_open(&p, &g);
    VkCommandBuffer cmd = gpu_begin(&fixture.gpu, &fixture.error);
    picture_record(&p, &g, cmd);
    assert_int_equal(fixture.gpu.validation_messages, 0);
    fixture.gpu.print_validation = false;
    vkCmdClearColorImage(cmd, g.images[SLOT_AO].image, VK_IMAGE_LAYOUT_GENERAL, &black, 1, &range);
    check(gpu_submit(&fixture.gpu, cmd, &fixture.error));
    uint32_t messages = fixture.gpu.validation_messages;
    fixture.gpu.validation_messages = 0;
    fixture.gpu.print_validation = true;
    picture_close(&g);
    picture_free(&p);
    assert_true(messages > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        gpu_test(validation_sees_a_missing_barrier_within_a_command_buffer),
        gpu_test(validation_sees_a_missing_barrier_between_submits),
        gpu_test(validation_sees_a_caller_who_forgets_the_barrier_after_vkao),
        gpu_test(callers_scratch_at_an_offset_gives_the_same_picture),
        gpu_test(frames_at_different_offsets_do_not_touch_each_other),
        gpu_test(misaligned_scratch_is_refused),
        gpu_test(frames_in_flight_share_scratch),
        gpu_test(frames_of_one_command_buffer_share_scratch),
        gpu_test(scratch_query_equals_what_create_allocates),
    };
    return fixture_run(tests);
}
