/* SPDX-License-Identifier: MIT
 *
 * Which pipelines a context has, and how they are found again. */
#include "pipeline.h"

#include "internal.h"

#include <string.h>

static const struct pipeline_key general = {.flags = VKAO_FLAGS_UNKNOWN};

static struct pipeline_entry *find_entry(const struct pipelines *p, enum pipeline which,
                                         VkBool32 bent, const struct pipeline_key *key)
{
    for (uint32_t i = 0; i < p->count; ++i) {
        struct pipeline_entry *e = &p->entries[i];
        if (e->which == which && e->bent == bent && memcmp(&e->key, key, sizeof *key) == 0)
            return e;
    }
    return NULL;
}

/* Adds one, yet to be created, unless it is there already. */
static void add_entry(struct pipelines *p, const struct pipeline_entry *wanted)
{
    if (!find_entry(p, wanted->which, wanted->bent, &wanted->key))
        p->entries[p->count++] = *wanted;
}

/* The stage that a pipeline is for. */
static vkao_stage_flags pipeline_stage(enum pipeline which)
{
    switch (which) {
    case PIPELINE_PREPARE:
        return VKAO_STAGE_SSAO | VKAO_STAGE_BLUR;
    case PIPELINE_COMPOSITE:
    case PIPELINE_DEBUG:
        return VKAO_STAGE_COMPOSITE;
    case PIPELINE_BLUR_X:
    case PIPELINE_BLUR_Y:
    case PIPELINE_UPSAMPLE:
    case PIPELINE_PACKED_BLUR_X:
    case PIPELINE_PACKED_BLUR_Y:
    case PIPELINE_PACKED_UPSAMPLE:
        return VKAO_STAGE_BLUR;
    default:
        return VKAO_STAGE_SSAO;
    }
}

/* variants_only leaves what variants do not have. */
static void plan_general(vkao_context *ctx, bool variants_only)
{
    for (uint32_t i = 0; i < PIPELINE_COUNT; ++i) {
        const enum pipeline which = (enum pipeline)i;
        const struct shader_code shader = shader_code(ctx, which, true);
        if (!shader.code || !(pipeline_stage(which) & ctx->stage_mask) ||
            (variants_only && pipeline_stage(which) != VKAO_STAGE_COMPOSITE) ||
            (i >= PIPELINE_SSAO && !(ctx->method_mask >> (i - PIPELINE_SSAO) & 1u)))
            continue;
        for (VkBool32 bent = 0; bent <= shader.bent; ++bent)
            add_entry(&ctx->pipelines,
                      &(struct pipeline_entry){which, bent, general, VK_NULL_HANDLE, VKAO_SUCCESS});
    }
}

static vkao_result create_pipeline(const vkao_context *ctx, VkPipelineCache cache,
                                   struct pipeline_entry *entry)
{
    const struct pipeline_key key = entry->key;
    const struct shader_code shader =
        shader_code(ctx, entry->which, memcmp(&key, &general, sizeof key) == 0);
    VkShaderModule module = VK_NULL_HANDLE;
    VkResult result =
        ctx->vk.CreateShaderModule(ctx->device,
                                   &(VkShaderModuleCreateInfo){
                                       .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                       .codeSize = shader.bytes,
                                       .pCode = shader.code,
                                   },
                                   ctx->allocator, &module);
    if (result != VK_SUCCESS)
        return vkao_vk_failed(&ctx->log, "vkCreateShaderModule", result);
    const uint32_t constants[VKAO_CONSTANT_COUNT] = {
        [VKAO_CONSTANT_BLUR_VERTICAL] = shader.vertical,
        [VKAO_CONSTANT_BENT_NORMALS] = entry->bent,
        [VKAO_CONSTANT_FLAGS] = key.flags,
        [VKAO_CONSTANT_SLICES] = key.slices,
        [VKAO_CONSTANT_STEPS] = key.steps,
        [VKAO_CONSTANT_SAMPLES] = key.samples,
        [VKAO_CONSTANT_RADIUS] = key.radius,
    };
    /* Entries for constants that a shader does not have are ignored. */
    VkSpecializationMapEntry entries[VKAO_CONSTANT_COUNT];
    for (uint32_t i = 0; i < VKAO_CONSTANT_COUNT; ++i)
        entries[i] = (VkSpecializationMapEntry){i, i * sizeof constants[0], sizeof constants[0]};
    const VkSpecializationInfo specialization = {VKAO_CONSTANT_COUNT, entries, sizeof constants,
                                                 constants};
    result = ctx->vk.CreateComputePipelines(
        ctx->device, cache, 1,
        &(VkComputePipelineCreateInfo){
            .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
            .stage =
                {
                    .sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                    .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                    .module = module,
                    .pName = "main",
                    .pSpecializationInfo = &specialization,
                },
            .layout = ctx->pipeline_layout,
        },
        ctx->allocator, &entry->pipeline);
    ctx->vk.DestroyShaderModule(ctx->device, module, ctx->allocator);
    if (result != VK_SUCCESS) {
        entry->pipeline = VK_NULL_HANDLE; /* drivers may leave anything behind a failure */
        return vkao_vk_failed(&ctx->log, "vkCreateComputePipelines", result);
    }
    vkao_set_name(ctx, VK_OBJECT_TYPE_PIPELINE, (uint64_t)entry->pipeline, shader.name);
    return VKAO_SUCCESS;
}

