/* SPDX-License-Identifier: MIT */
#include "compute.h"

#include <string.h>
#include <vulkan/vulkan.h>

/* The panel offers what is in range only, so that an invalid argument is a bug. */
static bool library_ok(struct tool_error *err, const char *call, vkao_result result)
{
    return result == VKAO_SUCCESS || gpu_library_failed(err, call, result);
}

/* --- Frame and images --- */

/* What of the composite the images and the view allow. */
static void fit_composite(vkao_effect_info *e, const struct inputs *inputs, enum view_kind view)
{
    const bool color = inputs->images.color.format != VK_FORMAT_UNDEFINED;
    if (view == VIEW_DEPTH)
        e->composite_mode = VKAO_COMPOSITE_VIEW_Z;
    else if (view == VIEW_NORMALS)
        e->composite_mode = VKAO_COMPOSITE_NORMALS;
    else if (view == VIEW_BENT)
        e->composite_mode = VKAO_COMPOSITE_BENT_NORMALS;
    else if (!color ||
             (e->composite_mode == VKAO_COMPOSITE_INDIRECT && !inputs->images.direct.format))
        e->composite_mode = color ? VKAO_COMPOSITE_MULTIPLY : VKAO_COMPOSITE_AO_ONLY;
    if (view != VIEW_COMPOSITE || !inputs->images.albedo.format)
        e->multi_bounce = VK_FALSE;
    if (view != VIEW_COMPOSITE || e->composite_mode == VKAO_COMPOSITE_AO_ONLY ||
        !inputs->images.specular.format || !inputs->view.normal_encoding)
        e->specular = VKAO_SPECULAR_NONE;
    else if (e->specular == VKAO_SPECULAR_NONE || !method_has_bent(e->method))
        e->specular = VKAO_SPECULAR_FROM_AO;
}

static struct shape shape_of(const struct inputs *inputs, const struct setting *setting,
                             enum view_kind view)
{
    const vkao_effect_info standard = vkao_effect_info_default();
    struct shape s;
    memset(&s, 0, sizeof s);
    s.extent = inputs->extent;
    const bool shows_bent = view == VIEW_BENT && method_has_bent(setting->effect.method);
    s.composite =
        view == VIEW_COMPOSITE || view == VIEW_DEPTH || view == VIEW_NORMALS || shows_bent;
    s.inputs = inputs->images;
    if (view != VIEW_COMPOSITE) {
        const vkao_image none = {0};
        s.inputs.color = s.inputs.direct = s.inputs.albedo = s.inputs.specular = none;
    }
    s.effect = setting_for_view(setting, view).effect;
    s.effect.stages = VKAO_STAGE_SSAO | VKAO_STAGE_BLUR | (s.composite ? VKAO_STAGE_COMPOSITE : 0u);
    ao_view_describe(&inputs->view, &s.effect);
    if (s.composite) {
        fit_composite(&s.effect, inputs, view);
    } else { /* nothing is compiled anew when it changes */
        s.effect.composite_mode = standard.composite_mode;
        s.effect.multi_bounce = standard.multi_bounce;
        s.effect.specular = standard.specular;
    }
    /* vkao writes those that its specular light is by. */
    s.bent = shows_bent || s.effect.specular == VKAO_SPECULAR_FROM_BENT;
    s.effect.bent_normals = s.bent;
    s.effect.ao_format = VK_FORMAT_R32_SFLOAT;
    return s;
}

bool computation_fits(const struct computation *c, const struct inputs *inputs,
                      const struct setting *setting, enum view_kind view)
{
    const struct shape wanted = shape_of(inputs, setting, view);
    return c->frame && memcmp(&wanted, &c->shape, sizeof wanted) == 0;
}

