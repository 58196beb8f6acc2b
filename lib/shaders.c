/* SPDX-License-Identifier: MIT
 *
 * The shaders of each build, and what a pipeline of them is compiled for. */
#include "pipeline.h"

#include "internal.h"

#include "blur.comp.h"
#include "blur_buf.comp.h"
#include "blur_x_buffers_any.comp.h"
#include "blur_x_buffers_buf.comp.h"
#include "blur_y_buffers_any.comp.h"
#include "blur_y_buffers_buf.comp.h"
#include "blur_z16.comp.h"
#include "composite.comp.h"
#include "composite_buf.comp.h"
#include "composite_z16.comp.h"
#include "debug.comp.h"
#include "debug_buf.comp.h"
#include "debug_z16.comp.h"
#include "prepare.comp.h"
#include "prepare_buffers_buf.comp.h"
#include "prepare_z16.comp.h"
#include "ssao_gtao.comp.h"
#include "ssao_gtao_buf.comp.h"
#include "ssao_gtao_buf16.comp.h"
#include "ssao_gtao_z16.comp.h"
#include "ssao_hbao.comp.h"
#include "ssao_hbao_buf.comp.h"
#include "ssao_hbao_buf16.comp.h"
#include "ssao_hbao_z16.comp.h"
#include "ssao_hemisphere.comp.h"
#include "ssao_hemisphere_buf.comp.h"
#include "ssao_hemisphere_buf16.comp.h"
#include "ssao_hemisphere_z16.comp.h"
#include "ssao_raymarch.comp.h"
#include "ssao_raymarch_buf.comp.h"
#include "ssao_raymarch_z16.comp.h"
#include "ssao_sphere.comp.h"
#include "ssao_sphere_buf.comp.h"
#include "ssao_sphere_z16.comp.h"
#include "ssao_vbao.comp.h"
#include "ssao_vbao_buf.comp.h"
#include "ssao_vbao_buf16.comp.h"
#include "ssao_vbao_z16.comp.h"
#include "tiles_buf.comp.h"
#include "upsample.comp.h"
#include "upsample_buf.comp.h"
#include "upsample_buffers_buf.comp.h"
#include "upsample_z16.comp.h"

#include <string.h>

/* How view z is kept, and noisy AO stored. */
enum build {
    BUILD_Z32,
    BUILD_Z16,
    BUILD_BUFFERS,
    /* In their place, where there is one: codes of two texels in one store; the general pipeline, if
     * it has code of its own. */
    BUILD_BUFFERS_16BIT,
    BUILD_BUFFERS_GENERAL,
    BUILD_COUNT
};

struct shader {
    const char *name;
    struct {
        const uint32_t *code; /* NULL = not in this build */
        size_t bytes;
    } builds[BUILD_COUNT];
    VkBool32 vertical; /* VKAO_CONSTANT_BLUR_VERTICAL */
    bool bent;         /* has a form with VKAO_CONSTANT_BENT_NORMALS */
    VkExtent2D texels; /* of one invocation in BUILD_BUFFERS; in images it is one */
};

#define CODE(name)                                                                                 \
    {                                                                                              \
        name, sizeof name                                                                          \
    }