/* Of one variant, at most. */
enum { VARIANT_STAGES = 6 };

/* What a variant asks for, stage by stage. */
struct variant_plan {
    struct pipeline_entry stages[VARIANT_STAGES];
    size_t count;
};

/* log: of the context, or a silent one. */
static vkao_result plan_variant(const vkao_context *ctx, const struct vkao_logger *log,
                                const vkao_variant *caller_variant, struct variant_plan *plan)
{
    struct view_constants view;
    vkao_variant info;
    vkao_ssao_params ssao;
    vkao_blur_params blur;
    vkao_view caller_view;
    const VkExtent2D any = {ctx->max_dimension, ctx->max_dimension};
    vkao_result result = vkao_import(log, "variant", caller_variant, &info, sizeof info);
    if (result == VKAO_SUCCESS && (info.half_resolution > 1 || info.bent_normals > 1))
        result = vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT,
                             "variant.half_resolution is %u, bent_normals %u, want 0 or 1",
                             info.half_resolution, info.bent_normals);
    if (result == VKAO_SUCCESS && info.staged_ao && !vk_format_is_ao(info.staged_ao))
        result = vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT,
                             "variant.staged_ao is VkFormat %d, which cannot hold AO",
                             (int)info.staged_ao);
    if (result == VKAO_SUCCESS)
        result = vkao_import(log, "variant.view", info.view, &caller_view, sizeof caller_view);
    if (result == VKAO_SUCCESS)
        result = view_constants_init(log, &caller_view, any, VK_FORMAT_UNDEFINED, &view);
    if (result == VKAO_SUCCESS)
        result = ssao_params_check(ctx, log, info.bent_normals, info.ssao, &ssao);
    if (result == VKAO_SUCCESS && info.blur)
        result = blur_params_check(log, info.blur, &blur);
    if (result != VKAO_SUCCESS)
        return result;
    const vkao_blur_params *has_blur = info.blur ? &blur : NULL;
    const bool packed = ctx->buffers && has_blur && !info.bent_normals;
    const uint32_t way = recording_way(packed, packed ? vk_format_staged(info.staged_ao) : 0);
    /* SSAO first: it takes longest to compile, beside the others if there are threads. */
    const enum pipeline stages[VARIANT_STAGES] = {
        (enum pipeline)(PIPELINE_SSAO + (int)ssao.method),
        PIPELINE_PREPARE,
        PIPELINE_TILES,
        packed ? PIPELINE_PACKED_BLUR_X : PIPELINE_BLUR_X,
        packed ? PIPELINE_PACKED_BLUR_Y : PIPELINE_BLUR_Y,
        packed ? PIPELINE_PACKED_UPSAMPLE : PIPELINE_UPSAMPLE,
    };
    view.grid_shift = info.half_resolution;
    plan->count = 0;
    for (size_t i = 0; i < (!has_blur ? 3 : info.half_resolution ? 6 : 5); ++i) {
        if (!shader_code(ctx, stages[i], false).code)
            continue;
        /* Upsampling is of the image's own grid. */
        struct view_constants grid = view;
        if (stages[i] == PIPELINE_UPSAMPLE || stages[i] == PIPELINE_PACKED_UPSAMPLE)
            grid.grid_shift = 0;
        const uint32_t flags = recording_flags(&grid, way, &ssao, has_blur);
        plan->stages[plan->count++] = (struct pipeline_entry){
            .which = stages[i],
            .bent = info.bent_normals && shader_code(ctx, stages[i], false).bent,
            .key = pipeline_key(stages[i], flags, &ssao, has_blur),
        };
    }
    return VKAO_SUCCESS;
}

VkBool32 vkao_context_has_variant(const vkao_context *ctx, const vkao_variant *variant)
{
    const struct vkao_logger silent = {0};
    struct variant_plan plan;
    if (!ctx || plan_variant(ctx, &silent, variant, &plan) != VKAO_SUCCESS)
        return VK_FALSE;
    for (size_t i = 0; i < plan.count; ++i) {
        const struct pipeline_entry *v = &plan.stages[i];
        if (!find_entry(&ctx->pipelines, v->which, v->bent, &v->key))
            return VK_FALSE;
    }
    return VK_TRUE;
}

