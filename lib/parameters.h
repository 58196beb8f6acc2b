/* SPDX-License-Identifier: MIT
 *
 * The structs of vkao.h: their sizes, ranges and defaults. Pure. */
#ifndef VKAO_PARAMETERS_H_
#define VKAO_PARAMETERS_H_

#include "formats.h"
#include "log.h"

#include <stdbool.h>
#include <stddef.h>

/* Those that have a struct_size. */
enum vkao_struct {
    VKAO_STRUCT_CONTEXT_INFO,
    VKAO_STRUCT_EFFECT_INFO,
    VKAO_STRUCT_FRAME_INFO,
    VKAO_STRUCT_IMAGES,
    VKAO_STRUCT_VIEW,
    VKAO_STRUCT_PARAMS,
    VKAO_STRUCT_COUNT
};

/* "0x3 (SSAO | BLUR)" */
const char *vkao_stages_name(vkao_stage_flags stages, char buffer[VKAO_NAME_BYTES]);

/* The struct rule of vkao.h: copies src into dst, which has `known` bytes. least: what the first
 * 0.2 had. */
vkao_result vkao_import_sized(const struct vkao_logger *log, const char *name, const void *src,
                              void *dst, size_t least, size_t known);
vkao_result vkao_import(const struct vkao_logger *log, enum vkao_struct which, const char *name,
                        const void *src, void *dst);

/* The other way round: as many bytes of own as the caller's struct has, with its size. */
void vkao_export(const void *own, size_t own_size, void *out, uint32_t size);

/* Does the method read that member of vkao_effect_info or vkao_params? */
bool vkao_method_reads(vkao_ssao_method method, const char *name);

/* Import, check every range of the table, and put in defaults for zeros that stand for them. */
vkao_result vkao_effect_info_check(const struct vkao_logger *log, const vkao_effect_info *in,
                                   vkao_effect_info *out);
/* Says which settings of a checked effect are given, but not used. */
void vkao_effect_info_warn(const struct vkao_logger *log, const vkao_effect_info *effect);
vkao_result vkao_params_check(const struct vkao_logger *log, const vkao_params *in,
                              vkao_params *out);

#endif
