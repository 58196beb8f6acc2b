/* SPDX-License-Identifier: MIT
 *
 * What the blur of the presets leaves of the noise's pattern on a tilted wall that boxes shade.
 * Slices turn with interleaved gradient noise, steps are jittered by the R2 sequence; a wall shows
 * what comes of them as waves k f1 + l f2: of the gradient for l = 0, of the sequence for k = 0,
 * beats of both otherwise. tests/cli/test_noise.py looks for them on files of renderers. */
#include "fixture.h"
#include "ref_noise.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

enum {
    WIDTH = 128,
    HEIGHT = 96,
    SIZE = 64, /* of the window in the middle */
    HARMONICS = 8,
    PATTERNS = 6
};

/* The scene is their mean, and goes out with it. Their phases lie such that the mean takes at most
 * .37 of the power of a wave along. */
static const uint32_t patterns[PATTERNS] = {0, 8, 19, 35, 45, 52};

struct frequency {
    double x, y; /* cycles per texel */
};

/* The gradient climbs by 53 steps over each period of its phase. */
static struct frequency wave(int k, int l)
{
    const double g = 1.32471795724474602596;
    return (struct frequency){remainder(k * 53 * 0.06711056 + l / g, 1.0),
                              remainder(k * 53 * 0.00583715 + l / (g * g), 1.0)};
}

/* Fourier transform of the middle of the image under a raised cosine. */
static void transform(const double *image, struct frequency f, double *re, double *im)
{
    const size_t x0 = (WIDTH - SIZE) / 2, y0 = (HEIGHT - SIZE) / 2;
    *re = *im = 0.0;
    for (size_t y = 0; y < SIZE; ++y) {
        double row = pow(sin(pi * ((double)y + 0.5) / SIZE), 2.0);
        for (size_t x = 0; x < SIZE; ++x) {
            double w = row * pow(sin(pi * ((double)x + 0.5) / SIZE), 2.0);
            double turn = 2.0 * pi * (f.x * (double)x + f.y * (double)y);
            double v = w * image[(y0 + y) * WIDTH + x0 + x];
            *re += v * cos(turn);
            *im += v * sin(turn);
        }
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

/* Share of a wave's power that stays when the mean over the patterns is taken out. */
static double left_by_mean(int k, int l)
{
    double re = 0.0, im = 0.0;
    for (int i = 0; i < PATTERNS; ++i) {
        double phase =
            2.0 * pi *
            (k * ref_gradient_noise(0, 0, patterns[i]) + l * ref_r2_noise(0, 0, patterns[i]));
        re += cos(phase) / PATTERNS;
        im += sin(phase) / PATTERNS;
    }
    return 1.0 - re * re - im * im;
}

struct waves {
    double own, beat, ratio; /* root mean squares; power to its surroundings */
};

static void look_at(double residuals[PATTERNS][WIDTH * HEIGHT], int k, int l, struct frequency f,
                    struct waves *waves)
{
    double *largest = k == 0 || l == 0 ? &waves->own : &waves->beat;
    double power = mean_power(residuals, f);
    *largest = fmax(*largest, rms_of(power / left_by_mean(k, l)));
    /* The surroundings cost nine times as much. */
    if ((k == 0 || l == 0) && k + abs(l) <= 3)
        waves->ratio = fmax(waves->ratio, power / surroundings(residuals, f));
}

/* The largest of all waves whose harmonics add up to no more than HARMONICS. */
static struct waves waves_of(double residuals[PATTERNS][WIDTH * HEIGHT], bool half)
{
    struct waves waves = {0};
    for (int k = 0; k <= HARMONICS; ++k) {
        for (int l = k - HARMONICS; l <= HARMONICS - k; ++l) {
            struct frequency f = wave(k, l);
            if (k == 0 && l <= 0)
                continue;
            if (!half)
                look_at(residuals, k, l, f, &waves);
            /* Upsampling doubles the periods and mirrors them. */
            for (int mirror = 0; half && mirror < 4; ++mirror)
                look_at(residuals, k, l,
                        (struct frequency){(f.x + mirror % 2) / 2.0, (f.y + mirror / 2) / 2.0},
                        &waves);
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
    vkao_frame_info frame = {.struct_size = sizeof frame};
    picture_init(&p, WIDTH, HEIGHT, VKAO_STAGE_SSAO | VKAO_STAGE_BLUR);
    p.view.depth_encoding = VKAO_DEPTH_VIEW_Z;
    p.view.normal_encoding = VKAO_NORMALS_XYZ_SNORM;
    picture_render_scene(&p, scene, &lens, VK_FORMAT_R32_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT);
    picture_set(&p, SLOT_AO, VK_FORMAT_R32_SFLOAT, NULL);
    check_vkao(vkao_preset(quality, &frame, &p.ssao, &p.blur));
    p.half_resolution = frame.half_resolution;
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
        run_pattern(quality, blurred, patterns[i], scene, residuals[i]);
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
    return waves_of(residuals, quality == VKAO_QUALITY_FAST);
}

/* The functions of the noise that shading is made of, as pictures. */
static void the_noise_is_where_it_is_looked_for(void **state)
{
    (void)state;
    static double gradient[WIDTH * HEIGHT], sequence[WIDTH * HEIGHT];
    for (int n = 1; n <= 3; ++n) {
        for (uint32_t t = 0; t < WIDTH * HEIGHT; ++t) {
            gradient[t] = cos(2.0 * pi * n * ref_gradient_noise(t % WIDTH, t / WIDTH, 0));
            sequence[t] = cos(2.0 * pi * n * ref_r2_noise(t % WIDTH, t / WIDTH, 0));
        }
        double a = rms_of(power_at(gradient, wave(n, 0))) * sqrt(2.0),
               b = rms_of(power_at(sequence, wave(0, n))) * sqrt(2.0);
        print_message("    wave %d: gradient %.3f, sequence %.3f of 1\n", n, a, b);
        assert_true(fabs(a - 1.0) < 0.05 && fabs(b - 1.0) < 0.05);
    }
}

/* In steps of an 8-bit image, root mean square: less than half a step of the noise's own waves, a
 * step of the beats, which may be slower than the blur is wide. Against its surroundings a wave
 * still stands out then, because the blur has weakened both alike. */
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
        print_message("    %-7s %2.0f degrees, mean AO %.2f: own %.2f/255 (noisy %.1f), beats "
                      "%.2f/255 (%.1f), peak to surroundings %.0f (%.0f)\n",
                      names[i % 4], walls[i / 4].degrees, mean_ao, left.own / step,
                      noisy.own / step, left.beat / step, noisy.beat / step, left.ratio,
                      noisy.ratio);
        assert_true(mean_ao < 0.95);
        assert_true(noisy.ratio > 10.0); /* it is looked for in the right places */
        assert_true(left.own <= 0.5 * step);
        assert_true(left.beat <= 1.0 * step);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        gpu_test(the_noise_is_where_it_is_looked_for),
        gpu_test(no_pattern_of_the_noise_is_left_on_a_tilted_wall),
    };
    return fixture_run(tests);
}
