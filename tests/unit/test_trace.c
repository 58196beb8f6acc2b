/* SPDX-License-Identifier: MIT
 *
 * The ray tracer that gives other tests their truth, against closed forms of cosine-weighted
 * visibility and against what a hit must satisfy. */
#include "trace.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

enum { RAYS = 4096 };

/* The R2 sequence errs by some 0.5 / RAYS^0.75; over all cases and seeds below the largest error is
 * 0.0021. Random rays would err by 0.0078 (one sigma). */
static const double tolerance = 0.0025;

static uint32_t random_state;

static double random_between(double low, double high)
{
    random_state = trace_hash(random_state + 0x9e3779b9u);
    return low + (high - low) * random_state * 0x1p-32;
}

static struct vec3 random_direction(void)
{
    double y = random_between(-1, 1), phi = random_between(0, 2 * PI), r = sqrt(1 - y * y);
    return vec3(r * cos(phi), y, r * sin(phi));
}

/* Failing by number alone says little: print what was expected. */
static void assert_near(double value, double expected, double allowed, const char *what)
{
    if (!(fabs(value - expected) <= allowed))
        fail_msg("%s is %.9g, want %.9g within %g", what, value, expected, allowed);
}

static struct trace_scene scene_of(const struct trace_primitive *primitives, size_t count)
{
    struct trace_scene scene = {0};
    for (size_t i = 0; i < count; i++)
        trace_add(&scene, primitives[i]);
    assert_true(trace_build(&scene));
    return scene;
}

/* --- ambient visibility of the floor's origin against closed forms --- */

static const struct vec3 up = {0, 1, 0};

static struct trace_primitive floor_plane(void)
{
    return trace_plane(vec3(0, 0, 0), up);
}

/* Beside a floor at the origin, for several seeds. NAN: not known. */
static void assert_visibility(const struct trace_primitive *others, size_t count, double radius,
                              double threshold, double falloff)
{
    struct trace_scene scene = {0};
    trace_add(&scene, floor_plane());
    for (size_t i = 0; i < count; i++)
        trace_add(&scene, others[i]);
    assert_true(trace_build(&scene));
    for (uint32_t seed = 0; seed < 8; seed++) {
        struct trace_ao ao = trace_ao(&scene, vec3(0, 0, 0), up, radius, RAYS, seed);
        if (!isnan(threshold))
            assert_near(ao.threshold, threshold, tolerance, "threshold");
        if (!isnan(falloff))
            assert_near(ao.falloff, falloff, tolerance, "falloff");
    }
    trace_scene_free(&scene);
}

/* Rays by their shadow in the unit disk (Nusselt): those with x > c = distance / radius meet the
 * wall, at t = distance / x. */
static void floor_beside_an_endless_wall(void **state)
{
    (void)state;
    for (double c = 0.05; c < 1.2; c += 0.05) {
        double radius = 2, s = c < 1 ? sqrt(1 - c * c) : 0, angle = c < 1 ? acos(c) : 0;
        double hit = angle - c * s, weighed = hit - 2 * c * s + 2 * c * c * angle;
        struct trace_primitive wall = trace_plane(vec3(c * radius, 0, 0), vec3(-1, 0, 0));
        assert_visibility(&wall, 1, radius, 1 - hit / PI, 1 - weighed / PI);
    }
}

static void open_floor_and_bottom_of_an_edge_and_of_a_corner(void **state)
{
    (void)state;
    const double close = 1e-7;
    struct trace_primitive walls[] = {trace_plane(vec3(close, 0, 0), vec3(-1, 0, 0)),
                                      trace_plane(vec3(0, 0, close), vec3(0, 0, -1))};
    assert_visibility(walls, 0, 1, 1.0, 1.0);
    assert_visibility(walls, 1, 1, 0.5, 0.5);
    assert_visibility(walls, 2, 1, 0.25, 0.25);
}

