/* SPDX-License-Identifier: MIT */
#include "fake_internal.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct fake_vulkan *fake_of(const void *dispatchable)
{
    return *(struct fake_vulkan *const *)dispatchable;
}

void fake_misuse(struct fake_vulkan *fake, const char *format, ...)
{
    if (fake->error[0])
        return;
    va_list args;
    va_start(args, format);
    vsnprintf(fake->error, sizeof fake->error, format, args);
    va_end(args);
}

struct fake_call *fake_note(struct fake_vulkan *fake, const char *name)
{
    if (fake->call_count == FAKE_CALLS) {
        fake_misuse(fake, "more than %d calls", FAKE_CALLS);
        --fake->call_count;
    }
    struct fake_call *call = &fake->calls[fake->call_count++];
    *call = (struct fake_call){.name = name};
    return call;
}

struct fake_object *fake_add(struct fake_vulkan *fake, VkObjectType type)
{
    if (fake->object_count == FAKE_OBJECTS) {
        fake_misuse(fake, "more than %d objects", FAKE_OBJECTS);
        --fake->object_count;
    }
    struct fake_object *object = &fake->objects[fake->object_count++];
    *object = (struct fake_object){
        .type = type,
        .handle = (uint64_t)type << 32 | (uint64_t)fake->object_count,
        .alive = true,
    };
    return object;
}

uint64_t fake_number(const void *handle)
{
    return (uint64_t)(uintptr_t)handle;
}

static struct fake_object *find(struct fake_vulkan *fake, uint64_t handle)
{
    for (size_t i = 0; i < fake->object_count; ++i) {
        if (fake->objects[i].handle == handle)
            return &fake->objects[i];
    }
    return NULL;
}

struct fake_object *fake_use(struct fake_vulkan *fake, const char *call, VkObjectType type,
                             uint64_t handle)
{
    struct fake_object *object = find(fake, handle);
    if (!object || object->type != type)
        fake_misuse(fake, "%s: 0x%" PRIx64 " is no handle of type %d", call, handle, (int)type);
    else if (!object->alive)
        fake_misuse(fake, "%s: 0x%" PRIx64 " was destroyed before", call, handle);
    else
        return object;
    return NULL;
}

void fake_init(struct fake_vulkan *fake)
{
    *fake = (struct fake_vulkan){
        .api_version = VK_API_VERSION_1_1,
        .max_dimension = 4096,
        .memory =
            {
                .memoryTypeCount = 3,
                .memoryTypes =
                    {
                        {VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT, 0},
                        {VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, 1},
                        {VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT | VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT,
                         1},
                    },
                .memoryHeapCount = 2,
            },
        .buffer_features = VK_FORMAT_FEATURE_STORAGE_TEXEL_BUFFER_BIT,
        .max_texels = UINT32_C(1) << 27,
        .max_buffer = UINT32_C(1) << 27,
        .image_alignment = 256,
        .image_type_bits = 0x7,
        .fail_result = VK_ERROR_DEVICE_LOST,
    };
    fake->instance = fake->physical_device = fake->device = fake->command_buffer = fake;
    pthread_mutex_init(&fake->lock, NULL);
    fake->calls = malloc(FAKE_CALLS * sizeof *fake->calls);
    fake->objects = malloc(FAKE_OBJECTS * sizeof *fake->objects);
    if (!fake->calls || !fake->objects)
        abort();
}

void fake_release(struct fake_vulkan *fake)
{
    free(fake->calls);
    free(fake->objects);
    pthread_mutex_destroy(&fake->lock);
    fake->calls = NULL;
    fake->objects = NULL;
}

VkInstance fake_instance(struct fake_vulkan *fake)
{
    return (VkInstance)(void *)&fake->instance;
}

VkPhysicalDevice fake_physical_device(struct fake_vulkan *fake)
{
    return (VkPhysicalDevice)(void *)&fake->physical_device;
}

VkDevice fake_device(struct fake_vulkan *fake)
{
    return (VkDevice)(void *)&fake->device;
}

VkCommandBuffer fake_command_buffer(struct fake_vulkan *fake)
{
    return (VkCommandBuffer)(void *)&fake->command_buffer;
}

void fake_limit_format(struct fake_vulkan *fake, VkFormat format, VkFormatFeatureFlags optimal,
                       VkFormatFeatureFlags linear)
{
    fake->formats[fake->format_count].format = format;
    fake->formats[fake->format_count].optimal = optimal;
    fake->formats[fake->format_count++].linear = linear;
}

VkImageView fake_caller_view(struct fake_vulkan *fake)
{
    struct fake_object *object = fake_add(fake, VK_OBJECT_TYPE_IMAGE_VIEW);
    object->of_caller = true;
    return (VkImageView)(uintptr_t)object->handle;
}

VkImage fake_caller_image(struct fake_vulkan *fake, const VkImageCreateInfo *info)
{
    struct fake_object *object = fake_add(fake, VK_OBJECT_TYPE_IMAGE);
    object->of_caller = true;
    object->image = *info;
    return (VkImage)(uintptr_t)object->handle;
}

VkDeviceMemory fake_caller_memory(struct fake_vulkan *fake)
{
    struct fake_object *object = fake_add(fake, VK_OBJECT_TYPE_DEVICE_MEMORY);
    object->of_caller = true;
    return (VkDeviceMemory)(uintptr_t)object->handle;
}

size_t fake_live_of(const struct fake_vulkan *fake, VkObjectType type)
{
    size_t live = 0;
    for (size_t i = 0; i < fake->object_count; ++i) {
        const struct fake_object *object = &fake->objects[i];
        live += object->alive && !object->of_caller &&
                (type == VK_OBJECT_TYPE_UNKNOWN || object->type == type);
    }
    return live;
}

size_t fake_live(const struct fake_vulkan *fake)
{
    return fake_live_of(fake, VK_OBJECT_TYPE_UNKNOWN);
}

const struct fake_object *fake_find(const struct fake_vulkan *fake, uint64_t handle)
{
    for (size_t i = 0; i < fake->object_count; ++i) {
        if (fake->objects[i].handle == handle)
            return &fake->objects[i];
    }
    return NULL;
}

void fake_forget_calls(struct fake_vulkan *fake)
{
    fake->call_count = 0;
}

size_t fake_count(const struct fake_vulkan *fake, const char *prefix)
{
    size_t count = 0;
    for (size_t i = 0; i < fake->call_count; ++i)
        count += strncmp(fake->calls[i].name, prefix, strlen(prefix)) == 0;
    return count;
}

const struct fake_call *fake_nth(const struct fake_vulkan *fake, const char *name, size_t index)
{
    for (size_t i = 0; i < fake->call_count; ++i) {
        if (strcmp(fake->calls[i].name, name) == 0 && index-- == 0)
            return &fake->calls[i];
    }
    return NULL;
}
