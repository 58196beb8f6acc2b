/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE /* CPU_COUNT */
#include "parallel.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>

enum { MAX_THREADS = 16 };

struct work {
    void (*job)(void *data, uint32_t i);
    void *data;
    uint32_t count;
    atomic_uint next;
};

static void *run(void *argument)
{
    struct work *work = argument;
    for (uint32_t i; (i = atomic_fetch_add(&work->next, 1)) < work->count;)
        work->job(work->data, i);
    return NULL;
}

/* Those that this process may run on. */
static uint32_t core_count(void)
{
    cpu_set_t set;
    return sched_getaffinity(0, sizeof set, &set) == 0 ? (uint32_t)CPU_COUNT(&set) : 1;
}

void parallel_run(void *user_data, uint32_t count, void (*job)(void *data, uint32_t i), void *data)
{
    struct work work = {job, data, count, 0};
    pthread_t threads[MAX_THREADS];
    uint32_t cores = core_count(), started = 0;
    (void)user_data;
    /* This thread works too, alone if no other can be had. */
    while (started + 1 < cores && started + 1 < count && started < MAX_THREADS &&
           pthread_create(&threads[started], NULL, run, &work) == 0)
        ++started;
    run(&work);
    for (uint32_t i = 0; i < started; ++i)
        pthread_join(threads[i], NULL);
}
