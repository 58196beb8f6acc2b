/* SPDX-License-Identifier: MIT
 *
 * A frame list and a frame pattern of any bytes; the pattern also looks for its files. */
#include "frames.h"
#include "fuzz.h"
#include "plan.h"

#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* MANY: of more than these not everything is looked at, which would take too long. */
enum { MOST_FRAMES = 1000000, MANY_FRAMES = 10000 };

static int compare_numbers(const void *a, const void *b)
{
    const int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
    return x < y ? -1 : x > y;
}

static void check_numbers(const struct frame_list *list)
{
    FUZZ_CHECK(list->count > 0 && list->count <= MOST_FRAMES, "%zu frames", list->count);
    if (list->count > MANY_FRAMES)
        return;
    int64_t *sorted = malloc(list->count * sizeof *sorted);
    if (!sorted)
        abort();
    for (size_t i = 0; i < list->count; i++) {
        FUZZ_CHECK(!list->frames[i].path, "a list has paths");
        sorted[i] = list->frames[i].number;
    }
    qsort(sorted, list->count, sizeof *sorted, compare_numbers);
    for (size_t i = 1; i < list->count; i++)
        FUZZ_CHECK(sorted[i] != sorted[i - 1], "%lld occurs twice", (long long)sorted[i]);
    free(sorted);
}

/* Cut where the buffer ends, and never beyond; readable back if it was not cut. */
static void check_description(const struct frame_list *list)
{
    for (size_t size = 8; size <= 512; size *= 4) {
        char *buffer = malloc(size);
        if (!buffer)
            abort();
        frame_list_describe(list, buffer, size);
        FUZZ_CHECK(memchr(buffer, '\0', size), "no end within %zu", size);
        free(buffer);
    }
}

static void fuzz_list(const char *spec, enum frame_syntax syntax)
{
    struct frame_list list;
    struct tool_error err = {0};
    if (frame_list_parse(spec, syntax, &list, &err)) {
        check_numbers(&list);
        check_description(&list);
        frame_list_free(&list);
        return;
    }
    fuzz_check_refusal(&err, FUZZ_CODE(EXIT_USAGE) | FUZZ_CODE(EXIT_MEMORY));
    FUZZ_CHECK(!list.frames && !list.count, "a refusal left frames behind");
}

/* What the pattern calls frame number is found again as that frame. */
static void check_scan(const struct frame_pattern *pattern, int64_t number)
{
    struct frame_list list;
    struct tool_error err = {0};
    char *path = frame_pattern_path(pattern, number);
    if (!path)
        abort();
    const int fd = open(path, O_CREAT | O_WRONLY | O_CLOEXEC, 0600);
    if (fd < 0) { /* too long a name, or none: nothing to find */
        free(path);
        return;
    }
    close(fd);
    if (frame_pattern_scan(pattern, &list, &err)) {
        bool found = false;
        for (size_t i = 0; i < list.count; i++) {
            found |= list.frames[i].number == number && strcmp(list.frames[i].path, path) == 0;
            FUZZ_CHECK(i == 0 || list.frames[i - 1].number < list.frames[i].number,
                       "not sorted at %zu", i);
        }
        FUZZ_CHECK(found, "'%s' is not found by its pattern, which finds %zu", path, list.count);
        frame_list_free(&list);
    } else {
        fuzz_check_refusal(&err, FUZZ_CODE(EXIT_INPUT));
        FUZZ_CHECK(0, "'%s' exists, and cannot be listed: %s", path, err.message);
    }
    unlink(path);
    free(path);
}

static void check_paths(const struct frame_pattern *pattern, const char *text)
{
    static const int64_t numbers[] = {0, 7, -12, 123456, 999999999999999999, -999999999999999999};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        char *path = frame_pattern_path(pattern, numbers[i]);
        FUZZ_CHECK(path, "no memory for a path");
        if (!frame_pattern_has_token(pattern))
            FUZZ_CHECK(strcmp(path, text) == 0, "'%s' became '%s'", text, path);
        free(path);
    }
}

