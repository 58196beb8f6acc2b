/* SPDX-License-Identifier: MIT
 *
 * The options, one row each, and above them what they do with their arguments. */
#include "options.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* --- Parameters of the library --- */

const vkao_parameter *option_parameter(const struct option_row *row)
{
    return row->apply == apply_parameter
               ? parameter_at(row->offset - offsetof(struct options, asked))
               : NULL;
}

const struct option_row *option_of_parameter(const vkao_parameter *parameter)
{
    for (size_t i = 0; i < option_table_count; i++)
        if (option_parameter(&option_table[i]) == parameter)
            return &option_table[i];
    return NULL;
}

struct option_range option_range(const struct option_row *row)
{
    const vkao_parameter *p = option_parameter(row);
    if (!p)
        return row->range;
    const struct parameter_range r = parameter_range(p);
    return (struct option_range){r.low, r.high, r.low_is_excluded, false};
}

/* --- Words --- */

static void *member(struct options *options, const struct option_row *row)
{
    return (char *)options + row->offset;
}

bool apply_flag(struct options *options, const struct option_row *row, const char *argument,
                struct tool_error *err)
{
    (void)argument;
    (void)err;
    *(bool *)member(options, row) = true;
    return true;
}

bool apply_text(struct options *options, const struct option_row *row, const char *argument,
                struct tool_error *err)
{
    if (!*argument)
        return fail(err, EXIT_USAGE, "--%s is empty", row->name);
    *(const char **)member(options, row) = argument;
    return true;
}

/* Of what is written: EXR has no longer ones for channels. */
static bool apply_name(struct options *options, const struct option_row *row, const char *argument,
                       struct tool_error *err)
{
    enum { MOST = 255 };
    const size_t bytes = strlen(argument);
    if (bytes > MOST)
        return fail(err, EXIT_USAGE, "--%s is of %zu bytes, want at most %d", row->name, bytes,
                    MOST);
    return apply_text(options, row, argument, err);
}

/* What the name of a file says of its contents must be true. */
bool apply_exr(struct options *options, const struct option_row *row, const char *argument,
               struct tool_error *err)
{
    if (!text_has_extension(argument, ".exr")) {
        const char *name = text_base_name(argument);
        const size_t stem = strcspn(name, ".");
        if (text_has_extension(argument, ".png"))
            fail_hint(err, "-o %.*s.exr --preview %s writes both", (int)stem, name, argument);
        else if (stem > 0 && strcmp(argument, "-") != 0)
            fail_hint(err, "-o %s.exr; oiiotool and ImageMagick make other formats of it",
                      argument);
        else
            fail_hint(err, "give a file: -o ao.exr");
        return !*argument ? apply_text(options, row, argument, err)
                          : fail(err, EXIT_USAGE,
                                 "--%s is '%s', want a name that ends in .exr: EXR is what is "
                                 "written%s",
                                 row->name, argument,
                                 strcmp(argument, "-") == 0 ? ", and not to a pipe" : "");
    }
    return apply_text(options, row, argument, err);
}

bool apply_word(struct options *options, const struct option_row *row, const char *argument,
                struct tool_error *err)
{
    _Static_assert(sizeof(enum depth_type) == sizeof(int) && sizeof(vkao_falloff) == sizeof(int),
                   "enums are written as int");
    struct text wanted = {0};
    for (const struct option_word *w = row->words; w->word; w++) {
        if (strcmp(w->word, argument) == 0) {
            memcpy(member(options, row), &w->value, sizeof w->value);
            text_free(&wanted);
            return true;
        }
        text_add(&wanted, "%s%s", w == row->words ? "" : w[1].word ? ", " : " or ", w->word);
    }
    fail(err, EXIT_USAGE, "--%s is '%s', want %s", row->name, argument,
         wanted.data ? wanted.data : "");
    text_free(&wanted);
    return false;
}

/* --- Numbers --- */

static bool fail_range(const struct option_row *row, const char *argument, bool whole,
                       struct tool_error *err)
{
    const struct option_range r = option_range(row);
    const char *noun = whole ? "whole number" : r.infinity_is_allowed ? "number" : "finite number";
    char wanted[96];
    if (isinf(r.high))
        snprintf(wanted, sizeof wanted, "%s %g", r.low_is_excluded ? ">" : ">=", r.low);
    else
        snprintf(wanted, sizeof wanted, "%s %.10g and <= %.10g",
                 r.low_is_excluded ? ">" : ">=", r.low, r.high);
    if (row->is_radius)
        fail_hint(err, "3.5 is scene units, 3.5px rows of the image, 3.5%% of the median distance");
    return fail(err, EXIT_USAGE, "--%s is %s, want a %s %s", row->name, argument, noun, wanted);
}

