/* SPDX-License-Identifier: MIT */
#ifndef _GNU_SOURCE
#define _GNU_SOURCE /* renameat2 */
#endif
#include "atomic_file.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* What a signal handler may have to remove. The paths are kept here, and not in struct atomic_file,
 * because a handler in one thread may run while another thread returns from the function that held
 * its struct. */
enum { PENDING_MAX = 64 };
enum pending_state { PENDING_FREE, PENDING_CLAIMED, PENDING_ARMED };

static struct {
    _Atomic int state;
    char path[ATOMIC_FILE_PATH_MAX];
} pending[PENDING_MAX];

static int pending_add(const char *path)
{
    for (int i = 0; i < PENDING_MAX; i++) {
        int expected = PENDING_FREE;
        if (atomic_compare_exchange_strong(&pending[i].state, &expected, PENDING_CLAIMED)) {
            snprintf(pending[i].path, sizeof pending[i].path, "%s", path);
            atomic_store(&pending[i].state, PENDING_ARMED);
            return i;
        }
    }
    return -1; /* more files at once than any tool opens: this one just has no net */
}

static void pending_remove(int slot)
{
    if (slot >= 0)
        atomic_store(&pending[slot].state, PENDING_FREE);
}

/* Async-signal-safe: it only calls write and unlink. */
static void on_signal(int number)
{
    static const char interrupted[] = "vkao: interrupted: the file in progress is not written\n";
    static const char terminated[] = "vkao: terminated: the file in progress is not written\n";
    /* Whoever closed the pipe does not listen. */
    const bool is_int = number == SIGINT;
    if (number != SIGPIPE && write(STDERR_FILENO, is_int ? interrupted : terminated,
                                   (is_int ? sizeof interrupted : sizeof terminated) - 1) < 0)
        errno = 0;
    for (int i = 0; i < PENDING_MAX; i++) {
        if (atomic_load(&pending[i].state) == PENDING_ARMED)
            unlink(pending[i].path);
    }
    _exit(128 + number);
}

void atomic_file_catch_signals(void)
{
    static const int numbers[] = {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE, SIGXCPU};
    struct sigaction action = {.sa_handler = on_signal};
    sigfillset(&action.sa_mask);
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        struct sigaction old;
        if (sigaction(numbers[i], NULL, &old) == 0 && old.sa_handler != SIG_IGN)
            sigaction(numbers[i], &action, NULL);
    }
    signal(SIGXFSZ, SIG_IGN);
}

/* "dir/" of "dir/name" and "" of "name": the length of the part up to the last slash. */
static size_t directory_length(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? (size_t)(slash - path) + 1 : 0;
}

static bool too_long(const char *path, struct tool_error *err)
{
    return fail(err, EXIT_OUTPUT, "%.200s...: cannot create: path is too long", path);
}

static bool fail_dead_link(const struct atomic_file *file, int error, struct tool_error *err)
{
    if (error == ELOOP)
        fail(err, EXIT_OUTPUT, "%s: cannot create: it is a symbolic link that leads in a circle",
             file->path);
    else if (error == ENOENT || error == ENOTDIR)
        fail(err, EXIT_OUTPUT, "%s: cannot create: it is a symbolic link to %s, which is not there",
             file->path, file->target);
    else
        fail(err, EXIT_OUTPUT, "%s: cannot create: it is a symbolic link to %s: %s", file->path,
             file->target, strerror(error));
    return fail_hint(err, "remove the link, or name the file itself");
}

/* Follows symbolic links at the last component: a user who links his output to another disk wants
 * the file there. A link to nothing is refused: a file where nobody looks, or none, is what becomes
 * of a disk that is not mounted. */
static bool resolve_links(struct atomic_file *file, struct tool_error *err)
{
    char link[ATOMIC_FILE_PATH_MAX], joined[2 * ATOMIC_FILE_PATH_MAX];
    strcpy(file->target, file->path);
    for (int depth = 0; depth < 40; depth++) {
        ssize_t length = readlink(file->target, link, sizeof link - 1);
        if (length < 0 && depth > 0 && errno != EINVAL)
            return fail_dead_link(file, errno, err);
        if (length < 0)
            return true; /* not a link, or not there: creating it will tell */
        link[length] = '\0';
        size_t directory = link[0] == '/' ? 0 : directory_length(file->target);
        int joined_length =
            snprintf(joined, sizeof joined, "%.*s%s", (int)directory, file->target, link);
        if (joined_length < 0 || (size_t)joined_length >= sizeof file->target)
            return too_long(file->path, err);
        memcpy(file->target, joined, (size_t)joined_length + 1);
    }
    return fail_dead_link(file, ELOOP, err);
}

static bool fail_exists(const struct atomic_file *file, struct tool_error *err)
{
    fail(err, EXIT_OUTPUT, "%s: exists, not overwritten", file->path);
    return fail_hint(err, "name another file, or remove this one; vkao replaces it with "
                          "--overwrite always");
}

