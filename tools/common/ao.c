/* SPDX-License-Identifier: MIT */
#include "ao.h"

#include <stdlib.h>
#include <vulkan/vulkan.h>

/* The caller's images, in the order of vkao_images. */
enum job_image { IMAGE_DEPTH, IMAGE_NORMALS, IMAGE_COLOR, IMAGE_AO, IMAGE_OUTPUT, IMAGE_COUNT };

struct ao_session {
    struct gpu *gpu;
    vkao_context *ctx;
    vkao_frame *frame;
    struct gpu_image images[IMAGE_COUNT]; /* of the last job; kept while the next one has the same shape */
    VkExtent2D extent;
    bool has_normals, has_color;
};

static bool library_failed(struct tool_error *err, const char *call, vkao_result result)
{
    enum exit_code code = EXIT_DEVICE;
    if (result == VKAO_ERROR_OUT_OF_HOST_MEMORY || result == VKAO_ERROR_OUT_OF_DEVICE_MEMORY)
        code = EXIT_MEMORY;
    else if (result == VKAO_ERROR_INVALID_ARGUMENT)
        code = EXIT_BUG; /* options were checked before: the tool built something wrong */
    return fail(err, code, "%s: %s", call, vkao_result_string(result));
}

struct ao_session *ao_session_create(struct gpu *gpu, uint32_t method_mask, struct tool_error *err)
{
    struct ao_session *session = calloc(1, sizeof *session);
    if (!session) {
        fail(err, EXIT_MEMORY, "out of memory");
        return NULL;
    }
    session->gpu = gpu;
    session->ctx = gpu_context(gpu, method_mask, err);
    if (session->ctx)
        return session;
    free(session);
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
    vkao_context_destroy(session->ctx);
    free(session);
}

static bool create_frame(struct ao_session *session, const struct ao_job *job, struct tool_error *err)
{
    const struct {
        bool used;
        VkFormat format;
        VkImageUsageFlags usage;
    } plan[IMAGE_COUNT] = {
        [IMAGE_DEPTH] = {true, VK_FORMAT_R32_SFLOAT, VK_IMAGE_USAGE_SAMPLED_BIT},
        [IMAGE_NORMALS] = {job->normals != NULL, VK_FORMAT_R32G32B32A32_SFLOAT, VK_IMAGE_USAGE_SAMPLED_BIT},
        [IMAGE_COLOR] = {job->color != NULL, VK_FORMAT_R32G32B32A32_SFLOAT, VK_IMAGE_USAGE_SAMPLED_BIT},
        [IMAGE_AO] = {true, VK_FORMAT_R32_SFLOAT, VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_STORAGE_BIT},
        [IMAGE_OUTPUT] = {job->color != NULL, VK_FORMAT_R32G32B32A32_SFLOAT, VK_IMAGE_USAGE_STORAGE_BIT},
    };
    VkExtent2D extent = {job->width, job->height};
    drop_frame(session);
    for (int i = 0; i < IMAGE_COUNT; ++i) {
        if (plan[i].used &&
            !gpu_image_create(session->gpu, plan[i].format, extent, plan[i].usage, &session->images[i], err))
            return false;
    }
    vkao_images images = vkao_images_default();
    images.depth = gpu_image_slot(&session->images[IMAGE_DEPTH]);
    images.ao = gpu_image_slot(&session->images[IMAGE_AO]);
    if (job->normals)
        images.normals = gpu_image_slot(&session->images[IMAGE_NORMALS]);
    if (job->color) {
        images.color = gpu_image_slot(&session->images[IMAGE_COLOR]);
        images.output = gpu_image_slot(&session->images[IMAGE_OUTPUT]);
    }
    vkao_stage_flags stages = VKAO_STAGE_SSAO | VKAO_STAGE_BLUR | (job->color ? VKAO_STAGE_COMPOSITE : 0u);
    vkao_result result = vkao_frame_create(session->ctx, &(vkao_frame_info){
        .struct_size = sizeof(vkao_frame_info),
        .stages = stages,
        .extent = extent,
        .images = &images,
    }, &session->frame);
    if (result != VKAO_SUCCESS)
        return library_failed(err, "vkao_frame_create", result);
    session->extent = extent;
    session->has_normals = job->normals != NULL;
    session->has_color = job->color != NULL;
    return true;
}

static bool upload(struct ao_session *session, enum job_image which, const float *data, uint64_t texels,
                   struct tool_error *err)
{
    struct gpu_image *image = &session->images[which];
    return !data || gpu_image_upload(session->gpu, image, data, texels * gpu_format_bytes(image->format), err);
}

static bool record_and_run(struct ao_session *session, const struct ao_job *job, struct tool_error *err)
{
    VkCommandBuffer cmd = gpu_begin(session->gpu, err);
    if (!cmd)
        return false;
    vkao_result result = vkao_cmd_all(session->frame, cmd, &job->view, &job->ssao, &job->blur,
                                      job->color ? &job->composite : NULL);
    bool submitted = gpu_submit(session->gpu, cmd, err);
    return result == VKAO_SUCCESS ? submitted : library_failed(err, "vkao_cmd_all", result);
}

static float *download(struct ao_session *session, enum job_image which, uint64_t texels, struct tool_error *err)
{
    struct gpu_image *image = &session->images[which];
    uint64_t bytes = texels * gpu_format_bytes(image->format);
    float *data = malloc((size_t)bytes);
    if (!data) {
        fail(err, EXIT_MEMORY, "out of memory for %ux%u texels", image->extent.width, image->extent.height);
        return NULL;
    }
    if (gpu_image_download(session->gpu, image, data, bytes, err))
        return data;
    free(data);
    return NULL;
}

bool ao_run(struct ao_session *session, const struct ao_job *job, struct ao_result *result, struct tool_error *err)
{
    uint64_t texels = (uint64_t)job->width * job->height;
    bool same = session->frame && session->extent.width == job->width && session->extent.height == job->height &&
                session->has_normals == (job->normals != NULL) && session->has_color == (job->color != NULL);
    *result = (struct ao_result){0};
    if ((!same && !create_frame(session, job, err)) || !upload(session, IMAGE_DEPTH, job->depth, texels, err) ||
        !upload(session, IMAGE_NORMALS, job->normals, texels, err) ||
        !upload(session, IMAGE_COLOR, job->color, texels, err) || !record_and_run(session, job, err))
        return false;
    result->ao = download(session, IMAGE_AO, texels, err);
    if (result->ao && job->color)
        result->output = download(session, IMAGE_OUTPUT, texels, err);
    if (result->ao && (result->output || !job->color))
        return true;
    ao_result_free(result);
    return false;
}

void ao_result_free(struct ao_result *result)
{
    free(result->ao);
    free(result->output);
    *result = (struct ao_result){0};
}
