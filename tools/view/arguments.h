/* SPDX-License-Identifier: MIT
 *
 * The command line of the viewer: its own options, and those of vkao that say how a G-buffer is to
 * be read and what AO of it is wanted. */
#ifndef VKAO_VIEW_ARGUMENTS_H_
#define VKAO_VIEW_ARGUMENTS_H_

#include "error.h"
#include "options.h"
#include "settings.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { MAX_WORDS = 128, MAX_STOPS = 10 };

/* In the form in which it was given. */
struct file_word {
    const char *word;
    const struct option_row *row; /* the option that it is, or is an argument of */
};

/* Strings point into argv, but for those of `versus_words`. */
struct arguments {
    bool help, version;
    const char *scene;      /* "cubes", "room"; NULL: files */
    const char *screenshot; /* PNG of the last frame */
    const char *reference;
    const char *save; /* stem of what Save writes; NULL: after the input */
    const char *versus;
    uint32_t frames;        /* 0: until somebody quits */
    uint32_t width, height; /* of the window; 0: after the image */
    enum view_kind view;
    double zoom;        /* 0: fit */
    double wipe;        /* share of the window's width; < 0: no wipe */
    double exposure;    /* of the composite, stops */
    double near, far;   /* of the depth view, scene units; far 0: automatic */
    double time;        /* seconds; where the clock of a live scene stands still; < 0: it runs */
    double panel_scale; /* texels per unit; 0: by monitor and window */
    bool no_panel;

    struct options options; /* of vkao */
    /* Options of vkao about files and the device: what the settings of the panel do not say. */
    struct file_word file_words[MAX_WORDS];
    size_t file_word_count;
    struct setting settings[2]; /* A and B; radius 0: automatic */
    bool bias_is_given[2];
    char versus_words[1024];
};

/* Errors: EXIT_USAGE. */
bool arguments_parse(int argc, char **argv, struct arguments *arguments, struct tool_error *err);
/* The text of --help: at most 24 lines of 80 columns. */
extern const char arguments_help[];
extern const char arguments_keys[]; /* of it: what the keys do */

#endif
