/* SPDX-License-Identifier: MIT */
#include "setting.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* --- What images show --- */

struct ao_view ao_view_default(void)
{
    struct ao_view v = {.depth_encoding = VKAO_DEPTH_PROJECTED};
    v.normal_to_view[0] = v.normal_to_view[4] = v.normal_to_view[8] = 1.0f;
    return v;
}

vkao_view ao_library_view(const struct ao_view *view)
{
    vkao_view v = vkao_view_default();
    v.axis = view->axis;
    v.valid = view->valid;
    v.viewport = view->viewport;
    v.rect = view->rect;
    memcpy(v.projection, view->projection, sizeof v.projection);
    memcpy(v.normal_to_view, view->normal_to_view, sizeof v.normal_to_view);
    return v;
}

void ao_view_describe(const struct ao_view *view, vkao_effect_info *effect)
{
    /* Perspective matrices have view z in w. */
    const bool is_orthographic = view->projection[15] != 0.0f;
    effect->depth_encoding = view->depth_encoding;
    effect->normal_encoding = view->normal_encoding;
    effect->bent_encoding = view->bent_encoding;
    effect->projection =
        is_orthographic ? VKAO_PROJECTION_ORTHOGRAPHIC : VKAO_PROJECTION_PERSPECTIVE;
}

/* --- What is wanted of them --- */

struct setting setting_default(void)
{
    return (struct setting){.effect = vkao_effect_info_default(), .params = vkao_params_default()};
}

void setting_apply_preset(struct setting *setting, vkao_quality quality)
{
    /* Fails for unknown qualities only, and then changes nothing. */
    (void)vkao_preset(quality, &setting->effect, &setting->params);
}

const char *const quality_names[QUALITY_COUNT] = {
    [VKAO_QUALITY_FAST] = "fast",
    [VKAO_QUALITY_DEFAULT] = "default",
    [VKAO_QUALITY_HIGH] = "high",
    [VKAO_QUALITY_BEST] = "best",
};

static const vkao_method *method_of(vkao_ssao_method method)
{
    uint32_t count;
    const vkao_method *methods = vkao_methods(&count);
    return (uint32_t)method < count ? &methods[method] : NULL;
}

const char *method_name(vkao_ssao_method method)
{
    const vkao_method *m = method_of(method);
    return m ? m->name : "";
}

bool method_has_bent(vkao_ssao_method method)
{
    const vkao_method *m = method_of(method);
    return m && m->has_bent_normals;
}

void version_string(char version[VERSION_BYTES])
{
    const uint32_t v = vkao_version();
    snprintf(version, VERSION_BYTES, "%u.%u.%u", VK_API_VERSION_MAJOR(v), VK_API_VERSION_MINOR(v),
             VK_API_VERSION_PATCH(v));
}

/* --- One parameter --- */

const vkao_parameter *parameter_named(const char *name)
{
    uint32_t count;
    const vkao_parameter *all = vkao_parameters(&count);
    for (uint32_t i = 0; i < count; i++)
        if (strcmp(all[i].name, name) == 0)
            return &all[i];
    return NULL;
}

const vkao_parameter *parameter_at(size_t offset)
{
    uint32_t count;
    const vkao_parameter *all = vkao_parameters(&count);
    for (uint32_t i = 0; i < count; i++)
        if (parameter_offset(&all[i]) == offset)
            return &all[i];
    return NULL;
}

size_t parameter_offset(const vkao_parameter *p)
{
    return (p->is_compiled ? offsetof(struct setting, effect) : offsetof(struct setting, params)) +
           p->offset;
}

size_t parameter_bytes(const vkao_parameter *p)
{
    _Static_assert(sizeof(VkBool32) == 4 && sizeof(vkao_ssao_method) == 4 && sizeof(float) == 4,
                   "every other parameter is a word of 32 bits");
    return p->type == VKAO_PARAMETER_COLOR ? 3 * sizeof(float) : sizeof(float);
}

bool parameter_equals(const vkao_parameter *p, const struct setting *a, const struct setting *b)
{
    return memcmp(parameter_of_const(a, p), parameter_of_const(b, p), parameter_bytes(p)) == 0;
}

void parameter_copy(const vkao_parameter *p, struct setting *to, const struct setting *from)
{
    memcpy(parameter_of(to, p), parameter_of_const(from, p), parameter_bytes(p));
}

bool parameter_is_of_images(const vkao_parameter *p)
{
    static const size_t offsets[] = {
        offsetof(vkao_effect_info, depth_encoding),
        offsetof(vkao_effect_info, normal_encoding),
        offsetof(vkao_effect_info, bent_encoding),
        offsetof(vkao_effect_info, projection),
    };
    for (size_t i = 0; p->is_compiled && i < sizeof offsets / sizeof *offsets; i++)
        if (p->offset == offsets[i])
            return true;
    return false;
}

struct parameter_range parameter_range(const vkao_parameter *p)
{
    struct parameter_range r = {p->least, p->most, p->above_least};
    if (p->type == VKAO_PARAMETER_FLOAT && p->most >= (double)FLT_MAX)
        r.high = INFINITY;
    if (p->zero_is_standard && p->type == VKAO_PARAMETER_FLOAT)
        r.low_is_excluded = true;
    else if (p->zero_is_standard)
        r.low = 1;
    return r;
}

void text_add_float(struct text *text, float value)
{
    char digits[32];
    for (int precision = 6; precision <= 9; precision++) {
        snprintf(digits, sizeof digits, "%.*g", precision, (double)value);
        const float back = (float)strtod(digits, NULL);
        if (memcmp(&back, &value, sizeof back) == 0)
            break;
    }
    text_add(text, "%s", digits);
}

void parameter_add_value(struct text *text, const vkao_parameter *p, const struct setting *setting)
{
    float numbers[3];
    uint32_t word;
    memcpy(numbers, parameter_of_const(setting, p), parameter_bytes(p));
    memcpy(&word, parameter_of_const(setting, p), sizeof word);
    switch (p->type) {
    case VKAO_PARAMETER_FLOAT:
        text_add_float(text, numbers[0]);
        break;
    case VKAO_PARAMETER_COLOR:
        for (int i = 0; i < 3; i++) {
            text_add(text, "%s", i ? "," : "");
            text_add_float(text, numbers[i]);
        }
        break;
    case VKAO_PARAMETER_CHOICE:
        text_add(text, "%s", (double)word <= p->most ? p->choices[word] : "");
        break;
    default:
        text_add(text, "%u", word);
    }
}
