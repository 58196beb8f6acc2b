/* SPDX-License-Identifier: MIT
 *
 * EXR files in and out: what is appended, copied, refused and left behind. Every input is made
 * here. */
#ifndef _GNU_SOURCE
#define _GNU_SOURCE
#endif
#include "exr_file.h"
#include "exr_files.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

static void info_ok(const char *path, struct exr_info *info)
{
    struct tool_error err = {0};
    if (!exr_info_read(path, info, &err))
        fail_msg("%s", err.message);
}

static const struct exr_attribute *find_attribute(const struct exr_part *part, const char *name)
{
    for (size_t i = 0; i < part->attribute_count; i++) {
        if (strcmp(part->attributes[i].name, name) == 0)
            return &part->attributes[i];
    }
    return NULL;
}

/* info first, then every channel: true if nothing complained. */
static bool reads_whole(const char *path, struct tool_error *err)
{
    struct exr_info info;
    bool ok = exr_info_read(path, &info, err);
    for (size_t p = 0; ok && p < info.part_count; p++) {
        const struct exr_part *part = &info.parts[p];
        size_t width = (size_t)(part->data_window.x_max - part->data_window.x_min) + 1;
        size_t height = (size_t)(part->data_window.y_max - part->data_window.y_min) + 1;
        float *values = malloc(width * height * sizeof *values);
        assert_non_null(values);
        for (size_t c = 0; ok && c < part->channel_count; c++) {
            struct exr_read read = {part->channels[c].name, values, 1};
            ok = exr_read_channels(&info, p, &read, 1, err);
        }
        free(values);
    }
    exr_info_free(&info);
    return ok;
}

static void expect_refused(const char *path, int code, const char *text)
{
    struct tool_error err = {0};
    if (reads_whole(path, &err))
        fail_msg("%s was accepted", path);
    assert_int_equal(err.code, code);
    if (!strstr(err.message, text) || strncmp(err.message, path, strlen(path)) != 0)
        fail_msg("'%s' lacks the path or '%s'", err.message, text);
}

static uint64_t little_endian(const unsigned char *p, int bytes)
{
    uint64_t value = 0;
    while (bytes-- > 0)
        value = value << 8 | p[bytes];
    return value;
}

/* The file position of the chunk tables: behind the headers. */
static size_t skip_headers(const struct bytes *file)
{
    bool multi_part = file->data[5] & 0x10;
    size_t p = 8;
    do {
        while (file->data[p]) {
            p += strlen((char *)file->data + p) + 1;
            p += strlen((char *)file->data + p) + 1;
            p += 4 + (size_t)little_endian(file->data + p, 4);
        }
        p++;
    } while (multi_part && file->data[p]);
    return p + multi_part;
}

/* Compares count chunks, whose tables begin at entry ia and ib, from the line number to the end of
 * the data. */
static void assert_same_chunks(const struct bytes *a, size_t ia, const struct bytes *b, size_t ib,
                               size_t count)
{
    size_t table_a = skip_headers(a) + 8 * ia, table_b = skip_headers(b) + 8 * ib;
    size_t part_a = a->data[5] & 0x10 ? 4 : 0, part_b = b->data[5] & 0x10 ? 4 : 0;
    for (size_t i = 0; i < count; i++) {
        size_t at_a = (size_t)little_endian(a->data + table_a + 8 * i, 8) + part_a;
        size_t at_b = (size_t)little_endian(b->data + table_b + 8 * i, 8) + part_b;
        size_t size = 8 + (size_t)little_endian(a->data + at_a + 4, 4);
        assert_in_range(at_a + size, 0, a->size);
        assert_in_range(at_b + size, 0, b->size);
        assert_memory_equal(a->data + at_a, b->data + at_b, size);
    }
}

