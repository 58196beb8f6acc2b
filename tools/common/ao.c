/* SPDX-License-Identifier: MIT */
#include "ao.h"

#include "clock.h"
#include "parallel.h"

#include <stdlib.h>
#include <string.h>
#include <vulkan/vulkan.h>

/* The caller's images, in the order of vkao_images. */
enum job_image {
    IMAGE_DEPTH,
    IMAGE_NORMALS,
    IMAGE_COLOR,
    IMAGE_AO,
    IMAGE_OUTPUT,
    IMAGE_BENT,
    IMAGE_THICKNESS,
    IMAGE_SECOND_DEPTH,
    IMAGE_ALBEDO,
    IMAGE_SPECULAR,
    IMAGE_COUNT
};

struct ao_session {
    struct gpu *gpu;
    vkao_context *ctx;
    vkao_effect *effect;
    vkao_effect_info compiled; /* what it was made for */
    vkao_frame *frame;
    struct gpu_image
        images[IMAGE_COUNT]; /* of the last job; kept while the next one has the same shape */
    VkExtent2D extent;
    bool has_normals, has_color;
    VkQueryPool timestamps; /* two, around the stages; VK_NULL_HANDLE if the queue has none */
};

static bool create_timestamps(struct ao_session *session, struct tool_error *err)
{
    if (session->gpu->timestamp_bits == 0)
        return true;
    VkResult result = vkCreateQueryPool(session->gpu->device,
                                        &(VkQueryPoolCreateInfo){
                                            .sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
                                            .queryType = VK_QUERY_TYPE_TIMESTAMP,
                                            .queryCount = 2,
                                        },
                                        NULL, &session->timestamps);
    if (result != VK_SUCCESS)
        session->timestamps = VK_NULL_HANDLE;
    return gpu_ok(err, "vkCreateQueryPool", result);
}

struct ao_session *ao_session_create(struct gpu *gpu, struct tool_error *err)
{
    struct ao_session *session = calloc(1, sizeof *session);
    if (!session) {
        fail(err, EXIT_MEMORY, "out of memory");
        return NULL;
    }
    session->gpu = gpu;
    session->ctx = gpu_context(gpu, err);
    if (session->ctx && create_timestamps(session, err))
        return session;
    ao_session_destroy(session);
    return NULL;
}

static void drop_frame(struct ao_session *session)
{
    vkao_frame_destroy(session->frame);
    session->frame = NULL;
    for (int i = 0; i < IMAGE_COUNT; ++i)
        gpu_image_destroy(session->gpu, &session->images[i]);
}

void ao_session_destroy(struct ao_session *session)
{
    if (!session)
        return;
    drop_frame(session);
    vkao_effect_destroy(session->effect);
    vkao_context_destroy(session->ctx);
    vkDestroyQueryPool(session->gpu->device, session->timestamps, NULL);
    free(session);
}

static const VkFormat ao_format = VK_FORMAT_R32_SFLOAT;

/* What a job is compiled for. */
static vkao_effect_info effect_of(const struct ao_job *job)
{
    vkao_effect_info effect = job->setting.effect;
    effect.stages = VKAO_STAGE_SSAO | VKAO_STAGE_BLUR | (job->color ? VKAO_STAGE_COMPOSITE : 0u);
    effect.ao_format = ao_format;
    ao_view_describe(&job->view, &effect);
    return effect;
}

