/* SPDX-License-Identifier: MIT */
#include "internal.h"

#include <stdlib.h>
#include <string.h>

/* A limit for sanity; each takes milliseconds to compile. */
#define MAX_VARIANTS 64u

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
    if (info->stage_mask & ~VKAO_STAGE_ALL)
        return vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT,
                           "context.stage_mask is 0x%x, want bits of 0x%x", info->stage_mask,
                           VKAO_STAGE_ALL);
    if (info->half_view_z > 1 || info->variants_only > 1 || info->storage_16bit > 1)
        return vkao_refuse(
            log, VKAO_ERROR_INVALID_ARGUMENT,
            "context.half_view_z is %u, variants_only %u, storage_16bit %u, want 0 or 1",
            info->half_view_z, info->variants_only, info->storage_16bit);
    if ((uint32_t)info->scratch_layout > VKAO_SCRATCH_BUFFERS ||
        (info->scratch_layout == VKAO_SCRATCH_BUFFERS && info->half_view_z))
        return vkao_refuse(
            log, VKAO_ERROR_INVALID_ARGUMENT,
            "context.scratch_layout is %d, want 0..%d, and not BUFFERS with half_view_z",
            (int)info->scratch_layout, (int)VKAO_SCRATCH_BUFFERS);
    if (info->variant_count > MAX_VARIANTS || (info->variant_count && !info->variants))
        return vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT,
                           "context.variant_count is %u, want at most %u and context.variants",
                           info->variant_count, MAX_VARIANTS);
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

/* Noisy AO as texels to write; view z as texels is mandatory. */
static bool has_buffer_formats(const vkao_context *ctx)
{
    VkFormatProperties one, two;
    ctx->vk.GetPhysicalDeviceFormatProperties(ctx->physical_device, VK_FORMAT_R8_UINT, &one);
    ctx->vk.GetPhysicalDeviceFormatProperties(ctx->physical_device, VK_FORMAT_R16_UINT, &two);
    return one.bufferFeatures & two.bufferFeatures & VK_FORMAT_FEATURE_STORAGE_TEXEL_BUFFER_BIT;
}

static vkao_result read_device(vkao_context *ctx, vkao_scratch_layout layout)
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
    ctx->max_texels = properties.limits.maxTexelBufferElements;
    ctx->max_buffer = properties.limits.maxStorageBufferRange;
    const bool wanted =
        layout == VKAO_SCRATCH_BUFFERS || (layout == VKAO_SCRATCH_AUTO && !ctx->half_view_z &&
                                           properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU);
    ctx->buffers = wanted && has_buffer_formats(ctx);
    if (layout == VKAO_SCRATCH_BUFFERS && !ctx->buffers)
        return vkao_refuse(
            &ctx->log, VKAO_ERROR_UNSUPPORTED,
            "context.scratch_layout is BUFFERS, but the device cannot store R8_UINT and "
            "R16_UINT texels in buffers");
    return VKAO_SUCCESS;
}

VkDescriptorType binding_type(uint32_t binding)
{
    switch (binding) {
    case VKAO_BINDING_VIEW_Z:
    case VKAO_BINDING_NOISY_WRITE:
    case VKAO_BINDING_HALFWAY_WRITE:
    case VKAO_BINDING_AO_WRITE:
    case VKAO_BINDING_OUTPUT:
    case VKAO_BINDING_BENT_WRITE:
        return VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
    case VKAO_BINDING_Z_WORDS:
    case VKAO_BINDING_HALFWAY_WORDS:
    case VKAO_BINDING_BLURRED_WORDS:
    case VKAO_BINDING_STAGED_WORDS:
    case VKAO_BINDING_PACKED_WORDS:
    case VKAO_BINDING_TILES:
        return VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    default:
        return scratch_view(binding) ? VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER
                                     : VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE;
    }
}

static vkao_result create_layouts(vkao_context *ctx)
{
    VkDescriptorSetLayoutBinding bindings[VKAO_BINDING_COUNT];
    for (uint32_t i = 0; i < VKAO_BINDING_COUNT; ++i)
        bindings[i] = (VkDescriptorSetLayoutBinding){
            .binding = i,
            .descriptorType = binding_type(i),
            .descriptorCount = 1,
            .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT,
        };
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
    ctx->storage_16bit = info.storage_16bit;
    ctx->method_mask = info.method_mask ? info.method_mask : (1u << VKAO_METHOD_COUNT) - 1u;
    ctx->stage_mask = info.stage_mask ? info.stage_mask : VKAO_STAGE_ALL;
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
    result = read_device(ctx, info.scratch_layout);
    if (result == VKAO_SUCCESS)
        result = create_layouts(ctx);
    if (result == VKAO_SUCCESS)
        result = pipelines_create(ctx, &info);
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
    pipelines_destroy(ctx);
    if (ctx->pipeline_layout)
        ctx->vk.DestroyPipelineLayout(ctx->device, ctx->pipeline_layout, ctx->allocator);
    if (ctx->set_layout)
        ctx->vk.DestroyDescriptorSetLayout(ctx->device, ctx->set_layout, ctx->allocator);
    /* The callbacks live inside the block that they free. */
    VkAllocationCallbacks allocator = ctx->allocator_copy;
    vkao_free(ctx->allocator ? &allocator : NULL, ctx);
}
