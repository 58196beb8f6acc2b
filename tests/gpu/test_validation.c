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
    if (p->staged && p->formats[SLOT_AO])
        g.slots.ao.image = (VkImage)(uintptr_t)1; /* whether there is one matters */
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

/* What was recorded before is worth nothing. */
static void validation_sees_a_frame_updated_between_recording_and_submit(void **state)
{
    (void)state;
    struct picture p;
    struct picture_gpu g;
    make(&p, scene_corner());
    picture_open(&p, &g);
    VkCommandBuffer cmd = gpu_begin(&fixture.gpu, &fixture.error);
    picture_record(&p, &g, cmd);
    check_vkao(vkao_frame_update(g.frame, &g.slots));
    fixture.gpu.print_validation = false;
    (void)gpu_submit(&fixture.gpu, cmd, &fixture.error);
    const uint32_t messages = fixture.gpu.validation_messages;
    fixture.gpu.validation_messages = 0;
    fixture.gpu.print_validation = true;
    cmd = gpu_begin(&fixture.gpu, &fixture.error);
    picture_record(&p, &g, cmd);
    check(gpu_submit(&fixture.gpu, cmd, &fixture.error));
    picture_close(&g);
    picture_free(&p);
    assert_true(messages > 0);
}

/* --- The last use of an image that vkao writes, and the barrier of the header for it --- */

enum last_use { READ, WRITTEN, COPIED_FROM, CLEARED, DRAWN, NONE, LAST_USES };

static const struct {
    const char *name;
    VkPipelineStageFlags stages;
    VkAccessFlags access;
} last_uses[LAST_USES] = {
    [READ] = {"read by a shader", VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, 0},
    [WRITTEN] = {"written by vkao", VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                 VK_ACCESS_SHADER_WRITE_BIT},
    [COPIED_FROM] = {"copied from", VK_PIPELINE_STAGE_TRANSFER_BIT, 0},
    [CLEARED] = {"cleared", VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT},
    [DRAWN] = {"drawn to", VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT,
               VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT},
    [NONE] = {"not used", VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT, 0},
};

/* An AO image, and all that may use it before vkao writes it. */
struct used_ao {
    struct picture p;
    struct picture_gpu g;
    struct gpu_image ao, shown;
    struct gpu_buffer home;
    vkao_frame *frame, *reading;
    vkao_effect *reading_effect;
    VkRenderPass pass;
    VkFramebuffer framebuffer;
};

static bool can_draw(void)
{
    VkQueueFamilyProperties families[16];
    uint32_t count = 16;
    vkGetPhysicalDeviceQueueFamilyProperties(fixture.gpu.physical_device, &count, families);
    return fixture.gpu.queue_family < count &&
           families[fixture.gpu.queue_family].queueFlags & VK_QUEUE_GRAPHICS_BIT;
}

static void create_pass(struct used_ao *u)
{
    const VkAttachmentDescription attachment = {
        .format = u->ao.format,
        .samples = VK_SAMPLE_COUNT_1_BIT,
        .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
        .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
        .initialLayout = VK_IMAGE_LAYOUT_GENERAL,
        .finalLayout = VK_IMAGE_LAYOUT_GENERAL,
    };
    const VkAttachmentReference color = {0, VK_IMAGE_LAYOUT_GENERAL};
    const VkSubpassDescription subpass = {.colorAttachmentCount = 1, .pColorAttachments = &color};
    assert_int_equal(vkCreateRenderPass(fixture.gpu.device,
                                        &(VkRenderPassCreateInfo){
                                            .sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO,
                                            .attachmentCount = 1,
                                            .pAttachments = &attachment,
                                            .subpassCount = 1,
                                            .pSubpasses = &subpass,
                                        },
                                        NULL, &u->pass),
                     VK_SUCCESS);
    assert_int_equal(vkCreateFramebuffer(fixture.gpu.device,
                                         &(VkFramebufferCreateInfo){
                                             .sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO,
                                             .renderPass = u->pass,
                                             .attachmentCount = 1,
                                             .pAttachments = &u->ao.view,
                                             .width = u->ao.extent.width,
                                             .height = u->ao.extent.height,
                                             .layers = 1,
                                         },
                                         NULL, &u->framebuffer),
                     VK_SUCCESS);
}