static void fuzz_pattern(const char *text)
{
    struct frame_pattern pattern;
    struct tool_error err = {0};
    if (!frame_pattern_parse(text, &pattern, &err)) {
        fuzz_check_refusal(&err, FUZZ_CODE(EXIT_USAGE) | FUZZ_CODE(EXIT_MEMORY));
        return;
    }
    FUZZ_CHECK(pattern.digits >= 0 && pattern.digits <= 18, "%d digits", pattern.digits);
    check_paths(&pattern, text);
    frame_pattern_free(&pattern);
}

/* Patterns are only looked for in a directory of our own. */
static void fuzz_scan(const char *name)
{
    char path[PATH_MAX];
    struct frame_pattern pattern;
    struct tool_error err = {0};
    if (strlen(name) > 200 || strchr(name, '/'))
        return;
    snprintf(path, sizeof path, "%s/%s", fuzz_directory(), name);
    if (!frame_pattern_parse(path, &pattern, &err))
        return;
    if (frame_pattern_has_token(&pattern)) {
        check_scan(&pattern, 7);
        check_scan(&pattern, -40);
        check_scan(&pattern, 1234567);
    }
    frame_pattern_free(&pattern);
}

/* The text as what render is told: INPUT, --output, --frames and --camera, one a line. */
static void check_plan(const struct options *options, const struct plan *plan)
{
    FUZZ_CHECK(plan->count > 0 && plan->count <= MOST_FRAMES, "%zu frames", plan->count);
    for (size_t i = 0; i < plan->count; i++) {
        const struct plan_frame *f = &plan->frames[i];
        FUZZ_CHECK(f->input && f->output, "frame %zu has no file", i);
        FUZZ_CHECK(strcmp(f->input, f->output) != 0, "'%s' is written to itself", f->input);
        FUZZ_CHECK(i == 0 || strcmp(f->output, f[-1].output) != 0, "'%s' is written twice",
                   f->output);
        const bool named = options->camera_file && strcmp(options->camera_file, "none") != 0;
        FUZZ_CHECK(named ? f->camera != NULL : plan->cameras_lie_beside || !f->camera,
                   "frame %zu lacks its camera", i);
    }
}

static void fuzz_plan(char *text)
{
    struct options options;
    struct plan plan;
    struct tool_error err = {0};
    char *lines[4] = {0}, input[PATH_MAX], output[PATH_MAX];
    for (size_t i = 0; i < 4 && text; i++) {
        lines[i] = text;
        text = strchr(text, '\n');
        if (text)
            *text++ = '\0';
    }
    if (!lines[1] || strchr(lines[0], '/') || strchr(lines[1], '/'))
        return;
    snprintf(input, sizeof input, "%s/%s", fuzz_directory(), lines[0]);
    snprintf(output, sizeof output, "%s/%s", fuzz_directory(), lines[1]);
    char words[3][20] = {"--output", "--frames", "--camera"}, program[] = "vkao";
    char *argv[] = {program, input, words[0], output, words[1], lines[2], words[2], lines[3], NULL};
    struct frame_list list = {0};
    const bool is_list = !lines[2] || frame_list_parse(lines[2], FRAME_SYNTAX_VFX, &list, &err);
    const size_t frames = list.count;
    frame_list_free(&list);
    err = (struct tool_error){0};
    if (is_list && frames > MANY_FRAMES / 10)
        return;
    const int argc = lines[3] ? 8 : lines[2] ? 6 : 4;
    argv[argc] = NULL;
    if (!options_parse(argc, argv, &options, &err)) {
        fuzz_check_refusal(&err, FUZZ_CODE(EXIT_USAGE));
        return;
    }
    if (plan_make(&options, &plan, &err)) {
        check_plan(&options, &plan);
        plan_free(&plan);
        return;
    }
    fuzz_check_refusal(&err, FUZZ_CODE(EXIT_USAGE) | FUZZ_CODE(EXIT_INPUT) |
                                 FUZZ_CODE(EXIT_OUTPUT) | FUZZ_CODE(EXIT_MEMORY));
    FUZZ_CHECK(!plan.frames && !plan.count, "a refusal left frames behind");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char *text = fuzz_copy(data, size);
    fuzz_list(text, FRAME_SYNTAX_VFX);
    if (strchr(text, ':'))
        fuzz_list(text, FRAME_SYNTAX_OPENJD);
    fuzz_pattern(text);
    fuzz_scan(text);
    fuzz_plan(text); /* takes the text apart */
    free(text);
    return 0;
}
