/* SPDX-License-Identifier: MIT
 *
 * Any radius on screen, from a few texels to several times the image: as dark as rays find it, and
 * smooth. Samples of a large radius lie far apart, and where one of them leaves what is close to
 * the eye, all texels of a patch lose it at once. */
#include "fixture.h"
#include "ref_normal.h"
#include "ref_scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Truth is known in the middle of each cell. */
enum { WIDTH = 640, HEIGHT = 400, CELL = 5, COLUMNS = WIDTH / CELL, ROWS = HEIGHT / CELL };
enum { PRESETS = 4, CELLS = COLUMNS * ROWS };

/* Seen from above at a slant; beyond the things it lies about 3 units away. */
#define FLOOR                                                                                      \
    {                                                                                              \
        SHAPE_PLANE, {0.0, 0.0, 3.2},                                                              \
        {                                                                                          \
            0.0, -1.0, -1.0                                                                        \
        }                                                                                          \
    }
static const double floor_normal[3] = {0.0, -0.70710678118654752, -0.70710678118654752};
static const double floor_z = 3.2, half_width = 0.64;

/* A slab over the floor, another that nearly lies on it, and a box. */
static const struct scene slab = {{
    FLOOR,
    {SHAPE_BOX, {-0.2, 0.1, 2.2}, {0.45, 0.25, 0.04}},
    {SHAPE_BOX, {-1.2, 0.2, 2.9}, {0.2, 0.04, 0.2}},
    {SHAPE_BOX, {1.2, 0.0, 3.2}, {0.2, 0.2, 0.2}},
}};

/* Barrel, body, sight, magazine and grip, close to the eye, and a box on the floor. */
static const struct scene gun = {{
    FLOOR,
    {SHAPE_BOX, {0.30, 0.20, 1.70}, {0.035, 0.035, 0.50}},
    {SHAPE_BOX, {0.30, 0.24, 1.20}, {0.07, 0.08, 0.30}},
    {SHAPE_BOX, {0.30, 0.13, 2.10}, {0.012, 0.05, 0.02}},
    {SHAPE_BOX, {0.30, 0.42, 1.30}, {0.04, 0.14, 0.07}},
    {SHAPE_BOX, {0.30, 0.40, 1.02}, {0.04, 0.12, 0.05}},
    {SHAPE_BOX, {-1.2, 0.3, 3.0}, {0.5, 0.2, 0.3}},
}};

static const char *const presets[PRESETS] = {"fast", "default", "high", "best"};

static void render(struct picture *p, const struct scene *scene)
{
    const struct lens lens = lens_perspective(half_width, half_width * HEIGHT / WIDTH);
    picture_init(p, WIDTH, HEIGHT, VKAO_STAGE_SSAO | VKAO_STAGE_BLUR);
    p->view.depth_encoding = VKAO_DEPTH_VIEW_Z;
    p->view.normal_encoding = VKAO_NORMALS_XYZ_SNORM;
    picture_render_scene(p, scene, &lens, VK_FORMAT_R32_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT);
    picture_set(p, SLOT_AO, VK_FORMAT_R32_SFLOAT, NULL);
}

struct truth {
    double ao[CELLS];
    bool is_floor[CELLS]; /* all of the cell */
};

static bool shows_floor(const struct ref_scene *view, uint32_t x, uint32_t y)
{
    for (uint32_t i = 0; i < CELL * CELL; ++i) {
        size_t texel = (size_t)(y + i / CELL) * WIDTH + x + i % CELL;
        if (!(ref_dot(&view->normals[texel * 3], floor_normal) > 0.999))
            return false;
    }
    return true;
}

static void trace(struct truth *truth, const struct picture *p, const struct scene *scene)
{
    struct ref_scene view;
    picture_reference_scene(p, &view);
    for (uint32_t i = 0; i < CELLS; ++i) {
        uint32_t x = i % COLUMNS * CELL, y = i / COLUMNS * CELL, half = CELL / 2;
        size_t middle = (size_t)(y + half) * WIDTH + x + half;
        double at[3];
        ref_view_position(&view.view, x + half, y + half, view.z[middle], at);
        truth->ao[i] =
            scene_ambient(scene, at, &view.normals[middle * 3], (double)p->ssao.radius, 768)
                .falloff;
        truth->is_floor[i] = shows_floor(&view, x, y);
    }
    ref_scene_free(&view);
}

static double cell_mean(const struct picture *p, uint32_t cell)
{
    double sum = 0.0;
    for (uint32_t y = 0; y < CELL; ++y)
        sum += mean_of(
            &p->values[SLOT_AO][(cell / COLUMNS * CELL + y) * WIDTH + cell % COLUMNS * CELL], CELL);
    return sum / CELL;
}

/* Is the floor all that is seen of a cell and two beside it on each side, and how much does the
 * error bend from the first of these five to the last? */
static bool bend_of(const double *error, const struct truth *truth, uint32_t cell, uint32_t step,
                    double *bend)
{
    for (uint32_t i = 0; i < 5; ++i) {
        if (!truth->is_floor[cell + i * step - 2 * step])
            return false;
    }
    *bend = error[cell - 2 * step] - 2.0 * error[cell] + error[cell + 2 * step];
    return true;
}

struct found {
    double rmse;
    /* Root mean square bend of the floor's error over 20 texels: what is wrong all over has little
     * of it, patches and bands have much. */
    double rough;
};

