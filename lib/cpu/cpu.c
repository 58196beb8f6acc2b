/* SPDX-License-Identifier: MIT */
#include "cpu.h"

#include "recording.h"
#include "stages.h"

#include "cpu/layout.h"

#include "vkao_blur_cpu.h"
#include "vkao_blur_last_cpu.h"
#include "vkao_debug_cpu.h"
#include "vkao_packed_blur_x_cpu.h"
#include "vkao_packed_blur_y_cpu.h"
#include "vkao_packed_breaks_x_cpu.h"
#include "vkao_packed_breaks_y_cpu.h"
#include "vkao_packed_prepare_cpu.h"
#include "vkao_packed_ring_normals_cpu.h"
#include "vkao_packed_width_cpu.h"
#include "vkao_packed_ssao_gtao_16bit_cpu.h"
#include "vkao_packed_ssao_gtao_cpu.h"
#include "vkao_packed_ssao_hbao_16bit_cpu.h"
#include "vkao_packed_ssao_hbao_cpu.h"
#include "vkao_packed_ssao_hemisphere_16bit_cpu.h"
#include "vkao_packed_ssao_hemisphere_cpu.h"
#include "vkao_packed_ssao_vbao_16bit_cpu.h"
#include "vkao_packed_ssao_vbao_cpu.h"
#include "vkao_packed_tiles_cpu.h"
#include "vkao_packed_upsample_cpu.h"
#include "vkao_ssao_raymarch_cpu.h"
#include "vkao_ssao_sphere_cpu.h"
#include "vkao_upsample_cpu.h"

#include <assert.h>

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

static_assert(VKAO_PART_END == (int)VKAO_RESOURCE_COUNT, "as passes.h counts");
static_assert(VKAO_BINDING_Z == VKAO_BINDING_CPU, "the CPU's bindings come last");

#define PART(name, part, does_write, format)                                                       \
    {                                                                                              \
        VKAO_BINDING_##name, (enum vkao_resource)VKAO_PART_##part, does_write, VK_FORMAT_##format  \
    }
#define READS_TEXELS(name, part, format) PART(name, part, false, format)
#define WRITES_TEXELS(name, part, format) PART(name, part, true, format)
#define READS_WORDS(name, part) PART(name, part, false, UNDEFINED)
#define WRITES_WORDS(name, part) PART(name, part, true, UNDEFINED)
#define READS_Z READS_TEXELS(Z, Z, R32_SFLOAT)
#define READS_Z4 READS_TEXELS(Z4, Z, R32G32B32A32_SFLOAT)
#define READS_DEPTH VKAO_READS(DEPTH, DEPTH), VKAO_READS(NEAREST, SAMPLER)
#define READS_NORMALS VKAO_READS(NORMALS, NORMALS)
#define READS_RING_NORMALS READS_TEXELS(RING_NORMALS_READ4, RING_NORMALS, R32G32B32A32_UINT)
#define READS_BENT_CODES VKAO_READS(BENT_SOURCE, BENT_CODES)
#define WRITES_NOISY VKAO_WRITES(TARGET, AO_NOISY), VKAO_WRITES(BENT_TARGET, BENT_CODES)

/* --- Recording --- */

static void record_prepare(const struct vkao_recording *r, uint32_t pass)
{
    const struct vkao_rect valid = r->grid.valid;
    struct vkao_dispatch push;
    vkao_rect_pack(valid, push.rect);
    vkao_bind(r, pass, &push, sizeof push);
    /* As many texels as it writes, border and padding included, moved to begin at 0. */
    vkao_dispatch(
        r, pass,
        (struct vkao_rect){0, 0,
                           valid.x1 - valid.x0 + valid.x0 % VKAO_BLUR_X_WIDTH + 2 * VKAO_BUFFER_PAD,
                           valid.y1 - valid.y0 + 2 * VKAO_VIEW_Z_BORDER});
}

