/* SPDX-License-Identifier: MIT
 *
 * Frame numbers (1-10x2,20) and file names that hold one (x.####.exr). */
#ifndef VKAO_TOOLS_FRAMES_H_
#define VKAO_TOOLS_FRAMES_H_

#include "error.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* How A-B:S is read: as a step in OpenJD, where S is a step; everywhere else it is refused, since
 * other tools interleave there. */
enum frame_syntax { FRAME_SYNTAX_VFX, FRAME_SYNTAX_OPENJD };

struct frame {
    int64_t number;
    char *path; /* the file found for it, NULL if none was looked for */
};

struct frame_list {
    struct frame *frames;
    size_t count;
};

/* A, A-B, A-BxS, comma lists, negative numbers, B-A for the reverse; repeated numbers count once.
 * Errors: EXIT_USAGE. */
bool frame_list_parse(const char *spec, enum frame_syntax syntax, struct frame_list *list,
                      struct tool_error *err);
void frame_list_free(struct frame_list *list);
/* "1-99, 102-240" of a sorted list, cut with "..." where buffer ends. */
void frame_list_describe(const struct frame_list *list, char *buffer, size_t size);

/* A path with at most one frame token in its last component: a run of # or @ (one # alone means
 * four digits), %d, %4d, %04d, $F or $F4. */
struct frame_pattern {
    char *prefix;   /* all of the path before the token */
    char *suffix;   /* and behind it; NULL if there is no token */
    int digits;     /* least number of digits, padded with zeros */
    bool is_printf; /* %04d: the sign is one of the digits, as in C */
};

/* The first token of a path that is no part of a word, as @ of x@2x.exr and %d of 100%done are, or
 * NULL. */
const char *frame_token_that_is_clear(const char *path, size_t *length);
/* Errors: EXIT_USAGE for mixed (#@) and repeated tokens. */
bool frame_pattern_parse(const char *path, struct frame_pattern *pattern, struct tool_error *err);
void frame_pattern_free(struct frame_pattern *pattern);
bool frame_pattern_has_token(const struct frame_pattern *pattern);
/* The path of one frame, malloc'ed; NULL if memory runs out. */
char *frame_pattern_path(const struct frame_pattern *pattern, int64_t number);
/* Existing files of the pattern with any number of digits, sorted by number. Where two files have
 * the same number, the one that is padded as the pattern says counts. No files is not an error. */
bool frame_pattern_scan(const struct frame_pattern *pattern, struct frame_list *list,
                        struct tool_error *err);

#endif
