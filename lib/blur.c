/* SPDX-License-Identifier: MIT */
#include "stages.h"

#include "vkao_blur.h"
#include "vkao_blur_last.h"
#include "vkao_upsample.h"

#include <math.h>

#define READS_SURFACE VKAO_READS(VIEW_Z, VIEW_Z), VKAO_READS(NORMALS, NORMALS)
#define WRITES_RESULT VKAO_WRITES(AO_WRITE, AO), VKAO_WRITES(BENT_WRITE, BENT_NORMALS)

static const struct vkao_pass horizontal = {
    .name = "vkao blur x",
    .label = "blur",
    .stage = VKAO_STAGE_BLUR,
    VKAO_CODE(vkao_blur),
    .uses = {READS_SURFACE, VKAO_READS(SOURCE, AO_NOISY), VKAO_WRITES(TARGET, HALFWAY)},
    .area = VKAO_AREA_ABOVE_BELOW,
    VKAO_ONE_TEXEL,
    .forms = 1,
};

static const struct vkao_pass vertical = {
    .name = "vkao blur y",
    .label = "blur",
    .stage = VKAO_STAGE_BLUR,
    VKAO_CODE(vkao_blur_last),
    .uses = {READS_SURFACE, VKAO_READS(SOURCE, HALFWAY), WRITES_RESULT},
    .area = VKAO_AREA_RECT,
    VKAO_ONE_TEXEL,
    .vertical = true,
    .forms = 2,
};

static const struct vkao_pass vertical_at_half = {
    .name = "vkao blur y",
    .label = "blur",
    .stage = VKAO_STAGE_BLUR,
    VKAO_CODE(vkao_blur),
    .uses = {READS_SURFACE, VKAO_READS(SOURCE, HALFWAY), VKAO_WRITES(TARGET, BLURRED)},
    .area = VKAO_AREA_RECT,
    VKAO_ONE_TEXEL,
    .vertical = true,
    .forms = 1,
};

static const struct vkao_pass upsample = {
    .name = "vkao upsample",
    .label = "upsample",
    .stage = VKAO_STAGE_BLUR,
    VKAO_CODE(vkao_upsample),
    .uses = {VKAO_READS(DEPTH, DEPTH), READS_SURFACE, VKAO_READS(SOURCE, BLURRED), WRITES_RESULT},
    .area = VKAO_AREA_IMAGE_RECT,
    VKAO_ONE_TEXEL,
    .forms = 2,
};

void vkao_blur_plan(struct vkao_program *program)
{
    vkao_program_add(program, &horizontal);
    vkao_program_add(program, program->settings.half_resolution ? &vertical_at_half : &vertical);
    if (program->settings.half_resolution)
        vkao_program_add(program, &upsample);
}

void vkao_blur_constants(const struct vkao_recording *r, const vkao_params *params,
                         struct vkao_constants *out)
{
    (void)r;
    /* Devices may take denormal numbers for 0, and no power of 0 is that. */
    out->power = fmaxf(params->power, 1e-30f);
}
