/* SPDX-License-Identifier: MIT */
#include "stages.h"

#include "vkao_composite.h"
#include "vkao_debug.h"

#include <assert.h>
#include <math.h>
#include <string.h>

static_assert(VKAO_GLSL_COMPOSITE_MULTIPLY == (int)VKAO_COMPOSITE_MULTIPLY &&
                  VKAO_GLSL_COMPOSITE_INDIRECT == (int)VKAO_COMPOSITE_INDIRECT &&
                  VKAO_GLSL_COMPOSITE_AO_ONLY == (int)VKAO_COMPOSITE_AO_ONLY &&
                  VKAO_GLSL_COMPOSITE_NOISY_AO == (int)VKAO_COMPOSITE_NOISY_AO &&
                  VKAO_GLSL_COMPOSITE_NORMALS == (int)VKAO_COMPOSITE_NORMALS &&
                  VKAO_GLSL_COMPOSITE_BENT_NORMALS == (int)VKAO_COMPOSITE_BENT_NORMALS &&
                  VKAO_GLSL_COMPOSITE_VIEW_Z == (int)VKAO_COMPOSITE_VIEW_Z,
              "params.h repeats vkao_composite_mode");
static_assert(VKAO_GLSL_SPECULAR_NONE == (int)VKAO_SPECULAR_NONE &&
                  VKAO_GLSL_SPECULAR_FROM_AO == (int)VKAO_SPECULAR_FROM_AO,
              "params.h repeats vkao_specular");

static const struct vkao_pass composite = {
    .name = "vkao composite",
    .label = "composite",
    .stage = VKAO_STAGE_COMPOSITE,
    VKAO_CODE(vkao_composite),
    .uses = {VKAO_READS(SOURCE, AO), VKAO_READS(COLOR, COLOR), VKAO_READS(DIRECT, DIRECT),
             VKAO_READS(ALBEDO, ALBEDO), VKAO_READS(SPECULAR, SPECULAR),
             VKAO_READS(NORMALS, NORMALS), VKAO_READS(BENT_READ, BENT_NORMALS),
             VKAO_WRITES(OUTPUT, OUTPUT)},
    .area = VKAO_AREA_IMAGE_RECT,
    VKAO_ONE_TEXEL,
    .forms = 1,
};

static const struct vkao_pass debug = {
    .name = "vkao debug view",
    .label = "composite",
    .stage = VKAO_STAGE_COMPOSITE,
    VKAO_CODE(vkao_debug),
    .uses = {VKAO_READS_VIEW_Z, VKAO_READS(NORMALS, NORMALS), VKAO_READS(SOURCE, AO_NOISY),
             VKAO_READS(BENT_READ, BENT_NORMALS), VKAO_WRITES(OUTPUT, OUTPUT)},
    .area = VKAO_AREA_IMAGE_RECT,
    VKAO_ONE_TEXEL,
    .forms = 1,
};

void vkao_composite_plan(struct vkao_program *program)
{
    const bool is_debug = program->settings.composite_mode > VKAO_COMPOSITE_AO_ONLY;
    vkao_program_add(program, is_debug ? &debug : &composite);
}

void vkao_composite_constants(const struct vkao_recording *r, const vkao_params *params,
                              struct vkao_constants *out)
{
    (void)r;
    memcpy(out->tint, params->tint, sizeof params->tint);
    out->debug_distance = fmaxf(params->debug_distance, (float)VKAO_NEAREST_Z);
}
