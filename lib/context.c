/* SPDX-License-Identifier: MIT */
#include "internal.h"

#include "blur.comp.h"
#include "blur_z16.comp.h"
#include "composite.comp.h"
#include "composite_z16.comp.h"
#include "debug.comp.h"
#include "debug_z16.comp.h"
#include "prepare.comp.h"
#include "prepare_z16.comp.h"
#include "ssao_gtao.comp.h"
#include "ssao_gtao_z16.comp.h"
#include "ssao_hbao.comp.h"
#include "ssao_hbao_z16.comp.h"
#include "ssao_hemisphere.comp.h"
#include "ssao_hemisphere_z16.comp.h"
#include "ssao_raymarch.comp.h"
#include "ssao_raymarch_z16.comp.h"
#include "ssao_sphere.comp.h"
#include "ssao_sphere_z16.comp.h"
#include "ssao_vbao.comp.h"
#include "ssao_vbao_z16.comp.h"
#include "upsample.comp.h"
#include "upsample_z16.comp.h"

#include <stdlib.h>
#include <string.h>

struct shader {
    const char *name;
    const uint32_t *code[2]; /* view z in 32-bit floats, in 16-bit ones */
    size_t bytes[2];
    VkBool32 vertical; /* VKAO_CONSTANT_BLUR_VERTICAL */
    bool bent;         /* has a variant with VKAO_CONSTANT_BENT_NORMALS */
};

#define SHADER(name)                                                                               \
#name, {name##_comp, name##_z16_comp },                                                        \
    {                                                                                              \
        sizeof name##_comp, sizeof name##_z16_comp                                                 \
    }
static const struct shader shaders[PIPELINE_COUNT] = {
    [PIPELINE_PREPARE] = {SHADER(prepare), VK_FALSE, false},
    [PIPELINE_BLUR_X] = {SHADER(blur), VK_FALSE, true},
    [PIPELINE_BLUR_Y] = {SHADER(blur), VK_TRUE, true},
    [PIPELINE_UPSAMPLE] = {SHADER(upsample), VK_FALSE, true},
    [PIPELINE_COMPOSITE] = {SHADER(composite), VK_FALSE, false},
    [PIPELINE_DEBUG] = {SHADER(debug), VK_FALSE, false},
    [PIPELINE_SSAO + VKAO_SSAO_SPHERE] = {SHADER(ssao_sphere), VK_FALSE, false},
    [PIPELINE_SSAO + VKAO_SSAO_HEMISPHERE] = {SHADER(ssao_hemisphere), VK_FALSE, false},
    [PIPELINE_SSAO + VKAO_SSAO_HBAO] = {SHADER(ssao_hbao), VK_FALSE, false},
    [PIPELINE_SSAO + VKAO_SSAO_GTAO] = {SHADER(ssao_gtao), VK_FALSE, true},
    [PIPELINE_SSAO + VKAO_SSAO_VBAO] = {SHADER(ssao_vbao), VK_FALSE, true},
    [PIPELINE_SSAO + VKAO_SSAO_RAYMARCH] = {SHADER(ssao_raymarch), VK_FALSE, true},
};

void *vkao_calloc(const VkAllocationCallbacks *allocator, size_t bytes)
{
    if (!allocator)
        return calloc(1, bytes);
    void *memory = allocator->pfnAllocation(allocator->pUserData, bytes, sizeof(void *) * 2,
                                            VK_SYSTEM_ALLOCATION_SCOPE_OBJECT);
    return memory ? memset(memory, 0, bytes) : NULL;
}

void vkao_free(const VkAllocationCallbacks *allocator, void *memory)
{
    if (!allocator)
        free(memory);
    else if (memory)
        allocator->pfnFree(allocator->pUserData, memory);
}

void vkao_add_required_features(VkPhysicalDeviceFeatures *features)
{
    features->shaderStorageImageWriteWithoutFormat = VK_TRUE;
}

void vkao_set_name(const vkao_context *ctx, VkObjectType type, uint64_t handle, const char *name)
{
    if (!ctx->vk.SetDebugUtilsObjectNameEXT)
        return;
    /* Names are a debugging aid: a failure to set one is not worth an error. */
    (void)ctx->vk.SetDebugUtilsObjectNameEXT(
        ctx->device, &(VkDebugUtilsObjectNameInfoEXT){
                         .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT,
                         .objectType = type,
                         .objectHandle = handle,
                         .pObjectName = name,
                     });
}

