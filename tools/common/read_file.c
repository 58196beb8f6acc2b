/* SPDX-License-Identifier: MIT */
#include "read_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static bool fail_read(const char *path, int error, struct tool_error *err)
{
    return fail(err, EXIT_INPUT, "%s: cannot read: %s", path, strerror(error));
}

/* One byte more than most tells a file that is too large, or has grown since. */
static bool read_all(int fd, const char *path, char *data, size_t most, struct tool_error *err)
{
    size_t length = 0;
    ssize_t got = 1;
    while (length <= most && got != 0) {
        got = read(fd, data + length, most + 1 - length);
        if (got < 0 && errno != EINTR)
            return fail_read(path, errno, err);
        length += got > 0 ? (size_t)got : 0;
    }
    if (length > most)
        return fail(err, EXIT_INPUT, "%s: larger than %zu bytes", path, most);
    data[length] = '\0';
    return true;
}

static bool check_kind(int fd, const char *path, size_t most, struct tool_error *err)
{
    struct stat status;
    if (fstat(fd, &status) != 0)
        return fail_read(path, errno, err);
    if (S_ISDIR(status.st_mode))
        return fail(err, EXIT_INPUT, "%s: cannot open: %s", path, strerror(EISDIR));
    if (!S_ISREG(status.st_mode)) {
        fail(err, EXIT_INPUT, "%s: cannot open: not a regular file", path);
        return fail_hint(err, "write it to a file first");
    }
    return (uint64_t)status.st_size <= most ||
           fail(err, EXIT_INPUT, "%s: larger than %zu bytes", path, most);
}

char *read_file(const char *path, size_t most, struct tool_error *err)
{
    /* O_NONBLOCK: a pipe without a writer must not hang us before we can refuse it. */
    const int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    if (fd < 0) {
        fail(err, EXIT_INPUT, "%s: cannot open: %s", path, strerror(errno));
        return NULL;
    }
    char *data = NULL;
    bool ok = check_kind(fd, path, most, err);
    if (ok) {
        data = malloc(most + 2);
        ok = (data || fail(err, EXIT_MEMORY, "%s: out of memory", path)) &&
             read_all(fd, path, data, most, err);
    }
    close(fd);
    if (ok)
        return data;
    free(data);
    return NULL;
}
