/* SPDX-License-Identifier: MIT
 *
 * Cameras from files, headers and flags, and the projection that comes of them. */
#include "camera.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const double degree = 3.14159265358979323846 / 180.0;

static void assert_close(double a, double b, double tolerance)
{
    if (!(fabs(a - b) <= tolerance))
        fail_msg("%.9g is not %.9g", a, b);
}

static struct camera_set parse(const char *json)
{
    struct camera_set set;
    struct tool_error err = {0};
    if (!camera_set_parse(json, "c.json", &set, &err))
        fail_msg("%s", err.message);
    return set;
}

static void refuse(const char *json, const char *words)
{
    struct camera_set set;
    struct tool_error err = {0};
    assert_false(camera_set_parse(json, "c.json", &set, &err));
    assert_int_equal(err.code, EXIT_INPUT);
    if (!strstr(err.message, words))
        fail_msg("'%s' does not say '%s'", err.message, words);
    assert_null(set.views);
}

/* A header of w x h pixels with given attributes. */
struct header {
    struct exr_info info;
    struct exr_part part;
    struct exr_attribute attributes[8];
    double numbers[8][16];
    char names[8][64];
};

static struct header *new_header(int width, int height)
{
    struct header *h = calloc(1, sizeof *h);
    assert_non_null(h);
    h->info.parts = &h->part;
    h->info.part_count = 1;
    h->part.attributes = h->attributes;
    h->part.pixel_aspect = 1.0f;
    h->part.display_window = h->part.data_window = (struct exr_box){0, 0, width - 1, height - 1};
    return h;
}

static struct exr_attribute *add_attribute(struct header *h, const char *name)
{
    size_t i = h->part.attribute_count++;
    snprintf(h->names[i], sizeof h->names[i], "%s", name);
    h->attributes[i] = (struct exr_attribute){.name = h->names[i]};
    return &h->attributes[i];
}

static void add_numbers(struct header *h, const char *name, const double *numbers, size_t count)
{
    size_t i = h->part.attribute_count;
    struct exr_attribute *a = add_attribute(h, name);
    memcpy(h->numbers[i], numbers, count * sizeof *numbers);
    a->numbers = h->numbers[i];
    a->number_count = count;
}

static struct camera resolve(const struct header *h, const struct camera_flags *flags,
                             const struct camera *file)
{
    struct camera camera;
    camera_resolve(flags, file, &h->info, 0, &camera);
    return camera;
}

/* Row vectors, as OpenEXR stores them: world to camera is a turn by angle round y, then a
 * translation; the camera looks along +z. NDC in [0,1] with y down, horizontal field of view 60
 * degrees, aspect 2, principal point off centre. */
struct matrices {
    double to_camera[16], to_ndc[16];
};

static void multiply(const double *a, const double *b, double *out)
{
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++) {
            out[i * 4 + j] = 0;
            for (int k = 0; k < 4; k++)
                out[i * 4 + j] += a[i * 4 + k] * b[k * 4 + j];
        }
}

static void transpose(double *m)
{
    for (int i = 0; i < 4; i++)
        for (int j = i + 1; j < 4; j++) {
            double x = m[i * 4 + j];
            m[i * 4 + j] = m[j * 4 + i];
            m[j * 4 + i] = x;
        }
}

static struct matrices make_matrices(bool zero_to_one, double shift, const double translation[3])
{
    struct matrices m;
    double c = cos(0.5), s = sin(0.5), fx = 1.0 / tan(30 * degree), fy = 2.0 * fx;
    const double view[16] = {
        c, 0, s, 0, 0, 1, 0, 0, -s, 0, c, 0, translation[0], translation[1], translation[2], 1};
    /* y up in [-1,1], y down in [0,1]; the axis lies at -2 * shift and +shift */
    const double signed_ndc[16] = {fx,         0,     0,    0, 0, fy, 0,    0,
                                   -2 * shift, shift, 1.01, 1, 0, 0,  -0.1, 0};
    const double unit_ndc[16] = {fx / 2,          0,    0, 0, 0, -fy / 2, 0, 0, 0.5 - shift,
                                 0.5 - shift / 2, 1.01, 1, 0, 0, -0.1,    0};
    memcpy(m.to_camera, view, sizeof view);
    multiply(view, zero_to_one ? unit_ndc : signed_ndc, m.to_ndc);
    return m;
}

