/* SPDX-License-Identifier: MIT
 *
 * OpenEXR files, seen from C. The exr_*.cpp files alone talk to OpenEXR, through its C++ API: the C
 * API of 3.1 cannot decode DWAA and DWAB. Names are UTF-8 as stored. Windows are inclusive, as in
 * OpenEXR. */
#ifndef VKAO_TOOLS_EXR_FILE_H_
#define VKAO_TOOLS_EXR_FILE_H_

#include "atomic_file.h"
#include "error.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum exr_pixel_type { EXR_UINT = 0, EXR_HALF = 1, EXR_FLOAT = 2 };

enum { EXR_COMPRESSIONS = 10 };
extern const char *const exr_compression_names[EXR_COMPRESSIONS];

struct exr_box {
    int32_t x_min, y_min, x_max, y_max;
};

struct exr_channel {
    char *name;
    enum exr_pixel_type type;
    int32_t x_sampling, y_sampling;
};

/* One header attribute. Numbers and matrices are given as doubles, text as text, whatever else as
 * its type name alone. */
struct exr_attribute {
    char *name;
    char *type;      /* "m44f", "float", "string" ... */
    char *text;      /* string attributes, else NULL */
    double *numbers; /* int, float, double, v2*, v3*, m33*, m44* (row by row as stored), box2* */
    size_t number_count;
};

struct exr_part {
    char *name;              /* "" in single-part files without one */
    char *view;              /* "" if the part belongs to no view */
    char *type;              /* "scanlineimage", "tiledimage", "deepscanline", "deeptile" */
    const char *compression; /* one of exr_compression_names */
    const char *line_order;  /* "increasing", "decreasing", "random" */
    struct exr_box data_window, display_window;
    float pixel_aspect;
    struct exr_channel *channels; /* as stored: sorted by byte order */
    size_t channel_count;
    struct exr_attribute *attributes;
    size_t attribute_count;
    char **multi_view; /* single-part stereo: first is the default view */
    size_t multi_view_count;
    bool deep;
    uint64_t decode_bytes; /* memory that reading pixels takes, beside that for the values */
};

/* A file, open. Whoever reads or copies it later sees what was there when it was opened, even if
 * the path names another file by then; that somebody wrote to this one is an error 3 of the next
 * call. One thread at a time. */
struct exr_info {
    char *path;
    struct exr_part *parts;
    size_t part_count;
    bool table_rebuilt; /* the file has no chunk table: it may be unfinished in other ways, too */
    struct exr_input *input; /* of the exr_*.cpp files */
};

/* Opens a file and reads its headers; it stays open until exr_info_free. Error codes: EXIT_INPUT
 * (missing, not EXR, damaged, unknown compression), EXIT_MEMORY. */
bool exr_info_read(const char *path, struct exr_info *info, struct tool_error *err);
void exr_info_free(struct exr_info *info);

/* One channel to read: values land at values[(row * width + column) * stride], converted to float.
 * */
struct exr_read {
    const char *channel;
    float *values;
    size_t stride; /* in floats */
};

/* Reads channels of one part over its data window (level 0 of mip-mapped files). A file that ends
 * early or whose chunks do not decode is an error; nothing is made up for missing pixels. */
bool exr_read_channels(const struct exr_info *info, size_t part, const struct exr_read *reads,
                       size_t count, struct tool_error *err);

/* A channel to write, from values[(row * width + column) * stride]. */
struct exr_write {
    const char *channel;
    enum exr_pixel_type type;
    const float *values;
    size_t stride;
};

struct exr_string {
    const char *name, *value;
};

struct exr_matrix {
    const char *name;
    float m[16]; /* row by row, as exr_attribute.numbers */
};

struct exr_new_part {
    const char *name; /* required in multi-part files */
    const char *view; /* NULL or "" = none */
    struct exr_box data_window, display_window;
    float pixel_aspect;
    const char *compression; /* as exr_part.compression */
    const struct exr_write *channels;
    size_t channel_count;
    const struct exr_string *strings; /* string attributes to add */
    size_t string_count;
    /* Open file and part whose other attributes (time code, chromaticities, owner, camera, anything
     * unknown) are copied verbatim, or NULL. */
    const struct exr_info *attributes_from;
    size_t attributes_from_part;
    const struct exr_matrix *matrices; /* m44f attributes to add */
    size_t matrix_count;
    float level; /* zip and zips: effort, 1 to 9; dwaa and dwab: error, about 1 to 1000.
                  * 0 = OpenEXR's defaults, 4 and 45 */
};

/* Writes a new file that its caller commits or aborts; file: zeroed. With copy_from every part of
 * that file is copied first, its pixels as raw chunks and its attributes as they are, and the new
 * parts follow. The file is written beside path and read back: copies byte for byte, new pixels
 * decoded and, if the compression keeps them, compared. On error nothing is left. If replace is
 * false an existing path is EXIT_OUTPUT, also when it appears meanwhile. */
bool exr_prepare_file(struct atomic_file *file, const char *path, const struct exr_info *copy_from,
                      const struct exr_new_part *parts, size_t count, bool replace,
                      struct tool_error *err);
/* Both at once: the file appears whole or not at all. */
bool exr_write_file(const char *path, const struct exr_info *copy_from,
                    const struct exr_new_part *parts, size_t count, bool replace,
                    struct tool_error *err);

/* "OpenEXR 3.1.5" */
const char *exr_library_version(void);
enum { EXR_MOST_THREADS = 256 };
/* Threads that OpenEXR may use, 0 = one for each processor, 1 = none but the caller. Once, before
 * the first file is opened. */
void exr_set_threads(unsigned count);

#ifdef __cplusplus
}
#endif
#endif
