/* SPDX-License-Identifier: MIT
 *
 * Prints the source of the man page: that of a file, with the options in place of the line
 * @OPTIONS@. */
#include "options.h"
#include "read_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int main(int argc, char **argv)
{
    enum { MOST_BYTES = 1 << 20 };
    static const char mark[] = "@OPTIONS@\n";
    struct tool_error err = {0};
    struct text options = {0};
    char *page = argc == 2 ? read_file(argv[1], MOST_BYTES, &err) : NULL;
    char *at = page ? strstr(page, mark) : NULL;
    if (!at) {
        fprintf(stderr, "%s\n",
                err.code ? err.message : "usage: man-page FILE with a line @OPTIONS@");
        free(page);
        return EXIT_USAGE;
    }
    options_man(&options);
    printf("%.*s%s%s", (int)(at - page), page, options.data ? options.data : "", at + strlen(mark));
    const bool ok = !options.out_of_memory && fflush(stdout) == 0;
    text_free(&options);
    free(page);
    return ok ? EXIT_OK : EXIT_OUTPUT;
}
