/* SPDX-License-Identifier: MIT
 *
 * The library on a device, as an engine would drive it: images uploaded once, one recording per
 * frame, nothing read back. */
#include "speed.h"

#include <string.h>
#include <vulkan/vulkan.h>

bool speed_device_create(const char *device, struct speed_features features, struct speed_device *d,
                         struct tool_error *err)
{
    const struct gpu_options options = {.device = device};
    *d = (struct speed_device){.features = features};
    return gpu_create(&options, &d->gpu, err) && stage_clock_create(&d->gpu, &d->clock, err);
}

/* Of any size: what a variant takes from a view does not depend on it. */
static vkao_view room_view(VkExtent2D extent)
{
    vkao_view view = vkao_view_default();
    view.depth_encoding = VKAO_DEPTH_VIEW_Z;
    view.normal_encoding = VKAO_NORMALS_XYZ_SNORM;
    room_projection(extent.width, extent.height, view.projection);
    return view;
}

static const VkFormat depth_format = VK_FORMAT_R32_SFLOAT, normal_format = VK_FORMAT_R8G8B8A8_SNORM,
                      ao_format = VK_FORMAT_R8_UNORM, color_format = VK_FORMAT_R16G16B16A16_SFLOAT;

static vkao_stage_flags stages_of(struct speed_features features)
{
    return VKAO_STAGE_SSAO | VKAO_STAGE_BLUR | (features.composite ? VKAO_STAGE_COMPOSITE : 0u);
}

bool speed_device_compile(struct speed_device *d, const struct config *configs, size_t count,
                          struct tool_error *err)
{
    const vkao_view view = room_view((VkExtent2D){1920, 1080});
    struct ao_job jobs[MAX_CONFIGS];
    vkao_variant variants[MAX_CONFIGS];
    vkao_context_info info = gpu_context_info(&d->gpu, 0);
    for (size_t i = 0; i < count; i++) {
        config_apply(&configs[i], &jobs[i]);
        variants[i] = (vkao_variant){
            .struct_size = sizeof variants[i],
            .half_resolution = jobs[i].half_resolution,
            .bent_normals = d->features.bent_normals,
            .staged_ao = ao_format,
            .view = &view,
            .ssao = &jobs[i].ssao,
            .blur = &jobs[i].blur,
        };
    }
    info.half_view_z = d->features.half_view_z;
    info.variants = variants;
    info.variant_count = (uint32_t)count;
    info.variants_only = VK_TRUE;
    info.stage_mask = stages_of(d->features);
    stage_clock_hook(&info);
    vkao_context_destroy(d->ctx);
    double start = speed_now_ms();
    d->ctx = gpu_context_create(&info, err);
    d->context_ms = speed_now_ms() - start;
    return d->ctx != NULL;
}

void speed_device_destroy(struct speed_device *d)
{
    if (d->gpu.device)
        stage_clock_destroy(&d->clock);
    vkao_context_destroy(d->ctx);
    gpu_destroy(&d->gpu);
    *d = (struct speed_device){0};
}

/* --- Images --- */

/* What engines have: 8-bit normals and AO, half-float colour. */

static vkao_image slot(VkFormat format, const struct gpu_image *image)
{
    vkao_image empty = {.layout = VK_IMAGE_LAYOUT_GENERAL, .format = format};
    return image ? gpu_image_slot(image) : empty;
}

void speed_frame_info(struct speed_features features, VkExtent2D extent, bool half_resolution,
                      const struct speed_images *on_device, vkao_images *images,
                      vkao_frame_info *info)
{
    const struct speed_images *on = on_device;
    *images = vkao_images_default();
    images->depth = slot(depth_format, on ? &on->depth : NULL);
    images->normals = slot(normal_format, on ? &on->normals : NULL);
    images->ao = slot(ao_format, on ? &on->ao : NULL);
    if (on)
        images->ao_image = on->ao.image;
    if (features.bent_normals)
        images->bent_normals = slot(normal_format, on ? &on->bent : NULL);
    if (features.composite) {
        images->color = slot(color_format, on ? &on->color : NULL);
        images->output = slot(color_format, on ? &on->output : NULL);
    }
    *info = (vkao_frame_info){
        .struct_size = sizeof *info,
        .stages = stages_of(features),
        .extent = extent,
        .images = images,
        .half_resolution = half_resolution,
    };
}

static bool create_images(struct speed_device *d, struct speed_images *i, struct tool_error *err)
{
    const VkImageUsageFlags in = VK_IMAGE_USAGE_SAMPLED_BIT, out = VK_IMAGE_USAGE_STORAGE_BIT;
    struct gpu *gpu = &d->gpu;
    return gpu_image_create(gpu, depth_format, i->extent, in, &i->depth, err) &&
           gpu_image_create(gpu, normal_format, i->extent, in, &i->normals, err) &&
           gpu_image_create(gpu, ao_format, i->extent, in | out, &i->ao, err) &&
           (!d->features.bent_normals ||
            gpu_image_create(gpu, normal_format, i->extent, in | out, &i->bent, err)) &&
           (!d->features.composite ||
            (gpu_image_create(gpu, color_format, i->extent, in, &i->color, err) &&
             gpu_image_create(gpu, color_format, i->extent, out, &i->output, err)));
}