static vkao_result check_info(const struct vkao_logger *log, const vkao_context_info *info)
{
    const struct {
        const char *name;
        bool missing;
    } required[] = {
        {"instance", !info->instance},
        {"physical_device", !info->physical_device},
        {"device", !info->device},
        {"get_instance_proc_addr", !info->get_instance_proc_addr},
        {"get_device_proc_addr", !info->get_device_proc_addr},
        {"enabled_features", !info->enabled_features},
    };
    for (size_t i = 0; i < sizeof required / sizeof required[0]; ++i) {
        if (required[i].missing)
            return vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT, "context.%s is NULL",
                               required[i].name);
    }
    if (info->method_mask >> VKAO_METHOD_COUNT)
        return vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT,
                           "context.method_mask is 0x%x, want bits of 0x%x", info->method_mask,
                           (1u << VKAO_METHOD_COUNT) - 1u);
    if (info->half_view_z > 1 || info->reserved)
        return vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT,
                           "context.half_view_z is %u, reserved %u, want 0 or 1, 0",
                           info->half_view_z, info->reserved);
    if (info->half_view_z && !info->enabled_features->shaderStorageImageExtendedFormats)
        return vkao_refuse(log, VKAO_ERROR_UNSUPPORTED,
                           "context.half_view_z needs shaderStorageImageExtendedFormats in "
                           "context.enabled_features");
    if ((uint32_t)info->log_level > VKAO_LOG_INFO)
        return vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT, "context.log_level is %d, want 0..%d",
                           (int)info->log_level, (int)VKAO_LOG_INFO);
    const VkAllocationCallbacks *a = info->allocator;
    if (a && (!a->pfnAllocation || !a->pfnReallocation || !a->pfnFree))
        return vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT,
                           "context.allocator lacks pfnAllocation, pfnReallocation or pfnFree");
    if (!info->enabled_features->shaderStorageImageWriteWithoutFormat)
        return vkao_refuse(
            log, VKAO_ERROR_UNSUPPORTED,
            "context.enabled_features lacks shaderStorageImageWriteWithoutFormat; call "
            "vkao_add_required_features before vkCreateDevice");
    return VKAO_SUCCESS;
}

static vkao_result read_device(vkao_context *ctx)
{
    VkPhysicalDeviceProperties properties;
    ctx->vk.GetPhysicalDeviceProperties(ctx->physical_device, &properties);
    ctx->vk.GetPhysicalDeviceMemoryProperties(ctx->physical_device, &ctx->memory);
    if (properties.apiVersion < VKAO_MIN_API_VERSION)
        return vkao_refuse(&ctx->log, VKAO_ERROR_UNSUPPORTED,
                           "the device has Vulkan %u.%u, want 1.1 or later",
                           VK_API_VERSION_MAJOR(properties.apiVersion),
                           VK_API_VERSION_MINOR(properties.apiVersion));
    ctx->max_dimension = properties.limits.maxImageDimension2D;
    /* shaders/params.h packs texel coordinates to 16 bits */
    if (ctx->max_dimension > UINT16_MAX)
        ctx->max_dimension = UINT16_MAX;
    return VKAO_SUCCESS;
}

static vkao_result create_layouts(vkao_context *ctx)
{
    VkDescriptorSetLayoutBinding bindings[VKAO_BINDING_COUNT];
    for (uint32_t i = 0; i < VKAO_BINDING_COUNT; ++i) {
        bool storage = i == VKAO_BINDING_VIEW_Z || i == VKAO_BINDING_NOISY_WRITE ||
                       i == VKAO_BINDING_HALFWAY_WRITE || i == VKAO_BINDING_AO_WRITE ||
                       i == VKAO_BINDING_OUTPUT || i == VKAO_BINDING_BENT_WRITE;
        bindings[i] = (VkDescriptorSetLayoutBinding){
            .binding = i,
            .descriptorType =
                storage ? VK_DESCRIPTOR_TYPE_STORAGE_IMAGE : VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE,
            .descriptorCount = 1,
            .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT,
        };
    }
    VkResult result = ctx->vk.CreateDescriptorSetLayout(
        ctx->device,
        &(VkDescriptorSetLayoutCreateInfo){
            .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
            .bindingCount = VKAO_BINDING_COUNT,
            .pBindings = bindings,
        },
        ctx->allocator, &ctx->set_layout);
    if (result != VK_SUCCESS) {
        ctx->set_layout = VK_NULL_HANDLE; /* drivers may leave anything behind a failure */
        return vkao_vk_failed(&ctx->log, "vkCreateDescriptorSetLayout", result);
    }
    result = ctx->vk.CreatePipelineLayout(
        ctx->device,
        &(VkPipelineLayoutCreateInfo){
            .sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
            .setLayoutCount = 1,
            .pSetLayouts = &ctx->set_layout,
            .pushConstantRangeCount = 1,
            .pPushConstantRanges =
                &(VkPushConstantRange){VK_SHADER_STAGE_COMPUTE_BIT, 0, VKAO_PUSH_BYTES},
        },
        ctx->allocator, &ctx->pipeline_layout);
    if (result != VK_SUCCESS) {
        ctx->pipeline_layout = VK_NULL_HANDLE;
        return vkao_vk_failed(&ctx->log, "vkCreatePipelineLayout", result);
    }
    return VKAO_SUCCESS;
}

