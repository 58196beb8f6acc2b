/* SPDX-License-Identifier: MIT */
#ifndef TOOLS_PARALLEL_H_
#define TOOLS_PARALLEL_H_

#include <stdint.h>

/* Calls job(data, i) once for each i < count, in as many threads as the machine has cores for, and
 * returns when all are done: a vkao_parallel_fn. user_data is not used. */
void parallel_run(void *user_data, uint32_t count, void (*job)(void *data, uint32_t i), void *data);

#endif
