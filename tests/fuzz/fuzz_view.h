/* SPDX-License-Identifier: MIT
 *
 * What the tools make of an input is never what the library refuses: that would be exit status
 * 70. */
#ifndef VKAO_TESTS_FUZZ_VIEW_H_
#define VKAO_TESTS_FUZZ_VIEW_H_

#include "gbuffer.h"
#include "setting.h"

struct fuzz_job {
    uint32_t width, height;
    const struct ao_view *view;
    const struct setting *setting; /* NULL = defaults */
};
/* Breaks a promise unless the library records all stages of the job, over a driver that computes
 * nothing. */
void fuzz_check_job(const struct fuzz_job *job);

/* What gbuffer.h promises of a loaded one. */
void fuzz_check_gbuffer(const struct gbuffer *gbuffer);

#endif
