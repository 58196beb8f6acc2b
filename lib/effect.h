/* SPDX-License-Identifier: MIT */
#ifndef VKAO_EFFECT_H_
#define VKAO_EFFECT_H_

#include "passes.h"

struct vkao_effect {
    struct vkao_program program;
    /* Frames that live, and the passes that they may complete; pointers, so that effects can be
     * const. */
    atomic_uint *frames, frame_count;
    struct vkao_program *passes;
};

/* The rows for checked settings, not compiled. is_cpu: those of the CPU. */
void vkao_program_plan(struct vkao_program *program, const vkao_context *ctx,
                       const vkao_effect_info *settings, bool is_cpu);

#endif