static void written_floats_come_back_exactly(void **state)
{
    (void)state;
    static const char *const lossless[] = {"none", "rle", "zips", "zip", "piz"};
    static float values[2 * PIXELS];
    for (size_t i = 0; i < sizeof lossless / sizeof lossless[0]; i++) {
        struct exr_new_part part = make_part("g", lossless[i]);
        struct exr_read read = {"Z", values + 1, 2};
        struct exr_info info;
        struct tool_error err = {0};
        write_ok(in_directory("a.exr"), NULL, &part, 1);
        memset(values, 0, sizeof values);
        assert_true(read_part(in_directory("a.exr"), 0, &read, 1, &err));
        for (size_t k = 0; k < PIXELS; k++) {
            assert_memory_equal(&values[2 * k + 1], &noise[k], sizeof noise[k]);
            assert_true(values[2 * k] == 0.0f); /* the stride leaves its gaps alone */
        }
        info_ok(in_directory("a.exr"), &info);
        assert_string_equal(info.parts[0].compression, lossless[i]);
        assert_memory_equal(&info.parts[0].data_window, &part.data_window, sizeof part.data_window);
        assert_memory_equal(&info.parts[0].display_window, &part.display_window,
                            sizeof part.display_window);
        assert_true(info.parts[0].pixel_aspect == 1.5f);
        exr_info_free(&info);
    }
}

static void halves_are_rounded_to_nearest_and_stay_finite(void **state)
{
    (void)state;
    /* 2049 lies midway between the halves 2048 and 2050 (even wins), 2051 between 2050 and 2052. */
    const float values[] = {2049.0f, 2051.0f, 1e30f, -INFINITY, 0.1f, 65519.0f};
    const float expected[] = {2048.0f, 2052.0f, 65504.0f, -65504.0f, 0.0999755859375f, 65504.0f};
    float back[6];
    struct exr_write channel = {"Y", EXR_HALF, values, 1};
    struct exr_read read = {"Y", back, 1};
    struct exr_new_part part = make_part("h", "none");
    struct tool_error err = {0};
    part.data_window = (struct exr_box){0, 0, 5, 0};
    part.channels = &channel;
    part.channel_count = 1;
    write_ok(in_directory("h.exr"), NULL, &part, 1);
    assert_true(read_part(in_directory("h.exr"), 0, &read, 1, &err));
    assert_memory_equal(back, expected, sizeof back);
}

static void a_channel_asked_for_twice_is_filled_twice(void **state)
{
    (void)state;
    static float one[PIXELS], two[PIXELS];
    struct exr_new_part part = make_part("g", "zip");
    struct exr_read reads[] = {{"Z", one, 1}, {"Z", two, 1}};
    struct tool_error err = {0};
    write_ok(in_directory("a.exr"), NULL, &part, 1);
    assert_true(read_part(in_directory("a.exr"), 0, reads, 2, &err));
    assert_memory_equal(one, noise, sizeof one);
    assert_memory_equal(two, noise, sizeof two);
}

static void append_keeps_every_existing_chunk_bit_identical(void **state)
{
    (void)state;
    static const char *const compressions[] = {"zips", "dwab"};
    const size_t chunks[] = {HEIGHT, 1}, first[] = {0, HEIGHT};
    struct exr_new_part parts[] = {make_part("one", compressions[0]),
                                   make_part("two", compressions[1])};
    struct exr_new_part ao = make_part("ao", "zip");
    write_ok(in_directory("in.exr"), NULL, parts, 2);
    write_ok(in_directory("out.exr"), in_directory("in.exr"), &ao, 1);
    struct bytes in = load_file(in_directory("in.exr")), out = load_file(in_directory("out.exr"));
    for (int i = 0; i < 2; i++)
        assert_same_chunks(&in, first[i], &out, first[i], chunks[i]);
    free(in.data);
    free(out.data);
}

