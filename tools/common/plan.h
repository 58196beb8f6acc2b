/* SPDX-License-Identifier: MIT
 *
 * Which files are read and written, settled and checked before any work starts. */
#ifndef VKAO_TOOLS_PLAN_H_
#define VKAO_TOOLS_PLAN_H_

#include "error.h"
#include "options.h"
#include "report.h"

#include <stddef.h>
#include <stdint.h>

struct plan_frame {
    int64_t number;
    char *input, *output;
    char *camera, *like, *preview, *write_camera; /* NULL if not asked for */
    char *file[ROLE_FILES];                       /* likewise */
    bool is_left;                                 /* its output is there, see --overwrite skip */
    bool is_late; /* it shows nothing, and waits for a frame that shows something */
};

struct plan {
    struct plan_frame *frames;
    size_t count;
    bool is_sequence;
    bool cameras_lie_beside; /* nobody named them */
    char found[256];         /* "1-99, 102-240": the frames that exist, of a sequence */
};

/* Errors: EXIT_USAGE (patterns, an output that is a file of any frame), EXIT_OUTPUT (outputs that
 * exist) and EXIT_INPUT (cameras and other files beside INPUT that do not), both left to the frames
 * with --continue-on-error; EXIT_INPUT (no file matches). */
bool plan_make(const struct options *options, struct plan *plan, struct tool_error *err);
void plan_free(struct plan *plan);

/* The one rule for cameras that nobody names: FILE.camera.json is that of FILE.exr, unless there is
 * --camera, also as none, or --like, whose record has one. Where one frame has such a file each
 * must: half a sequence by another camera would jump. plan_make does it; it is for plans that are
 * made without. Errors: EXIT_MEMORY. */
bool plan_take_cameras(const struct options *options, struct plan *plan, struct tool_error *err);
/* One line, if there are any. */
void plan_say_cameras(const struct plan *plan, const struct report *report);

/* Is an output there that --overwrite skip leaves alone? An empty file, a directory and a dead link
 * are not: they are in the way. */
bool plan_leaves(const struct options *options, const char *path);
/* Whether a preview that is there is replaced: always, or with skip if it says that it is the
 * frame's and the output is not there, as after a run that was killed between the two. */
bool plan_replaces_preview(const struct options *options, const struct plan_frame *frame,
                           const char *path);
/* Whether a preview can be written at path, and may be. Errors: EXIT_OUTPUT. */
bool plan_check_preview(const struct options *options, const struct plan_frame *frame,
                        const char *path, struct tool_error *err);
/* The same of all outputs of the frame, and whether their directories are there. */
bool plan_check_outputs(const struct options *options, const struct plan_frame *frame,
                        struct tool_error *err);
/* A message names the file it is about, which is the input if nothing else is. Returns false. */
bool plan_fail_of_frame(const struct plan_frame *frame, struct tool_error *err);

#endif
