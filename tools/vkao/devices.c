/* SPDX-License-Identifier: MIT */
#include "commands.h"

#include "gpu.h"
#include "json_text.h"

#include <stdio.h>
#include <stdlib.h>

static void version_text(uint32_t version, char text[32])
{
    snprintf(text, 32, "%u.%u.%u", VK_API_VERSION_MAJOR(version), VK_API_VERSION_MINOR(version),
             VK_API_VERSION_PATCH(version));
}

static void print_text(const struct gpu_device_list *list)
{
    for (uint32_t i = 0; i < list->count; i++) {
        const VkPhysicalDeviceProperties *p = &list->properties[i];
        char api[32], name[4 * VK_MAX_PHYSICAL_DEVICE_NAME_SIZE];
        version_text(p->apiVersion, api);
        text_printable(name, sizeof name, p->deviceName);
        printf("%u  %s  (%s, Vulkan %s%s)\n", i, name, gpu_device_type_name(p->deviceType), api,
               p->apiVersion < VKAO_MIN_API_VERSION ? ", too old" : "");
    }
}

static bool print_json(const struct gpu_device_list *list)
{
    const unsigned begun = json_begin();
    cJSON *root = cJSON_CreateObject(), *devices = cJSON_AddArrayToObject(root, "devices");
    for (uint32_t i = 0; i < list->count; i++) {
        const VkPhysicalDeviceProperties *p = &list->properties[i];
        cJSON *device = cJSON_CreateObject();
        char api[32];
        version_text(p->apiVersion, api);
        cJSON_AddNumberToObject(device, "index", i);
        cJSON_AddStringToObject(device, "name", p->deviceName);
        cJSON_AddStringToObject(device, "type", gpu_device_type_name(p->deviceType));
        cJSON_AddStringToObject(device, "api_version", api);
        cJSON_AddBoolToObject(device, "usable", p->apiVersion >= VKAO_MIN_API_VERSION);
        cJSON_AddItemToArray(devices, device);
    }
    char *text = json_text(root, true, begun);
    cJSON_Delete(root);
    if (!text)
        return false;
    puts(text);
    free(text);
    return true;
}

int command_devices(const struct options *options)
{
    struct gpu_device_list list = {0};
    struct tool_error err = {0};
    bool ok = gpu_list_devices(&list, &err);
    if (ok && options->json && !print_json(&list))
        ok = fail(&err, EXIT_MEMORY, "out of memory");
    if (ok && !options->json)
        print_text(&list);
    if (!ok)
        report_error(&err);
    gpu_device_list_free(&list);
    return err.code;
}