static void append_promotes_a_single_part_with_its_chunks_and_attributes(void **state)
{
    (void)state;
    struct exr_string note = {"studio/note", "keep me"};
    struct exr_new_part part = make_part("", "dwaa"), ao = make_part("part0", "zip");
    struct exr_info info;
    part.strings = &note;
    part.string_count = 1;
    write_ok(in_directory("in.exr"), NULL, &part, 1);
    write_ok(in_directory("out.exr"), in_directory("in.exr"), &ao, 1);
    info_ok(in_directory("out.exr"), &info);
    assert_int_equal(info.part_count, 2);
    assert_string_equal(info.parts[0].name, "");
    assert_string_equal(info.parts[1].name, "part0");
    const struct exr_attribute *kept = find_attribute(&info.parts[0], "studio/note");
    assert_non_null(kept);
    assert_string_equal(kept->text, "keep me");
    exr_info_free(&info);
    struct bytes in = load_file(in_directory("in.exr")), out = load_file(in_directory("out.exr"));
    assert_same_chunks(&in, 0, &out, 0, 2);
    free(in.data);
    free(out.data);
}

static void appended_parts_share_the_first_display_window(void **state)
{
    (void)state;
    struct exr_new_part part = make_part("g", "zip"), ao = make_part("ao", "zip");
    struct exr_info info;
    ao.display_window.x_max = 5000;
    ao.pixel_aspect = 1.0f;
    write_ok(in_directory("in.exr"), NULL, &part, 1);
    write_ok(in_directory("out.exr"), in_directory("in.exr"), &ao, 1);
    info_ok(in_directory("out.exr"), &info);
    assert_int_equal(info.parts[1].display_window.x_max, 99);
    assert_true(info.parts[1].pixel_aspect == 1.5f);
    exr_info_free(&info);
}

static void new_parts_take_attributes_but_no_structure_from_another(void **state)
{
    (void)state;
    struct exr_string strings[] = {{"owner", "studio"}, {"cryptomatte/1/name", "object"}};
    struct exr_new_part part = make_part("g", "piz"), ao = make_part("ao", "zip");
    struct exr_info info, from;
    part.view = "left";
    part.strings = strings;
    part.string_count = 2;
    ao.attributes_from = &from;
    write_ok(in_directory("in.exr"), NULL, &part, 1);
    info_ok(in_directory("in.exr"), &from);
    write_ok(in_directory("out.exr"), NULL, &ao, 1);
    info_ok(in_directory("out.exr"), &info);
    assert_non_null(find_attribute(&info.parts[0], "owner"));
    assert_null(find_attribute(&info.parts[0], "cryptomatte/1/name"));
    assert_string_equal(info.parts[0].name, "ao");
    assert_string_equal(info.parts[0].view, "");
    assert_string_equal(info.parts[0].compression, "zip");
    exr_info_free(&info);
    exr_info_free(&from);
}

static void two_parts_of_one_name_are_an_error(void **state)
{
    (void)state;
    struct exr_new_part part = make_part("ao", "zip");
    struct tool_error err = {0};
    write_ok(in_directory("in.exr"), NULL, &part, 1);
    assert_false(write_copy(in_directory("out.exr"), in_directory("in.exr"), &part, 1, &err));
    assert_int_equal(err.code, EXIT_OUTPUT);
    assert_non_null(strstr(err.message, "'ao'"));
    assert_int_equal(files_in_directory(), 1);
}

static void truncated_file_is_an_error(void **state)
{
    (void)state;
    struct exr_new_part parts[] = {make_part("one", "zip"), make_part("two", "none")};
    for (size_t count = 1; count <= 2; count++) {
        write_ok(in_directory("whole.exr"), NULL, parts, count);
        struct bytes file = load_file(in_directory("whole.exr"));
        /* Every cut up to the first chunks, then in strides, and the last bytes. */
        for (size_t cut = 0; cut < file.size; cut += cut < 1200 || cut + 9 > file.size ? 1 : 151) {
            struct tool_error err = {0};
            store_file(in_directory("cut.exr"), file.data, cut);
            if (reads_whole(in_directory("cut.exr"), &err))
                fail_msg("%zu of %zu bytes were accepted", cut, file.size);
            assert_int_equal(err.code, EXIT_INPUT);
        }
        store_file(in_directory("cut.exr"), file.data, file.size - 1);
        expect_refused(in_directory("cut.exr"), EXIT_INPUT, "truncated");
        free(file.data);
    }
}

