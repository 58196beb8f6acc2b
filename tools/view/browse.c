/* SPDX-License-Identifier: MIT */
#include "browse.h"

#include "text.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static char lower(char c)
{
    return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c;
}

static bool contains(const char *name, const char *part)
{
    for (; *name; name++) {
        size_t i = 0;
        while (part[i] && lower(name[i]) == lower(part[i]))
            i++;
        if (!part[i])
            return true;
    }
    return !*part;
}

/* --- Reading --- */

/* "/" joins; a folder "." is left out of paths. False if it is too long. */
static bool join(const char *folder, const char *name, char *path, size_t size)
{
    const bool ends = *folder && folder[strlen(folder) - 1] == '/';
    const int length = strcmp(folder, ".") == 0
                           ? snprintf(path, size, "%s", name)
                           : snprintf(path, size, "%s%s%s", folder, ends ? "" : "/", name);
    return length >= 0 && (size_t)length < size;
}

static bool is_offered(const char *folder, const char *name, bool *is_folder)
{
    char path[sizeof((struct browser *)NULL)->folder + 256];
    struct stat s;
    if (!join(folder, name, path, sizeof path) || stat(path, &s) != 0)
        return false;
    *is_folder = S_ISDIR(s.st_mode);
    if (*is_folder)
        return strcmp(name, "..") == 0 || name[0] != '.';
    return S_ISREG(s.st_mode) &&
           (text_has_extension(name, ".exr") || text_has_extension(name, ".json"));
}

static int compare(const void *a, const void *b)
{
    const struct browser_entry *x = a, *y = b;
    return x->is_folder != y->is_folder ? (x->is_folder ? -1 : 1) : strcmp(x->name, y->name);
}

static bool add(struct browser *b, const char *name, bool is_folder)
{
    if ((b->count & (b->count - 1)) == 0) { /* at powers of two */
        const size_t more = b->count ? b->count * 2 : 1;
        struct browser_entry *entries = realloc(b->entries, more * sizeof *entries);
        if (!entries)
            return false;
        b->entries = entries;
    }
    b->entries[b->count] = (struct browser_entry){text_copy(name, strlen(name)), is_folder};
    return b->entries[b->count++].name != NULL;
}

static bool list_folder(struct browser *b, struct tool_error *err)
{
    DIR *folder = opendir(b->folder);
    if (!folder)
        return fail(err, EXIT_INPUT, "%s: cannot list: %s", b->folder, strerror(errno));
    bool ok = true;
    for (struct dirent *d = readdir(folder); ok && d; d = readdir(folder)) {
        bool is_folder;
        if (is_offered(b->folder, d->d_name, &is_folder))
            ok = add(b, d->d_name, is_folder);
    }
    closedir(folder);
    b->shown = ok ? calloc(b->count + 1, sizeof *b->shown) : NULL;
    if (!b->shown)
        return fail(err, EXIT_MEMORY, "%s: out of memory for its list", b->folder);
    if (b->count > 0)
        qsort(b->entries, b->count, sizeof *b->entries, compare);
    return true;
}

/* --- Choosing --- */

/* What was chosen stays so, if it is still there. */
static void apply_filter(struct browser *b, const char *chosen)
{
    b->shown_count = b->at = 0;
    for (size_t i = 0; i < b->count; i++) {
        if (!contains(b->entries[i].name, b->filter))
            continue;
        if (chosen && strcmp(b->entries[i].name, chosen) == 0)
            b->at = b->shown_count;
        b->shown[b->shown_count++] = i;
    }
}

static bool open_folder(struct browser *b, const char *folder, const char *chosen,
                        struct tool_error *err)
{
    struct browser other = {.is_open = true};
    const int length = snprintf(other.folder, sizeof other.folder, "%s", folder);
    bool ok = (length >= 0 && (size_t)length < sizeof other.folder) ||
              fail(err, EXIT_INPUT, "%.200s...: a path too long", folder);
    if (!ok || !list_folder(&other, err)) {
        browser_close(&other);
        return false;
    }
    apply_filter(&other, chosen);
    browser_close(b);
    *b = other;
    return true;
}

