/* SPDX-License-Identifier: MIT */
#include "pipeline.h"

#include "internal.h"

#include "blur.comp.h"
#include "blur_buf.comp.h"
#include "blur_x_buffers_buf.comp.h"
#include "blur_y_buffers_buf.comp.h"
#include "blur_z16.comp.h"
#include "composite.comp.h"
#include "composite_buf.comp.h"
#include "composite_z16.comp.h"
#include "debug.comp.h"
#include "debug_buf.comp.h"
#include "debug_z16.comp.h"
#include "prepare.comp.h"
#include "prepare_buffers_buf.comp.h"
#include "prepare_z16.comp.h"
#include "ssao_gtao.comp.h"
#include "ssao_gtao_buf.comp.h"
#include "ssao_gtao_z16.comp.h"
#include "ssao_hbao.comp.h"
#include "ssao_hbao_buf.comp.h"
#include "ssao_hbao_z16.comp.h"
#include "ssao_hemisphere.comp.h"
#include "ssao_hemisphere_buf.comp.h"
#include "ssao_hemisphere_z16.comp.h"
#include "ssao_raymarch.comp.h"
#include "ssao_raymarch_buf.comp.h"
#include "ssao_raymarch_z16.comp.h"
#include "ssao_sphere.comp.h"
#include "ssao_sphere_buf.comp.h"
#include "ssao_sphere_z16.comp.h"
#include "ssao_vbao.comp.h"
#include "ssao_vbao_buf.comp.h"
#include "ssao_vbao_z16.comp.h"
#include "tiles_buf.comp.h"
#include "upsample.comp.h"
#include "upsample_buf.comp.h"
#include "upsample_buffers_buf.comp.h"
#include "upsample_z16.comp.h"

#include <string.h>

/* How view z is kept. */
enum build { BUILD_Z32, BUILD_Z16, BUILD_BUFFERS, BUILD_COUNT };

struct shader {
    const char *name;
    struct {
        const uint32_t *code; /* NULL = not in this build */
        size_t bytes;
    } builds[BUILD_COUNT];
    VkBool32 vertical; /* VKAO_CONSTANT_BLUR_VERTICAL */
    bool bent;         /* has a form with VKAO_CONSTANT_BENT_NORMALS */
    VkExtent2D texels; /* of one invocation in BUILD_BUFFERS; in images it is one */
};

#define CODE(name)                                                                                 \
    {                                                                                              \
        name, sizeof name                                                                          \
    }