static void under_a_disk(void **state)
{
    (void)state;
    const double h = 0.7, radius = 1.5;
    for (double r = 0.1; r < 3; r *= 1.5) {
        double reach = sqrt(radius * radius - h * h), seen = r < reach ? r : reach;
        double sin2 = seen * seen / (seen * seen + h * h);
        double weighed = sin2 + h * h / (radius * radius) * log(1 - sin2);
        struct trace_primitive disk = trace_disk(vec3(0, h, 0), vec3(0, -1, 0), r);
        assert_visibility(&disk, 1, radius, 1 - sin2, 1 - weighed);
    }
}

/* A ball that is wholly above the horizon covers sin^2 of its half angle times the cosine. */
static void under_and_beside_a_sphere(void **state)
{
    (void)state;
    struct trace_primitive above = trace_sphere(vec3(0, 2, 0), 0.8);
    assert_visibility(&above, 1, 100, 1 - 0.16, NAN);
    for (double d = 0.3; d < 3; d += 0.3) {
        struct trace_primitive resting = trace_sphere(vec3(d, 1, 0), 1);
        assert_visibility(&resting, 1, 100, 1 - pow(1 + d * d, -1.5), NAN);
    }
}

/* An endless strip covers (sin a - sin b) / 2 in the plane across it. */
static void under_a_long_beam_and_pipe(void **state)
{
    (void)state;
    struct trace_primitive pipe = trace_cylinder(vec3(0, 2, -1e5), vec3(0, 2, 1e5), 0.9);
    assert_visibility(&pipe, 1, 1e7, 1 - 0.45, NAN);
    struct trace_primitive beam = trace_box(vec3(0, 1.5, 0), vec3(0.75, 0.5, 1e5));
    assert_visibility(&beam, 1, 1e7, 1 - 0.6, NAN);
}

static void bottom_of_a_well(void **state)
{
    (void)state;
    const double bore = 0.6, depth = 0.8;
    struct trace_primitive well = trace_cylinder(vec3(0, 0, 0), vec3(0, depth, 0), 1);
    well.kind = TRACE_BORED_CYLINDER;
    well.bore = bore;
    assert_visibility(&well, 1, 100, bore * bore / (bore * bore + depth * depth), NAN);
}

/* From the axis, a ray whose part along the axis is z meets the vault at t = 1 / sqrt(1 - z^2):
 * those within reach have |z| < c, a strip of the unit disk. */
static void under_a_long_vault(void **state)
{
    (void)state;
    struct trace_primitive vault = trace_box(vec3(0, 1, 0), vec3(2, 1, 1e4));
    vault.kind = TRACE_BORED_BOX;
    vault.bore = 1.0;
    vault.bore_y = -1.0;
    assert_visibility(&vault, 1, 1.0 - 1e-9, 1.0, 1.0);
    double radius = 1.25, c = sqrt(1 - 1 / (radius * radius));
    assert_visibility(&vault, 1, radius, 1 - 2 * (asin(c) + c / radius) / PI, NAN);
}

static void closed_room_has_no_sky(void **state)
{
    (void)state;
    struct trace_primitive room = trace_box(vec3(0.2, 1, -0.3), vec3(2, 1.5, 3));
    assert_visibility(&room, 1, 100, 0.0, NAN);
    assert_visibility(&room, 1, 1.0, 1.0, 1.0);
}

/* --- hits --- */

static struct trace_primitive random_primitive(enum trace_kind kind)
{
    struct trace_primitive p =
        trace_box(vec3(random_between(-3, 3), random_between(-3, 3), random_between(-3, 3)),
                  vec3(random_between(0.2, 1), random_between(0.2, 1), random_between(0.2, 1)));
    p.axes = mat3_turned(random_between(0, 6), random_between(0, 6), random_between(0, 6));
    p.kind = kind;
    p.bore = random_between(0.3, 0.9) * fmin(p.size.x, p.size.y);
    p.bore_y = kind == TRACE_BORED_BOX ? random_between(-1, 1) * p.size.y : 0;
    return p;
}