static void check_header(bool zero_to_one, bool columns, double shift, const double translation[3])
{
    struct header *h = new_header(200, 100);
    struct matrices m = make_matrices(zero_to_one, shift, translation);
    if (columns) {
        transpose(m.to_camera);
        transpose(m.to_ndc);
    }
    add_numbers(h, "worldToCamera", m.to_camera, 16);
    add_numbers(h, "worldToNDC", m.to_ndc, 16);
    const struct camera camera = resolve(h, &(struct camera_flags){0}, NULL);
    assert_int_equal(camera.type, CAMERA_PERSPECTIVE);
    assert_close(camera.half_width, tan(30 * degree), 1e-6);
    assert_close(camera.half_height, tan(30 * degree) / 2, 1e-6);
    assert_close(camera.shift_x, shift, 1e-6);
    assert_close(camera.shift_y, -shift / 2, 1e-6);
    assert_true(camera.has_rotation && camera.axis_certain);
    /* x = c X - s Z, z = -(s X + c Z): +z forward became -z forward */
    const double rotation[9] = {cos(0.5), 0, -sin(0.5), 0, 1, 0, -sin(0.5), 0, -cos(0.5)};
    for (int i = 0; i < 9; i++)
        assert_close(camera.world_to_view[i], rotation[i], 1e-9);
    assert_string_equal(camera.source, "worldToNDC");
    free(h);
}

static void header_matrices_of_row_and_column_vectors_agree(void **state)
{
    static const double somewhere[3] = {1, -2, 5};
    (void)state;
    check_header(true, false, 0, somewhere);
    check_header(true, true, 0, somewhere);
    check_header(false, false, 0, somewhere);
    check_header(false, true, 0, somewhere);
}

static void header_matrices_of_a_camera_at_the_origin_are_read(void **state)
{
    static const double origin[3] = {0, 0, 0};
    (void)state;
    check_header(true, false, 0, origin);
    check_header(true, true, 0, origin);
}

static void header_matrices_keep_the_lens_shift(void **state)
{
    static const double somewhere[3] = {1, -2, 5};
    (void)state;
    check_header(true, false, 0.1, somewhere);
    check_header(false, true, 0.1, somewhere);
}

static void renderer_attributes_give_the_field_of_view(void **state)
{
    static const double fov = 91.33, focal = 50, aperture = 36, inches = 1.41732283;
    static const double sensor[2] = {36, 24};
    static char text[] = "61.5", other[] = "1.5,nonsense";
    struct header *h = new_header(200, 100);
    const struct camera_flags none = {0};
    (void)state;
    add_numbers(h, "cameraFov", &fov, 1);
    assert_close(
        camera_fov_x_deg(&(struct camera){.half_width = resolve(h, &none, NULL).half_width}), fov,
        1e-9);
    h->part.attribute_count = 0;
    add_attribute(h, "unreal/camera/FinalImage/fov")->text = text;
    assert_close(resolve(h, &none, NULL).half_width, tan(61.5 / 2 * degree), 1e-9);
    h->part.attribute_count = 0;
    add_attribute(h, "rs/camera/fov")->text = other;
    assert_close(resolve(h, &none, NULL).half_width, tan(0.75 * degree), 1e-9);
    h->part.attribute_count = 0;
    add_numbers(h, "CameraFocalLength", &focal, 1);
    add_numbers(h, "CameraFilmApertureHorizontal", &inches, 1);
    assert_close(resolve(h, &none, NULL).half_width, 0.36, 1e-6);
    h->part.attribute_count = 0;
    add_numbers(h, "pinholeFocalLength", &focal, 1);
    add_numbers(h, "sensorOverallDimensions", sensor, 2);
    assert_close(resolve(h, &none, NULL).half_width, 0.36, 1e-9);
    h->part.attribute_count = 0;
    add_numbers(h, "cameraFocalLength", &focal, 1);
    add_numbers(h, "cameraAperture", &aperture, 1);
    assert_close(resolve(h, &none, NULL).half_width, 0.36, 1e-9);
    free(h);
}