static VkDeviceSize part_offset(const struct vkao_recording *r, int part)
{
    return r->frame->scratch.blocks[part].offset;
}

/* Where SSAO, the next pass, has work to do, into the list that its dispatch reads. */
static void record_tiles(const struct vkao_recording *r, uint32_t pass)
{
    static_assert(VKAO_STRIP_TEXELS % (VKAO_ROW_GROUP_WIDTH * VKAO_SSAO_TEXELS) == 0,
                  "strips are of whole tiles");
    static_assert(sizeof(struct vkao_tiling) <= VKAO_PUSH_BYTES &&
                      sizeof(struct vkao_strip) <= VKAO_PUSH_BYTES,
                  "push constants of every pass have the same range");
    const struct vkao_pass *ssao = r->frame->program->steps[pass + 1].row;
    const struct vkao_rect rect = vkao_area(r, ssao->area);
    const uint32_t width = ssao->texels.width * ssao->group.width;
    const uint32_t x0 = rect.x0 - rect.x0 % 4, rows = rect.y1 - rect.y0,
                   columns = (rect.x1 - x0 + width - 1) / width;
    uint32_t height = VKAO_TILE_HEIGHT;
    /* maxComputeWorkGroupCount of an indirect dispatch's y, which is the count of tiles */
    while (columns * ((rows + height - 1) / height) > VKAO_MOST_TILES)
        height *= 2;
    struct vkao_tiling push = {
        .tiles = {columns, (rows + height - 1) / height},
        .tile_width = width,
        .tile_height = height,
        .strip_columns = VKAO_STRIP_TEXELS / width,
    };
    vkao_rect_pack(rect, push.rect);
    const struct vkao_tiles_head none = {.group_rows = height, .one = 1};
    vkao_barrier(r, VKAO_SHADERS, VKAO_TRANSFER);
    r->frame->ctx->vk.CmdUpdateBuffer(r->cmd, r->frame->scratch.buffer,
                                      part_offset(r, VKAO_PART_TILES), sizeof none, &none);
    vkao_barrier(r, VKAO_TRANSFER, VKAO_SHADERS);
    vkao_bind(r, pass, &push, sizeof push);
    vkao_dispatch(r, pass, (struct vkao_rect){0, 0, push.tiles[0] * push.tiles[1], 1});
}

static void record_ssao(const struct vkao_recording *r, uint32_t pass)
{
    struct vkao_dispatch push;
    vkao_rect_pack(vkao_area(r, VKAO_AREA_AROUND), push.rect);
    vkao_barrier(r, VKAO_SHADERS, VKAO_INDIRECT); /* tiles wrote the list */
    vkao_bind(r, pass, &push, sizeof push);
    r->frame->ctx->vk.CmdDispatchIndirect(r->cmd, r->frame->scratch.buffer,
                                          part_offset(r, VKAO_PART_TILES));
}

/* Copied AO of a strip -> its image. Later vkao work, and whoever waits for it, sees the copy as
 * one of its writes. */
static void record_copy(const struct vkao_recording *r, struct vkao_rect strip)
{
    const vkao_frame *frame = r->frame;
    const VkBufferImageCopy region = {
        .bufferOffset = part_offset(r, VKAO_PART_COPIED) + strip.x0 * frame->rows.copied_texel,
        .bufferRowLength = frame->rows.copied_stride,
        .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
        .imageOffset = {(int32_t)strip.x0, (int32_t)strip.y0, 0},
        .imageExtent = {strip.x1 - strip.x0, strip.y1 - strip.y0, 1},
    };
    vkao_barrier(r, VKAO_SHADERS, VKAO_TRANSFER);
    frame->ctx->vk.CmdCopyBufferToImage(r->cmd, frame->scratch.buffer, frame->images.ao.image,
                                        VK_IMAGE_LAYOUT_GENERAL, 1, &region);
    vkao_barrier(r, VKAO_TRANSFER, VKAO_SHADERS);
}