static bool in_range(const struct option_row *row, double value)
{
    const struct option_range r = option_range(row);
    bool low = r.low_is_excluded ? value > r.low : value >= r.low;
    bool high = isinf(r.high) ? r.infinity_is_allowed || isfinite(value) : value <= r.high;
    return low && high;
}

static bool read_number(const struct option_row *row, const char *argument, double *value,
                        struct tool_error *err)
{
    if (!text_to_number(argument, value) || !in_range(row, *value))
        return fail_range(row, argument, false, err);
    return true;
}

bool apply_double(struct options *options, const struct option_row *row, const char *argument,
                  struct tool_error *err)
{
    return read_number(row, argument, member(options, row), err);
}

static bool read_integer(const struct option_row *row, const char *argument, int64_t *value,
                         struct tool_error *err)
{
    if (!text_to_integer(argument, value) || !in_range(row, (double)*value))
        return fail_range(row, argument, true, err);
    return true;
}

bool apply_uint(struct options *options, const struct option_row *row, const char *argument,
                struct tool_error *err)
{
    int64_t value;
    if (!read_integer(row, argument, &value, err))
        return false;
    *(uint32_t *)member(options, row) = (uint32_t)value;
    return true;
}

bool apply_count(struct options *options, const struct option_row *row, const char *argument,
                 struct tool_error *err)
{
    int64_t value;
    if (!read_integer(row, argument, &value, err))
        return false;
    *(uint64_t *)member(options, row) = (uint64_t)value;
    return true;
}

bool apply_bytes(struct options *options, const struct option_row *row, const char *argument,
                 struct tool_error *err)
{
    return budget_parse_bytes(argument, member(options, row)) ||
           fail(err, EXIT_USAGE, "--%s is %s, want bytes, as 800M or 4G", row->name, argument);
}

/* --- Members of the library's structs --- */

static bool read_float(const struct option_row *row, const char *argument, float *number,
                       struct tool_error *err)
{
    double value;
    if (!read_number(row, argument, &value, err))
        return false;
    /* 1e-50 is in the range of double only. */
    *number = (float)value;
    return in_range(row, (double)*number) || fail_range(row, argument, false, err);
}

static bool read_color(const struct option_row *row, const char *argument, float color[3],
                       struct tool_error *err)
{
    const struct option_range r = option_range(row);
    const char *from = argument;
    for (int i = 0; i < 3; i++) {
        char number[64];
        double value;
        int length = (int)strcspn(from, ",");
        snprintf(number, sizeof number, "%.*s", length, from);
        from += length;
        bool ends_well = i < 2 ? *from++ == ',' : !*from;
        if (!ends_well || !text_to_number(number, &value) || !in_range(row, value))
            return fail(err, EXIT_USAGE, "--%s is %s, want R,G,B, each >= %g and <= %g", row->name,
                        argument, r.low, r.high);
        color[i] = (float)value;
    }
    return true;
}

static bool read_choice(const struct option_row *row, const vkao_parameter *p, const char *argument,
                        uint32_t *choice, struct tool_error *err)
{
    const uint32_t count = (uint32_t)p->most + 1;
    for (*choice = 0; *choice < count; ++*choice)
        if (strcmp(p->choices[*choice], argument) == 0)
            return true;
    struct text wanted = {0};
    text_add_list(&wanted, p->choices, (1u << count) - 1u, "or");
    fail(err, EXIT_USAGE, "--%s is '%s', want %s", row->name, argument,
         wanted.data ? wanted.data : "");
    text_free(&wanted);
    return false;
}

/* '25px' and '5%': settled when the depth is known. */
static bool read_relative_radius(const struct option_row *row, const char *argument, bool *is_one,
                                 struct relative_radius *radius, struct tool_error *err)
{
    char number[64];
    radius->in_pixels = text_ends_with(argument, "px");
    *is_one = radius->in_pixels || text_ends_with(argument, "%");
    if (!*is_one)
        return true;
    snprintf(number, sizeof number, "%.*s", (int)strlen(argument) - (radius->in_pixels ? 2 : 1),
             argument);
    return (text_to_number(number, &radius->amount) &&
            in_range(row, (double)(float)radius->amount)) ||
           fail_range(row, argument, false, err);
}

