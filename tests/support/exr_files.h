/* SPDX-License-Identifier: MIT
 *
 * A temporary directory and EXR files in it, for tests that write and read them. */
#ifndef VKAO_TESTS_EXR_FILES_H_
#define VKAO_TESTS_EXR_FILES_H_

#include "exr_file.h"

#include <stddef.h>

enum { WIDTH = 70, HEIGHT = 45, PIXELS = WIDTH * HEIGHT };
extern float ramp[PIXELS], noise[PIXELS];

struct bytes {
    unsigned char *data; /* malloc'ed */
    size_t size;
};

/* Group setup and teardown, and the teardown of each test: the directory is made, emptied,
 * removed. */
int make_directory(void **state);
int empty_directory(void **state);
int remove_directory(void **state);

/* A path inside the directory; good for eight calls. */
const char *in_directory(const char *name);
size_t files_in_directory(void);
/* They fail the test if they cannot. */
struct bytes load_file(const char *path);
void store_file(const char *path, const void *data, size_t size);

/* Two channels that compress badly and well, at an offset inside the display window. */
extern struct exr_write default_channels[2];
struct exr_new_part make_part(const char *name, const char *compression);
/* exr_write_file and exr_read_channels for files that are not open yet; copy_from may be NULL. What
 * is there is replaced. */
bool write_copy(const char *path, const char *copy_from, const struct exr_new_part *parts,
                size_t count, struct tool_error *err);
bool read_part(const char *path, size_t part, const struct exr_read *reads, size_t count,
               struct tool_error *err);
/* Replaces what is there; fails the test if it cannot. */
void write_ok(const char *path, const char *copy_from, const struct exr_new_part *parts,
              size_t count);

#endif
