/* SPDX-License-Identifier: MIT
 *
 * What an EXR file that vkao wrote tells of how it was made: the attribute vkao/params of each of
 * its parts, JSON on one line. It holds every parameter of the library's table and whatever else
 * decides the picture, so that --like can make the same one again. Who reads it must not trust it:
 * it may be a stranger's. */
#ifndef VKAO_TOOLS_RECORD_H_
#define VKAO_TOOLS_RECORD_H_

#include "error.h"
#include "gbuffer.h"
#include "options.h"

#include <stddef.h>

/* Of the form. Another number means that fields have another meaning. */
enum { RECORD_VERSION = 1 };

/* malloc'ed; NULL if memory runs out. options: mode, pixel type and compression; setting: as
 * used. */
char *record_write(const struct options *options, const struct setting *setting, const char *view,
                   const struct gbuffer *gbuffer, const char *device);

struct record {
    char *view;             /* "" in files without views */
    char *version, *device; /* of vkao and its device */
    /* As --depth, --normal, --color, --thickness-channel or --back-depth, --layer2; but for depth
     * they may be NULL. */
    char *depth, *normal, *color, *thickness, *second_depth;
    char *more[ROLE_KINDS]; /* likewise, of the roles that only options find; NULL: not named */
    enum depth_type depth_type;
    struct depth_range depth_range;
    enum background_rule background;
    double background_value;
    enum normal_space normal_space;
    enum normal_encoding normal_encoding;
    struct camera camera;
    enum output_mode mode;
    enum exr_pixel_type pixel_type;
    const char *compression;
    struct setting setting;
};

/* One for each view. */
struct record_set {
    struct record *records;
    size_t count;
};

/* Errors: EXIT_INPUT (none in it, of another version, or damaged), naming file, field and
 * remedy. */
bool record_set_read(const char *path, struct record_set *set, struct tool_error *err);
bool record_parse(const char *json, const char *path, struct record *record,
                  struct tool_error *err);
void record_free(struct record *record);
void record_set_free(struct record_set *set);
/* That of a view, NULL if there is none. A single one without a view serves all. */
const struct record *record_set_find(const struct record_set *set, const char *view);

/* Takes from the record what no option said; options->setting is settled anew. Strings point into
 * the record. Errors: EXIT_USAGE. */
bool options_take_record(struct options *options, const struct record *record,
                         struct tool_error *err);

#endif