static void create_frames(struct used_ao *u)
{
    vkao_frame_info info;
    u->g.slots.ao = gpu_image_slot(&u->ao);
    u->g.slots.ao.image = u->ao.image; /* where it is faster, vkao copies into it */
    picture_frame_info(&u->p, &u->g, &info);
    check_vkao(vkao_frame_create(u->g.effect, &info, &u->frame));
    vkao_effect_info shows = vkao_effect_info_default();
    shows.stages = VKAO_STAGE_COMPOSITE;
    shows.composite_mode = VKAO_COMPOSITE_AO_ONLY;
    check_vkao(vkao_effect_create(fixture.context, &shows, &u->reading_effect));
    vkao_images images = vkao_images_default();
    images.ao = gpu_image_slot(&u->ao);
    images.output = gpu_image_slot(&u->shown);
    info.images = &images;
    check_vkao(vkao_frame_create(u->reading_effect, &info, &u->reading));
}

static void open_used(struct used_ao *u)
{
    const VkExtent2D extent = {80, 60};
    const VkImageUsageFlags usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_STORAGE_BIT;
    const struct scene scene = scene_corner();
    *u = (struct used_ao){.frame = NULL};
    picture_make(&u->p, VKAO_STAGE_SSAO | VKAO_STAGE_BLUR, &scene);
    picture_set(&u->p, SLOT_AO, VK_FORMAT_R8_UNORM, NULL);
    picture_open(&u->p, &u->g);
    check(gpu_image_create(&fixture.gpu, VK_FORMAT_R8_UNORM, extent,
                           usage | (can_draw() ? VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT : 0u), &u->ao,
                           &fixture.error));
    check(gpu_image_create(&fixture.gpu, VK_FORMAT_R8G8B8A8_UNORM, extent, usage, &u->shown,
                           &fixture.error));
    check(gpu_buffer_create(&fixture.gpu, 80 * 60, VK_BUFFER_USAGE_TRANSFER_DST_BIT, &u->home,
                            &fixture.error));
    create_frames(u);
    if (can_draw())
        create_pass(u);
}

static void close_used(struct used_ao *u)
{
    vkao_frame_destroy(u->frame);
    vkao_frame_destroy(u->reading);
    vkao_effect_destroy(u->reading_effect);
    vkDestroyFramebuffer(fixture.gpu.device, u->framebuffer, NULL);
    vkDestroyRenderPass(fixture.gpu.device, u->pass, NULL);
    gpu_buffer_destroy(&fixture.gpu, &u->home);
    gpu_image_destroy(&fixture.gpu, &u->ao);
    gpu_image_destroy(&fixture.gpu, &u->shown);
    picture_close(&u->g);
    picture_free(&u->p);
}

static void record_frame(const struct used_ao *u, const vkao_frame *frame, VkCommandBuffer cmd)
{
    const vkao_view view = ao_library_view(&u->p.view);
    const vkao_params params = vkao_params_default();
    check_vkao(vkao_cmd_record(frame, cmd, &view, &params));
}

static void use(const struct used_ao *u, VkCommandBuffer cmd, enum last_use last)
{
    const VkClearColorValue black = {{0.0f, 0.0f, 0.0f, 0.0f}};
    const VkImageSubresourceRange range = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    const VkBufferImageCopy all = {.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                   .imageExtent = {80, 60, 1}};
    const VkRenderPassBeginInfo draw = {
        .sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO,
        .renderPass = u->pass,
        .framebuffer = u->framebuffer,
        .renderArea = {{0, 0}, u->ao.extent},
        .clearValueCount = 1,
        .pClearValues = &(VkClearValue){.color = black},
    };
    if (last == READ || last == WRITTEN) {
        record_frame(u, last == READ ? u->reading : u->frame, cmd);
    } else if (last == COPIED_FROM) {
        vkCmdCopyImageToBuffer(cmd, u->ao.image, VK_IMAGE_LAYOUT_GENERAL, u->home.buffer, 1, &all);
    } else if (last == CLEARED) {
        vkCmdClearColorImage(cmd, u->ao.image, VK_IMAGE_LAYOUT_GENERAL, &black, 1, &range);
    } else if (last == DRAWN) {
        vkCmdBeginRenderPass(cmd, &draw, VK_SUBPASS_CONTENTS_INLINE);
        vkCmdEndRenderPass(cmd);
    }
}

