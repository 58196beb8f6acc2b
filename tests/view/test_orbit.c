/* SPDX-License-Identifier: MIT
 *
 * The camera of the live scenes: what its matrices promise and where dragging leads. */
#include "orbit.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

static const double pi = 3.14159265358979323846;
static const double aspect = 1.6;
/* Matrices are floats. */
static const double tolerance = 2e-6;

/* A few ways to look; every test goes through all, in both projections. */
static const struct orbit cameras[] = {
    {{0, 0, 0}, 0, 0, 5, 1, 50, 0.8, 0.1, 10, false},
    {{1, 2, -3}, 0.7, 0.4, 3, 1, 50, 1.2, 0.05, 20, false},
    {{-4, 0.5, 2}, -2.5, -0.9, 12, 1, 50, 0.5, 0.2, 15, false},
    {{0, 1, 0}, 3.1, 1.5, 2, 1, 50, 1.0, 0.1, 8, false},
};
enum { CAMERAS = 2 * sizeof cameras / sizeof cameras[0] };

static struct orbit camera_at(int i)
{
    struct orbit orbit = cameras[i / 2];
    orbit.orthographic = i % 2;
    return orbit;
}

static void assert_near(double value, double expected, double allowed, const char *what)
{
    if (!(fabs(value - expected) <= allowed))
        fail_msg("%s is %.9g, want %.9g within %g", what, value, expected, allowed);
}

static void transform(const float m[16], const double p[4], double out[4])
{
    for (int row = 0; row < 4; ++row) {
        out[row] = 0;
        for (int k = 0; k < 4; ++k)
            out[row] += (double)m[4 * k + row] * p[k];
    }
}

static void to_view(const struct orbit *orbit, const double world[3], double out[4])
{
    float view[16];
    orbit_view_matrix(orbit, view);
    transform(view, (const double[4]){world[0], world[1], world[2], 1}, out);
}

/* x, y and depth. */
static void to_ndc(const struct orbit *orbit, const double world[3], double out[3])
{
    float projection[16];
    double v[4], clip[4];
    orbit_projection(orbit, aspect, projection);
    to_view(orbit, world, v);
    transform(projection, v, clip);
    for (int i = 0; i < 3; ++i)
        out[i] = clip[i] / clip[3];
}

/* World direction of a view axis: row `axis` of the rotation. */
static void axis_of(const struct orbit *orbit, int axis, double out[3])
{
    float rotation[9];
    orbit_rotation(orbit, rotation);
    for (int i = 0; i < 3; ++i)
        out[i] = (double)rotation[3 * i + axis];
}

/* The target, moved by this much along the view's axes. */
static void near_target(const struct orbit *orbit, double right, double up, double back,
                        double out[3])
{
    const double amount[3] = {right, up, back};
    memcpy(out, orbit->target, 3 * sizeof *out);
    for (int a = 0; a < 3; ++a) {
        double axis[3];
        axis_of(orbit, a, axis);
        for (int i = 0; i < 3; ++i)
            out[i] += amount[a] * axis[i];
    }
}

static void rotation_is_a_rotation(void **state)
{
    (void)state;
    for (int i = 0; i < CAMERAS; ++i) {
        struct orbit orbit = camera_at(i);
        double a[3][3];
        for (int k = 0; k < 3; ++k)
            axis_of(&orbit, k, a[k]);
        for (int j = 0; j < 3; ++j) {
            for (int k = 0; k < 3; ++k)
                assert_near(a[j][0] * a[k][0] + a[j][1] * a[k][1] + a[j][2] * a[k][2], j == k,
                            tolerance, "the product of two axes");
        }
        double det = a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) +
                     a[0][1] * (a[1][2] * a[2][0] - a[1][0] * a[2][2]) +
                     a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
        assert_near(det, 1, tolerance, "the determinant");
    }
}

