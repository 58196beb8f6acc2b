/* SPDX-License-Identifier: MIT */
#include "world.h"

#include <stdio.h>
#include <string.h>

static void keep(void *user_data, vkao_log_level level, const char *message)
{
    struct kept_log *log = user_data;
    ++log->lines;
    log->last_level = level;
    snprintf(log->last, sizeof log->last, "%s", message);
    if (level == VKAO_LOG_ERROR) {
        ++log->errors;
        snprintf(log->last_error, sizeof log->last_error, "%s", message);
    }
    assert_null(strchr(message, '\n'));
}

const char *const world_slot_names[SLOT_COUNT] = {
    "images.depth",  "images.normals", "images.ao_noisy",     "images.ao",     "images.color",
    "images.direct", "images.output",  "images.bent_normals", "images.albedo", "images.specular",
};

vkao_image *world_slot(vkao_images *images, size_t index)
{
    vkao_image *const slots[SLOT_COUNT] = {
        &images->depth,  &images->normals,  &images->ao_noisy, &images->ao,
        &images->color,  &images->direct,   &images->output,   &images->bent_normals,
        &images->albedo, &images->specular,
    };
    return slots[index];
}

vkao_effect_info settings_of(const vkao_effect *effect)
{
    vkao_effect_info settings;
    vkao_effect_settings(effect, &settings, sizeof settings);
    return settings;
}

void world_init(struct world *w, bool with_callbacks)
{
    static const VkFormat formats[SLOT_COUNT] = {
        VK_FORMAT_D32_SFLOAT,
        VK_FORMAT_R16G16B16A16_SNORM,
        VK_FORMAT_R8_UNORM,
        VK_FORMAT_R16_UNORM,
        VK_FORMAT_B10G11R11_UFLOAT_PACK32,
        VK_FORMAT_R16G16B16A16_SFLOAT,
        VK_FORMAT_R8G8B8A8_UNORM,
        VK_FORMAT_R32G32B32A32_SFLOAT,
        VK_FORMAT_B8G8R8A8_SRGB,
        VK_FORMAT_A2B10G10R10_UNORM_PACK32,
    };
    memset(w, 0, sizeof *w);
    host_calloc = (struct host_memory){0};
    fake_init(&w->fake);
    w->callbacks = host_callbacks(&w->host);
    w->features.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2;
    w->storage_features = (VkPhysicalDevice16BitStorageFeatures){
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_16BIT_STORAGE_FEATURES,
        .storageBuffer16BitAccess = VK_TRUE};
    vkao_add_required_features(&w->features.features);
    w->info = (vkao_context_info){
        .struct_size = sizeof w->info,
        .instance = fake_instance(&w->fake),
        .physical_device = fake_physical_device(&w->fake),
        .device = fake_device(&w->fake),
        .get_instance_proc_addr = fake_get_instance_proc_addr,
        .get_device_proc_addr = fake_get_device_proc_addr,
        .enabled_features = &w->features,
        .allocator = with_callbacks ? &w->callbacks : NULL,
        .log = keep,
        .log_user_data = &w->log,
    };
    w->fake.expected_allocator = w->info.allocator;
    w->images = vkao_images_default();
    for (size_t i = 0; i < SLOT_COUNT; ++i)
        *world_slot(&w->images, i) = (vkao_image){
            fake_caller_view(&w->fake), VK_IMAGE_LAYOUT_GENERAL, formats[i], VK_NULL_HANDLE};
    w->bent_normals = w->images.bent_normals;
    w->images.bent_normals = (vkao_image){0};
    w->effect_info = vkao_effect_info_default();
    /* It has one pass a stage, and two of the blur. */
    w->effect_info.method = VKAO_SSAO_GTAO;
    w->effect_info.stages = VKAO_STAGE_ALL;
    w->effect_info.ao_format = formats[3];
    w->effect_info.noisy_ao = VK_TRUE;
    w->frame_info = vkao_frame_info_default();
    w->frame_info.extent = (VkExtent2D){100, 60};
    w->frame_info.images = &w->images;
    w->view = vkao_view_default();
    w->view.projection[0] = w->view.projection[5] = 1.0f;
    w->view.projection[10] = -1.01f;
    w->view.projection[11] = -1.0f;
    w->view.projection[14] = -0.101f;
    w->params = vkao_params_default();
}

