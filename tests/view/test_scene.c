/* SPDX-License-Identifier: MIT
 *
 * What the live scenes look like, and what vkao makes of them: both kinds, both projections. */
#include "live_rig.h"

#include <math.h>
#include <stdlib.h>

enum { WIDTH = 320, HEIGHT = 180, PROJECTIONS = 2 };

static void open_case(struct rig *rig, int kind, int orthographic, struct orbit *camera)
{
    rig_open(rig, (enum live_kind)kind, WIDTH, HEIGHT);
    *camera = live_scene_camera((enum live_kind)kind);
    camera->orthographic = orthographic != 0;
}

/* Runs the check for each kind of scene and projection. */
static void for_each_case(void (*run)(struct rig *rig, const struct orbit *camera))
{
    for (int kind = 0; kind < LIVE_KIND_COUNT; ++kind) {
        for (int orthographic = 0; orthographic < PROJECTIONS; ++orthographic) {
            struct rig rig;
            struct orbit camera;
            open_case(&rig, kind, orthographic, &camera);
            run(&rig, &camera);
            rig_close(&rig);
        }
    }
}

static int by_value(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Degrees between the normals of the image and those that the depth around each texel gives,
 * sorted; malloc'ed. */
static double *sorted_angles(const struct shot *shot, size_t *count)
{
    struct ref_scene stored, rebuilt;
    size_t n = shot_texels(shot);
    double *angles = test_alloc(n, sizeof *angles);
    struct ao_view depth_only = shot->view;
    depth_only.normal_encoding = VKAO_NORMALS_FROM_DEPTH;
    ref_scene_init(&stored, &shot->view, shot->width, shot->height, VK_FORMAT_D32_SFLOAT,
                   shot->depth, shot->normals);
    ref_scene_init(&rebuilt, &depth_only, shot->width, shot->height, VK_FORMAT_D32_SFLOAT,
                   shot->depth, NULL);
    *count = 0;
    for (size_t i = 0; i < n; ++i) {
        const double *a = stored.normals + 3 * i, *b = rebuilt.normals + 3 * i;
        if (isnan(stored.z[i]))
            continue;
        double cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        angles[(*count)++] = acos(fmin(fmax(cosine, -1), 1)) * 57.29577951308232;
    }
    ref_scene_free(&stored);
    ref_scene_free(&rebuilt);
    qsort(angles, *count, sizeof *angles, by_value);
    return angles;
}

static void check_normals(struct rig *rig, const struct orbit *camera)
{
    struct shot shot;
    size_t count;
    rig_shoot(rig, camera, 1.0, &shot);
    double *angles = sorted_angles(&shot, &count);
    assert_true(count > shot_texels(&shot) / 5);
    double median = angles[count / 2], p90 = angles[count / 10 * 9];
    print_message("%s%s: normals are off by %.2f degrees at the median, %.2f at the 90th centile\n",
                  live_scene_name(rig->kind), camera->orthographic ? ", orthographic" : "", median,
                  p90);
    /* 10 bits are good for 0.1 degrees. What is left are edges, and spheres of flat triangles. */
    assert_true(median < 0.15);
    assert_true(p90 < 8);
    free(angles);
    shot_free(&shot);
}

static void normals_agree_with_depth(void **state)
{
    (void)state;
    for_each_case(check_normals);
}

static void check_background(struct rig *rig, const struct orbit *camera)
{
    struct shot shot;
    size_t background = 0, occluded = 0;
    rig_shoot(rig, camera, 1.0, &shot);
    for (size_t i = 0; i < shot_texels(&shot); ++i) {
        bool surface = shot.depth[i] > 0;
        assert_true(shot.depth[i] < 1);
        assert_true(shot.indirect[4 * i + 3] == surface && shot.direct[4 * i + 3] == surface);
        occluded += shot.ao[i] < 1;
        background += !surface;
        if (!surface && shot.ao[i] != 1)
            fail_msg("background has AO %.9g", shot.ao[i]);
    }
    assert_true(background > 0);
    assert_true(occluded > shot_texels(&shot) / 20);
    shot_free(&shot);
}

static void background_is_open(void **state)
{
    (void)state;
    for_each_case(check_background);
}

/* The output is what INDIRECT says: direct light whole, indirect light times AO. */
static void check_lights(struct rig *rig, const struct orbit *camera)
{
    struct shot shot;
    rig_shoot(rig, camera, 1.0, &shot);
    size_t n = shot_texels(&shot);
    double *want = test_alloc(3 * n, sizeof *want), *got = test_alloc(3 * n, sizeof *got);
    for (size_t i = 0; i < 3 * n; ++i) {
        size_t k = i / 3 * 4 + i % 3;
        want[i] = shot.direct[k] + shot.indirect[k] * shot.ao[i / 3];
        got[i] = shot.output[k];
        assert_true(shot.indirect[k] >= 0 && shot.direct[k] >= 0);
    }
    /* Half floats around 1 are 0.001 apart. */
    check_close("output", got, want, 3 * n, 0.0003, 0.001, 0.02);
    free(want);
    free(got);
    shot_free(&shot);
}

static void occlusion_dims_indirect_light_alone(void **state)
{
    (void)state;
    for_each_case(check_lights);
}

static void bounces_brighten_what_is_occluded(void **state)
{
    (void)state;
    struct rig rig;
    struct orbit camera;
    struct shot once, bounced;
    open_case(&rig, LIVE_ROOM, 0, &camera);
    rig_shoot(&rig, &camera, 1.0, &once);
    rig.multi_bounce = true;
    rig_resize(&rig, rig.flights[0].target.extent.width, rig.flights[0].target.extent.height);
    rig_shoot(&rig, &camera, 1.0, &bounced);
    size_t n = shot_texels(&once);
    for (size_t i = 0; i < 4 * n; ++i)
        assert_true(bounced.output[i] >= once.output[i] - 0.001);
    assert_true(mean_of(bounced.output, 4 * n) > mean_of(once.output, 4 * n) + 0.002);
    shot_free(&once);
    shot_free(&bounced);
    rig_close(&rig);
}

/* Mean of the texel and its eight neighbours. */
static double ao_at(const struct shot *shot, const struct orbit *camera, const double world[3])
{
    double sum = 0;
    long texel = shot_texel_of(shot, camera, world), width = (long)shot->width;
    if (texel < width || texel >= width * (long)(shot->height - 1))
        fail_msg("the point %g %g %g is not seen", world[0], world[1], world[2]);
    for (long y = -1; y <= 1; ++y) {
        for (long x = -1; x <= 1; ++x)
            sum += shot->ao[texel + y * width + x];
    }
    return sum / 9;
}

/* World points; contacts lie a little off the edge that they are named for. */
static const struct sights {
    double open[2][3], contacts[4][3];
} sights[LIVE_KIND_COUNT] = {
    [LIVE_CUBES] =
        {
            .open = {{0.2, 0, 2.6}, {2.4, 0, 0.6}},
            /* cubes on the slab, and on each other */
            .contacts = {{1.1, 0, 0.83}, {-0.2, 1.2, 0.34}, {2.25, 0, -1.78}, {-0.48, 0, 1.41}},
        },
    [LIVE_ROOM] =
        {
            .open = {{3.1, 0, 0.0}, {-0.2, 0, 2.1}},
            /* two walls, the sofa's seat and back, cupboard and step, column and floor */
            .contacts =
                {{-3.97, 1.6, -3}, {-3.64, 0.42, -0.85}, {2.9, 0.18, -2.47}, {2.0, 0, 0.92}},
        },
};
/* When what moves is behind. */
static const double sights_time[LIVE_KIND_COUNT] = {[LIVE_CUBES] = 6, [LIVE_ROOM] = 4};

static void check_contacts(struct rig *rig, const struct orbit *camera)
{
    const struct sights *s = &sights[rig->kind];
    struct shot shot;
    rig_shoot(rig, camera, sights_time[rig->kind], &shot);
    for (size_t i = 0; i < sizeof s->open / sizeof s->open[0]; ++i) {
        double ao = ao_at(&shot, camera, s->open[i]);
        print_message("open %.3f\n", ao);
        assert_true(ao > 0.97);
    }
    for (size_t i = 0; i < sizeof s->contacts / sizeof s->contacts[0]; ++i) {
        double ao = ao_at(&shot, camera, s->contacts[i]);
        print_message("contact %.3f\n", ao);
        assert_true(ao < 0.8);
    }
    shot_free(&shot);
}

static void contacts_are_darker_than_the_open_floor(void **state)
{
    (void)state;
    for_each_case(check_contacts);
}

/* The floor in front of where the cube hovers and the ball rolls at `near`, from where both are
 * gone at `far`. Whole rounds take `round` seconds. */
static const struct journey {
    double near, far, round, floor[3];
} journeys[LIVE_KIND_COUNT] = {
    [LIVE_CUBES] = {0, 6, 12, {0.06, 0, 2.2}},
    [LIVE_ROOM] = {6, 2, 8, {1.17, 0.0, 0.72}},
};

static void check_motion(struct rig *rig, const struct orbit *camera)
{
    const struct journey *j = &journeys[rig->kind];
    struct shot here, gone, again;
    rig_shoot(rig, camera, j->near, &here);
    rig_shoot(rig, camera, j->far, &gone);
    rig_shoot(rig, camera, j->near + j->round, &again);
    double dark = ao_at(&here, camera, j->floor), light = ao_at(&gone, camera, j->floor);
    print_message("the floor has AO %.3f beneath it, %.3f without\n", dark, light);
    assert_true(dark < light - 0.2);
    shot_check_equal(&here, &again);
    shot_free(&here);
    shot_free(&gone);
    shot_free(&again);
}

static void what_moves_darkens_the_floor_and_comes_round(void **state)
{
    (void)state;
    for_each_case(check_motion);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        gpu_test(normals_agree_with_depth),
        gpu_test(background_is_open),
        gpu_test(occlusion_dims_indirect_light_alone),
        gpu_test(bounces_brighten_what_is_occluded),
        gpu_test(contacts_are_darker_than_the_open_floor),
        gpu_test(what_moves_darkens_the_floor_and_comes_round),
    };
    return fixture_run(tests);
}
