/* SPDX-License-Identifier: MIT */
#include "stages.h"

#include "vkao_breaks.h"
#include "vkao_prepare.h"
#include "vkao_thickness.h"
#include "vkao_width.h"

#include <assert.h>
#include <math.h>
#include <string.h>

static_assert(VKAO_GLSL_DEPTH_PROJECTED == (int)VKAO_DEPTH_PROJECTED &&
                  VKAO_GLSL_DEPTH_VIEW_Z == (int)VKAO_DEPTH_VIEW_Z &&
                  VKAO_GLSL_DEPTH_DISTANCE == (int)VKAO_DEPTH_DISTANCE &&
                  VKAO_GLSL_DEPTH_INVERSE_Z == (int)VKAO_DEPTH_INVERSE_Z,
              "params.h repeats vkao_depth_encoding");
static_assert(VKAO_GLSL_NORMALS_FROM_DEPTH == (int)VKAO_NORMALS_FROM_DEPTH &&
                  VKAO_GLSL_NORMALS_XYZ_SNORM == (int)VKAO_NORMALS_XYZ_SNORM &&
                  VKAO_GLSL_NORMALS_XYZ_UNORM == (int)VKAO_NORMALS_XYZ_UNORM &&
                  VKAO_GLSL_NORMALS_OCT_SNORM == (int)VKAO_NORMALS_OCT_SNORM &&
                  VKAO_GLSL_NORMALS_OCT_UNORM == (int)VKAO_NORMALS_OCT_UNORM,
              "params.h repeats vkao_normal_encoding");

static_assert(VKAO_GLSL_THICKNESS_AS_SEEN == (int)VKAO_THICKNESS_AS_SEEN &&
                  VKAO_GLSL_THICKNESS_GIVEN == (int)VKAO_THICKNESS_GIVEN &&
                  VKAO_GLSL_THICKNESS_BACK_DEPTH == (int)VKAO_THICKNESS_BACK_DEPTH,
              "params.h repeats vkao_thickness_input");

/* How many columns a block of the image of view z has: see shaders/gpu/columns.glsl. */
static uint32_t view_z_columns(uint32_t width)
{
    return (width + VKAO_VIEW_Z_BLOCKS - 1) / VKAO_VIEW_Z_BLOCKS + 2;
}

VkExtent2D vkao_view_z_extent(VkExtent2D grid)
{
    return (VkExtent2D){view_z_columns(grid.width) * VKAO_VIEW_Z_BLOCKS,
                        grid.height + 2 * VKAO_VIEW_Z_BORDER};
}

