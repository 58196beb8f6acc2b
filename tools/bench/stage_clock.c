/* SPDX-License-Identifier: MIT */
#include "stage_clock.h"

#include <stdint.h>
#include <string.h>
#include <vulkan/vulkan.h>

static const char *const names[STAGES] = {
    [STAGE_PREPARE] = "prepare",   [STAGE_SSAO] = "ssao",           [STAGE_BLUR] = "blur",
    [STAGE_UPSAMPLE] = "upsample", [STAGE_COMPOSITE] = "composite", [STAGE_TOTAL] = "total",
};

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

void stage_clock_mark(void *user_data, VkCommandBuffer cmd, const char *name, VkBool32 begins)
{
    struct stage_clock *clock = user_data;
    enum stage stage = STAGE_TOTAL;
    if (!clock->pool || clock->cmd != cmd)
        return;
    for (int s = 0; begins && s < STAGE_TOTAL; s++)
        if (strcmp(name, names[s]) == 0)
            stage = (enum stage)s;
    mark(clock, stage);
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
    clock->marks = 0;
    vkCmdResetQueryPool(cmd, clock->pool, 0, STAGE_CLOCK_MARKS);
    mark(clock, STAGE_TOTAL);
}

void stage_clock_stop(struct stage_clock *clock)
{
    if (!clock->pool)
        return;
    mark(clock, STAGE_TOTAL);
    clock->cmd = VK_NULL_HANDLE;
}

bool stage_clock_read(const struct stage_clock *clock, double wall_ms, double ms[STAGES],
                      struct tool_error *err)
{
    const struct gpu *gpu = clock->gpu;
    uint64_t ticks[STAGE_CLOCK_MARKS];
    for (int s = 0; s < STAGES; s++)
        ms[s] = 0;
    ms[STAGE_TOTAL] = wall_ms;
    if (!clock->pool)
        return true;
    if (clock->marks > STAGE_CLOCK_MARKS)
        return fail(err, EXIT_BUG, "%d marks in one recording", clock->marks);
    VkResult result = vkGetQueryPoolResults(gpu->device, clock->pool, 0, (uint32_t)clock->marks,
                                            sizeof ticks, ticks, sizeof ticks[0],
                                            VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT);
    if (result != VK_SUCCESS)
        return fail(err, EXIT_DEVICE, "vkGetQueryPoolResults failed with VkResult %d", (int)result);
    for (int i = 0; i + 1 < clock->marks; i++)
        if (clock->after[i] != STAGE_TOTAL)
            ms[clock->after[i]] += gpu_ms_between(gpu, ticks[i], ticks[i + 1]);
    ms[STAGE_TOTAL] = gpu_ms_between(gpu, ticks[0], ticks[clock->marks - 1]);
    return true;
}
