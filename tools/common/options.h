/* SPDX-License-Identifier: MIT
 *
 * The command line. Every option is one row of the table in options_table.c: parsing, --help, the
 * man page and the suggestion for a misspelt one come from there; ranges, defaults, words and
 * explanations of what is a parameter of the library, from the library's table. */
#ifndef VKAO_TOOLS_OPTIONS_H_
#define VKAO_TOOLS_OPTIONS_H_

#include "automatic.h"
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
enum { MAX_OPTIONS = 96 };

/* What becomes of outputs that exist: a mistake, replaced, left alone. */
enum overwrite { OVERWRITE_NEVER, OVERWRITE_ALWAYS, OVERWRITE_SKIP };
enum output_mode { OUTPUT_AO, OUTPUT_APPEND, OUTPUT_COMP };

/* Strings point into argv. */
struct options {
    enum command command;
    bool help, version;
    const char *input;
    const char *file[ROLE_FILES]; /* of what is not in input; may hold a frame token */

    const char *output, *frames, *part_name, *channel, *preview;
    const char *like; /* EXR file whose record holds the settings; may hold a frame token */
    enum frame_syntax frame_syntax;
    enum output_mode mode;
    enum exr_pixel_type pixel_type;
    const char *compression; /* as exr_part.compression */
    enum overwrite overwrite;
    bool continue_on_error;

    const char *camera_file; /* may hold a frame token; "none": not that beside INPUT either */
    const char *view;        /* NULL = decide, "all" */
    struct gbuffer_options gbuffer;

    int quality; /* vkao_quality */
    /* By row: whether the option was given, and whether what was said last was 'auto'. */
    bool given[MAX_OPTIONS], automatic[MAX_OPTIONS];
    struct setting asked; /* members that options gave; the others mean nothing */
    /* What is left to the file: options_settle tells. */
    bool radius_is_auto, bias_is_given;
    struct relative_radius relative_radius; /* what radius_is_auto stands for */
    struct setting setting;                 /* by options, preset and record */

    const char *device;
    bool validation;
    uint32_t threads; /* of OpenEXR, 0 = as many as processors */
    bool json;
    const char *write_camera; /* where inspect writes what it found, or NULL */
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
    const char *help;     /* of a parameter: what there is to say beside its own help, or NULL */
    const char *more;     /* whole sentences that the man page adds, or NULL */
    unsigned commands;    /* enum command values or-ed */
    option_apply *apply;
    size_t offset; /* of the member of struct options that apply writes */
    /* Of a parameter: what the default, which the word auto stands for too, is; NULL: the
     * library's. */
    const char *automatic;
    bool has_off;                    /* of a parameter: the word off is 0 */
    bool is_radius;                  /* of a parameter: px or % may follow the number */
    struct option_range range;       /* not of parameters */
    const struct option_word *words; /* ends with a NULL word; likewise */
};

extern const struct option_row option_table[];
extern const size_t option_table_count;

/* Errors: EXIT_USAGE. */
bool options_parse(int argc, char **argv, struct options *options, struct tool_error *err);
/* Fills options->setting and what belongs to it. like: where what was not given comes from; NULL:
 * from --quality. Errors: EXIT_USAGE. */
bool options_settle(struct options *options, const struct setting *like, struct tool_error *err);
bool option_is_given(const struct options *options, const char *name);
/* The row whose option sets a parameter, NULL if none does; and the parameter of a row, or NULL. */
const struct option_row *option_of_parameter(const vkao_parameter *parameter);
const vkao_parameter *option_parameter(const struct option_row *row);
/* Of a parameter too. */
struct option_range option_range(const struct option_row *row);

extern const char options_example[];
/* The text of --help, at most 80 columns; and the options as the man page's source has them. */
void options_help(struct text *text);
void options_man(struct text *text);

/* Values of apply. */
option_apply apply_parameter, apply_flag, apply_text, apply_exr, apply_word, apply_double,
    apply_uint, apply_count, apply_bytes, apply_fov, apply_depth_range, apply_background,
    apply_normal, apply_layer, apply_compression, apply_verbose, apply_quiet;

#endif
