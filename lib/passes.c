/* SPDX-License-Identifier: MIT */
#include "passes.h"

#include <assert.h>
#include <stddef.h>

static_assert(offsetof(struct vkao_constants, far_z) == 168, "vectors lie as std140 has them");

bool vkao_makes_ao(const vkao_effect_info *effect)
{
    return effect->stages & (VKAO_STAGE_SSAO | VKAO_STAGE_BLUR);
}

bool vkao_has_thickness(const vkao_effect_info *effect)
{
    return effect->stages & VKAO_STAGE_SSAO &&
           (effect->method == VKAO_SSAO_VBAO || effect->thickness_input != VKAO_THICKNESS_AS_SEEN);
}

vkao_stage_flags vkao_stages_of(const vkao_effect_info *effect)
{
    return effect->stages | (vkao_makes_ao(effect) ? VKAO_STAGE_PREPARE : 0u);
}

void vkao_program_add(struct vkao_program *program, const struct vkao_pass *row)
{
    assert(program->count < VKAO_MOST_PASSES);
    struct vkao_step *step = &program->steps[program->count++];
    step->row = row;
    for (const struct vkao_use *use = row->uses; use->binding; ++use) {
        assert(step->use_count < VKAO_MOST_USES);
        struct vkao_use *own = &step->uses[step->use_count++];
        *own = *use;
        /* Without BLUR, SSAO writes the final image itself. */
        if (use->resource == VKAO_RESOURCE_AO_NOISY &&
            !(program->settings.stages & VKAO_STAGE_BLUR))
            own->resource = VKAO_RESOURCE_AO;
        else if (use->resource == VKAO_RESOURCE_AO_NOISY && program->has_codes)
            own->resource = VKAO_RESOURCE_CODES;
    }
}

bool vkao_use_is_touched(const struct vkao_program *program, const struct vkao_use *use)
{
    const uint32_t of = use->writes ? program->written : program->read;
    return of & VKAO_BIT(use->resource);
}

static bool touches(const struct vkao_program *program, const struct vkao_step *step,
                    enum vkao_resource resource, bool writes)
{
    for (uint32_t i = 0; i < step->use_count; ++i) {
        if (step->uses[i].resource == resource && step->uses[i].writes == writes)
            return vkao_use_is_touched(program, &step->uses[i]);
    }
    return false;
}

bool vkao_program_reads(const struct vkao_program *program, enum vkao_resource resource)
{
    for (uint32_t i = 0; i < program->count; ++i) {
        if (touches(program, &program->steps[i], resource, false))
            return true;
    }
    return false;
}

bool vkao_program_writes(const struct vkao_program *program, enum vkao_resource resource)
{
    for (uint32_t i = 0; i < program->count; ++i) {
        if (touches(program, &program->steps[i], resource, true))
            return true;
    }
    return false;
}

void vkao_program_lifetime(const struct vkao_program *program, enum vkao_resource resource,
                           uint32_t *first, uint32_t *last)
{
    *first = 1;
    *last = 0;
    bool found = false;
    for (uint32_t i = 0; i < program->count; ++i) {
        const struct vkao_step *step = &program->steps[i];
        if (!touches(program, step, resource, false) && !touches(program, step, resource, true))
            continue;
        for (*first = found ? *first : i; *first > 0 && program->steps[*first - 1].row->with_next;)
            --*first;
        for (*last = i; program->steps[*last].row->with_next;)
            ++*last;
        found = true;
    }
}

VkDescriptorType vkao_use_type(const struct vkao_use *use)
{
    if (use->resource == VKAO_RESOURCE_CONSTANTS)
        return VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
    if (use->resource == VKAO_RESOURCE_SAMPLER)
        return VK_DESCRIPTOR_TYPE_SAMPLER;
    if (use->resource >= VKAO_IMAGE_COUNT)
        return use->texels ? VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER
                           : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    return use->writes ? VK_DESCRIPTOR_TYPE_STORAGE_IMAGE : VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE;
}

static bool names_sampler(const struct vkao_program *program)
{
    for (uint32_t i = 0; i < program->count; ++i) {
        for (uint32_t k = 0; k < program->steps[i].use_count; ++k) {
            if (program->steps[i].uses[k].resource == VKAO_RESOURCE_SAMPLER)
                return true;
        }
    }
    return false;
}

