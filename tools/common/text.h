/* SPDX-License-Identifier: MIT
 *
 * Strings that grow, what a terminal may see of them, numbers read strictly, and the distance
 * between two words. */
#ifndef VKAO_TOOLS_TEXT_H_
#define VKAO_TOOLS_TEXT_H_

#include "error.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Zero-initialise; data is NULL or zero-terminated. Once memory runs out it stays as it is and says
 * so, so that only the end of a long text needs a check. */
struct text {
    char *data;
    size_t length, capacity;
    bool out_of_memory;
};

void text_add(struct text *text, const char *format, ...) TOOL_PRINTF(2, 3);
void text_free(struct text *text);

/* A string from anywhere as one line that cannot steer a terminal. Legal UTF-8 stays. Control
 * characters (C0, DEL, C1), changes of direction (U+202A to E, U+2066 to 9), line and paragraph
 * separators, and bytes that are no UTF-8 become \xNN, byte by byte. A backslash that would look
 * like such an escape becomes \x5c, so that no two strings look alike: escape once, where the
 * string goes out. Like snprintf it returns the bytes wanted and cuts, though never in a character
 * or an escape. */
size_t text_printable(char *out, size_t size, const char *string);
void text_add_printable(struct text *text, const char *string);
/* JSON as cJSON prints it, whose strings may hold any bytes: what a terminal must not see becomes
 * \uNNNN and so stays what it was; a byte that is no UTF-8 becomes the characters \xNN. */
void text_add_json(struct text *text, const char *json);

char *text_copy(const char *string, size_t length); /* NULL if memory runs out */
bool text_equal_nocase(const char *a, const char *b);
bool text_starts_with(const char *string, const char *prefix);
bool text_ends_with(const char *string, const char *suffix);
/* What stands behind the last slash of a path. */
const char *text_base_name(const char *path);
/* Of a path: ".exr" in letters of any case, behind something. */
bool text_has_extension(const char *path, const char *extension);

/* The whole of string, or false. Numbers may be inf, never nan. Both take what C takes in the C
 * locale. */
bool text_to_number(const char *string, double *number);
bool text_to_integer(const char *string, int64_t *integer);

/* Insertions, deletions, replacements and swaps of neighbours that turn a into b; words beyond 63
 * bytes are cut. */
unsigned text_distance(const char *a, const char *b);

/* A share in [0,1] as people write it: "12 %", "3.4 %", "0.02 %"; 100 and 0 only if it is so. */
enum { PERCENT_BYTES = 24 };
void text_percent(char out[PERCENT_BYTES], double share);

/* False if the product does not fit. */
bool size_multiply(size_t a, size_t b, size_t *product);

/* "a, b or c" of the words whose bits are set, with `last` before the last. */
void text_add_list(struct text *text, const char *const *words, uint32_t chosen, const char *last);
/* Words from column indent on, where the text stands, and a line break: no line reaches beyond
 * columns. */
void text_add_wrapped(struct text *text, const char *words, size_t indent, size_t columns);

#endif
