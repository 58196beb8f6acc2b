/* SPDX-License-Identifier: MIT */
#include "configs.h"

#include "text.h"

#include <stdio.h>
#include <string.h>

static const struct config default_set[] = {
    {.name = "vbao-fast",
     .method = VKAO_SSAO_VBAO,
     .is_preset = true,
     .quality = VKAO_QUALITY_FAST},
    {.name = "vbao-default",
     .method = VKAO_SSAO_VBAO,
     .is_preset = true,
     .quality = VKAO_QUALITY_DEFAULT},
    {.name = "vbao-high",
     .method = VKAO_SSAO_VBAO,
     .is_preset = true,
     .quality = VKAO_QUALITY_HIGH},
    {.name = "vbao-best",
     .method = VKAO_SSAO_VBAO,
     .is_preset = true,
     .quality = VKAO_QUALITY_BEST},
    {.name = "gtao-3x6", .method = VKAO_SSAO_GTAO, .slices = 3, .steps = 6},
    {.name = "gtao-1x8", .method = VKAO_SSAO_GTAO, .slices = 1, .steps = 8},
    {.name = "hbao-4x6", .method = VKAO_SSAO_HBAO, .slices = 4, .steps = 6},
    {.name = "hemisphere-16", .method = VKAO_SSAO_HEMISPHERE, .samples = 16},
    {.name = "hemisphere-64", .method = VKAO_SSAO_HEMISPHERE, .samples = 64},
    {.name = "sphere-48", .method = VKAO_SSAO_SPHERE, .samples = 48},
};
enum { DEFAULT_COUNT = sizeof default_set / sizeof default_set[0] };

/* What the two numbers of a setting are. The limits are those of vkao_effect_info. */
static const struct method_row {
    const char *name;
    bool has_samples, has_slices, has_steps;
} methods[] = {
    [VKAO_SSAO_SPHERE] = {"sphere", true, false, false},
    [VKAO_SSAO_HEMISPHERE] = {"hemisphere", true, false, false},
    [VKAO_SSAO_HBAO] = {"hbao", false, true, true},
    [VKAO_SSAO_GTAO] = {"gtao", false, true, true},
    [VKAO_SSAO_VBAO] = {"vbao", false, true, true},
    [VKAO_SSAO_RAYMARCH] = {"raymarch", true, false, true},
};
enum { METHOD_COUNT = sizeof methods / sizeof methods[0], MAX_FIRST = 64, MAX_STEPS = 256 };

struct config config_yardstick(void)
{
    return (struct config){.name = "raymarch",
                           .method = VKAO_SSAO_RAYMARCH,
                           .samples = 64,
                           .steps = 64,
                           .is_yardstick = true};
}

const char *config_method_name(const struct config *config)
{
    return methods[config->method].name;
}

static bool add(const char *option, struct config_list *list, const struct config *config,
                struct tool_error *err)
{
    if (list->count == MAX_CONFIGS)
        return fail(err, EXIT_USAGE, "%s names more than %d settings", option, (int)MAX_CONFIGS);
    for (size_t i = 0; i < list->count; i++)
        if (strcmp(list->rows[i].name, config->name) == 0)
            return true;
    list->rows[list->count++] = *config;
    return true;
}