bool apply_parameter(struct options *options, const struct option_row *row, const char *argument,
                     struct tool_error *err)
{
    const vkao_parameter *p = option_parameter(row);
    float numbers[3] = {0};
    uint32_t word = VK_TRUE;
    int64_t whole = 0;
    bool ok = true;
    if (!p)
        return fail(err, EXIT_BUG, "--%s is no parameter", row->name);
    bool *automatic = &options->automatic[row - option_table];
    *automatic = row->automatic && strcmp(argument, "auto") == 0;
    if (row->is_radius) {
        options->relative_radius = (struct relative_radius){0};
        if (!*automatic &&
            !read_relative_radius(row, argument, automatic, &options->relative_radius, err))
            return false;
    }
    if (*automatic)
        return true;
    if (row->has_off && strcmp(argument, "off") == 0)
        argument = "0";
    switch (p->type) {
    case VKAO_PARAMETER_FLOAT:
        ok = read_float(row, argument, numbers, err);
        break;
    case VKAO_PARAMETER_COLOR:
        ok = read_color(row, argument, numbers, err);
        break;
    case VKAO_PARAMETER_CHOICE:
        ok = read_choice(row, p, argument, &word, err);
        break;
    case VKAO_PARAMETER_UINT:
        ok = read_integer(row, argument, &whole, err);
        word = (uint32_t)whole;
        break;
    default:
        break;
    }
    const bool is_number = p->type == VKAO_PARAMETER_FLOAT || p->type == VKAO_PARAMETER_COLOR;
    const void *value = is_number ? (const void *)numbers : &word;
    if (ok)
        memcpy(member(options, row), value, parameter_bytes(p));
    return ok;
}

/* --- What has a form of its own --- */

bool apply_fov(struct options *options, const struct option_row *row, const char *argument,
               struct tool_error *err)
{
    const char *colon = strchr(argument, ':');
    char number[64];
    double value;
    snprintf(number, sizeof number, "%.*s", colon ? (int)(colon - argument) : (int)strlen(argument),
             argument);
    bool axis = !colon || strcmp(colon, ":h") == 0 || strcmp(colon, ":v") == 0;
    if (!axis || !text_to_number(number, &value) || !(value > 0 && value < 180))
        return fail(err, EXIT_USAGE,
                    "--%s is %s, want degrees > 0 and < 180, followed by :h or :v or nothing",
                    row->name, argument);
    options->gbuffer.camera.fov_deg = value;
    options->gbuffer.camera.fov_is_vertical = colon && colon[1] == 'v';
    return true;
}

bool apply_depth_range(struct options *options, const struct option_row *row, const char *argument,
                       struct tool_error *err)
{
    char near_number[64], far_number[64];
    double near_distance = 0, far_distance = 0;
    const size_t first = strcspn(argument, ",");
    const char *rest = argument[first] ? argument + first + 1 : "";
    const size_t length = strcspn(rest, ",");
    const bool is_inverted = strcmp(rest + length, ",inverted") == 0;
    snprintf(near_number, sizeof near_number, "%.*s", (int)first, argument);
    snprintf(far_number, sizeof far_number, "%.*s", (int)length, rest);
    if (!text_to_number(near_number, &near_distance) ||
        !text_to_number(far_number, &far_distance) || !(near_distance >= 0) ||
        !(far_distance > near_distance) || !isfinite(far_distance) ||
        (rest[length] && !is_inverted))
        return fail(err, EXIT_USAGE,
                    "--%s is %s, want NEAR,FAR or NEAR,FAR,inverted: two distances, 0 <= NEAR < "
                    "FAR",
                    row->name, argument);
    options->gbuffer.depth_range =
        (struct depth_range){.is_given = true,
                             .zero = is_inverted ? far_distance : near_distance,
                             .one = is_inverted ? near_distance : far_distance};
    return true;
}

bool apply_background(struct options *options, const struct option_row *row, const char *argument,
                      struct tool_error *err)
{
    struct gbuffer_options *g = &options->gbuffer;
    double distance = 0;
    g->background_value = 0;
    g->background = strcmp(argument, "auto") == 0  ? BACKGROUND_AUTO
                    : strcmp(argument, "off") == 0 ? BACKGROUND_OFF
                                                   : BACKGROUND_GIVEN;
    if (g->background != BACKGROUND_GIVEN)
        return true;
    if (!text_to_number(argument, &distance) || !(distance > 0) || !isfinite(distance))
        return fail(err, EXIT_USAGE, "--%s is %s, want auto, off or a distance > 0", row->name,
                    argument);
    g->background_value = distance;
    return true;
}

bool apply_normal(struct options *options, const struct option_row *row, const char *argument,
                  struct tool_error *err)
{
    options->gbuffer.roles.no_normals = strcmp(argument, "none") == 0;
    if (!options->gbuffer.roles.no_normals)
        return apply_text(options, row, argument, err);
    *(const char **)member(options, row) = NULL;
    return true;
}

/* none takes back what a record brings. */
bool apply_layer(struct options *options, const struct option_row *row, const char *argument,
                 struct tool_error *err)
{
    if (strcmp(argument, "none") != 0)
        return apply_text(options, row, argument, err);
    *(const char **)member(options, row) = NULL;
    return true;
}

