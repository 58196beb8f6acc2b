/* SPDX-License-Identifier: MIT
 *
 * What the panel can change, as one table: the panel shows a row for each parameter, and the
 * command line that Save writes comes from the same rows. Pure functions: no device, no window. */
#ifndef VKAO_VIEW_SETTINGS_H_
#define VKAO_VIEW_SETTINGS_H_

#include "text.h"
#include "setting.h"

#include <stdbool.h>
#include <stddef.h>

/* All that decides the AO of a G-buffer. */
struct setting {
    struct ao_ssao ssao;
    struct ao_blur blur;
    struct ao_composite composite;
    VkBool32 half_resolution;
};

enum view_kind {
    VIEW_RAW, /* before the blur, and without intensity and power */
    VIEW_AO,
    VIEW_COMPOSITE,
    VIEW_DEPTH,
    VIEW_NORMALS,
    VIEW_BENT,
    VIEW_DIFFERENCE, /* of AO to a reference */
    VIEW_KINDS
};

struct view_name {
    const char *word;  /* of --show */
    const char *title; /* in the panel and in the window's title */
};
extern const struct view_name view_names[VIEW_KINDS];

enum param_group { GROUP_SSAO, GROUP_BLUR, GROUP_COMPOSITE, GROUP_COUNT };
extern const char *const group_names[GROUP_COUNT];

enum param_kind { PARAM_FLOAT, PARAM_UINT, PARAM_CHOICE, PARAM_SWITCH, PARAM_COLOR };

/* Images of the G-buffer that a parameter or a choice needs. */
enum { NEEDS_DIRECT = 1, NEEDS_ALBEDO = 2, NEEDS_SPECULAR = 4, NEEDS_COLOR = 8 };

struct param_choice {
    const char *word; /* as the command line says it */
    int value;
    unsigned needs;
};

struct param {
    const char *label, *help;
    const char *option; /* of vkao, without dashes; NULL: vkao has none */
    enum param_group group;
    enum param_kind kind;
    size_t offset;    /* in struct setting */
    double low, high; /* what the panel offers: the range of vkao.h, cut where it is endless */
    bool logarithmic; /* the slider */
    unsigned methods; /* bits 1 << vkao_ssao_method of those that read it; 0 = all */
    unsigned needs;   /* without these images it has no effect */
    const struct param_choice *choices; /* PARAM_CHOICE: ends with a NULL word */
};
extern const struct param params[];
extern const size_t param_count;

/* vkao_*_default() of all. */
struct setting setting_default(void);
static inline void *param_of(struct setting *setting, const struct param *param)
{
    return (char *)setting + param->offset;
}
static inline const void *param_of_const(const struct setting *setting, const struct param *param)
{
    return (const char *)setting + param->offset;
}
bool param_is_default(const struct param *param, const struct setting *setting);
void param_reset(const struct param *param, struct setting *setting);
/* What vkao_preset decides; the rest stays. */
void setting_apply_preset(struct setting *setting, vkao_quality quality);

/* "vbao" */
const char *method_name(vkao_ssao_method method);
/* Whether VKAO_STAGE_BLUR can write bent normals after it. */
bool method_has_bent(vkao_ssao_method method);

/* What is computed for a view: the setting, but for the raw view without blur, intensity and
 * power. */
struct setting setting_for_view(const struct setting *setting, enum view_kind view);

/* Adds the options of vkao, a blank before each, that make it compute the view with this setting.
 * radius and bias are always said, since vkao would otherwise choose them by what is in the file.
 * What vkao has no option for goes to `unsaid`, as words. */
void setting_add_options(const struct setting *setting, enum view_kind view, struct text *out,
                         struct text *unsaid);

#endif