/* *mode becomes the permission bits to give the new file, or 0 for those of a newly created one. */
static bool check_target(const struct atomic_file *file, mode_t *mode, struct tool_error *err)
{
    struct stat status;
    size_t length = strlen(file->target);
    *mode = 0;
    if (length == 0 || file->target[length - 1] == '/')
        return fail(err, EXIT_OUTPUT, "%s: cannot create: not a file name", file->path);
    /* Usually ENOENT. Whatever else is wrong, creating the temporary file tells, but for a name too
     * long: that file's is shorter. */
    if (stat(file->target, &status) != 0)
        return errno != ENAMETOOLONG || fail(err, EXIT_OUTPUT, "%.200s...: cannot create: %s",
                                             file->path, strerror(ENAMETOOLONG));
    if (S_ISDIR(status.st_mode))
        return fail(err, EXIT_OUTPUT, "%s: cannot create: %s", file->path, strerror(EISDIR));
    if (!S_ISREG(status.st_mode)) {
        fail(err, EXIT_OUTPUT, "%s: cannot create: not a regular file", file->path);
        return fail_hint(err, "name a file; pipes and devices cannot be written atomically");
    }
    if (!file->replace)
        return fail_exists(file, err);
    /* A rename would not mind a write-protected file, but whoever protected it does. */
    if (access(file->target, W_OK) != 0)
        return fail(err, EXIT_OUTPUT, "%s: cannot replace: %s", file->path, strerror(errno));
    *mode = status.st_mode & 0777;
    return true;
}

static uint64_t random_number(void)
{
    uint64_t number = 0;
    if (getrandom(&number, sizeof number, GRND_NONBLOCK) != (ssize_t)sizeof number) {
        struct timespec now = {0};
        clock_gettime(CLOCK_REALTIME, &now); /* O_EXCL makes sure anyway */
        number = (uint64_t)now.tv_nsec * 0x9e3779b97f4a7c15u + (uint64_t)now.tv_sec;
    }
    return number;
}

/* Host and process id make leftovers of a crash attributable, and keep two machines apart on one
 * file server. */
static bool temp_name(struct atomic_file *file, struct tool_error *err)
{
    char host[65] = "localhost";
    size_t directory = directory_length(file->target);
    if (gethostname(host, sizeof host - 1) != 0)
        strcpy(host, "localhost");
    for (char *c = host; *c; c++) {
        if (*c == '/')
            *c = '_';
    }
    /* The name is cut so that the whole stays below the 255 bytes that file systems allow. */
    int length = snprintf(file->temp, sizeof file->temp, "%.*s.%.120s.vkao-%.64s-%ld-%016llx.tmp",
                          (int)directory, file->target, file->target + directory, host,
                          (long)getpid(), (unsigned long long)random_number());
    if (length < 0 || (size_t)length >= sizeof file->temp) {
        file->temp[0] = '\0';
        return too_long(file->path, err);
    }
    return true;
}

static bool fail_create(const struct atomic_file *file, int error, struct tool_error *err)
{
    fail(err, EXIT_OUTPUT, "%s: cannot create: %s", file->path, strerror(error));
    size_t directory = directory_length(file->target);
    struct stat status;
    char name[ATOMIC_FILE_PATH_MAX];
    snprintf(name, sizeof name, "%.*s", (int)directory, file->target);
    if (error == ENOENT && directory > 0 && stat(name, &status) == 0)
        fail_hint(err, "no file can be made in %s: name another directory", name);
    else if (error == ENOENT)
        fail_hint(err,
                  directory > 0 ? "make the directory %.*s first"
                                : "the working directory has been removed: change to another",
                  (int)directory, file->target);
    else if (error == EMFILE || error == ENFILE)
        fail_hint(err, "'ulimit -n' limits the files that may be open");
    return false;
}

