/* SPDX-License-Identifier: MIT */
#include "arguments.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define KEYS                                                                                       \
    "Keys: 1 raw AO 2 AO 3 composite 4 depth 5 normals 6 bent normals 7 difference\n"              \
    "  Tab A or B   W wipe: drag the line   P panel   S save   F1 ? help  Q, Esc quit\n"           \
    "  + - wheel zoom   drag pan   0, F fit   Z 1:1   Left Right frames of a sequence\n"           \
    "  Ctrl+Z, Y undo, redo   Ctrl+C copies what the mouse is on   Ctrl+O, drop: open\n"           \
    "  Live: drag turns, right drag moves, wheel nears, O projection, Space the clock\n"

const char arguments_keys[] = KEYS;

const char arguments_help[] =
    "Usage: vkao-view [FILE.exr] [OPTION]...     FILE may hold a frame token: ####\n"
    "       vkao-view --scene cubes|room [OPTION]...\n"
    "Ambient occlusion of a G-buffer, or of a live scene, in a window.\n"
    "  --show NAME         raw, ao, composite, depth, normals, bent or difference\n"
    "  --reference FILE    what difference compares to; else FILE.gt.exr if there\n"
    "  --versus 'OPTIONS'  setting B: that of A, changed by these options of vkao\n"
    "  --wipe X            A left and B right of X, from 0 to 1 of the width\n"
    "  --zoom X            screen texels per texel; else the image fits the window\n"
    "  --size WxH          of the window; else it fits the image\n"
    "  --screenshot FILE   PNG of the last frame; --frames N: end after N of them\n"
    "  --save STEM         S writes STEM.sh, .exr and .png; else FILE.view.sh ...\n"
    "  --exposure STOPS    of the composite; --show-range NEAR,FAR: of the depth view\n"
    "  --time X            a live scene's clock stands still at X seconds\n"
    "  --panel-scale X     else by monitor and window; --no-panel\n"
    "  --help, --version; --validation, --device NAME; and what says how\n"
    "  to read a file and what AO of it is wanted, as vkao has it: see 'vkao --help'.\n"
    "  The camera is that of --camera, FILE.camera.json if there, or the header's.\n" KEYS
    "Exit status: 0 done, 2 usage, 3 input, 4 channels, 5 no display or no device,\n"
    "6 output, 33 out of memory, 70 a validation message or other mistake of vkao.\n";

struct own_option {
    const char *name;
    bool takes_argument;
    bool (*apply)(struct arguments *a, const char *argument);
    const char *wanted; /* by apply */
};

static bool take_help(struct arguments *a, const char *argument)
{
    (void)argument;
    return a->help = true;
}

static bool take_version(struct arguments *a, const char *argument)
{
    (void)argument;
    return a->version = true;
}

static bool take_no_panel(struct arguments *a, const char *argument)
{
    (void)argument;
    return a->no_panel = true;
}

static bool take_scene(struct arguments *a, const char *argument)
{
    a->scene = argument;
    return strcmp(argument, "cubes") == 0 || strcmp(argument, "room") == 0;
}

static bool take_screenshot(struct arguments *a, const char *argument)
{
    a->screenshot = argument;
    return *argument;
}

static bool take_reference(struct arguments *a, const char *argument)
{
    a->reference = argument;
    return *argument;
}

static bool take_save(struct arguments *a, const char *argument)
{
    a->save = argument;
    return *argument;
}

static bool take_versus(struct arguments *a, const char *argument)
{
    a->versus = argument;
    return strlen(argument) < sizeof a->versus_words;
}

static bool take_frames(struct arguments *a, const char *argument)
{
    int64_t n;
    if (!text_to_integer(argument, &n) || n < 1 || n > 1000000)
        return false;
    a->frames = (uint32_t)n;
    return true;
}

static bool take_size(struct arguments *a, const char *argument)
{
    char width[16];
    const char *x = strchr(argument, 'x');
    int64_t w, h;
    if (!x)
        return false;
    snprintf(width, sizeof width, "%.*s", (int)(x - argument), argument);
    if (!text_to_integer(width, &w) || !text_to_integer(x + 1, &h) || w < 1 || h < 1 || w > 16384 ||
        h > 16384)
        return false;
    a->width = (uint32_t)w;
    a->height = (uint32_t)h;
    return true;
}

static bool take_show(struct arguments *a, const char *argument)
{
    for (int v = 0; v < VIEW_KINDS; v++) {
        if (strcmp(view_names[v].word, argument) == 0) {
            a->view = (enum view_kind)v;
            return true;
        }
    }
    return false;
}

static bool take_zoom(struct arguments *a, const char *argument)
{
    return text_to_number(argument, &a->zoom) && a->zoom >= 1.0 / 64 && a->zoom <= 64;
}

static bool take_wipe(struct arguments *a, const char *argument)
{
    return text_to_number(argument, &a->wipe) && a->wipe >= 0 && a->wipe <= 1;
}

