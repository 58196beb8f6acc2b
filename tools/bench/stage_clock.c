/* SPDX-License-Identifier: MIT */
#include "stage_clock.h"

#include <stdint.h>
#include <string.h>
#include <vulkan/vulkan.h>

static const char *const names[STAGES] = {
    [STAGE_PREPARE] = "prepare",   [STAGE_SSAO] = "ssao",           [STAGE_BLUR] = "blur",
    [STAGE_UPSAMPLE] = "upsample", [STAGE_COMPOSITE] = "composite", [STAGE_TOTAL] = "total",
};

/* Label functions get a command buffer and nothing else, so the clock that runs must be known. */
static struct stage_clock *running;

const char *stage_name(enum stage stage)
{
    return names[stage];
}

static void mark(struct stage_clock *clock, enum stage after)
{
    if (clock->marks < STAGE_CLOCK_MARKS) {
        clock->after[clock->marks] = after;
        vkCmdWriteTimestamp(clock->cmd, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, clock->pool,
                            (uint32_t)clock->marks);
    }
    clock->marks++;
}

/* What no label names belongs to the total alone. */
static enum stage current(const struct stage_clock *clock)
{
    int depth = clock->depth < STAGE_CLOCK_DEPTH ? clock->depth : STAGE_CLOCK_DEPTH;
    return depth > 0 ? clock->labels[depth - 1] : STAGE_TOTAL;
}

static enum stage stage_of(const struct stage_clock *clock, const char *label)
{
    static const char prefix[] = "vkao ";
    const size_t length = sizeof prefix - 1;
    for (int s = 0; s < STAGE_TOTAL; s++)
        if (strncmp(label, prefix, length) == 0 && strcmp(label + length, names[s]) == 0)
            return (enum stage)s;
    return current(clock);
}

static VKAPI_ATTR void VKAPI_CALL begin_label(VkCommandBuffer cmd,
                                              const VkDebugUtilsLabelEXT *label)
{
    struct stage_clock *clock = running;
    if (!clock || clock->cmd != cmd)
        return;
    enum stage stage = stage_of(clock, label->pLabelName);
    if (clock->depth < STAGE_CLOCK_DEPTH)
        clock->labels[clock->depth] = stage;
    clock->depth++;
    mark(clock, stage);
}

static VKAPI_ATTR void VKAPI_CALL end_label(VkCommandBuffer cmd)
{
    struct stage_clock *clock = running;
    if (!clock || clock->cmd != cmd || clock->depth == 0)
        return;
    clock->depth--;
    mark(clock, current(clock));
}

static PFN_vkVoidFunction label_function(const char *name)
{
    if (strcmp(name, "vkCmdBeginDebugUtilsLabelEXT") == 0)
        return (PFN_vkVoidFunction)begin_label;
    if (strcmp(name, "vkCmdEndDebugUtilsLabelEXT") == 0)
        return (PFN_vkVoidFunction)end_label;
    return NULL;
}

static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL instance_function(VkInstance instance,
                                                                  const char *name)
{
    PFN_vkVoidFunction own = label_function(name);
    return own ? own : vkGetInstanceProcAddr(instance, name);
}

static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL device_function(VkDevice device, const char *name)
{
    PFN_vkVoidFunction own = label_function(name);
    return own ? own : vkGetDeviceProcAddr(device, name);
}

void stage_clock_hook(vkao_context_info *info)
{
    info->debug_labels = VK_TRUE;
    info->get_instance_proc_addr = instance_function;
    info->get_device_proc_addr = device_function;
}

bool stage_clock_create(struct gpu *gpu, struct stage_clock *clock, struct tool_error *err)
{
    *clock = (struct stage_clock){.gpu = gpu};
    if (gpu->timestamp_bits == 0)
        return true;
    VkResult result = vkCreateQueryPool(gpu->device,
                                        &(VkQueryPoolCreateInfo){
                                            .sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
                                            .queryType = VK_QUERY_TYPE_TIMESTAMP,
                                            .queryCount = STAGE_CLOCK_MARKS,
                                        },
                                        NULL, &clock->pool);
    if (result == VK_SUCCESS)
        return true;
    clock->pool = VK_NULL_HANDLE;
    return fail(err, EXIT_MEMORY, "vkCreateQueryPool failed with VkResult %d", (int)result);
}

void stage_clock_destroy(struct stage_clock *clock)
{
    if (clock->pool)
        vkDestroyQueryPool(clock->gpu->device, clock->pool, NULL);
    *clock = (struct stage_clock){0};
}

void stage_clock_start(struct stage_clock *clock, VkCommandBuffer cmd)
{
    if (!clock->pool)
        return;
    clock->cmd = cmd;
    clock->marks = clock->depth = 0;
    vkCmdResetQueryPool(cmd, clock->pool, 0, STAGE_CLOCK_MARKS);
    mark(clock, STAGE_TOTAL);
    running = clock;
}

void stage_clock_stop(struct stage_clock *clock)
{
    if (!clock->pool)
        return;
    running = NULL;
    mark(clock, STAGE_TOTAL);
    clock->cmd = VK_NULL_HANDLE;
}

bool stage_clock_read(const struct stage_clock *clock, double wall_ms, double ms[STAGES],
                      struct tool_error *err)
{
    const struct gpu *gpu = clock->gpu;
    uint64_t ticks[STAGE_CLOCK_MARKS];
    uint64_t mask =
        gpu->timestamp_bits < 64 ? (UINT64_C(1) << gpu->timestamp_bits) - 1 : UINT64_MAX;
    double ms_per_tick = (double)gpu->properties.limits.timestampPeriod * 1e-6;
    for (int s = 0; s < STAGES; s++)
        ms[s] = 0;
    ms[STAGE_TOTAL] = wall_ms;
    if (!clock->pool)
        return true;
    if (clock->marks > STAGE_CLOCK_MARKS)
        return fail(err, EXIT_BUG, "%d labels in one recording", clock->marks);
    VkResult result = vkGetQueryPoolResults(gpu->device, clock->pool, 0, (uint32_t)clock->marks,
                                            sizeof ticks, ticks, sizeof ticks[0],
                                            VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT);
    if (result != VK_SUCCESS)
        return fail(err, EXIT_DEVICE, "vkGetQueryPoolResults failed with VkResult %d", (int)result);
    /* Masked after the subtraction: the counter may have wrapped in between. */
    for (int i = 0; i + 1 < clock->marks; i++)
        if (clock->after[i] != STAGE_TOTAL)
            ms[clock->after[i]] += (double)((ticks[i + 1] - ticks[i]) & mask) * ms_per_tick;
    ms[STAGE_TOTAL] = (double)((ticks[clock->marks - 1] - ticks[0]) & mask) * ms_per_tick;
    return true;
}
