/* SPDX-License-Identifier: MIT
 *
 * A folder of G-buffers with ray-traced truth: X.exr, its camera X.camera.json and X.gt.exr, or
 * X.VIEW.gt.exr for each view of a stereo file. A truth file has the channels AO_falloff and
 * AO_threshold, and the attribute aoRadius. */
#ifndef VKAO_BENCH_CORPUS_H_
#define VKAO_BENCH_CORPUS_H_

#include "ao.h"
#include "error.h"
#include "gbuffer.h"
#include "placement.h"
#include "report.h"
#include "views.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct corpus {
    char *folder;
    char **stems; /* X of each G-buffer, sorted */
    size_t count;
};

/* Files without a camera or without truth are no part of it. part_of_name may be NULL.
 * Errors: EXIT_INPUT (no such folder, nothing in it), EXIT_MEMORY. */
bool corpus_open(const char *folder, const char *part_of_name, struct corpus *corpus,
                 struct tool_error *err);
/* Puts the G-buffers in the order of their frame numbers. Errors: EXIT_INPUT unless they are at
 * least three frames STEM.NUMBER of one STEM. */
bool corpus_order_frames(struct corpus *corpus, struct tool_error *err);
/* Whether one of comma-separated patterns, as shells have them, fits the whole X. */
bool corpus_fits(const struct corpus *corpus, size_t index, const char *patterns);
/* Errors: EXIT_USAGE, naming the option and the pattern that fits no X. */
bool corpus_check_patterns(const struct corpus *corpus, const char *option, const char *patterns,
                           struct tool_error *err);
void corpus_close(struct corpus *corpus);

/* Header and cameras of one G-buffer; its views are source->views. *source needs
 * frame_source_close in any case. */
bool corpus_read(const struct corpus *corpus, size_t index, struct frame_source *source,
                 struct tool_error *err);

/* One view of a G-buffer, ready to be computed, and what should come out. */
struct scene {
    char name[256];     /* X, or X.VIEW */
    const char *folder; /* of the corpus */
    struct gbuffer gbuffer;
    struct placement placement;
    uint8_t *foreground; /* width * height: the texels that count */
    float *truth[2];     /* by vkao_falloff; NULL: not wanted */
    float radius;        /* of the truth file, 0 if it does not say */
};

/* wanted: which truth, by vkao_falloff. Errors: those of gbuffer_load; EXIT_INPUT or EXIT_CHANNELS
 * for a truth file that does not fit. *scene needs scene_free in any case. */
bool scene_load(const struct corpus *corpus, size_t index, const struct frame_source *source,
                size_t view, const bool wanted[2], struct report *report, struct scene *scene,
                struct tool_error *err);
void scene_free(struct scene *scene);

/* Images and view of the job; the rest stays. */
void scene_fill_job(const struct scene *scene, struct ao_job *job);

#endif
