/* SPDX-License-Identifier: MIT */
#include "settings.h"

#include "options.h"

#include <math.h>
#include <string.h>

#define EFFECT(member) offsetof(struct setting, effect.member)
#define PARAMS(member) offsetof(struct setting, params.member)

const struct view_name view_names[VIEW_KINDS] = {
    [VIEW_RAW] = {"raw", "AO before the blur"},       [VIEW_AO] = {"ao", "AO"},
    [VIEW_COMPOSITE] = {"composite", "Composite"},    [VIEW_DEPTH] = {"depth", "Depth"},
    [VIEW_NORMALS] = {"normals", "Normals"},          [VIEW_BENT] = {"bent", "Bent normals"},
    [VIEW_DIFFERENCE] = {"difference", "Difference"},
};

const char *const group_names[GROUP_COUNT] = {
    [GROUP_SSAO] = "Occlusion", [GROUP_BLUR] = "Blur", [GROUP_COMPOSITE] = "Composite"};

/* --- Rows --- */

static bool is_at(const vkao_parameter *p, size_t offset)
{
    return parameter_offset(p) == offset;
}

/* The view decides whether there are bent normals, and what of depth is seen; no file says how many
 * bits its depth once had, nobody asks for AO before the blur as an image of its own, and options
 * that name channels say whether there is thickness and a second layer. */
static bool is_shown(const vkao_parameter *p)
{
    return !parameter_is_of_images(p) && !is_at(p, EFFECT(depth_bits)) &&
           !is_at(p, EFFECT(bent_normals)) && !is_at(p, EFFECT(noisy_ao)) &&
           !is_at(p, EFFECT(thickness_input)) && !is_at(p, EFFECT(second_layer)) &&
           !is_at(p, PARAMS(debug_distance));
}

static enum param_group group_of(const vkao_parameter *p)
{
    return p->stages & VKAO_STAGE_SSAO   ? GROUP_SSAO
           : p->stages & VKAO_STAGE_BLUR ? GROUP_BLUR
                                         : GROUP_COMPOSITE;
}

static unsigned needs_of(const vkao_parameter *p)
{
    return is_at(p, EFFECT(multi_bounce)) ? NEEDS_ALBEDO
           : is_at(p, EFFECT(specular))   ? NEEDS_SPECULAR
                                          : 0u;
}

/* Sliders end where ranges do not: wholes at 63, lengths at 2000 times their default; and begin at
 * a hundredth of it where zero is out of range. */
static void fill_slider(struct param *row)
{
    enum { MOST_WHOLE = 63 };
    const vkao_parameter *p = row->parameter;
    const struct parameter_range r = parameter_range(p);
    row->low = r.low_is_excluded ? p->standard / 100 : r.low;
    row->high = isinf(r.high) ? p->standard * 2000 : r.high;
    if (p->type == VKAO_PARAMETER_UINT && row->high >= (double)UINT32_MAX)
        row->high = MOST_WHOLE;
    row->logarithmic =
        p->type != VKAO_PARAMETER_COLOR && p->standard < row->high / 16 && row->high != MOST_WHOLE;
}

static struct param make_row(const vkao_parameter *p)
{
    struct param row = {.parameter = p, .group = group_of(p), .needs = needs_of(p)};
    for (size_t i = 0; p->name[i] && i + 1 < sizeof row.label; i++)
        row.label[i] = p->name[i] == '_' ? ' ' : p->name[i];
    fill_slider(&row);
    return row;
}

/* What is changed most comes first. */
const struct param *panel_params(size_t *count)
{
    static const size_t first[] = {EFFECT(method), PARAMS(radius), EFFECT(falloff)};
    enum { FIRST = sizeof first / sizeof *first };
    static struct param rows[MAX_PARAMS];
    static size_t filled;
    uint32_t all_count;
    const vkao_parameter *all = vkao_parameters(&all_count);
    for (size_t i = 0; !filled && i < FIRST; i++)
        rows[i] = make_row(parameter_at(first[i]));
    size_t n = FIRST;
    for (uint32_t i = 0; !filled && i < all_count && n < MAX_PARAMS; i++) {
        bool is_there = !is_shown(&all[i]);
        for (size_t k = 0; k < FIRST; k++)
            is_there = is_there || is_at(&all[i], first[k]);
        if (!is_there)
            rows[n++] = make_row(&all[i]);
    }
    filled = filled ? filled : n;
    *count = filled;
    return rows;
}

uint32_t last_choice(const struct param *param)
{
    return is_at(param->parameter, EFFECT(composite_mode)) ? VKAO_COMPOSITE_AO_ONLY
                                                           : (uint32_t)param->parameter->most;
}

