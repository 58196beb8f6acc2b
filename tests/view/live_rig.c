/* SPDX-License-Identifier: MIT */
#include "live_rig.h"

#include "pixels.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <vulkan/vulkan.h>

static void open_frame(const struct rig *rig, struct rig_flight *f, vkao_projection projection,
                       VkExtent2D extent, const vkao_images *images)
{
    struct orbit camera = live_scene_camera(rig->kind);
    struct ao_view view;
    const struct ao_ssao ssao = ao_ssao_default();
    const struct ao_blur blur = ao_blur_default();
    struct ao_composite composite = ao_composite_default();
    composite.mode = VKAO_COMPOSITE_INDIRECT;
    composite.multi_bounce = rig->multi_bounce;
    camera.orthographic = projection == VKAO_PROJECTION_ORTHOGRAPHIC;
    live_scene_view(&camera, extent, &view);
    vkao_effect_info info = ao_effect(VKAO_STAGE_ALL, &view, &ssao, &blur, &composite);
    info.ao_format = VK_FORMAT_R16_UNORM;
    check_vkao(vkao_effect_create(fixture.context, &info, &f->effects[projection]));
    check_vkao(vkao_frame_create(f->effects[projection],
                                 &(vkao_frame_info){
                                     .struct_size = sizeof(vkao_frame_info),
                                     .extent = extent,
                                     .images = images,
                                 },
                                 &f->frames[projection]));
}

static void open_flight(struct rig *rig, struct rig_flight *f, VkExtent2D extent)
{
    const VkImageUsageFlags usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT;
    struct gpu *gpu = &fixture.gpu;
    vkao_images images = vkao_images_default();
    check(live_target_create(rig->scene, extent, &f->target, &fixture.error));
    check(gpu_image_create(gpu, VK_FORMAT_R16_UNORM, extent, usage, &f->ao, &fixture.error));
    check(gpu_image_create(gpu, VK_FORMAT_R16G16B16A16_SFLOAT, extent, usage, &f->output,
                           &fixture.error));
    live_target_images(&f->target, &images);
    images.ao = gpu_image_slot(&f->ao);
    images.output = gpu_image_slot(&f->output);
    for (int projection = 0; projection < RIG_PROJECTIONS; ++projection)
        open_frame(rig, f, (vkao_projection)projection, extent, &images);
    assert_int_equal(
        vkCreateFence(gpu->device,
                      &(VkFenceCreateInfo){.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO}, NULL,
                      &f->fence),
        VK_SUCCESS);
}

static void close_flight(struct rig *rig, int flight)
{
    struct rig_flight *f = &rig->flights[flight];
    rig_wait(rig, flight);
    vkDestroyFence(fixture.gpu.device, f->fence, NULL);
    for (int projection = 0; projection < RIG_PROJECTIONS; ++projection) {
        vkao_frame_destroy(f->frames[projection]);
        vkao_effect_destroy(f->effects[projection]);
    }
    gpu_image_destroy(&fixture.gpu, &f->ao);
    gpu_image_destroy(&fixture.gpu, &f->output);
    live_target_destroy(&f->target);
    *f = (struct rig_flight){.cmd = NULL};
}

void rig_open(struct rig *rig, enum live_kind kind, uint32_t width, uint32_t height)
{
    *rig = (struct rig){.kind = kind};
    rig->scene = live_scene_create(&fixture.gpu, kind, &fixture.error);
    check(rig->scene != NULL);
    for (int i = 0; i < RIG_FLIGHTS; ++i)
        open_flight(rig, &rig->flights[i], (VkExtent2D){width, height});
}

void rig_resize(struct rig *rig, uint32_t width, uint32_t height)
{
    for (int i = 0; i < RIG_FLIGHTS; ++i)
        close_flight(rig, i);
    for (int i = 0; i < RIG_FLIGHTS; ++i)
        open_flight(rig, &rig->flights[i], (VkExtent2D){width, height});
}

void rig_close(struct rig *rig)
{
    for (int i = 0; i < RIG_FLIGHTS; ++i)
        close_flight(rig, i);
    live_scene_destroy(rig->scene);
}