static bool inside(const struct trace_primitive *p, struct vec3 q)
{
    bool in_box = fabs(q.x) < p->size.x && fabs(q.y) < p->size.y && fabs(q.z) < p->size.z;
    bool in_cylinder = hypot(q.x, q.z) < p->size.x && fabs(q.y) < p->size.y;
    switch (p->kind) {
    case TRACE_SPHERE:
        return length(q) < p->size.x;
    case TRACE_BOX:
        return in_box;
    case TRACE_CYLINDER:
        return in_cylinder;
    case TRACE_BORED_BOX:
        return in_box && hypot(q.x, q.y - p->bore_y) > p->bore;
    case TRACE_BORED_CYLINDER:
        return in_cylinder && hypot(q.x, q.z) > p->bore;
    default: /* sheets: the half space below */
        return q.y < 0;
    }
}

/* Distance to the nearest edge of a solid, where a step along the normal need not leave it. */
static bool near_an_edge(const struct trace_primitive *p, struct vec3 q, struct vec3 n)
{
    struct mat3 frame = mat3_around(n);
    bool first = inside(p, mad(n, -1e-5, q));
    for (int i = 0; i < 8; i++) {
        struct vec3 side =
            add(scale(frame.x, 1e-3 * cos(i * PI / 4)), scale(frame.z, 1e-3 * sin(i * PI / 4)));
        if (inside(p, add(q, mad(n, -2e-5, side))) != first)
            return true;
    }
    return false;
}

static void hits_lie_on_the_surface_and_normals_point_out_of_it(void **state)
{
    (void)state;
    random_state = 5;
    for (int kind = TRACE_PLANE; kind <= TRACE_BORED_CYLINDER; kind++) {
        int checked = 0;
        for (int i = 0; i < 20000; i++) {
            struct trace_primitive p = random_primitive((enum trace_kind)kind);
            struct trace_scene scene = scene_of(&p, 1);
            struct vec3 origin = scale(random_direction(), 8);
            struct vec3 d = normalize(sub(mad(random_direction(), 0.8, p.position), origin));
            struct trace_hit hit;
            if (trace_closest(&scene, origin, d, 0, INFINITY, &hit)) {
                assert_near(length(sub(hit.position, mad(d, hit.t, origin))), 0, 1e-12, "position");
                assert_near(length(hit.normal), 1, 1e-9, "length of the normal");
                assert_true(dot(trace_facing(&hit, d), d) <= 0);
                assert_true(fabs(dot(trace_facing(&hit, d), hit.normal)) > 1 - 1e-9);
                struct vec3 world = mul_transposed(p.axes, hit.local);
                assert_near(length(sub(add(world, p.position), hit.position)), 0, 1e-12, "local");
                assert_true(inside(&p, mad(hit.local_normal, -1e-9, hit.local)) ||
                            near_an_edge(&p, hit.local, hit.local_normal));
                assert_true(!inside(&p, mad(hit.local_normal, 1e-9, hit.local)) ||
                            near_an_edge(&p, hit.local, hit.local_normal));
                /* From outside one enters. */
                if (kind > TRACE_DISK)
                    assert_true(dot(hit.normal, d) < 0);
                if (kind == TRACE_DISK)
                    assert_true(length(hit.local) <= p.size.x + 1e-9);
                checked++;
            }
            trace_scene_free(&scene);
        }
        if (checked < 2000)
            fail_msg("kind %d was hit only %d times", kind, checked);
    }
}

