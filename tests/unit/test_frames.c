/* SPDX-License-Identifier: MIT
 *
 * Frame numbers and the file names that hold them. */
#include "frames.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <sys/stat.h>
#include <unistd.h>

/* Of this program and what it is linked with, the C library left out. */
static struct {
    unsigned total;   /* allocations ever tried */
    unsigned fail_at; /* 1 = the first fails; 0 = none */
    size_t live;
} memory;

void *__real_realloc(void *old, size_t size);
void __real_free(void *block);
void *__wrap_malloc(size_t size);
void *__wrap_realloc(void *old, size_t size);
void __wrap_free(void *block);

void *__wrap_realloc(void *old, size_t size)
{
    if (++memory.total == memory.fail_at)
        return NULL;
    memory.live += old ? 0 : 1;
    return __real_realloc(old, size);
}

void *__wrap_malloc(size_t size)
{
    return __wrap_realloc(NULL, size);
}

void __wrap_free(void *block)
{
    memory.live -= block ? 1 : 0;
    __real_free(block);
}

static void expect_frames(const char *spec, const int64_t *numbers, size_t count)
{
    struct frame_list list;
    struct tool_error err = {0};
    assert_true(frame_list_parse(spec, FRAME_SYNTAX_VFX, &list, &err));
    assert_int_equal(list.count, count);
    for (size_t i = 0; i < count; i++)
        assert_int_equal(list.frames[i].number, numbers[i]);
    frame_list_free(&list);
}

#define EXPECT_FRAMES(spec, ...)                                                                   \
    expect_frames(spec, (const int64_t[]){__VA_ARGS__},                                            \
                  sizeof(const int64_t[]){__VA_ARGS__} / sizeof(int64_t))

static void expect_refusal(const char *spec, const char *words)
{
    struct frame_list list;
    struct tool_error err = {0};
    assert_false(frame_list_parse(spec, FRAME_SYNTAX_VFX, &list, &err));
    assert_int_equal(err.code, EXIT_USAGE);
    assert_non_null(strstr(err.message, words));
    assert_null(list.frames);
}

static void ranges_steps_and_lists_are_expanded(void **state)
{
    (void)state;
    EXPECT_FRAMES("7", 7);
    EXPECT_FRAMES("1-4", 1, 2, 3, 4);
    EXPECT_FRAMES("1-10x3", 1, 4, 7, 10);
    EXPECT_FRAMES("1-3,20,30-31", 1, 2, 3, 20, 30, 31);
    EXPECT_FRAMES("0010-0012", 10, 11, 12);
}

static void negative_and_reversed_ranges_keep_their_order(void **state)
{
    (void)state;
    EXPECT_FRAMES("-3--1", -3, -2, -1);
    EXPECT_FRAMES("-1-1", -1, 0, 1);
    EXPECT_FRAMES("4-1", 4, 3, 2, 1);
    EXPECT_FRAMES("10-1x4", 10, 6, 2);
}

static void repeated_frames_count_once_where_they_first_stand(void **state)
{
    (void)state;
    EXPECT_FRAMES("5,1-6,5", 5, 1, 2, 3, 4, 6);
}

static void colon_is_refused_unless_the_syntax_is_openjd(void **state)
{
    struct frame_list list;
    struct tool_error err = {0};
    (void)state;
    expect_refusal("1-10:2", "':' means step in OpenJD but interleave in fileseq/OpenCue");
    assert_false(frame_list_parse("1-10:2", FRAME_SYNTAX_VFX, &list, &err));
    assert_non_null(strstr(err.hint, "1-10x2"));
    err = (struct tool_error){0};
    assert_true(frame_list_parse("1-9:4", FRAME_SYNTAX_OPENJD, &list, &err));
    assert_int_equal(list.count, 3);
    assert_int_equal(list.frames[2].number, 9);
    frame_list_free(&list);
}

static void nonsense_is_refused_with_the_place(void **state)
{
    (void)state;
    expect_refusal("", "expected a frame number at ''");
    expect_refusal("1-", "expected a frame number");
    expect_refusal("a", "expected a frame number at 'a'");
    expect_refusal("1-5x0", "step");
    expect_refusal("1-5x-1", "step");
    expect_refusal("1-5y2", "'y'");
    expect_refusal("1,,2", "at ',2'");
    expect_refusal("1 2", "cannot read ' 2'");
    expect_refusal("1-100000000", "more than");
    expect_refusal("99999999999999999999", "expected a frame number");
}

static void expect_path(const char *pattern, int64_t number, const char *path)
{
    struct frame_pattern p;
    struct tool_error err = {0};
    assert_true(frame_pattern_parse(pattern, &p, &err));
    char *made = frame_pattern_path(&p, number);
    assert_string_equal(made, path);
    free(made);
    frame_pattern_free(&p);
}

static void every_token_pads_as_its_origin_does(void **state)
{
    (void)state;
    expect_path("a/x.####.exr", 7, "a/x.0007.exr");
    expect_path("x.#.exr", 7, "x.0007.exr");
    expect_path("x.######.exr", 7, "x.000007.exr");
    expect_path("x.@@@.exr", 7, "x.007.exr");
    expect_path("x.%04d.exr", 12345, "x.12345.exr");
    expect_path("x.%d.exr", 12, "x.12.exr");
    expect_path("x.$F4.exr", 12, "x.0012.exr");
    expect_path("x.$F.exr", 12, "x.12.exr");
    expect_path("x.####.exr", -3, "x.-0003.exr");
}