#define SHADER(name)                                                                               \
#name,                                                                                         \
    {                                                                                              \
        CODE(name##_comp), CODE(name##_z16_comp), CODE(name##_buf_comp)                            \
    }
#define ONE_TEXEL                                                                                  \
    {                                                                                              \
        1, 1                                                                                       \
    }
#define SSAO_TEXELS                                                                                \
    {                                                                                              \
        VKAO_SSAO_TEXELS, 1                                                                        \
    }
static const struct shader shaders[PIPELINE_COUNT] = {
    [PIPELINE_PREPARE] = {"prepare",
                          {CODE(prepare_comp), CODE(prepare_z16_comp),
                           CODE(prepare_buffers_buf_comp)},
                          VK_FALSE,
                          false,
                          {VKAO_PREPARE_WIDTH, 1}},
    [PIPELINE_BLUR_X] = {SHADER(blur), VK_FALSE, true, ONE_TEXEL},
    [PIPELINE_BLUR_Y] = {SHADER(blur), VK_TRUE, true, ONE_TEXEL},
    [PIPELINE_UPSAMPLE] = {SHADER(upsample), VK_FALSE, true, ONE_TEXEL},
    [PIPELINE_TILES] = {"tiles",
                        {[BUILD_BUFFERS] = CODE(tiles_buf_comp)},
                        VK_FALSE,
                        true,
                        ONE_TEXEL},
    [PIPELINE_PACKED_BLUR_X] = {"blur_x",
                                {[BUILD_BUFFERS] = CODE(blur_x_buffers_buf_comp)},
                                VK_FALSE,
                                false,
                                {VKAO_BLUR_X_WIDTH, 1}},
    [PIPELINE_PACKED_BLUR_Y] = {"blur_y",
                                {[BUILD_BUFFERS] = CODE(blur_y_buffers_buf_comp)},
                                VK_TRUE,
                                false,
                                {VKAO_BLUR_Y_WIDTH, VKAO_BLUR_Y_HEIGHT}},
    [PIPELINE_PACKED_UPSAMPLE] = {"upsample",
                                  {[BUILD_BUFFERS] = CODE(upsample_buffers_buf_comp)},
                                  VK_FALSE,
                                  false,
                                  {VKAO_UPSAMPLE_WIDTH, VKAO_UPSAMPLE_HEIGHT}},
    [PIPELINE_COMPOSITE] = {SHADER(composite), VK_FALSE, false, ONE_TEXEL},
    [PIPELINE_DEBUG] = {SHADER(debug), VK_FALSE, false, ONE_TEXEL},
    [PIPELINE_SSAO + VKAO_SSAO_SPHERE] = {SHADER(ssao_sphere), VK_FALSE, false, ONE_TEXEL},
    [PIPELINE_SSAO + VKAO_SSAO_HEMISPHERE] = {SHADER(ssao_hemisphere), VK_FALSE, false, SSAO_TEXELS},
    [PIPELINE_SSAO + VKAO_SSAO_HBAO] = {SHADER(ssao_hbao), VK_FALSE, false, SSAO_TEXELS},
    [PIPELINE_SSAO + VKAO_SSAO_GTAO] = {SHADER(ssao_gtao), VK_FALSE, true, SSAO_TEXELS},
    [PIPELINE_SSAO + VKAO_SSAO_VBAO] = {SHADER(ssao_vbao), VK_FALSE, true, SSAO_TEXELS},
    [PIPELINE_SSAO + VKAO_SSAO_RAYMARCH] = {SHADER(ssao_raymarch), VK_FALSE, true, ONE_TEXEL},
};

static enum build context_build(const vkao_context *ctx)
{
    return ctx->buffers ? BUILD_BUFFERS : ctx->half_view_z ? BUILD_Z16 : BUILD_Z32;
}

VkExtent2D pipeline_texels(const vkao_context *ctx, enum pipeline which)
{
    return ctx->buffers ? shaders[which].texels : (VkExtent2D)ONE_TEXEL;
}

static_assert(sizeof(struct pipeline_key) ==
                  (VKAO_CONSTANT_COUNT - VKAO_CONSTANT_FLAGS) * sizeof(uint32_t),
              "the constants from VKAO_CONSTANT_FLAGS on");

VkExtent2D pipeline_group(const vkao_context *ctx, enum pipeline which)
{
    return ctx->buffers && (which >= PIPELINE_SSAO || which == PIPELINE_TILES)
               ? (VkExtent2D){VKAO_ROW_GROUP_WIDTH, 1}
               : (VkExtent2D){VKAO_GROUP_WIDTH, VKAO_GROUP_HEIGHT};
}

#define ENUM_FLAGS(shift, bits) (((1u << (bits)) - 1u) << (shift))

/* The flags that a stage's shader asks for; the rest is left out of its key. */
static uint32_t stage_flags(enum pipeline which)
{
    const uint32_t normals = ENUM_FLAGS(VKAO_FLAG_NORMALS_SHIFT, 3),
                   bent = ENUM_FLAGS(VKAO_FLAG_BENT_SHIFT, 3),
                   depth = ENUM_FLAGS(VKAO_FLAG_DEPTH_SHIFT, 2) | VKAO_FLAG_ORTHOGRAPHIC |
                           VKAO_FLAG_FAR_IS_ONE,
                   blur = normals | bent | VKAO_FLAG_BLUR_NORMALS | VKAO_FLAG_NORMAL_POWER_8 |
                          VKAO_FLAG_PHYSICAL,
                   finish = blur | ENUM_FLAGS(VKAO_FLAG_STAGED_SHIFT, 3);
    switch (which) {
    case PIPELINE_TILES:
        return VKAO_FLAG_PACKED;
    case PIPELINE_PREPARE:
        return depth | VKAO_FLAG_HALF_RESOLUTION;
    case PIPELINE_BLUR_X:
    case PIPELINE_BLUR_Y:
    case PIPELINE_PACKED_BLUR_X:
        return blur | VKAO_FLAG_HALF_RESOLUTION;
    case PIPELINE_PACKED_BLUR_Y:
        return finish | VKAO_FLAG_HALF_RESOLUTION;
    case PIPELINE_UPSAMPLE:
    case PIPELINE_PACKED_UPSAMPLE:
        return finish | depth;
    case PIPELINE_COMPOSITE:
    case PIPELINE_DEBUG:
        return 0;
    default:
        return normals | VKAO_FLAG_ORTHOGRAPHIC | VKAO_FLAG_NORMALS_ALIGNED |
               VKAO_FLAG_HALF_RESOLUTION | VKAO_FLAG_THRESHOLD | VKAO_FLAG_SPHERE_LITERAL |
               VKAO_FLAG_PACKED;
    }
}

/* Loops this long are not worth unrolling: they take long to compile, and their overhead is small. */
enum { MAX_UNROLLED = 64 };

struct pipeline_key pipeline_key(enum pipeline which, uint32_t flags, const vkao_ssao_params *ssao,
                                 const vkao_blur_params *blur)
{
    struct pipeline_key key = {.flags = flags & stage_flags(which)};
    if (blur && (which == PIPELINE_PACKED_BLUR_X || which == PIPELINE_PACKED_BLUR_Y))
        key.radius = blur->radius;
    if (!ssao || which != (enum pipeline)(PIPELINE_SSAO + (int)ssao->method))
        return key;
    switch (ssao->method) {
    case VKAO_SSAO_SPHERE:
    case VKAO_SSAO_HEMISPHERE:
        if (ssao->sample_count <= MAX_UNROLLED)
            key.samples = ssao->sample_count;
        break;
    case VKAO_SSAO_RAYMARCH:
        break;
    default:
        if (ssao->slice_count * ssao->step_count <= MAX_UNROLLED) {
            key.slices = ssao->slice_count;
            key.steps = ssao->step_count;
        }
    }
    return key;
}

/* Does the matrix only turn axes round? */
static bool is_aligned(const float rows[3][3])
{
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) {
            if (r != c && rows[r][c] != 0.0f)
                return false;
        }
    }
    return true;
}

