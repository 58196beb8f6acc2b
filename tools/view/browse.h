/* SPDX-License-Identifier: MIT
 *
 * A list of the folders and files that could be opened, moved through with the keyboard. No device,
 * no window. */
#ifndef VKAO_VIEW_BROWSE_H_
#define VKAO_VIEW_BROWSE_H_

#include "error.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct browser_entry {
    char *name;
    bool is_folder;
};

struct browser {
    bool is_open;
    char folder[4096];
    char filter[64];               /* what names must contain, whatever the case */
    struct browser_entry *entries; /* folders first, by name; "..", EXR files and cameras */
    size_t count;
    size_t *shown; /* indices of entries that the filter leaves */
    size_t shown_count, at;
};

/* The folder of a path, which is chosen if it is there; NULL: the working directory. What was open
 * is closed; on errors it stays. Errors: EXIT_INPUT, EXIT_MEMORY. */
bool browser_open(struct browser *browser, const char *path, struct tool_error *err);
void browser_close(struct browser *browser);

/* By so many entries, up to the ends. */
void browser_move(struct browser *browser, long by);
/* Adds a character of Unicode to the filter, or takes its last one away; without any, goes to the
 * folder above. */
void browser_type(struct browser *browser, uint32_t character);
bool browser_erase(struct browser *browser, struct tool_error *err);
/* Of the chosen entry: true with the path of a file; false for a folder, which is then listed, for
 * nothing, and on errors. */
bool browser_choose(struct browser *browser, char *path, size_t size, struct tool_error *err);

#endif
