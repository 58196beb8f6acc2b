/* SPDX-License-Identifier: MIT */
#include "pipelines.h"

uint64_t entry_handle(const struct pipeline_entry *entry)
{
    return (uint64_t)(uintptr_t)entry->pipeline;
}

bool entry_is_general(const struct pipeline_entry *entry)
{
    return entry->key.flags == VKAO_FLAGS_UNKNOWN;
}

const struct pipeline_entry *general_entry(const vkao_context *ctx, enum pipeline which, bool bent)
{
    for (uint32_t i = 0; i < ctx->pipelines.count; ++i) {
        const struct pipeline_entry *e = &ctx->pipelines.entries[i];
        if (e->which == which && e->bent == (bent ? VK_TRUE : VK_FALSE) && entry_is_general(e))
            return e;
    }
    return NULL;
}

const struct pipeline_entry *entry_of(const vkao_context *ctx, uint64_t pipeline)
{
    for (uint32_t i = 0; i < ctx->pipelines.count; ++i) {
        if (entry_handle(&ctx->pipelines.entries[i]) == pipeline)
            return &ctx->pipelines.entries[i];
    }
    return NULL;
}