/* Karma's files have worldToCamera under both names. */
static void a_placement_is_no_projection(void **state)
{
    static const double somewhere[3] = {1, -2, 5};
    struct header *h = new_header(200, 100);
    struct matrices m = make_matrices(true, 0, somewhere);
    (void)state;
    add_numbers(h, "worldToCamera", m.to_camera, 16);
    add_numbers(h, "worldToNDC", m.to_camera, 16);
    struct camera camera = resolve(h, &(struct camera_flags){0}, NULL);
    assert_string_equal(camera.source, "");
    assert_non_null(strstr(camera.remark, "worldToNDC is no projection"));
    assert_true(camera.has_rotation && !camera.axis_certain);
    add_numbers(h, "worldToScreen", m.to_ndc, 16);
    camera = resolve(h, &(struct camera_flags){0}, NULL);
    assert_string_equal(camera.source, "worldToScreen");
    assert_close(camera.half_width, tan(30 * degree), 1e-6);
    free(h);
}

static void an_affine_matrix_of_another_size_is_orthographic(void **state)
{
    static const double view[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 3, 4, 5, 1};
    const double ortho[16] = {0.25, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.01, 0, 0, 0, 0, 1};
    double to_ndc[16];
    struct header *h = new_header(200, 100);
    (void)state;
    multiply(view, ortho, to_ndc);
    add_numbers(h, "worldToCamera", view, 16);
    add_numbers(h, "worldToNDC", to_ndc, 16);
    const struct camera camera = resolve(h, &(struct camera_flags){0}, NULL);
    assert_int_equal(camera.type, CAMERA_ORTHOGRAPHIC);
    assert_close(camera.half_width, 4, 1e-9);
    assert_string_equal(camera.remark, "");
    free(h);
}

static void the_width_counts_of_a_matrix_of_another_aspect(void **state)
{
    static const double somewhere[3] = {1, -2, 5};
    struct header *h = new_header(200, 150);
    struct matrices m = make_matrices(true, 0, somewhere);
    (void)state;
    add_numbers(h, "worldToCamera", m.to_camera, 16);
    add_numbers(h, "worldToNDC", m.to_ndc, 16);
    const struct camera camera = resolve(h, &(struct camera_flags){0}, NULL);
    assert_close(camera.half_width, tan(30 * degree), 1e-6);
    assert_close(camera.half_height, tan(30 * degree) * 0.75, 1e-6);
    assert_non_null(strstr(camera.remark, "aspect ratio of 2, the image 1.333"));
    free(h);
}

static void arnold_has_one_unit_for_film_and_lens(void **state)
{
    static const double fov = 50, film = 1.0, focal = 1.0722534656524658, wide = 2.0;
    struct header *h = new_header(200, 100);
    (void)state;
    add_numbers(h, "CameraFilmApertureHorizontal", &film, 1);
    add_numbers(h, "CameraFocalLength", &focal, 1);
    struct camera camera = resolve(h, &(struct camera_flags){0}, NULL);
    assert_close(camera_fov_x_deg(&camera), fov, 1e-3);
    assert_string_equal(camera.source, "CameraFocalLength");
    add_numbers(h, "CameraFov", &fov, 1);
    camera = resolve(h, &(struct camera_flags){0}, NULL);
    assert_string_equal(camera.source, "CameraFov");
    assert_string_equal(camera.remark, "");
    memcpy(h->numbers[0], &wide, sizeof wide);
    camera = resolve(h, &(struct camera_flags){0}, NULL);
    assert_close(camera_fov_x_deg(&camera), fov, 1e-9);
    assert_non_null(strstr(camera.remark, "CameraFocalLength says 86.0"));
    free(h);
}