void rig_record(const struct rig *rig, int flight, VkCommandBuffer cmd, const struct orbit *camera,
                double time, VkExtent2D used)
{
    const struct rig_flight *f = &rig->flights[flight];
    struct ao_view view;
    struct ao_ssao ssao = ao_ssao_default();
    struct ao_blur blur = ao_blur_default();
    struct ao_composite composite = ao_composite_default();
    ssao.radius = live_scene_radius(rig->kind);
    composite.mode = VKAO_COMPOSITE_INDIRECT;
    composite.multi_bounce = rig->multi_bounce;
    live_scene_view(camera, used, &view);
    live_scene_record(rig->scene, &f->target, cmd, camera, time, used);
    const vkao_view library_view = ao_library_view(&view);
    const vkao_params params = ao_params(&ssao, &blur, &composite);
    const vkao_projection projection =
        camera->orthographic ? VKAO_PROJECTION_ORTHOGRAPHIC : VKAO_PROJECTION_PERSPECTIVE;
    check_vkao(vkao_cmd_record(f->frames[projection], cmd, &library_view, &params));
}

void rig_submit(struct rig *rig, int flight, const struct orbit *camera, double time,
                VkExtent2D used)
{
    struct rig_flight *f = &rig->flights[flight];
    rig_wait(rig, flight);
    f->cmd = gpu_begin(&fixture.gpu, &fixture.error);
    check(f->cmd != NULL);
    rig_record(rig, flight, f->cmd, camera, time, used);
    assert_int_equal(vkEndCommandBuffer(f->cmd), VK_SUCCESS);
    assert_int_equal(vkQueueSubmit(fixture.gpu.queue, 1,
                                   &(VkSubmitInfo){
                                       .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                                       .commandBufferCount = 1,
                                       .pCommandBuffers = &f->cmd,
                                   },
                                   f->fence),
                     VK_SUCCESS);
}

void rig_wait(struct rig *rig, int flight)
{
    struct rig_flight *f = &rig->flights[flight];
    VkDevice device = fixture.gpu.device;
    if (!f->cmd)
        return;
    assert_int_equal(vkWaitForFences(device, 1, &f->fence, VK_TRUE, UINT64_MAX), VK_SUCCESS);
    assert_int_equal(vkResetFences(device, 1, &f->fence), VK_SUCCESS);
    vkFreeCommandBuffers(device, fixture.gpu.command_pool, 1, &f->cmd);
    f->cmd = VK_NULL_HANDLE;
}

/* gpu_image_download wants GENERAL; live_scene_record takes any layout. */
static void leave_read_only(const struct gpu_image *image, VkImageLayout layout)
{
    bool depth = image->format == VK_FORMAT_D32_SFLOAT;
    VkCommandBuffer cmd = gpu_begin(&fixture.gpu, &fixture.error);
    check(cmd != NULL);
    /* the render pass' own dependency reaches TRANSFER / TRANSFER_READ -> the copy reads */
    vkCmdPipelineBarrier(
        cmd, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0, NULL, 0, NULL, 1,
        &(VkImageMemoryBarrier){
            .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
            .srcAccessMask = VK_ACCESS_TRANSFER_READ_BIT,
            .dstAccessMask = VK_ACCESS_TRANSFER_READ_BIT,
            .oldLayout = layout,
            .newLayout = VK_IMAGE_LAYOUT_GENERAL,
            .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
            .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
            .image = image->image,
            .subresourceRange = {depth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT, 0,
                                 1, 0, 1},
        });
    check(gpu_submit(&fixture.gpu, cmd, &fixture.error));
}

