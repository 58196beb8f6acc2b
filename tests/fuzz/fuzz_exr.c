/* SPDX-License-Identifier: MIT
 *
 * An EXR of any bytes: headers, roles, camera, and the pixels of whatever part has few enough of them. */
#include "camera.h"
#include "exr_file.h"
#include "fuzz.h"

#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

static void read_pixels(const struct exr_info *info, size_t part)
{
    const struct exr_part *p = &info->parts[part];
    int64_t width = (int64_t)p->data_window.x_max - p->data_window.x_min + 1;
    int64_t height = (int64_t)p->data_window.y_max - p->data_window.y_min + 1;
    if (!p->channel_count || width <= 0 || height <= 0 || width * height > 1 << 20)
        return;
    float *values = calloc((size_t)(width * height), sizeof *values);
    struct tool_error err = {0};
    const struct exr_read read = {p->channels[0].name, values, 1};
    if (values)
        (void)exr_read_channels(info, part, &read, 1, &err);
    free(values);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char path[64];
    struct exr_info info;
    struct tool_error err = {0};
    int fd = memfd_create("fuzz.exr", 0);
    if (fd < 0 || write(fd, data, size) != (ssize_t)size)
        abort(); /* not a finding about the input: the harness itself is broken */
    snprintf(path, sizeof path, "/proc/self/fd/%d", fd);
    if (exr_info_read(path, &info, &err)) {
        for (size_t i = 0; i < info.part_count; ++i) {
            struct camera camera = {0};
            camera_from_header(&info.parts[i], &camera);
            read_pixels(&info, i);
        }
        exr_info_free(&info);
    } else if (err.code == EXIT_OK || !err.message[0]) {
        abort(); /* a refusal must say why */
    }
    close(fd);
    return 0;
}
