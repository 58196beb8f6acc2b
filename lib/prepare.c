/* SPDX-License-Identifier: MIT */
#include "stages.h"

#include "vkao_prepare.h"

#include <assert.h>
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

static const struct vkao_pass prepare = {
    .name = "vkao prepare",
    .label = "prepare",
    .stage = VKAO_STAGE_PREPARE,
    VKAO_CODE(vkao_prepare),
    .uses = {VKAO_READS(DEPTH, DEPTH), VKAO_WRITES(VIEW_Z_WRITE, VIEW_Z)},
    .area = VKAO_AREA_VALID,
    VKAO_ONE_TEXEL,
    .forms = 1,
};

void vkao_prepare_plan(struct vkao_program *program)
{
    vkao_program_add(program, &prepare);
}

void vkao_prepare_constants(const struct view_constants *image, const struct view_constants *grid,
                            struct vkao_constants *out)
{
    const bool far_is_one = image->far_depth > 0.5f;
    memcpy(out->image_unproject, image->unproject, sizeof out->image_unproject);
    memcpy(out->unproject, grid->unproject, sizeof out->unproject);
    memcpy(out->normal_x, image->normal_rows[0], sizeof image->normal_rows[0]);
    memcpy(out->normal_y, image->normal_rows[1], sizeof image->normal_rows[1]);
    memcpy(out->normal_z, image->normal_rows[2], sizeof image->normal_rows[2]);
    memcpy(out->linearize, image->linearize, sizeof out->linearize);
    memcpy(out->depth_error, image->depth_error, sizeof out->depth_error);
    for (int i = 0; i < 2; ++i)
        out->inverse_unproject[i] = 1.0f / grid->unproject[i];
    out->far_test[0] = far_is_one ? 1.0f : -1.0f;
    out->far_test[1] = far_is_one ? 1.0f : 0.0f;
    out->far_z = image->far_z;
    out->reference_z = image->reference_z;
    vkao_rect_pack(image->valid, out->image_valid);
    vkao_rect_pack(grid->valid, out->valid);
}