static bool create_frame(struct ao_session *session, const struct ao_job *job,
                         struct tool_error *err)
{
    const vkao_effect_info *effect = &job->setting.effect;
    const bool has_thickness = effect->thickness_input != VKAO_THICKNESS_AS_SEEN;
    const struct {
        bool used;
        VkFormat format;
        VkImageUsageFlags usage;
    } plan[IMAGE_COUNT] = {
        [IMAGE_DEPTH] = {true, VK_FORMAT_R32_SFLOAT, VK_IMAGE_USAGE_SAMPLED_BIT},
        [IMAGE_NORMALS] = {job->normals != NULL, VK_FORMAT_R32G32B32A32_SFLOAT,
                           VK_IMAGE_USAGE_SAMPLED_BIT},
        [IMAGE_COLOR] = {job->color != NULL, VK_FORMAT_R32G32B32A32_SFLOAT,
                         VK_IMAGE_USAGE_SAMPLED_BIT},
        [IMAGE_AO] = {true, ao_format, VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_STORAGE_BIT},
        [IMAGE_OUTPUT] = {job->color != NULL, VK_FORMAT_R32G32B32A32_SFLOAT,
                          VK_IMAGE_USAGE_STORAGE_BIT},
        [IMAGE_BENT] = {job->setting.effect.bent_normals, VK_FORMAT_R32G32B32A32_SFLOAT,
                        VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_STORAGE_BIT},
        [IMAGE_THICKNESS] = {has_thickness, VK_FORMAT_R32_SFLOAT, VK_IMAGE_USAGE_SAMPLED_BIT},
        [IMAGE_ALBEDO] = {effect->multi_bounce, VK_FORMAT_R32G32B32A32_SFLOAT,
                          VK_IMAGE_USAGE_SAMPLED_BIT},
        [IMAGE_SPECULAR] = {effect->specular != VKAO_SPECULAR_NONE, VK_FORMAT_R32G32B32A32_SFLOAT,
                            VK_IMAGE_USAGE_SAMPLED_BIT},
        [IMAGE_SECOND_DEPTH] = {effect->second_layer, VK_FORMAT_R32_SFLOAT,
                                VK_IMAGE_USAGE_SAMPLED_BIT},
    };
    VkExtent2D extent = {job->width, job->height};
    drop_frame(session);
    for (int i = 0; i < IMAGE_COUNT; ++i) {
        if (plan[i].used && !gpu_image_create(session->gpu, plan[i].format, extent, plan[i].usage,
                                              &session->images[i], err))
            return false;
    }
    vkao_images images = vkao_images_default();
    images.depth = gpu_image_slot(&session->images[IMAGE_DEPTH]);
    images.ao = gpu_image_slot(&session->images[IMAGE_AO]);
    images.ao.image = session->images[IMAGE_AO].image;
    if (job->normals)
        images.normals = gpu_image_slot(&session->images[IMAGE_NORMALS]);
    if (job->color) {
        images.color = gpu_image_slot(&session->images[IMAGE_COLOR]);
        images.output = gpu_image_slot(&session->images[IMAGE_OUTPUT]);
    }
    if (job->setting.effect.bent_normals)
        images.bent_normals = gpu_image_slot(&session->images[IMAGE_BENT]);
    if (has_thickness)
        images.thickness = gpu_image_slot(&session->images[IMAGE_THICKNESS]);
    if (effect->second_layer)
        images.second_depth = gpu_image_slot(&session->images[IMAGE_SECOND_DEPTH]);
    if (effect->multi_bounce)
        images.albedo = gpu_image_slot(&session->images[IMAGE_ALBEDO]);
    if (effect->specular)
        images.specular = gpu_image_slot(&session->images[IMAGE_SPECULAR]);
    vkao_result result = vkao_frame_create(session->effect,
                                           &(vkao_frame_info){
                                               .struct_size = sizeof(vkao_frame_info),
                                               .extent = extent,
                                               .images = &images,
                                           },
                                           &session->frame);
    if (result == VKAO_ERROR_UNSUPPORTED)
        fail_hint(err, "crop or scale the image, or take --device cpu");
    if (result != VKAO_SUCCESS)
        return gpu_library_failed(err, "vkao_frame_create", result);
    session->extent = extent;
    session->has_normals = job->normals != NULL;
    session->has_color = job->color != NULL;
    return true;
}

/* An effect for this job, if that of the last one does not fit. */
static bool fit_effect(struct ao_session *session, const struct ao_job *job, struct tool_error *err)
{
    vkao_effect_info info = effect_of(job);
    /* Messages of validation are counted in one thread. */
    info.parallel = session->gpu->messenger ? NULL : parallel_run;
    if (session->effect && memcmp(&session->compiled, &info, sizeof info) == 0)
        return true;
    drop_frame(session);
    vkao_effect_destroy(session->effect);
    session->effect = NULL;
    session->compiled = info;
    vkao_result result = vkao_effect_create(session->ctx, &info, &session->effect);
    return result == VKAO_SUCCESS || gpu_library_failed(err, "vkao_effect_create", result);
}

uint64_t ao_job_texel_bytes(bool has_normals, bool has_color, const vkao_effect_info *effect)
{
    /* Images on the device, and results; the library's scratch, with room for the margins of half
     * resolution; what an image passes through on its way to or from the device. */
    const uint64_t vector = 4 * sizeof(float), normals = has_normals ? vector : 0;
    const uint64_t color = has_color ? vector : 0, bent = effect->bent_normals ? vector : 0;
    const uint64_t thickness = effect->thickness_input ? sizeof(float) : 0;
    const uint64_t second = effect->second_layer ? sizeof(float) : 0;
    const uint64_t light = (effect->multi_bounce ? vector : 0) + (effect->specular ? vector : 0);
    const uint64_t images =
        light + 2 * sizeof(float) + normals + 2 * color + bent + thickness + second;
    const uint64_t results = sizeof(float) + color + bent;
    const uint64_t scratch = (bent ? 24 : 8) + second;
    return images + results + scratch + (normals || color || bent ? vector : sizeof(float));
}

static bool upload(struct ao_session *session, enum job_image which, const float *data,
                   uint64_t texels, struct tool_error *err)
{
    struct gpu_image *image = &session->images[which];
    return !data || gpu_image_upload(session->gpu, image, data,
                                     texels * gpu_format_bytes(image->format), err);
}