#define PREPARES(shader, shades, side, ...)                                                        \
    {                                                                                              \
        .name = "vkao " #shader, .label = "prepare", .stage = VKAO_STAGE_PREPARE,                  \
        VKAO_CODE(vkao_##shader), .uses = {__VA_ARGS__}, .area = VKAO_AREA_##shades,               \
        .texels = {side, side}, .group = {VKAO_GROUP_WIDTH, VKAO_GROUP_HEIGHT}, .forms = 1,        \
    }
#define BREAKS(view_z)                                                                             \
    {                                                                                              \
        .name = "vkao breaks", .label = "prepare", .stage = VKAO_STAGE_PREPARE,                    \
        VKAO_CODE(vkao_breaks),                                                                    \
        .uses = {VKAO_READS(VIEW_Z, view_z), VKAO_READS(NEAREST, SAMPLER),                         \
                 VKAO_WRITES(BREAKS_X_WRITE, BREAKS_X), VKAO_WRITES(BREAKS_Y_WRITE, BREAKS_Y)},    \
        .area = VKAO_AREA_VALID, .texels = {4, 4},                                                 \
        .group = {VKAO_BREAKS_WIDTH, VKAO_BREAKS_HEIGHT}, .forms = 1,                              \
    }
#define WIDTH(view_z)                                                                              \
    {                                                                                              \
        .name = "vkao width", .label = "prepare", .stage = VKAO_STAGE_PREPARE,                     \
        VKAO_CODE(vkao_width),                                                                     \
        .uses = {VKAO_READS(BREAKS_X, BREAKS_X), VKAO_READS(BREAKS_Y, BREAKS_Y),                   \
                 VKAO_READS(NEAREST, SAMPLER), VKAO_WRITES(VIEW_Z_WRITE, view_z)},                 \
        .area = VKAO_AREA_VALID, .texels = {2, 2}, .group = {VKAO_GROUP_WIDTH, VKAO_GROUP_HEIGHT}, \
        .forms = 1,                                                                                \
    }
/* A layer of depth, and how thick it is as seen. */
#define LAYER(depth, view_z)                                                                       \
    {                                                                                              \
        PREPARES(prepare, WHOLE, 2, VKAO_READS(DEPTH, depth), VKAO_READS(NEAREST, SAMPLER),        \
                 VKAO_WRITES(VIEW_Z_WRITE, view_z)),                                               \
            BREAKS(view_z), WIDTH(view_z),                                                         \
    }
enum { LAYER_PASSES = 3 };
static const struct vkao_pass first[LAYER_PASSES] = LAYER(DEPTH, VIEW_Z),
                              second[LAYER_PASSES] = LAYER(SECOND_DEPTH, SECOND_Z);
/* An input. Back depth is decoded as depth is, so it takes that binding. */
static const struct vkao_pass given =
    PREPARES(thickness, VALID, 1, VKAO_READS(DEPTH, THICKNESS), VKAO_WRITES(VIEW_Z_WRITE, VIEW_Z));

static void plan_layer(struct vkao_program *program, const struct vkao_pass *layer, int count)
{
    for (int i = 0; i < count; ++i)
        vkao_program_add(program, &layer[i]);
}

void vkao_prepare_plan(struct vkao_program *program)
{
    const vkao_effect_info *e = &program->settings;
    const bool is_given = e->thickness_input != VKAO_THICKNESS_AS_SEEN,
               is_vbao = vkao_has_thickness(e) && e->method == VKAO_SSAO_VBAO;
    plan_layer(program, first, is_vbao && !is_given ? LAYER_PASSES : 1);
    if (is_given && vkao_has_thickness(e))
        vkao_program_add(program, &given);
    if (e->second_layer && e->stages & VKAO_STAGE_SSAO)
        plan_layer(program, second, is_vbao && !is_given ? LAYER_PASSES : 1);
}

/* What to divide by so that the matrix makes unit vectors of unit vectors: 1 for what floats make
 * of a rotation. */
static double normal_scale(const float rows[3][3])
{
    double largest = 0.0, sum = 0.0;
    for (int i = 0; i < 9; ++i)
        largest = fmax(largest, fabs((double)rows[i / 3][i % 3]));
    for (int i = 0; largest > 0.0 && i < 9; ++i)
        sum += pow((double)rows[i / 3][i % 3] / largest, 2.0);
    const double scale = sqrt(sum / 3.0) * largest;
    return fabs(scale - 1.0) < 1e-3 || !(scale > 0.0) ? 1.0 : scale;
}

static uint32_t longer_side(struct vkao_rect area)
{
    const uint32_t width = area.x1 - area.x0, height = area.y1 - area.y0;
    return width > height ? width : height;
}

static void normals_constants(const float rows[3][3], struct vkao_constants *out)
{
    const double scale = normal_scale(rows);
    for (int column = 0; column < 3; ++column) {
        out->normal_x[column] = (float)((double)rows[0][column] / scale);
        out->normal_y[column] = (float)((double)rows[1][column] / scale);
        out->normal_z[column] = (float)((double)rows[2][column] / scale);
    }
}

void vkao_prepare_constants(const struct vkao_recording *r, const vkao_params *params,
                            struct vkao_constants *out)
{
    const struct view_constants *image = &r->image, *grid = &r->grid;
    const float radius = vkao_radius_of(params);
    out->break_least = image->orthographic ? (float)VKAO_VBAO_BREAK_LEAST_RADII * radius
                                           : (float)VKAO_VBAO_BREAK_LEAST;
    out->width_reach = image->orthographic ? (float)VKAO_VBAO_WIDTH_REACH_RADII * radius
                                           : (float)VKAO_VBAO_WIDTH_REACH;
    out->view_z_columns = view_z_columns(vkao_area(r, VKAO_AREA_WHOLE).x1);
    out->view_z_pitch = (float)(out->view_z_columns * VKAO_VIEW_Z_BLOCKS - 1);
    out->view_z_last = (float)out->view_z_columns - 1.0f / (float)VKAO_VIEW_Z_BLOCKS;
    const bool far_is_one = image->far_depth > 0.5f;
    memcpy(out->image_unproject, image->unproject, sizeof out->image_unproject);
    memcpy(out->unproject, grid->unproject, sizeof out->unproject);
    memcpy(out->inverse_unproject, grid->inverse_unproject, sizeof out->inverse_unproject);
    normals_constants(image->normal_rows, out);
    memcpy(out->linearize, image->linearize, sizeof out->linearize);
    memcpy(out->depth_error, image->depth_error, sizeof out->depth_error);
    out->far_test[0] = far_is_one ? 1.0f : -1.0f;
    out->far_test[1] = far_is_one ? 1.0f : 0.0f;
    out->far_z = fminf(image->far_z, (float)VKAO_FARTHEST_Z);
    out->reference_z = image->reference_z;
    vkao_rect_pack(image->valid, out->image_valid);
    vkao_rect_pack(grid->valid, out->valid);
    out->farthest = (float)VKAO_STEP_FARTHEST * (float)longer_side(grid->valid);
}
