/* SPDX-License-Identifier: MIT
 *
 * What cJSON leaves to its users: it prints strings as they are, though names in files need not be
 * text, and an item that memory ran out for is just not there. */
#ifndef VKAO_TOOLS_JSON_TEXT_H_
#define VKAO_TOOLS_JSON_TEXT_H_

#include <cjson/cJSON.h>
#include <stdbool.h>

/* Before a document is built or parsed, in the thread that does so: how often memory ran out so
 * far. */
unsigned json_begin(void);
/* Whether nothing that was asked of cJSON since then failed for want of memory. */
bool json_is_whole(unsigned begun);
/* Valid JSON and UTF-8 for terminals and programs, as text_add_json says; free() it. NULL if memory
 * ran out since json_begin. */
char *json_text(const cJSON *root, bool formatted, unsigned begun);

#endif