static uint32_t way_flags(bool packed, uint32_t staged)
{
    return (packed ? VKAO_FLAG_PACKED : 0u) | staged << VKAO_FLAG_STAGED_SHIFT;
}

uint32_t frame_flags(const vkao_frame *frame)
{
    return way_flags(frame->packed, frame->staged);
}

uint32_t recording_flags(const struct view_constants *view, uint32_t way,
                         const vkao_ssao_params *ssao, const vkao_blur_params *blur)
{
    uint32_t flags = way | (view->encodings & 0xffu) << VKAO_FLAG_NORMALS_SHIFT |
                     (view->encodings >> 8) << VKAO_FLAG_BENT_SHIFT |
                     view->depth_encoding << VKAO_FLAG_DEPTH_SHIFT;
    const struct {
        bool is;
        uint32_t flag;
    } facts[] = {
        {view->orthographic, VKAO_FLAG_ORTHOGRAPHIC},
        {view->far_depth > 0.5f, VKAO_FLAG_FAR_IS_ONE},
        {is_aligned(view->normal_rows), VKAO_FLAG_NORMALS_ALIGNED},
        {view->grid_shift > 0, VKAO_FLAG_HALF_RESOLUTION},
        {ssao && ssao->falloff == VKAO_FALLOFF_THRESHOLD, VKAO_FLAG_THRESHOLD},
        {ssao && ssao->sphere_form == VKAO_SPHERE_LITERAL, VKAO_FLAG_SPHERE_LITERAL},
        {blur && blur->normal_power > 0.0f, VKAO_FLAG_BLUR_NORMALS},
        {blur && blur->normal_power == 8.0f, VKAO_FLAG_NORMAL_POWER_8},
        {blur && blur->intensity == 1.0f && blur->power == 1.0f, VKAO_FLAG_PHYSICAL},
    };
    for (size_t i = 0; i < sizeof facts / sizeof facts[0]; ++i)
        flags |= facts[i].is ? facts[i].flag : 0u;
    return flags;
}

