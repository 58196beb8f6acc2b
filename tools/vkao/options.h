/* SPDX-License-Identifier: MIT
 *
 * The command line. Every option is one row of the table in options_table.c: parsing, ranges,
 * defaults, --help and the suggestion for a misspelt one come from there. */
#ifndef VKAO_TOOLS_OPTIONS_H_
#define VKAO_TOOLS_OPTIONS_H_

#include "error.h"
#include "frames.h"
#include "gbuffer.h"
#include "report.h"
#include "text.h"
#include "setting.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum command { COMMAND_RENDER = 1, COMMAND_INSPECT = 2, COMMAND_DEVICES = 4 };
/* In blur.radius and blur.normal_power until the preset fills them. */
#define BLUR_BY_QUALITY UINT32_MAX
#define NORMAL_POWER_BY_QUALITY (-1.0f)

enum output_mode { OUTPUT_AO, OUTPUT_APPEND, OUTPUT_COMP };

/* Strings point into argv. */
struct options {
    enum command command;
    bool help, version;
    const char *input;

    const char *output, *frames, *part_name, *preview;
    enum frame_syntax frame_syntax;
    enum output_mode mode;
    enum exr_pixel_type pixel_type;
    const char *compression; /* as exr_part.compression */
    int overwrite;
    bool continue_on_error;

    const char *camera_file; /* may hold a frame token */
    const char *view;        /* NULL = decide, "all" */
    struct gbuffer_options gbuffer;

    bool radius_is_auto, bias_is_given;
    int quality; /* vkao_quality */
    bool half_resolution, bent_normals;
    struct ao_ssao ssao; /* slice_count, step_count and thickness 0 until the preset
                              fills them */
    struct ao_blur blur;
    struct ao_composite composite;

    const char *device;
    bool validation;
    uint32_t threads; /* of OpenEXR, 0 = as many as processors */
    bool json;
    enum verbosity verbosity;
};

struct option_row;
typedef bool option_apply(struct options *options, const struct option_row *row,
                          const char *argument, struct tool_error *err);

/* A number's range. high = INFINITY: no upper end. */
struct option_range {
    double low, high;
    bool low_is_excluded, infinity_is_allowed;
};

struct option_word {
    const char *word;
    int value;
};

struct option_row {
    const char *heading;  /* printed above it in --help, or NULL */
    const char *name;     /* without dashes */
    char letter;          /* 0 = no short form */
    const char *argument; /* as --help shows it; NULL = takes none */
    const char *fallback; /* default, applied before argv is read; NULL = leave zero */
    const char *help;
    unsigned commands; /* enum command values or-ed */
    option_apply *apply;
    size_t offset; /* of the member of struct options that apply writes */
    struct option_range range;
    const struct option_word *words; /* ends with a NULL word */
};

extern const struct option_row option_table[];
extern const size_t option_table_count;

/* Errors: EXIT_USAGE. */
bool options_parse(int argc, char **argv, struct options *options, struct tool_error *err);
/* The text of --help, at most 80 columns. */
void options_help(struct text *text);

/* Values of apply. */
option_apply apply_flag, apply_text, apply_word, apply_float, apply_double, apply_uint,
    apply_count, apply_bytes, apply_radius, apply_bias, apply_blur, apply_normal_power, apply_tint,
    apply_fov, apply_normal, apply_compression, apply_verbose, apply_quiet;

#endif
