/* SPDX-License-Identifier: MIT
 *
 * Output files that appear whole or not at all: written under a temporary name beside their final
 * one, synced, and then renamed. Until the commit nobody sees them, and after any error nothing is
 * left. */
#ifndef VKAO_TOOLS_ATOMIC_FILE_H_
#define VKAO_TOOLS_ATOMIC_FILE_H_

#include "error.h"

#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { ATOMIC_FILE_PATH_MAX = 4096 }; /* bytes with the final zero, as PATH_MAX on Linux */

/* One file in progress. Zero-initialise it; do not copy it, since the signal handler may know its
 * address. Threads may each have their own. */
struct atomic_file {
    char path[ATOMIC_FILE_PATH_MAX];   /* as the user gave it: what messages name */
    char target[ATOMIC_FILE_PATH_MAX]; /* path, or what the symbolic link at path names */
    char temp[ATOMIC_FILE_PATH_MAX];   /* "" once there is no temporary file any more */
    int fd;                            /* open for reading and writing; check every write */
    bool replace;
    int slot; /* place in the list of pending files, < 0 if none */
};

/* Whether a file can be at path, in place of one that is there: no directory, no pipe, no symbolic
 * link to nothing. Asked before any work. Errors: EXIT_OUTPUT. */
bool atomic_file_check(const char *path, struct tool_error *err);
/* Creates the temporary file (mode 0666 less the umask). With replace an existing path is replaced
 * at the commit (permission bits are kept); without it an existing path is an error, now or at the
 * commit. Directories, devices, pipes and symbolic links to nothing are always an error. Errors:
 * EXIT_OUTPUT. On failure there is nothing to abort, though aborting does no harm. */
bool atomic_file_open(struct atomic_file *file, const char *path, bool replace,
                      struct tool_error *err);
/* Writes all bytes to fd or fails with EXIT_OUTPUT and the system's reason. */
bool atomic_file_write(struct atomic_file *file, const void *data, size_t bytes,
                       struct tool_error *err);
/* Syncs, closes and renames. Whatever fails, the temporary file is gone afterwards. */
bool atomic_file_commit(struct atomic_file *file, struct tool_error *err);
/* Closes and removes the temporary file. Harmless on a zeroed, failed, committed or aborted file.
 * */
void atomic_file_abort(struct atomic_file *file);
/* Commits one after another until one fails: how many there are then. */
size_t atomic_files_commit(struct atomic_file *files, size_t count, struct tool_error *err);
/* Removes those of the committed files that were not there before. */
void atomic_files_withdraw(const struct atomic_file *files, size_t count);
/* For main(): signals that end the process remove the temporary files of all threads first, and its
 * exit code is 128 + number. A limit of file sizes (ulimit -f) becomes an error of
 * atomic_file_write. What is ignored already, as nohup and shells do, stays ignored. */
void atomic_file_catch_signals(void);

#ifdef __cplusplus
}
#endif
#endif
