/* SPDX-License-Identifier: MIT */
#include "sizes.h"

#include "text.h"

#include <stdio.h>
#include <string.h>

static bool parse_size(const char *name, VkExtent2D *size)
{
    static const struct {
        const char *name;
        VkExtent2D size;
    } known[] = {
        {"720p", {1280, 720}},
        {"1080p", {1920, 1080}},
        {"2160p", {3840, 2160}},
        {"8k", {7680, 4320}},
    };
    int end = 0;
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        if (text_equal_nocase(known[i].name, name)) {
            *size = known[i].size;
            return true;
        }
    }
    return sscanf(name, "%5ux%5u%n", &size->width, &size->height, &end) == 2 && !name[end] &&
           size->width >= 1 && size->width <= 65535 && size->height >= 1 && size->height <= 65535;
}

bool sizes_choose(const char *names, struct size_list *list, struct tool_error *err)
{
    *list = (struct size_list){0};
    while (*names) {
        char name[64];
        size_t length = strcspn(names, ",");
        snprintf(name, sizeof name, "%.*s", (int)length, names);
        names += length + (names[length] == ',');
        if (!*name)
            continue;
        if (list->count == MAX_SIZES)
            return fail(err, EXIT_USAGE, "--size names more than %d sizes", (int)MAX_SIZES);
        if (!parse_size(name, &list->sizes[list->count++]))
            return fail(err, EXIT_USAGE, "--size is '%s', want WxH, 720p, 1080p, 2160p or 8k",
                        name);
    }
    return list->count > 0 || fail(err, EXIT_USAGE, "--size names nothing");
}
