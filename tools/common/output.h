/* SPDX-License-Identifier: MIT
 *
 * Results to files. */
#ifndef VKAO_TOOLS_OUTPUT_H_
#define VKAO_TOOLS_OUTPUT_H_

#include "ao.h"
#include "atomic_file.h"
#include "error.h"
#include "gbuffer.h"
#include "options.h"
#include "plan.h"
#include "views.h"

/* One view, done. */
struct rendered_view {
    const char *name; /* "" or the view */
    struct gbuffer gbuffer;
    struct ao_result result;
    struct setting setting; /* as used */
};

/* Whether the names of the new part and of the previews of several views are free, asked before any
 * work. */
bool output_check_names(const struct options *options, const struct plan_frame *frame,
                        const struct frame_source *source, struct tool_error *err);
/* Writes new files that the caller commits or aborts: a preview of each view if they are asked for,
 * and the EXR file, which is the last. files: zeroed; also what was written before an error is to
 * be aborted. Errors: EXIT_OUTPUT, EXIT_MEMORY. */
bool output_prepare(const struct options *options, const struct plan_frame *frame,
                    const struct frame_source *source, const struct rendered_view *views,
                    const char *device, struct atomic_file *files, struct tool_error *err);
/* The EXR file and, if asked for, the PNG. Errors: EXIT_OUTPUT, EXIT_MEMORY. */
bool output_write(const struct options *options, const struct plan_frame *frame,
                  const struct frame_source *source, const struct rendered_view *views,
                  const char *device, struct tool_error *err);

#endif