static void record_part(const struct vkao_recording *r, uint32_t pass, uint32_t ring_row,
                        struct vkao_rect rect)
{
    struct vkao_strip push = {.ring_row = ring_row};
    vkao_rect_pack(rect, push.rect);
    vkao_bind(r, pass, &push, sizeof push);
    vkao_dispatch(r, pass, rect);
}

/* Does a pass of its own decode normals for both directions of the blur? */
static bool decodes_normals(const struct vkao_program *program)
{
    return program->is_packed && program->settings.blur_normal_power > 0.0f;
}

/* Rows of a strip into the ring. again: the strip before was read from it. */
static void record_strip_rows(const struct vkao_recording *r, uint32_t pass, uint32_t ring_row,
                              struct vkao_rect rows, bool again)
{
    const bool decodes = decodes_normals(r->frame->program);
    const struct vkao_rect around = vkao_area(r, VKAO_AREA_AROUND);
    if (again)
        vkao_barrier(r, VKAO_SHADERS, VKAO_SHADERS);
    if (decodes) {
        record_part(r, pass, ring_row, (struct vkao_rect){around.x0, rows.y0, around.x1, rows.y1});
        vkao_barrier(r, VKAO_SHADERS, VKAO_SHADERS); /* normals are in the ring */
    }
    record_part(r, decodes ? pass + 1 : pass, ring_row, rows);
    vkao_barrier(r, VKAO_SHADERS, VKAO_SHADERS); /* rows wrote the ring -> columns read it */
}

/* Both directions, down the image in strips, so that what lies between them fits a ring of rows.
 * Each strip adds the rows that the one before did not need. */
static void record_blur(const struct vkao_recording *r, uint32_t pass)
{
    static_assert(VKAO_STRIP_ROWS % VKAO_BLUR_Y_HEIGHT == 0 &&
                      VKAO_RING_ROWS >= VKAO_STRIP_ROWS + 2 * VKAO_BUFFER_PAD,
                  "a ring holds a strip and the largest radius around it");
    const vkao_effect_info *e = &r->frame->program->settings;
    const uint32_t ring = VKAO_RING_ROWS, radius = e->blur_radius;
    const uint32_t columns = decodes_normals(r->frame->program) ? pass + 2 : pass + 1;
    const struct vkao_rect rect = r->grid.rect;
    struct vkao_rect halfway = vkao_area(r, VKAO_AREA_ABOVE_BELOW), strip = rect;
    const uint32_t last = halfway.y1;
    for (; strip.y0 < rect.y1; strip.y0 = strip.y1) {
        const uint32_t left = rect.y1 - strip.y0;
        strip.y1 = strip.y0 + (left < VKAO_STRIP_ROWS ? left : VKAO_STRIP_ROWS);
        halfway.y1 = strip.y1 + radius < last ? strip.y1 + radius : last;
        /* Not below the first row that the strip reads, which may lie before row 0. */
        const uint32_t ring_row = (strip.y0 + ring - radius) / ring * ring - ring;
        if (halfway.y0 < halfway.y1) /* else the strip before has added all that there is */
            record_strip_rows(r, pass, ring_row, halfway, strip.y0 > rect.y0);
        record_part(r, columns, ring_row, strip);
        if (r->frame->copies && !e->half_resolution)
            record_copy(r, strip);
        halfway.y0 = halfway.y1;
    }
}

static void record_rows(const struct vkao_recording *r, uint32_t pass)
{
    if (!decodes_normals(r->frame->program)) /* else their pass has recorded it */
        record_blur(r, pass);
}

/* record_blur has recorded it. */
static void record_nothing(const struct vkao_recording *r, uint32_t pass)
{
    (void)r;
    (void)pass;
}