static vkao_result create_sampler(struct vkao_program *program)
{
    const vkao_context *ctx = program->ctx;
    VkResult result =
        ctx->vk.CreateSampler(ctx->device,
                              &(VkSamplerCreateInfo){
                                  .sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                                  .addressModeU = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                  .addressModeV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                  .addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                  .unnormalizedCoordinates = VK_TRUE,
                              },
                              ctx->allocator, &program->nearest);
    if (result == VK_SUCCESS)
        return VKAO_SUCCESS;
    program->nearest = VK_NULL_HANDLE; /* drivers may leave anything behind a failure */
    return vkao_vk_failed(&ctx->log, "vkCreateSampler", result);
}

static vkao_result create_layouts(const struct vkao_program *program, struct vkao_step *step)
{
    const vkao_context *ctx = program->ctx;
    VkDescriptorSetLayoutBinding bindings[VKAO_MOST_USES + 1] = {{
        .binding = VKAO_BINDING_CONSTANTS,
        .descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER,
        .descriptorCount = 1,
        .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT,
    }};
    for (uint32_t i = 0; i < step->use_count; ++i) {
        const VkDescriptorType type = vkao_use_type(&step->uses[i]);
        bindings[i + 1] = (VkDescriptorSetLayoutBinding){
            .binding = step->uses[i].binding,
            .descriptorType = type,
            .descriptorCount = 1,
            .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT,
            .pImmutableSamplers = type == VK_DESCRIPTOR_TYPE_SAMPLER ? &program->nearest : NULL,
        };
    }
    VkResult result = ctx->vk.CreateDescriptorSetLayout(
        ctx->device,
        &(VkDescriptorSetLayoutCreateInfo){
            .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
            .bindingCount = step->use_count + 1,
            .pBindings = bindings,
        },
        ctx->allocator, &step->set_layout);
    if (result != VK_SUCCESS) {
        step->set_layout = VK_NULL_HANDLE; /* drivers may leave anything behind a failure */
        return vkao_vk_failed(&ctx->log, "vkCreateDescriptorSetLayout", result);
    }
    result = ctx->vk.CreatePipelineLayout(
        ctx->device,
        &(VkPipelineLayoutCreateInfo){
            .sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
            .setLayoutCount = 1,
            .pSetLayouts = &step->set_layout,
            .pushConstantRangeCount = 1,
            .pPushConstantRanges =
                &(VkPushConstantRange){VK_SHADER_STAGE_COMPUTE_BIT, 0, VKAO_PUSH_BYTES},
        },
        ctx->allocator, &step->layout);
    if (result != VK_SUCCESS) {
        step->layout = VK_NULL_HANDLE;
        return vkao_vk_failed(&ctx->log, "vkCreatePipelineLayout", result);
    }
    return VKAO_SUCCESS;
}

static vkao_result create_form(const struct vkao_program *program, struct vkao_step *step,
                               VkShaderModule module, uint32_t form)
{
    const vkao_context *ctx = program->ctx;
    uint32_t constants[VKAO_SETTING_COUNT];
    VkSpecializationMapEntry entries[VKAO_SETTING_COUNT];
    for (uint32_t i = 0; i < VKAO_SETTING_COUNT; ++i) {
        constants[i] = program->constants[i];
        entries[i] =
            (VkSpecializationMapEntry){i, i * (uint32_t)sizeof constants[0], sizeof constants[0]};
    }
    constants[VKAO_SETTING_VERTICAL] = step->row->vertical;
    constants[VKAO_SETTING_TONED] = form & VKAO_FORM_TONED ? 1 : 0;
    constants[VKAO_SETTING_COPIED] = form & VKAO_FORM_COPIED ? 1 : 0;
    /* Entries for constants that a shader does not have are ignored. */
    const VkSpecializationInfo specialization = {VKAO_SETTING_COUNT, entries, sizeof constants,
                                                 constants};
    VkPipeline pipeline;
    VkResult result = ctx->vk.CreateComputePipelines(
        ctx->device, program->settings.pipeline_cache, 1,
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
            .layout = step->layout,
        },
        ctx->allocator, &pipeline);
    if (result != VK_SUCCESS) /* drivers may leave anything behind a failure */
        return vkao_vk_failed(&ctx->log, "vkCreateComputePipelines", result);
    vkao_set_name(ctx, VK_OBJECT_TYPE_PIPELINE, (uint64_t)pipeline, step->row->name);
    /* Another thread may have been faster. */
    VkPipeline none = VK_NULL_HANDLE;
    if (!atomic_compare_exchange_strong(&step->forms[form], &none, pipeline))
        ctx->vk.DestroyPipeline(ctx->device, pipeline, ctx->allocator);
    return VKAO_SUCCESS;
}

