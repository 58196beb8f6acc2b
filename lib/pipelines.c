/* SPDX-License-Identifier: MIT */
#include "pipelines.h"

#include <string.h>

/* --- What a row is compiled from --- */

/* Bits of the constants that a shader declares, and of those that it uses: their ids are operands
 * of something. A number that looks like an id makes one more of these, which does no harm. */
static void find_constants(const struct vkao_pass *row, uint32_t *declared, uint32_t *used)
{
    enum { HEADER = 5, NAME = 5, SPEC_TRUE = 48, SPEC_FALSE, SPEC_CONSTANT, DECORATE = 71 };
    enum { SPEC_ID = 1 };
    const size_t count = row->code_bytes / sizeof row->code[0];
    uint32_t ids[VKAO_SETTING_COUNT] = {0};
    *declared = *used = 0;
    for (size_t i = HEADER; i < count; i += row->code[i] >> 16) {
        const uint32_t *word = &row->code[i], opcode = word[0] & 0xffffu;
        if (opcode == DECORATE && word[2] == SPEC_ID) {
            *declared |= 1u << word[3];
            ids[word[3]] = word[1];
        }
        if (opcode == NAME || opcode == DECORATE || opcode == SPEC_TRUE || opcode == SPEC_FALSE ||
            opcode == SPEC_CONSTANT)
            continue;
        for (uint32_t k = 1; k < word[0] >> 16; ++k) {
            for (uint32_t id = 0; id < VKAO_SETTING_COUNT; ++id)
                *used |= (*declared >> id & (uint32_t)(word[k] == ids[id])) << id;
        }
    }
}

static void describe(const struct vkao_program *program, const struct vkao_step *step,
                     struct vkao_pipelines *p)
{
    p->row = step->row;
    p->is_cpu = program->is_cpu;
    find_constants(step->row, &p->declared, &p->used);
    memcpy(p->constants, program->constants, sizeof p->constants);
    p->constants[VKAO_SETTING_VERTICAL] = step->row->vertical;
}

static bool is_alike(const struct vkao_pipelines *a, const struct vkao_pipelines *b)
{
    bool alike = a->row == b->row && a->is_cpu == b->is_cpu;
    for (uint32_t i = 0; alike && i < VKAO_SETTING_COUNT; ++i)
        alike = !(a->used >> i & 1u) || a->constants[i] == b->constants[i];
    return alike;
}

/* --- Layouts --- */

static vkao_result create_sampler(const vkao_context *ctx, struct vkao_pipelines *p)
{
    VkResult result =
        ctx->vk.CreateSampler(ctx->device,
                              &(VkSamplerCreateInfo){
                                  .sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                                  .addressModeU = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                  .addressModeV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                  .addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                  .unnormalizedCoordinates = VK_TRUE,
                              },
                              ctx->allocator, &p->nearest);
    if (result == VK_SUCCESS)
        return VKAO_SUCCESS;
    p->nearest = VK_NULL_HANDLE; /* drivers may leave anything behind a failure */
    return vkao_vk_failed(&ctx->log, "vkCreateSampler", result);
}

static vkao_result create_layouts(const vkao_context *ctx, struct vkao_pipelines *p)
{
    VkDescriptorSetLayoutBinding bindings[VKAO_MOST_USES + 1] = {{
        .binding = VKAO_BINDING_CONSTANTS,
        .descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER,
        .descriptorCount = 1,
        .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT,
    }};
    uint32_t count = 1;
    for (const struct vkao_use *use = p->row->uses; use->binding; ++use) {
        const VkDescriptorType type = vkao_use_type(use);
        const bool is_sampler = type == VK_DESCRIPTOR_TYPE_SAMPLER;
        vkao_result result = is_sampler ? create_sampler(ctx, p) : VKAO_SUCCESS;
        if (result != VKAO_SUCCESS)
            return result;
        bindings[count++] = (VkDescriptorSetLayoutBinding){
            .binding = use->binding,
            .descriptorType = type,
            .descriptorCount = 1,
            .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT,
            .pImmutableSamplers = is_sampler ? &p->nearest : NULL,
        };
    }
    VkResult result = ctx->vk.CreateDescriptorSetLayout(
        ctx->device,
        &(VkDescriptorSetLayoutCreateInfo){
            .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
            .bindingCount = count,
            .pBindings = bindings,
        },
        ctx->allocator, &p->set_layout);
    if (result != VK_SUCCESS) {
        p->set_layout = VK_NULL_HANDLE;
        return vkao_vk_failed(&ctx->log, "vkCreateDescriptorSetLayout", result);
    }
    result = ctx->vk.CreatePipelineLayout(
        ctx->device,
        &(VkPipelineLayoutCreateInfo){
            .sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
            .setLayoutCount = 1,
            .pSetLayouts = &p->set_layout,
            .pushConstantRangeCount = 1,
            .pPushConstantRanges =
                &(VkPushConstantRange){VK_SHADER_STAGE_COMPUTE_BIT, 0, VKAO_PUSH_BYTES},
        },
        ctx->allocator, &p->layout);
    if (result != VK_SUCCESS) {
        p->layout = VK_NULL_HANDLE;
        return vkao_vk_failed(&ctx->log, "vkCreatePipelineLayout", result);
    }
    return VKAO_SUCCESS;
}

