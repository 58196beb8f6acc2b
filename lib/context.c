/* SPDX-License-Identifier: MIT */
#include "context.h"

#include "parameters.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

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
    if (features)
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

bool vkao_scratch_can(const vkao_context *ctx, VkFormat format)
{
    VkFormatProperties properties;
    const VkFormatFeatureFlags want =
        VK_FORMAT_FEATURE_STORAGE_IMAGE_BIT | VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT;
    ctx->vk.GetPhysicalDeviceFormatProperties(ctx->physical_device, format, &properties);
    return (properties.optimalTilingFeatures & want) == want;
}

bool vkao_format_can(const vkao_context *ctx, VkFormat format, VkFormatFeatureFlags want)
{
    VkFormatProperties properties;
    ctx->vk.GetPhysicalDeviceFormatProperties(ctx->physical_device, format, &properties);
    /* The caller's tiling is unknown: either will do. */
    return (properties.optimalTilingFeatures & want) == want ||
           (properties.linearTilingFeatures & want) == want;
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
    if ((uint32_t)info->log_level > VKAO_LOG_INFO)
        return vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT, "context.log_level is %d, want 0..%d",
                           (int)info->log_level, (int)VKAO_LOG_INFO);
    if (info->debug_labels > 1 || info->padding)
        return vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT,
                           "context.debug_labels is %u, padding %u, want 0 or 1, 0",
                           info->debug_labels, info->padding);
    const VkAllocationCallbacks *a = info->allocator;
    if (a && (!a->pfnAllocation || !a->pfnReallocation || !a->pfnFree))
        return vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT,
                           "context.allocator lacks pfnAllocation, pfnReallocation or pfnFree");
    if (info->enabled_features->sType != VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2)
        return vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT,
                           "context.enabled_features has sType %d, want "
                           "VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2",
                           (int)info->enabled_features->sType);
    if (!info->enabled_features->features.shaderStorageImageWriteWithoutFormat)
        return vkao_refuse(
            log, VKAO_ERROR_UNSUPPORTED,
            "context.enabled_features lacks shaderStorageImageWriteWithoutFormat; call "
            "vkao_add_required_features before vkCreateDevice");
    return VKAO_SUCCESS;
}

/* Is storageBuffer16BitAccess in the chain? */
static bool has_16bit_storage(const VkPhysicalDeviceFeatures2 *features)
{
    for (const VkBaseInStructure *s = features->pNext; s; s = s->pNext) {
        if (s->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_16BIT_STORAGE_FEATURES)
            return ((const VkPhysicalDevice16BitStorageFeatures *)(const void *)s)
                ->storageBuffer16BitAccess;
        if (s->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES)
            return ((const VkPhysicalDeviceVulkan11Features *)(const void *)s)
                ->storageBuffer16BitAccess;
    }
    return false;
}

/* Codes of AO as texels to write; view z as texels is mandatory. */
static bool has_buffer_formats(const vkao_context *ctx)
{
    VkFormatProperties one, two;
    ctx->vk.GetPhysicalDeviceFormatProperties(ctx->physical_device, VK_FORMAT_R8_UINT, &one);
    ctx->vk.GetPhysicalDeviceFormatProperties(ctx->physical_device, VK_FORMAT_R16_UINT, &two);
    return one.bufferFeatures & two.bufferFeatures & VK_FORMAT_FEATURE_STORAGE_TEXEL_BUFFER_BIT;
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
    ctx->max_image = ctx->max_dimension = properties.limits.maxImageDimension2D;
    /* shaders/params.h packs texel coordinates to 16 bits */
    if (ctx->max_dimension > UINT16_MAX)
        ctx->max_dimension = UINT16_MAX;
    ctx->max_texels = properties.limits.maxTexelBufferElements;
    ctx->max_buffer = properties.limits.maxStorageBufferRange;
    ctx->granularity = properties.limits.bufferImageGranularity;
    ctx->is_cpu = properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU && has_buffer_formats(ctx);
    return VKAO_SUCCESS;
}

vkao_result vkao_context_create(const vkao_context_info *caller_info, vkao_context **out)
{
    struct vkao_logger log = {0};
    vkao_context_info info;
    /* A size of 0 was forgotten; of a struct that is too short for a log nothing can be said. */
    if (caller_info && (!caller_info->struct_size ||
                        caller_info->struct_size >= offsetof(vkao_context_info, mark)))
        log = (struct vkao_logger){caller_info->log, caller_info->log_user_data,
                                   caller_info->log_level};
    vkao_result result = vkao_want(&log, "vkao_context_create", "out", out);
    if (result != VKAO_SUCCESS)
        return result;
    *out = NULL;
    result = vkao_import(&log, VKAO_STRUCT_CONTEXT_INFO, "context", caller_info, &info);
    if (result == VKAO_SUCCESS)
        result = check_info(&log, &info);
    if (result != VKAO_SUCCESS)
        return result;

    vkao_context *ctx = vkao_calloc(info.allocator, sizeof *ctx);
    if (!ctx)
        return vkao_refuse(&log, VKAO_ERROR_OUT_OF_HOST_MEMORY, "no host memory for the context");
    ctx->log = log;
    ctx->mark = info.mark;
    ctx->mark_user_data = info.mark_user_data;
    ctx->device = info.device;
    ctx->physical_device = info.physical_device;
    ctx->has_16bit_storage = has_16bit_storage(info.enabled_features);
    ctx->live = &ctx->live_count;
    ctx->shared = &ctx->shared_pipelines;
    atomic_flag_clear(&ctx->shared->is_busy);
    if (info.allocator) {
        ctx->allocator_copy = *info.allocator;
        ctx->allocator = &ctx->allocator_copy;
    }
    const char *missing;
    if (vkao_vk_table_load(&ctx->vk, &info, &missing))
        result = read_device(ctx);
    else
        result = vkao_refuse(&log, VKAO_ERROR_UNSUPPORTED,
                             "context.device has no %s: make it of an instance whose "
                             "VkApplicationInfo.apiVersion is VK_API_VERSION_1_1 or later",
                             missing);
    if (result != VKAO_SUCCESS) {
        vkao_free(info.allocator, ctx);
        return result;
    }
    *out = ctx;
    return VKAO_SUCCESS;
}

void vkao_context_destroy(vkao_context *ctx)
{
    if (!ctx)
        return;
    const unsigned live = atomic_load(ctx->live);
    if (live) {
        vkao_log(&ctx->log, VKAO_LOG_ERROR,
                 "vkao_context_destroy: %u effects and frames of the context live; destroy them "
                 "first",
                 live);
        return;
    }
    /* The callbacks live inside the block that they free. */
    VkAllocationCallbacks allocator = ctx->allocator_copy;
    vkao_free(ctx->allocator ? &allocator : NULL, ctx);
}
