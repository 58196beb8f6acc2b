/* SPDX-License-Identifier: MIT
 *
 * Changes EXR files so that they stay EXR files, mostly. A byte more in a header moves all chunks,
 * and the first check of their offsets would be as far as such an input gets: so the tables are
 * moved along. Sizes and names of attributes, tables and the numbers in front of chunks are changed
 * as what they are. */
#include "fuzz.h"

#include <stdlib.h>
#include <string.h>

size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t max_size);
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned seed);

enum { MOST_ATTRIBUTES = 256, MOST_CHUNKS = 4096, OPTION_BYTES = 16 };

struct attribute {
    size_t name, type, bytes, value, end; /* offsets in the file */
};

struct layout {
    struct attribute attributes[MOST_ATTRIBUTES];
    size_t attribute_count;
    size_t header_end, chunk_count; /* all tables lie at header_end, one behind the other */
    bool multi_part;
};

/* --- Reading --- */

static uint64_t read_number(const uint8_t *p, int bytes)
{
    uint64_t value = 0;
    while (bytes-- > 0)
        value = value << 8 | p[bytes];
    return value;
}

static void write_number(uint8_t *p, int bytes, uint64_t value)
{
    for (int i = 0; i < bytes; i++)
        p[i] = (uint8_t)(value >> 8 * i);
}

static bool skip_text(const uint8_t *data, size_t size, size_t *at)
{
    const uint8_t *end = *at < size ? memchr(data + *at, 0, size - *at) : NULL;
    if (!end)
        return false;
    *at = (size_t)(end - data) + 1;
    return true;
}

static bool read_attribute(const uint8_t *data, size_t size, size_t *at, struct attribute *a)
{
    a->name = a->type = *at;
    if (!skip_text(data, size, &a->type))
        return false;
    a->bytes = a->type;
    if (!skip_text(data, size, &a->bytes) || size - a->bytes < 4)
        return false;
    a->value = a->bytes + 4;
    const uint64_t bytes = read_number(data + a->bytes, 4);
    if (bytes > size - a->value)
        return false;
    *at = a->end = a->value + (size_t)bytes;
    return true;
}

static void count_chunks(const uint8_t *data, size_t size, struct layout *layout)
{
    uint64_t first = size;
    while (layout->chunk_count < MOST_CHUNKS) {
        const size_t at = layout->header_end + 8 * layout->chunk_count;
        if (at + 8 > first || at + 8 > size)
            break;
        const uint64_t offset = read_number(data + at, 8);
        if (offset > layout->header_end && offset < first)
            first = offset;
        layout->chunk_count++;
    }
}

static bool read_layout(const uint8_t *data, size_t size, struct layout *layout)
{
    size_t at = 8;
    *layout = (struct layout){0};
    if (size < 9 || read_number(data, 4) != 20000630)
        return false;
    layout->multi_part = data[5] & 0x10;
    while (at < size) {
        if (data[at] == 0) {
            at++;
            if (layout->multi_part && at < size && data[at] != 0)
                continue;
            layout->header_end = at + layout->multi_part;
            count_chunks(data, size, layout);
            return layout->attribute_count > 0 && layout->header_end <= size;
        }
        if (layout->attribute_count == MOST_ATTRIBUTES ||
            !read_attribute(data, size, &at, &layout->attributes[layout->attribute_count++]))
            return false;
    }
    return false;
}

/* --- Changing --- */

static uint32_t next_random(unsigned *state)
{
    *state = *state * 1664525u + 1013904223u;
    return *state >> 8;
}

struct file {
    uint8_t *data;
    size_t size, max_size;
    struct layout layout;
    unsigned random;
};

static uint32_t any(struct file *f, size_t count)
{
    return count ? next_random(&f->random) % (uint32_t)count : 0;
}

static uint32_t any_number(struct file *f)
{
    static const uint32_t values[] = {
        0,     1,     2,          7,          8,          13,         16,         20,        255,
        65535, 65536, 0x7fffffff, 0x80000000, 0xffffffff, 0x3fffffff, 0xc0000001, 0x7f800000};
    const uint32_t kind = any(f, 24);
    return kind < sizeof values / sizeof *values ? values[kind] : next_random(&f->random);
}

/* Replaces bytes of the headers, and tells the tables where the chunks are now. */
static void splice(struct file *f, size_t at, size_t removed, const void *bytes, size_t inserted)
{
    if (f->size - removed + inserted > f->max_size)
        return;
    memmove(f->data + at + inserted, f->data + at + removed, f->size - at - removed);
    memcpy(f->data + at, bytes, inserted);
    f->size = f->size - removed + inserted;
    const size_t tables = f->layout.header_end - removed + inserted;
    for (size_t i = 0; i < f->layout.chunk_count; i++) {
        uint8_t *entry = f->data + tables + 8 * i;
        const uint64_t offset = read_number(entry, 8);
        if (offset >= f->layout.header_end)
            write_number(entry, 8, offset - removed + inserted);
    }
}