void world_open(struct world *w)
{
    world_init(w, true);
    assert_int_equal(vkao_context_create(&w->info, &w->ctx), VKAO_SUCCESS);
    assert_non_null(w->ctx);
}

vkao_result world_try_effect(struct world *w)
{
    vkao_frame_destroy(w->frame);
    vkao_effect_destroy(w->effect);
    w->frame = NULL;
    w->effect = NULL;
    return vkao_effect_create(w->ctx, &w->effect_info, &w->effect);
}

vkao_result world_try_frame(struct world *w)
{
    vkao_result result = world_try_effect(w);
    return result == VKAO_SUCCESS ? vkao_frame_create(w->effect, &w->frame_info, &w->frame)
                                  : result;
}

void world_create_effect(struct world *w)
{
    assert_int_equal(world_try_effect(w), VKAO_SUCCESS);
    assert_non_null(w->effect);
}

void world_create_frame(struct world *w)
{
    if (world_try_frame(w) != VKAO_SUCCESS)
        fail_msg("%s", w->log.last_error);
    assert_non_null(w->frame);
    fake_forget_calls(&w->fake);
}

void world_open_frame(struct world *w, vkao_stage_flags stages)
{
    const vkao_stage_flags both = VKAO_STAGE_SSAO | VKAO_STAGE_BLUR;
    world_open(w);
    w->effect_info.stages = stages;
    w->effect_info.noisy_ao = (stages & both) == both;
    world_create_frame(w);
}

void world_use_bent_normals(struct world *w)
{
    world_use_scratch_noise(w);
    w->images.bent_normals = w->bent_normals;
    w->effect_info.bent_normals = VK_TRUE;
}

void world_use_scratch_noise(struct world *w)
{
    w->images.ao_noisy = (vkao_image){0};
    w->effect_info.noisy_ao = VK_FALSE;
}

void world_be_cpu(struct world *w)
{
    w->fake.device_type = VK_PHYSICAL_DEVICE_TYPE_CPU;
}

/* Nothing that the library made is alive, on the device or on the host. */
static void world_check_empty(const struct world *w)
{
    if (w->fake.error[0])
        fail_msg("%s", w->fake.error);
    for (size_t i = 0; i < w->fake.object_count; ++i) {
        const struct fake_object *object = &w->fake.objects[i];
        if (object->alive && !object->of_caller)
            fail_msg("an object of VkObjectType %d leaks", (int)object->type);
        if (!object->alive && object->of_caller)
            fail_msg("the caller's object of VkObjectType %d was destroyed", (int)object->type);
    }
    assert_int_equal(w->host.live, 0);
    assert_int_equal(host_calloc.live, 0);
}

void world_close(struct world *w)
{
    vkao_frame_destroy(w->frame);
    vkao_effect_destroy(w->effect);
    vkao_context_destroy(w->ctx);
    world_check_empty(w);
    fake_release(&w->fake);
}

void world_forget_log(struct world *w)
{
    memset(&w->log, 0, sizeof w->log);
}

VkCommandBuffer world_cmd(struct world *w)
{
    return fake_command_buffer(&w->fake);
}

void expect_refused(struct world *w, vkao_result want, vkao_result got, const char *name,
                    const char *value)
{
    if (got != want)
        fail_msg("%s %s: %s, want %s", name, value, vkao_result_string(got),
                 vkao_result_string(want));
    if (w->log.errors != 1)
        fail_msg("%s %s: %u error lines, want one", name, value, w->log.errors);
    if (!strstr(w->log.last_error, name) || !strstr(w->log.last_error, value))
        fail_msg("the log says '%s', want it to name '%s' and '%s'", w->log.last_error, name,
                 value);
    world_forget_log(w);
}

void expect_nothing_recorded(const struct world *w)
{
    assert_int_equal(fake_count(&w->fake, "vkCmd"), 0);
}

vkao_result world_record_all(struct world *w)
{
    return vkao_cmd_record(w->frame, world_cmd(w), &w->view, &w->params);
}
