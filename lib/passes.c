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
