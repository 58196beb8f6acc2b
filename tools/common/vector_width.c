/* SPDX-License-Identifier: MIT */
#include "vector_width.h"

#include <stdbool.h>
#include <stdlib.h>
#include <vulkan/vulkan.h>

/* Mesa never runs at that width by itself, so it is done where all that vkao has was tried: with
 * Mesa 22.3 and LLVM 15 of Debian 12. Drivers say what they are only when it is too late; this is
 * the loader that goes with them. */
static bool is_tried(void)
{
    uint32_t loader = 0;
    return vkEnumerateInstanceVersion(&loader) == VK_SUCCESS &&
           loader == VK_MAKE_API_VERSION(0, 1, 3, 239);
}

#ifdef __x86_64__
#include <cpuid.h>

/* AMD's processors from Zen 5 on, whose units are that wide: vkao takes .65 to .85 of the time
 * there. Processors that take halves in turn, or clock lower meanwhile, gain nothing. */
static bool is_wide_processor(void)
{
    enum { ZEN_5_FAMILY = 0x1a };
    unsigned eax, ebx, ecx, edx;
    if (!__builtin_cpu_is("amd") || !__get_cpuid(1, &eax, &ebx, &ecx, &edx))
        return false;
    const unsigned family = (eax >> 8 & 0xf) + (eax >> 20 & 0xff);
    /* These ask the operating system, too. */
    return family >= ZEN_5_FAMILY && __builtin_cpu_supports("avx512f") &&
           __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512vl");
}
#else
static bool is_wide_processor(void)
{
    return false;
}
#endif

void choose_vector_width(void)
{
    if (getenv("LP_NATIVE_VECTOR_WIDTH") || getenv("GALLIVM_PERF") || !is_wide_processor() ||
        !is_tried())
        return;
    /* Mesa's cache on disk does not tell widths apart: other programs would run code for this one.
     * It does tell this flag, which means trilinear filtering alone. There is none here. */
    if (setenv("GALLIVM_PERF", "brilinear", 1) == 0)
        setenv("LP_NATIVE_VECTOR_WIDTH", "512", 1);
}