static bool take_exposure(struct arguments *a, const char *argument)
{
    return text_to_number(argument, &a->exposure) && a->exposure >= -MAX_STOPS &&
           a->exposure <= MAX_STOPS;
}

static bool take_show_range(struct arguments *a, const char *argument)
{
    char near_number[64];
    const char *comma = strchr(argument, ',');
    if (!comma)
        return false;
    snprintf(near_number, sizeof near_number, "%.*s", (int)(comma - argument), argument);
    return text_to_number(near_number, &a->near) && text_to_number(comma + 1, &a->far) &&
           a->near >= 0 && a->far > a->near && isfinite(a->far);
}

static bool take_panel_scale(struct arguments *a, const char *argument)
{
    return text_to_number(argument, &a->panel_scale) && a->panel_scale >= 1 && a->panel_scale <= 4;
}

static bool take_time(struct arguments *a, const char *argument)
{
    return text_to_number(argument, &a->time) && a->time >= 0 && a->time <= 1e6;
}

static const struct own_option own_options[] = {
    {"help", false, take_help, ""},
    {"version", false, take_version, ""},
    {"no-panel", false, take_no_panel, ""},
    {"scene", true, take_scene, "cubes or room"},
    {"screenshot", true, take_screenshot, "a file"},
    {"reference", true, take_reference, "a file"},
    {"save", true, take_save, "a path"},
    {"versus", true, take_versus, "options of vkao"},
    {"frames", true, take_frames, "a whole number >= 1 and <= 1000000"},
    {"size", true, take_size, "WIDTHxHEIGHT, each >= 1 and <= 16384"},
    {"show", true, take_show, "raw, ao, composite, depth, normals, bent or difference"},
    {"zoom", true, take_zoom, "a number >= 1/64 and <= 64"},
    {"wipe", true, take_wipe, "a number >= 0 and <= 1"},
    {"exposure", true, take_exposure, "stops >= -10 and <= 10"},
    {"show-range", true, take_show_range, "NEAR,FAR, 0 <= NEAR < FAR"},
    {"panel-scale", true, take_panel_scale, "a number >= 1 and <= 4"},
    {"time", true, take_time, "a number >= 0 and <= 1000000"},
};

/* Of vkao, but not for a viewer. */
static const char *const foreign[] = {
    "output",  "mode",      "part-name", "channel",       "pixel-type",   "compression",
    "preview", "overwrite", "json",      "frames-syntax", "write-camera", "continue-on-error",
    "like"};

static const struct own_option *find_own(const char *name, size_t length)
{
    for (size_t i = 0; i < sizeof own_options / sizeof *own_options; i++)
        if (strlen(own_options[i].name) == length &&
            strncmp(own_options[i].name, name, length) == 0)
            return &own_options[i];
    return NULL;
}

/* By name or, after one dash, by letter. */
static const struct option_row *find_foreign(const char *word, size_t length)
{
    for (size_t i = 0; i < option_table_count; i++) {
        const struct option_row *row = &option_table[i];
        if (word[1] != '-' && row->letter && row->letter == word[1])
            return row;
        if (word[1] == '-' && strlen(row->name) == length - 2 &&
            strncmp(row->name, word + 2, length - 2) == 0)
            return row;
    }
    return NULL;
}

/* Whether Save takes the option from the settings, or need not repeat it. */
static bool is_of_settings(const struct option_row *row)
{
    static const char *const more[] = {"quality", "frames",  "validation",
                                       "threads", "verbose", "quiet"};
    for (size_t i = 0; i < sizeof more / sizeof *more; i++)
        if (strcmp(more[i], row->name) == 0)
            return true;
    return option_parameter(row) != NULL;
}

static bool fail_usage(struct tool_error *err)
{
    return fail_hint(err, "'vkao-view --help' lists the options");
}

/* What is left for vkao's own parser. */
struct words {
    char *list[MAX_WORDS + 8];
    size_t count;
};

static bool add_word(struct words *words, char *word, struct tool_error *err)
{
    if (words->count + 4 >= MAX_WORDS)
        return fail(err, EXIT_USAGE, "more than %d arguments", MAX_WORDS);
    words->list[words->count++] = word;
    return true;
}

static bool take_own(struct arguments *a, const struct own_option *own, const char *argument,
                     struct tool_error *err)
{
    if (own->apply(a, argument))
        return true;
    fail(err, EXIT_USAGE, "--%s is '%s', want %s", own->name, argument, own->wanted);
    return fail_usage(err);
}

/* One option of vkao at argv[*i], with its argument. */
static bool pass_on(struct arguments *a, int argc, char **argv, int *i, struct words *words,
                    struct tool_error *err)
{
    char *word = argv[*i];
    size_t length = strcspn(word, "=");
    const struct option_row *row = find_foreign(word, length);
    bool two = row && row->argument && !word[length] && (word[1] == '-' || !word[2]);
    for (size_t f = 0; row && f < sizeof foreign / sizeof *foreign; f++) {
        if (strcmp(row->name, foreign[f]) == 0) {
            fail(err, EXIT_USAGE, "option '--%s' has no meaning for vkao-view", row->name);
            return fail_usage(err);
        }
    }
    bool keep = row && !is_of_settings(row) && strcmp(row->name, "camera") != 0;
    for (int n = 0; n < (two && *i + 1 < argc ? 2 : 1); n++) {
        if (!add_word(words, argv[*i + n], err))
            return false;
        if (keep)
            a->file_words[a->file_word_count++] = (struct file_word){argv[*i + n], row};
    }
    *i += two ? 1 : 0;
    return true;
}

