/* SPDX-License-Identifier: MIT */
#include "settings.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define AT(member) offsetof(struct setting, member)
#define METHOD(name) (1u << VKAO_SSAO_##name)
#define SLICED (METHOD(HBAO) | METHOD(GTAO) | METHOD(VBAO))

const struct view_name view_names[VIEW_KINDS] = {
    [VIEW_RAW] = {"raw", "AO before the blur"},       [VIEW_AO] = {"ao", "AO"},
    [VIEW_COMPOSITE] = {"composite", "Composite"},    [VIEW_DEPTH] = {"depth", "Depth"},
    [VIEW_NORMALS] = {"normals", "Normals"},          [VIEW_BENT] = {"bent", "Bent normals"},
    [VIEW_DIFFERENCE] = {"difference", "Difference"},
};

const char *const group_names[GROUP_COUNT] = {
    [GROUP_SSAO] = "Occlusion", [GROUP_BLUR] = "Blur", [GROUP_COMPOSITE] = "Composite"};

static const struct param_choice methods[] = {{"sphere", VKAO_SSAO_SPHERE, 0},
                                              {"hemisphere", VKAO_SSAO_HEMISPHERE, 0},
                                              {"hbao", VKAO_SSAO_HBAO, 0},
                                              {"gtao", VKAO_SSAO_GTAO, 0},
                                              {"vbao", VKAO_SSAO_VBAO, 0},
                                              {"raymarch", VKAO_SSAO_RAYMARCH, 0},
                                              {0}};
static const struct param_choice falloffs[] = {
    {"smooth", VKAO_FALLOFF_SMOOTH, 0}, {"threshold", VKAO_FALLOFF_THRESHOLD, 0}, {0}};
static const struct param_choice forms[] = {
    {"rescaled", VKAO_SPHERE_RESCALED, 0}, {"literal", VKAO_SPHERE_LITERAL, 0}, {0}};
static const struct param_choice modes[] = {
    {"multiply", VKAO_COMPOSITE_MULTIPLY, NEEDS_COLOR},
    {"indirect", VKAO_COMPOSITE_INDIRECT, NEEDS_COLOR | NEEDS_DIRECT},
    {"ao only", VKAO_COMPOSITE_AO_ONLY, 0},
    {0}};
static const struct param_choice speculars[] = {
    {"none", VKAO_SPECULAR_NONE, 0},
    {"from ao", VKAO_SPECULAR_FROM_AO, NEEDS_SPECULAR},
    {"from bent", VKAO_SPECULAR_FROM_BENT, NEEDS_SPECULAR},
    {0}};

