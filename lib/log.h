/* SPDX-License-Identifier: MIT */
#ifndef VKAO_LOG_H_
#define VKAO_LOG_H_

#include "vkao.h"

struct vkao_logger {
    vkao_log_fn fn;
    void *user_data;
    vkao_log_level level;
};

#ifdef __GNUC__
#define VKAO_PRINTF(fmt, args) __attribute__((format(printf, fmt, args)))
#else
#define VKAO_PRINTF(fmt, args)
#endif

void vkao_log(const struct vkao_logger *log, vkao_log_level level, const char *format, ...)
    VKAO_PRINTF(3, 4);

/* Logs the reason and returns the result, so that refusals read as one statement. */
vkao_result vkao_refuse(const struct vkao_logger *log, vkao_result result, const char *format, ...)
    VKAO_PRINTF(3, 4);

/* Refuses an argument of the call that is NULL. Here, where analysers see it. */
static inline vkao_result vkao_want(const struct vkao_logger *log, const char *call,
                                    const char *argument, const void *value)
{
    if (value)
        return VKAO_SUCCESS;
    (void)vkao_refuse(log, VKAO_ERROR_INVALID_ARGUMENT, "%s: %s is NULL", call, argument);
    return VKAO_ERROR_INVALID_ARGUMENT;
}

/* Logs that a Vulkan call failed and maps its result. */
vkao_result vkao_vk_failed(const struct vkao_logger *log, const char *call, VkResult result);

#endif