#define SHADER(name)                                                                               \
#name,                                                                                         \
    {                                                                                              \
        CODE(name##_comp), CODE(name##_z16_comp), CODE(name##_buf_comp)                            \
    }
#define SHADER_OF_PAIRS(name)                                                                      \
#name,                                                                                         \
    {                                                                                              \
        CODE(name##_comp), CODE(name##_z16_comp), CODE(name##_buf_comp), CODE(name##_buf16_comp)   \
    }
#define ONE_TEXEL                                                                                  \
    {                                                                                              \
        1, 1                                                                                       \
    }
#define SSAO_TEXELS                                                                                \
    {                                                                                              \
        VKAO_SSAO_TEXELS, 1                                                                        \
    }
static const struct shader shaders[PIPELINE_COUNT] = {
    [PIPELINE_PREPARE] = {"prepare",
                          {CODE(prepare_comp), CODE(prepare_z16_comp),
                           CODE(prepare_buffers_buf_comp)},
                          VK_FALSE,
                          false,
                          {VKAO_PREPARE_WIDTH, 1}},
    [PIPELINE_BLUR_X] = {SHADER(blur), VK_FALSE, true, ONE_TEXEL},
    [PIPELINE_BLUR_Y] = {SHADER(blur), VK_TRUE, true, ONE_TEXEL},
    [PIPELINE_UPSAMPLE] = {SHADER(upsample), VK_FALSE, true, ONE_TEXEL},
    [PIPELINE_TILES] =
        {"tiles", {[BUILD_BUFFERS] = CODE(tiles_buf_comp)}, VK_FALSE, true, ONE_TEXEL},
    [PIPELINE_PACKED_BLUR_X] = {"blur_x",
                                {[BUILD_BUFFERS] = CODE(blur_x_buffers_buf_comp),
                                 [BUILD_BUFFERS_GENERAL] = CODE(blur_x_buffers_any_comp)},
                                VK_FALSE,
                                false,
                                {VKAO_BLUR_X_WIDTH, 1}},
    [PIPELINE_PACKED_BLUR_Y] = {"blur_y",
                                {[BUILD_BUFFERS] = CODE(blur_y_buffers_buf_comp),
                                 [BUILD_BUFFERS_GENERAL] = CODE(blur_y_buffers_any_comp)},
                                VK_TRUE,
                                false,
                                {VKAO_BLUR_Y_WIDTH, VKAO_BLUR_Y_HEIGHT}},
    [PIPELINE_PACKED_UPSAMPLE] = {"upsample",
                                  {[BUILD_BUFFERS] = CODE(upsample_buffers_buf_comp)},
                                  VK_FALSE,
                                  false,
                                  {VKAO_UPSAMPLE_WIDTH, VKAO_UPSAMPLE_HEIGHT}},
    [PIPELINE_COMPOSITE] = {SHADER(composite), VK_FALSE, false, ONE_TEXEL},
    [PIPELINE_DEBUG] = {SHADER(debug), VK_FALSE, false, ONE_TEXEL},
    [PIPELINE_SSAO + VKAO_SSAO_SPHERE] = {SHADER(ssao_sphere), VK_FALSE, false, ONE_TEXEL},
    [PIPELINE_SSAO +
        VKAO_SSAO_HEMISPHERE] = {SHADER_OF_PAIRS(ssao_hemisphere), VK_FALSE, false, SSAO_TEXELS},
    [PIPELINE_SSAO + VKAO_SSAO_HBAO] = {SHADER_OF_PAIRS(ssao_hbao), VK_FALSE, false, SSAO_TEXELS},
    [PIPELINE_SSAO + VKAO_SSAO_GTAO] = {SHADER_OF_PAIRS(ssao_gtao), VK_FALSE, true, SSAO_TEXELS},
    [PIPELINE_SSAO + VKAO_SSAO_VBAO] = {SHADER_OF_PAIRS(ssao_vbao), VK_FALSE, true, SSAO_TEXELS},
    [PIPELINE_SSAO + VKAO_SSAO_RAYMARCH] = {SHADER(ssao_raymarch), VK_FALSE, true, ONE_TEXEL},
};

static enum build context_build(const vkao_context *ctx)
{
    if (ctx->buffers)
        return ctx->storage_16bit ? BUILD_BUFFERS_16BIT : BUILD_BUFFERS;
    return ctx->half_view_z ? BUILD_Z16 : BUILD_Z32;
}

struct shader_code shader_code(const vkao_context *ctx, enum pipeline which, bool general)
{
    const struct shader *s = &shaders[which];
    enum build build = context_build(ctx);
    if (ctx->buffers && general && s->builds[BUILD_BUFFERS_GENERAL].code)
        build = BUILD_BUFFERS_GENERAL;
    if (build == BUILD_BUFFERS_16BIT && !s->builds[build].code)
        build = BUILD_BUFFERS;
    return (struct shader_code){s->name, s->builds[build].code, s->builds[build].bytes, s->vertical,
                                s->bent};
}

VkExtent2D pipeline_texels(const vkao_context *ctx, enum pipeline which)
{
    return ctx->buffers ? shaders[which].texels : (VkExtent2D)ONE_TEXEL;
}

static_assert(sizeof(struct pipeline_key) ==
                  (VKAO_CONSTANT_COUNT - VKAO_CONSTANT_FLAGS) * sizeof(uint32_t),
              "the constants from VKAO_CONSTANT_FLAGS on");

VkExtent2D pipeline_group(const vkao_context *ctx, enum pipeline which)
{
    return ctx->buffers && (which >= PIPELINE_SSAO || which == PIPELINE_TILES)
               ? (VkExtent2D){VKAO_ROW_GROUP_WIDTH, 1}
               : (VkExtent2D){VKAO_GROUP_WIDTH, VKAO_GROUP_HEIGHT};
}

#define ENUM_FLAGS(shift, bits) (((1u << (bits)) - 1u) << (shift))

/* The flags that a stage's shader asks for; the rest is left out of its key. */
static uint32_t stage_flags(enum pipeline which)
{
    const uint32_t normals = ENUM_FLAGS(VKAO_FLAG_NORMALS_SHIFT, 3),
                   bent = ENUM_FLAGS(VKAO_FLAG_BENT_SHIFT, 3),
                   depth = ENUM_FLAGS(VKAO_FLAG_DEPTH_SHIFT, 2) | VKAO_FLAG_ORTHOGRAPHIC |
                           VKAO_FLAG_FAR_IS_ONE,
                   blur = normals | bent | VKAO_FLAG_BLUR_NORMALS | VKAO_FLAG_NORMAL_POWER_8 |
                          VKAO_FLAG_PHYSICAL,
                   finish = blur | ENUM_FLAGS(VKAO_FLAG_STAGED_SHIFT, 3);
    switch (which) {
    case PIPELINE_TILES:
        return VKAO_FLAG_PACKED;
    case PIPELINE_PREPARE:
        return depth | VKAO_FLAG_HALF_RESOLUTION;
    case PIPELINE_BLUR_X:
    case PIPELINE_BLUR_Y:
    case PIPELINE_PACKED_BLUR_X:
        return blur | VKAO_FLAG_HALF_RESOLUTION;
    case PIPELINE_PACKED_BLUR_Y:
        return finish | VKAO_FLAG_HALF_RESOLUTION;
    case PIPELINE_UPSAMPLE:
    case PIPELINE_PACKED_UPSAMPLE:
        return finish | depth;
    case PIPELINE_COMPOSITE:
    case PIPELINE_DEBUG:
        return 0;
    default:
        return normals | VKAO_FLAG_ORTHOGRAPHIC | VKAO_FLAG_NORMALS_ALIGNED |
               VKAO_FLAG_HALF_RESOLUTION | VKAO_FLAG_THRESHOLD | VKAO_FLAG_SPHERE_LITERAL |
               VKAO_FLAG_PACKED;
    }
}

/* May the counts of slices and steps be constants? vbao loops over slices if both are too many together. */
static bool unrolls(const vkao_ssao_params *ssao)
{
    uint32_t slices = ssao->method == VKAO_SSAO_VBAO ? 1 : ssao->slice_count;
    return slices * ssao->step_count <= VKAO_MOST_UNROLLED;
}

struct pipeline_key pipeline_key(enum pipeline which, uint32_t flags, const vkao_ssao_params *ssao,
                                 const vkao_blur_params *blur)
{
    struct pipeline_key key = {.flags = flags & stage_flags(which)};
    if (blur && (which == PIPELINE_PACKED_BLUR_X || which == PIPELINE_PACKED_BLUR_Y))
        key.radius = blur->radius;
    if (!ssao || which != (enum pipeline)(PIPELINE_SSAO + (int)ssao->method))
        return key;
    switch (ssao->method) {
    case VKAO_SSAO_SPHERE:
    case VKAO_SSAO_HEMISPHERE:
        if (ssao->sample_count <= VKAO_MOST_UNROLLED)
            key.samples = ssao->sample_count;
        break;
    case VKAO_SSAO_RAYMARCH:
        break;
    default:
        if (unrolls(ssao)) {
            key.slices = ssao->slice_count;
            key.steps = ssao->step_count;
        }
    }
    return key;
}

/* Does the matrix only turn axes round? */
static bool is_aligned(const float rows[3][3])
{
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) {
            if (r != c && rows[r][c] != 0.0f)
                return false;
        }
    }
    return true;
}