/* The used texels in doubles, `channels` of each. */
static double *take_image(struct gpu_image *image, VkExtent2D used, uint32_t channels)
{
    size_t width = image->extent.width, texels = width * image->extent.height;
    size_t bytes = texels * gpu_format_bytes(image->format);
    void *data = test_alloc(bytes, 1);
    double *all = test_alloc(texels * 4, sizeof *all);
    double *part = test_alloc((size_t)used.width * used.height * channels, sizeof *part);
    check(gpu_image_download(&fixture.gpu, image, data, bytes, &fixture.error));
    pixels_decode(image->format, data, texels, all);
    for (size_t y = 0; y < used.height; ++y) {
        for (size_t x = 0; x < used.width; ++x)
            memcpy(part + (y * used.width + x) * channels, all + (y * width + x) * 4,
                   channels * sizeof *part);
    }
    free(all);
    free(data);
    return part;
}

void rig_take(struct rig *rig, int flight, const struct orbit *camera, VkExtent2D used,
              struct shot *shot)
{
    struct rig_flight *f = &rig->flights[flight];
    vkao_images slots = vkao_images_default();
    rig_wait(rig, flight);
    live_target_images(&f->target, &slots);
    leave_read_only(&f->target.depth, slots.depth.layout);
    leave_read_only(&f->target.normals, slots.normals.layout);
    leave_read_only(&f->target.indirect, slots.color.layout);
    leave_read_only(&f->target.direct, slots.direct.layout);
    *shot = (struct shot){
        .width = used.width,
        .height = used.height,
        .depth = take_image(&f->target.depth, used, 1),
        .ao = take_image(&f->ao, used, 1),
        .normals = take_image(&f->target.normals, used, 4),
        .indirect = take_image(&f->target.indirect, used, 4),
        .direct = take_image(&f->target.direct, used, 4),
        .output = take_image(&f->output, used, 4),
    };
    live_scene_view(camera, used, &shot->view);
}

void rig_shoot(struct rig *rig, const struct orbit *camera, double time, struct shot *shot)
{
    VkExtent2D extent = rig->flights[0].target.extent;
    rig_submit(rig, 0, camera, time, extent);
    rig_take(rig, 0, camera, extent, shot);
}

size_t shot_texels(const struct shot *shot)
{
    return (size_t)shot->width * shot->height;
}

void shot_free(struct shot *shot)
{
    free(shot->depth);
    free(shot->ao);
    free(shot->normals);
    free(shot->indirect);
    free(shot->direct);
    free(shot->output);
    *shot = (struct shot){.width = 0};
}

void shot_check_equal(const struct shot *a, const struct shot *b)
{
    size_t n = shot_texels(a);
    assert_int_equal(a->width, b->width);
    assert_int_equal(a->height, b->height);
    check_equal("depth", a->depth, b->depth, n);
    check_equal("ao", a->ao, b->ao, n);
    check_equal("normals", a->normals, b->normals, 4 * n);
    check_equal("indirect", a->indirect, b->indirect, 4 * n);
    check_equal("direct", a->direct, b->direct, 4 * n);
    check_equal("output", a->output, b->output, 4 * n);
}

static void transform(const float m[16], const double p[4], double out[4])
{
    for (int row = 0; row < 4; ++row) {
        out[row] = 0;
        for (int k = 0; k < 4; ++k)
            out[row] += (double)m[4 * k + row] * p[k];
    }
}

long shot_texel_of(const struct shot *shot, const struct orbit *camera, const double world[3])
{
    float view[16];
    double v[4], clip[4];
    orbit_view_matrix(camera, view);
    transform(view, (const double[4]){world[0], world[1], world[2], 1}, v);
    transform(shot->view.projection, v, clip);
    double x = floor((clip[0] / clip[3] * 0.5 + 0.5) * shot->width);
    double y = floor((clip[1] / clip[3] * 0.5 + 0.5) * shot->height);
    if (!(x >= 0 && y >= 0 && x < shot->width && y < shot->height))
        return -1;
    long texel = (long)y * (long)shot->width + (long)x;
    struct ref_view ref;
    ref_view_init(&ref, &shot->view, shot->width, shot->height, VK_FORMAT_D32_SFLOAT);
    double z = ref_view_z(&ref, x, y, shot->depth[texel]);
    /* A floor seen at a slant changes by this much from one side of a texel to the other. */
    return fabs(z + v[2]) < 0.02 * -v[2] ? texel : -1;
}
