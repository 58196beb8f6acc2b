/* SPDX-License-Identifier: MIT */
#include "effect.h"

#include "cpu/cpu.h"
#include "parameters.h"
#include "pipelines.h"
#include "stages.h"

#include <string.h>

/* May the counts of slices and steps be constants? vbao loops over slices, on CPUs all do. */
static bool unrolls(const struct vkao_program *program)
{
    const vkao_effect_info *e = &program->settings;
    const bool loops = program->is_cpu || e->method == VKAO_SSAO_VBAO;
    return (loops ? 1 : e->slice_count) * e->step_count <= VKAO_MOST_UNROLLED;
}

/* Is final AO rounded to half floats? If its image has them; and with COMPOSITE if the caller names
 * no format of more bits, as there may be no image then, and scratch has them. */
static bool final_ao_is_half(const vkao_effect_info *e)
{
    return e->ao_format == VK_FORMAT_R16_SFLOAT ||
           (e->stages & VKAO_STAGE_COMPOSITE && e->ao_format == VK_FORMAT_R8_UNORM);
}

/* Without noisy_ao BLUR reads it from scratch. */
static bool noisy_ao_is_half(const vkao_effect_info *e)
{
    return e->stages & VKAO_STAGE_BLUR ? !e->noisy_ao : final_ao_is_half(e);
}

static void set_constants(struct vkao_program *program)
{
    const vkao_effect_info *e = &program->settings;
    uint32_t *c = program->constants;
    const bool has_slices = vkao_method_reads(e->method, "slice_count");
    const bool has_samples =
        vkao_method_reads(e->method, "sample_count") && !vkao_method_reads(e->method, "step_count");
    c[VKAO_SETTING_DEPTH_ENCODING] = (uint32_t)e->depth_encoding;
    c[VKAO_SETTING_NORMAL_ENCODING] = (uint32_t)e->normal_encoding;
    c[VKAO_SETTING_BENT_ENCODING] = (uint32_t)e->bent_encoding;
    c[VKAO_SETTING_ORTHOGRAPHIC] = e->projection == VKAO_PROJECTION_ORTHOGRAPHIC;
    c[VKAO_SETTING_GRID_SHIFT] = e->half_resolution;
    c[VKAO_SETTING_BENT_NORMALS] = e->bent_normals;
    c[VKAO_SETTING_THRESHOLD] = e->falloff == VKAO_FALLOFF_THRESHOLD;
    c[VKAO_SETTING_THICKNESS_INPUT] = (uint32_t)e->thickness_input;
    c[VKAO_SETTING_SECOND_LAYER] = e->second_layer;
    c[VKAO_SETTING_SPHERE_LITERAL] = e->sphere_form == VKAO_SPHERE_LITERAL;
    c[VKAO_SETTING_SLICES] = has_slices && unrolls(program) ? e->slice_count : 0;
    c[VKAO_SETTING_STEPS] = has_slices && unrolls(program) ? e->step_count : 0;
    c[VKAO_SETTING_SAMPLES] =
        has_samples && e->sample_count <= VKAO_MOST_UNROLLED ? e->sample_count : 0;
    c[VKAO_SETTING_BLUR_RADIUS] = e->blur_radius;
    /* Without normals there is nothing to compare. */
    if (e->normal_encoding != VKAO_NORMALS_FROM_DEPTH)
        memcpy(&c[VKAO_SETTING_BLUR_NORMAL_POWER], &e->blur_normal_power, sizeof(float));
    c[VKAO_SETTING_COMPOSITE_MODE] = (uint32_t)e->composite_mode;
    c[VKAO_SETTING_MULTI_BOUNCE] = e->multi_bounce;
    c[VKAO_SETTING_SPECULAR] = (uint32_t)e->specular;
    c[VKAO_SETTING_NOISY_CODES] = program->has_codes;
    c[VKAO_SETTING_TILE_WORDS] = vkao_blur_tile_words(e);
    c[VKAO_SETTING_HALF_AO] = final_ao_is_half(e);
    c[VKAO_SETTING_HALF_NOISY] = noisy_ao_is_half(e);
    if (program->is_cpu)
        c[VKAO_SETTING_PATH] = vkao_cpu_setting(program);
}