/* Bits of those that are not there. Of the two kinds of frames, whose AO is copied or not, most
 * effects see one. A GPU's recordings must not wait for the driver, so that both tones are there
 * before; a driver in software takes a quarter of all its time for the tone that few ask for. */
static uint32_t missing_forms(const struct vkao_program *program, const struct vkao_step *step,
                              uint32_t form)
{
    const uint32_t mask = step->row->forms - 1;
    const uint32_t wanted =
        1u << (form & mask) | (program->is_cpu ? 0u : 1u << ((form | VKAO_FORM_TONED) & mask));
    uint32_t missing = 0;
    for (uint32_t i = 0; i < step->row->forms; ++i) {
        if (wanted & 1u << i && !atomic_load(&step->forms[i]))
            missing |= 1u << i;
    }
    return missing;
}

static vkao_result create_forms(const struct vkao_program *program, struct vkao_step *step,
                                uint32_t form)
{
    const vkao_context *ctx = program->ctx;
    VkShaderModule module = VK_NULL_HANDLE;
    const uint32_t missing = missing_forms(program, step, form);
    if (!missing)
        return VKAO_SUCCESS;
    VkResult created =
        ctx->vk.CreateShaderModule(ctx->device,
                                   &(VkShaderModuleCreateInfo){
                                       .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                       .codeSize = step->row->code_bytes,
                                       .pCode = step->row->code,
                                   },
                                   ctx->allocator, &module);
    if (created != VK_SUCCESS)
        return vkao_vk_failed(&ctx->log, "vkCreateShaderModule", created);
    vkao_result result = VKAO_SUCCESS;
    for (uint32_t i = 0; result == VKAO_SUCCESS && i < step->row->forms; ++i) {
        if (missing & 1u << i)
            result = create_form(program, step, module, i);
    }
    ctx->vk.DestroyShaderModule(ctx->device, module, ctx->allocator);
    return result;
}

vkao_result vkao_program_complete(struct vkao_program *program, uint32_t form)
{
    vkao_result result = VKAO_SUCCESS;
    for (uint32_t i = 0; result == VKAO_SUCCESS && i < program->count; ++i)
        result = create_forms(program, &program->steps[i], form);
    return result;
}

/* What a job of vkao_program_compile works on. */
struct compilation {
    struct vkao_program *program;
    vkao_result results[VKAO_MOST_PASSES];
};

static void compile_step(void *data, uint32_t i)
{
    struct compilation *c = data;
    struct vkao_step *step = &c->program->steps[i];
    c->results[i] = create_layouts(c->program, step);
    if (c->results[i] == VKAO_SUCCESS)
        c->results[i] = create_forms(c->program, step, VKAO_FORM_COPIED);
}

vkao_result vkao_program_compile(struct vkao_program *program)
{
    struct compilation compilation = {.program = program};
    const vkao_effect_info *info = &program->settings;
    vkao_result result = names_sampler(program) ? create_sampler(program) : VKAO_SUCCESS;
    if (result != VKAO_SUCCESS)
        return result;
    if (info->parallel) {
        info->parallel(info->parallel_user_data, program->count, compile_step, &compilation);
    } else {
        for (uint32_t i = 0; i < program->count; ++i) {
            compile_step(&compilation, i);
            if (compilation.results[i] != VKAO_SUCCESS)
                break;
        }
    }
    for (uint32_t i = 0; i < program->count; ++i) {
        if (compilation.results[i] != VKAO_SUCCESS)
            return compilation.results[i];
    }
    return VKAO_SUCCESS;
}

void vkao_program_destroy(struct vkao_program *program)
{
    const vkao_context *ctx = program->ctx;
    for (uint32_t i = 0; i < program->count; ++i) {
        const struct vkao_step *step = &program->steps[i];
        for (uint32_t form = 0; form < VKAO_MOST_FORMS; ++form) {
            VkPipeline pipeline = atomic_load(&step->forms[form]);
            if (pipeline)
                ctx->vk.DestroyPipeline(ctx->device, pipeline, ctx->allocator);
        }
        if (step->layout)
            ctx->vk.DestroyPipelineLayout(ctx->device, step->layout, ctx->allocator);
        if (step->set_layout)
            ctx->vk.DestroyDescriptorSetLayout(ctx->device, step->set_layout, ctx->allocator);
    }
    if (program->nearest)
        ctx->vk.DestroySampler(ctx->device, program->nearest, ctx->allocator);
}