bool computation_create(struct computation *c, struct gpu *gpu, const vkao_context *ctx,
                        const struct inputs *inputs, const struct setting *setting,
                        enum view_kind view, struct tool_error *err)
{
    const VkImageUsageFlags usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_STORAGE_BIT;
    const struct shape shape = shape_of(inputs, setting, view);
    computation_destroy(c);
    c->gpu = gpu;
    c->shape = shape;
    vkao_images images = shape.inputs;
    bool ok = gpu_image_create(gpu, VK_FORMAT_R32_SFLOAT, shape.extent, usage, &c->ao, err) &&
              (!shape.bent || gpu_image_create(gpu, VK_FORMAT_R32G32B32A32_SFLOAT, shape.extent,
                                               usage, &c->bent, err)) &&
              (!shape.composite || gpu_image_create(gpu, VK_FORMAT_R32G32B32A32_SFLOAT,
                                                    shape.extent, usage, &c->output, err));
    images.ao = gpu_image_slot(&c->ao);
    images.ao.image = c->ao.image;
    if (shape.bent)
        images.bent_normals = gpu_image_slot(&c->bent);
    if (shape.composite)
        images.output = gpu_image_slot(&c->output);
    ok =
        ok &&
        library_ok(err, "vkao_effect_create", vkao_effect_create(ctx, &shape.effect, &c->effect)) &&
        library_ok(err, "vkao_frame_create",
                   vkao_frame_create(c->effect,
                                     &(vkao_frame_info){
                                         .struct_size = sizeof(vkao_frame_info),
                                         .extent = shape.extent,
                                         .images = &images,
                                     },
                                     &c->frame));
    if (!ok)
        computation_destroy(c);
    return ok;
}

void computation_destroy(struct computation *c)
{
    if (!c->gpu)
        return;
    vkao_frame_destroy(c->frame);
    vkao_effect_destroy(c->effect);
    gpu_image_destroy(c->gpu, &c->ao);
    gpu_image_destroy(c->gpu, &c->bent);
    gpu_image_destroy(c->gpu, &c->output);
    *c = (struct computation){0};
}

/* --- Recording --- */

static void barrier(VkCommandBuffer cmd, VkPipelineStageFlags from, VkPipelineStageFlags to,
                    VkAccessFlags before, VkAccessFlags after)
{
    vkCmdPipelineBarrier(cmd, from, to, 0, 1,
                         &(VkMemoryBarrier){
                             .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                             .srcAccessMask = before,
                             .dstAccessMask = after,
                         },
                         0, NULL, 0, NULL);
}

static void stamp(VkCommandBuffer cmd, VkQueryPool pool, uint32_t query)
{
    if (pool)
        vkCmdWriteTimestamp(cmd, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, pool, query);
}

bool computation_record(const struct computation *c, VkCommandBuffer cmd,
                        const struct inputs *inputs, const struct setting *setting,
                        enum view_kind view, VkQueryPool pool, uint32_t query,
                        struct tool_error *err)
{
    const VkPipelineStageFlags compute = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT;
    const VkPipelineStageFlags readers =
        VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT;
    const struct setting s = setting_for_view(setting, view);
    const vkao_view library_view = ao_library_view(&inputs->view);
    if (pool)
        vkCmdResetQueryPool(cmd, pool, query, STAGES + 1);
    /* The display and the probe of earlier frames read the results -> vkao writes them. */
    barrier(cmd, readers | compute, compute, VK_ACCESS_SHADER_WRITE_BIT,
            VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT);
    stamp(cmd, pool, query);
    static const vkao_stage_flags stages[STAGES] = {VKAO_STAGE_PREPARE, VKAO_STAGE_SSAO,
                                                    VKAO_STAGE_BLUR, VKAO_STAGE_COMPOSITE};
    vkao_result result = VKAO_SUCCESS;
    for (uint32_t i = 0; i < STAGES; i++) {
        if (result == VKAO_SUCCESS && (stages[i] != VKAO_STAGE_COMPOSITE || c->shape.composite))
            result = vkao_cmd_stage(c->frame, cmd, stages[i], &library_view, &s.params);
        stamp(cmd, pool, query + i + 1);
    }
    /* vkao wrote the results -> the display and the probe read them. */
    barrier(cmd, compute, readers, VK_ACCESS_SHADER_WRITE_BIT,
            VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_TRANSFER_READ_BIT);
    return library_ok(err, "vkao", result);
}

bool read_stage_times(const struct gpu *gpu, VkQueryPool pool, uint32_t query,
                      struct stage_times *times, struct tool_error *err)
{
    uint64_t ticks[STAGES + 1];
    VkResult result = vkGetQueryPoolResults(gpu->device, pool, query, STAGES + 1, sizeof ticks,
                                            ticks, sizeof ticks[0], VK_QUERY_RESULT_64_BIT);
    if (result == VK_NOT_READY || !gpu_ok(err, "vkGetQueryPoolResults", result))
        return false;
    for (int i = 0; i < STAGES; i++)
        times->ms[i] = gpu_ms_between(gpu, ticks[i], ticks[i + 1]);
    return true;
}

VkImageView computation_result(const struct computation *c, enum view_kind view)
{
    const bool shows_output = view != VIEW_RAW && view != VIEW_AO && view != VIEW_DIFFERENCE;
    return shows_output ? c->output.view : c->ao.view;
}