/* What is touched of what the rows name. */
static void find_touched(struct vkao_program *program)
{
    const vkao_effect_info *e = &program->settings;
    const bool composite = e->stages & VKAO_STAGE_COMPOSITE, makes_ao = vkao_makes_ao(e);
    const bool lit = composite && e->composite_mode <= VKAO_COMPOSITE_INDIRECT;
    const bool reads_bent = (composite && e->composite_mode == VKAO_COMPOSITE_BENT_NORMALS) ||
                            (lit && e->specular == VKAO_SPECULAR_FROM_BENT);
    const struct {
        bool is;
        enum vkao_resource resource;
    } facts[] = {
        {makes_ao, VKAO_RESOURCE_DEPTH},
        {e->thickness_input != VKAO_THICKNESS_AS_SEEN, VKAO_RESOURCE_THICKNESS},
        {e->second_layer, VKAO_RESOURCE_SECOND_DEPTH},
        {e->second_layer, VKAO_RESOURCE_SECOND_Z},
        {e->normal_encoding != VKAO_NORMALS_FROM_DEPTH &&
             (makes_ao || (lit && e->specular != VKAO_SPECULAR_NONE)),
         VKAO_RESOURCE_NORMALS},
        {!program->is_packed && !program->has_codes, VKAO_RESOURCE_AO_NOISY},
        {true, VKAO_RESOURCE_AO},
        {lit, VKAO_RESOURCE_COLOR},
        {lit && e->composite_mode == VKAO_COMPOSITE_INDIRECT, VKAO_RESOURCE_DIRECT},
        {composite, VKAO_RESOURCE_OUTPUT},
        {e->bent_normals, VKAO_RESOURCE_BENT_CODES},
        {e->bent_normals || reads_bent, VKAO_RESOURCE_BENT_NORMALS},
        {composite && e->composite_mode <= VKAO_COMPOSITE_AO_ONLY && e->multi_bounce,
         VKAO_RESOURCE_ALBEDO},
        {lit && e->specular != VKAO_SPECULAR_NONE, VKAO_RESOURCE_SPECULAR},
    };
    uint32_t touched = ~0u;
    for (size_t i = 0; i < sizeof facts / sizeof facts[0]; ++i)
        touched &= facts[i].is ? ~0u : ~VKAO_BIT(facts[i].resource);
    program->written = e->bent_normals ? touched : touched & ~VKAO_BIT(VKAO_RESOURCE_BENT_NORMALS);
    program->read = reads_bent ? touched : touched & ~VKAO_BIT(VKAO_RESOURCE_BENT_NORMALS);
}

/* Nobody sees AO between SSAO and the blur, and 8 bits will do. Storing to them is optional in
 * Vulkan. */
static bool hands_over_codes(const struct vkao_program *program)
{
    const vkao_effect_info *e = &program->settings;
    const vkao_stage_flags both = VKAO_STAGE_SSAO | VKAO_STAGE_BLUR;
    return (e->stages & both) == both && !e->bent_normals && !e->noisy_ao &&
           vkao_scratch_can(program->ctx, VKAO_CODES_FORMAT);
}

void vkao_program_plan(struct vkao_program *program, const vkao_context *ctx,
                       const vkao_effect_info *settings, bool is_cpu)
{
    const vkao_stage_flags stages = vkao_stages_of(settings);
    *program = (struct vkao_program){.ctx = ctx, .settings = *settings, .is_cpu = is_cpu};
    program->has_codes = !is_cpu && hands_over_codes(program);
#define PLAN(NAME, name)                                                                           \
    if (stages & VKAO_STAGE_##NAME && !(is_cpu && vkao_cpu_plan(program, VKAO_STAGE_##NAME)))      \
        vkao_##name##_plan(program);
    VKAO_STAGES(PLAN)
#undef PLAN
    find_touched(program);
    set_constants(program);
}

vkao_result vkao_effect_create(const vkao_context *ctx, const vkao_effect_info *info,
                               vkao_effect **out)
{
    vkao_effect_info settings;
    if (out)
        *out = NULL;
    if (!ctx)
        return VKAO_ERROR_INVALID_ARGUMENT;
    vkao_result result = vkao_want(&ctx->log, "vkao_effect_create", "out", out);
    if (result == VKAO_SUCCESS)
        result = vkao_want(&ctx->log, "vkao_effect_create", "info", info);
    if (result == VKAO_SUCCESS)
        result = vkao_effect_info_check(&ctx->log, info, &settings);
    if (result != VKAO_SUCCESS)
        return result;
    vkao_effect_info_warn(&ctx->log, &settings);
    vkao_effect *effect = vkao_calloc(ctx->allocator, sizeof *effect);
    if (!effect)
        return vkao_refuse(&ctx->log, VKAO_ERROR_OUT_OF_HOST_MEMORY,
                           "no host memory for the effect");
    vkao_program_plan(&effect->program, ctx, &settings, ctx->is_cpu && vkao_cpu_has(&settings));
    effect->frames = &effect->frame_count;
    effect->passes = &effect->program;
    atomic_fetch_add(ctx->live, 1);
    result = vkao_program_compile(&effect->program);
    if (result != VKAO_SUCCESS) {
        vkao_effect_destroy(effect);
        return result;
    }
    /* The caller's, during this call only. */
    effect->program.settings.pipeline_cache = VK_NULL_HANDLE;
    effect->program.settings.parallel = NULL;
    effect->program.settings.parallel_user_data = NULL;
    *out = effect;
    return VKAO_SUCCESS;
}

void vkao_effect_settings(const vkao_effect *effect, vkao_effect_info *out, uint32_t size)
{
    static const vkao_effect_info none;
    vkao_export(effect ? &effect->program.settings : &none, sizeof none, out, size);
}

void vkao_effect_destroy(vkao_effect *effect)
{
    if (!effect)
        return;
    const vkao_context *ctx = effect->program.ctx;
    const unsigned live = atomic_load(effect->frames);
    if (live) {
        vkao_log(&ctx->log, VKAO_LOG_ERROR,
                 "vkao_effect_destroy: %u frames of the effect live; destroy them first", live);
        return;
    }
    vkao_program_destroy(&effect->program);
    vkao_free(ctx->allocator, effect);
    atomic_fetch_sub(ctx->live, 1);
}