/* Messages of the layers when the barrier from those stages and accesses stands between the last
 * use and vkao, in one submit or in two. */
static uint32_t messages_of(const struct used_ao *u, enum last_use last, bool across_submits,
                            VkImageLayout from, VkPipelineStageFlags stages, VkAccessFlags access)
{
    const VkImageMemoryBarrier anew = {VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
                                       NULL,
                                       access,
                                       VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT,
                                       from,
                                       VK_IMAGE_LAYOUT_GENERAL,
                                       VK_QUEUE_FAMILY_IGNORED,
                                       VK_QUEUE_FAMILY_IGNORED,
                                       u->ao.image,
                                       {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
    VkCommandBuffer cmds[2] = {gpu_begin(&fixture.gpu, &fixture.error)};
    use(u, cmds[0], last);
    cmds[1] = across_submits ? gpu_begin(&fixture.gpu, &fixture.error) : cmds[0];
    vkCmdPipelineBarrier(cmds[1], stages,
                         VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT, 0,
                         0, NULL, 0, NULL, 1, &anew);
    record_frame(u, u->frame, cmds[1]);
    for (int i = 0; i <= across_submits; ++i)
        submit(cmds[i]);
    assert_int_equal(vkQueueWaitIdle(fixture.gpu.queue), VK_SUCCESS);
    vkFreeCommandBuffers(fixture.gpu.device, fixture.gpu.command_pool, 1u + across_submits, cmds);
    const uint32_t messages = fixture.gpu.validation_messages;
    fixture.gpu.validation_messages = 0;
    return messages;
}

static void barriers_that_the_header_names_are_right_and_needed(void **state)
{
    (void)state;
    struct used_ao u;
    open_used(&u);
    for (int i = 0; i < LAST_USES * 2; ++i) {
        const enum last_use last = (enum last_use)(i / 2);
        const bool across = i % 2;
        const VkPipelineStageFlags stages = last_uses[last].stages;
        const VkAccessFlags access = last_uses[last].access;
        if (last == DRAWN && !can_draw())
            continue;
        const VkImageLayout layouts[] = {VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_GENERAL};
        for (int k = 0; k < 2; ++k)
            if (messages_of(&u, last, across, layouts[k], stages, access))
                fail_msg("%s, %s: the barrier is a hazard", last_uses[last].name,
                         across ? "two submits" : "one submit");
        if (last == NONE)
            continue;
        fixture.gpu.print_validation = false;
        const uint32_t none = messages_of(&u, last, across, VK_IMAGE_LAYOUT_UNDEFINED,
                                          VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT, 0),
                       short_of =
                           messages_of(&u, last, across, VK_IMAGE_LAYOUT_UNDEFINED, stages, 0);
        fixture.gpu.print_validation = true;
        if (!none || (access && !short_of))
            fail_msg("%s, %s: %u messages without a barrier, %u without srcAccessMask",
                     last_uses[last].name, across ? "two submits" : "one submit", none, short_of);
    }
    close_used(&u);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        gpu_test(validation_sees_a_missing_barrier_within_a_command_buffer),
        gpu_test(validation_sees_a_missing_barrier_between_submits),
        gpu_test(validation_sees_a_caller_who_forgets_the_barrier_after_vkao),
        gpu_test(validation_sees_a_frame_updated_between_recording_and_submit),
        gpu_test(barriers_that_the_header_names_are_right_and_needed),
        gpu_test(callers_scratch_at_an_offset_gives_the_same_picture),
        gpu_test(frames_at_different_offsets_do_not_touch_each_other),
        gpu_test(misaligned_scratch_is_refused),
        gpu_test(frames_in_flight_share_scratch),
        gpu_test(frames_of_one_command_buffer_share_scratch),
        gpu_test(scratch_query_equals_what_create_allocates),
    };
    return fixture_run(tests);
}
