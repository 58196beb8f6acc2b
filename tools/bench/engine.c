/* SPDX-License-Identifier: MIT */
#include "engine.h"

#include "clock.h"
#include "parallel.h"

#include <string.h>
#include <vulkan/vulkan.h>

bool engine_create(const char *device, struct engine_features features, struct engine *e,
                   struct tool_error *err)
{
    const struct gpu_options options = {.device = device};
    *e = (struct engine){.features = features};
    return gpu_create(&options, &e->gpu, err) && stage_clock_create(&e->gpu, &e->clock, err);
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

static vkao_stage_flags stages_of(struct engine_features features)
{
    return VKAO_STAGE_SSAO | VKAO_STAGE_BLUR | (features.composite ? VKAO_STAGE_COMPOSITE : 0u);
}

vkao_effect_info engine_effect_info(struct engine_features features, const struct config *config)
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

static void destroy_effects(struct engine *e)
{
    for (size_t i = 0; i < e->effect_count; i++)
        vkao_effect_destroy(e->effects[i]);
    e->effect_count = 0;
    vkao_context_destroy(e->ctx);
    e->ctx = NULL;
}

bool engine_compile(struct engine *e, const struct config *configs, size_t count,
                    struct tool_error *err)
{
    vkao_result result = VKAO_SUCCESS;
    destroy_effects(e);
    vkao_context_info info = gpu_context_info(&e->gpu);
    info.mark = stage_clock_mark;
    info.mark_user_data = &e->clock;
    double start = now_ms();
    e->ctx = gpu_context_create(&info, err);
    if (!e->ctx)
        return false;
    for (size_t i = 0; result == VKAO_SUCCESS && i < count; i++) {
        vkao_effect_info effect = engine_effect_info(e->features, &configs[i]);
        effect.parallel = parallel_run;
        e->configs[i] = configs[i];
        result = vkao_effect_create(e->ctx, &effect, &e->effects[i]);
        e->effect_count += result == VKAO_SUCCESS;
    }
    e->compile_ms = now_ms() - start;
    return result == VKAO_SUCCESS || gpu_library_failed(err, "vkao_effect_create", result);
}

void engine_destroy(struct engine *e)
{
    if (e->gpu.device)
        stage_clock_destroy(&e->clock);
    destroy_effects(e);
    gpu_destroy(&e->gpu);
    *e = (struct engine){0};
}

/* --- Images --- */

/* What engines have: 8-bit normals and AO, half-float colour. */

static vkao_image slot(VkFormat format, const struct gpu_image *image)
{
    return image ? gpu_image_slot(image) : (vkao_image){.format = format};
}

void engine_frame_info(struct engine_features features, VkExtent2D extent,
                       const struct engine_images *on_device, vkao_images *images,
                       vkao_frame_info *info)
{
    const struct engine_images *on = on_device;
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

void engine_image_formats(struct engine_images *i)
{
    i->depth.format = depth_format;
    i->normals.format = i->bent.format = normal_format;
    i->ao.format = ao_format;
    i->color.format = i->output.format = color_format;
}

static bool create_images(struct engine *e, struct engine_images *i, struct tool_error *err)
{
    const VkImageUsageFlags in = VK_IMAGE_USAGE_SAMPLED_BIT, out = VK_IMAGE_USAGE_STORAGE_BIT;
    struct gpu *gpu = &e->gpu;
    engine_image_formats(i);
    return gpu_image_create(gpu, i->depth.format, i->extent, in, &i->depth, err) &&
           gpu_image_create(gpu, i->normals.format, i->extent, in, &i->normals, err) &&
           gpu_image_create(gpu, i->ao.format, i->extent, in | out, &i->ao, err) &&
           (!e->features.bent_normals ||
            gpu_image_create(gpu, i->bent.format, i->extent, in | out, &i->bent, err)) &&
           (!e->features.composite ||
            (gpu_image_create(gpu, i->color.format, i->extent, in, &i->color, err) &&
             gpu_image_create(gpu, i->output.format, i->extent, out, &i->output, err)));
}

/* AO takes the same time on every colour, but memory that nobody wrote may hold NaN. */
static bool clear_color(struct engine *e, struct engine_images *images, struct tool_error *err)
{
    VkCommandBuffer cmd = gpu_begin(&e->gpu, err);
    if (!cmd)
        return false;
    vkCmdClearColorImage(cmd, images->color.image, VK_IMAGE_LAYOUT_GENERAL,
                         &(VkClearColorValue){.float32 = {0.5f, 0.5f, 0.5f, 1.0f}}, 1,
                         &(VkImageSubresourceRange){VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1});
    gpu_full_barrier(cmd);
    return gpu_submit(&e->gpu, cmd, err);
}

/* One block for all frames: they run in turn. */
static bool create_scratch(struct engine *e, struct engine_images *images, struct tool_error *err)
{
    VkMemoryRequirements all = {.alignment = 1, .memoryTypeBits = UINT32_MAX};
    for (size_t i = 0; i < e->effect_count; i++) {
        VkMemoryRequirements need;
        vkao_images slots;
        vkao_frame_info info;
        engine_frame_info(e->features, images->extent, images, &slots, &info);
        vkao_result result = vkao_frame_scratch(e->effects[i], &info, &need);
        if (result != VKAO_SUCCESS)
            return gpu_library_failed(err, "vkao_frame_scratch", result);
        all.size = need.size > all.size ? need.size : all.size;
        all.memoryTypeBits &= need.memoryTypeBits;
    }
    return gpu_allocate(&e->gpu, &all, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, &images->scratch, err);
}

static bool create_frames(struct engine *e, struct engine_images *images, struct tool_error *err)
{
    for (size_t i = 0; i < e->effect_count; i++) {
        vkao_images slots;
        vkao_frame_info info;
        engine_frame_info(e->features, images->extent, images, &slots, &info);
        info.scratch_memory = images->scratch;
        vkao_result result = vkao_frame_create(e->effects[i], &info, &images->frames[i]);
        if (result != VKAO_SUCCESS)
            return gpu_library_failed(err, "vkao_frame_create", result);
    }
    return true;
}

bool engine_check_size(const struct engine *e, VkExtent2D size, struct tool_error *err)
{
    const uint32_t most = e->gpu.properties.limits.maxImageDimension2D;
    return (size.width <= most && size.height <= most) ||
           fail(err, EXIT_DEVICE, "%u x %u texels: maxImageDimension2D of %s is %u", size.width,
                size.height, e->gpu.properties.deviceName, most);
}

bool engine_images_create(struct engine *e, const struct room *room, struct engine_images *images,
                          struct tool_error *err)
{
    const uint64_t bytes = (uint64_t)room->width * room->height * 4;
    *images = (struct engine_images){.extent = {room->width, room->height}};
    if (create_images(e, images, err) &&
        gpu_image_upload(&e->gpu, &images->depth, room->z, bytes, err) &&
        gpu_image_upload(&e->gpu, &images->normals, room->normals, bytes, err) &&
        (!e->features.composite || clear_color(e, images, err)) && create_scratch(e, images, err) &&
        create_frames(e, images, err))
        return true;
    engine_images_destroy(e, images);
    return false;
}

void engine_images_destroy(struct engine *e, struct engine_images *images)
{
    struct gpu_image *all[] = {&images->depth, &images->normals, &images->ao,
                               &images->bent,  &images->color,   &images->output};
    for (size_t i = 0; i < MAX_CONFIGS; i++)
        vkao_frame_destroy(images->frames[i]);
    for (size_t i = 0; e->gpu.device && i < sizeof all / sizeof all[0]; i++)
        gpu_image_destroy(&e->gpu, all[i]);
    if (images->scratch)
        vkFreeMemory(e->gpu.device, images->scratch, NULL);
    *images = (struct engine_images){0};
}

/* --- One run --- */

/* The frame whose effect was compiled for the setting. */
static const vkao_frame *frame_of(const struct engine *e, const struct engine_images *images,
                                  const struct config *config)
{
    for (size_t i = 0; i < e->effect_count; i++)
        if (strcmp(e->configs[i].name, config->name) == 0)
            return images->frames[i];
    return NULL;
}

vkao_result engine_record(const vkao_frame *frame, VkExtent2D extent, const struct config *config,
                          float radius, VkCommandBuffer cmd)
{
    const struct ao_view room = room_view(extent);
    const vkao_view view = ao_library_view(&room);
    struct ao_job job = {0};
    config_apply(config, &job);
    job.setting.params.radius = radius;
    return vkao_cmd_record(frame, cmd, &view, &job.setting.params);
}

bool engine_run(struct engine *e, const struct engine_images *images, const struct config *config,
                float radius, double ms[STAGES], struct tool_error *err)
{
    VkCommandBuffer cmd = gpu_begin(&e->gpu, err);
    if (!cmd)
        return false;
    stage_clock_start(&e->clock, cmd);
    vkao_result result =
        engine_record(frame_of(e, images, config), images->extent, config, radius, cmd);
    stage_clock_stop(&e->clock);
    double start = now_ms();
    bool submitted = gpu_submit(&e->gpu, cmd, err);
    double wall = now_ms() - start;
    if (result != VKAO_SUCCESS)
        return gpu_library_failed(err, "vkao_cmd_record", result);
    return submitted && stage_clock_read(&e->clock, wall, ms, err);
}