/* Any bytes of the headers in any way. */
static void change_headers(struct file *f)
{
    const size_t begin = 8, end = f->layout.header_end, room = end - begin + 256;
    uint8_t *copy = malloc(room);
    if (!copy)
        abort();
    memcpy(copy, f->data + begin, end - begin);
    const size_t size = LLVMFuzzerMutate(copy, end - begin, room);
    splice(f, begin, end - begin, copy, size);
    free(copy);
}

static void change_value(struct file *f, const struct attribute *a)
{
    const size_t size = a->end - a->value;
    if (size >= 4 && any(f, 2)) {
        write_number(f->data + a->value + any(f, size / 4) * 4, 4, any_number(f));
    } else if (size) {
        uint8_t *copy = malloc(size);
        if (!copy)
            abort();
        memcpy(copy, f->data + a->value, size);
        LLVMFuzzerMutate(copy, size, size);
        memcpy(f->data + a->value, copy, size);
        free(copy);
    }
}

static void change_text(struct file *f, size_t begin, size_t end)
{
    static const char *const texts[] = {
        "channels",
        "compression",
        "dataWindow",
        "displayWindow",
        "lineOrder",
        "tiles",
        "type",
        "name",
        "view",
        "multiView",
        "preview",
        "chunkCount",
        "pixelAspectRatio",
        "version",
        "screenWindowWidth",
        "chlist",
        "box2i",
        "box2f",
        "v2i",
        "v3f",
        "m44f",
        "m33f",
        "float",
        "int",
        "string",
        "double",
        "tiledesc",
        "stringvector",
        "worldToCamera",
        "worldToNDC",
        "cameraFov",
        "timeCode",
        "chromaticities",
        "opaque",
        "stringvectorx",
        "maxSamplesPerPixel",
        "deepImageState",
        "dwaCompressionLevel",
    };
    const char *text = texts[any(f, sizeof texts / sizeof *texts)];
    splice(f, begin, end - begin, text, strlen(text) + 1);
}

static void change_attribute(struct file *f)
{
    const struct attribute a = f->layout.attributes[any(f, f->layout.attribute_count)];
    const size_t size = a.end - a.name;
    uint8_t *copy = malloc(size);
    if (!copy)
        abort();
    memcpy(copy, f->data + a.name, size);
    switch (any(f, 10)) {
    case 0:
        write_number(f->data + a.bytes, 4, any_number(f));
        break;
    case 1:
        f->data[a.bytes] = (uint8_t)(f->data[a.bytes] + any(f, 9) - 4);
        break;
    case 2:
        splice(f, a.name, size, "", 0);
        break;
    case 3:
        splice(f, f->layout.attributes[any(f, f->layout.attribute_count)].name, 0, copy, size);
        break;
    case 4:
        change_text(f, a.name, a.type);
        break;
    case 5:
        change_text(f, a.type, a.bytes);
        break;
    default:
        change_value(f, &a);
        break;
    }
    free(copy);
}

/* Offsets, and the coordinates and sizes in front of chunks. */
static void change_chunks(struct file *f)
{
    if (!f->layout.chunk_count)
        return;
    uint8_t *table = f->data + f->layout.header_end;
    uint8_t *entry = table + 8 * any(f, f->layout.chunk_count);
    uint8_t *other = table + 8 * any(f, f->layout.chunk_count);
    const uint64_t offset = read_number(entry, 8);
    const uint32_t kind = any(f, 8);
    if (kind == 0) {
        write_number(entry, 8, read_number(other, 8));
        write_number(other, 8, offset);
    } else if (kind == 1) {
        memcpy(entry, other, 8);
    } else if (kind == 2) {
        write_number(entry, 8, offset + any(f, 65) - 32);
    } else if (offset < f->size && f->size - offset > 28) {
        const size_t at = (size_t)offset + any(f, 7) * 4;
        if (kind < 6)
            write_number(f->data + at, 4, any_number(f));
        else
            write_number(f->data + at, 4, read_number(f->data + at, 4) + any(f, 5) - 2);
    }
}

static void change_options(struct file *f)
{
    const size_t tail = f->size < OPTION_BYTES ? f->size : OPTION_BYTES;
    for (uint32_t changes = 1 + any(f, 4); tail && changes; changes--)
        f->data[f->size - 1 - any(f, tail)] = (uint8_t)next_random(&f->random);
}

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned seed)
{
    struct file f = {.data = data, .size = size, .max_size = max_size, .random = seed};
    const uint32_t kind = any(&f, 12);
    if (kind < 3 || !read_layout(data, size, &f.layout))
        return LLVMFuzzerMutate(data, size, max_size);
    if (kind < 6)
        change_headers(&f);
    else if (kind < 9)
        change_attribute(&f);
    else if (kind < 11)
        change_chunks(&f);
    else
        change_options(&f);
    return f.size;
}