/* --- Pipelines --- */

static vkao_result create_form(const vkao_context *ctx, struct vkao_pipelines *p,
                               VkShaderModule module, uint32_t form, VkPipelineCache cache)
{
    uint32_t constants[VKAO_SETTING_COUNT], count = 0;
    VkSpecializationMapEntry entries[VKAO_SETTING_COUNT];
    for (uint32_t i = 0; i < VKAO_SETTING_COUNT; ++i) {
        constants[i] = p->constants[i];
        if (p->declared >> i & 1u)
            entries[count++] = (VkSpecializationMapEntry){i, i * (uint32_t)sizeof constants[0],
                                                          sizeof constants[0]};
    }
    constants[VKAO_SETTING_TONED] = form & VKAO_FORM_TONED ? 1 : 0;
    constants[VKAO_SETTING_COPIED] = form & VKAO_FORM_COPIED ? 1 : 0;
    const VkSpecializationInfo specialization = {count, entries, sizeof constants, constants};
    VkPipeline pipeline;
    VkResult result = ctx->vk.CreateComputePipelines(
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
            .layout = p->layout,
        },
        ctx->allocator, &pipeline);
    if (result != VK_SUCCESS) /* drivers may leave anything behind a failure */
        return vkao_vk_failed(&ctx->log, "vkCreateComputePipelines", result);
    vkao_set_name(ctx, VK_OBJECT_TYPE_PIPELINE, (uint64_t)pipeline, p->row->name);
    /* Another thread may have been faster. */
    VkPipeline none = VK_NULL_HANDLE;
    if (!atomic_compare_exchange_strong(&p->forms[form], &none, pipeline))
        ctx->vk.DestroyPipeline(ctx->device, pipeline, ctx->allocator);
    return VKAO_SUCCESS;
}

/* Bits of those that are not there. Of the two kinds of frames, whose AO is copied or not, most
 * effects see one. A GPU's recordings must not wait for the driver, so that both tones are there
 * before; a driver in software takes a quarter of all its time for the tone that few ask for. */
static uint32_t missing_forms(const struct vkao_pipelines *p, uint32_t form)
{
    const uint32_t mask = p->row->forms - 1;
    const uint32_t wanted =
        1u << (form & mask) | (p->is_cpu ? 0u : 1u << ((form | VKAO_FORM_TONED) & mask));
    uint32_t missing = 0;
    for (uint32_t i = 0; i < p->row->forms; ++i) {
        if (wanted & 1u << i && !atomic_load(&p->forms[i]))
            missing |= 1u << i;
    }
    return missing;
}

/* As vkao_program_complete, of one row. */
static vkao_result create_forms(const vkao_context *ctx, struct vkao_pipelines *p, uint32_t form,
                                VkPipelineCache cache)
{
    VkShaderModule module = VK_NULL_HANDLE;
    const uint32_t missing = missing_forms(p, form);
    if (!missing)
        return VKAO_SUCCESS;
    VkResult created =
        ctx->vk.CreateShaderModule(ctx->device,
                                   &(VkShaderModuleCreateInfo){
                                       .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                       .codeSize = p->row->code_bytes,
                                       .pCode = p->row->code,
                                   },
                                   ctx->allocator, &module);
    if (created != VK_SUCCESS)
        return vkao_vk_failed(&ctx->log, "vkCreateShaderModule", created);
    vkao_result result = VKAO_SUCCESS;
    for (uint32_t i = 0; result == VKAO_SUCCESS && i < p->row->forms; ++i) {
        if (missing & 1u << i)
            result = create_form(ctx, p, module, i, cache);
    }
    ctx->vk.DestroyShaderModule(ctx->device, module, ctx->allocator);
    return result;
}