static void truncated_file_is_not_appended_to(void **state)
{
    (void)state;
    struct exr_new_part part = make_part("g", "none"), ao = make_part("ao", "zip");
    struct tool_error err = {0};
    write_ok(in_directory("whole.exr"), NULL, &part, 1);
    struct bytes file = load_file(in_directory("whole.exr"));
    store_file(in_directory("cut.exr"), file.data, file.size * 6 / 10);
    free(file.data);
    assert_false(write_copy(in_directory("out.exr"), in_directory("cut.exr"), &ao, 1, &err));
    assert_int_equal(err.code, EXIT_INPUT);
    assert_non_null(strstr(err.message, "cut.exr"));
    assert_int_equal(files_in_directory(), 2);
}

static void unfinished_file_is_an_error(void **state)
{
    (void)state;
    struct exr_new_part part = make_part("g", "none");
    write_ok(in_directory("a.exr"), NULL, &part, 1);
    struct bytes file = load_file(in_directory("a.exr"));
    memset(file.data + skip_headers(&file) + 8 * 7, 0, 8); /* as a renderer that was killed */
    store_file(in_directory("a.exr"), file.data, file.size);
    free(file.data);
    expect_refused(in_directory("a.exr"), EXIT_INPUT, "part 0 has 44 of 45 chunks");
}

/* The value of a header attribute, to be damaged. */
static unsigned char *header_value(struct bytes *file, const char *name)
{
    unsigned char *at = memmem(file->data, file->size, name, strlen(name) + 1);
    assert_non_null(at);
    at += strlen(name) + 1;
    return at + strlen((char *)at) + 1 + 4;
}

static void damaged_headers_are_named_errors(void **state)
{
    (void)state;
    static const struct {
        const char *attribute;
        size_t offset;
        unsigned char bytes[4];
        size_t count;
        const char *text;
    } cases[] = {
        {"compression", 0, {10}, 1, "compression htj2k256 (10) needs a newer OpenEXR"},
        {"compression", 0, {11}, 1, "compression htj2k32 (11) needs a newer OpenEXR"},
        {"compression", 0, {200}, 1, "compression (200) needs a newer OpenEXR"},
        {"dataWindow", 8, {0xff, 0xff, 0xff, 0x7f}, 4, "more than the limit"},
        {"dataWindow", 8, {0, 0, 0, 0x80}, 4, "dataWindow is empty"},
        {"dataWindow", 8, {0, 0xff, 0, 0}, 4, "cannot hold"},
        {"dataWindow", 12, {0, 2, 0, 0}, 4, "of 508 chunks"},
        {"channels", 2, {9}, 1, "channel 'A' is invalid"},
        {"lineOrder", 0, {7}, 1, "damaged"},
        {"channels", (size_t)-4, {0xff, 0xff, 0xff, 0x7f}, 4, "claims 2147483647 bytes"},
    };
    struct exr_new_part part = make_part("g", "none");
    write_ok(in_directory("a.exr"), NULL, &part, 1);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct bytes file = load_file(in_directory("a.exr"));
        memcpy(header_value(&file, cases[i].attribute) + cases[i].offset, cases[i].bytes,
               cases[i].count);
        store_file(in_directory("bad.exr"), file.data, file.size);
        free(file.data);
        expect_refused(in_directory("bad.exr"), EXIT_INPUT, cases[i].text);
    }
}