/* clang-format off */
const struct param params[] = {
    {.label = "method", .option = "method", .group = GROUP_SSAO, .kind = PARAM_CHOICE,
     .help = "vbao is closest to ray-traced AO; raymarch is slow, the yardstick of the others",
     .offset = AT(ssao.method), .choices = methods},
    {.label = "radius", .option = "radius", .group = GROUP_SSAO, .kind = PARAM_FLOAT,
     .help = "scene units that an occluder reaches",
     .offset = AT(ssao.radius), .low = 0.001, .high = 1000, .logarithmic = true},
    {.label = "falloff", .option = "falloff", .group = GROUP_SSAO, .kind = PARAM_CHOICE,
     .help = "smooth: weight 1 - (t/R)^2; threshold: 1 up to the radius",
     .offset = AT(ssao.falloff), .choices = falloffs},
    {.label = "slices", .option = "slices", .group = GROUP_SSAO, .kind = PARAM_UINT,
     .help = "directions, each marched to both sides",
     .offset = AT(ssao.slice_count), .low = 1, .high = 64, .logarithmic = true, .methods = SLICED},
    {.label = "steps", .option = "steps", .group = GROUP_SSAO, .kind = PARAM_UINT,
     .help = "samples on each side of a slice, or on each ray",
     .offset = AT(ssao.step_count), .low = 1, .high = 256, .logarithmic = true,
     .methods = SLICED | METHOD(RAYMARCH)},
    {.label = "samples", .option = "samples", .group = GROUP_SSAO, .kind = PARAM_UINT,
     .help = "points of sphere and hemisphere, rays of raymarch",
     .offset = AT(ssao.sample_count), .low = 1, .high = 1024, .logarithmic = true,
     .methods = METHOD(SPHERE) | METHOD(HEMISPHERE) | METHOD(RAYMARCH)},
    {.label = "thickness", .option = "thickness", .group = GROUP_SSAO, .kind = PARAM_FLOAT,
     .help = "how thick the scene is behind what is seen, relative to the measured default",
     .offset = AT(ssao.thickness), .low = 0.01, .high = 8, .logarithmic = true,
     .methods = METHOD(VBAO) | METHOD(RAYMARCH)},
    {.label = "bias", .option = "bias", .group = GROUP_SSAO, .kind = PARAM_FLOAT,
     .help = "share of the radius by which the scene must stand in front to block",
     .offset = AT(ssao.bias), .low = 0, .high = 1, .logarithmic = true},
    {.label = "sphere form", .option = "sphere-form", .group = GROUP_SSAO, .kind = PARAM_CHOICE,
     .help = "rescaled: a flat wall is open; literal: the textbook's",
     .offset = AT(ssao.sphere_form), .choices = forms, .methods = METHOD(SPHERE)},
    {.label = "blocking scale", .option = "blocking-scale", .group = GROUP_SSAO,
     .kind = PARAM_FLOAT, .help = "1 / scene units; the constant of the literal form",
     .offset = AT(ssao.blocking_scale), .low = 0.01, .high = 10000, .logarithmic = true,
     .methods = METHOD(SPHERE)},
    {.label = "noise index", .option = "noise-index", .group = GROUP_SSAO, .kind = PARAM_UINT,
     .help = "which noise pattern; 0: the static one",
     .offset = AT(ssao.noise_index), .low = 0, .high = 63},
    {.label = "half resolution", .group = GROUP_SSAO, .kind = PARAM_SWITCH,
     .help = "a fourth of the work, then depth- and normal-aware upsampling",
     .offset = AT(half_resolution)},
    {.label = "blur radius", .option = "blur", .group = GROUP_BLUR, .kind = PARAM_UINT,
     .help = "texels on each side; 0: intensity and power alone",
     .offset = AT(blur.radius), .low = 0, .high = 16},
    {.label = "sharpness", .option = "blur-sharpness", .group = GROUP_BLUR, .kind = PARAM_FLOAT,
     .help = "how strictly the blur stops at depth edges; 0: not at all",
     .offset = AT(blur.sharpness), .low = 0, .high = 10000, .logarithmic = true},
    {.label = "normal power", .option = "blur-normal-power", .group = GROUP_BLUR,
     .kind = PARAM_FLOAT, .help = "how strictly it stops where normals turn; 0: not at all",
     .offset = AT(blur.normal_power), .low = 0, .high = 128, .logarithmic = true},
    {.label = "intensity", .option = "intensity", .group = GROUP_BLUR, .kind = PARAM_FLOAT,
     .help = "scale of occlusion; 1 is physical",
     .offset = AT(blur.intensity), .low = 0, .high = 8},
    {.label = "power", .option = "power", .group = GROUP_BLUR, .kind = PARAM_FLOAT,
     .help = "exponent on visibility; 1 is physical",
     .offset = AT(blur.power), .low = 0.01, .high = 8},
    {.label = "mode", .group = GROUP_COMPOSITE, .kind = PARAM_CHOICE,
     .help = "multiply: color * ao; indirect: direct + color * ao",
     .offset = AT(composite.mode), .choices = modes},
    {.label = "strength", .option = "strength", .group = GROUP_COMPOSITE, .kind = PARAM_FLOAT,
     .help = "0: as if open everywhere",
     .offset = AT(composite.strength), .low = 0, .high = 1},
    {.label = "tint", .option = "tint", .group = GROUP_COMPOSITE, .kind = PARAM_COLOR,
     .help = "linear colour of full occlusion",
     .offset = AT(composite.tint), .low = 0, .high = 1},
    {.label = "multi-bounce", .group = GROUP_COMPOSITE, .kind = PARAM_SWITCH,
     .help = "brighten by the light that bounces on; needs an albedo image",
     .offset = AT(composite.multi_bounce), .needs = NEEDS_ALBEDO},
    {.label = "specular", .group = GROUP_COMPOSITE, .kind = PARAM_CHOICE,
     .help = "occlusion of indirect specular light; needs an image of it",
     .offset = AT(composite.specular), .choices = speculars, .needs = NEEDS_SPECULAR},
    {.label = "depth shown as 1", .group = GROUP_COMPOSITE, .kind = PARAM_FLOAT,
     .help = "scene units; the depth view shows this distance in white",
     .offset = AT(composite.debug_distance), .low = 0.001, .high = 1e6, .logarithmic = true},
};
/* clang-format on */
const size_t param_count = sizeof params / sizeof *params;

struct setting setting_default(void)
{
    return (struct setting){.ssao = ao_ssao_default(),
                            .blur = ao_blur_default(),
                            .composite = ao_composite_default()};
}