/* --- Sharing --- */

/* Held for as long as it takes to go through the list, of some dozen. */
static void lock(struct vkao_shared_pipelines *shared)
{
    while (atomic_flag_test_and_set(&shared->is_busy))
        ;
}

static void unlock(struct vkao_shared_pipelines *shared)
{
    atomic_flag_clear(&shared->is_busy);
}

/* Those that are alike, with one more user, or NULL; or own, if that is to join where there are
 * none. */
static struct vkao_pipelines *share(struct vkao_shared_pipelines *shared,
                                    struct vkao_pipelines *own, bool joins)
{
    lock(shared);
    struct vkao_pipelines *p = shared->first;
    while (p && !is_alike(p, own))
        p = p->next;
    if (p) {
        ++p->users;
    } else if (joins) {
        own->next = shared->first;
        shared->first = p = own;
    }
    unlock(shared);
    return p;
}

static void destroy(const vkao_context *ctx, struct vkao_pipelines *p)
{
    for (uint32_t form = 0; form < VKAO_MOST_FORMS; ++form) {
        VkPipeline pipeline = atomic_load(&p->forms[form]);
        if (pipeline)
            ctx->vk.DestroyPipeline(ctx->device, pipeline, ctx->allocator);
    }
    if (p->layout)
        ctx->vk.DestroyPipelineLayout(ctx->device, p->layout, ctx->allocator);
    if (p->set_layout)
        ctx->vk.DestroyDescriptorSetLayout(ctx->device, p->set_layout, ctx->allocator);
    if (p->nearest)
        ctx->vk.DestroySampler(ctx->device, p->nearest, ctx->allocator);
    vkao_free(ctx->allocator, p);
}

/* Those of the step, with layouts; of pipelines what there is. *out is NULL on failure. */
static vkao_result take(const struct vkao_program *program, const struct vkao_step *step,
                        struct vkao_pipelines **out)
{
    const vkao_context *ctx = program->ctx;
    struct vkao_pipelines *own = vkao_calloc(ctx->allocator, sizeof *own);
    *out = NULL;
    if (!own)
        return vkao_refuse(&ctx->log, VKAO_ERROR_OUT_OF_HOST_MEMORY,
                           "no host memory for the effect");
    describe(program, step, own);
    own->users = 1;
    *out = share(ctx->shared, own, false);
    vkao_result result = *out ? VKAO_SUCCESS : create_layouts(ctx, own);
    /* Another thread may have been faster. */
    if (!*out && result == VKAO_SUCCESS)
        *out = share(ctx->shared, own, true);
    if (*out != own)
        destroy(ctx, own);
    return result;
}

/* The last user destroys them. p: may be NULL. */
static void give_back(const vkao_context *ctx, struct vkao_pipelines *p)
{
    if (!p)
        return;
    lock(ctx->shared);
    const bool is_last = --p->users == 0;
    struct vkao_pipelines **link = &ctx->shared->first;
    while (is_last && *link != p)
        link = &(*link)->next;
    if (is_last)
        *link = p->next;
    unlock(ctx->shared);
    if (is_last)
        destroy(ctx, p);
}

/* --- All of an effect --- */

vkao_result vkao_program_complete(struct vkao_program *program, uint32_t form)
{
    vkao_result result = VKAO_SUCCESS;
    for (uint32_t i = 0; result == VKAO_SUCCESS && i < program->count; ++i)
        result = create_forms(program->ctx, program->steps[i].pipelines, form, VK_NULL_HANDLE);
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
    const struct vkao_program *program = c->program;
    struct vkao_step *step = &c->program->steps[i];
    c->results[i] = take(program, step, &step->pipelines);
    if (step->pipelines)
        c->results[i] = create_forms(program->ctx, step->pipelines, VKAO_FORM_COPIED,
                                     program->settings.pipeline_cache);
}

vkao_result vkao_program_compile(struct vkao_program *program)
{
    struct compilation compilation = {.program = program};
    const vkao_effect_info *info = &program->settings;
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
    for (uint32_t i = 0; i < program->count; ++i)
        give_back(program->ctx, program->steps[i].pipelines);
}
