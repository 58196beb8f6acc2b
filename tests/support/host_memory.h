/* SPDX-License-Identifier: MIT
 *
 * Host memory under watch: allocation callbacks that count and fail on demand, and calloc as the
 * library calls it without callbacks (the tests are linked with --wrap=calloc,--wrap=free). */
#ifndef HOST_MEMORY_H_
#define HOST_MEMORY_H_

#include <stddef.h>
#include <vulkan/vulkan_core.h>

struct host_memory {
    unsigned total;   /* allocations ever tried */
    unsigned fail_at; /* 1 = the first fails; 0 = none */
    size_t live;
};

VkAllocationCallbacks host_callbacks(struct host_memory *host);

/* calloc of this whole program; a program has one. */
extern struct host_memory host_calloc;

#endif