static void a_field_of_view_comes_before_a_matrix_that_contradicts_it(void **state)
{
    static const double somewhere[3] = {1, -2, 5};
    double fov = 60.2;
    struct header *h = new_header(200, 100);
    struct matrices m = make_matrices(false, 0.1, somewhere);
    (void)state;
    add_numbers(h, "worldToCamera", m.to_camera, 16);
    add_numbers(h, "worldToScreen", m.to_ndc, 16);
    add_numbers(h, "CameraFov", &fov, 1);
    struct camera camera = resolve(h, &(struct camera_flags){0}, NULL);
    assert_string_equal(camera.source, "worldToScreen"); /* they agree, and it has the shift */
    assert_close(camera.shift_x, 0.1, 1e-6);
    h->numbers[2][0] = 45;
    camera = resolve(h, &(struct camera_flags){0}, NULL);
    assert_close(camera_fov_x_deg(&camera), 45, 1e-9);
    assert_non_null(
        strstr(camera.remark, "CameraFov says 45 degrees, worldToScreen 60: CameraFov is taken"));
    assert_true(camera.has_rotation);
    camera = resolve(h, &(struct camera_flags){.fov_deg = 30}, NULL);
    assert_string_equal(camera.remark, ""); /* nobody asked the header */
    free(h);
}

static void a_panorama_is_no_camera_unless_options_say_so(void **state)
{
    static const double fov = 360, spherical = 4;
    struct header *h = new_header(200, 100);
    (void)state;
    add_numbers(h, "cameraFov", &fov, 1);
    add_numbers(h, "cameraProjection", &spherical, 1);
    struct camera camera = resolve(h, &(struct camera_flags){0}, NULL);
    assert_string_equal(camera.unsupported, "cameraProjection is 4");
    camera = resolve(h, &(struct camera_flags){.fov_deg = 30}, NULL);
    assert_string_equal(camera.unsupported, "");
    free(h);
}

/* A camera of 30 degrees to the left about +y at (1, 2, 3), by its axes in the world. */
static void renderers_transforms_give_the_rotation(void **state)
{
    const double c = cos(30 * degree), s = sin(30 * degree);
    const double rows[16] = {c, 0, -s, 0, 0, 1, 0, 0, s, 0, c, 0, 1, 2, 3, 1};
    const double want[9] = {c, 0, -s, 0, 1, 0, s, 0, c};
    double columns[16];
    char text[256];
    (void)state;
    memcpy(columns, rows, sizeof rows);
    transpose(columns);
    snprintf(text, sizeof text, "%g, 0, %g, 0, 0, 1, 0, 0, %g, 0, %g, 0, 1, 2, 3, 1", c, -s, s, c);
    for (int i = 0; i < 3; i++) {
        struct header *h = new_header(200, 100);
        if (i == 2)
            add_attribute(h, "rs/camera/transform")->text = text;
        else
            add_numbers(h, "cameraTransform", i ? columns : rows, 16);
        const struct camera camera = resolve(h, &(struct camera_flags){0}, NULL);
        assert_true(camera.has_rotation && !camera.axis_certain);
        for (int k = 0; k < 9; k++)
            assert_close(camera.world_to_view[k], want[k], 1e-5);
        assert_string_equal(camera.rotation_source,
                            i == 2 ? "rs/camera/transform" : "cameraTransform");
        free(h);
    }
}

/* Yaw turns from x (forwards) to y (right); a positive pitch looks up. */
static void unreal_rotations_are_left_handed_with_z_up(void **state)
{
    static char pitch[] = "30.0", yaw[] = "90.0", roll[] = "0.0", roll_right[] = "90.0";
    const double c = cos(30 * degree), s = sin(30 * degree);
    const double want[9] = {-1, 0, 0, 0, -s, c, 0, -c, -s};
    const double rolled[9] = {0, s, -c, -1, 0, 0, 0, -c, -s};
    struct header *h = new_header(200, 100);
    (void)state;
    add_attribute(h, "unreal/camera/curRot/pitch")->text = pitch;
    add_attribute(h, "unreal/camera/curRot/yaw")->text = yaw;
    add_attribute(h, "unreal/camera/curRot/roll")->text = roll;
    struct camera camera = resolve(h, &(struct camera_flags){0}, NULL);
    for (int k = 0; k < 9; k++)
        assert_close(camera.world_to_view[k], want[k], 1e-12);
    assert_true(camera.axis_certain);
    h->attributes[2].text = roll_right;
    camera = resolve(h, &(struct camera_flags){0}, NULL);
    for (int k = 0; k < 9; k++)
        assert_close(camera.world_to_view[k], rolled[k], 1e-12);
    free(h);
}

