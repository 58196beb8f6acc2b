/* SPDX-License-Identifier: MIT
 *
 * A frame opened: its header, its cameras and the views of it that are wanted. */
#ifndef VKAO_TOOLS_VIEWS_H_
#define VKAO_TOOLS_VIEWS_H_

#include "camera.h"
#include "error.h"
#include "exr_file.h"
#include "options.h"
#include "record.h"

#include <stdbool.h>
#include <stddef.h>

enum { MAX_VIEWS = 16 };

struct view {
    const char *name;                        /* "" in files without views */
    const struct camera *camera;             /* of the camera file or of the record, or NULL */
    const struct record *record;             /* of --like, or NULL */
    const struct exr_info *file[ROLE_FILES]; /* as role_request.file */
};

struct frame_source {
    struct exr_info info;
    struct exr_info files[ROLE_FILES]; /* of what lies in a file of its own */
    struct camera_set cameras;
    struct record_set records;
    struct view views[MAX_VIEWS];
    size_t view_count;
};

/* camera_path may be NULL. Errors: EXIT_INPUT, EXIT_CHANNELS. *source needs closing in any case. */
bool frame_source_open(const struct options *options, const char *path, const char *camera_path,
                       struct frame_source *source, struct tool_error *err);
/* As above, up to the header alone. */
bool frame_source_read_header(const char *path, struct frame_source *source,
                              struct tool_error *err);
/* The other files of the frame, by role; NULL: none of its own. */
bool frame_source_read_files(const char *const paths[ROLE_FILES], struct frame_source *source,
                             struct tool_error *err);
/* Before the views are chosen: what of them the record tells. */
bool frame_source_read_like(const char *like_path, struct frame_source *source,
                            struct tool_error *err);
bool frame_source_choose_views(const struct options *options, const char *camera_path,
                               struct frame_source *source, struct tool_error *err);
void frame_source_close(struct frame_source *source);

/* What gbuffer_load needs for one view. */
struct gbuffer_options view_options(const struct options *options, const struct view *view);
/* Counts in what ao_run takes for the effect. */
void view_reserve_work(struct gbuffer_options *options, const vkao_effect_info *effect);

#endif