/* Marching misses at most what is thinner than a step. */
static void nothing_is_passed_on_the_way_to_a_hit(void **state)
{
    (void)state;
    random_state = 6;
    for (int i = 0; i < 3000; i++) {
        struct trace_primitive p =
            random_primitive((enum trace_kind)(TRACE_SPHERE + i % (TRACE_BORED_CYLINDER - 1)));
        struct trace_scene scene = scene_of(&p, 1);
        /* From anywhere, inside too; then the first crossing is that of the other sense. */
        struct vec3 origin = mad(random_direction(), random_between(0, 1.5), p.position);
        struct vec3 d = random_direction();
        struct trace_hit hit;
        double end = trace_closest(&scene, origin, d, 0, 5, &hit) ? hit.t : 5;
        struct vec3 o = mul_mat(p.axes, sub(origin, p.position)), l = mul_mat(p.axes, d);
        bool first = inside(&p, o);
        for (double t = 0.01; t < end; t += 0.01)
            assert_int_equal(inside(&p, mad(l, t, o)), first);
        if (end < 5) {
            assert_int_equal(inside(&p, mad(l, end + 1e-9, o)), !first);
            assert_int_equal(dot(hit.normal, d) > 0, first);
        }
        trace_scene_free(&scene);
    }
}

static struct trace_scene random_scene(size_t count)
{
    struct trace_scene scene = {0};
    for (size_t i = 0; i < count; i++)
        trace_add(&scene, random_primitive((enum trace_kind)(i % (TRACE_BORED_CYLINDER + 1))));
    assert_true(trace_build(&scene));
    return scene;
}

static void tree_finds_what_a_search_of_all_finds(void **state)
{
    (void)state;
    random_state = 7;
    struct trace_scene scene = random_scene(100);
    struct trace_scene single[100];
    for (size_t i = 0; i < scene.count; i++)
        single[i] = scene_of(&scene.primitives[i], 1);
    for (int ray = 0; ray < 3000; ray++) {
        struct vec3 origin = scale(random_direction(), random_between(0, 6));
        struct vec3 d = ray % 10 ? random_direction() : vec3(0, 0, 1);
        double t_min = random_between(0, 1), t_max = random_between(1, 9);
        struct trace_hit hit = {0}, one;
        size_t best = scene.count;
        double nearest = t_max;
        for (size_t i = 0; i < scene.count; i++) {
            if (trace_closest(&single[i], origin, d, t_min, nearest, &one)) {
                nearest = one.t;
                best = i;
            }
        }
        bool found = trace_closest(&scene, origin, d, t_min, t_max, &hit);
        assert_int_equal(found, best < scene.count);
        assert_int_equal(trace_any(&scene, origin, d, t_min, t_max), found);
        if (found) {
            assert_int_equal(hit.primitive, best);
            assert_true(hit.t == nearest && hit.t > t_min && hit.t < t_max);
        }
    }
    for (size_t i = 0; i < scene.count; i++)
        trace_scene_free(&single[i]);
    trace_scene_free(&scene);
}

static void empty_scene_is_open(void **state)
{
    (void)state;
    struct trace_scene scene = {0};
    struct trace_hit hit;
    assert_true(trace_build(&scene));
    assert_false(trace_closest(&scene, vec3(0, 0, 0), up, 0, INFINITY, &hit));
    assert_false(trace_any(&scene, vec3(0, 0, 0), up, 0, INFINITY));
    trace_scene_free(&scene);
}

/* --- cameras and pictures --- */

enum { WIDTH = 31, HEIGHT = 17 };

static struct trace_camera camera_of(bool orthographic)
{
    struct trace_camera camera = {
        .orthographic = orthographic, .fov_x_deg = 70, .ortho_width = 6, .near = 0.5, .far = 50};
    trace_camera_look_at(&camera, vec3(2, 3, 5), vec3(-0.5, 0.2, 0));
    return camera;
}

