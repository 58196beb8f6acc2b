/* SPDX-License-Identifier: MIT */
#include "png_file.h"

#include "atomic_file.h"
#include "text.h"

#include <fcntl.h>
#include <math.h>
#include <png.h>
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

uint8_t byte_of(double value)
{
    return value > 0 ? (uint8_t)lround(fmin(value, 1) * 255) : 0;
}

double srgb_of(double linear)
{
    if (!(linear > 0))
        return 0;
    return linear <= 0.0031308 ? linear * 12.92 : 1.055 * pow(fmin(linear, 1), 1 / 2.4) - 0.055;
}

struct sink {
    struct atomic_file *file;
    struct tool_error *err;
    bool out_of_memory; /* which libpng reports as any other error */
};

static png_voidp allocate(png_structp png, png_alloc_size_t bytes)
{
    struct sink *sink = png_get_mem_ptr(png);
    void *memory = malloc(bytes);
    sink->out_of_memory = sink->out_of_memory || !memory;
    return memory;
}

static void release(png_structp png, png_voidp memory)
{
    (void)png;
    free(memory);
}

static void write_bytes(png_structp png, png_bytep data, size_t bytes)
{
    struct sink *sink = png_get_io_ptr(png);
    if (!atomic_file_write(sink->file, data, bytes, sink->err))
        png_error(png, "write");
}

static void flush_nothing(png_structp png)
{
    (void)png;
}

static void on_error(png_structp png, png_const_charp message)
{
    struct sink *sink = png_get_error_ptr(png);
    fail(sink->err, sink->out_of_memory ? EXIT_MEMORY : EXIT_OUTPUT, "%s: cannot write PNG: %s",
         sink->file->path, message);
    png_longjmp(png, 1);
}

static void on_warning(png_structp png, png_const_charp message)
{
    (void)png;
    (void)message;
}

/* libpng leaves by longjmp: nothing here may be needed afterwards that changes after setjmp. */
static bool encode(struct sink *sink, png_structp png, png_infop info,
                   const struct png_picture *picture)
{
    const size_t row_bytes = (size_t)picture->width * picture->channels;
    if (setjmp(png_jmpbuf(png)))
        return false;
    png_set_write_fn(png, sink, write_bytes, flush_nothing);
    png_set_IHDR(png, info, picture->width, picture->height, 8,
                 picture->channels == 1 ? PNG_COLOR_TYPE_GRAY : PNG_COLOR_TYPE_RGB,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    /* libpng copies both, and does not change them. */
    png_text text = {
        .compression = PNG_ITXT_COMPRESSION_NONE, .key = picture->key, .text = picture->text};
    if (picture->key)
        png_set_text(png, info, &text, 1);
    png_write_info(png, info);
    for (size_t row = 0; row < picture->height; row++)
        png_write_row(png, picture->pixels + row * row_bytes);
    png_write_end(png, info);
    return true;
}

bool png_file_prepare(struct atomic_file *file, const char *path, const struct png_picture *picture,
                      bool replace, struct tool_error *err)
{
    struct sink sink = {.file = file, .err = err};
    png_structp png = png_create_write_struct_2(PNG_LIBPNG_VER_STRING, &sink, on_error, on_warning,
                                                &sink, allocate, release);
    png_infop info = png ? png_create_info_struct(png) : NULL;
    bool ok = false;
    if (!info) {
        fail(err, EXIT_MEMORY, "%s: out of memory", path);
    } else if (atomic_file_open(file, path, replace, err)) {
        ok = encode(&sink, png, info, picture);
        if (!ok)
            atomic_file_abort(file);
    }
    png_destroy_write_struct(&png, &info);
    return ok;
}

bool png_file_write(const char *path, const struct png_picture *picture, bool replace,
                    struct tool_error *err)
{
    struct atomic_file *file = calloc(1, sizeof *file);
    if (!file)
        return fail(err, EXIT_MEMORY, "%s: out of memory", path);
    bool ok = png_file_prepare(file, path, picture, replace, err) && atomic_file_commit(file, err);
    free(file);
    return ok;
}

static void leave(png_structp png, png_const_charp message)
{
    (void)message;
    png_longjmp(png, 1);
}

static void read_info(png_structp png, png_infop info, FILE *file, const char *key, char **found)
{
    png_textp texts;
    int count = 0;
    if (setjmp(png_jmpbuf(png)))
        return;
    png_init_io(png, file);
    png_read_info(png, info);
    png_get_text(png, info, &texts, &count);
    for (int i = 0; i < count && !*found; i++)
        if (strcmp(texts[i].key, key) == 0 && texts[i].text)
            *found = text_copy(texts[i].text, strlen(texts[i].text));
}

/* A pipe would be waited for. */
static FILE *open_regular(const char *path)
{
    struct stat status;
    const int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    FILE *file =
        fd >= 0 && fstat(fd, &status) == 0 && S_ISREG(status.st_mode) ? fdopen(fd, "rb") : NULL;
    if (fd >= 0 && !file)
        close(fd);
    return file;
}

char *png_file_read_text(const char *path, const char *key)
{
    png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, NULL, leave, on_warning);
    png_infop info = png ? png_create_info_struct(png) : NULL;
    FILE *file = info ? open_regular(path) : NULL;
    char *found = NULL;
    if (file)
        read_info(png, info, file, key, &found);
    if (file)
        fclose(file);
    png_destroy_read_struct(&png, &info, NULL);
    return found;
}
