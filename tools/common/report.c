/* SPDX-License-Identifier: MIT */
#include "report.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* One write per line, so that lines of processes that share a log do not mix. */
static void say(const char *label, const char *format, va_list args) TOOL_PRINTF(2, 0);
static void say(const char *label, const char *format, va_list args)
{
    char line[2048];
    vsnprintf(line, sizeof line, format, args);
    fprintf(stderr, "vkao: %s%s\n", label, line);
}

void report_error(const struct tool_error *err)
{
    if (err->hint[0])
        fprintf(stderr, "vkao: %s\n      %s\n", err->message, err->hint);
    else
        fprintf(stderr, "vkao: %s\n", err->message);
}

void report_warn(struct report *report, const char *key, const char *format, ...)
{
    for (size_t i = 0; i < report->said_count; i++)
        if (strcmp(report->said[i], key) == 0)
            return;
    if (report->said_count < sizeof report->said / sizeof *report->said)
        report->said[report->said_count++] = key;
    if (report->verbosity < REPORT_NORMAL)
        return;
    va_list args;
    va_start(args, format);
    say("warning: ", format, args);
    va_end(args);
}

void report_note(const struct report *report, const char *format, ...)
{
    if (report->verbosity < REPORT_NORMAL)
        return;
    va_list args;
    va_start(args, format);
    say("", format, args);
    va_end(args);
}

void report_detail(const struct report *report, const char *format, ...)
{
    if (report->verbosity < REPORT_VERBOSE)
        return;
    va_list args;
    va_start(args, format);
    say("", format, args);
    va_end(args);
}
