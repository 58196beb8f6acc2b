/* SPDX-License-Identifier: MIT
 *
 * A command line of any words: one a line, or separated by zeros. What is accepted is in range, and
 * the library takes it; what is refused says why. */
#include "fuzz.h"
#include "fuzz_view.h"
#include "options.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_WORDS = 64 };

/* argv as a program gets it: each word ends where its memory ends. */
struct command_line {
    int argc;
    char *argv[MOST_WORDS + 1];
    char *owned[MOST_WORDS + 1]; /* getopt changes the order of argv */
};

static void split(const uint8_t *data, size_t size, struct command_line *line)
{
    line->argv[line->argc++] = fuzz_copy("vkao", 4);
    while (size && line->argc < MOST_WORDS) {
        size_t length = 0;
        while (length < size && data[length] && data[length] != '\n')
            length++;
        line->argv[line->argc++] = fuzz_copy(data, length);
        data += length + (length < size);
        size -= length + (length < size);
    }
    line->argv[line->argc] = NULL;
    memcpy(line->owned, line->argv, sizeof line->owned);
}

static void check_number(const struct option_row *row, double value)
{
    const struct option_range r = option_range(row);
    const bool low = r.low_is_excluded ? value > r.low : value >= r.low;
    const bool high = isinf(r.high) ? r.infinity_is_allowed || isfinite(value) : value <= r.high;
    FUZZ_CHECK(low && high, "--%s is %g", row->name, value);
}

static void check_parameter(const struct options *o, const struct option_row *row,
                            const vkao_parameter *p)
{
    const void *at = parameter_of_const(&o->setting, p);
    float number;
    uint32_t word;
    memcpy(&number, at, sizeof number);
    memcpy(&word, at, sizeof word);
    if (p->type == VKAO_PARAMETER_FLOAT || p->type == VKAO_PARAMETER_COLOR)
        check_number(row, (double)number);
    else
        FUZZ_CHECK((double)word <= p->most, "--%s is %u", row->name, word);
}

static void check_row(const struct options *o, const struct option_row *row)
{
    const char *member = (const char *)o + row->offset;
    double value;
    if (option_parameter(row)) {
        check_parameter(o, row, option_parameter(row));
    } else if (row->apply == apply_uint) {
        uint32_t whole;
        memcpy(&whole, member, sizeof whole);
        check_number(row, (double)whole);
    } else if (row->apply == apply_double) {
        memcpy(&value, member, sizeof value);
        /* 0 is what stands there if the option was not given. */
        if (value > 0 || value < 0)
            check_number(row, value);
    }
}

static void check_words(const struct options *o)
{
    for (size_t i = 0; i < option_table_count; i++) {
        const struct option_row *row = &option_table[i];
        int value;
        if (row->apply != apply_word) {
            check_row(o, row);
            continue;
        }
        memcpy(&value, (const char *)o + row->offset, sizeof value);
        const struct option_word *word = row->words;
        while (word->word && word->value != value)
            word++;
        FUZZ_CHECK(word->word || (!row->fallback && !value), "--%s is %d", row->name, value);
    }
}

/* render resolves the radius and the planes; all else goes to the library as it is. */
static void check_with_library(const struct options *o)
{
    struct ao_view view = ao_view_default();
    const struct exr_box box = {0, 0, 15, 8};
    struct exr_part part = {.data_window = box, .display_window = box, .pixel_aspect = 1.0f};
    const struct exr_info info = {.parts = &part, .part_count = 1};
    const struct camera_planes planes = {0.1, INFINITY};
    struct camera camera;
    camera_resolve(&o->gbuffer.camera, NULL, &info, 0, &camera);
    camera_project(&camera, &planes, &box, &box, &view);
    if (camera.type == CAMERA_ORTHOGRAPHIC)
        camera_project(&camera, &(struct camera_planes){0, 100}, &box, &box, &view);
    if (!camera_can_project(&view)) /* refused by name when the depth is prepared */
        return;
    fuzz_check_job(&(struct fuzz_job){
        .width = 16,
        .height = 9,
        .view = &view,
        .setting = &o->setting,
    });
}

static void check_frames(const struct options *o)
{
    struct frame_list list;
    struct tool_error err = {0};
    if (!o->frames)
        return;
    if (frame_list_parse(o->frames, o->frame_syntax, &list, &err))
        frame_list_free(&list);
    else
        fuzz_check_refusal(&err, FUZZ_CODE(EXIT_USAGE) | FUZZ_CODE(EXIT_MEMORY));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct command_line line = {0};
    struct options options;
    struct tool_error err = {0};
    split(data, size, &line);
    if (!options_parse(line.argc, line.argv, &options, &err)) {
        fuzz_check_refusal(&err, FUZZ_CODE(EXIT_USAGE));
    } else if (!options.help && !options.version) {
        FUZZ_CHECK(options.command == COMMAND_DEVICES || options.input, "no INPUT");
        FUZZ_CHECK(options.command != COMMAND_RENDER || options.output, "no output");
        check_words(&options);
        check_with_library(&options);
        check_frames(&options);
    }
    for (int i = 0; i < line.argc; i++)
        free(line.owned[i]);
    return 0;
}
