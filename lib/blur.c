/* SPDX-License-Identifier: MIT */
#include "stages.h"

#include "vkao_blur.h"
#include "vkao_blur_last.h"
#include "vkao_blur_tile.h"
#include "vkao_blur_tile_last.h"
#include "vkao_upsample_quads.h"

#include <math.h>

#define READS_SURFACE VKAO_READS_VIEW_Z, VKAO_READS(NORMALS, NORMALS)
#define READS_NOISY VKAO_READS(SOURCE, AO_NOISY), VKAO_READS(BENT_SOURCE, BENT_CODES)
#define READS_HALFWAY VKAO_READS(SOURCE, HALFWAY), VKAO_READS(BENT_SOURCE, BENT_CODES)
#define WRITES_RESULT VKAO_WRITES(AO_WRITE, AO), VKAO_WRITES(BENT_WRITE, BENT_NORMALS)

static const struct vkao_pass horizontal = {
    .name = "vkao blur x",
    .label = "blur",
    .stage = VKAO_STAGE_BLUR,
    VKAO_CODE(vkao_blur),
    .uses = {READS_SURFACE, READS_NOISY, VKAO_WRITES(TARGET, HALFWAY)},
    .area = VKAO_AREA_ABOVE_BELOW,
    VKAO_ONE_TEXEL,
    .forms = 1,
};

static const struct vkao_pass vertical = {
    .name = "vkao blur y",
    .label = "blur",
    .stage = VKAO_STAGE_BLUR,
    VKAO_CODE(vkao_blur_last),
    .uses = {READS_SURFACE, READS_HALFWAY, WRITES_RESULT},
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
    .uses = {READS_SURFACE, READS_HALFWAY, VKAO_WRITES(TARGET, BLURRED)},
    .area = VKAO_AREA_RECT,
    VKAO_ONE_TEXEL,
    .vertical = true,
    .forms = 1,
};

/* Both directions at once. */
#define TILES(words, is_half, code, ...)                                                           \
    {                                                                                              \
        .name = "vkao blur", .label = "blur", .stage = VKAO_STAGE_BLUR, VKAO_CODE(code),           \
        .uses = {READS_SURFACE, READS_NOISY, __VA_ARGS__}, .area = VKAO_AREA_RECT,                 \
        .texels = {1,                                                                              \
                   (VKAO_BLUR_TILE_ROWS(words) - 2 * (VKAO_BLUR_TILE_RADIUS + 1)) / ROWS_AT_ONCE}, \
        .group = {VKAO_BLUR_TILE_WIDTH, ROWS_AT_ONCE}, .forms = (is_half) ? 1 : 2,                 \
    }
#define TILES_OF(words)                                                                            \
    {                                                                                              \
        TILES(words, 0, vkao_blur_tile_last, WRITES_RESULT),                                       \
            TILES(words, 1, vkao_blur_tile, VKAO_WRITES(TARGET, BLURRED)),                         \
    }
enum { ROWS_AT_ONCE = VKAO_BLUR_TILE_THREADS / VKAO_BLUR_TILE_WIDTH };
/* By vkao_blur_tile_words and half resolution. */
static const struct vkao_pass tiles[][2] = {
    [2] = TILES_OF(2), [3] = TILES_OF(3), [5] = TILES_OF(5)};

static const struct vkao_pass upsample = {
    .name = "vkao upsample",
    .label = "upsample",
    .stage = VKAO_STAGE_BLUR,
    VKAO_CODE(vkao_upsample_quads),
    .uses = {VKAO_READS(DEPTH, DEPTH), READS_SURFACE, VKAO_READS(SOURCE, BLURRED), WRITES_RESULT},
    .area = VKAO_AREA_IMAGE_RECT,
    .texels = {2, 2},
    .group = {VKAO_GROUP_WIDTH, VKAO_GROUP_HEIGHT},
    .on_rows = true,
    .forms = 2,
};

void vkao_blur_plan(struct vkao_program *program)
{
    const vkao_effect_info *e = &program->settings;
    if (e->blur_radius <= VKAO_BLUR_TILE_RADIUS) {
        vkao_program_add(program, &tiles[vkao_blur_tile_words(e)][e->half_resolution]);
    } else {
        vkao_program_add(program, &horizontal);
        vkao_program_add(program, e->half_resolution ? &vertical_at_half : &vertical);
    }
    if (e->half_resolution)
        vkao_program_add(program, &upsample);
}

uint32_t vkao_blur_tile_words(const vkao_effect_info *effect)
{
    const bool has_normals =
        effect->blur_normal_power > 0.0f && effect->normal_encoding != VKAO_NORMALS_FROM_DEPTH;
    return 2u + has_normals + effect->bent_normals * (has_normals ? 2u : 1u);
}

void vkao_blur_constants(const struct vkao_recording *r, const vkao_params *params,
                         struct vkao_constants *out)
{
    (void)r;
    /* Devices may take denormal numbers for 0, and no power of 0 is that. */
    out->power = fmaxf(params->power, 1e-30f);
}