bool apply_compression(struct options *options, const struct option_row *row, const char *argument,
                       struct tool_error *err)
{
    for (size_t i = 0; i < EXR_COMPRESSIONS; i++)
        if (strcmp(exr_compression_names[i], argument) == 0)
            return apply_text(options, row, argument, err);
    return fail(err, EXIT_USAGE, "--%s is '%s', want %s", row->name, argument, row->help);
}

bool apply_verbose(struct options *options, const struct option_row *row, const char *argument,
                   struct tool_error *err)
{
    (void)row;
    (void)argument;
    (void)err;
    options->verbosity = REPORT_VERBOSE;
    return true;
}

bool apply_quiet(struct options *options, const struct option_row *row, const char *argument,
                 struct tool_error *err)
{
    (void)row;
    (void)argument;
    (void)err;
    options->verbosity = REPORT_QUIET;
    return true;
}

/* --- The table --- */

#define AT(member) offsetof(struct options, member)
/* A member of the library's structs: range, default, words and help are those of its row there. */
#define PARAMETER(option, member)                                                                  \
    .name = option, .commands = COMMAND_RENDER, .apply = apply_parameter, .offset = AT(asked.member)
#define BY_QUALITY .automatic = "by --quality"
#define RENDER COMMAND_RENDER
#define INSPECT COMMAND_INSPECT
#define DEVICES COMMAND_DEVICES
#define ABOVE_ZERO                                                                                 \
    {                                                                                              \
        .low = 0, .high = INFINITY, .low_is_excluded = true                                        \
    }
#define FROM_TO(from, to)                                                                          \
    {                                                                                              \
        .low = (from), .high = (to)                                                                \
    }

static const struct option_word modes[] = {
    {"ao", OUTPUT_AO}, {"append", OUTPUT_APPEND}, {"comp", OUTPUT_COMP}, {0}};
static const struct option_word syntaxes[] = {
    {"vfx", FRAME_SYNTAX_VFX}, {"openjd", FRAME_SYNTAX_OPENJD}, {0}};
static const struct option_word pixel_types[] = {{"half", EXR_HALF}, {"float", EXR_FLOAT}, {0}};
static const struct option_word overwrites[] = {
    {"never", OVERWRITE_NEVER}, {"always", OVERWRITE_ALWAYS}, {"skip", OVERWRITE_SKIP}, {0}};
static const struct option_word depth_types[] = {{"auto", DEPTH_AUTO},
                                                 {"planar", DEPTH_PLANAR},
                                                 {"radial", DEPTH_RADIAL},
                                                 {"radial-near", DEPTH_RADIAL_NEAR},
                                                 {"inverse", DEPTH_INVERSE},
                                                 {"device", DEPTH_DEVICE},
                                                 {"normalized", DEPTH_NORMALIZED},
                                                 {0}};
static const struct option_word spaces[] = {{"auto", NORMAL_SPACE_AUTO},
                                            {"world", NORMAL_SPACE_WORLD},
                                            {"camera", NORMAL_SPACE_CAMERA},
                                            {0}};
static const struct option_word encodings[] = {{"auto", NORMAL_ENCODING_AUTO},
                                               {"signed", NORMAL_ENCODING_SIGNED},
                                               {"unsigned", NORMAL_ENCODING_UNSIGNED},
                                               {0}};
static const struct option_word qualities[] = {{"fast", VKAO_QUALITY_FAST},
                                               {"default", VKAO_QUALITY_DEFAULT},
                                               {"high", VKAO_QUALITY_HIGH},
                                               {"best", VKAO_QUALITY_BEST},
                                               {0}};

