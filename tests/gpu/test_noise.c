/* SPDX-License-Identifier: MIT
 *
 * What the blur of the presets leaves of the noise's pattern on a tilted wall that boxes shade.
 * Digits of turns and moves repeat after four texels, with four slices after two, and turns climb
 * by a quarter of 1/g from row to row: whatever comes of them, a wall shows as waves
 * (i / tile, j / tile + k / 4g). Those along a column, i = 0, are mixtures of turns and
 * moves. tests/cli/test_noise.py looks for them on files of renderers. */
#include "fixture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

enum {
    WIDTH = 128,
    HEIGHT = 96,
    SIZE = 64,   /* of the window in the middle */
    PATTERNS = 8 /* The scene is their mean, and goes out with it. */
};

struct frequency {
    double x, y; /* cycles per texel */
};

/* A wave along one axis of the window, under a raised cosine. */
static void wave_along(double cycles, double re[SIZE], double im[SIZE])
{
    for (int i = 0; i < SIZE; ++i) {
        const double weight = pow(sin(pi * (i + 0.5) / SIZE), 2.0), turn = 2.0 * pi * cycles * i;
        re[i] = weight * cos(turn);
        im[i] = weight * sin(turn);
    }
}

/* Fourier transform of the middle of the image: along rows, then along the column of these. */
static void transform(const double *image, struct frequency f, double *re, double *im)
{
    const size_t x0 = (WIDTH - SIZE) / 2, y0 = (HEIGHT - SIZE) / 2;
    double x_re[SIZE], x_im[SIZE], y_re[SIZE], y_im[SIZE];
    wave_along(f.x, x_re, x_im);
    wave_along(f.y, y_re, y_im);
    *re = *im = 0.0;
    for (size_t y = 0; y < SIZE; ++y) {
        double row_re = 0.0, row_im = 0.0;
        for (size_t x = 0; x < SIZE; ++x) {
            const double v = image[(y0 + y) * WIDTH + x0 + x];
            row_re += v * x_re[x];
            row_im += v * x_im[x];
        }
        *re += row_re * y_re[y] - row_im * y_im[y];
        *im += row_re * y_im[y] + row_im * y_re[y];
    }
}

static double power_at(const double *image, struct frequency f)
{
    double re, im;
    transform(image, f, &re, &im);
    return re * re + im * im;
}

static double level_of(const double *image)
{
    double sum, im;
    transform(image, (struct frequency){0.0, 0.0}, &sum, &im);
    return sum / (SIZE * SIZE / 4.0);
}

/* Root mean square of the wave whose power this is. */
static double rms_of(double power)
{
    return sqrt(2.0 * power) / (SIZE * SIZE / 4.0);
}