/* AO takes the same time on every colour, but memory that nobody wrote may hold NaN. */
static bool clear_color(struct speed_device *d, struct speed_images *images, struct tool_error *err)
{
    VkCommandBuffer cmd = gpu_begin(&d->gpu, err);
    if (!cmd)
        return false;
    vkCmdClearColorImage(cmd, images->color.image, VK_IMAGE_LAYOUT_GENERAL,
                         &(VkClearColorValue){.float32 = {0.5f, 0.5f, 0.5f, 1.0f}}, 1,
                         &(VkImageSubresourceRange){VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1});
    gpu_full_barrier(cmd);
    return gpu_submit(&d->gpu, cmd, err);
}

/* One block for both frames: they run in turn. */
static bool create_scratch(struct speed_device *d, struct speed_images *images,
                           struct tool_error *err)
{
    VkMemoryRequirements both = {.alignment = 1, .memoryTypeBits = UINT32_MAX};
    for (int half = 0; half < 2; half++) {
        VkMemoryRequirements need;
        vkao_images slots;
        vkao_frame_info info;
        speed_frame_info(d->features, images->extent, half, images, &slots, &info);
        vkao_result result = vkao_frame_scratch(d->ctx, &info, &need);
        if (result != VKAO_SUCCESS)
            return gpu_library_failed(err, "vkao_frame_scratch", result);
        both.size = need.size > both.size ? need.size : both.size;
        both.memoryTypeBits &= need.memoryTypeBits;
    }
    return gpu_allocate(&d->gpu, &both, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, &images->scratch, err);
}

static bool create_frames(struct speed_device *d, struct speed_images *images,
                          struct tool_error *err)
{
    for (int half = 0; half < 2; half++) {
        vkao_images slots;
        vkao_frame_info info;
        speed_frame_info(d->features, images->extent, half, images, &slots, &info);
        info.scratch_memory = images->scratch;
        vkao_result result = vkao_frame_create(d->ctx, &info, &images->frames[half]);
        if (result != VKAO_SUCCESS)
            return gpu_library_failed(err, "vkao_frame_create", result);
    }
    return true;
}

bool speed_size_check(const struct speed_device *d, VkExtent2D size, struct tool_error *err)
{
    const uint32_t most = d->gpu.properties.limits.maxImageDimension2D;
    return (size.width <= most && size.height <= most) ||
           fail(err, EXIT_DEVICE, "%u x %u texels: maxImageDimension2D of %s is %u", size.width,
                size.height, d->gpu.properties.deviceName, most);
}

bool speed_images_create(struct speed_device *d, const struct room *room,
                         struct speed_images *images, struct tool_error *err)
{
    const uint64_t bytes = (uint64_t)room->width * room->height * 4;
    *images = (struct speed_images){.extent = {room->width, room->height}};
    if (create_images(d, images, err) &&
        gpu_image_upload(&d->gpu, &images->depth, room->z, bytes, err) &&
        gpu_image_upload(&d->gpu, &images->normals, room->normals, bytes, err) &&
        (!d->features.composite || clear_color(d, images, err)) && create_scratch(d, images, err) &&
        create_frames(d, images, err))
        return true;
    speed_images_destroy(d, images);
    return false;
}

void speed_images_destroy(struct speed_device *d, struct speed_images *images)
{
    struct gpu_image *all[] = {&images->depth, &images->normals, &images->ao,
                               &images->bent,  &images->color,   &images->output};
    for (int half = 0; half < 2; half++)
        vkao_frame_destroy(images->frames[half]);
    for (size_t i = 0; d->gpu.device && i < sizeof all / sizeof all[0]; i++)
        gpu_image_destroy(&d->gpu, all[i]);
    if (images->scratch)
        vkFreeMemory(d->gpu.device, images->scratch, NULL);
    *images = (struct speed_images){0};
}

/* --- One run --- */

static vkao_result record(struct speed_device *d, const struct speed_images *images,
                          const struct config *config, float radius, VkCommandBuffer cmd)
{
    const vkao_composite_params composite = vkao_composite_params_default();
    const vkao_view view = room_view(images->extent);
    struct ao_job job = {0};
    config_apply(config, &job);
    job.ssao.radius = radius;
    stage_clock_start(&d->clock, cmd);
    vkao_result result = vkao_cmd_all(images->frames[job.half_resolution], cmd, &view, &job.ssao,
                                      &job.blur, d->features.composite ? &composite : NULL);
    stage_clock_stop(&d->clock);
    return result;
}

bool speed_run_once(struct speed_device *d, const struct speed_images *images,
                    const struct config *config, float radius, double ms[STAGES],
                    struct tool_error *err)
{
    VkCommandBuffer cmd = gpu_begin(&d->gpu, err);
    if (!cmd)
        return false;
    vkao_result result = record(d, images, config, radius, cmd);
    double start = speed_now_ms();
    bool submitted = gpu_submit(&d->gpu, cmd, err);
    double wall = speed_now_ms() - start;
    if (result != VKAO_SUCCESS)
        return gpu_library_failed(err, "vkao_cmd_all", result);
    return submitted && stage_clock_read(&d->clock, wall, ms, err);
}
