/* SPDX-License-Identifier: MIT */
#include "driver.h"

#include <stdio.h>
#include <string.h>
#include <vulkan/vulkan.h>

struct driver_name driver_name(const struct gpu *gpu)
{
    VkExtensionProperties extensions[512];
    uint32_t count = sizeof extensions / sizeof extensions[0];
    VkPhysicalDeviceDriverProperties driver = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES};
    struct driver_name name;
    snprintf(name.text, sizeof name.text, "0x%x", gpu->properties.driverVersion);
    vkEnumerateDeviceExtensionProperties(gpu->physical_device, NULL, &count, extensions);
    for (uint32_t i = 0; i < count; i++) {
        if (strcmp(extensions[i].extensionName, VK_KHR_DRIVER_PROPERTIES_EXTENSION_NAME) != 0)
            continue;
        vkGetPhysicalDeviceProperties2(
            gpu->physical_device,
            &(VkPhysicalDeviceProperties2){.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2,
                                           .pNext = &driver});
        snprintf(name.text, sizeof name.text, "%s %s", driver.driverName, driver.driverInfo);
    }
    return name;
}
