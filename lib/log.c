/* SPDX-License-Identifier: MIT */
#include "log.h"

#include "vk.h"

#include <stdarg.h>
#include <stdio.h>

VKAO_PRINTF(3, 0)
static void log_line(const struct vkao_logger *log, vkao_log_level level, const char *format,
                     va_list args)
{
    vkao_log_level limit = log->level == VKAO_LOG_DEFAULT ? VKAO_LOG_WARNING : log->level;
    if (!log->fn || level > limit)
        return;
    char line[512];
    vsnprintf(line, sizeof line, format, args);
    log->fn(log->user_data, level, line);
}

void vkao_log(const struct vkao_logger *log, vkao_log_level level, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    log_line(log, level, format, args);
    va_end(args);
}

vkao_result vkao_refuse(const struct vkao_logger *log, vkao_result result, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    log_line(log, VKAO_LOG_ERROR, format, args);
    va_end(args);
    return result;
}

vkao_result vkao_vk_failed(const struct vkao_logger *log, const char *call, VkResult result)
{
    return vkao_refuse(log, vkao_from_vk(result), "%s failed with VkResult %d", call, (int)result);
}

uint32_t vkao_version(void)
{
    return VK_MAKE_API_VERSION(0, VKAO_VERSION_MAJOR, VKAO_VERSION_MINOR, VKAO_VERSION_PATCH);
}

const char *vkao_result_string(vkao_result result)
{
    if (result <= VKAO_ERROR_VULKAN)
        return "Vulkan error";
    switch (result) {
    case VKAO_SUCCESS:
        return "success";
    case VKAO_ERROR_INVALID_ARGUMENT:
        return "invalid argument";
    case VKAO_ERROR_UNSUPPORTED:
        return "not supported by the device";
    case VKAO_ERROR_OUT_OF_HOST_MEMORY:
        return "out of host memory";
    case VKAO_ERROR_OUT_OF_DEVICE_MEMORY:
        return "out of device memory";
    default:
        return "unknown result";
    }
}

VkResult vkao_vk_result(vkao_result result)
{
    if (result <= VKAO_ERROR_VULKAN)
        return (VkResult)((int)result - VKAO_ERROR_VULKAN);
    if (result == VKAO_ERROR_OUT_OF_HOST_MEMORY)
        return VK_ERROR_OUT_OF_HOST_MEMORY;
    return result == VKAO_ERROR_OUT_OF_DEVICE_MEMORY ? VK_ERROR_OUT_OF_DEVICE_MEMORY : VK_SUCCESS;
}