static void record_upsample(const struct vkao_recording *r, uint32_t pass)
{
    const struct vkao_rect rect = r->image.rect;
    const uint32_t height = r->frame->copies ? VKAO_STRIP_ROWS : rect.y1 - rect.y0;
    for (struct vkao_rect strip = rect; strip.y0 < rect.y1; strip.y0 = strip.y1) {
        strip.y1 = rect.y1 - strip.y0 > height ? strip.y0 + height : rect.y1;
        struct vkao_dispatch push;
        vkao_rect_pack(strip, push.rect);
        vkao_bind(r, pass, &push, sizeof push);
        /* Invocations of more than one row begin at rows of half resolution. */
        struct vkao_rect rows = strip;
        rows.y0 -= rows.y0 % VKAO_UPSAMPLE_HEIGHT;
        vkao_dispatch(r, pass, rows);
        if (r->frame->copies)
            record_copy(r, strip);
    }
}

/* --- Rows --- */

#define TEXELS(width, height) .texels = {width, height}, .group = {VKAO_GROUP_OF(width), 1}
#define ROW_GROUP .group = {VKAO_ROW_GROUP_WIDTH, 1}

static const struct vkao_pass prepare = {
    .name = "vkao prepare",
    .label = "prepare",
    .stage = VKAO_STAGE_PREPARE,
    VKAO_CODE(vkao_packed_prepare_cpu),
    .uses = {READS_DEPTH, WRITES_WORDS(Z_WORDS, Z)},
    .area = VKAO_AREA_VALID,
    TEXELS(VKAO_PREPARE_WIDTH, VKAO_PREPARE_HEIGHT),
    .forms = 1,
    .record = record_prepare,
};