static void planes_come_from_the_header(void **state)
{
    static const double near_plane = 0.25, far_plane = 80;
    static const char *const names[][2] = {{"clipNear", "clipFar"},
                                           {"cameraNearClip", "cameraFarClip"},
                                           {"arnold/camera/near_clip", "arnold/camera/far_clip"},
                                           {"rs/camera/nearPlane", "rs/camera/farPlane"}};
    (void)state;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        struct header *h = new_header(200, 100);
        add_numbers(h, names[i][0], &near_plane, 1);
        add_numbers(h, names[i][1], &far_plane, 1);
        const struct camera camera = resolve(h, &(struct camera_flags){0}, NULL);
        assert_close(camera.near_plane, near_plane, 0);
        assert_close(camera.far_plane, far_plane, 0);
        free(h);
    }
}

static void absurd_attributes_are_no_camera(void **state)
{
    static const double zero = 0, nan_value = NAN, flat[16] = {0};
    static const char *const names[] = {"cameraFov", "worldToCamera"};
    (void)state;
    for (int i = 0; i < 3; i++) {
        struct header *h = new_header(200, 100);
        if (i == 2) {
            add_numbers(h, names[1], flat, 16);
            add_numbers(h, "worldToNDC", flat, 16);
        } else {
            add_numbers(h, names[0], i ? &nan_value : &zero, 1);
        }
        const struct camera camera = resolve(h, &(struct camera_flags){0}, NULL);
        assert_string_equal(camera.source, "");
        assert_close(camera_fov_x_deg(&camera), 40.0, 1e-9);
        assert_false(camera.has_rotation);
        free(h);
    }
}

static void flags_come_before_file_and_file_before_header(void **state)
{
    static const double fov = 91.33;
    struct header *h = new_header(200, 100);
    struct camera_set set = parse("{\"fov_x_deg\":50,\"near\":0.25,\"shift_x\":0.1,"
                                  "\"world_to_view\":[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}");
    (void)state;
    add_numbers(h, "cameraFov", &fov, 1);
    struct camera camera = resolve(h, &(struct camera_flags){0}, &set.views[0].camera);
    assert_close(camera_fov_x_deg(&camera), 50, 1e-9);
    assert_string_equal(camera.source, "camera file");
    camera =
        resolve(h, &(struct camera_flags){.fov_deg = 30, .near_plane = 0.5}, &set.views[0].camera);
    assert_close(camera_fov_x_deg(&camera), 30, 1e-9);
    assert_close(camera.near_plane, 0.5, 0);
    assert_close(camera.shift_x, 0.1, 1e-12);
    assert_true(camera.has_rotation);
    camera = resolve(h, &(struct camera_flags){.ortho_width = 6}, NULL);
    assert_int_equal(camera.type, CAMERA_ORTHOGRAPHIC);
    assert_close(camera.half_width, 3, 0);
    camera_set_free(&set);
    free(h);
}

static void vertical_fov_and_pixel_aspect_fix_the_other_side(void **state)
{
    struct header *h = new_header(200, 100);
    (void)state;
    struct camera camera =
        resolve(h, &(struct camera_flags){.fov_deg = 40, .fov_is_vertical = true}, NULL);
    assert_close(camera.half_height, tan(20 * degree), 1e-12);
    assert_close(camera.half_width, 2 * tan(20 * degree), 1e-12);
    h->part.pixel_aspect = 1.5f;
    camera = resolve(h, &(struct camera_flags){.fov_deg = 40}, NULL);
    assert_close(camera.half_width, tan(20 * degree), 1e-12);
    assert_close(camera.half_height, tan(20 * degree) / 3, 1e-12);
    free(h);
}

