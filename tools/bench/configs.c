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

/* --- What the library's tables say of the numbers of a setting --- */

bool config_reads(vkao_ssao_method method, const char *name)
{
    const vkao_parameter *row = parameter_named(name);
    return row && (row->methods == 0 || (row->methods >> method & 1u));
}

static bool is_in_range(const char *name, unsigned count)
{
    const vkao_parameter *row = parameter_named(name);
    return row && count >= 1 && (double)count <= row->most;
}

bool config_find_method(const char *name, size_t length, vkao_ssao_method *method)
{
    uint32_t count;
    const vkao_method *rows = vkao_methods(&count);
    for (uint32_t m = 0; m < count; m++) {
        if (strlen(rows[m].name) == length && strncmp(rows[m].name, name, length) == 0) {
            *method = (vkao_ssao_method)m;
            return true;
        }
    }
    return false;
}

const char *config_method_name(const struct config *config)
{
    uint32_t count;
    return vkao_methods(&count)[config->method].name;
}

struct config config_of(vkao_ssao_method method, unsigned samples, unsigned slices, unsigned steps)
{
    struct config c = {.method = method};
    c.samples = config_reads(method, "sample_count") ? samples : 0;
    c.slices = config_reads(method, "slice_count") ? slices : 0;
    c.steps = config_reads(method, "step_count") ? steps : 0;
    const unsigned first = c.slices ? c.slices : c.samples;
    if (c.steps)
        snprintf(c.name, sizeof c.name, "%s-%ux%u", config_method_name(&c), first, c.steps);
    else
        snprintf(c.name, sizeof c.name, "%s-%u", config_method_name(&c), first);
    return c;
}

/* --- The list --- */

struct config config_yardstick(void)
{
    return (struct config){.name = "raymarch",
                           .method = VKAO_SSAO_RAYMARCH,
                           .samples = 64,
                           .steps = 64,
                           .is_yardstick = true};
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

/* "gtao-2x12", "hemisphere-32"; leaves *config alone if it is neither. Its name has the numbers
 * again, so that 'gtao-03x06' is no other setting than 'gtao-3x6'. */
static bool parse_setting(const char *name, struct config *config)
{
    vkao_ssao_method method;
    unsigned first = 0, steps = 0;
    int end = 0;
    size_t length = strcspn(name, "-");
    if (!name[length] || !config_find_method(name, length, &method))
        return false;
    const char *numbers = name + length + 1;
    const char *what = config_reads(method, "slice_count") ? "slice_count" : "sample_count";
    const bool has_steps = config_reads(method, "step_count");
    bool fits = has_steps ? sscanf(numbers, "%4ux%3u%n", &first, &steps, &end) == 2
                          : sscanf(numbers, "%4u%n", &first, &end) == 1;
    if (!fits || numbers[end] || !is_in_range(what, first) ||
        (has_steps && !is_in_range("step_count", steps)))
        return false;
    *config = config_of(method, first, first, steps);
    return true;
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
    config_apply(config, &job);
    unsigned first = config_reads(config->method, "slice_count") ? job.setting.effect.slice_count
                                                                 : job.setting.effect.sample_count;
    const char *half = job.setting.effect.half_resolution ? ", half resolution" : "";
    if (config_reads(config->method, "step_count"))
        snprintf(text, size, "%s %u x %u%s", config_method_name(config), first,
                 job.setting.effect.step_count, half);
    else
        snprintf(text, size, "%s %u%s", config_method_name(config), first, half);
}