#define BREAKS(axis, part, width, height)                                                          \
    {                                                                                              \
        .name = "vkao breaks " #axis, .label = "prepare", .stage = VKAO_STAGE_PREPARE,             \
        VKAO_CODE(vkao_packed_breaks_##axis##_cpu),                                                \
        .uses = {READS_Z4, WRITES_WORDS(BREAKS_WORDS, part)}, TEXELS(width, height), .forms = 1,   \
        .record = record_prepare,                                                                  \
    }
static const struct vkao_pass breaks_x = BREAKS(x, BREAKS_X, 32, 1),
                              breaks_y = BREAKS(y, BREAKS_Y, VKAO_PREPARE_WIDTH, 32);

static_assert(32 % VKAO_WIDTH_HEIGHT == 0, "no rows of an invocation are of two words");
static const struct vkao_pass width = {
    .name = "vkao width",
    .label = "prepare",
    .stage = VKAO_STAGE_PREPARE,
    VKAO_CODE(vkao_packed_width_cpu),
    .uses = {READS_TEXELS(BREAKS_X_READ, BREAKS_X, R32_UINT),
             READS_TEXELS(BREAKS_Y_READ4, BREAKS_Y, R32G32B32A32_UINT), READS_Z4,
             WRITES_WORDS(Z_WORDS, Z)},
    TEXELS(VKAO_PREPARE_WIDTH, VKAO_WIDTH_HEIGHT),
    .forms = 1,
    .record = record_prepare,
};

static const struct vkao_pass tiles = {
    .name = "vkao tiles",
    .label = "ssao",
    .stage = VKAO_STAGE_SSAO,
    VKAO_CODE(vkao_packed_tiles_cpu),
    .uses = {READS_Z4, WRITES_WORDS(PACKED_WORDS, PACKED), WRITES_WORDS(TILES, TILES),
             WRITES_NOISY},
    .texels = {1, 1},
    ROW_GROUP,
    .forms = 1,
    .record = record_tiles,
};

#define METHOD(method, words, width, codes)                                                        \
    {                                                                                              \
        .name = "vkao ssao " #method, .label = "ssao", .stage = VKAO_STAGE_SSAO, VKAO_CODE(words), \
        .uses = {READS_Z,                                                                          \
                 READS_NORMALS,                                                                    \
                 VKAO_READS(SECOND_Z, SECOND_Z),                                                   \
                 WRITES_NOISY,                                                                     \
                 READS_WORDS(TILES, TILES),                                                        \
                 WRITES_TEXELS(PACKED_WRITE, PACKED, codes)},                                      \
        .area = VKAO_AREA_AROUND, .texels = {width, 1}, ROW_GROUP, .forms = 1,                     \
        .record = record_ssao,                                                                     \
    }
#define PAIRED_METHOD(method)                                                                      \
    METHOD(method, vkao_packed_ssao_##method##_cpu, VKAO_SSAO_TEXELS, R16_UINT)
static const struct vkao_pass methods[] = {
    [VKAO_SSAO_SPHERE] = METHOD(sphere, vkao_ssao_sphere_cpu, 1, R8_UINT),
    [VKAO_SSAO_HEMISPHERE] = PAIRED_METHOD(hemisphere),
    [VKAO_SSAO_HBAO] = PAIRED_METHOD(hbao),
    [VKAO_SSAO_GTAO] = PAIRED_METHOD(gtao),
    [VKAO_SSAO_VBAO] = PAIRED_METHOD(vbao),
    [VKAO_SSAO_RAYMARCH] = METHOD(raymarch, vkao_ssao_raymarch_cpu, 1, R8_UINT),
};

/* The same, with codes of two texels in one store. */
#define METHOD_16BIT(method)                                                                       \
    {                                                                                              \
        .name = "vkao ssao " #method, .label = "ssao", .stage = VKAO_STAGE_SSAO,                   \
        VKAO_CODE(vkao_packed_ssao_##method##_16bit_cpu),                                          \
        .uses = {READS_Z, READS_NORMALS, WRITES_NOISY, READS_WORDS(TILES, TILES),                  \
                 WRITES_WORDS(PACKED_WORDS, PACKED)},                                              \
        .area = VKAO_AREA_AROUND, .texels = {VKAO_SSAO_TEXELS, 1}, ROW_GROUP, .forms = 1,          \
        .record = record_ssao,                                                                     \
    }
static const struct vkao_pass methods_16bit[] = {
    [VKAO_SSAO_HEMISPHERE] = METHOD_16BIT(hemisphere),
    [VKAO_SSAO_HBAO] = METHOD_16BIT(hbao),
    [VKAO_SSAO_GTAO] = METHOD_16BIT(gtao),
    [VKAO_SSAO_VBAO] = METHOD_16BIT(vbao),
};

static const struct vkao_pass ring_normals = {
    .name = "vkao ring normals",
    .label = "blur",
    .stage = VKAO_STAGE_BLUR,
    VKAO_CODE(vkao_packed_ring_normals_cpu),
    .uses = {READS_NORMALS, WRITES_WORDS(RING_NORMALS_WORDS, RING_NORMALS)},
    TEXELS(4, 1),
    .with_next = true,
    .forms = 1,
    .record = record_blur,
};

static const struct vkao_pass packed_blur_x = {
    .name = "vkao blur x",
    .label = "blur",
    .stage = VKAO_STAGE_BLUR,
    VKAO_CODE(vkao_packed_blur_x_cpu),
    .uses = {READS_Z4, READS_RING_NORMALS, READS_TEXELS(PACKED_READ4, PACKED, R32_UINT),
             WRITES_WORDS(HALFWAY_WORDS, HALFWAY)},
    TEXELS(VKAO_BLUR_X_WIDTH, 1),
    .with_next = true,
    .forms = 1,
    .record = record_rows,
};

#define PACKED_BLUR_Y(is_half)                                                                     \
    {                                                                                              \
        .name = "vkao blur y", .label = "blur", .stage = VKAO_STAGE_BLUR,                          \
        VKAO_CODE(vkao_packed_blur_y_cpu),                                                         \
        .uses = {READS_Z4,                                                                         \
                 READS_TEXELS(HALFWAY_READ2, HALFWAY, R32_UINT),                                   \
                 READS_RING_NORMALS,                                                               \
                 WRITES_WORDS(BLURRED_WORDS, BLURRED),                                             \
                 WRITES_WORDS(STAGED_WORDS, COPIED),                                               \
                 VKAO_WRITES(AO_WRITE, AO)},                                                       \
        TEXELS(VKAO_BLUR_Y_WIDTH, VKAO_BLUR_Y_HEIGHT), .vertical = true,                           \
        .forms = (is_half) ? 1 : 4, .record = record_nothing,                                      \
    }
/* By half resolution. */
static const struct vkao_pass packed_blur_y[] = {PACKED_BLUR_Y(0), PACKED_BLUR_Y(1)};

static const struct vkao_pass packed_upsample = {
    .name = "vkao upsample",
    .label = "upsample",
    .stage = VKAO_STAGE_BLUR,
    VKAO_CODE(vkao_packed_upsample_cpu),
    .uses = {READS_DEPTH, READS_Z, READS_Z4, READS_NORMALS,
             READS_TEXELS(BLURRED_READ2, BLURRED, R32_UINT), WRITES_WORDS(STAGED_WORDS, COPIED),
             VKAO_WRITES(AO_WRITE, AO)},
    TEXELS(VKAO_UPSAMPLE_WIDTH, VKAO_UPSAMPLE_HEIGHT),
    .forms = 4,
    .record = record_upsample,
};

/* AO in images beside view z in the buffer: bent normals, noisy_ao, and BLUR without SSAO. */
static const struct vkao_pass blur_x = {
    .name = "vkao blur x",
    .label = "blur",
    .stage = VKAO_STAGE_BLUR,
    VKAO_CODE(vkao_blur_cpu),
    .uses = {READS_Z, READS_NORMALS, READS_BENT_CODES, VKAO_READS(SOURCE, AO_NOISY),
             VKAO_WRITES(TARGET, HALFWAY)},
    VKAO_ONE_TEXEL,
    .with_next = true,
    .forms = 1,
    .record = record_blur,
};

static const struct vkao_pass blur_y = {
    .name = "vkao blur y",
    .label = "blur",
    .stage = VKAO_STAGE_BLUR,
    VKAO_CODE(vkao_blur_last_cpu),
    .uses = {READS_Z, READS_NORMALS, READS_BENT_CODES, VKAO_READS(SOURCE, HALFWAY),
             VKAO_WRITES(AO_WRITE, AO), VKAO_WRITES(BENT_WRITE, BENT_NORMALS)},
    VKAO_ONE_TEXEL,
    .vertical = true,
    .forms = 2,
    .record = record_nothing,
};

static const struct vkao_pass blur_y_at_half = {
    .name = "vkao blur y",
    .label = "blur",
    .stage = VKAO_STAGE_BLUR,
    VKAO_CODE(vkao_blur_cpu),
    .uses = {READS_Z, READS_NORMALS, READS_BENT_CODES, VKAO_READS(SOURCE, HALFWAY),
             VKAO_WRITES(TARGET, BLURRED)},
    VKAO_ONE_TEXEL,
    .vertical = true,
    .forms = 1,
    .record = record_nothing,
};

static const struct vkao_pass upsample = {
    .name = "vkao upsample",
    .label = "upsample",
    .stage = VKAO_STAGE_BLUR,
    VKAO_CODE(vkao_upsample_cpu),
    .uses = {VKAO_READS(DEPTH, DEPTH), READS_Z, READS_NORMALS, VKAO_READS(SOURCE, BLURRED),
             VKAO_WRITES(AO_WRITE, AO), VKAO_WRITES(BENT_WRITE, BENT_NORMALS)},
    .area = VKAO_AREA_IMAGE_RECT,
    VKAO_ONE_TEXEL,
    .forms = 2,
};

static const struct vkao_pass debug = {
    .name = "vkao debug view",
    .label = "composite",
    .stage = VKAO_STAGE_COMPOSITE,
    VKAO_CODE(vkao_debug_cpu),
    .uses = {READS_Z, READS_NORMALS, VKAO_READS(SOURCE, AO_NOISY),
             READS_TEXELS(PACKED_READ4, PACKED, R32_UINT), VKAO_READS(BENT_READ, BENT_NORMALS),
             VKAO_WRITES(OUTPUT, OUTPUT)},
    .area = VKAO_AREA_IMAGE_RECT,
    VKAO_ONE_TEXEL,
    .forms = 1,
};

static void plan_blur(struct vkao_program *program)
{
    const bool half = program->settings.half_resolution;
    if (decodes_normals(program))
        vkao_program_add(program, &ring_normals);
    vkao_program_add(program, program->is_packed ? &packed_blur_x : &blur_x);
    if (program->is_packed)
        vkao_program_add(program, &packed_blur_y[half]);
    else
        vkao_program_add(program, half ? &blur_y_at_half : &blur_y);
    if (half)
        vkao_program_add(program, program->is_packed ? &packed_upsample : &upsample);
}

bool vkao_cpu_has(const vkao_effect_info *settings)
{
    return !(settings->stages & VKAO_STAGE_SSAO) ||
           (settings->thickness_input == VKAO_THICKNESS_AS_SEEN && !settings->second_layer &&
            (size_t)settings->method < COUNT(methods) && methods[settings->method].code);
}

static const struct vkao_pass *method_row(const struct vkao_program *program)
{
    const size_t method = (size_t)program->settings.method;
    const bool is_16bit = program->ctx->has_16bit_storage && method < COUNT(methods_16bit) &&
                          methods_16bit[method].code;
    return is_16bit ? &methods_16bit[method] : &methods[method];
}

bool vkao_cpu_plan(struct vkao_program *program, vkao_stage_flags stage)
{
    const vkao_effect_info *e = &program->settings;
    const vkao_stage_flags both = VKAO_STAGE_SSAO | VKAO_STAGE_BLUR;
    program->is_packed = (e->stages & both) == both && !e->bent_normals && !e->noisy_ao;
    switch (stage) {
    case VKAO_STAGE_PREPARE:
        vkao_program_add(program, &prepare);
        if (vkao_has_thickness(e)) {
            vkao_program_add(program, &breaks_x);
            vkao_program_add(program, &breaks_y);
            vkao_program_add(program, &width);
        }
        return true;
    case VKAO_STAGE_SSAO:
        vkao_program_add(program, &tiles);
        vkao_program_add(program, method_row(program));
        return true;
    case VKAO_STAGE_BLUR:
        plan_blur(program);
        return true;
    case VKAO_STAGE_COMPOSITE:
        if (e->composite_mode > VKAO_COMPOSITE_AO_ONLY)
            vkao_program_add(program, &debug);
        return e->composite_mode > VKAO_COMPOSITE_AO_ONLY;
    default:
        return false;
    }
}

/* --- Memory --- */

static const struct format {
    VkFormat format;
    uint32_t code;
    VkDeviceSize bytes;
} formats[] = {
    {VK_FORMAT_R8_UNORM, VKAO_STAGED_UNORM8, 1},
    {VK_FORMAT_R16_UNORM, VKAO_STAGED_UNORM16, 2},
    {VK_FORMAT_R16_SFLOAT, VKAO_STAGED_FLOAT16, 2},
    {VK_FORMAT_R32_SFLOAT, VKAO_STAGED_FLOAT32, 4},
};

/* Of the AO image, which was checked. */
static const struct format *find_format(VkFormat format)
{
    size_t i = 0;
    while (i + 1 < COUNT(formats) && formats[i].format != format)
        ++i;
    return &formats[i];
}

uint32_t vkao_cpu_setting(const struct vkao_program *program)
{
    return (program->is_packed ? VKAO_PATH_PACKED : 0u) |
           find_format(program->settings.ao_format)->code;
}

uint32_t vkao_cpu_halfway_rows(uint32_t height)
{
    return height < VKAO_RING_ROWS ? height : VKAO_RING_ROWS;
}

void vkao_cpu_parts(const struct vkao_program *program, VkExtent2D extent, bool copies,
                    struct vkao_rows *rows, VkDeviceSize parts[VKAO_RESOURCE_COUNT])
{
    enum { LEAST = 256 }; /* of what shaders name and do not use */
    if (!vkao_makes_ao(&program->settings))
        return;
    const uint32_t shift = program->settings.half_resolution, window = VKAO_BLUR_X_WIDTH;
    const VkExtent2D grid = {(extent.width + shift) >> shift, (extent.height + shift) >> shift};
    /* The last window of a row stays inside its padding. */
    rows->stride = (grid.width + window - 1) / window * window + 2 * VKAO_BUFFER_PAD;
    const VkDeviceSize stride = rows->stride;
    parts[VKAO_PART_Z] = stride * (grid.height + 2 * VKAO_VIEW_Z_BORDER) * 4;
    if (vkao_has_thickness(&program->settings)) {
        parts[VKAO_PART_BREAKS_X] = (VkDeviceSize)VKAO_BREAKS_STRIDE_OF(stride) * grid.height * 8;
        parts[VKAO_PART_BREAKS_Y] = stride * ((grid.height + 31) / 32) * 8;
    }
    /* A rect may begin within a tile of this many at most. */
    const VkDeviceSize columns = (grid.width + 3) / VKAO_ROW_GROUP_WIDTH + 1,
                       tile_rows = (grid.height + VKAO_TILE_HEIGHT - 1) / VKAO_TILE_HEIGHT;
    parts[VKAO_PART_TILES] = sizeof(struct vkao_tiles_head) + columns * tile_rows * 4;
    parts[VKAO_PART_PACKED] = parts[VKAO_PART_HALFWAY] = parts[VKAO_PART_RING_NORMALS] =
        parts[VKAO_PART_BLURRED] = parts[VKAO_PART_COPIED] = LEAST;
    if (!program->is_packed)
        return;
    parts[VKAO_PART_PACKED] = stride * grid.height;
    parts[VKAO_PART_HALFWAY] = stride * VKAO_RING_ROWS * 2;
    if (decodes_normals(program))
        parts[VKAO_PART_RING_NORMALS] = stride * VKAO_RING_ROWS * 4;
    if (program->settings.half_resolution)
        parts[VKAO_PART_BLURRED] = stride * grid.height * 2;
    if (!copies)
        return;
    const uint32_t wide = VKAO_UPSAMPLE_WIDTH, most = VKAO_STRIP_ROWS;
    rows->copied_stride = (extent.width + wide - 1) / wide * wide;
    rows->copied_texel = find_format(program->settings.ao_format)->bytes;
    parts[VKAO_PART_COPIED] =
        rows->copied_texel * rows->copied_stride * (extent.height < most ? extent.height : most);
}

bool vkao_cpu_fits(const struct vkao_program *program, VkExtent2D extent)
{
    VkDeviceSize parts[VKAO_RESOURCE_COUNT] = {0};
    struct vkao_rows rows;
    vkao_cpu_parts(program, extent, true, &rows, parts);
    for (int i = VKAO_PART_Z; i < VKAO_PART_END; ++i) {
        /* As texels of the fewest bytes that the part is read by, or fewer. */
        const VkDeviceSize texels = i == VKAO_PART_Z || i == VKAO_PART_HALFWAY ||
                                            i == VKAO_PART_RING_NORMALS || i == VKAO_PART_BLURRED
                                        ? parts[i] / 4
                                        : parts[i] / 2;
        if (parts[i] > program->ctx->max_buffer ||
            (i != VKAO_PART_COPIED && i != VKAO_PART_TILES && texels > program->ctx->max_texels))
            return false;
    }
    return true;
}