static struct found compare(const struct picture *p, const struct truth *truth)
{
    static double error[CELLS];
    double squares = 0.0, bends = 0.0, bend;
    size_t count = 0;
    for (uint32_t i = 0; i < CELLS; ++i) {
        error[i] = cell_mean(p, i) - truth->ao[i];
        squares += error[i] * error[i];
    }
    for (uint32_t i = 0; i < CELLS; ++i) {
        uint32_t x = i % COLUMNS, y = i / COLUMNS;
        if (x < 2 || x >= COLUMNS - 2 || y < 2 || y >= ROWS - 2)
            continue;
        for (uint32_t step = 1; step <= COLUMNS; step += COLUMNS - 1) {
            if (!bend_of(error, truth, i, step, &bend))
                continue;
            bends += bend * bend;
            ++count;
        }
    }
    return (struct found){sqrt(squares / CELLS), sqrt(bends / (double)count)};
}

static void as_dark_and_as_smooth_at_any_radius(void **state)
{
    (void)state;
    const struct {
        const char *name;
        const struct scene *scene;
        double texels; /* of the floor */
        struct found limits[PRESETS];
    } rows[] = {
        /* What the slab hides is guessed too large: one layer does not show how thin it is. */
        {"slab", &slab, 5.0, {{0.009, 0.0020}, {0.008, 0.0023}, {0.008, 0.0019}, {0.007, 0.0020}}},
        {"slab", &slab, 10.0, {{0.012, 0.0074}, {0.011, 0.0070}, {0.010, 0.0070}, {0.010, 0.0071}}},
        {"slab", &slab, 60.0, {{0.028, 0.0091}, {0.025, 0.0079}, {0.026, 0.0084}, {0.026, 0.0069}}},
        {"slab",
         &slab,
         320.0,
         {{0.083, 0.0138}, {0.083, 0.0172}, {0.084, 0.0128}, {0.086, 0.0121}}},
        {"slab",
         &slab,
         1000.0,
         {{0.088, 0.0168}, {0.087, 0.0179}, {0.087, 0.0154}, {0.085, 0.0162}}},
        {"slab",
         &slab,
         2000.0,
         {{0.085, 0.0182}, {0.084, 0.0198}, {0.085, 0.0176}, {0.089, 0.0180}}},
        {"gun", &gun, 5.0, {{0.010, 0.0021}, {0.008, 0.0016}, {0.008, 0.0016}, {0.007, 0.0016}}},
        {"gun", &gun, 10.0, {{0.008, 0.0022}, {0.006, 0.0015}, {0.006, 0.0014}, {0.006, 0.0014}}},
        {"gun", &gun, 60.0, {{0.008, 0.0026}, {0.008, 0.0020}, {0.008, 0.0020}, {0.007, 0.0016}}},
        {"gun", &gun, 320.0, {{0.015, 0.0053}, {0.015, 0.0052}, {0.014, 0.0046}, {0.012, 0.0055}}},
        {"gun", &gun, 1000.0, {{0.047, 0.0086}, {0.047, 0.0093}, {0.047, 0.0076}, {0.040, 0.0064}}},
        {"gun", &gun, 2000.0, {{0.066, 0.0100}, {0.065, 0.0111}, {0.066, 0.0092}, {0.057, 0.0080}}},
    };
    static struct truth truth;
    size_t failures = 0;
    for (size_t row = 0; row < sizeof rows / sizeof rows[0]; ++row) {
        struct picture p;
        render(&p, rows[row].scene);
        p.ssao.radius = (float)(rows[row].texels * floor_z * 2.0 * half_width / WIDTH);
        trace(&truth, &p, rows[row].scene);
        for (int preset = 0; preset < PRESETS; ++preset) {
            const struct found *most = &rows[row].limits[preset];
            picture_preset(&p, (vkao_quality)preset);
            picture_run(&p);
            struct found found = compare(&p, &truth);
            bool good = found.rmse <= most->rmse && found.rough <= most->rough;
            print_message("    %-4s %4.0f texels, %-7s: RMSE %.4f, roughness %.5f%s\n",
                          rows[row].name, rows[row].texels, presets[preset], found.rmse,
                          found.rough, good ? "" : " TOO MUCH");
            failures += !good;
        }
        picture_free(&p);
    }
    assert_int_equal(failures, 0);
}

/* Samples beyond the image hide nothing: were most of them there, all would be open. */
static void beyond_the_image_nothing_gets_lighter(void **state)
{
    (void)state;
    static const vkao_ssao_method methods[] = {VKAO_SSAO_HBAO, VKAO_SSAO_GTAO, VKAO_SSAO_VBAO};
    for (size_t i = 0; i < sizeof methods / sizeof methods[0]; ++i) {
        double means[2];
        for (int far = 0; far < 2; ++far) {
            struct picture p;
            render(&p, &slab);
            picture_preset(&p, VKAO_QUALITY_DEFAULT);
            p.ssao.method = methods[i];
            p.ssao.radius = (far ? 1.0e5f : 100.0f) * (float)(floor_z * 2.0 * half_width);
            picture_run(&p);
            means[far] = mean_of(p.values[SLOT_AO], picture_texels(&p));
            picture_free(&p);
        }
        print_message("    method %d: mean %.4f at 100 times the width, %.4f at 100000\n",
                      (int)methods[i], means[0], means[1]);
        assert_true(means[0] < 0.98 && fabs(means[1] - means[0]) < 0.01);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {gpu_test(as_dark_and_as_smooth_at_any_radius),
                                       gpu_test(beyond_the_image_nothing_gets_lighter)};
    return fixture_run(tests);
}