static void json_cameras_of_stereo_are_found_by_view(void **state)
{
    struct camera_set set =
        parse("{\"views\":{\"left\":{\"type\":\"perspective\",\"fov_x_deg\":60},"
              "\"right\":{\"type\":\"orthographic\",\"ortho_width\":4}}}");
    (void)state;
    assert_int_equal(set.count, 2);
    assert_close(camera_fov_x_deg(camera_set_find(&set, "left")), 60, 1e-9);
    assert_int_equal(camera_set_find(&set, "right")->type, CAMERA_ORTHOGRAPHIC);
    assert_null(camera_set_find(&set, "middle"));
    assert_null(camera_set_find(&set, ""));
    camera_set_free(&set);
    set = parse("{\"type\":\"perspective\",\"fov_x_deg\":60}");
    assert_non_null(camera_set_find(&set, "left"));
    camera_set_free(&set);
}

static void json_mistakes_are_named(void **state)
{
    (void)state;
    refuse("{\"fov_x_deg\":60", "not JSON (line 1)");
    refuse("{\n\n\"fov_x_deg\":}", "not JSON (line 3)");
    refuse("[]", "must be an object");
    refuse("{}", "'fov_x_deg' must be given");
    refuse("{\"type\":\"fisheye\"}", "'type' must be");
    refuse("{\"type\":\"orthographic\"}", "'ortho_width' must be given");
    refuse("{\"type\":\"orthographic\",\"ortho_width\":5,\"fov_x_deg\":60}",
           "'fov_x_deg' must be left out of an orthographic camera");
    refuse("{\"fov_x_deg\":60,\"ortho_width\":5}",
           "'ortho_width' must be left out of a perspective camera");
    refuse("{\"fov_x_deg\":60,\"left_handed\":1}", "'left_handed' must be true or false");
    refuse("{\"fov_x_deg\":180}", "'fov_x_deg' must be a number between 0 and 180");
    refuse("{\"fov_x_deg\":\"60\"}", "'fov_x_deg' must be");
    refuse("{\"fov_x_deg\":60,\"near\":-1}", "'near' must be a number > 0");
    refuse("{\"fov_x_deg\":60,\"world_to_view\":[[1,0,0],[0,1,0],[0,0,1]]}", "4 rows of 4");
    refuse("{\"fov_x_deg\":60,\"world_to_view\":[[1,0,0,0],[0,1,0,0],[0,0,1,0],[1,2,3,1]]}",
           "column vectors");
    refuse("{\"fov_x_deg\":60,\"world_to_view\":[[0,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}",
           "a rotation");
    refuse("{\"fov_x_deg\":60,\"world_to_view\":[[1,0,0,0],[1,1,0,0],[0,0,1,0],[0,0,0,1]]}",
           "shear");
    refuse("{\"fov_x_deg\":60,\"shiftx\":1}", "unknown key 'shiftx'");
    refuse("{\"views\":{\"left\":{\"fov_x_deg\":60}},\"near\":1}", "unknown key 'near'");
    refuse("{\"fov_x_deg\":60,\"world_to_view\":[[1,0,0,0],[0,1,0,0],[0,0,-1,0],[0,0,0,1]]}",
           "a mirror image");
    refuse("{\"fov_x_deg\":60,\"left_handed\":true,"
           "\"world_to_view\":[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}",
           "a mirror image if");
    refuse("{\"views\":{}}", "'views'");
    refuse("{\"views\":{\"left\":{}}}", "left: 'fov_x_deg'");
}

static void json_takes_comments_and_left_handed_worlds(void **state)
{
    struct camera_set set = parse("{\"_source\":\"a test\",\"fov_x_deg\":60,\"left_handed\":true,"
                                  "\"world_to_view\":[[1,0,0,0],[0,1,0,0],[0,0,-1,0],[0,0,0,1]]}");
    (void)state;
    assert_true(camera_is_mirrored(&set.views[0].camera));
    camera_set_free(&set);
}

