/* SPDX-License-Identifier: MIT */
#ifndef _GNU_SOURCE
#define _GNU_SOURCE /* RTLD_NODELETE */
#endif
#include "fixture.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct fixture fixture;

/* LeakSanitizer cannot name, nor suppress, leaks of a library that is gone at exit: what the loader
 * unloads with the instance is kept mapped. A library that is not there needs no keeping. */
static void keep_loaded(void)
{
    static const char *const libraries[] = {"libvulkan_lvp.so", "libVkLayer_khronos_validation.so"};
    for (size_t i = 0; i < sizeof libraries / sizeof libraries[0]; ++i) {
        void *library = dlopen(libraries[i], RTLD_LAZY | RTLD_NODELETE);
        if (library)
            dlclose(library);
    }
}

/* The layers of 1.3.239 never let go of what queue-submit validation knows of a submit: objects
 * that hold each other. A Vulkan object that a test forgets is not hidden by this: the layers
 * report it when the device is destroyed. */
const char *__lsan_default_suppressions(void);
const char *__lsan_default_suppressions(void)
{
    return "leak:libVkLayer_khronos_validation.so\n";
}

bool fixture_open(void)
{
    const struct gpu_options options = {.device = getenv("VKAO_TEST_DEVICE"), .validation = true};
    keep_loaded();
    if (!gpu_create(&options, &fixture.gpu, &fixture.error)) {
        fprintf(stderr, "skipped: %s\n", fixture.error.message);
        return false;
    }
    fixture.context = gpu_context(&fixture.gpu, &fixture.error);
    if (!fixture.context) {
        fprintf(stderr, "%s\n", fixture.error.message);
        exit(EXIT_FAILURE);
    }
    return true;
}

/* A ring: [next] is the oldest. */
static struct {
    vkao_effect_info info;
    vkao_effect *effect;
} kept[32];
static size_t next;

vkao_effect *fixture_effect(const vkao_effect_info *info)
{
    const size_t count = sizeof kept / sizeof kept[0];
    for (size_t i = 0; i < count; ++i) {
        if (kept[i].effect && memcmp(&kept[i].info, info, sizeof *info) == 0)
            return kept[i].effect;
    }
    vkao_effect_destroy(kept[next].effect);
    kept[next].effect = NULL;
    check_vkao(vkao_effect_create(fixture.context, info, &kept[next].effect));
    kept[next].info = *info;
    vkao_effect *effect = kept[next].effect;
    next = (next + 1) % count;
    return effect;
}

void fixture_forget_effects(void)
{
    for (size_t i = 0; i < sizeof kept / sizeof kept[0]; ++i)
        vkao_effect_destroy(kept[i].effect);
    memset(kept, 0, sizeof kept);
}

vkao_context_info fixture_context_info(void)
{
    vkao_context_info info = gpu_context_info(&fixture.gpu);
    info.log = NULL;
    return info;
}

int fixture_close(void **state)
{
    (void)state;
    fixture_forget_effects();
    vkao_context_destroy(fixture.context);
    gpu_destroy(&fixture.gpu);
    /* Objects that outlive their device are reported as it goes. */
    if (fixture.gpu.validation_messages)
        print_error("%u validation messages at device destruction\n",
                    fixture.gpu.validation_messages);
    return fixture.gpu.validation_messages ? -1 : 0;
}

int fixture_after_test(void **state)
{
    (void)state;
    uint32_t messages = fixture.gpu.validation_messages;
    fixture.gpu.validation_messages = 0;
    if (messages)
        print_error("%u validation messages\n", messages);
    return messages ? -1 : 0;
}

void check(bool ok)
{
    if (!ok)
        fail_msg("%s", fixture.error.message);
}

void *test_alloc(size_t count, size_t size)
{
    void *memory = calloc(count, size);
    assert_non_null(memory);
    return memory;
}

VkDeviceMemory fixture_allocate(const VkMemoryRequirements *requirements, VkDeviceSize size)
{
    const VkPhysicalDeviceMemoryProperties *memory = &fixture.gpu.memory;
    for (uint32_t i = 0; i < memory->memoryTypeCount; ++i) {
        VkDeviceMemory out;
        if (!(requirements->memoryTypeBits >> i & 1u) ||
            !(memory->memoryTypes[i].propertyFlags & VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT))
            continue;
        assert_int_equal(vkAllocateMemory(fixture.gpu.device,
                                          &(VkMemoryAllocateInfo){
                                              .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                              .allocationSize = size,
                                              .memoryTypeIndex = i,
                                          },
                                          NULL, &out),
                         VK_SUCCESS);
        return out;
    }
    fail_msg("no device-local memory type among 0x%x", requirements->memoryTypeBits);
    return VK_NULL_HANDLE;
}