/* clang-format off */
const struct option_row option_table[] = {
    {.heading = "Files", .name = "output", .letter = 'o', .argument = "FILE",
     .help = "EXR file to write; with a frame token if INPUT has one",
     .commands = RENDER, .apply = apply_exr, .offset = AT(output),
     .more = "It appears whole or not at all, and must not be the input."},
    {.name = "mode", .argument = "MODE", .fallback = "ao",
     .help = "ao: a file with AO alone; append: all of INPUT, untouched, and a new part "
             "'ao'; comp: colour times AO",
     .commands = RENDER, .apply = apply_word, .offset = AT(mode), .words = modes,
     .more = "Of a stereo file each view has a part of its own, ao.VIEW. append leaves pixels "
             "and attributes as they are. comp writes R, G and B into a part named like that "
             "of the colour, with its A untouched."},
    {.name = "part-name", .argument = "NAME",
     .help = "name of the new part, instead of ao",
     .commands = RENDER, .apply = apply_name, .offset = AT(part_name)},
    {.name = "channel", .argument = "NAME",
     .help = "name of the channel of AO. Default: R, G and B alike, a grey image that every "
             "program shows; AO with --mode append",
     .commands = RENDER, .apply = apply_name, .offset = AT(channel),
     .more = "To a file of Blender's with a layer ViewLayer, --mode append adds a part "
             "ViewLayer.AO with a channel ViewLayer.AO.V, which its compositor lists among the "
             "passes; SSAO if there is a pass AO already. Give --part-name and --channel to choose "
             "both."},
    {.name = "like", .argument = "FILE",
     .help = "take every setting from the record in FILE, which vkao wrote; other options come "
             "before it. May hold a frame token",
     .commands = RENDER, .apply = apply_text, .offset = AT(like),
     .more = "The record holds all that decides the picture: parameters, channels and what "
             "they mean, camera, mode, pixel type and compression. The same vkao on the same "
             "device makes the same pixels of it, to the bit. A sequence with one record takes "
             "its camera for all frames."},
    {.name = "pixel-type", .argument = "TYPE", .fallback = "half",
     .help = "half or float",
     .commands = RENDER, .apply = apply_word, .offset = AT(pixel_type), .words = pixel_types},
    {.name = "compression", .argument = "NAME", .fallback = "zip",
     .help = "none, rle, zips, zip, piz, pxr24, b44, b44a, dwaa or dwab",
     .commands = RENDER, .apply = apply_compression, .offset = AT(compression)},
    {.name = "preview", .argument = "FILE",
     .help = "write an 8-bit PNG too: AO * 255 without gamma, or the composite in sRGB",
     .commands = RENDER, .apply = apply_text, .offset = AT(preview),
     .more = "Its name ends in .png. The composite is clamped. Of several views each gets its name "
             "put before the extension."},
    {.name = "overwrite", .argument = "WHEN", .fallback = "never",
     .help = "never, always or skip: what to do if an output exists",
     .commands = RENDER | INSPECT, .apply = apply_word, .offset = AT(overwrite),
     .words = overwrites,
     .more = "skip leaves frames alone whose output exists, and makes the others, as after a run "
             "that was interrupted. They get what all frames share, as an automatic radius or a "
             "camera that is estimated, from the first frame that exists and shows something: "
             "the record in it has the radius, and it is computed again for the rest. Settings "
             "that differ from its own are a warning. A preview goes with its output: where "
             "that is missing, one that a killed run left, as it says itself, is replaced. An "
             "empty file and a directory are not left alone: they stop the run. Symbolic links "
             "are followed, except those to nothing: whatever WHEN is, these stop the run."},
    {.name = "frames", .letter = 'f', .argument = "SPEC",
     .help = "frames of a sequence: 1-100, 1-100x2 (every second), 1,5,20-30. Default: all files"
             " that match INPUT",
     .commands = RENDER, .apply = apply_text, .offset = AT(frames),
     .more = "Numbers may be negative, and ranges may go down. 1-10:2 is refused: it means "
             "different things to different tools."},
    {.name = "frames-syntax", .argument = "NAME", .fallback = "vfx",
     .help = "vfx, or openjd: 1-100:2 is then a step",
     .commands = RENDER, .apply = apply_word, .offset = AT(frame_syntax), .words = syntaxes},
    {.name = "continue-on-error",
     .help = "go on with the next frame; exit status 1 if any failed",
     .commands = RENDER, .apply = apply_flag, .offset = AT(continue_on_error)},
    {.heading = "Channels", .name = "depth", .argument = "NAME",
     .help = "channel, layer or part/channel. Default: found by the names that renderers use",
     .commands = RENDER | INSPECT, .apply = apply_text,
     .offset = AT(gbuffer.roles.name[ROLE_DEPTH])},
    {.name = "depth-file", .argument = "FILE",
     .help = "EXR file that the depth is in, if not in INPUT; with a frame token if INPUT has one",
     .commands = RENDER | INSPECT, .apply = apply_text, .offset = AT(file[ROLE_DEPTH]),
     .more = "For renderers that write a file for each element. What is alone in such a file "
             "needs no name: R of a grey depth pass is depth. Its display window must be that "
             "of INPUT. The camera is that of this file's header, or else of INPUT's."},
    {.name = "depth-type", .argument = "TYPE", .fallback = "auto",
     .help = "planar: along the view axis; radial: from the eye; radial-near: along the ray from"
             " the near plane (Mitsuba); inverse: 1/planar (Nuke); device: a depth buffer; "
             "normalized: 0..1. auto: by name and by what flat things look like, else planar",
     .commands = RENDER | INSPECT, .apply = apply_word, .offset = AT(gbuffer.depth_type),
     .words = depth_types,
     .more = "radial-near needs the near plane; device needs both planes, and holds values "
             "from 0 to 1; normalized needs --depth-range. What auto cannot tell from 0..1 is "
             "refused, as is a depth that is the same everywhere. Whole numbers are scene units; "
             "of device and normalized they are parts of the largest of 8, 16, 24 or 32 bits that "
             "holds them all: 1 is 255, 65535, 16777215 or 4294967295. Whole numbers of other "
             "bits are said, and those that nothing shows to be distances are refused. Where depth "
             "is from 0 to 1 --near with --far, or --depth-range, say the type too."},
    {.name = "depth-range", .argument = "NEAR,FAR[,inverted]",
     .help = "distances that 0 and 1 stand for, of normalized depth; inverted: 1 and 0",
     .commands = RENDER | INSPECT, .apply = apply_depth_range, .offset = AT(gbuffer.depth_range),
     .more = "In scene units, along the view axis. Exactly 0 and 1 are background: that is where "
             "renderers clamp."},
    {.name = "background", .argument = "DISTANCE", .fallback = "auto",
     .help = "as far as this or farther there is nothing, in the unit of depth; or off. auto: what"
             " is far behind all else and always the same",
     .commands = RENDER | INSPECT, .apply = apply_background,
     .offset = AT(gbuffer.background_value),
     .more = "0, infinities and 1e10 are background in any case. auto takes a far value that "
             "repeats for background if it is the far plane, if alpha or normals are 0 there, or "
             "if it is three times as far as nearly all else and no floor reaches it."},
    {.name = "normal", .argument = "NAME",
     .help = "layer of the normals, or none: derive them from depth",
     .commands = RENDER | INSPECT, .apply = apply_normal,
     .offset = AT(gbuffer.roles.name[ROLE_NORMAL])},
    {.name = "normal-file", .argument = "FILE",
     .help = "EXR file that the normals are in, likewise",
     .commands = RENDER | INSPECT, .apply = apply_text, .offset = AT(file[ROLE_NORMAL]),
     .more = "R, G and B alone in it are normals."},
    {.name = "normal-space", .argument = "SPACE", .fallback = "auto",
     .help = "world or camera. auto: by name, camera and looks",
     .commands = RENDER | INSPECT, .apply = apply_word, .offset = AT(gbuffer.normal_space),
     .words = spaces,
     .more = "world needs the rotation of the camera. camera has +x to the right and +y up, "
             "and either sign of z. auto takes what the name says; else world if the rotation "
             "is known; else camera if the normals look so."},
    {.name = "normal-encoding", .argument = "ENC", .fallback = "auto",
     .help = "signed (-1..1) or unsigned (0..1)",
     .commands = RENDER | INSPECT, .apply = apply_word, .offset = AT(gbuffer.normal_encoding),
     .words = encodings},
    {.name = "color", .argument = "NAME",
     .help = "layer of the colour, for --mode comp",
     .commands = RENDER | INSPECT, .apply = apply_text,
     .offset = AT(gbuffer.roles.name[ROLE_COLOR])},
    {.name = "color-file", .argument = "FILE",
     .help = "EXR file that the colour is in, likewise",
     .commands = RENDER | INSPECT, .apply = apply_text, .offset = AT(file[ROLE_COLOR])},
    {.name = "indirect", .argument = "NAME",
     .help = "layer of indirect light, the part of the colour that AO darkens, for --mode comp. "
             "Default: all of it",
     .commands = RENDER | INSPECT, .apply = apply_layer,
     .offset = AT(gbuffer.roles.name[ROLE_INDIRECT]),
     .more = "In the units of the colour, with the albedo in it: the composite is the colour less "
             "this, plus this times AO."},
    {.name = "albedo", .argument = "NAME",
     .help = "layer of diffuse reflectance: AO is brightened by light that bounces on, for --mode "
             "comp",
     .commands = RENDER | INSPECT, .apply = apply_layer,
     .offset = AT(gbuffer.roles.name[ROLE_ALBEDO]),
     .more = "After Jimenez et al. 2016, for each colour."},
    {.name = "specular", .argument = "NAME",
     .help = "layer of indirect specular light, which is in the colour and is darkened by a factor "
             "of its own, for --mode comp; needs normals",
     .commands = RENDER | INSPECT, .apply = apply_layer,
     .offset = AT(gbuffer.roles.name[ROLE_SPECULAR]),
     .more = "By AO and roughness (Lagarde and de Rousiers 2014); with --bent-normals by the cone "
             "around the bent normal (Oat and Sander 2007)."},
    {.name = "roughness", .argument = "NAME",
     .help = "channel of roughness, 0 to 1, for --specular. Default: 0.5 everywhere",
     .commands = RENDER | INSPECT, .apply = apply_layer,
     .offset = AT(gbuffer.roles.name[ROLE_ROUGHNESS])},
    {.name = "holdout", .argument = "NAME",
     .help = "channel of a matte, 0 to 1, or crypto:OBJECT[,...], by Cryptomatte: what it covers "
             "gets no AO, and still casts it",
     .commands = RENDER | INSPECT, .apply = apply_layer,
     .offset = AT(gbuffer.roles.name[ROLE_HOLDOUT]),
     .more = "AO becomes 1 - (1 - AO) (1 - matte), and with --mode comp the colour is mixed with "
             "what it was."},
    {.name = "no-cast", .argument = "NAME",
     .help = "channel of a matte, or crypto:OBJECT[,...]: what is 0.5 or more is taken for "
             "background, casts nothing and gets AO 1",
     .commands = RENDER | INSPECT, .apply = apply_layer,
     .offset = AT(gbuffer.roles.name[ROLE_NO_CAST]),
     .more = "What is behind it is not known, so it leaves a hole: render without the object "
             "where its place is to get AO."},
    {.name = "thickness-channel", .argument = "NAME",
     .help = "channel of how thick things are at each texel, along the view axis, in scene units; "
             "for vbao and raymarch",
     .commands = RENDER | INSPECT, .apply = apply_layer,
     .offset = AT(gbuffer.roles.name[ROLE_THICKNESS]),
     .more = "What is not above 0 is unknown. none: as without the option, also with --like."},
    {.name = "back-depth", .argument = "NAME",
     .help = "channel of where the surface ends that depth sees, of the same depth type; for vbao "
             "and raymarch",
     .commands = RENDER | INSPECT, .apply = apply_layer,
     .offset = AT(gbuffer.roles.name[ROLE_BACK_DEPTH]),
     .more = "Instead of --thickness-channel. Background, and what is not behind depth, is "
             "unknown. none: as without the option, also with --like."},
    {.name = "layer2", .argument = "NAME",
     .help = "channel of the depth of what lies next behind the first surface, of the same depth "
             "type; for vbao and raymarch",
     .commands = RENDER | INSPECT, .apply = apply_layer,
     .offset = AT(gbuffer.roles.name[ROLE_LAYER2]),
     .more = "Background where there is nothing. none: as without the option, also with --like."},
    {.name = "view", .argument = "NAME",
     .help = "one view of a stereo file, or all. Default: all if the camera file has views",
     .commands = RENDER | INSPECT, .apply = apply_text, .offset = AT(view)},
    {.heading = "Camera", .name = "camera", .argument = "FILE",
     .help = "JSON camera, see vkao(1); may hold a frame token. Default: FILE.camera.json beside "
             "FILE.exr, else what header, positions, or depth and normals say",
     .commands = RENDER | INSPECT, .apply = apply_text, .offset = AT(camera_file),
     .more = "none: not the file beside INPUT either. Where one frame has a file beside it, all "
             "must; with --like, the camera is that of the record. "
             "Options come before the camera file, and that before the header. Where nobody tells, "
             "positions do, exactly, or depth and normals, with a bound; where these cannot, 40 "
             "degrees are assumed. Either is said in a warning."},
    {.name = "write-camera", .argument = "FILE",
     .help = "inspect: write the camera that was found, as --camera reads it",
     .commands = INSPECT, .apply = apply_text, .offset = AT(write_camera),
     .more = "Its name ends in .json. Of a sequence, that of the first frame that shows "
             "something, or with a frame token that of each frame that does. It is an error if "
             "none was found."},
    {.name = "fov", .argument = "DEG[:h|v]",
     .help = "field of view over the display window, horizontal (h) or vertical",
     .commands = RENDER | INSPECT, .apply = apply_fov, .offset = AT(gbuffer.camera.fov_deg)},
    {.name = "ortho", .argument = "WIDTH",
     .help = "orthographic; scene units over the display window",
     .commands = RENDER | INSPECT, .apply = apply_double, .offset = AT(gbuffer.camera.ortho_width),
     .range = ABOVE_ZERO},
    {.name = "near", .argument = "DISTANCE",
     .help = "near plane, for depth types radial-near and device",
     .commands = RENDER | INSPECT, .apply = apply_double, .offset = AT(gbuffer.camera.near_plane),
     .range = {.low = 0, .high = INFINITY, .low_is_excluded = true, .infinity_is_allowed = true},
     .more = "In scene units. Either plane may be inf for device depth."},
    {.name = "far", .argument = "DISTANCE",
     .help = "far plane, for depth type device; may be inf. near > far: reversed",
     .commands = RENDER | INSPECT, .apply = apply_double, .offset = AT(gbuffer.camera.far_plane),
     .range = {.low = 0, .high = INFINITY, .low_is_excluded = true, .infinity_is_allowed = true}},
    {.heading = "Ambient occlusion",
     PARAMETER("method", effect.method), .letter = 'm', .argument = "NAME"},
    {.name = "quality", .argument = "NAME", .fallback = "default",
     .help = "fast (half resolution), default, high or best: slices, steps and blur at once",
     .commands = RENDER, .apply = apply_word, .offset = AT(quality), .words = qualities,
     .more = "One setting for all scenes."},
    {PARAMETER("slices", effect.slice_count), .argument = "N", BY_QUALITY},
    {PARAMETER("steps", effect.step_count), .argument = "N", BY_QUALITY},
    {PARAMETER("thickness", params.thickness), .argument = "X", BY_QUALITY},
    {PARAMETER("bent-normals", effect.bent_normals),
     .help = "as channels bent.X, .Y, .Z in the space of the normals"},
    {PARAMETER("sphere-form", effect.sphere_form), .argument = "FORM"},
    {PARAMETER("radius", params.radius), .letter = 'r', .argument = "R",
     .is_radius = true,
     .help = "or Npx: so many rows of the image at the median distance; N%: percent of that "
             "distance. Both by the first frame that shows something, and kept for the others",
     .automatic = "5%, in two digits",
     .more = "What px, % and auto make is rounded to three digits and printed: give that number "
             "to all when parts of a sequence are computed by several processes."},
    {PARAMETER("falloff", effect.falloff), .argument = "NAME",
     .help = "smooth is weight 1 - (t/R)^2, threshold weight 1 up to R"},
    {PARAMETER("samples", effect.sample_count), .letter = 's', .argument = "N"},
    {PARAMETER("bias", params.bias), .argument = "B",
     .help = "raised for half depth if not given"},
    {PARAMETER("blocking-scale", params.blocking_scale), .argument = "S"},
    {PARAMETER("noise-index", params.noise_index), .argument = "N"},
    {PARAMETER("intensity", params.intensity), .letter = 'i', .argument = "X"},
    {PARAMETER("power", params.power), .letter = 'p', .argument = "X"},
    {PARAMETER("blur", effect.blur_radius), .letter = 'b', .argument = "N", .has_off = true,
     BY_QUALITY},
    {PARAMETER("blur-sharpness", params.sharpness), .argument = "X", BY_QUALITY},
    {PARAMETER("blur-normal-power", effect.blur_normal_power), .argument = "X", BY_QUALITY},
    {PARAMETER("strength", params.strength), .argument = "X"},
    {PARAMETER("tint", params.tint), .argument = "R,G,B"},
    {.heading = "Running", .name = "device", .letter = 'd', .argument = "NAME", .fallback = "auto",
     .help = "auto, cpu, a number from 'vkao devices' or part of a name",
     .commands = RENDER, .apply = apply_text, .offset = AT(device),
     .more = "auto takes a discrete GPU, else an integrated one, else the CPU."},
    {.name = "max-memory", .argument = "SIZE",
     .help = "refuse what needs more, of host and device together: 800M, 4G. Default: 3/4 of the "
             "machine's",
     .commands = RENDER | INSPECT, .apply = apply_bytes, .offset = AT(gbuffer.budget.memory),
     .more = "What is needed is reckoned from the header, before pixels are read. The memory "
             "of the machine is what control groups and resource limits leave of it."},
    {.name = "max-pixels", .argument = "N", .fallback = "268435456",
     .help = "refuse images of more pixels",
     .commands = RENDER | INSPECT, .apply = apply_count, .offset = AT(gbuffer.budget.pixels),
     .range = FROM_TO(1, 1073741824),
     .more = "1 to 1073741824."},
    {.name = "threads", .argument = "N", .fallback = "0",
     .help = "threads that read and write EXR, at most 256; 0: one for each processor",
     .commands = RENDER | INSPECT, .apply = apply_uint, .offset = AT(threads),
     .range = FROM_TO(0, EXR_MOST_THREADS)},
    {.name = "validation",
     .help = "run with the Vulkan validation layers",
     .commands = RENDER, .apply = apply_flag, .offset = AT(validation)},
    {.name = "json",
     .help = "inspect and devices: print JSON",
     .commands = INSPECT | DEVICES, .apply = apply_flag, .offset = AT(json)},
    {.name = "verbose", .letter = 'v',
     .help = "times per frame, and what was found",
     .commands = RENDER | INSPECT | DEVICES, .apply = apply_verbose, .offset = AT(verbosity)},
    {.name = "quiet", .letter = 'q',
     .help = "errors only",
     .commands = RENDER | INSPECT | DEVICES, .apply = apply_quiet, .offset = AT(verbosity)},
    {.name = "version", .letter = 'V',
     .help = "print versions",
     .commands = RENDER | INSPECT | DEVICES, .apply = apply_flag, .offset = AT(version)},
    {.name = "help", .letter = 'h',
     .help = "print this",
     .commands = RENDER | INSPECT | DEVICES, .apply = apply_flag, .offset = AT(help)},
};
/* clang-format on */
const size_t option_table_count = sizeof option_table / sizeof *option_table;
_Static_assert(sizeof option_table / sizeof *option_table <= MAX_OPTIONS,
               "options.given holds them all");