/* Of the member; every kind but a colour is one word of 32 bits. */
static size_t param_bytes(const struct param *param)
{
    _Static_assert(sizeof(VkBool32) == 4 && sizeof(vkao_ssao_method) == 4 && sizeof(float) == 4,
                   "every parameter is a word of 32 bits");
    return param->kind == PARAM_COLOR ? 3 * sizeof(float) : sizeof(float);
}

static bool same(const struct param *param, const struct setting *a, const struct setting *b)
{
    return memcmp(param_of_const(a, param), param_of_const(b, param), param_bytes(param)) == 0;
}

bool param_is_default(const struct param *param, const struct setting *setting)
{
    const struct setting standard = setting_default();
    return same(param, setting, &standard);
}

void param_reset(const struct param *param, struct setting *setting)
{
    const struct setting standard = setting_default();
    memcpy(param_of(setting, param), param_of_const(&standard, param), param_bytes(param));
}

void setting_apply_preset(struct setting *setting, vkao_quality quality)
{
    /* Fails for unknown qualities only, and then changes nothing. */
    (void)ao_preset(quality, &setting->half_resolution, &setting->ssao, &setting->blur);
}

const char *method_name(vkao_ssao_method method)
{
    for (const struct param_choice *c = methods; c->word; c++)
        if (c->value == (int)method)
            return c->word;
    return "";
}

bool method_has_bent(vkao_ssao_method method)
{
    return method == VKAO_SSAO_GTAO || method == VKAO_SSAO_VBAO || method == VKAO_SSAO_RAYMARCH;
}

struct setting setting_for_view(const struct setting *setting, enum view_kind view)
{
    struct setting s = *setting;
    if (view == VIEW_RAW) {
        s.blur.radius = 0;
        s.blur.intensity = s.blur.power = 1.0f;
    }
    return s;
}

/* --- Command line --- */

/* As few digits as bring the same float back. */
static void add_float(struct text *text, float value)
{
    char digits[32];
    for (int precision = 6; precision <= 9; precision++) {
        snprintf(digits, sizeof digits, "%.*g", precision, (double)value);
        float back = strtof(digits, NULL);
        if (memcmp(&back, &value, sizeof back) == 0)
            break;
    }
    text_add(text, "%s", digits);
}

static void add_choice(struct text *text, const struct param *param, int value)
{
    for (const struct param_choice *c = param->choices; c->word; c++)
        if (c->value == value)
            text_add(text, "%s", c->word);
}

static void add_value(struct text *text, const struct param *param, const struct setting *setting)
{
    const void *at = param_of_const(setting, param);
    int choice;
    switch (param->kind) {
    case PARAM_FLOAT:
        add_float(text, *(const float *)at);
        break;
    case PARAM_UINT:
    case PARAM_SWITCH:
        text_add(text, "%u", *(const uint32_t *)at);
        break;
    case PARAM_CHOICE:
        memcpy(&choice, at, sizeof choice);
        add_choice(text, param, choice);
        break;
    case PARAM_COLOR:
        for (int i = 0; i < 3; i++) {
            text_add(text, "%s", i ? "," : "");
            add_float(text, ((const float *)at)[i]);
        }
        break;
    }
}

/* vkao.h: zero means the default. The command line knows no zero. */
static void name_zeros(struct setting *s)
{
    const struct ao_ssao standard = ao_ssao_default();
    if (!s->ssao.slice_count)
        s->ssao.slice_count = standard.slice_count;
    if (!s->ssao.step_count)
        s->ssao.step_count = standard.step_count;
    if (!(s->ssao.thickness > 0.0f))
        s->ssao.thickness = standard.thickness;
}

void setting_add_options(const struct setting *setting, enum view_kind view, struct text *out,
                         struct text *unsaid)
{
    struct setting s = setting_for_view(setting, view), base = setting_default();
    /* What --quality decides is said only where it differs from that. */
    if (s.half_resolution)
        setting_apply_preset(&base, VKAO_QUALITY_FAST);
    if (s.half_resolution)
        text_add(out, " --quality fast");
    name_zeros(&s);
    for (size_t i = 0; i < param_count; i++) {
        const struct param *p = &params[i];
        const bool composite = p->group == GROUP_COMPOSITE;
        const bool always = p->offset == AT(ssao.radius) || p->offset == AT(ssao.bias);
        if ((composite && view != VIEW_COMPOSITE) || p->offset == AT(composite.debug_distance) ||
            p->offset == AT(half_resolution) || (!always && same(p, &s, &base)))
            continue;
        struct text *to = p->option ? out : unsaid;
        if (p->option)
            text_add(to, " --%s ", p->option);
        else
            text_add(to, "%s%s ", to->length ? ", " : "", p->label);
        add_value(to, p, &s);
    }
}
