/* SPDX-License-Identifier: MIT
 *
 * The files that are looked at: a G-buffer, or a sequence of them, read as the command line tool
 * reads them, and kept on the device. Beside FILE.exr may lie its reference FILE.gt.exr. */
#ifndef VKAO_VIEW_SOURCE_H_
#define VKAO_VIEW_SOURCE_H_

#include "compute.h"
#include "gbuffer.h"
#include "options.h"
#include "placement.h"
#include "plan.h"
#include "report.h"
#include "views.h"

/* All of one frame. */
struct loaded_frame {
    char *path, *camera_path, *reference_path; /* path is NULL if nothing is loaded */
    size_t view;                               /* index in files.views: the eye of a stereo file */
    struct frame_source *files;                /* stays where it is: the roles point into it */
    struct gbuffer gbuffer;                    /* its images stay in host memory too */
    double near_z,
        far_z; /* view z that 1 % and 99 % of the foreground are nearer than; 0 without */
    struct placement placement;
    struct gpu_image depth, normals, color, thickness, second_depth, albedo, specular, reference;
    /* What comes after the composite, width x height of the G-buffer: light that AO does not darken
     * and, in alpha, the holdout; and the colour as it was. Without an image there is none. */
    struct gpu_image kept, before;
    float *reference_values; /* width * height of the G-buffer; NULL = no reference */
    char reference_channel[64];
    float reference_radius; /* scene units, as its header says; 0 = it does not */
};

struct source {
    struct gpu *gpu;
    struct options options; /* as the command line tool would have them */
    struct plan plan;
    size_t frame; /* index in the plan */
    struct loaded_frame now;
    const char *reference_given; /* --reference or dropped, or NULL */
    char reference_dropped[4096];
    float radius; /* what vkao would take for all frames; 0 = not known yet */
    struct frame_memory cameras[MAX_VIEWS]; /* by view, as estimated of the first frame */
};

/* options->input may be NULL: an empty window. Nothing is loaded yet. */
bool source_open(struct source *source, struct gpu *gpu, const struct options *options,
                 const char *reference, struct tool_error *err);
void source_close(struct source *source);

/* What a drop replaces. */
struct source_undo {
    struct plan plan;
    size_t frame;
    float radius;
    struct frame_memory cameras[MAX_VIEWS];
    const char *reference_given;
    char reference_dropped[4096];
};

/* Paths that were dropped on the window: G-buffers, which become the sequence, or else a reference,
 * or a camera. Takes no ownership. source->frame is to be loaded then; source_settle ends it, and
 * brings back what was before if that failed. On failure the source is as it was, and there is
 * nothing to settle. */
bool source_drop(struct source *source, char *const *paths, size_t count, struct source_undo *undo,
                 struct tool_error *err);
void source_settle(struct source *source, struct source_undo *undo, bool loaded);

/* Loads a frame; waits for the device. If that fails, what was loaded before stays.
 * Errors: EXIT_INPUT, EXIT_CHANNELS, EXIT_DEVICE, EXIT_MEMORY. */
bool source_load(struct source *source, size_t frame, size_t view, struct report *report,
                 struct tool_error *err);

static inline bool source_is_loaded(const struct source *source)
{
    return source->now.path != NULL;
}
/* Images and view for vkao. */
struct inputs source_inputs(const struct source *source);

#endif