static void header_matrices_project_hits_back_to_their_texels(void **state)
{
    (void)state;
    struct trace_scene scene = scene_of((struct trace_primitive[]){floor_plane()}, 1);
    for (int orthographic = 0; orthographic < 2; orthographic++) {
        struct trace_camera camera = camera_of(orthographic);
        float view[16], ndc[16];
        trace_camera_exr_matrices(&camera, WIDTH, HEIGHT, view, ndc);
        for (int i = 0; i < WIDTH * HEIGHT; i++) {
            struct trace_hit hit;
            struct trace_ray ray;
            double x = i % WIDTH + 0.5, y = i / WIDTH + 0.5;
            if (!trace_primary(&scene, &camera, x, y, WIDTH, HEIGHT, &hit, &ray))
                continue;
            const double p[4] = {hit.position.x, hit.position.y, hit.position.z, 1};
            double in_view[4] = {0}, in_ndc[4] = {0};
            for (int k = 0; k < 16; k++) {
                in_view[k % 4] += p[k / 4] * (double)view[k];
                in_ndc[k % 4] += p[k / 4] * (double)ndc[k];
            }
            assert_near(in_ndc[0] / in_ndc[3] * WIDTH, x, 1e-4, "x");
            assert_near(in_ndc[1] / in_ndc[3] * HEIGHT, y, 1e-4, "y");
            assert_near(in_view[2], hit.t * ray.z_per_t, 1e-5, "z");
            double depth = in_ndc[2] / in_ndc[3];
            assert_true(depth > 0 && depth < 1);
        }
    }
    trace_scene_free(&scene);
}

static void pictures_are_upright_and_x_goes_right(void **state)
{
    (void)state;
    struct trace_primitive parts[] = {trace_sphere(vec3(-2, 0, -5), 0.5),
                                      trace_sphere(vec3(0, 1.2, -5), 0.5)};
    struct trace_scene scene = scene_of(parts, 2);
    for (int orthographic = 0; orthographic < 2; orthographic++) {
        struct trace_camera camera = camera_of(orthographic);
        trace_camera_look_at(&camera, vec3(0, 0, 0), vec3(0, 0, -1));
        float z[WIDTH * HEIGHT], normal[3 * WIDTH * HEIGHT];
        struct trace_gbuffer out = {.z = z, .normal = normal};
        trace_gbuffer(&scene, &camera, WIDTH, HEIGHT, 0, HEIGHT, &out);
        double left = 0, right = 0, top = 0, bottom = 0;
        for (int i = 0; i < WIDTH * HEIGHT; i++) {
            bool seen = z[i] > 0;
            left += seen && i % WIDTH < WIDTH / 3;
            right += seen && i % WIDTH > 2 * WIDTH / 3;
            top += seen && i / WIDTH < HEIGHT / 2 - 1 && i % WIDTH > WIDTH / 3;
            bottom += seen && i / WIDTH > HEIGHT / 2 && i % WIDTH > WIDTH / 3;
            assert_true(seen ? normal[3 * i + 2] > 0 : normal[3 * i + 2] == 0);
        }
        assert_true(left > 3 && top > 3);
        assert_true(right == 0 && bottom == 0);
    }
    trace_scene_free(&scene);
}

static void depth_is_planar_and_clipped_by_near_and_far(void **state)
{
    (void)state;
    struct trace_primitive parts[] = {trace_plane(vec3(0, 0, -4), vec3(0, 0, 1)),
                                      trace_plane(vec3(0, 0, -9), vec3(0, 0, 1))};
    struct trace_scene scene = scene_of(parts, 2);
    static const struct {
        double near, far;
        float z;
    } rows[] = {{1, 50, 4}, {4.5, 50, 9}, {4.5, 8.5, 0}, {10, 50, 0}};
    for (size_t row = 0; row < sizeof rows / sizeof *rows; row++) {
        for (int orthographic = 0; orthographic < 2; orthographic++) {
            struct trace_camera camera = camera_of(orthographic);
            trace_camera_look_at(&camera, vec3(0, 0, 0), vec3(0, 0, -1));
            camera.near = rows[row].near;
            camera.far = rows[row].far;
            float z[WIDTH * HEIGHT];
            struct trace_gbuffer out = {.z = z};
            trace_gbuffer(&scene, &camera, WIDTH, HEIGHT, 0, HEIGHT, &out);
            for (int i = 0; i < WIDTH * HEIGHT; i++)
                assert_near((double)z[i], (double)rows[row].z, 1e-6, "z");
        }
    }
    trace_scene_free(&scene);
}

