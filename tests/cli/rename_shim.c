/* SPDX-License-Identifier: MIT
 *
 * Preloaded, it ends the process before its n-th rename of a temporary file, n being VKAO_KILL_AT,
 * or stops it there until it is told to go on, n being VKAO_STOP_AT: as whoever ends a run, or
 * works on the same files, may, though hardly ever at the same place twice. */
#ifndef _GNU_SOURCE
#define _GNU_SOURCE
#endif
#include <dlfcn.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static atomic_int renames;

static void count(const char *from)
{
    const char *kill_at = getenv("VKAO_KILL_AT"), *stop_at = getenv("VKAO_STOP_AT");
    if (!strstr(from, ".vkao-"))
        return;
    const int number = atomic_fetch_add(&renames, 1) + 1;
    if (kill_at && number == atoi(kill_at))
        raise(SIGKILL);
    if (stop_at && number == atoi(stop_at))
        raise(SIGSTOP);
}

int rename(const char *from, const char *to)
{
    int (*next)(const char *, const char *);
    *(void **)&next = dlsym(RTLD_NEXT, "rename");
    count(from);
    return next(from, to);
}

int renameat2(int from_fd, const char *from, int to_fd, const char *to, unsigned flags)
{
    int (*next)(int, const char *, int, const char *, unsigned);
    *(void **)&next = dlsym(RTLD_NEXT, "renameat2");
    count(from);
    return next(from_fd, from, to_fd, to, flags);
}
