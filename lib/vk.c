/* SPDX-License-Identifier: MIT */
#include "vk.h"

bool vkao_vk_table_load(struct vk_table *vk, const vkao_context_info *info, const char **missing)
{
    *missing = NULL;
#define VKAO_LOAD_INSTANCE(name)                                                                   \
    vk->name = (PFN_vk##name)info->get_instance_proc_addr(info->instance, "vk" #name);             \
    if (!vk->name)                                                                                 \
        *missing = "vk" #name;
#define VKAO_LOAD_DEVICE(name)                                                                     \
    vk->name = (PFN_vk##name)info->get_device_proc_addr(info->device, "vk" #name);                 \
    if (!vk->name)                                                                                 \
        *missing = "vk" #name;
    /* An instance extension: the loader hands its device functions out at instance level. */
#define VKAO_LOAD_DEBUG(name)                                                                      \
    vk->name = info->debug_labels                                                                  \
                   ? (PFN_vk##name)info->get_instance_proc_addr(info->instance, "vk" #name)        \
                   : NULL;
    VKAO_INSTANCE_FUNCTIONS(VKAO_LOAD_INSTANCE)
    VKAO_DEVICE_FUNCTIONS(VKAO_LOAD_DEVICE)
    VKAO_DEBUG_FUNCTIONS(VKAO_LOAD_DEBUG)
    /* Never called. Whatever the device is, those of an instance for Vulkan 1.0 lack it, and with
     * it what shaders here are compiled for. */
    if (!info->get_device_proc_addr(info->device, "vkTrimCommandPool"))
        *missing = "vkTrimCommandPool";
#undef VKAO_LOAD_INSTANCE
#undef VKAO_LOAD_DEVICE
#undef VKAO_LOAD_DEBUG
    return !*missing;
}

vkao_result vkao_from_vk(VkResult result)
{
    switch (result) {
    case VK_SUCCESS:
        return VKAO_SUCCESS;
    case VK_ERROR_OUT_OF_HOST_MEMORY:
        return VKAO_ERROR_OUT_OF_HOST_MEMORY;
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
    case VK_ERROR_OUT_OF_POOL_MEMORY:
    case VK_ERROR_FRAGMENTED_POOL:
        return VKAO_ERROR_OUT_OF_DEVICE_MEMORY;
    default:
        /* What is no error should not have come. */
        return (vkao_result)(VKAO_ERROR_VULKAN + (int)(result < 0 ? result : VK_ERROR_UNKNOWN));
    }
}

uint32_t vkao_memory_type(const VkPhysicalDeviceMemoryProperties *memory, uint32_t type_bits)
{
    for (uint32_t i = 0; i < memory->memoryTypeCount; ++i) {
        if ((type_bits >> i & 1u) &&
            (memory->memoryTypes[i].propertyFlags & VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT))
            return i;
    }
    return UINT32_MAX;
}