static void normals_face_the_camera_on_both_sides_of_a_sheet(void **state)
{
    (void)state;
    for (int side = -1; side <= 1; side += 2) {
        struct trace_primitive sheet = trace_plane(vec3(0, 0, -4), vec3(0, 0, side));
        struct trace_scene scene = scene_of(&sheet, 1);
        struct trace_camera camera = camera_of(false);
        trace_camera_look_at(&camera, vec3(0, 0, 0), vec3(0, 0, -1));
        float normal[3 * WIDTH * HEIGHT], threshold[WIDTH * HEIGHT], falloff[WIDTH * HEIGHT];
        struct trace_gbuffer out = {.normal = normal};
        trace_gbuffer(&scene, &camera, WIDTH, HEIGHT, 0, HEIGHT, &out);
        trace_ao_image(&scene, &camera, WIDTH, HEIGHT, 0, HEIGHT, 1, 16, threshold, falloff);
        for (int i = 0; i < WIDTH * HEIGHT; i++) {
            assert_near((double)normal[3 * i + 2], 1, 1e-6, "normal.z");
            assert_true(threshold[i] == 1.0f);
        }
        trace_scene_free(&scene);
    }
}

static void ao_image_is_the_same_in_parts_and_open_where_nothing_is(void **state)
{
    (void)state;
    struct trace_primitive parts[] = {trace_box(vec3(0, 0.5, 0), vec3(0.5, 0.5, 0.5)),
                                      trace_disk(vec3(0, 0, 0), up, 2)};
    struct trace_scene scene = scene_of(parts, 2);
    struct trace_camera camera = camera_of(false);
    float whole[2][WIDTH * HEIGHT], halves[2][WIDTH * HEIGHT], z[WIDTH * HEIGHT];
    struct trace_gbuffer out = {.z = z};
    trace_gbuffer(&scene, &camera, WIDTH, HEIGHT, 0, HEIGHT, &out);
    trace_ao_image(&scene, &camera, WIDTH, HEIGHT, 0, HEIGHT, 1, 64, whole[0], whole[1]);
    trace_ao_image(&scene, &camera, WIDTH, HEIGHT, 9, HEIGHT, 1, 64, halves[0], halves[1]);
    trace_ao_image(&scene, &camera, WIDTH, HEIGHT, 0, 9, 1, 64, halves[0], halves[1]);
    assert_memory_equal(whole, halves, sizeof whole);
    int background = 0, occluded = 0;
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        background += z[i] == 0.0f;
        occluded += whole[0][i] < 0.9f;
        assert_true(whole[1][i] >= whole[0][i]);
        if (z[i] == 0.0f)
            assert_true(whole[0][i] == 1.0f && whole[1][i] == 1.0f);
    }
    assert_true(background > 50 && occluded > 10);
    trace_scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(floor_beside_an_endless_wall),
        cmocka_unit_test(open_floor_and_bottom_of_an_edge_and_of_a_corner),
        cmocka_unit_test(under_a_disk),
        cmocka_unit_test(under_and_beside_a_sphere),
        cmocka_unit_test(under_a_long_beam_and_pipe),
        cmocka_unit_test(bottom_of_a_well),
        cmocka_unit_test(under_a_long_vault),
        cmocka_unit_test(closed_room_has_no_sky),
        cmocka_unit_test(hits_lie_on_the_surface_and_normals_point_out_of_it),
        cmocka_unit_test(nothing_is_passed_on_the_way_to_a_hit),
        cmocka_unit_test(tree_finds_what_a_search_of_all_finds),
        cmocka_unit_test(empty_scene_is_open),
        cmocka_unit_test(header_matrices_project_hits_back_to_their_texels),
        cmocka_unit_test(pictures_are_upright_and_x_goes_right),
        cmocka_unit_test(depth_is_planar_and_clipped_by_near_and_far),
        cmocka_unit_test(normals_face_the_camera_on_both_sides_of_a_sheet),
        cmocka_unit_test(ao_image_is_the_same_in_parts_and_open_where_nothing_is),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
