/* SPDX-License-Identifier: MIT
 *
 * A camera file of any bytes, and every way in which a camera of it makes a projection. */
#include "camera.h"
#include "fuzz.h"
#include "fuzz_view.h"
#include "gbuffer_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 6, HEIGHT = 4 };

static const struct exr_box display = {-3, 2, 12, 9}, data = {-1, 3, WIDTH - 2, HEIGHT + 2};

static void check_read(const struct camera *camera)
{
    FUZZ_CHECK(camera->type != CAMERA_UNKNOWN, "a camera without projection was accepted");
    FUZZ_CHECK(isfinite(camera->half_width) && camera->half_width > 0, "half width %g",
               camera->half_width);
    FUZZ_CHECK(fabs(camera->shift_x) < 10 && fabs(camera->shift_y) < 10, "shift %g, %g",
               camera->shift_x, camera->shift_y);
    FUZZ_CHECK(camera->near_plane >= 0 && camera->far_plane >= 0, "planes %g, %g",
               camera->near_plane, camera->far_plane);
    for (int i = 0; camera->has_rotation && i < 9; i++)
        FUZZ_CHECK(fabs(camera->world_to_view[i]) < 1 + 1e-6, "rotation %g",
                   camera->world_to_view[i]);
}

/* Depth of all kinds, with a bit of everything in it, as gbuffer_load prepares it. */
static void check_depth_types(const struct camera *camera, float scale)
{
    static const float values[WIDTH] = {1.0f, 0.0f, 2.5f, -1.0f, 1e30f, 0.75f};
    struct exr_channel channel = {.name = (char[]){"Z"}, .type = EXR_HALF};
    char path[] = "fuzz", name[] = "";
    struct exr_part part = {.name = name, .compression = "none"};
    const struct exr_info info = {.path = path, .parts = &part, .part_count = 1};
    for (int type = DEPTH_PLANAR; type <= DEPTH_NORMALIZED; type++) {
        const struct gbuffer_options options = {
            .depth_type = (enum depth_type)type,
            .depth_range = {.is_given = true, .zero = 3, .one = 1},
        };
        struct report report = {.verbosity = REPORT_QUIET};
        struct tool_error err = {0};
        float depth[WIDTH * HEIGHT];
        struct gbuffer g = {
            .camera = *camera,
            .width = WIDTH,
            .height = HEIGHT,
            .data_window = data,
            .display_window = display,
            .pixel_aspect = 1.0f,
            .depth = depth,
            .depth_type = (enum depth_type)type,
            .view = ao_view_default(),
        };
        g.roles.kind[ROLE_DEPTH].channels[0] = &channel;
        for (int i = 0; i < WIDTH * HEIGHT; i++)
            depth[i] = values[i % WIDTH] * scale * (1.0f + (float)i / 16.0f);
        if (!gbuffer_prepare_depth(&g, &info, &options, &report, &err)) {
            fuzz_check_refusal(&err, FUZZ_CODE(EXIT_CHANNELS));
            continue;
        }
        fuzz_check_gbuffer(&g);
        fuzz_check_job(&(struct fuzz_job){.width = WIDTH, .height = HEIGHT, .view = &g.view});
    }
}

static void check_rays(const struct camera *camera)
{
    double x, y;
    camera_ray(camera, &display, &data, 0, 0, &x, &y);
    FUZZ_CHECK(!isnan(x) && !isnan(y), "ray %g, %g", x, y);
    const double fov = camera_fov_x_deg(camera);
    FUZZ_CHECK(fov > 0 && fov <= 180, "field of view %g", fov);
    float matrix[9];
    camera_normal_to_view(camera, matrix);
    for (int i = 0; i < 9; i++)
        FUZZ_CHECK(isfinite(matrix[i]), "normal_to_view %g", (double)matrix[i]);
}

static void check_camera(const struct camera *file, float scale)
{
    static const struct camera_flags flags[] = {
        {0},
        {.fov_deg = 60, .fov_is_vertical = true},
        {.ortho_width = 4, .near_plane = 0.5, .far_plane = INFINITY},
        {.near_plane = INFINITY, .far_plane = 0.25},
    };
    struct exr_part part = {.data_window = data, .display_window = display, .pixel_aspect = 0.5f};
    const struct exr_info info = {.parts = &part, .part_count = 1};
    check_read(file);
    for (size_t i = 0; i < sizeof flags / sizeof *flags; i++) {
        struct camera camera = {0};
        camera_resolve(&flags[i], file, &info, 0, &camera);
        FUZZ_CHECK(camera.half_width >= 0 && camera.half_height >= 0, "half sizes %g, %g",
                   camera.half_width, camera.half_height);
        check_rays(&camera);
        check_depth_types(&camera, scale);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    struct camera_set set;
    struct tool_error err = {0};
    char *text = fuzz_copy(bytes, size);
    if (camera_set_parse(text, "fuzz.json", &set, &err)) {
        FUZZ_CHECK(set.count > 0, "a set of no cameras");
        (void)camera_set_find(&set, "no view of that name");
        for (size_t i = 0; i < set.count; i++) {
            const struct camera *camera = camera_set_find(&set, set.views[i].name);
            /* Of two cameras of one view the first is meant. */
            FUZZ_CHECK(camera && camera <= &set.views[i].camera, "view %zu is not found", i);
            if (i < 4)
                check_camera(&set.views[i].camera, size % 2 ? 1.0f : 1e-30f);
        }
        camera_set_free(&set);
    } else {
        fuzz_check_refusal(&err, FUZZ_CODE(EXIT_INPUT) | FUZZ_CODE(EXIT_MEMORY));
        FUZZ_CHECK(!set.views && !set.count, "a refusal left cameras behind");
    }
    free(text);
    return 0;
}
