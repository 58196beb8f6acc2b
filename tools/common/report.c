/* SPDX-License-Identifier: MIT */
#include "report.h"

#include "text.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LINE_BYTES = 2048 };

/* On the stack, since memory may be what has run out. */
static void print_line(const char *before, const char *label, const char *text)
{
    char line[4 * LINE_BYTES + 64];
    size_t length = (size_t)snprintf(line, 64, "%s%s", before, label);
    text_printable(line + length, sizeof line - length, text);
    fprintf(stderr, "%s\n", line);
}

/* One write per line, so that lines of processes that share a log do not mix. */
static void say(const char *label, const char *format, va_list args) TOOL_PRINTF(2, 0);
static void say(const char *label, const char *format, va_list args)
{
    char line[LINE_BYTES];
    vsnprintf(line, sizeof line, format, args);
    print_line("vkao: ", label, line);
}

void report_error(const struct tool_error *err)
{
    print_line("vkao: ", "", err->message);
    if (err->hint[0])
        print_line("      ", "", err->hint);
}

/* False if there is no room for another. */
static bool find_key(struct report *report, const char *key, bool *is_new, size_t *index)
{
    size_t i = 0;
    while (i < report->said_count && strcmp(report->said[i], key) != 0)
        i++;
    *is_new = i == report->said_count;
    *index = i;
    if (*is_new && i == sizeof report->said / sizeof *report->said)
        return false;
    if (*is_new)
        report->said[report->said_count++] = key;
    return true;
}

static void warn(struct report *report, const char *key, bool each_frame, const char *line)
{
    bool is_new;
    size_t index;
    const bool has_room = find_key(report, key, &is_new, &index);
    const bool is_new_here = is_new || report->said_in[index] != report->frame;
    if (has_room)
        report->said_in[index] = report->frame;
    if (!is_new_here)
        return;
    if (report->heard)
        report->heard(report->heard_data, line);
    if (report->verbosity >= REPORT_NORMAL && (is_new || each_frame))
        print_line("vkao: ", "warning: ", line);
}

struct report_waiting {
    const char *key;
    bool each_frame;
    char *line;
};

static void wait_in(struct report_queue *queue, const char *key, bool each_frame, const char *line)
{
    struct report_waiting *list = realloc(queue->list, (queue->count + 1) * sizeof *queue->list);
    char *copy = strdup(line);
    if (list)
        queue->list = list;
    if (list && copy) {
        list[queue->count++] = (struct report_waiting){key, each_frame, copy};
        return;
    }
    free(copy);
    queue->out_of_memory = true;
}

static void warn_or_wait(struct report *report, const char *key, bool each_frame,
                         const char *format, va_list args) TOOL_PRINTF(4, 0);
static void warn_or_wait(struct report *report, const char *key, bool each_frame,
                         const char *format, va_list args)
{
    char line[LINE_BYTES];
    vsnprintf(line, sizeof line, format, args);
    if (report->queue)
        wait_in(report->queue, key, each_frame, line);
    else
        warn(report, key, each_frame, line);
}

void report_warn(struct report *report, const char *key, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    warn_or_wait(report, key, false, format, args);
    va_end(args);
}

void report_warn_of_frame(struct report *report, const char *key, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    warn_or_wait(report, key, true, format, args);
    va_end(args);
}

void report_warn_of_queue(struct report *report, struct report_queue *queue)
{
    for (size_t i = 0; i < queue->count; i++)
        warn(report, queue->list[i].key, queue->list[i].each_frame, queue->list[i].line);
    report_free_queue(queue);
}

void report_free_queue(struct report_queue *queue)
{
    for (size_t i = 0; i < queue->count; i++)
        free(queue->list[i].line);
    free(queue->list);
    *queue = (struct report_queue){0};
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

bool report_text(const char *text, struct tool_error *err)
{
    struct text line = {0}, clean = {0};
    while (*text) {
        const size_t length = strcspn(text, "\n");
        line.length = 0;
        text_add(&line, "%.*s", (int)length, text);
        text_add_printable(&clean, line.data ? line.data : "");
        text_add(&clean, "%s", text[length] ? "\n" : "");
        text += length + (text[length] != '\0');
    }
    const bool ok = !line.out_of_memory && !clean.out_of_memory;
    if (ok && clean.data)
        fputs(clean.data, stdout);
    text_free(&line);
    text_free(&clean);
    return ok || fail(err, EXIT_MEMORY, "out of memory");
}
