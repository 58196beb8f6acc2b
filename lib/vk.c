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

bool vkao_format_is_ao(VkFormat format)
{
    return format == VK_FORMAT_R8_UNORM || format == VK_FORMAT_R16_UNORM ||
           format == VK_FORMAT_R16_SFLOAT || format == VK_FORMAT_R32_SFLOAT;
}

struct depth_format {
    VkFormat format;
    float step;
    bool floating;
};

static const struct depth_format depth_formats[] = {
    {VK_FORMAT_D16_UNORM, 0x1p-16f, false},
    {VK_FORMAT_D16_UNORM_S8_UINT, 0x1p-16f, false},
    {VK_FORMAT_X8_D24_UNORM_PACK32, 0x1p-24f, false},
    {VK_FORMAT_D24_UNORM_S8_UINT, 0x1p-24f, false},
    {VK_FORMAT_D32_SFLOAT, 0x1p-24f, true},
    {VK_FORMAT_D32_SFLOAT_S8_UINT, 0x1p-24f, true},
    {VK_FORMAT_R16_UNORM, 0x1p-16f, false},
    {VK_FORMAT_R16_SFLOAT, 0x1p-11f, true},
    {VK_FORMAT_R32_SFLOAT, 0x1p-24f, true},
};

float vkao_format_depth_step(VkFormat format, bool *floating)
{
    for (size_t i = 0; i < sizeof depth_formats / sizeof depth_formats[0]; ++i) {
        if (depth_formats[i].format == format) {
            *floating = depth_formats[i].floating;
            return depth_formats[i].step;
        }
    }
    *floating = false;
    return 0.0f;
}

bool vkao_format_is_depth(VkFormat format)
{
    bool floating;
    return vkao_format_depth_step(format, &floating) > 0.0f;
}

bool vkao_format_is_sampled_float(VkFormat format)
{
    static const VkFormat integers[] = {
        VK_FORMAT_R8_UINT,
        VK_FORMAT_R8_SINT,
        VK_FORMAT_R8G8_UINT,
        VK_FORMAT_R8G8_SINT,
        VK_FORMAT_R8G8B8_UINT,
        VK_FORMAT_R8G8B8_SINT,
        VK_FORMAT_B8G8R8_UINT,
        VK_FORMAT_B8G8R8_SINT,
        VK_FORMAT_R8G8B8A8_UINT,
        VK_FORMAT_R8G8B8A8_SINT,
        VK_FORMAT_B8G8R8A8_UINT,
        VK_FORMAT_B8G8R8A8_SINT,
        VK_FORMAT_A8B8G8R8_UINT_PACK32,
        VK_FORMAT_A8B8G8R8_SINT_PACK32,
        VK_FORMAT_A2R10G10B10_UINT_PACK32,
        VK_FORMAT_A2R10G10B10_SINT_PACK32,
        VK_FORMAT_A2B10G10R10_UINT_PACK32,
        VK_FORMAT_A2B10G10R10_SINT_PACK32,
        VK_FORMAT_R16_UINT,
        VK_FORMAT_R16_SINT,
        VK_FORMAT_R16G16_UINT,
        VK_FORMAT_R16G16_SINT,
        VK_FORMAT_R16G16B16_UINT,
        VK_FORMAT_R16G16B16_SINT,
        VK_FORMAT_R16G16B16A16_UINT,
        VK_FORMAT_R16G16B16A16_SINT,
        VK_FORMAT_R32_UINT,
        VK_FORMAT_R32_SINT,
        VK_FORMAT_R32G32_UINT,
        VK_FORMAT_R32G32_SINT,
        VK_FORMAT_R32G32B32_UINT,
        VK_FORMAT_R32G32B32_SINT,
        VK_FORMAT_R32G32B32A32_UINT,
        VK_FORMAT_R32G32B32A32_SINT,
        VK_FORMAT_S8_UINT,
    };
    /* 64-bit components and everything that later versions and extensions added but packed 16-bit formats */
    if (format <= VK_FORMAT_UNDEFINED ||
        (format >= VK_FORMAT_R64_UINT && format <= VK_FORMAT_R64G64B64A64_SFLOAT) ||
        format > VK_FORMAT_ASTC_12x12_SRGB_BLOCK)
        return false;
    for (size_t i = 0; i < sizeof integers / sizeof integers[0]; ++i) {
        if (integers[i] == format)
            return false;
    }
    return true;
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
