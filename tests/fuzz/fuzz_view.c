/* SPDX-License-Identifier: MIT */
#include "fuzz_view.h"

#include "fake_vulkan.h"
#include "fuzz.h"
#include "gbuffer_internal.h"

#include <math.h>
#include <stdio.h>

static struct fake_vulkan fake;
static vkao_context *context;
static char last_error[1024];

static void keep_error(void *user_data, vkao_log_level level, const char *message)
{
    (void)user_data;
    if (level == VKAO_LOG_ERROR)
        snprintf(last_error, sizeof last_error, "%s", message);
}

static void create_context(void)
{
    VkPhysicalDeviceFeatures2 features = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2};
    fake_init(&fake);
    fake.max_dimension = UINT16_MAX;
    fake.max_texels = fake.max_buffer = UINT32_MAX;
    vkao_add_required_features(&features.features);
    const vkao_context_info info = {
        .struct_size = sizeof info,
        .instance = fake_instance(&fake),
        .physical_device = fake_physical_device(&fake),
        .device = fake_device(&fake),
        .get_instance_proc_addr = fake_get_instance_proc_addr,
        .get_device_proc_addr = fake_get_device_proc_addr,
        .enabled_features = &features,
        .log = keep_error,
    };
    if (vkao_context_create(&info, &context) != VKAO_SUCCESS)
        fuzz_broken(__FILE__, __LINE__, "vkao_context_create", "%s", last_error);
}

static vkao_image image_of(VkFormat format)
{
    return (vkao_image){fake_caller_view(&fake), VK_IMAGE_LAYOUT_GENERAL, format, VK_NULL_HANDLE};
}

void fuzz_check_job(const struct fuzz_job *job)
{
    const struct setting setting = job->setting ? *job->setting : setting_default();
    if (!context)
        create_context();
    const size_t objects = fake.object_count;
    vkao_images images = vkao_images_default();
    images.depth = image_of(VK_FORMAT_R32_SFLOAT);
    images.normals = image_of(VK_FORMAT_R32G32B32A32_SFLOAT);
    images.ao = image_of(VK_FORMAT_R32_SFLOAT);
    images.color = images.output = image_of(VK_FORMAT_R32G32B32A32_SFLOAT);
    if (setting.effect.bent_normals)
        images.bent_normals = image_of(VK_FORMAT_R32G32B32A32_SFLOAT);
    if (setting.effect.thickness_input)
        images.thickness = image_of(VK_FORMAT_R32_SFLOAT);
    if (setting.effect.second_layer)
        images.second_depth = image_of(VK_FORMAT_R32_SFLOAT);
    if (setting.effect.multi_bounce)
        images.albedo = image_of(VK_FORMAT_R32G32B32A32_SFLOAT);
    if (setting.effect.specular)
        images.specular = image_of(VK_FORMAT_R32G32B32A32_SFLOAT);
    vkao_effect_info effect_info = setting.effect;
    effect_info.stages = VKAO_STAGE_ALL;
    ao_view_describe(job->view, &effect_info);
    effect_info.ao_format = VK_FORMAT_R32_SFLOAT;
    vkao_frame_info info = vkao_frame_info_default();
    info.extent = (VkExtent2D){job->width, job->height};
    info.images = &images;
    const vkao_view view = ao_library_view(job->view);
    vkao_effect *effect = NULL;
    vkao_frame *frame = NULL;
    last_error[0] = '\0';
    vkao_result result = vkao_effect_create(context, &effect_info, &effect);
    if (result == VKAO_SUCCESS)
        result = vkao_frame_create(effect, &info, &frame);
    FUZZ_CHECK(result == VKAO_SUCCESS, "%ux%u: %s", job->width, job->height, last_error);
    result = vkao_cmd_record(frame, fake_command_buffer(&fake), &view, &setting.params);
    FUZZ_CHECK(result == VKAO_SUCCESS, "%ux%u: %s", job->width, job->height, last_error);
    vkao_frame_destroy(frame);
    vkao_effect_destroy(effect);
    FUZZ_CHECK(!fake.error[0], "%s", fake.error);
    /* The fake forgets nothing by itself. */
    fake_forget_calls(&fake);
    fake.object_count = objects;
}

static void check_depth(const struct gbuffer *g)
{
    const float *const images[] = {g->depth, g->thickness, g->second_depth};
    for (size_t k = 0; k < sizeof images / sizeof *images; k++)
        for (size_t i = 0; images[k] && i < gbuffer_texels(g); i++)
            FUZZ_CHECK(isfinite(images[k][i]) && images[k][i] >= 0, "depth %zu, %zu is %g", k, i,
                       (double)images[k][i]);
    FUZZ_CHECK(isfinite(g->min_z) && isfinite(g->max_z) && g->min_z >= 0 &&
                   g->min_z <= g->median_z && g->median_z <= g->max_z,
               "view z %g, %g, %g", g->min_z, g->median_z, g->max_z);
}

void fuzz_check_gbuffer(const struct gbuffer *g)
{
    FUZZ_CHECK(g->width > 0 && g->height > 0 && g->depth, "%ux%u", g->width, g->height);
    FUZZ_CHECK(g->depth_type != DEPTH_AUTO, "no depth type");
    check_depth(g);
    FUZZ_CHECK(g->background_share >= 0 && g->background_share <= 1 && g->invalid_share >= 0 &&
                   g->invalid_share <= 1,
               "shares %g, %g", g->background_share, g->invalid_share);
    FUZZ_CHECK(g->depth_step >= 0 && isfinite(g->depth_step), "depth step %g", g->depth_step);
    for (size_t i = 0; g->normals && i < gbuffer_texels(g) * 4; i++)
        FUZZ_CHECK(i % 4 == 3 || isfinite(g->normals[i]), "normal component %zu is %g", i,
                   (double)g->normals[i]);
    FUZZ_CHECK((g->view.normal_encoding == VKAO_NORMALS_FROM_DEPTH) == !g->normals,
               "normal encoding %d", (int)g->view.normal_encoding);
}
