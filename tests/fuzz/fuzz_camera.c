/* SPDX-License-Identifier: MIT
 *
 * A camera file of any bytes. */
#include "camera.h"
#include "fuzz.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void check(const struct camera *camera)
{
    const struct exr_box box = {0, 0, 63, 31};
    vkao_view view = vkao_view_default();
    struct camera resolved = {0};
    const struct camera_flags flags = {0};
    struct exr_part part = {.data_window = box, .display_window = box, .pixel_aspect = 1.0f};
    const struct exr_info info = {.parts = &part, .part_count = 1};
    camera_resolve(&flags, camera, &info, 0, &resolved);
    camera_project(&resolved, &(struct camera_planes){0.1, INFINITY}, &box, &box, &view);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char *text = malloc(size + 1);
    struct camera_set set;
    struct tool_error err = {0};
    if (!text)
        return 0;
    memcpy(text, data, size);
    text[size] = '\0';
    if (camera_set_parse(text, "fuzz.json", &set, &err)) {
        for (size_t i = 0; i < set.count; ++i)
            check(&set.views[i].camera);
        camera_set_free(&set);
    } else if (err.code == EXIT_OK || !err.message[0]) {
        abort(); /* a refusal must say why */
    }
    free(text);
    return 0;
}