static void world_up_is_up_and_the_horizon_level(void **state)
{
    (void)state;
    for (int i = 0; i < CAMERAS; ++i) {
        struct orbit orbit = camera_at(i);
        double right[3], up[3], above[3], ndc[3];
        axis_of(&orbit, 0, right);
        axis_of(&orbit, 1, up);
        assert_near(right[1], 0, tolerance, "the right axis' rise");
        assert_true(up[1] > 0);
        memcpy(above, orbit.target, sizeof above);
        above[1] += 0.1;
        to_ndc(&orbit, above, ndc);
        assert_near(ndc[0], 0, tolerance, "x of a point above the target");
        assert_true(ndc[1] < 0);
    }
}

static void target_is_in_the_middle_and_at_its_distance(void **state)
{
    (void)state;
    for (int i = 0; i < CAMERAS; ++i) {
        struct orbit orbit = camera_at(i);
        double ndc[3], view[4];
        to_ndc(&orbit, orbit.target, ndc);
        to_view(&orbit, orbit.target, view);
        assert_near(ndc[0], 0, 4 * tolerance, "x of the target");
        assert_near(ndc[1], 0, 4 * tolerance, "y of the target");
        assert_near(-view[2], orbit.orthographic ? orbit.near + orbit.reach : orbit.distance,
                    10 * tolerance, "the distance to the target");
    }
}

static void eye_is_the_view_space_origin(void **state)
{
    (void)state;
    for (int i = 0; i < CAMERAS; ++i) {
        struct orbit orbit = camera_at(i);
        double eye[3], view[4];
        orbit_eye(&orbit, eye);
        to_view(&orbit, eye, view);
        for (int k = 0; k < 3; ++k)
            assert_near(view[k], 0, 10 * tolerance, "the eye");
    }
}

static void depth_is_reversed_from_near_to_far(void **state)
{
    (void)state;
    for (int i = 0; i < CAMERAS; ++i) {
        struct orbit orbit = camera_at(i);
        float projection[16];
        double clip[4], last = 2;
        orbit_projection(&orbit, aspect, projection);
        transform(projection, (const double[4]){0, 0, -orbit.near, 1}, clip);
        assert_near(clip[2] / clip[3], 1, tolerance, "depth at the near plane");
        for (double z = orbit.near; z < 2 * orbit.reach; z *= 1.5) {
            transform(projection, (const double[4]){0, 0, -z, 1}, clip);
            assert_true(clip[2] / clip[3] < last && clip[2] / clip[3] > 0);
            last = clip[2] / clip[3];
        }
        double far = orbit.orthographic ? orbit.near + 2 * orbit.reach : 1e9;
        transform(projection, (const double[4]){0, 0, -far, 1}, clip);
        assert_near(clip[2] / clip[3], 0, tolerance, "depth at the far plane");
    }
}

static void image_spans_the_field_of_view(void **state)
{
    (void)state;
    for (int i = 0; i < CAMERAS; ++i) {
        struct orbit orbit = camera_at(i);
        double half = orbit.distance * tan(0.5 * orbit.fov_y), corner[3], ndc[3];
        near_target(&orbit, half * aspect, half, 0, corner);
        to_ndc(&orbit, corner, ndc);
        assert_near(ndc[0], 1, 10 * tolerance, "x of the upper right corner");
        assert_near(ndc[1], -1, 10 * tolerance, "y of the upper right corner");
    }
}

static void orthographic_view_holds_what_is_within_reach_however_near_the_zoom(void **state)
{
    (void)state;
    for (int i = 1; i < CAMERAS; i += 2) {
        struct orbit orbit = camera_at(i);
        double front[3], behind[3], ndc[3];
        orbit_zoom(&orbit, 1000);
        near_target(&orbit, 0, 0, 0.99 * orbit.reach, front);
        near_target(&orbit, 0, 0, -0.99 * orbit.reach, behind);
        to_ndc(&orbit, front, ndc);
        assert_true(ndc[2] > 0 && ndc[2] < 1);
        to_ndc(&orbit, behind, ndc);
        assert_true(ndc[2] > 0 && ndc[2] < 1);
    }
}

