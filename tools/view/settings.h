/* SPDX-License-Identifier: MIT
 *
 * What the panel can change: the library's table of parameters, and what a panel adds to it; and
 * the command line that Save writes, from the same rows. Pure functions: no device, no window. */
#ifndef VKAO_VIEW_SETTINGS_H_
#define VKAO_VIEW_SETTINGS_H_

#include "setting.h"
#include "text.h"

#include <stdbool.h>
#include <stddef.h>

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

/* Sections of the panel. A parameter stands where the last stage that reads it does, but for what
 * SSAO reads. */
enum param_group { GROUP_SSAO, GROUP_BLUR, GROUP_COMPOSITE, GROUP_COUNT };
extern const char *const group_names[GROUP_COUNT];

/* Images of the G-buffer that a parameter or a choice needs. */
enum { NEEDS_DIRECT = 1, NEEDS_ALBEDO = 2, NEEDS_SPECULAR = 4, NEEDS_COLOR = 8 };

/* A row of the panel. */
struct param {
    const vkao_parameter *parameter;
    char label[32];
    enum param_group group;
    double low, high; /* what a slider offers: the range, cut where it is endless */
    bool logarithmic; /* the slider */
    unsigned needs;   /* without these images it has no effect */
};
enum { MAX_PARAMS = 64 };
/* In the order of the panel: all but what images or the view decide. */
const struct param *panel_params(size_t *count);
/* Whether the images that are there leave a choice open. */
bool choice_is_open(const struct param *param, uint32_t choice, unsigned there);
/* The last of the choices that the panel offers: what comes after it are views of their own. */
uint32_t last_choice(const struct param *param);

void param_reset(const struct param *param, struct setting *setting);

/* What is computed for a view: the setting, but without thickness and second layer where the method
 * does not read them, and for the raw view without blur, intensity and power. */
struct setting setting_for_view(const struct setting *setting, enum view_kind view);
/* As vkao would have it from the options that setting_add_options adds. */
struct setting setting_as_said(const struct setting *setting, enum view_kind view);

/* Adds the options of vkao, a blank before each, that make it compute the view with this setting.
 * radius and bias are always said, since vkao would otherwise choose them by what is in the file.
 * What vkao has no option for goes to `unsaid`, as words. */
void setting_add_options(const struct setting *setting, enum view_kind view, struct text *out,
                         struct text *unsaid);

#endif
