/* SPDX-License-Identifier: MIT
 *
 * The library on a device, as an engine would drive it: images uploaded once, one recording per
 * frame, nothing read back. */
#include "speed.h"

#include "parallel.h"

#include <string.h>
#include <vulkan/vulkan.h>

bool speed_device_create(const char *device, struct speed_features features, struct speed_device *d,
                         struct tool_error *err)
{
    const struct gpu_options options = {.device = device};
    *d = (struct speed_device){.features = features};
    return gpu_create(&options, &d->gpu, err) && stage_clock_create(&d->gpu, &d->clock, err);
}

static struct ao_view room_view(VkExtent2D extent)
{
    struct ao_view view = ao_view_default();
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

vkao_effect_info speed_effect_info(struct speed_features features, const struct config *config)
{
    const struct ao_view view = room_view((VkExtent2D){1920, 1080});
    struct ao_job job = {0};
    config_apply(config, &job);
    vkao_effect_info info = job.setting.effect;
    info.stages = stages_of(features);
    ao_view_describe(&view, &info);
    info.bent_normals = features.bent_normals;
    info.ao_format = ao_format;
    return info;
}

static void destroy_effects(struct speed_device *d)
{
    for (size_t i = 0; i < d->effect_count; i++)
        vkao_effect_destroy(d->effects[i]);
    d->effect_count = 0;
    vkao_context_destroy(d->ctx);
    d->ctx = NULL;
}

bool speed_device_compile(struct speed_device *d, const struct config *configs, size_t count,
                          struct tool_error *err)
{
    vkao_result result = VKAO_SUCCESS;
    destroy_effects(d);
    vkao_context_info info = gpu_context_info(&d->gpu);
    info.mark = stage_clock_mark;
    info.mark_user_data = &d->clock;
    double start = speed_now_ms();
    d->ctx = gpu_context_create(&info, err);
    if (!d->ctx)
        return false;
    for (size_t i = 0; result == VKAO_SUCCESS && i < count; i++) {
        vkao_effect_info effect = speed_effect_info(d->features, &configs[i]);
        effect.parallel = parallel_run;
        d->configs[i] = configs[i];
        result = vkao_effect_create(d->ctx, &effect, &d->effects[i]);
        d->effect_count += result == VKAO_SUCCESS;
    }
    d->context_ms = speed_now_ms() - start;
    return result == VKAO_SUCCESS || gpu_library_failed(err, "vkao_effect_create", result);
}

void speed_device_destroy(struct speed_device *d)
{
    if (d->gpu.device)
        stage_clock_destroy(&d->clock);
    destroy_effects(d);
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

void speed_frame_info(struct speed_features features, VkExtent2D extent,
                      const struct speed_images *on_device, vkao_images *images,
                      vkao_frame_info *info)
{
    const struct speed_images *on = on_device;
    *images = vkao_images_default();
    images->depth = slot(depth_format, on ? &on->depth : NULL);
    images->normals = slot(normal_format, on ? &on->normals : NULL);
    images->ao = slot(ao_format, on ? &on->ao : NULL);
    if (on)
        images->ao.image = on->ao.image;
    if (features.bent_normals)
        images->bent_normals = slot(normal_format, on ? &on->bent : NULL);
    if (features.composite) {
        images->color = slot(color_format, on ? &on->color : NULL);
        images->output = slot(color_format, on ? &on->output : NULL);
    }
    *info = vkao_frame_info_default();
    info->extent = extent;
    info->images = images;
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

/* One block for all frames: they run in turn. */
static bool create_scratch(struct speed_device *d, struct speed_images *images,
                           struct tool_error *err)
{
    VkMemoryRequirements all = {.alignment = 1, .memoryTypeBits = UINT32_MAX};
    for (size_t i = 0; i < d->effect_count; i++) {
        VkMemoryRequirements need;
        vkao_images slots;
        vkao_frame_info info;
        speed_frame_info(d->features, images->extent, images, &slots, &info);
        vkao_result result = vkao_frame_scratch(d->effects[i], &info, &need);
        if (result != VKAO_SUCCESS)
            return gpu_library_failed(err, "vkao_frame_scratch", result);
        all.size = need.size > all.size ? need.size : all.size;
        all.memoryTypeBits &= need.memoryTypeBits;
    }
    return gpu_allocate(&d->gpu, &all, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, &images->scratch, err);
}

static bool create_frames(struct speed_device *d, struct speed_images *images,
                          struct tool_error *err)
{
    for (size_t i = 0; i < d->effect_count; i++) {
        vkao_images slots;
        vkao_frame_info info;
        speed_frame_info(d->features, images->extent, images, &slots, &info);
        info.scratch_memory = images->scratch;
        vkao_result result = vkao_frame_create(d->effects[i], &info, &images->frames[i]);
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
    for (size_t i = 0; i < MAX_CONFIGS; i++)
        vkao_frame_destroy(images->frames[i]);
    for (size_t i = 0; d->gpu.device && i < sizeof all / sizeof all[0]; i++)
        gpu_image_destroy(&d->gpu, all[i]);
    if (images->scratch)
        vkFreeMemory(d->gpu.device, images->scratch, NULL);
    *images = (struct speed_images){0};
}

/* --- One run --- */

/* The frame whose effect was compiled for the setting. */
static const vkao_frame *frame_of(const struct speed_device *d, const struct speed_images *images,
                                  const struct config *config)
{
    for (size_t i = 0; i < d->effect_count; i++)
        if (strcmp(d->configs[i].name, config->name) == 0)
            return images->frames[i];
    return NULL;
}

static vkao_result record(struct speed_device *d, const struct speed_images *images,
                          const struct config *config, float radius, VkCommandBuffer cmd)
{
    const struct ao_view room = room_view(images->extent);
    const vkao_view view = ao_library_view(&room);
    struct ao_job job = {0};
    config_apply(config, &job);
    job.setting.params.radius = radius;
    stage_clock_start(&d->clock, cmd);
    vkao_result result = vkao_cmd_record(frame_of(d, images, config), cmd, &view, &job.setting.params);
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
        return gpu_library_failed(err, "vkao_cmd_record", result);
    return submitted && stage_clock_read(&d->clock, wall, ms, err);
}
