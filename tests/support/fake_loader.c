/* SPDX-License-Identifier: MIT
 *
 * What the fake answers when it is asked for its functions, and those of its instance. */
#include "fake_internal.h"

#include <string.h>

static VKAPI_ATTR void VKAPI_CALL fake_GetPhysicalDeviceProperties(VkPhysicalDevice device,
                                                                   VkPhysicalDeviceProperties *out)
{
    const struct fake_vulkan *fake = fake_of(device);
    fake_note(fake_of(device), "vkGetPhysicalDeviceProperties");
    *out = (VkPhysicalDeviceProperties){
        .apiVersion = fake->api_version,
        .deviceName = "fake",
        .deviceType = fake->device_type,
        .limits = {.maxImageDimension2D = fake->max_dimension,
                   .maxPushConstantsSize = 128,
                   .maxTexelBufferElements = fake->max_texels,
                   .maxStorageBufferRange = fake->max_buffer},
    };
}

static VKAPI_ATTR void VKAPI_CALL fake_GetPhysicalDeviceMemoryProperties(
    VkPhysicalDevice device, VkPhysicalDeviceMemoryProperties *out)
{
    fake_note(fake_of(device), "vkGetPhysicalDeviceMemoryProperties");
    *out = fake_of(device)->memory;
}

static VKAPI_ATTR void VKAPI_CALL fake_GetPhysicalDeviceFormatProperties(VkPhysicalDevice device,
                                                                         VkFormat format,
                                                                         VkFormatProperties *out)
{
    struct fake_vulkan *fake = fake_of(device);
    const VkFormatFeatureFlags all =
        VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT | VK_FORMAT_FEATURE_STORAGE_IMAGE_BIT;
    pthread_mutex_lock(&fake->lock);
    fake_note(fake, "vkGetPhysicalDeviceFormatProperties");
    pthread_mutex_unlock(&fake->lock);
    *out = (VkFormatProperties){.optimalTilingFeatures = all,
                                .linearTilingFeatures = all,
                                .bufferFeatures = fake->buffer_features};
    if (format == fake->no_texel_buffer)
        out->bufferFeatures = 0;
    for (size_t i = 0; i < fake->format_count; ++i) {
        if (fake->formats[i].format == format) {
            out->optimalTilingFeatures = fake->formats[i].optimal;
            out->linearTilingFeatures = fake->formats[i].linear;
        }
    }
}

#define ENTRY(name)                                                                                \
    {                                                                                              \
        "vk" #name, (PFN_vkVoidFunction)fake_##name                                                \
    }
static const struct fake_entry instance_functions[] = {
    ENTRY(GetPhysicalDeviceProperties),
    ENTRY(GetPhysicalDeviceMemoryProperties),
    ENTRY(GetPhysicalDeviceFormatProperties),
};
#define COUNT(array) (sizeof(array) / sizeof(array)[0])

static PFN_vkVoidFunction look_up(struct fake_vulkan *fake, const struct fake_entry *entries,
                                  size_t count, const char *name)
{
    if (fake->missing && strcmp(fake->missing, name) == 0)
        return NULL;
    for (size_t i = 0; i < count; ++i) {
        if (strcmp(entries[i].name, name) == 0)
            return entries[i].function;
    }
    return NULL;
}

static void remember(struct fake_vulkan *fake, const struct fake_entry *entries, size_t count,
                     const char *name)
{
    for (size_t i = 0; i < fake->asked_count; ++i) {
        if (strcmp(fake->asked[i], name) == 0)
            return;
    }
    for (size_t i = 0; i < count; ++i) {
        if (strcmp(entries[i].name, name) == 0 && fake->asked_count < FAKE_NAMES)
            fake->asked[fake->asked_count++] = entries[i].name;
    }
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL fake_get_instance_proc_addr(VkInstance instance,
                                                                     const char *name)
{
    struct fake_vulkan *fake = fake_of(instance);
    remember(fake, instance_functions, COUNT(instance_functions), name);
    PFN_vkVoidFunction found = look_up(fake, instance_functions, COUNT(instance_functions), name);
    if (!found && fake->debug_utils)
        found = look_up(fake, fake_debug_functions, FAKE_DEBUG_FUNCTIONS, name);
    return found;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL fake_get_device_proc_addr(VkDevice device,
                                                                   const char *name)
{
    struct fake_vulkan *fake = fake_of(device);
    remember(fake, fake_device_functions, FAKE_DEVICE_FUNCTIONS, name);
    remember(fake, fake_commands, FAKE_COMMANDS, name);
    PFN_vkVoidFunction found = look_up(fake, fake_device_functions, FAKE_DEVICE_FUNCTIONS, name);
    return found ? found : look_up(fake, fake_commands, FAKE_COMMANDS, name);
}
