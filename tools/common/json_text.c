/* SPDX-License-Identifier: MIT */
#include "json_text.h"

#include "text.h"

#include <stdlib.h>

static _Thread_local unsigned failures;

static void *allocate(size_t size)
{
    void *memory = malloc(size);
    failures += !memory;
    return memory;
}

unsigned json_begin(void)
{
    cJSON_InitHooks(&(cJSON_Hooks){.malloc_fn = allocate, .free_fn = free});
    return failures;
}

bool json_is_whole(unsigned begun)
{
    return failures == begun;
}

char *json_text(const cJSON *root, bool formatted, unsigned begun)
{
    struct text text = {0};
    char *json = formatted ? cJSON_Print(root) : cJSON_PrintUnformatted(root);
    if (json && json_is_whole(begun))
        text_add_json(&text, json);
    cJSON_free(json);
    if (text.out_of_memory)
        text_free(&text);
    return text.data;
}