uint32_t recording_way(bool packed, uint32_t staged)
{
    return (packed ? VKAO_FLAG_PACKED : 0u) | staged << VKAO_FLAG_STAGED_SHIFT;
}

uint32_t frame_flags(const vkao_frame *frame)
{
    return recording_way(frame->packed, frame->staged);
}

uint32_t recording_flags(const struct view_constants *view, uint32_t way,
                         const vkao_ssao_params *ssao, const vkao_blur_params *blur)
{
    uint32_t flags = way | (view->encodings & 0xffu) << VKAO_FLAG_NORMALS_SHIFT |
                     (view->encodings >> 8) << VKAO_FLAG_BENT_SHIFT |
                     view->depth_encoding << VKAO_FLAG_DEPTH_SHIFT;
    const struct {
        bool is;
        uint32_t flag;
    } facts[] = {
        {view->orthographic, VKAO_FLAG_ORTHOGRAPHIC},
        {view->far_depth > 0.5f, VKAO_FLAG_FAR_IS_ONE},
        {is_aligned(view->normal_rows), VKAO_FLAG_NORMALS_ALIGNED},
        {view->grid_shift > 0, VKAO_FLAG_HALF_RESOLUTION},
        {ssao && ssao->falloff == VKAO_FALLOFF_THRESHOLD, VKAO_FLAG_THRESHOLD},
        {ssao && ssao->sphere_form == VKAO_SPHERE_LITERAL, VKAO_FLAG_SPHERE_LITERAL},
        {blur && blur->normal_power > 0.0f, VKAO_FLAG_BLUR_NORMALS},
        {blur && blur->normal_power == 8.0f, VKAO_FLAG_NORMAL_POWER_8},
        {blur && blur->intensity == 1.0f && blur->power == 1.0f, VKAO_FLAG_PHYSICAL},
    };
    for (size_t i = 0; i < sizeof facts / sizeof facts[0]; ++i)
        flags |= facts[i].is ? facts[i].flag : 0u;
    return flags;
}
