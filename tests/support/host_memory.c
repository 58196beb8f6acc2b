/* SPDX-License-Identifier: MIT */
#include "host_memory.h"

#include <stdlib.h>

static void *allocate(void *user_data, size_t size, size_t alignment, VkSystemAllocationScope scope)
{
    struct host_memory *host = user_data;
    (void)scope;
    if (alignment > sizeof(void *) * 2) /* what malloc promises */
        abort();
    if (++host->total == host->fail_at)
        return NULL;
    ++host->live;
    return malloc(size);
}

static void *reallocate(void *user_data, void *old, size_t size, size_t alignment,
                        VkSystemAllocationScope scope)
{
    (void)user_data;
    (void)alignment;
    (void)scope;
    return realloc(old, size);
}

static void release(void *user_data, void *memory)
{
    struct host_memory *host = user_data;
    if (memory)
        --host->live;
    free(memory);
}

VkAllocationCallbacks host_callbacks(struct host_memory *host)
{
    return (VkAllocationCallbacks){
        .pUserData = host,
        .pfnAllocation = allocate,
        .pfnReallocation = reallocate,
        .pfnFree = release,
    };
}

struct host_memory host_calloc;
static void *blocks[64]; /* what calloc gave and free has not taken */

void *__real_calloc(size_t count, size_t size);
void __real_free(void *memory);
void *__wrap_calloc(size_t count, size_t size);
void __wrap_free(void *memory);

void *__wrap_calloc(size_t count, size_t size)
{
    if (++host_calloc.total == host_calloc.fail_at)
        return NULL;
    void *memory = __real_calloc(count, size);
    for (size_t i = 0; memory && i < sizeof blocks / sizeof blocks[0]; ++i) {
        if (!blocks[i]) {
            blocks[i] = memory;
            ++host_calloc.live;
            return memory;
        }
    }
    return memory;
}

void __wrap_free(void *memory)
{
    for (size_t i = 0; memory && i < sizeof blocks / sizeof blocks[0]; ++i) {
        if (blocks[i] == memory) {
            blocks[i] = NULL;
            --host_calloc.live;
            break;
        }
    }
    __real_free(memory);
}