/* Clip coordinates of a view-space point, to texels of the data window. */
static void project(const struct ao_view *view, double x, double y, double z, double *column,
                    double *row, double *depth)
{
    double p[4] = {x, y, z, 1}, clip[4];
    for (int r = 0; r < 4; r++) {
        clip[r] = 0;
        for (int c = 0; c < 4; c++)
            clip[r] += (double)view->projection[c * 4 + r] * p[c];
    }
    *column =
        (clip[0] / clip[3] + 1) / 2 * view->viewport.extent.width + view->viewport.offset.x - 0.5;
    *row =
        (clip[1] / clip[3] + 1) / 2 * view->viewport.extent.height + view->viewport.offset.y - 0.5;
    *depth = clip[2] / clip[3];
}

static void check_round_trip(const struct camera *camera)
{
    const struct exr_box display = {0, 0, 199, 99}, data = {30, -10, 149, 79};
    const double z = 7;
    struct ao_view view = ao_view_default();
    bool ortho = camera->type == CAMERA_ORTHOGRAPHIC;
    camera_project(camera, &(struct camera_planes){0.5, ortho ? 100 : INFINITY}, &display, &data,
                   &view);
    for (int i = 0; i < 5; i++) {
        double x, y, column, row, depth;
        camera_ray(camera, &display, &data, 12 + 20 * i, 3 + 11 * i, &x, &y);
        project(&view, ortho ? x : x * z, ortho ? y : y * z, -z, &column, &row, &depth);
        assert_close(column, 12 + 20 * i, 1e-4);
        assert_close(row, 3 + 11 * i, 1e-4);
        assert_true(depth > 0 && depth < 1);
    }
}

static void projection_undoes_the_ray_of_every_texel(void **state)
{
    (void)state;
    check_round_trip(&(struct camera){.type = CAMERA_PERSPECTIVE,
                                      .half_width = 0.6,
                                      .half_height = 0.3,
                                      .shift_x = 0.1,
                                      .shift_y = -0.2});
    check_round_trip(&(struct camera){.type = CAMERA_ORTHOGRAPHIC,
                                      .half_width = 6,
                                      .half_height = 3,
                                      .shift_x = 0.1,
                                      .shift_y = -0.2});
}

static void top_left_of_the_display_looks_up_and_left(void **state)
{
    const struct exr_box box = {0, 0, 199, 99};
    const struct camera camera = {
        .type = CAMERA_PERSPECTIVE, .half_width = 0.6, .half_height = 0.3};
    double x, y;
    (void)state;
    camera_ray(&camera, &box, &box, -0.5, -0.5, &x, &y);
    assert_close(x, -0.6, 1e-12);
    assert_close(y, 0.3, 1e-12);
}

/* x_ndc = (i + 0.5) / w * 2 - 1 + 2 * shift_x, as the G-buffers' README has it. */
static void shift_moves_the_view_to_the_right_and_up(void **state)
{
    const struct exr_box box = {0, 0, 199, 99};
    const struct camera camera = {.type = CAMERA_PERSPECTIVE,
                                  .half_width = 0.6,
                                  .half_height = 0.3,
                                  .shift_x = 0.25,
                                  .shift_y = 0.25};
    double x, y;
    (void)state;
    camera_ray(&camera, &box, &box, 99.5, 49.5, &x, &y);
    assert_close(x, 0.3, 1e-12);
    assert_close(y, 0.15, 1e-12);
}

static void viewport_is_the_display_seen_from_the_data_window(void **state)
{
    const struct exr_box display = {-5, 10, 194, 109}, data = {30, 20, 149, 79};
    const struct camera camera = {
        .type = CAMERA_PERSPECTIVE, .half_width = 0.6, .half_height = 0.3};
    struct ao_view view = ao_view_default();
    (void)state;
    camera_project(&camera, &(struct camera_planes){0.5, INFINITY}, &display, &data, &view);
    assert_int_equal(view.viewport.offset.x, -35);
    assert_int_equal(view.viewport.offset.y, -10);
    assert_int_equal(view.viewport.extent.width, 200);
    assert_int_equal(view.viewport.extent.height, 100);
}