static vkao_result create_pipeline(vkao_context *ctx, VkPipelineCache cache, enum pipeline which,
                                   VkBool32 bent, struct pipeline_key key, VkPipeline *out)
{
    const struct shader *shader = &shaders[which];
    const enum build build = context_build(ctx);
    VkShaderModule module = VK_NULL_HANDLE;
    VkResult result =
        ctx->vk.CreateShaderModule(ctx->device,
                                   &(VkShaderModuleCreateInfo){
                                       .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                       .codeSize = shader->builds[build].bytes,
                                       .pCode = shader->builds[build].code,
                                   },
                                   ctx->allocator, &module);
    if (result != VK_SUCCESS)
        return vkao_vk_failed(&ctx->log, "vkCreateShaderModule", result);
    const uint32_t constants[VKAO_CONSTANT_COUNT] = {
        [VKAO_CONSTANT_BLUR_VERTICAL] = shader->vertical,
        [VKAO_CONSTANT_BENT_NORMALS] = bent,
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
        ctx->allocator, out);
    ctx->vk.DestroyShaderModule(ctx->device, module, ctx->allocator);
    if (result != VK_SUCCESS) {
        *out = VK_NULL_HANDLE; /* drivers may leave anything behind a failure */
        return vkao_vk_failed(&ctx->log, "vkCreateComputePipelines", result);
    }
    vkao_set_name(ctx, VK_OBJECT_TYPE_PIPELINE, (uint64_t)*out, shader->name);
    return VKAO_SUCCESS;
}

/* variants_only leaves what variants do not have: COMPOSITE. */
static vkao_result create_general(vkao_context *ctx, VkPipelineCache cache, bool variants_only)
{
    const struct pipeline_key general = {.flags = VKAO_FLAGS_UNKNOWN};
    vkao_result result = VKAO_SUCCESS;
    for (uint32_t i = 0; result == VKAO_SUCCESS && i < PIPELINE_COUNT; ++i) {
        if ((variants_only && i != PIPELINE_COMPOSITE && i != PIPELINE_DEBUG) ||
            !shaders[i].builds[context_build(ctx)].code ||
            (i >= PIPELINE_SSAO && !(ctx->method_mask >> (i - PIPELINE_SSAO) & 1u)))
            continue;
        for (VkBool32 bent = 0; result == VKAO_SUCCESS && bent <= shaders[i].bent; ++bent)
            result = create_pipeline(ctx, cache, (enum pipeline)i, bent, general,
                                     &ctx->pipelines.general[i][bent]);
    }
    return result;
}

static VkPipeline find_variant(const struct pipelines *p, enum pipeline which, VkBool32 bent,
                               const struct pipeline_key *key)
{
    for (uint32_t i = 0; i < p->variant_count; ++i) {
        const struct pipeline_variant *v = &p->variants[i];
        if (v->which == which && v->bent == bent && memcmp(&v->key, key, sizeof *key) == 0)
            return v->pipeline;
    }
    return VK_NULL_HANDLE;
}

/* Adds one unless it is there already. */
static vkao_result add_variant(vkao_context *ctx, VkPipelineCache cache,
                               const struct pipeline_variant *wanted)
{
    struct pipelines *p = &ctx->pipelines;
    if (find_variant(p, wanted->which, wanted->bent, &wanted->key))
        return VKAO_SUCCESS;
    struct pipeline_variant *v = &p->variants[p->variant_count];
    *v = *wanted;
    vkao_result result = create_pipeline(ctx, cache, v->which, v->bent, v->key, &v->pipeline);
    if (result == VKAO_SUCCESS)
        ++p->variant_count;
    return result;
}

/* Of one variant, at most. */
enum { VARIANT_STAGES = 6 };

/* What a variant asks for, stage by stage. */
struct variant_plan {
    struct pipeline_variant stages[VARIANT_STAGES];
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
    if (result == VKAO_SUCCESS &&
        (info.half_resolution > 1 || info.bent_normals > 1))
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
    const uint32_t way = way_flags(packed, packed ? vk_format_staged(info.staged_ao) : 0);
    const enum pipeline stages[VARIANT_STAGES] = {
        PIPELINE_PREPARE,
        PIPELINE_TILES,
        (enum pipeline)(PIPELINE_SSAO + (int)ssao.method),
        packed ? PIPELINE_PACKED_BLUR_X : PIPELINE_BLUR_X,
        packed ? PIPELINE_PACKED_BLUR_Y : PIPELINE_BLUR_Y,
        packed ? PIPELINE_PACKED_UPSAMPLE : PIPELINE_UPSAMPLE,
    };
    view.grid_shift = info.half_resolution;
    plan->count = 0;
    for (size_t i = 0; i < (!has_blur ? 3 : info.half_resolution ? 6 : 5); ++i) {
        if (!shaders[stages[i]].builds[context_build(ctx)].code)
            continue;
        /* Upsampling is of the image's own grid. */
        struct view_constants grid = view;
        if (stages[i] == PIPELINE_UPSAMPLE || stages[i] == PIPELINE_PACKED_UPSAMPLE)
            grid.grid_shift = 0;
        const uint32_t flags = recording_flags(&grid, way, &ssao, has_blur);
        plan->stages[plan->count++] = (struct pipeline_variant){
            .which = stages[i],
            .bent = info.bent_normals && shaders[stages[i]].bent,
            .key = pipeline_key(stages[i], flags, &ssao, has_blur),
        };
    }
    return VKAO_SUCCESS;
}