static int compare_doubles(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

/* Means over the patterns of what they differ from their mean by. */
static double mean_power(double residuals[PATTERNS][WIDTH * HEIGHT], struct frequency f)
{
    double power = 0.0;
    for (int i = 0; i < PATTERNS; ++i)
        power += power_at(residuals[i], f) / PATTERNS;
    return power;
}

/* Median of the power on a circle of 5 bins around. */
static double surroundings(double residuals[PATTERNS][WIDTH * HEIGHT], struct frequency f)
{
    enum { COUNT = 9 };
    double powers[COUNT];
    for (int i = 0; i < COUNT; ++i) {
        double angle = 2.0 * pi * i / COUNT;
        powers[i] = mean_power(residuals, (struct frequency){f.x + 5.0 / SIZE * cos(angle),
                                                             f.y + 5.0 / SIZE * sin(angle)});
    }
    qsort(powers, COUNT, sizeof powers[0], compare_doubles);
    return powers[COUNT / 2];
}

/* Root mean squares of the largest of the noise's own waves and of the mixtures; power of a wave
 * of the digits, k = 0, to its surroundings. */
struct waves {
    double own, mixed, ratio;
};

/* tile: texels after which the digits repeat. */
static struct waves waves_of(double residuals[PATTERNS][WIDTH * HEIGHT], int tile, bool half)
{
    const double g = 1.32471795724474602596, scale = half ? 0.5 : 1.0;
    const int harmonics = tile == 4 ? 3 : 0;
    struct waves waves = {0};
    for (int k = -harmonics; k <= harmonics; ++k) {
        for (int wave = k == 0; wave < tile * tile; ++wave) {
            double x = (double)(wave % tile) / tile, y = (double)(wave / tile) / tile;
            /* Upsampling doubles the periods and mirrors them. */
            for (int mirror = 0; mirror < (half ? 4 : 1); ++mirror) {
                const struct frequency f = {scale * (x + mirror % 2),
                                            scale * (y + k / (4.0 * g) + mirror / 2)};
                double power = mean_power(residuals, f);
                double *largest = wave % tile || k == 0 ? &waves.own : &waves.mixed;
                *largest = fmax(*largest, rms_of(power));
                if (k == 0)
                    waves.ratio = fmax(waves.ratio, power / surroundings(residuals, f));
            }
        }
    }
    return waves;
}

/* A wall through (0, 0, 4), and six boxes on it left and right of the window. */
static struct scene shaded_wall(double degrees, double azimuth)
{
    struct scene scene = scene_tilted_plane(degrees, azimuth);
    const double *n = scene.shapes[0].size;
    for (int i = 0; i < 6; ++i) {
        double x = i % 2 ? 1.15 : -1.15, y = 0.8 * (i / 2 - 1);
        double z = 4.0 - (n[0] * x + n[1] * y) / n[2], height = -0.4 / n[2];
        scene.shapes[1 + i] = (struct shape){SHAPE_BOX, {x, y, z - height}, {0.3, 0.3, height}};
    }
    return scene;
}

static void run_pattern(vkao_quality quality, bool blurred, uint32_t pattern,
                        const struct scene *scene, double *ao)
{
    struct picture p;
    struct lens lens = lens_orthographic(1.6, 1.2);
    picture_init(&p, WIDTH, HEIGHT, VKAO_STAGE_SSAO | VKAO_STAGE_BLUR);
    p.view.depth_encoding = VKAO_DEPTH_VIEW_Z;
    p.view.normal_encoding = VKAO_NORMALS_XYZ_SNORM;
    picture_render_scene(&p, scene, &lens, VK_FORMAT_R32_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT);
    picture_set(&p, SLOT_AO, VK_FORMAT_R32_SFLOAT, NULL);
    picture_preset(&p, quality);
    p.ssao.radius = 1.6f;
    p.ssao.noise_index = pattern;
    if (!blurred)
        p.blur.radius = 0;
    picture_run(&p);
    memcpy(ao, p.values[SLOT_AO], sizeof(double) * WIDTH * HEIGHT);
    picture_free(&p);
}

static struct waves measure(vkao_quality quality, bool blurred, const struct scene *scene,
                            double *mean_ao)
{
    static double residuals[PATTERNS][WIDTH * HEIGHT];
    *mean_ao = 0.0;
    for (int i = 0; i < PATTERNS; ++i) {
        run_pattern(quality, blurred, (uint32_t)i, scene, residuals[i]);
        *mean_ao += level_of(residuals[i]) / PATTERNS;
    }
    for (size_t t = 0; t < WIDTH * HEIGHT; ++t) {
        double mean = 0.0;
        for (int i = 0; i < PATTERNS; ++i)
            mean += residuals[i][t] / PATTERNS;
        for (int i = 0; i < PATTERNS; ++i)
            residuals[i][t] -= mean;
    }
    for (int i = 0; i < PATTERNS; ++i) {
        double level = level_of(residuals[i]); /* would pass for slow waves */
        for (size_t t = 0; t < WIDTH * HEIGHT; ++t)
            residuals[i][t] -= level;
    }
    return waves_of(residuals, quality == VKAO_QUALITY_BEST ? 2 : 4, quality == VKAO_QUALITY_FAST);
}

/* In steps of an 8-bit image, root mean square: hardly anything of the noise's own waves, less than
 * a step of the mixtures, which are weak from the start but may be slower than the blur is wide. */
static void no_pattern_of_the_noise_is_left_on_a_tilted_wall(void **state)
{
    (void)state;
    static const char *const names[] = {"fast", "default", "high", "best"};
    static const struct {
        double degrees, azimuth;
    } walls[] = {{0.0, 0.0}, {35.0, 25.0}, {60.0, 115.0}};
    const double step = 1.0 / 255.0;
    for (int i = 0; i < 3 * 4; ++i) {
        const struct scene scene = shaded_wall(walls[i / 4].degrees, walls[i / 4].azimuth);
        double mean_ao;
        struct waves noisy = measure((vkao_quality)(i % 4), false, &scene, &mean_ao);
        struct waves left = measure((vkao_quality)(i % 4), true, &scene, &mean_ao);
        print_message("    %-7s %2.0f degrees, mean AO %.2f: own %.3f/255 (noisy %.2f), mixed "
                      "%.2f/255 (%.2f), peak to surroundings %.1f (%.0f)\n",
                      names[i % 4], walls[i / 4].degrees, mean_ao, left.own / step,
                      noisy.own / step, left.mixed / step, noisy.mixed / step, left.ratio,
                      noisy.ratio);
        assert_true(mean_ao < 0.95);
        /* It is looked for in the right places; two slices have less of it from the start. */
        assert_true(noisy.own > (i % 4 == VKAO_QUALITY_HIGH ? 25.0 : 50.0) * left.own);
        assert_true(left.own <= 0.1 * step);
        assert_true(left.mixed <= 0.75 * step);
        /* Upsampling leaves peaks, of a fiftieth of a step. */
        assert_true(i % 4 == VKAO_QUALITY_FAST || left.ratio < 2.0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        gpu_test(no_pattern_of_the_noise_is_left_on_a_tilted_wall),
    };
    return fixture_run(tests);
}