static void planes_map_to_zero_and_one_or_reversed(void **state)
{
    static const struct camera_planes planes[] = {
        {0.5, 100}, {100, 0.5}, {0.5, INFINITY}, {INFINITY, 0.5}};
    const struct exr_box box = {0, 0, 199, 99};
    const struct camera camera = {
        .type = CAMERA_PERSPECTIVE, .half_width = 0.6, .half_height = 0.3};
    (void)state;
    for (size_t i = 0; i < 4; i++) {
        struct ao_view view = ao_view_default();
        double column, row, depth;
        camera_project(&camera, &planes[i], &box, &box, &view);
        project(&view, 0, 0, isinf(planes[i].near_plane) ? -1e9 : -planes[i].near_plane, &column,
                &row, &depth);
        assert_close(depth, 0, 1e-6);
        project(&view, 0, 0, isinf(planes[i].far_plane) ? -1e9 : -planes[i].far_plane, &column,
                &row, &depth);
        assert_close(depth, 1, 1e-6);
    }
}

static void rotation_is_handed_over_by_columns(void **state)
{
    struct camera_set set =
        parse("{\"fov_x_deg\":50,\"world_to_view\":[[0,1,0,3],[0,0,2,4],[1,0,0,5],[0,0,0,1]]}");
    float m[9];
    (void)state;
    camera_normal_to_view(&set.views[0].camera, m);
    /* world x becomes view z; rows are normalised */
    assert_close((double)m[0 * 3 + 2], 1, 1e-6);
    assert_close((double)m[1 * 3 + 0], 1, 1e-6);
    assert_close((double)m[2 * 3 + 1], 1, 1e-6);
    camera_set_free(&set);
}

static void only_files_place_the_camera(void **state)
{
    struct header *h = new_header(200, 100);
    struct camera_set set =
        parse("{\"fov_x_deg\":50,\"world_to_view\":[[0,1,0,3],[0,0,2,4],[1,0,0,5],[0,0,0,1]]}");
    (void)state;
    struct camera camera = resolve(h, &(struct camera_flags){0}, &set.views[0].camera);
    assert_true(camera.has_translation);
    for (int i = 0; i < 3; i++)
        assert_close(camera.translation[i], i + 3, 0);
    camera = resolve(h, &(struct camera_flags){0}, NULL);
    assert_false(camera.has_translation);
    camera_set_free(&set);
    free(h);
}

#define TEST(name) cmocka_unit_test(name)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(header_matrices_of_row_and_column_vectors_agree),
        TEST(header_matrices_of_a_camera_at_the_origin_are_read),
        TEST(header_matrices_keep_the_lens_shift),
        TEST(renderer_attributes_give_the_field_of_view),
        TEST(a_placement_is_no_projection),
        TEST(an_affine_matrix_of_another_size_is_orthographic),
        TEST(the_width_counts_of_a_matrix_of_another_aspect),
        TEST(arnold_has_one_unit_for_film_and_lens),
        TEST(a_field_of_view_comes_before_a_matrix_that_contradicts_it),
        TEST(a_panorama_is_no_camera_unless_options_say_so),
        TEST(renderers_transforms_give_the_rotation),
        TEST(unreal_rotations_are_left_handed_with_z_up),
        TEST(planes_come_from_the_header),
        TEST(absurd_attributes_are_no_camera),
        TEST(flags_come_before_file_and_file_before_header),
        TEST(vertical_fov_and_pixel_aspect_fix_the_other_side),
        TEST(json_cameras_of_stereo_are_found_by_view),
        TEST(json_mistakes_are_named),
        TEST(json_takes_comments_and_left_handed_worlds),
        TEST(projection_undoes_the_ray_of_every_texel),
        TEST(top_left_of_the_display_looks_up_and_left),
        TEST(shift_moves_the_view_to_the_right_and_up),
        TEST(viewport_is_the_display_seen_from_the_data_window),
        TEST(planes_map_to_zero_and_one_or_reversed),
        TEST(rotation_is_handed_over_by_columns),
        TEST(only_files_place_the_camera),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