static bool create_temp(struct atomic_file *file, struct tool_error *err)
{
    int error = EEXIST;
    for (int attempt = 0; attempt < 16 && error == EEXIST; attempt++) {
        if (!temp_name(file, err))
            return false;
        /* Listed before it exists, so that no signal finds it existing and unlisted. */
        file->slot = pending_add(file->temp);
        file->fd = open(file->temp, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (file->fd >= 0)
            return true;
        error = errno;
        pending_remove(file->slot);
        if (error == EINTR)
            error = EEXIST;
    }
    file->temp[0] = '\0';
    return fail_create(file, error, err);
}

static bool settle_target(struct atomic_file *file, const char *path, bool replace, mode_t *mode,
                          struct tool_error *err)
{
    memset(file, 0, sizeof *file);
    file->fd = -1;
    file->slot = -1;
    file->replace = replace;
    if (strlen(path) >= sizeof file->path)
        return too_long(path, err);
    strcpy(file->path, path);
    return resolve_links(file, err) && check_target(file, mode, err);
}

bool atomic_file_check(const char *path, struct tool_error *err)
{
    struct atomic_file file;
    mode_t mode;
    return settle_target(&file, path, true, &mode, err);
}

bool atomic_file_open(struct atomic_file *file, const char *path, bool replace,
                      struct tool_error *err)
{
    mode_t mode = 0;
    if (!settle_target(file, path, replace, &mode, err) || !create_temp(file, err))
        return false;
    if (mode)
        (void)!fchmod(file->fd, mode); /* some file systems have no permissions to keep */
    return true;
}

bool atomic_file_write(struct atomic_file *file, const void *data, size_t bytes,
                       struct tool_error *err)
{
    const char *from = data;
    while (bytes > 0) {
        ssize_t written = write(file->fd, from, bytes);
        if (written < 0 && errno == EINTR)
            continue;
        if (written <= 0) {
            int error = written < 0 ? errno : ENOSPC;
            fail(err, EXIT_OUTPUT, "%s: cannot write: %s", file->path, strerror(error));
            if (error == ENOSPC || error == EDQUOT)
                fail_hint(err, "free some space or choose another disk; nothing was left behind");
            else if (error == EFBIG)
                fail_hint(err, "'ulimit -f' or the file system limits the size of files; nothing "
                               "was left behind");
            return false;
        }
        from += written;
        bytes -= (size_t)written;
    }
    return true;
}

/* The file's data first: a rename that reaches the disk before it would leave an empty file after a
 * power cut. */
static bool sync_and_close(struct atomic_file *file, struct tool_error *err)
{
    int error = 0;
    if (fsync(file->fd) != 0 && errno != EINVAL && errno != ENOSYS)
        error = errno;
    /* Network file systems report a full disk or quota here at the latest. */
    if (close(file->fd) != 0 && errno != EINTR && !error)
        error = errno;
    file->fd = -1;
    if (error)
        return fail(err, EXIT_OUTPUT, "%s: cannot write: %s", file->path, strerror(error));
    return true;
}

/* 0, or errno; EEXIST if somebody else was faster. Not every file system knows every way. */
static int rename_unless_exists(const char *temp, const char *target)
{
    struct stat status;
#ifdef RENAME_NOREPLACE
    if (renameat2(AT_FDCWD, temp, AT_FDCWD, target, RENAME_NOREPLACE) == 0)
        return 0;
    if (errno != EINVAL && errno != ENOSYS && errno != ENOTSUP)
        return errno;
#endif
    if (link(temp, target) == 0) {
        unlink(temp);
        return 0;
    }
    if (errno != EPERM && errno != ENOSYS && errno != ENOTSUP && errno != EMLINK)
        return errno;
    /* Neither exists on, say, FAT over the network: a short race is the best there is. */
    if (lstat(target, &status) == 0)
        return EEXIST;
    return rename(temp, target) == 0 ? 0 : errno;
}

static void sync_directory(const char *target)
{
    char directory[ATOMIC_FILE_PATH_MAX];
    size_t length = directory_length(target);
    snprintf(directory, sizeof directory, "%.*s", (int)length, target);
    int fd = open(length ? directory : ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (fd >= 0) {
        /* The file is there, whole and synced; only a power cut in the next seconds could still
         * undo the rename, so a directory that cannot be synced is no reason to report a failure.
         * */
        (void)fsync(fd);
        close(fd);
    }
}

bool atomic_file_commit(struct atomic_file *file, struct tool_error *err)
{
    int error;
    if (!sync_and_close(file, err)) {
        atomic_file_abort(file);
        return false;
    }
    if (file->replace)
        error = rename(file->temp, file->target) == 0 ? 0 : errno;
    else
        error = rename_unless_exists(file->temp, file->target);
    if (error) {
        if (error == EEXIST && !file->replace)
            fail_exists(file, err);
        else
            fail(err, EXIT_OUTPUT, "%s: cannot rename: %s", file->path, strerror(error));
        atomic_file_abort(file);
        return false;
    }
    pending_remove(file->slot);
    file->slot = -1;
    file->temp[0] = '\0';
    sync_directory(file->target);
    return true;
}

void atomic_file_abort(struct atomic_file *file)
{
    if (!file->temp[0])
        return;
    if (file->fd >= 0)
        close(file->fd);
    file->fd = -1;
    unlink(file->temp);
    pending_remove(file->slot);
    file->slot = -1;
    file->temp[0] = '\0';
}

size_t atomic_files_commit(struct atomic_file *files, size_t count, struct tool_error *err)
{
    size_t done = 0;
    while (done < count && atomic_file_commit(&files[done], err))
        done++;
    return done;
}

void atomic_files_withdraw(const struct atomic_file *files, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (!files[i].replace)
            unlink(files[i].target);
}
