/* SPDX-License-Identifier: MIT */
#include "error.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

bool fail(struct tool_error *err, enum exit_code code, const char *format, ...)
{
    if (err->code == EXIT_OK) {
        va_list args;
        va_start(args, format);
        vsnprintf(err->message, sizeof err->message, format, args);
        va_end(args);
        err->code = (int)code;
    }
    return false;
}

bool fail_hint(struct tool_error *err, const char *format, ...)
{
    if (!err->hint[0]) {
        va_list args;
        va_start(args, format);
        vsnprintf(err->hint, sizeof err->hint, format, args);
        va_end(args);
    }
    return false;
}

bool fail_of(struct tool_error *err, const char *path)
{
    char message[sizeof err->message];
    if (strncmp(err->message, path, strlen(path)) == 0)
        return false;
    memcpy(message, err->message, sizeof message);
    /* A long path leaves less of the message: the message ends with what matters least. */
    snprintf(err->message, sizeof err->message, "%.500s: %.500s", path, message);
    return false;
}
