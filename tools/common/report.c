/* SPDX-License-Identifier: MIT */
#include "report.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Names in files are anybody's: none of them may steer the terminal. */
static void print_line(const char *before, const char *label, const char *text)
{
    char line[2200];
    snprintf(line, sizeof line, "%s%s%s", before, label, text);
    for (char *p = line; *p; p++)
        if ((unsigned char)*p < ' ' || *p == 0x7f)
            *p = '?';
    fprintf(stderr, "%s\n", line);
}

/* One write per line, so that lines of processes that share a log do not mix. */
static void say(const char *label, const char *format, va_list args) TOOL_PRINTF(2, 0);
static void say(const char *label, const char *format, va_list args)
{
    char line[2048];
    vsnprintf(line, sizeof line, format, args);
    print_line("vkao: ", label, line);
}

void report_error(const struct tool_error *err)
{
    print_line("vkao: ", "", err->message);
    if (err->hint[0])
        print_line("      ", "", err->hint);
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
