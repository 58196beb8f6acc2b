/* SPDX-License-Identifier: MIT
 *
 * A record of any bytes, as a stranger's file may have it. What is accepted is a setting that the
 * library takes, and is written and read back the same. */
#include "fuzz.h"
#include "fuzz_view.h"
#include "record.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* As render does it, up to the planes. */
static void check_options(const struct record *record)
{
    char *words[] = {(char[]){"vkao"}, (char[]){"i.exr"}, (char[]){"-oo.exr"},
                     (char[]){"--like=f"}};
    const struct exr_box box = {0, 0, 15, 8};
    struct exr_part part = {.data_window = box, .display_window = box, .pixel_aspect = 1.0f};
    const struct exr_info info = {.parts = &part, .part_count = 1};
    struct ao_view view = ao_view_default();
    struct options o;
    struct camera camera;
    struct tool_error err = {0};
    FUZZ_CHECK(options_parse(4, words, &o, &err), "%s", err.message);
    FUZZ_CHECK(options_take_record(&o, record, &err), "%s", err.message);
    FUZZ_CHECK(!o.radius_is_auto && o.bias_is_given, "something is left to the file");
    camera_resolve(&o.gbuffer.camera, &record->camera, &info, 0, &camera);
    const bool is_flat = camera.type == CAMERA_ORTHOGRAPHIC;
    const struct camera_planes planes = {is_flat ? 0 : 0.1, is_flat ? 100 : INFINITY};
    camera_project(&camera, &planes, &box, &box, &view);
    if (!camera_can_project(&view)) /* refused by name when the depth is prepared */
        return;
    fuzz_check_job(
        &(struct fuzz_job){.width = 16, .height = 9, .view = &view, .setting = &o.setting});
}

static void check_round_trip(const struct record *record)
{
    const struct options o = {
        .mode = record->mode, .pixel_type = record->pixel_type, .compression = record->compression};
    struct gbuffer g = {.camera = record->camera,
                        .depth_type = record->depth_type,
                        .normal_space = record->normal_space,
                        .normal_encoding = record->normal_encoding};
    struct record again;
    struct tool_error err = {0};
    char *json = record_write(&o, &record->setting, record->view, &g, record->device);
    FUZZ_CHECK(json, "no memory for a record");
    FUZZ_CHECK(record_parse(json, "fuzz.exr", &again, &err), "%s\n%s", err.message, json);
    FUZZ_CHECK(memcmp(&again.setting, &record->setting, sizeof again.setting) == 0, "%s", json);
    record_free(&again);
    free(json);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct record record;
    struct tool_error err = {0};
    char *text = fuzz_copy(data, size);
    if (record_parse(text, "fuzz.exr", &record, &err)) {
        check_options(&record);
        check_round_trip(&record);
        record_free(&record);
    } else {
        fuzz_check_refusal(&err, FUZZ_CODE(EXIT_INPUT) | FUZZ_CODE(EXIT_MEMORY));
        FUZZ_CHECK(!record.view && !record.depth, "a refusal left strings behind");
    }
    free(text);
    return 0;
}
