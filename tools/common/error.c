/* SPDX-License-Identifier: MIT */
#include "error.h"

#include <stdarg.h>
#include <stdio.h>

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
