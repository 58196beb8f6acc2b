/* SPDX-License-Identifier: MIT */
#include "host_memory.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>

/* Of all counts: effects may be created in several threads. */
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

/* Counts an allocation; false if it is the one that fails. */
static bool takes(struct host_memory *host)
{
    pthread_mutex_lock(&lock);
    const bool ok = ++host->total != host->fail_at;
    host->live += ok ? 1 : 0;
    pthread_mutex_unlock(&lock);
    return ok;
}

static void *allocate(void *user_data, size_t size, size_t alignment, VkSystemAllocationScope scope)
{
    struct host_memory *host = user_data;
    (void)scope;
    if (alignment > sizeof(void *) * 2) /* what malloc promises */
        abort();
    return takes(host) ? malloc(size) : NULL;
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
    pthread_mutex_lock(&lock);
    if (memory)
        --host->live;
    pthread_mutex_unlock(&lock);
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
enum { BLOCKS = 64 };
static void *blocks[BLOCKS]; /* what calloc gave and free has not taken */

void *__real_calloc(size_t count, size_t size);
void __real_free(void *memory);
void *__wrap_calloc(size_t count, size_t size);
void __wrap_free(void *memory);

void *__wrap_calloc(size_t count, size_t size)
{
    if (!takes(&host_calloc))
        return NULL;
    void *memory = __real_calloc(count, size);
    size_t i = 0;
    pthread_mutex_lock(&lock);
    while (i < BLOCKS && blocks[i])
        ++i;
    if (memory && i < BLOCKS)
        blocks[i] = memory;
    else
        --host_calloc.live; /* of these nothing is known */
    pthread_mutex_unlock(&lock);
    return memory;
}

void __wrap_free(void *memory)
{
    pthread_mutex_lock(&lock);
    for (size_t i = 0; memory && i < BLOCKS; ++i) {
        if (blocks[i] == memory) {
            blocks[i] = NULL;
            --host_calloc.live;
            break;
        }
    }
    pthread_mutex_unlock(&lock);
    __real_free(memory);
}