static void drag_takes_the_near_side_along(void **state)
{
    (void)state;
    for (int i = 0; i < CAMERAS; ++i) {
        struct orbit orbit = camera_at(i);
        double grabbed[3], before[3], after[3];
        orbit.pitch *= 0.5; /* away from where pitch ends */
        near_target(&orbit, 0, 0, 0.2 * orbit.distance, grabbed);
        to_ndc(&orbit, grabbed, before);
        struct orbit right = orbit, down = orbit;
        orbit_drag(&right, 0.05, 0);
        to_ndc(&right, grabbed, after);
        assert_true(after[0] > before[0] + 0.001);
        orbit_drag(&down, 0, 0.05);
        to_ndc(&down, grabbed, after);
        assert_true(after[1] > before[1] + 0.001);
    }
}

static void drag_of_two_heights_comes_round_and_pitch_stops_before_the_pole(void **state)
{
    (void)state;
    struct orbit orbit = camera_at(2);
    for (int i = 0; i < 200; ++i)
        orbit_drag(&orbit, 0.01, 0);
    assert_near(orbit.yaw, cameras[1].yaw, 1e-9, "yaw after a whole turn");
    assert_near(orbit.pitch, cameras[1].pitch, 0, "pitch after a level drag");
    orbit_drag(&orbit, 0, 100);
    assert_true(orbit.pitch > 1.5 && orbit.pitch < 0.5 * pi);
    orbit_drag(&orbit, 0, -200);
    assert_true(orbit.pitch < -1.5 && orbit.pitch > -0.5 * pi);
    orbit_drag(&orbit, 12345.6, 0);
    assert_true(fabs(orbit.yaw) <= pi);
}

static void pan_moves_the_target_with_the_pointer(void **state)
{
    (void)state;
    for (int i = 0; i < CAMERAS; ++i) {
        struct orbit orbit = camera_at(i);
        double ndc[3];
        orbit_pan(&orbit, 0.15, -0.1);
        to_ndc(&orbit, cameras[i / 2].target, ndc);
        /* A height is 2 in NDC y, and an aspect less of x. */
        assert_near(ndc[0], 0.15 * 2 / aspect, 10 * tolerance, "x of what was the target");
        assert_near(ndc[1], -0.1 * 2, 10 * tolerance, "y of what was the target");
    }
}

static void zoom_is_undone_by_its_opposite_and_stops_at_its_limits(void **state)
{
    (void)state;
    struct orbit orbit = camera_at(2);
    orbit_zoom(&orbit, 2);
    assert_near(orbit.distance, 3 * 0.81, 1e-12, "distance after two steps");
    orbit_zoom(&orbit, -2);
    assert_near(orbit.distance, 3, 1e-12, "distance back");
    orbit_zoom(&orbit, 1e6);
    assert_near(orbit.distance, orbit.distance_min, 0, "the nearest");
    orbit_zoom(&orbit, -1e6);
    assert_near(orbit.distance, orbit.distance_max, 0, "the furthest");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rotation_is_a_rotation),
        cmocka_unit_test(world_up_is_up_and_the_horizon_level),
        cmocka_unit_test(target_is_in_the_middle_and_at_its_distance),
        cmocka_unit_test(eye_is_the_view_space_origin),
        cmocka_unit_test(depth_is_reversed_from_near_to_far),
        cmocka_unit_test(image_spans_the_field_of_view),
        cmocka_unit_test(orthographic_view_holds_what_is_within_reach_however_near_the_zoom),
        cmocka_unit_test(drag_takes_the_near_side_along),
        cmocka_unit_test(drag_of_two_heights_comes_round_and_pitch_stops_before_the_pole),
        cmocka_unit_test(pan_moves_the_target_with_the_pointer),
        cmocka_unit_test(zoom_is_undone_by_its_opposite_and_stops_at_its_limits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