/* What a choice needs. */
static unsigned choice_needs(const struct param *param, uint32_t choice)
{
    static const unsigned of_mode[] = {[VKAO_COMPOSITE_MULTIPLY] = NEEDS_COLOR,
                                       [VKAO_COMPOSITE_INDIRECT] = NEEDS_COLOR | NEEDS_DIRECT,
                                       [VKAO_COMPOSITE_AO_ONLY] = 0};
    if (is_at(param->parameter, EFFECT(specular)) && choice != VKAO_SPECULAR_NONE)
        return NEEDS_SPECULAR;
    return is_at(param->parameter, EFFECT(composite_mode)) &&
                   choice < sizeof of_mode / sizeof *of_mode
               ? of_mode[choice]
               : 0u;
}

bool choice_is_open(const struct param *param, uint32_t choice, unsigned there)
{
    /* Specular light that was taken out of the colour comes back by a factor of its own only. */
    if (is_at(param->parameter, EFFECT(specular)) && choice == VKAO_SPECULAR_NONE)
        return !(there & NEEDS_SPECULAR);
    return (choice_needs(param, choice) & ~there) == 0;
}

void param_reset(const struct param *param, struct setting *setting)
{
    const struct setting standard = setting_default();
    parameter_copy(param->parameter, setting, &standard);
}

/* --- What a view computes --- */

static bool method_reads(vkao_ssao_method method, size_t offset)
{
    return parameter_at(offset)->methods >> method & 1u;
}

struct setting setting_for_view(const struct setting *setting, enum view_kind view)
{
    struct setting s = *setting;
    if (!method_reads(s.effect.method, EFFECT(thickness_input)))
        s.effect.thickness_input = VKAO_THICKNESS_AS_SEEN;
    if (!method_reads(s.effect.method, EFFECT(second_layer)))
        s.effect.second_layer = VK_FALSE;
    if (view == VIEW_RAW) {
        s.effect.blur_radius = 0;
        s.params.intensity = s.params.power = 1.0f;
    }
    return s;
}

/* vkao.h: zero means the default. The command line knows no zero. */
static void name_zeros(struct setting *s)
{
    const struct setting standard = setting_default();
    uint32_t count, zero = 0;
    const vkao_parameter *all = vkao_parameters(&count);
    for (uint32_t i = 0; i < count; i++)
        if (all[i].zero_is_standard && memcmp(parameter_of(s, &all[i]), &zero, sizeof zero) == 0)
            parameter_copy(&all[i], s, &standard);
}

static bool has_option(const vkao_parameter *p)
{
    return option_of_parameter(p) != NULL;
}

/* What only the composite reads is not said where there is none. */
static bool is_said(const struct param *p, enum view_kind view)
{
    return (p->group != GROUP_COMPOSITE || view == VIEW_COMPOSITE) &&
           !is_at(p->parameter, EFFECT(half_resolution));
}

struct setting setting_as_said(const struct setting *setting, enum view_kind view)
{
    struct setting s = setting_for_view(setting, view);
    const struct setting standard = setting_default();
    size_t count;
    const struct param *rows = panel_params(&count);
    name_zeros(&s);
    for (size_t i = 0; i < count; i++) {
        const vkao_parameter *p = rows[i].parameter;
        if (!is_at(p, EFFECT(half_resolution)) && (!is_said(&rows[i], view) || !has_option(p)))
            parameter_copy(p, &s, &standard);
    }
    s.params.debug_distance = standard.params.debug_distance;
    return s;
}

void setting_add_options(const struct setting *setting, enum view_kind view, struct text *out,
                         struct text *unsaid)
{
    struct setting s = setting_for_view(setting, view), base = setting_default();
    size_t count;
    const struct param *rows = panel_params(&count);
    /* What --quality decides is said only where it differs from that. */
    if (s.effect.half_resolution)
        setting_apply_preset(&base, VKAO_QUALITY_FAST);
    if (s.effect.half_resolution)
        text_add(out, " --quality %s", quality_names[VKAO_QUALITY_FAST]);
    name_zeros(&s);
    for (size_t i = 0; i < count; i++) {
        const vkao_parameter *p = rows[i].parameter;
        const struct option_row *option = option_of_parameter(p);
        const bool always = is_at(p, PARAMS(radius)) || is_at(p, PARAMS(bias));
        if (!is_said(&rows[i], view) || (!always && parameter_equals(p, &s, &base)))
            continue;
        struct text *to = option ? out : unsaid;
        if (option)
            text_add(to, " --%s ", option->name);
        else
            text_add(to, "%s%s ", to->length ? ", " : "", rows[i].label);
        parameter_add_value(to, p, &s);
    }
}
