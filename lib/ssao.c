/* SPDX-License-Identifier: MIT */
#include "stages.h"

#include "vkao_ssao_gtao.h"
#include "vkao_ssao_hbao.h"
#include "vkao_ssao_hemisphere.h"
#include "vkao_ssao_raymarch.h"
#include "vkao_ssao_sphere.h"
#include "vkao_ssao_vbao.h"

#define METHOD(method)                                                                             \
    {                                                                                              \
        .name = "vkao ssao " #method, .label = "ssao", .stage = VKAO_STAGE_SSAO,                   \
        VKAO_CODE(vkao_ssao_##method),                                                             \
        .uses = {VKAO_READS_VIEW_Z, VKAO_READS(NORMALS, NORMALS), VKAO_READS(SECOND_Z, SECOND_Z),  \
                 VKAO_WRITES(TARGET, AO_NOISY), VKAO_WRITES(BENT_TARGET, BENT_CODES)},             \
        .area = VKAO_AREA_AROUND, .texels = {1, 1},                                                \
        .group = {VKAO_SSAO_GROUP_WIDTH, VKAO_SSAO_GROUP_HEIGHT}, .forms = 1,                      \
    }
static const struct vkao_pass methods[] = {
    [VKAO_SSAO_SPHERE] = METHOD(sphere), [VKAO_SSAO_HEMISPHERE] = METHOD(hemisphere),
    [VKAO_SSAO_HBAO] = METHOD(hbao),     [VKAO_SSAO_GTAO] = METHOD(gtao),
    [VKAO_SSAO_VBAO] = METHOD(vbao),     [VKAO_SSAO_RAYMARCH] = METHOD(raymarch),
};

void vkao_ssao_plan(struct vkao_program *program)
{
    vkao_program_add(program, &methods[program->settings.method]);
}

/* What vkao_constants says of inverse_unit. */
static void set_units(const struct vkao_recording *r, bool is_given, struct vkao_constants *out)
{
    const float gap = out->thickness_gap, widths = (float)VKAO_VBAO_WIDTHS, unit = gap / widths;
    out->inverse_unit = out->inverse_radius * unit;
    for (size_t i = 0; i < 2; i++)
        out->unproject_units[i] = r->grid.unproject[i] * out->inverse_unit;
    out->unit_square = unit * unit;
    out->hidden_share = 1.0f / ((float)VKAO_VBAO_SECTORS * out->unit_square);
    out->unit_base = out->thickness_base / widths;
    out->unit_slope = out->thickness_slope / gap;
    out->unit_seen = (is_given ? out->thickness : out->thickness_seen) * gap;
}

void vkao_ssao_constants(const struct vkao_recording *r, const vkao_params *params,
                         struct vkao_constants *out)
{
    const vkao_effect_info *effect = &r->frame->program->settings;
    const float thickness =
        params->thickness *
        (effect->falloff == VKAO_FALLOFF_THRESHOLD ? (float)VKAO_THICKNESS_THRESHOLD : 1.0f);
    out->radius = vkao_radius_of(params);
    out->inverse_radius = 1.0f / out->radius;
    out->reach =
        out->radius * (float)(effect->falloff == VKAO_FALLOFF_THRESHOLD ? VKAO_VBAO_REACH_THRESHOLD
                                                                        : VKAO_VBAO_REACH_SMOOTH);
    out->bias = params->bias * out->radius;
    out->bias_cosine = params->bias;
    const bool is_vbao = effect->method == VKAO_SSAO_VBAO,
               is_given = effect->thickness_input != VKAO_THICKNESS_AS_SEEN;
    const float share = (float)VKAO_VBAO_THICKNESS_SEEN +
                        (float)VKAO_VBAO_THICKNESS_MISSED / (float)effect->step_count;
    out->thickness = thickness;
    out->thickness_seen = thickness * share;
    out->thickness_gap =
        (float)(effect->half_resolution ? VKAO_VBAO_THICKNESS_GAP_HALF : VKAO_VBAO_THICKNESS_GAP) /
        share;
    out->thickness_base =
        is_vbao ? (float)VKAO_VBAO_THICKNESS_BASE / share : thickness * (float)VKAO_THICKNESS_BASE;
    out->thickness_slope = is_vbao ? (float)VKAO_VBAO_THICKNESS_SLOPE / share
                                   : thickness * (float)VKAO_THICKNESS_SLOPE;
    set_units(r, is_given, out);
    if (vkao_has_thickness(effect)) /* in the last bits of view z */
        out->depth_error[effect->projection == VKAO_PROJECTION_ORTHOGRAPHIC] +=
            (float)VKAO_THICKNESS_DEPTH_ERROR *
            (is_given ? (float)(1 << VKAO_THICKNESS_FINER) : 1.0f);
    out->slices = effect->slice_count;
    out->steps = effect->step_count;
    out->samples = effect->sample_count;
}
