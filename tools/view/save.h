/* SPDX-License-Identifier: MIT
 *
 * The parts of Save: names and command line (save.c), values and pictures of files (save_file.c)
 * and of live scenes (save_live.c). */
#ifndef VKAO_VIEW_SAVE_H_
#define VKAO_VIEW_SAVE_H_

#include "atomic_file.h"
#include "output.h"
#include "viewer.h"

enum { SAVE_STEM_MAX = ATOMIC_FILE_PATH_MAX - 32 }; /* leaves room for number and extension */

/* Of one save. */
struct save_names {
    char exr[ATOMIC_FILE_PATH_MAX], png[ATOMIC_FILE_PATH_MAX], script[ATOMIC_FILE_PATH_MAX];
    char gbuffer[ATOMIC_FILE_PATH_MAX], camera[ATOMIC_FILE_PATH_MAX]; /* of live scenes */
};

/* The computation that the last frame showed for the active side. */
const struct computation *save_result(const struct viewer *viewer);
/* EXR and PNG; of a live scene its G-buffer and camera too. */
bool save_file_values(struct viewer *viewer, const struct save_names *names,
                      struct tool_error *err);
bool save_live_values(struct viewer *viewer, const struct save_names *names,
                      struct tool_error *err);

/* malloc'ed texels of an image in GENERAL, in its own format. */
void *save_download(struct viewer *viewer, const struct gpu_image *image, struct tool_error *err);
/* The picture as the display shows it, of values without padding: width and height are those of
 * the G-buffer. */
bool save_picture(struct viewer *viewer, const struct rendered_view *view, const char *path,
                  struct tool_error *err);

#endif