static vkao_result add_variant_stages(vkao_context *ctx, VkPipelineCache cache,
                                      const vkao_variant *variant)
{
    struct variant_plan plan;
    vkao_result result = plan_variant(ctx, &ctx->log, variant, &plan);
    for (size_t i = 0; result == VKAO_SUCCESS && i < plan.count; ++i)
        result = add_variant(ctx, cache, &plan.stages[i]);
    return result;
}

VkBool32 vkao_context_has_variant(const vkao_context *ctx, const vkao_variant *variant)
{
    const struct vkao_logger silent = {0};
    struct variant_plan plan;
    if (!ctx || plan_variant(ctx, &silent, variant, &plan) != VKAO_SUCCESS)
        return VK_FALSE;
    for (size_t i = 0; i < plan.count; ++i) {
        const struct pipeline_variant *v = &plan.stages[i];
        if (!find_variant(&ctx->pipelines, v->which, v->bent, &v->key))
            return VK_FALSE;
    }
    return VK_TRUE;
}

vkao_result pipelines_create(vkao_context *ctx, const vkao_context_info *info)
{
    struct pipelines *p = &ctx->pipelines;
    struct variant_plan plan;
    vkao_result result = VKAO_SUCCESS;
    /* Compiling may take seconds: a bad variant is refused before. */
    for (uint32_t i = 0; result == VKAO_SUCCESS && i < info->variant_count; ++i)
        result = plan_variant(ctx, &ctx->log, &info->variants[i], &plan);
    if (result == VKAO_SUCCESS)
        result = create_general(ctx, info->pipeline_cache, info->variants_only);
    if (result != VKAO_SUCCESS || !info->variant_count)
        return result;
    p->variants =
        vkao_calloc(ctx->allocator, info->variant_count * VARIANT_STAGES * sizeof p->variants[0]);
    if (!p->variants)
        return vkao_refuse(&ctx->log, VKAO_ERROR_OUT_OF_HOST_MEMORY,
                           "no host memory for context.variants");
    for (uint32_t i = 0; result == VKAO_SUCCESS && i < info->variant_count; ++i)
        result = add_variant_stages(ctx, info->pipeline_cache, &info->variants[i]);
    return result;
}

void pipelines_destroy(vkao_context *ctx)
{
    struct pipelines *p = &ctx->pipelines;
    for (uint32_t i = 0; i < PIPELINE_COUNT; ++i) {
        for (int bent = 0; bent < 2; ++bent) {
            if (p->general[i][bent])
                ctx->vk.DestroyPipeline(ctx->device, p->general[i][bent], ctx->allocator);
        }
    }
    for (uint32_t i = 0; i < p->variant_count; ++i)
        ctx->vk.DestroyPipeline(ctx->device, p->variants[i].pipeline, ctx->allocator);
    vkao_free(ctx->allocator, p->variants);
}

VkPipeline pipeline_find(const vkao_context *ctx, enum pipeline which, bool bent,
                         struct pipeline_key key)
{
    const VkBool32 is_bent = bent && shaders[which].bent;
    VkPipeline variant = find_variant(&ctx->pipelines, which, is_bent, &key);
    return variant ? variant : ctx->pipelines.general[which][is_bent];
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
        {ssao && frame->ctx->buffers, PIPELINE_TILES, &grid},
        {ssao, ssao ? (enum pipeline)(PIPELINE_SSAO + (int)ssao->method) : PIPELINE_SSAO, &grid},
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
                               shaders[which].name);
    }
    return VKAO_SUCCESS;
}