/* "gtao-2x12", "hemisphere-32"; leaves *config alone if it is neither. */
static bool parse_setting(const char *name, struct config *config)
{
    struct config c = {0};
    unsigned first = 0, steps = 0;
    int end = 0;
    size_t length = strcspn(name, "-");
    for (size_t m = 0; m < METHOD_COUNT; m++) {
        const struct method_row *row = &methods[m];
        if (strncmp(row->name, name, length) != 0 || row->name[length] || !name[length])
            continue;
        const char *numbers = name + length + 1;
        bool fits = row->has_steps ? sscanf(numbers, "%3ux%3u%n", &first, &steps, &end) == 2
                                   : sscanf(numbers, "%3u%n", &first, &end) == 1;
        bool in_range = first >= 1 && first <= MAX_FIRST && steps <= MAX_STEPS;
        if (!fits || numbers[end] || !in_range || (row->has_steps && steps == 0))
            return false;
        c.method = (vkao_ssao_method)m;
        c.samples = row->has_samples ? first : 0;
        c.slices = row->has_slices ? first : 0;
        c.steps = steps;
        /* The numbers again, so that 'gtao-03x06' is no other setting than 'gtao-3x6'. */
        if (row->has_steps)
            snprintf(c.name, sizeof c.name, "%s-%ux%u", row->name, first, steps);
        else
            snprintf(c.name, sizeof c.name, "%s-%u", row->name, first);
        *config = c;
        return true;
    }
    return false;
}

/* By its name, its method, or, of a preset, what stands behind the method: "fast". */
static bool is_called(const struct config *row, const char *name)
{
    const char *method = config_method_name(row);
    return strcmp(row->name, name) == 0 || strcmp(method, name) == 0 ||
           (row->is_preset && strcmp(row->name + strlen(method) + 1, name) == 0);
}

static bool add_named(const char *option, struct config_list *list, const char *name,
                      struct tool_error *err)
{
    bool found = false;
    struct config free_form;
    for (size_t i = 0; i < DEFAULT_COUNT; i++) {
        const struct config *row = &default_set[i];
        if (!is_called(row, name))
            continue;
        found = true;
        if (!add(option, list, row, err))
            return false;
    }
    if (found)
        return true;
    if (parse_setting(name, &free_form))
        return add(option, list, &free_form, err);
    struct text known = {0};
    for (size_t i = 0; i < DEFAULT_COUNT; i++)
        text_add(&known, "%s%s", i ? ", " : "", default_set[i].name);
    fail_hint(err, "known: %s; or METHOD-SAMPLES, METHOD-SLICESxSTEPS",
              known.data ? known.data : "");
    text_free(&known);
    return fail(err, EXIT_USAGE, "%s: no setting '%s'", option, name);
}

bool configs_choose(const char *option, const char *names, struct config_list *list,
                    struct tool_error *err)
{
    *list = (struct config_list){0};
    for (size_t i = 0; !names && i < DEFAULT_COUNT; i++)
        list->rows[list->count++] = default_set[i];
    while (names && *names) {
        char name[64];
        size_t length = strcspn(names, ",");
        snprintf(name, sizeof name, "%.*s", (int)length, names);
        names += length + (names[length] == ',');
        if (*name && !add_named(option, list, name, err))
            return false;
    }
    return list->count > 0 || fail(err, EXIT_USAGE, "%s names nothing", option);
}

void config_apply(const struct config *config, struct ao_job *job)
{
    vkao_effect_info *effect = &job->setting.effect;
    job->setting = setting_default();
    if (config->is_preset) {
        setting_apply_preset(&job->setting, config->quality);
        return;
    }
    effect->method = config->method;
    if (config->samples)
        effect->sample_count = config->samples;
    if (config->slices)
        effect->slice_count = config->slices;
    if (config->steps)
        effect->step_count = config->steps;
    /* Averaging takes the noise away without taking detail along. */
    if (config->is_yardstick)
        effect->blur_radius = 0;
}

void config_describe(const struct config *config, char *text, size_t size)
{
    struct ao_job job = {0};
    const struct method_row *row = &methods[config->method];
    config_apply(config, &job);
    unsigned first = row->has_slices ? job.setting.effect.slice_count : job.setting.effect.sample_count;
    const char *half = job.setting.effect.half_resolution ? ", half resolution" : "";
    if (row->has_steps)
        snprintf(text, size, "%s %u x %u%s", row->name, first, job.setting.effect.step_count, half);
    else
        snprintf(text, size, "%s %u%s", row->name, first, half);
}