/* What a job of pipelines_create works on. */
struct creation {
    vkao_context *ctx;
    VkPipelineCache cache;
};

static void create_entry(void *data, uint32_t i)
{
    const struct creation *c = data;
    struct pipeline_entry *e = &c->ctx->pipelines.entries[i];
    e->result = create_pipeline(c->ctx, c->cache, e);
}

static vkao_result create_entries(vkao_context *ctx, const vkao_context_info *info)
{
    struct creation creation = {ctx, info->pipeline_cache};
    const struct pipelines *p = &ctx->pipelines;
    if (info->parallel) {
        info->parallel(info->parallel_user_data, p->count, create_entry, &creation);
    } else {
        for (uint32_t i = 0; i < p->count; ++i) {
            create_entry(&creation, i);
            if (p->entries[i].result != VKAO_SUCCESS)
                break;
        }
    }
    for (uint32_t i = 0; i < p->count; ++i) {
        if (p->entries[i].result != VKAO_SUCCESS)
            return p->entries[i].result;
    }
    return VKAO_SUCCESS;
}

vkao_result pipelines_create(vkao_context *ctx, const vkao_context_info *info)
{
    struct pipelines *p = &ctx->pipelines;
    struct variant_plan plan;
    p->entries =
        vkao_calloc(ctx->allocator, (PIPELINE_COUNT * 2 + info->variant_count * VARIANT_STAGES) *
                                        sizeof p->entries[0]);
    if (!p->entries)
        return vkao_refuse(&ctx->log, VKAO_ERROR_OUT_OF_HOST_MEMORY,
                           "no host memory for pipelines");
    plan_general(ctx, info->variants_only);
    /* Compiling may take seconds: a bad variant is refused before. */
    for (uint32_t i = 0; i < info->variant_count; ++i) {
        vkao_result result = plan_variant(ctx, &ctx->log, &info->variants[i], &plan);
        if (result != VKAO_SUCCESS)
            return result;
        for (size_t k = 0; k < plan.count; ++k) {
            if (pipeline_stage(plan.stages[k].which) & ctx->stage_mask)
                add_entry(p, &plan.stages[k]);
        }
    }
    return create_entries(ctx, info);
}

void pipelines_destroy(vkao_context *ctx)
{
    struct pipelines *p = &ctx->pipelines;
    for (uint32_t i = 0; i < p->count; ++i) {
        if (p->entries[i].pipeline)
            ctx->vk.DestroyPipeline(ctx->device, p->entries[i].pipeline, ctx->allocator);
    }
    vkao_free(ctx->allocator, p->entries);
}

VkPipeline pipeline_find(const vkao_context *ctx, enum pipeline which, bool bent,
                         struct pipeline_key key)
{
    const VkBool32 is_bent = bent && shader_code(ctx, which, false).bent;
    const struct pipeline_entry *e = find_entry(&ctx->pipelines, which, is_bent, &key);
    if (!e)
        e = find_entry(&ctx->pipelines, which, is_bent, &general);
    return e ? e->pipeline : VK_NULL_HANDLE;
}

vkao_result pipelines_check(const vkao_frame *frame, const struct view_constants *view,
                            const vkao_ssao_params *ssao, const vkao_blur_params *blur)
{
    const struct view_constants grid = frame_grid(frame, view);
    const bool packed = frame->packed;
    const struct {
        bool runs;
        enum pipeline which;
        const struct view_constants *grid;
    } stages[] = {
        {true, PIPELINE_PREPARE, &grid},
        /* Before its tiles: the log names what callers know. */
        {ssao, ssao ? (enum pipeline)(PIPELINE_SSAO + (int)ssao->method) : PIPELINE_SSAO, &grid},
        {ssao && frame->ctx->buffers, PIPELINE_TILES, &grid},
        {blur, packed ? PIPELINE_PACKED_BLUR_X : PIPELINE_BLUR_X, &grid},
        {blur, packed ? PIPELINE_PACKED_BLUR_Y : PIPELINE_BLUR_Y, &grid},
        {blur && frame->half_resolution, packed ? PIPELINE_PACKED_UPSAMPLE : PIPELINE_UPSAMPLE,
         view},
    };
    for (size_t i = 0; i < sizeof stages / sizeof stages[0]; ++i) {
        const enum pipeline which = stages[i].which;
        if (!stages[i].runs)
            continue;
        const uint32_t flags = recording_flags(stages[i].grid, frame_flags(frame), ssao, blur);
        if (!pipeline_find(frame->ctx, which, frame_has_bent_normals(frame),
                           pipeline_key(which, flags, ssao, blur)))
            return vkao_refuse(&frame->ctx->log, VKAO_ERROR_INVALID_ARGUMENT,
                               "the context has variants_only, and none for these settings of %s",
                               shader_code(frame->ctx, which, false).name);
    }
    return VKAO_SUCCESS;
}
