/* SPDX-License-Identifier: MIT */
#include "preview.h"

#include "png_file.h"

#include <stdlib.h>
#include <string.h>

void preview_path(const char *path, const char *view, size_t view_count, struct text *out)
{
    const char *dot = strrchr(path, '.');
    size_t stem = dot && !strchr(dot, '/') ? (size_t)(dot - path) : strlen(path);
    if (view_count < 2) {
        text_add(out, "%s", path);
        return;
    }
    text_add(out, "%.*s.%s%s", (int)stem, path, view, path + stem);
    const size_t end = stem + 1 + strlen(view);
    for (size_t i = stem + 1; out->data && !out->out_of_memory && i < end; i++)
        if (out->data[i] == '/')
            out->data[i] = '_';
}

/* The real path of the directory that a file is in, malloc'ed, or NULL. */
static char *real_directory(const char *path)
{
    const char *slash = strrchr(path, '/');
    char *directory = slash ? text_copy(path, (size_t)(slash - path) + 1) : text_copy(".", 1);
    char *real = directory ? realpath(directory, NULL) : NULL;
    free(directory);
    return real;
}

/* From one real path of a directory to another, with a slash at its end. */
static void add_way(const char *from, const char *to, struct text *way)
{
    size_t shared = 0;
    for (size_t i = 0;; i++) {
        const bool both_end = (!from[i] || from[i] == '/') && (!to[i] || to[i] == '/');
        if (both_end)
            shared = i;
        if (!from[i] || !to[i] || from[i] != to[i])
            break;
    }
    for (const char *c = from + shared; *c; c++)
        if (*c == '/' && c[1])
            text_add(way, "../");
    if (to[shared] == '/' && to[shared + 1])
        text_add(way, "%s/", to + shared + 1);
}

char *preview_owner(const char *preview, const char *output)
{
    struct text way = {0};
    char *from = real_directory(preview), *to = real_directory(output);
    if (from && to) {
        add_way(from, to, &way);
        text_add(&way, "%s", text_base_name(output));
    }
    free(from);
    free(to);
    if (way.out_of_memory)
        text_free(&way);
    return way.data;
}

bool preview_is_of(const char *preview, const char *output)
{
    char *owner = preview_owner(preview, output);
    char *said = owner ? png_file_read_text(preview, PREVIEW_OWNER_KEY) : NULL;
    const bool is_own = said && strcmp(said, owner) == 0;
    free(said);
    free(owner);
    return is_own;
}
