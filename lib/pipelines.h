/* SPDX-License-Identifier: MIT
 *
 * What a device compiles of rows. Effects of one context share those that they want alike: effects
 * differ in few of their passes, and a driver takes milliseconds to seconds for each. */
#ifndef VKAO_PIPELINES_H_
#define VKAO_PIPELINES_H_

#include "passes.h"

/* A row, compiled. */
struct vkao_pipelines {
    const struct vkao_pass *row; /* what an effect puts in place of its uses are images too */
    bool is_cpu;                 /* the effect runs on the CPU's passes: which forms come first */
    /* Bits of the settings that the shader declares, and of those of them that it uses. */
    uint32_t declared, used;
    uint32_t constants[VKAO_SETTING_COUNT];
    VkSampler nearest; /* if the row names it; its coordinates are texels */
    VkDescriptorSetLayout set_layout;
    VkPipelineLayout layout;
    _Atomic(VkPipeline) forms[VKAO_MOST_FORMS]; /* those that some frame may need; others are 0 */
    uint32_t users;                             /* steps of effects */
    struct vkao_pipelines *next;
};

/* Layouts and pipelines of all rows. On failure the rest is for vkao_program_destroy. */
vkao_result vkao_program_compile(struct vkao_program *program);
/* Of all rows the form, VKAO_FORM_*, where it is still missing, and on a GPU that with a tone too;
 * vkao_program_compile begins with COPIED. Any number of threads at a time. */
vkao_result vkao_program_complete(struct vkao_program *program, uint32_t form);
void vkao_program_destroy(struct vkao_program *program);

#endif
