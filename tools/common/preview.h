/* SPDX-License-Identifier: MIT
 *
 * The PNG beside an output: what it is called, and whose it is. */
#ifndef VKAO_TOOLS_PREVIEW_H_
#define VKAO_TOOLS_PREVIEW_H_

#include "text.h"

#include <stdbool.h>
#include <stddef.h>

/* 'x.png' becomes 'x.left.png' where there is more than one view. A view's name is the file's, and
 * must not lead to another directory. */
void preview_path(const char *path, const char *view, size_t view_count, struct text *out);

/* What a preview says of whose it is, as png_text: the way to the output from where the preview is.
 * malloc'ed; NULL if a directory is not there or memory runs out. */
#define PREVIEW_OWNER_KEY "vkao/output"
char *preview_owner(const char *preview, const char *output);
/* Whether it says so of this output: then nobody else wants it. */
bool preview_is_of(const char *preview, const char *output);

#endif
