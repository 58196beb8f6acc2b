/* SPDX-License-Identifier: MIT
 *
 * One error, as the tools report it: an exit code, one line that names the file and the thing, and
 * a remedy. */
#ifndef VKAO_TOOLS_ERROR_H_
#define VKAO_TOOLS_ERROR_H_

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Exit codes of every vkao tool; documented in the README and the man page. */
enum exit_code {
    EXIT_OK = 0,
    EXIT_SOME_FRAMES = 1,
    EXIT_USAGE = 2,
    EXIT_INPUT = 3,
    EXIT_CHANNELS = 4,
    EXIT_DEVICE = 5,
    EXIT_OUTPUT = 6,
    EXIT_MEMORY = 33,
    EXIT_BUG = 70
};

struct tool_error {
    int code;           /* enum exit_code; EXIT_OK while nothing went wrong */
    bool ends_run;      /* no other file could do better: there is no device, or it is lost */
    bool shows_nothing; /* all background, which other frames of the sequence may not be */
    char message[1024]; /* 'FILE: what is wrong', no newline */
    char hint[1024];    /* what to do about it; empty if there is nothing useful to say */
};

#ifdef __GNUC__
#define TOOL_PRINTF(fmt, args) __attribute__((format(printf, fmt, args)))
#else
#define TOOL_PRINTF(fmt, args)
#endif

/* Fills *err unless it already holds an error (the first cause wins), and returns false, so that
 * callers can write `return fail(err, EXIT_INPUT, "%s: ...", path);`. */
bool fail(struct tool_error *err, enum exit_code code, const char *format, ...) TOOL_PRINTF(3, 4);
/* Adds the remedy to an error that has none yet; returns false. */
bool fail_hint(struct tool_error *err, const char *format, ...) TOOL_PRINTF(2, 3);
/* Puts 'PATH: ' in front of an error whose message does not begin so; returns false. */
bool fail_of(struct tool_error *err, const char *path);

#ifdef __cplusplus
}
#endif
#endif
