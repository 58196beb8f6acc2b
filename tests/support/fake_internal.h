/* SPDX-License-Identifier: MIT
 *
 * What the parts of the fake share: its state (fake_vulkan.c), its device functions (fake_device.c)
 * and its commands (fake_commands.c), which fake_loader.c hands out. */
#ifndef FAKE_INTERNAL_H_
#define FAKE_INTERNAL_H_

#include "fake_vulkan.h"

enum { FAKE_DEBUG_FUNCTIONS = 3, FAKE_DEVICE_FUNCTIONS = 29, FAKE_COMMANDS = 8 };

struct fake_entry {
    const char *name;
    PFN_vkVoidFunction function;
};

extern const struct fake_entry fake_debug_functions[FAKE_DEBUG_FUNCTIONS];
extern const struct fake_entry fake_device_functions[FAKE_DEVICE_FUNCTIONS];
extern const struct fake_entry fake_commands[FAKE_COMMANDS];

/* The fake that a dispatchable handle belongs to. */
struct fake_vulkan *fake_of(const void *dispatchable);
struct fake_call *fake_note(struct fake_vulkan *fake, const char *name);
struct fake_object *fake_add(struct fake_vulkan *fake, VkObjectType type);
uint64_t fake_number(const void *handle);
/* The object of a handle, NULL and a misuse if it is of another type or gone. */
struct fake_object *fake_use(struct fake_vulkan *fake, const char *call, VkObjectType type,
                             uint64_t handle);
/* Keeps the first misuse of the API. */
#ifdef __GNUC__
__attribute__((format(printf, 2, 3)))
#endif
void fake_misuse(struct fake_vulkan *fake, const char *format, ...);

#endif
