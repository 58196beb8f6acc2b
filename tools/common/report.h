/* SPDX-License-Identifier: MIT
 *
 * What the tools say on stderr: one line each, `vkao: ` in front, a remedy indented below. Names in
 * files are anybody's: whatever goes out here is escaped as text_printable says. */
#ifndef VKAO_TOOLS_REPORT_H_
#define VKAO_TOOLS_REPORT_H_

#include "error.h"

#include <stdbool.h>
#include <stddef.h>

enum verbosity { REPORT_QUIET = -1, REPORT_NORMAL = 0, REPORT_VERBOSE = 1 };

/* Warnings that wait until it is their turn; of one thread at a time. */
struct report_queue {
    struct report_waiting *list; /* malloc'ed */
    size_t count;
    bool out_of_memory; /* not all of them are there */
};

struct report {
    enum verbosity verbosity;
    const char *said[64]; /* keys of the warnings given so far; the strings are static */
    unsigned said_in[64]; /* the frame of each, the last one */
    size_t said_count;
    unsigned frame; /* of a sequence, counted by who goes through it */
    /* Hears warnings too, and however quiet the report is, once per key and frame; NULL: nobody. */
    void (*heard)(void *data, const char *warning);
    void *heard_data;
    struct report_queue *queue; /* takes warnings, which nobody hears before; NULL: at once */
};

/* Whatever the verbosity. */
void report_error(const struct tool_error *err);
/* Once per key, which must be a string literal; silent when quiet. Warnings of a sequence would be
 * noise otherwise. */
void report_warn(struct report *report, const char *key, const char *format, ...) TOOL_PRINTF(3, 4);
/* Once per key and frame, which may be too much: for what the caller knows to begin there. */
void report_warn_of_frame(struct report *report, const char *key, const char *format, ...)
    TOOL_PRINTF(3, 4);
/* What waits, as if it were warned of now, and empties the queue. */
void report_warn_of_queue(struct report *report, struct report_queue *queue);
/* Empties it; nobody hears what waited. */
void report_free_queue(struct report_queue *queue);
/* Progress and summaries, at normal verbosity. */
void report_note(const struct report *report, const char *format, ...) TOOL_PRINTF(2, 3);
/* Details, with -v. */
void report_detail(const struct report *report, const char *format, ...) TOOL_PRINTF(2, 3);
/* Finished text on stdout, its lines escaped. */
bool report_text(const char *text, struct tool_error *err);

#endif
