/* SPDX-License-Identifier: MIT
 *
 * The table of options in words: --help and the source of the man page. */
#include "options.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { COLUMNS = 80, HELP_COLUMN = 30 };

/* --- What is said of one option --- */

static bool names_all(const char *help, const vkao_parameter *p)
{
    for (uint32_t i = 0; i <= (uint32_t)p->most; i++)
        if (!strstr(help, p->choices[i]))
            return false;
    return true;
}

static void add_range(struct text *text, const vkao_parameter *p)
{
    const struct parameter_range r = parameter_range(p);
    if (*p->unit)
        text_add(text, ", in %s", p->unit);
    if (isinf(r.high))
        text_add(text, "; %s %g", r.low_is_excluded ? "above" : "from", r.low);
    else
        text_add(text, "; %s%g to %.10g", r.low_is_excluded ? "above " : "", r.low, r.high);
}

/* The methods that read it, if not all do. */
static void add_readers(struct text *text, const vkao_parameter *p)
{
    if (p->stages == VKAO_STAGE_COMPOSITE)
        text_add(text, "; for --mode comp");
    if (!p->methods)
        return;
    text_add(text, "; for ");
    text_add_list(text, parameter_named("method")->choices, p->methods, "and");
}

static void add_parameter(struct text *text, const struct option_row *row, const vkao_parameter *p)
{
    const struct setting standard = setting_default();
    text_add(text, "%s", p->help);
    if (p->type == VKAO_PARAMETER_CHOICE && !names_all(p->help, p)) {
        text_add(text, ": ");
        text_add_list(text, p->choices, (1u << (unsigned)(p->most + 1)) - 1u, "or");
    } else if (p->type != VKAO_PARAMETER_CHOICE && p->type != VKAO_PARAMETER_BOOL) {
        add_range(text, p);
    }
    add_readers(text, p);
    if (row->help)
        text_add(text, "; %s", row->help);
    if (row->automatic) {
        text_add(text, ". auto, the default: %s", row->automatic);
    } else if (p->type != VKAO_PARAMETER_BOOL) {
        text_add(text, " (default: ");
        parameter_add_value(text, p, &standard);
        text_add(text, ")");
    }
}

static void add_words(struct text *text, const struct option_row *row)
{
    const vkao_parameter *p = option_parameter(row);
    if (p) {
        add_parameter(text, row, p);
        return;
    }
    text_add(text, "%s", row->help);
    if (row->fallback && strcmp(row->fallback, "auto") != 0)
        text_add(text, " (default: %s)", row->fallback);
}

/* --- Help --- */

static void add_option(struct text *text, const struct option_row *row)
{
    struct text words = {0};
    char left[80], letter[8] = "    ";
    if (row->letter)
        snprintf(letter, sizeof letter, "-%c, ", row->letter);
    int used = snprintf(left, sizeof left, "  %s--%s%s%s", letter, row->name,
                        row->argument ? " " : "", row->argument ? row->argument : "");
    add_words(&words, row);
    if (used + 2 > HELP_COLUMN)
        text_add(text, "%s\n%*s", left, HELP_COLUMN, "");
    else
        text_add(text, "%-*s", HELP_COLUMN, left);
    text_add_wrapped(text, words.data ? words.data : "", HELP_COLUMN, COLUMNS);
    text_free(&words);
}

void options_help(struct text *text)
{
    text_add(text, "Usage: vkao [render] INPUT.exr -o OUTPUT.exr [OPTION]...\n"
                   "       vkao inspect INPUT.exr [--json] [OPTION]...\n"
                   "       vkao devices [--json]\n"
                   "\n"
                   "Ambient occlusion from the depth and the normals of OpenEXR files. INPUT and\n"
                   "OUTPUT may hold a frame token: a run of # or @, as ####, %%04d or $F4.\n");
    for (size_t i = 0; i < option_table_count; i++) {
        if (option_table[i].heading)
            text_add(text, "\n%s:\n", option_table[i].heading);
        add_option(text, &option_table[i]);
    }
    text_add(text,
             "\nExit status: 0 done, 1 some frames failed, 2 usage, 3 input, 4 channels or\n"
             "conventions, 5 Vulkan device, 6 output, 33 out of memory.\n\n%s\n",
             options_example);
}

/* --- Man page --- */

/* What scdoc would take for markup. */
static void add_escaped(struct text *text, const char *words)
{
    for (; *words; words++)
        text_add(text, "%s%c", strchr("*_\\`#<>", *words) ? "\\" : "", *words);
}

static void add_methods(struct text *text)
{
    uint32_t count;
    const vkao_method *methods = vkao_methods(&count);
    for (uint32_t i = 0; i < count; i++) {
        text_add(text, "%s*%s*: ", i ? "; " : "\n\n\t", methods[i].name);
        add_escaped(text, methods[i].help);
    }
    text_add(text, ".");
}

void options_man(struct text *text)
{
    for (size_t i = 0; i < option_table_count; i++) {
        const struct option_row *row = &option_table[i];
        const vkao_parameter *p = option_parameter(row);
        struct text words = {0};
        if (row->heading)
            text_add(text, "## %s\n\n", row->heading);
        if (row->letter)
            text_add(text, "*-%c*, ", row->letter);
        text_add(text, "*--%s*", row->name);
        if (row->argument)
            text_add(text, " _%s_", row->argument);
        text_add(text, "\n\t");
        add_words(&words, row);
        add_escaped(text, words.data ? words.data : "");
        if (row->more)
            text_add(text, "%s", words.length && words.data[words.length - 1] == '.' ? " " : ". ");
        add_escaped(text, row->more ? row->more : "");
        if (p && p == parameter_named("method"))
            add_methods(text);
        text_add(text, "\n\n");
        text_free(&words);
    }
}