static void other_formats_and_empty_files_are_named(void **state)
{
    (void)state;
    static const struct {
        const char *bytes;
        size_t size;
        const char *text;
    } cases[] = {
        {"\x89PNG\r\n", 6, "not an OpenEXR file (first bytes 89 50 4E 47 = PNG)"},
        {"\xff\xd8\xff\xe0", 4, "= JPEG"},
        {"#?RADIANCE", 10, "= Radiance HDR"},
        {"II*\0....", 8, "= TIFF"},
        {"hello", 5, "(first bytes 68 65 6C 6C)"},
        {"", 0, "empty file"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        store_file(in_directory("x.exr"), cases[i].bytes, cases[i].size);
        expect_refused(in_directory("x.exr"), EXIT_INPUT, cases[i].text);
    }
    expect_refused(in_directory("none.exr"), EXIT_INPUT, "cannot open: No such file or directory");
    expect_refused(in_directory("."), EXIT_INPUT, "Is a directory");
}

/* Puts an attribute in front of all others of a single-part file; the chunk table follows the
 * shift. */
static struct bytes with_attribute(const struct bytes *file, const char *type, const void *value,
                                   size_t size, size_t claimed)
{
    const size_t name = 2, head = name + strlen(type) + 1 + 4, shift = head + size;
    struct bytes out = {malloc(file->size + shift), file->size + shift};
    assert_non_null(out.data);
    memcpy(out.data, file->data, 8);
    memcpy(out.data + 8, "x", name);
    memcpy(out.data + 8 + name, type, strlen(type) + 1);
    for (size_t i = 0; i < 4; i++)
        out.data[8 + head - 4 + i] = (unsigned char)(claimed >> 8 * i);
    memcpy(out.data + 8 + head, value, size);
    memcpy(out.data + 8 + shift, file->data + 8, file->size - 8);
    const size_t table = skip_headers(file);
    const size_t chunks = ((size_t)little_endian(file->data + table, 8) - table) / 8;
    for (size_t i = 0; i < chunks; i++) {
        const uint64_t offset = little_endian(file->data + table + 8 * i, 8) + shift;
        for (size_t k = 0; k < 8; k++)
            out.data[table + shift + 8 * i + k] = (unsigned char)(offset >> 8 * k);
    }
    return out;
}

static void attributes_of_another_size_than_their_types_are_refused(void **state)
{
    (void)state;
    /* Of types that zeros are no value of. */
    static const unsigned char string[6] = {2, 0, 0, 0, 'a', 'b'}, picture[12] = {1, 0, 0, 0, 1},
                               film[28] = {[20] = 4, [24] = 64},
                               channel[19] = {'Z', 0, 2, [10] = 1, [14] = 1};
    static const struct {
        const char *type;
        size_t bytes;
        const unsigned char *value; /* NULL: zeros */
    } types[] = {
        {"box2i", 16, NULL},         {"box2f", 16, NULL},      {"chromaticities", 32, NULL},
        {"compression", 1, NULL},    {"double", 8, NULL},      {"envmap", 1, NULL},
        {"float", 4, NULL},          {"int", 4, NULL},         {"keycode", 28, film},
        {"lineOrder", 1, NULL},      {"m33f", 36, NULL},       {"m33d", 72, NULL},
        {"m44f", 64, NULL},          {"m44d", 128, NULL},      {"rational", 8, NULL},
        {"timecode", 8, NULL},       {"v2i", 8, NULL},         {"v2f", 8, NULL},
        {"v2d", 16, NULL},           {"v3i", 12, NULL},        {"v3f", 12, NULL},
        {"v3d", 24, NULL},           {"tiledesc", 9, NULL},    {"floatvector", 8, NULL},
        {"stringvector", 6, string}, {"preview", 12, picture}, {"chlist", 19, channel},
    };
    struct exr_new_part part = make_part("g", "none");
    write_ok(in_directory("in.exr"), NULL, &part, 1);
    struct bytes file = load_file(in_directory("in.exr"));
    for (size_t i = 0; i < sizeof types / sizeof *types; i++) {
        for (int difference = -1; difference <= 1; difference++) {
            const size_t size = types[i].bytes + (size_t)difference;
            unsigned char value[161] = {0};
            if (types[i].value)
                memcpy(value, types[i].value, types[i].bytes);
            struct bytes made = with_attribute(&file, types[i].type, value, size, size);
            struct tool_error err = {0};
            store_file(in_directory("x.exr"), made.data, made.size);
            free(made.data);
            const bool read = reads_whole(in_directory("x.exr"), &err);
            if (read != (difference == 0))
                fail_msg("%s of %zu bytes: %s", types[i].type, size,
                         read ? "accepted" : err.message);
            if (!read) {
                assert_int_equal(err.code, EXIT_INPUT);
                assert_non_null(strstr(err.message, "is not a valid"));
            }
        }
    }
    free(file.data);
}

/* What two parsers of the headers would disagree on: the window of the second becomes larger. */
static void a_header_hidden_in_an_attribute_does_not_move_the_window(void **state)
{
    (void)state;
    struct exr_new_part part = make_part("g", "none");
    unsigned char value[8 + 64] = {0};
    /* Behind the 8 bytes that are claimed come 4 that a v3f takes, and then a header of its own. */
    memcpy(value + 12, "dataWindow\0box2i\0\x10\0\0\0\0\0\0\0\0\0\0\0\xff\xff\0\0\xff\xff\0\0", 37);
    write_ok(in_directory("in.exr"), NULL, &part, 1);
    struct bytes file = load_file(in_directory("in.exr"));
    struct bytes made = with_attribute(&file, "v3f", value, sizeof value, 8);
    store_file(in_directory("x.exr"), made.data, made.size);
    expect_refused(in_directory("x.exr"), EXIT_INPUT,
                   "attribute 'x' of 8 bytes is not a valid v3f");
    free(made.data);
    free(file.data);
}

static void an_open_file_is_read_as_it_was_when_another_takes_its_place(void **state)
{
    (void)state;
    static float values[PIXELS];
    struct exr_new_part part = make_part("g", "zip"), larger = make_part("g", "zip");
    static float many[4 * PIXELS];
    const struct exr_write channels[] = {{"Y", EXR_HALF, many, 1}, {"Z", EXR_FLOAT, many, 1}};
    larger.data_window = (struct exr_box){0, 0, 2 * WIDTH - 1, 2 * HEIGHT - 1};
    larger.channels = channels;
    struct exr_info info;
    struct tool_error err = {0};
    const struct exr_read read = {"Z", values, 1};
    write_ok(in_directory("in.exr"), NULL, &part, 1);
    info_ok(in_directory("in.exr"), &info);
    write_ok(in_directory("in.exr"), NULL, &larger, 1);
    assert_true(exr_read_channels(&info, 0, &read, 1, &err));
    assert_memory_equal(values, noise, sizeof noise);
    /* And the copy is of what was opened. */
    struct exr_new_part ao = make_part("ao", "zip");
    assert_true(exr_write_file(in_directory("out.exr"), &info, &ao, 1, true, &err));
    exr_info_free(&info);
    assert_true(read_part(in_directory("out.exr"), 0, &read, 1, &err));
    assert_memory_equal(values, noise, sizeof noise);
}

static void a_file_written_to_while_open_is_an_error(void **state)
{
    (void)state;
    static float values[PIXELS];
    struct exr_new_part part = make_part("g", "none"), ao = make_part("ao", "zip");
    const struct exr_read read = {"Z", values, 1};
    write_ok(in_directory("in.exr"), NULL, &part, 1);
    struct bytes file = load_file(in_directory("in.exr"));
    const struct {
        size_t size, from; /* bytes kept, and where other ones are written */
    } changes[] = {
        {file.size / 2, SIZE_MAX}, {file.size, 40}, {file.size, file.size - 100}, {0, SIZE_MAX}};
    for (size_t i = 0; i < sizeof changes / sizeof *changes; i++) {
        struct exr_info info;
        struct tool_error read_err = {0}, write_err = {0};
        store_file(in_directory("in.exr"), file.data, file.size);
        info_ok(in_directory("in.exr"), &info);
        FILE *f = fopen(in_directory("in.exr"), "r+b");
        assert_non_null(f);
        assert_int_equal(ftruncate(fileno(f), (off_t)changes[i].size), 0);
        if (changes[i].from < file.size) {
            fseek(f, (long)changes[i].from, SEEK_SET);
            fwrite("xxxxxxxxxxxxxxxx", 1, 16, f);
        }
        fclose(f);
        /* Clocks of file systems tick slower than this test runs. */
        const struct timespec later[2] = {{.tv_nsec = UTIME_OMIT},
                                          {.tv_sec = 2000000000 + (time_t)i}};
        assert_int_equal(utimensat(AT_FDCWD, in_directory("in.exr"), later, 0), 0);
        assert_false(exr_read_channels(&info, 0, &read, 1, &read_err));
        assert_int_equal(read_err.code, EXIT_INPUT);
        assert_non_null(strstr(read_err.message, "written to it"));
        assert_false(exr_write_file(in_directory("out.exr"), &info, &ao, 1, true, &write_err));
        assert_int_equal(write_err.code, EXIT_INPUT);
        assert_int_equal(files_in_directory(), 1);
        exr_info_free(&info);
    }
    free(file.data);
}

static void chunks_in_the_wrong_place_are_not_appended_to(void **state)
{
    (void)state;
    struct exr_new_part part = make_part("g", "none"), ao = make_part("ao", "zip");
    write_ok(in_directory("in.exr"), NULL, &part, 1);
    struct bytes file = load_file(in_directory("in.exr"));
    unsigned char *table = file.data + skip_headers(&file);
    struct tool_error err = {0};
    /* Twice the same one: each is whole and inside the file. */
    memcpy(table + 8 * 7, table + 8 * 3, 8);
    store_file(in_directory("in.exr"), file.data, file.size);
    free(file.data);
    assert_false(write_copy(in_directory("out.exr"), in_directory("in.exr"), &ao, 1, &err));
    assert_int_equal(err.code, EXIT_INPUT);
    assert_non_null(strstr(err.message, "chunk 7 of part 0"));
    assert_int_equal(files_in_directory(), 1);
}

static void missing_channel_is_a_channel_error(void **state)
{
    (void)state;
    float value[1];
    struct exr_new_part part = make_part("g", "zip");
    struct exr_read read = {"depth.Z", value, 1};
    struct tool_error err = {0};
    write_ok(in_directory("a.exr"), NULL, &part, 1);
    assert_false(read_part(in_directory("a.exr"), 0, &read, 1, &err));
    assert_int_equal(err.code, EXIT_CHANNELS);
    assert_non_null(strstr(err.message, "'depth.Z'"));
}

#define TEST(name) cmocka_unit_test_teardown(name, empty_directory)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(written_floats_come_back_exactly),
        TEST(halves_are_rounded_to_nearest_and_stay_finite),
        TEST(a_channel_asked_for_twice_is_filled_twice),
        TEST(append_keeps_every_existing_chunk_bit_identical),
        TEST(append_promotes_a_single_part_with_its_chunks_and_attributes),
        TEST(appended_parts_share_the_first_display_window),
        TEST(new_parts_take_attributes_but_no_structure_from_another),
        TEST(two_parts_of_one_name_are_an_error),
        TEST(truncated_file_is_an_error),
        TEST(truncated_file_is_not_appended_to),
        TEST(unfinished_file_is_an_error),
        TEST(damaged_headers_are_named_errors),
        TEST(other_formats_and_empty_files_are_named),
        TEST(attributes_of_another_size_than_their_types_are_refused),
        TEST(a_header_hidden_in_an_attribute_does_not_move_the_window),
        TEST(an_open_file_is_read_as_it_was_when_another_takes_its_place),
        TEST(a_file_written_to_while_open_is_an_error),
        TEST(chunks_in_the_wrong_place_are_not_appended_to),
        TEST(missing_channel_is_a_channel_error),
    };
    return cmocka_run_group_tests(tests, make_directory, remove_directory);
}