static bool split(struct arguments *a, int argc, char **argv, struct words *words, char **input,
                  struct tool_error *err)
{
    bool only_files = false;
    for (int i = 1; i < argc; i++) {
        char *word = argv[i];
        size_t length = strcspn(word, "=");
        const struct own_option *own = NULL;
        if (strcmp(word, "--") == 0 && !only_files) {
            only_files = true;
            continue;
        }
        if (only_files || word[0] != '-' || !word[1]) {
            if (*input) {
                fail(err, EXIT_USAGE, "one FILE at a time, got '%s' and '%s'", *input, word);
                return fail_hint(err, "quote patterns, so that the shell leaves them alone");
            }
            *input = word;
            continue;
        }
        if (strcmp(word, "-h") == 0)
            own = find_own("help", 4);
        else if (strncmp(word, "--", 2) == 0)
            own = find_own(word + 2, length - 2);
        if (!own) {
            if (!pass_on(a, argc, argv, &i, words, err))
                return false;
            continue;
        }
        const char *argument = word[length] ? word + length + 1 : NULL;
        if (own->takes_argument && !argument && i + 1 < argc)
            argument = argv[++i];
        if (own->takes_argument != (argument != NULL)) {
            fail(err, EXIT_USAGE, "option '--%s' %s", own->name,
                 own->takes_argument ? "needs an argument" : "takes no argument");
            return fail_usage(err);
        }
        if (!take_own(a, own, argument, err))
            return false;
    }
    return true;
}

/* vkao's parser wants an input and an output; and the light of the composite, which is one of the
 * views, the mode that has it. */
static bool parse_words(struct words words, char *input, struct options *options,
                        struct tool_error *err)
{
    static char name[] = "vkao", output[] = "--output=none.exr", none[] = "none", end[] = "--",
                mode[] = "--mode=comp";
    char *list[MAX_WORDS + 8] = {name};
    size_t count = 1;
    for (size_t i = 0; i < words.count; i++)
        list[count++] = words.list[i];
    list[count++] = output;
    list[count++] = mode;
    list[count++] = end;
    list[count++] = input ? input : none;
    list[count] = NULL;
    if (!options_parse((int)count, list, options, err)) {
        snprintf(err->hint, sizeof err->hint, "'vkao-view --help' lists the options");
        return false;
    }
    options->input = input;
    options->output = NULL;
    return true;
}

static struct setting setting_of(const struct options *o)
{
    struct setting s = o->setting;
    s.effect.bent_normals = VK_FALSE; /* a view has them */
    if (o->radius_is_auto)
        s.params.radius = 0.0f;
    return s;
}

/* B is A and more options. */
static bool parse_versus(struct arguments *a, struct words words, char *input,
                         struct tool_error *err)
{
    struct options options;
    snprintf(a->versus_words, sizeof a->versus_words, "%s", a->versus);
    for (char *word = strtok(a->versus_words, " \t"); word; word = strtok(NULL, " \t"))
        if (!add_word(&words, word, err))
            return false;
    if (!parse_words(words, input, &options, err))
        return false;
    if (options.relative_radius.amount > 0 &&
        memcmp(&options.relative_radius, &a->options.relative_radius,
               sizeof options.relative_radius) != 0) {
        fail(err, EXIT_USAGE, "--versus has a --radius of its own in px or %%, want scene units");
        return fail_usage(err);
    }
    a->settings[1] = setting_of(&options);
    a->bias_is_given[1] = options.bias_is_given;
    return true;
}

bool arguments_parse(int argc, char **argv, struct arguments *arguments, struct tool_error *err)
{
    struct arguments *a = arguments;
    struct words words = {0};
    char *input = NULL;
    *a = (struct arguments){.view = VIEW_AO, .wipe = -1, .time = -1};
    if (!split(a, argc, argv, &words, &input, err))
        return false;
    if (a->help || a->version)
        return true;
    if (a->scene && input) {
        fail(err, EXIT_USAGE, "--scene and FILE '%s' exclude each other", input);
        return fail_usage(err);
    }
    if (!parse_words(words, input, &a->options, err))
        return false;
    a->settings[0] = a->settings[1] = setting_of(&a->options);
    a->bias_is_given[0] = a->bias_is_given[1] = a->options.bias_is_given;
    if (a->options.help || a->options.version) {
        a->help = a->options.help;
        a->version = a->options.version;
        return true;
    }
    return !a->versus || parse_versus(a, words, input, err);
}