static void tokens_count_in_the_last_path_component_only(void **state)
{
    struct frame_pattern p;
    struct tool_error err = {0};
    (void)state;
    assert_true(frame_pattern_parse("user@host/sh#10/x.exr", &p, &err));
    assert_false(frame_pattern_has_token(&p));
    frame_pattern_free(&p);
    expect_path("user@host/x.exr", 5, "user@host/x.exr");
}

static void mixed_and_repeated_tokens_are_refused(void **state)
{
    struct frame_pattern p;
    struct tool_error err = {0};
    (void)state;
    assert_false(frame_pattern_parse("x.#@@.exr", &p, &err));
    assert_non_null(strstr(err.message, "mixes # and @"));
    err = (struct tool_error){0};
    assert_false(frame_pattern_parse("x.####.%04d.exr", &p, &err));
    assert_non_null(strstr(err.message, "more than one frame token"));
    assert_int_equal(err.code, EXIT_USAGE);
}

static char directory[64];

static void touch(const char *name)
{
    char path[128];
    snprintf(path, sizeof path, "%s/%s", directory, name);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fclose(file);
}

static int make_directory(void **state)
{
    (void)state;
    const char *parent = getenv("TMPDIR");
    snprintf(directory, sizeof directory, "%s/vkao-frames-XXXXXX", parent ? parent : P_tmpdir);
    return mkdtemp(directory) ? 0 : -1;
}

static int remove_directory(void **state)
{
    static const char *const names[] = {"x.0001.exr", "x.0003.exr", "x.3.exr",   "x.12345.exr",
                                        "x.-2.exr",   "x.00a1.exr", "y.0001.exr"};
    char path[128];
    (void)state;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        snprintf(path, sizeof path, "%s/%s", directory, names[i]);
        unlink(path);
    }
    return rmdir(directory);
}

static void scan_finds_any_padding_in_order_and_prefers_the_pattern(void **state)
{
    static const int64_t numbers[] = {-2, 1, 3, 12345};
    struct frame_pattern p;
    struct frame_list list;
    struct tool_error err = {0};
    char pattern[128], exact[128];
    (void)state;
    touch("x.12345.exr");
    touch("x.3.exr");
    touch("x.0003.exr");
    touch("x.0001.exr");
    touch("x.-2.exr");
    touch("x.00a1.exr");
    touch("y.0001.exr");
    snprintf(pattern, sizeof pattern, "%s/x.####.exr", directory);
    snprintf(exact, sizeof exact, "%s/x.0003.exr", directory);
    assert_true(frame_pattern_parse(pattern, &p, &err));
    assert_true(frame_pattern_scan(&p, &list, &err));
    assert_int_equal(list.count, 4);
    for (size_t i = 0; i < 4; i++)
        assert_int_equal(list.frames[i].number, numbers[i]);
    assert_string_equal(list.frames[2].path, exact);
    frame_list_free(&list);
    frame_pattern_free(&p);
}

static void failing_nth_allocation_of_a_scan_leaks_nothing(void **state)
{
    struct frame_pattern p;
    struct frame_list list;
    struct tool_error err = {0};
    char pattern[128];
    bool ok = false;
    (void)state;
    touch("x.3.exr");
    touch("x.0003.exr");
    touch("x.12345.exr");
    snprintf(pattern, sizeof pattern, "%s/x.####.exr", directory);
    assert_true(frame_pattern_parse(pattern, &p, &err));
    const size_t before = memory.live;
    for (unsigned n = 1; !ok; n++) {
        memory.fail_at = memory.total + n;
        ok = frame_pattern_scan(&p, &list, &err);
        memory.fail_at = 0;
        if (ok)
            frame_list_free(&list);
        else
            assert_int_equal(err.code, EXIT_MEMORY);
        assert_int_equal(memory.live, before);
    }
    frame_pattern_free(&p);
}

static void description_joins_runs_and_stays_in_its_buffer(void **state)
{
    struct frame_list list;
    struct tool_error err = {0};
    char text[64], small[16];
    (void)state;
    assert_true(frame_list_parse("1-99,102-240,300", FRAME_SYNTAX_VFX, &list, &err));
    frame_list_describe(&list, text, sizeof text);
    assert_string_equal(text, "1-99, 102-240, 300");
    frame_list_describe(&list, small, sizeof small);
    assert_string_equal(small, "1-99, ...");
    frame_list_free(&list);
}

#define TEST(name) cmocka_unit_test(name)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(ranges_steps_and_lists_are_expanded),
        TEST(negative_and_reversed_ranges_keep_their_order),
        TEST(repeated_frames_count_once_where_they_first_stand),
        TEST(colon_is_refused_unless_the_syntax_is_openjd),
        TEST(nonsense_is_refused_with_the_place),
        TEST(every_token_pads_as_its_origin_does),
        TEST(tokens_count_in_the_last_path_component_only),
        TEST(mixed_and_repeated_tokens_are_refused),
        cmocka_unit_test_setup_teardown(scan_finds_any_padding_in_order_and_prefers_the_pattern,
                                        make_directory, remove_directory),
        cmocka_unit_test_setup_teardown(failing_nth_allocation_of_a_scan_leaks_nothing,
                                        make_directory, remove_directory),
        TEST(description_joins_runs_and_stays_in_its_buffer),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