static bool upload_behind(struct ao_session *session, const struct ao_job *job, uint64_t texels,
                          struct tool_error *err)
{
    const vkao_effect_info *effect = &job->setting.effect;
    if ((effect->thickness_input && !job->thickness) ||
        (effect->second_layer && !job->second_depth))
        return fail(err, EXIT_BUG, "no image of thickness or second depth");
    if ((effect->multi_bounce && !job->albedo) || (effect->specular && !job->specular))
        return fail(err, EXIT_BUG, "no image of albedo or specular light");
    return (!effect->thickness_input ||
            upload(session, IMAGE_THICKNESS, job->thickness, texels, err)) &&
           (!effect->second_layer ||
            upload(session, IMAGE_SECOND_DEPTH, job->second_depth, texels, err)) &&
           (!effect->multi_bounce || upload(session, IMAGE_ALBEDO, job->albedo, texels, err)) &&
           (!effect->specular || upload(session, IMAGE_SPECULAR, job->specular, texels, err));
}

static bool read_timestamps(struct ao_session *session, double *ms, struct tool_error *err)
{
    const struct gpu *gpu = session->gpu;
    uint64_t ticks[2];
    VkResult result =
        vkGetQueryPoolResults(gpu->device, session->timestamps, 0, 2, sizeof ticks, ticks,
                              sizeof ticks[0], VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT);
    if (!gpu_ok(err, "vkGetQueryPoolResults", result))
        return false;
    *ms = gpu_ms_between(gpu, ticks[0], ticks[1]);
    return true;
}

static bool record_and_run(struct ao_session *session, const struct ao_job *job, double *gpu_ms,
                           struct tool_error *err)
{
    VkCommandBuffer cmd = gpu_begin(session->gpu, err);
    if (!cmd)
        return false;
    if (session->timestamps) {
        vkCmdResetQueryPool(cmd, session->timestamps, 0, 2);
        vkCmdWriteTimestamp(cmd, VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT, session->timestamps, 0);
    }
    const vkao_view view = ao_library_view(&job->view);
    vkao_result result = vkao_cmd_record(session->frame, cmd, &view, &job->setting.params);
    if (session->timestamps)
        vkCmdWriteTimestamp(cmd, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, session->timestamps, 1);
    double start = now_ms();
    bool submitted = gpu_submit(session->gpu, cmd, err);
    *gpu_ms = now_ms() - start;
    if (result != VKAO_SUCCESS)
        return gpu_library_failed(err, "vkao_cmd_record", result);
    return submitted && (!session->timestamps || read_timestamps(session, gpu_ms, err));
}

static float *download(struct ao_session *session, enum job_image which, uint64_t texels,
                       struct tool_error *err)
{
    struct gpu_image *image = &session->images[which];
    uint64_t bytes = texels * gpu_format_bytes(image->format);
    float *data = malloc((size_t)bytes);
    if (!data) {
        fail(err, EXIT_MEMORY, "out of memory for %ux%u texels", image->extent.width,
             image->extent.height);
        return NULL;
    }
    if (gpu_image_download(session->gpu, image, data, bytes, err))
        return data;
    free(data);
    return NULL;
}

static bool run(struct ao_session *session, const struct ao_job *job, struct ao_result *result,
                struct tool_error *err)
{
    uint64_t texels = (uint64_t)job->width * job->height;
    *result = (struct ao_result){0};
    if (!fit_effect(session, job, err))
        return false;
    bool same = session->frame && session->extent.width == job->width &&
                session->extent.height == job->height &&
                session->has_normals == (job->normals != NULL) &&
                session->has_color == (job->color != NULL);
    if ((!same && !create_frame(session, job, err)) ||
        !upload(session, IMAGE_DEPTH, job->depth, texels, err) ||
        !upload(session, IMAGE_NORMALS, job->normals, texels, err) ||
        !upload(session, IMAGE_COLOR, job->color, texels, err) ||
        !upload_behind(session, job, texels, err) ||
        !record_and_run(session, job, &result->gpu_ms, err))
        return false;
    result->ao = download(session, IMAGE_AO, texels, err);
    if (result->ao && job->color)
        result->output = download(session, IMAGE_OUTPUT, texels, err);
    if (result->ao && job->setting.effect.bent_normals)
        result->bent = download(session, IMAGE_BENT, texels, err);
    return result->ao && (result->output || !job->color) &&
           (result->bent || !job->setting.effect.bent_normals);
}

bool ao_run(struct ao_session *session, const struct ao_job *job, struct ao_result *result,
            struct tool_error *err)
{
    if (run(session, job, result, err))
        return true;
    ao_result_free(result);
    drop_frame(session);
    return false;
}

void ao_result_free(struct ao_result *result)
{
    free(result->ao);
    free(result->output);
    free(result->bent);
    *result = (struct ao_result){0};
}
