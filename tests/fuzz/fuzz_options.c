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

static void check_row(const struct options *o, const struct option_row *row)
{
    const char *member = (const char *)o + row->offset;
    double value;
    if (row->apply == apply_float || row->apply == apply_bias || row->apply == apply_normal_power) {
        float narrow;
        memcpy(&narrow, member, sizeof narrow);
        value = (double)narrow;
    } else if (row->apply == apply_uint || row->apply == apply_blur) {
        uint32_t whole;
        memcpy(&whole, member, sizeof whole);
        value = (double)whole;
    } else if (row->apply == apply_double) {
        memcpy(&value, member, sizeof value);
    } else {
        return;
    }
    const struct option_range *r = &row->range;
    /* 0 is what stands there if the option was not given. */
    const bool absent = !row->fallback && !(value > 0) && !(value < 0);
    const bool low = r->low_is_excluded ? value > r->low : value >= r->low;
    const bool high = isinf(r->high) ? r->infinity_is_allowed || isfinite(value) : value <= r->high;
    FUZZ_CHECK(absent || (low && high), "--%s is %g", row->name, value);
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
    struct ao_ssao ssao = o->ssao;
    if (o->radius_is_auto)
        ssao.radius = 1.0f;
    fuzz_check_job(&(struct fuzz_job){
        .width = 16,
        .height = 9,
        .half_resolution = o->half_resolution,
        .bent_normals = o->bent_normals,
        .view = &view,
        .ssao = &ssao,
        .blur = &o->blur,
        .composite = &o->composite,
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
