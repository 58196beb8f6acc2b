/* SPDX-License-Identifier: MIT */
#ifndef _GNU_SOURCE
#define _GNU_SOURCE
#endif
#include "exr_files.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <dirent.h>
#include <unistd.h>

float ramp[PIXELS], noise[PIXELS];
static char directory[512];

const char *in_directory(const char *name)
{
    static char paths[8][1024];
    static unsigned next;
    char *path = paths[next++ % 8];
    snprintf(path, sizeof paths[0], "%s/%s", directory, name);
    return path;
}

struct bytes load_file(const char *path)
{
    struct bytes b = {0};
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    assert_int_equal(fseek(file, 0, SEEK_END), 0);
    b.size = (size_t)ftell(file);
    rewind(file);
    b.data = malloc(b.size + 1);
    assert_non_null(b.data);
    assert_int_equal(fread(b.data, 1, b.size, file), b.size);
    fclose(file);
    return b;
}

void store_file(const char *path, const void *data, size_t size)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(data, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

size_t files_in_directory(void)
{
    size_t count = 0;
    DIR *dir = opendir(directory);
    assert_non_null(dir);
    for (struct dirent *entry; (entry = readdir(dir));)
        count += strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0;
    closedir(dir);
    return count;
}

struct exr_write default_channels[2] = {
    {"Z", EXR_FLOAT, noise, 1},
    {"A", EXR_HALF, ramp, 1},
};

struct exr_new_part make_part(const char *name, const char *compression)
{
    return (struct exr_new_part){
        .name = name,
        .data_window = {-3, 5, -3 + WIDTH - 1, 5 + HEIGHT - 1},
        .display_window = {0, 0, 99, 59},
        .pixel_aspect = 1.5f,
        .compression = compression,
        .channels = default_channels,
        .channel_count = 2,
    };
}

bool write_copy(const char *path, const char *copy_from, const struct exr_new_part *parts,
                size_t count, struct tool_error *err)
{
    struct exr_info info = {0};
    bool ok = (!copy_from || exr_info_read(copy_from, &info, err)) &&
              exr_write_file(path, copy_from ? &info : NULL, parts, count, true, err);
    exr_info_free(&info);
    return ok;
}

void write_ok(const char *path, const char *copy_from, const struct exr_new_part *parts,
              size_t count)
{
    struct tool_error err = {0};
    if (!write_copy(path, copy_from, parts, count, &err))
        fail_msg("%s", err.message);
}

bool read_part(const char *path, size_t part, const struct exr_read *reads, size_t count,
               struct tool_error *err)
{
    struct exr_info info;
    bool ok = exr_info_read(path, &info, err) && exr_read_channels(&info, part, reads, count, err);
    exr_info_free(&info);
    return ok;
}

static void fill_pixels(void)
{
    uint32_t random = 1;
    for (size_t i = 0; i < PIXELS; i++) {
        random = random * 1664525u + 1013904223u;
        noise[i] = (float)(random >> 8) / 4096.0f - 1000.0f;
        ramp[i] = (float)(i % WIDTH) / WIDTH;
    }
}

int make_directory(void **state)
{
    const char *base = getenv("TMPDIR");
    (void)state;
    fill_pixels();
    snprintf(directory, sizeof directory, "%s/vkao-exr-XXXXXX", base && base[0] ? base : P_tmpdir);
    return mkdtemp(directory) ? 0 : -1;
}

int empty_directory(void **state)
{
    (void)state;
    DIR *dir = opendir(directory);
    if (!dir)
        return -1;
    for (struct dirent *entry; (entry = readdir(dir));) {
        if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0)
            unlinkat(dirfd(dir), entry->d_name, 0);
    }
    return closedir(dir);
}

int remove_directory(void **state)
{
    (void)state;
    return rmdir(directory);
}