static vkao_result create_pipeline(vkao_context *ctx, VkPipelineCache cache, enum pipeline which,
                                   VkBool32 bent)
{
    const struct shader *shader = &shaders[which];
    VkShaderModule module = VK_NULL_HANDLE;
    VkResult result =
        ctx->vk.CreateShaderModule(ctx->device,
                                   &(VkShaderModuleCreateInfo){
                                       .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                       .codeSize = shader->bytes[ctx->half_view_z],
                                       .pCode = shader->code[ctx->half_view_z],
                                   },
                                   ctx->allocator, &module);
    if (result != VK_SUCCESS)
        return vkao_vk_failed(&ctx->log, "vkCreateShaderModule", result);
    /* Entries for constants that a shader does not have are ignored. */
    const VkSpecializationMapEntry entries[] = {
        {VKAO_CONSTANT_BLUR_VERTICAL, 0, sizeof(VkBool32)},
        {VKAO_CONSTANT_BENT_NORMALS, sizeof(VkBool32), sizeof(VkBool32)},
    };
    const VkBool32 constants[] = {shader->vertical, bent};
    const VkSpecializationInfo specialization = {2, entries, sizeof constants, constants};
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
        ctx->allocator, &ctx->pipelines[which][bent]);
    ctx->vk.DestroyShaderModule(ctx->device, module, ctx->allocator);
    if (result != VK_SUCCESS) {
        ctx->pipelines[which][bent] = VK_NULL_HANDLE;
        return vkao_vk_failed(&ctx->log, "vkCreateComputePipelines", result);
    }
    vkao_set_name(ctx, VK_OBJECT_TYPE_PIPELINE, (uint64_t)ctx->pipelines[which][bent],
                  shader->name);
    return VKAO_SUCCESS;
}

static vkao_result create_pipelines(vkao_context *ctx, VkPipelineCache cache, enum pipeline which)
{
    vkao_result result = create_pipeline(ctx, cache, which, VK_FALSE);
    if (result == VKAO_SUCCESS && shaders[which].bent)
        result = create_pipeline(ctx, cache, which, VK_TRUE);
    return result;
}

vkao_result vkao_context_create(const vkao_context_info *caller_info, vkao_context **out)
{
    struct vkao_logger silent = {0}, log;
    vkao_context_info info;
    if (caller_info && caller_info->struct_size >= sizeof info)
        silent = (struct vkao_logger){caller_info->log, caller_info->log_user_data,
                                      caller_info->log_level};
    if (!out)
        return vkao_refuse(&silent, VKAO_ERROR_INVALID_ARGUMENT,
                           "vkao_context_create: out is NULL");
    *out = NULL;
    vkao_result result = vkao_import(&silent, "context", caller_info, &info, sizeof info);
    if (result != VKAO_SUCCESS)
        return result;
    log = (struct vkao_logger){info.log, info.log_user_data, info.log_level};
    result = check_info(&log, &info);
    if (result != VKAO_SUCCESS)
        return result;

    vkao_context *ctx = vkao_calloc(info.allocator, sizeof *ctx);
    if (!ctx)
        return vkao_refuse(&log, VKAO_ERROR_OUT_OF_HOST_MEMORY, "no host memory for the context");
    ctx->log = log;
    ctx->device = info.device;
    ctx->physical_device = info.physical_device;
    ctx->half_view_z = info.half_view_z;
    ctx->method_mask = info.method_mask ? info.method_mask : (1u << VKAO_METHOD_COUNT) - 1u;
    if (info.allocator) {
        ctx->allocator_copy = *info.allocator;
        ctx->allocator = &ctx->allocator_copy;
    }
    const char *missing;
    if (!vk_table_load(&ctx->vk, &info, &missing)) {
        result =
            vkao_refuse(&log, VKAO_ERROR_UNSUPPORTED, "context: the device has no %s", missing);
        /* Nothing was created yet, and the functions that would destroy it may be the missing ones. */
        vkao_free(info.allocator, ctx);
        return result;
    }
    result = read_device(ctx);
    if (result == VKAO_SUCCESS)
        result = create_layouts(ctx);
    for (uint32_t i = 0; result == VKAO_SUCCESS && i < PIPELINE_COUNT; ++i) {
        if (i < PIPELINE_SSAO || (ctx->method_mask >> (i - PIPELINE_SSAO) & 1u))
            result = create_pipelines(ctx, info.pipeline_cache, (enum pipeline)i);
    }
    if (result != VKAO_SUCCESS) {
        vkao_context_destroy(ctx);
        return result;
    }
    *out = ctx;
    return VKAO_SUCCESS;
}

void vkao_context_destroy(vkao_context *ctx)
{
    if (!ctx)
        return;
    for (uint32_t i = 0; i < PIPELINE_COUNT; ++i) {
        for (int bent = 0; bent < 2; ++bent) {
            if (ctx->pipelines[i][bent])
                ctx->vk.DestroyPipeline(ctx->device, ctx->pipelines[i][bent], ctx->allocator);
        }
    }
    if (ctx->pipeline_layout)
        ctx->vk.DestroyPipelineLayout(ctx->device, ctx->pipeline_layout, ctx->allocator);
    if (ctx->set_layout)
        ctx->vk.DestroyDescriptorSetLayout(ctx->device, ctx->set_layout, ctx->allocator);
    /* The callbacks live inside the block that they free. */
    VkAllocationCallbacks allocator = ctx->allocator_copy;
    vkao_free(ctx->allocator ? &allocator : NULL, ctx);
}