bool browser_open(struct browser *browser, const char *path, struct tool_error *err)
{
    const char *slash = path ? strrchr(path, '/') : NULL;
    if (!slash)
        return open_folder(browser, ".", path, err);
    const size_t length = slash == path ? 1 : (size_t)(slash - path);
    char *folder = text_copy(path, length);
    bool ok = folder ? open_folder(browser, folder, slash + 1, err)
                     : fail(err, EXIT_MEMORY, "%s: out of memory", path);
    free(folder);
    return ok;
}

void browser_close(struct browser *browser)
{
    for (size_t i = 0; i < browser->count; i++)
        free(browser->entries[i].name);
    free(browser->entries);
    free(browser->shown);
    *browser = (struct browser){0};
}

void browser_move(struct browser *browser, long by)
{
    const long last = (long)browser->shown_count - 1;
    long at = (long)browser->at;
    at = by < -at ? 0 : by > last - at ? last : at + by;
    browser->at = at < 0 ? 0 : (size_t)at;
}

static const char *chosen_name(const struct browser *b)
{
    return b->at < b->shown_count ? b->entries[b->shown[b->at]].name : NULL;
}

void browser_type(struct browser *browser, uint32_t character)
{
    struct browser *b = browser;
    const size_t length = strlen(b->filter), bytes = character < 0x80      ? 1
                                                     : character < 0x800   ? 2
                                                     : character < 0x10000 ? 3
                                                                           : 4;
    static const unsigned first[] = {0, 0, 0xc0, 0xe0, 0xf0};
    if (length + bytes >= sizeof b->filter || character > 0x10ffff)
        return;
    for (size_t i = bytes; i-- > 1; character >>= 6)
        b->filter[length + i] = (char)(0x80 | (character & 0x3f));
    b->filter[length] = (char)(first[bytes] | character);
    b->filter[length + bytes] = '\0';
    apply_filter(b, chosen_name(b));
}

/* The folder above, with this one chosen in it. */
static bool go_up(struct browser *b, struct tool_error *err)
{
    char above[sizeof b->folder + 4], name[sizeof b->folder];
    const char *slash = strrchr(b->folder, '/'), *last = slash ? slash + 1 : b->folder;
    const bool is_name = *last && strcmp(last, ".") != 0 && strcmp(last, "..") != 0;
    snprintf(name, sizeof name, "%s", is_name ? last : "");
    if (!is_name)
        snprintf(above, sizeof above, "%s%s", strcmp(b->folder, ".") == 0 ? "" : b->folder,
                 strcmp(b->folder, ".") == 0   ? ".."
                 : strcmp(b->folder, "/") == 0 ? ""
                                               : "/..");
    else if (slash)
        snprintf(above, sizeof above, "%.*s", slash == b->folder ? 1 : (int)(slash - b->folder),
                 b->folder);
    else
        snprintf(above, sizeof above, ".");
    return open_folder(b, above, name, err);
}

bool browser_erase(struct browser *browser, struct tool_error *err)
{
    struct browser *b = browser;
    size_t length = strlen(b->filter);
    if (length == 0)
        return go_up(b, err);
    /* All bytes of a UTF-8 character. */
    while (length > 1 && ((unsigned char)b->filter[length - 1] & 0xc0) == 0x80)
        length--;
    b->filter[length - 1] = '\0';
    apply_filter(b, chosen_name(b));
    return true;
}

bool browser_choose(struct browser *browser, char *path, size_t size, struct tool_error *err)
{
    struct browser *b = browser;
    const char *name = chosen_name(b);
    if (!name)
        return false;
    const bool is_folder = b->entries[b->shown[b->at]].is_folder;
    if (is_folder && strcmp(name, "..") == 0)
        return go_up(b, err) && false;
    if (!join(b->folder, name, path, size))
        return fail(err, EXIT_INPUT, "%.200s...: a path too long", b->folder);
    return is_folder ? open_folder(b, path, NULL, err) && false : true;
}
