/* SPDX-License-Identifier: MIT */
#ifndef VKAO_VIEW_SHELL_H_
#define VKAO_VIEW_SHELL_H_

#include "text.h"

/* One word of a command line, quoted where a POSIX shell would make something else of it. */
void text_add_quoted(struct text *text, const char *word);

#endif
