/* SPDX-License-Identifier: MIT
 *
 * What is measured: methods with their settings, and the presets of the library. Everything else
 * is as the library's *_default() functions have it: intensity 1, power 1, the default blur. */
#ifndef VKAO_BENCH_CONFIGS_H_
#define VKAO_BENCH_CONFIGS_H_

#include "ao.h"
#include "error.h"
#include "setting.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { MAX_CONFIGS = 40 };

struct config {
    char name[32]; /* "vbao-default", "gtao-3x6", "sphere-48" */
    vkao_ssao_method method;
    bool is_preset; /* quality says the rest */
    vkao_quality quality;
    uint32_t samples;       /* sphere, hemisphere; rays of raymarch */
    uint32_t slices, steps; /* hbao, gtao, vbao; raymarch has steps only */
    bool is_yardstick;      /* averaged over passes, unblurred: the converged raymarch */
};

struct config_list {
    struct config rows[MAX_CONFIGS];
    size_t count;
};

/* names: comma-separated, each a row of the default set, a preset ("fast"), a method (all its rows
 * of that set), or any setting: METHOD-SAMPLES, METHOD-SLICESxSTEPS, raymarch-RAYSxSTEPS. NULL =
 * the default set. option: the one that the names came with, for messages. Errors: EXIT_USAGE. */
bool configs_choose(const char *option, const char *names, struct config_list *list,
                    struct tool_error *err);
/* Rays that converge when averaged over noise patterns. */
struct config config_yardstick(void);

/* Fills ssao, blur and half_resolution; radius and falloff are the caller's to set after it. */
void config_apply(const struct config *config, struct ao_job *job);
const char *config_method_name(const struct config *config);
/* Any setting by its numbers, of which it has those that the method reads; and its name. */
struct config config_of(vkao_ssao_method method, unsigned samples, unsigned slices, unsigned steps);
/* Whether a method reads a member of vkao_effect_info: "step_count". */
bool config_reads(vkao_ssao_method method, const char *name);
/* name: length bytes of it. False if there is no such method. */
bool config_find_method(const char *name, size_t length, vkao_ssao_method *method);
/* "vbao 1 x 10, half resolution" */
void config_describe(const struct config *config, char *text, size_t size);

#endif
