/* SPDX-License-Identifier: MIT
 *
 * What screen-space ambient occlusion is known to get wrong, one test each, for every method.
 * Self-occlusion and the edges of the image are in test_view.c. */
#include "fixture.h"
#include "ref_blur.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

static const char *const names[] = {"sphere", "hemisphere", "hbao", "gtao", "vbao", "raymarch"};
enum { METHODS = sizeof names / sizeof names[0] };

static void make(struct picture *p, int method, vkao_stage_flags stages, uint32_t width,
                 uint32_t height, const struct scene *scene, const struct lens *lens)
{
    picture_init(p, width, height, stages);
    p->view.depth_encoding = VKAO_DEPTH_VIEW_Z;
    p->view.normal_encoding = VKAO_NORMALS_XYZ_SNORM;
    picture_render_scene(p, scene, lens, VK_FORMAT_R32_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT);
    picture_set(p, SLOT_AO, VK_FORMAT_R32_SFLOAT, NULL);
    p->ssao.method = (vkao_ssao_method)method;
}

/* A box three units before a wall, at a reach of half a unit. */
static void objects_far_in_front_cast_no_halo(void **state)
{
    (void)state;
    /* The point methods fade with the difference in depth instead of cutting at the reach. */
    static const double darkest[METHODS] = {0.95, 0.95, 0.998, 0.998, 0.998, 0.998};
    const struct scene scene = {{
        {SHAPE_PLANE, {0.0, 0.0, 5.0}, {0.1, 0.2, -1.0}},
        {SHAPE_BOX, {0.0, 0.0, 1.6}, {0.2, 0.2, 0.2}},
    }};
    struct lens lens = lens_perspective(0.6, 0.45);
    for (int i = 0; i < METHODS * 2; ++i) {
        struct picture p;
        make(&p, i % METHODS, VKAO_STAGE_SSAO, 80, 60, &scene, &lens);
        p.ssao.falloff = (vkao_falloff)(i / METHODS);
        picture_run(&p);
        double worst = 1.0;
        for (size_t t = 0; t < picture_texels(&p); ++t)
            worst = p.values[SLOT_DEPTH][t] > 3.0 ? fmin(worst, p.values[SLOT_AO][t]) : worst;
        print_message("    %-10s falloff %d: darkest texel of the wall %.4f\n", names[i % METHODS],
                      i / METHODS, worst);
        assert_true(worst >= darkest[i % METHODS]);
        picture_free(&p);
    }
}

/* Occlusion beside an edge falls off with the distance: rows of a groove, from its bottom outwards,
 * never darken again. */
static void shades_have_no_bands(void **state)
{
    (void)state;
    const struct scene groove = scene_groove();
    struct lens lens = lens_orthographic(1.6, 1.2);
    for (int method = 0; method < METHODS; ++method) {
        struct picture p;
        double before = 0.0, worst = 0.0, first = 0.0;
        make(&p, method, VKAO_STAGE_SSAO | VKAO_STAGE_BLUR, 128, 96, &groove, &lens);
        p.ssao.radius = 0.8f;
        picture_run(&p);
        for (uint32_t y = 49; y < 96; ++y) {
            double mean = mean_of(&p.values[SLOT_AO][y * 128 + 24], 80);
            first = y == 49 ? mean : first;
            worst = fmax(worst, before - mean);
            before = fmax(before, mean);
        }
        print_message("    %-10s from %.3f, darkens again by %.4f\n", names[method], first, worst);
        assert_true(worst < 0.004 && first < 0.8);
        picture_free(&p);
    }
}

static double rmse_on_wall(const struct picture *p, const struct scene *scene)
{
    struct ref_scene view;
    double square = 0.0;
    size_t count = 0;
    picture_reference_scene(p, &view);
    for (uint32_t y = 6; y < p->height - 6; y += 3) {
        for (uint32_t x = 6; x < p->width - 6; x += 3) {
            size_t i = (size_t)y * p->width + x;
            double at[3];
            if (view.z[i] < 3.8)
                continue;
            ref_view_position(&view.view, x, y, view.z[i], at);
            struct scene_ambient a =
                scene_ambient(scene, at, &view.normals[i * 3], (double)p->ssao.radius, 256);
            square += pow(p->values[SLOT_AO][i] - a.falloff, 2.0);
            ++count;
        }
    }
    ref_scene_free(&view);
    return sqrt(square / (double)count);
}

/* Light passes behind a thin rod. Horizons cannot know. */
static void thin_rods_do_not_darken_what_is_behind(void **state)
{
    (void)state;
    const struct scene scene = {{
        {SHAPE_PLANE, {0.0, 0.0, 4.0}, {0.0, 0.0, -1.0}},
        {SHAPE_BOX, {0.0, 0.0, 3.6}, {0.04, 9.0, 0.04}},
    }};
    struct lens lens = lens_perspective(0.3, 0.225);
    double errors[METHODS];
    for (int method = 0; method < METHODS; ++method) {
        struct picture p;
        make(&p, method, VKAO_STAGE_SSAO | VKAO_STAGE_BLUR, 80, 60, &scene, &lens);
        p.ssao.radius = 1.0f;
        p.ssao.slice_count = 4;
        p.ssao.sample_count = 64;
        picture_run(&p);
        errors[method] = rmse_on_wall(&p, &scene);
        print_message("    %-10s RMSE on the wall %.4f\n", names[method], errors[method]);
        picture_free(&p);
    }
    assert_true(errors[VKAO_SSAO_VBAO] < 0.8 * errors[VKAO_SSAO_HBAO]);
    assert_true(errors[VKAO_SSAO_VBAO] < errors[VKAO_SSAO_GTAO]);
}

/* At 90 of 100 units, where a standard depth buffer has spent its precision. */
static void far_walls_are_open(void **state)
{
    (void)state;
    static const VkFormat formats[] = {VK_FORMAT_D32_SFLOAT, VK_FORMAT_D16_UNORM};
    for (int i = 0; i < METHODS * 2 * 3; ++i) {
        struct picture p;
        struct scene wall = scene_tilted_plane(25.0 * (i / METHODS / 2), 25.0);
        struct lens lens = lens_perspective(0.3, 0.225);
        wall.shapes[0].center[2] = 85.0;
        make(&p, i % METHODS, VKAO_STAGE_SSAO, 64, 48, &wall, &lens);
        p.view.depth_encoding = VKAO_DEPTH_PROJECTED;
        picture_render_scene(&p, &wall, &lens, formats[i / METHODS % 2],
                             VK_FORMAT_R32G32B32A32_SFLOAT);
        p.ssao.radius = 10.0f;
        picture_run(&p);
        for (size_t t = 0; t < picture_texels(&p); ++t) {
            if (!(fabs(p.values[SLOT_AO][t] - 1.0) <= 0.002))
                fail_msg("%s, format %d, %d degrees: texel %zu is %g", names[i % METHODS],
                         (int)formats[i / METHODS % 2], 25 * (i / METHODS / 2), t,
                         p.values[SLOT_AO][t]);
        }
        picture_free(&p);
    }
}

/* Stores a normal that leans towards +x, by so much from the direction to the eye of an
 * orthographic right-handed view. */
static void lean(struct picture *p, size_t texel, double angle)
{
    double *n = &p->values[SLOT_NORMALS][texel * 4];
    n[0] = sin(angle);
    n[1] = 0.0;
    n[2] = cos(angle);
}

static double darkest_of(struct picture *p)
{
    double darkest = 1.0;
    picture_run(p);
    for (size_t t = 0; t < picture_texels(p); ++t) {
        assert_true(!isnan(p->values[SLOT_AO][t]));
        darkest = fmin(darkest, p->values[SLOT_AO][t]);
    }
    return darkest;
}

/* A cylinder made of facets of 12 degrees. It is convex and open; smooth normals over flat facets
 * tilt the tangent plane by up to 6 degrees, and half of a facet seems to rise over it. */
static void facets_under_smooth_normals_hardly_show(void **state)
{
    (void)state;
    static const double darkest[METHODS] = {0.985, 0.998, 0.978, 0.997, 0.993, 0.993};
    const struct scene nothing = {{{SHAPE_NONE, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}}}};
    const double facet = 12.0 * pi / 180.0, radius = 2.0;
    struct lens lens = lens_orthographic(1.6, 1.2);
    for (int i = 0; i < METHODS * 2; ++i) {
        struct picture p;
        const bool smooth = i / METHODS;
        make(&p, i % METHODS, VKAO_STAGE_SSAO | VKAO_STAGE_BLUR, 80, 60, &nothing, &lens);
        p.blur.radius = 4;
        p.blur.normal_power = 8.0f;
        for (size_t t = 0; t < picture_texels(&p); ++t) {
            double x = ((double)(t % p.width) + 0.5) / p.width * 3.2 - 1.6;
            /* the facet whose chord holds x: its middle angle, and the chord's distance from the
             * axis */
            double middle = (floor(asin(x / radius) / facet) + 0.5) * facet,
                   chord = radius * cos(facet / 2.0);
            double along = smooth ? asin(x / radius) : middle;
            p.values[SLOT_DEPTH][t] = 5.0 - (chord - x * sin(middle)) / cos(middle);
            lean(&p, t, along);
        }
        const double worst = darkest_of(&p);
        print_message("    %-10s %s normals: darkest %.4f\n", names[i % METHODS],
                      smooth ? "smooth" : "flat", worst);
        assert_true(worst >= (smooth ? darkest[i % METHODS] : 0.99));
        picture_free(&p);
    }
}

/* Near the outline of a coarse mesh, interpolated normals point away from the eye: here by 15
 * degrees on a wall that is seen at 20 degrees, whose true normal stands at 70. */
static void normals_past_the_outline_do_not_darken(void **state)
{
    (void)state;
    const struct scene nothing = {{{SHAPE_NONE, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}}}};
    const double slope = tan(70.0 * pi / 180.0), shading = 105.0 * pi / 180.0;
    struct lens lens = lens_orthographic(1.6, 1.2);
    for (int method = 0; method < METHODS; ++method) {
        struct picture p;
        make(&p, method, VKAO_STAGE_SSAO, 80, 60, &nothing, &lens);
        for (size_t t = 0; t < picture_texels(&p); ++t) {
            double x = ((double)(t % p.width) + 0.5) / p.width * 3.2 - 1.6;
            p.values[SLOT_DEPTH][t] = 10.0 + x * slope;
            lean(&p, t, shading);
        }
        const double worst = darkest_of(&p);
        print_message("    %-10s darkest %.4f\n", names[method], worst);
        assert_true(worst >= 0.998);
        picture_free(&p);
    }
}

/* Hair far in front of a tilted wall, which is seen through gaps of a texel: in rows, or in rows
 * and columns. The depth image has no plane there; normals have. */
static void walls_behind_thin_things_are_open(void **state)
{
    (void)state;
    const struct scene wall = scene_tilted_plane(40.0, 25.0);
    struct lens lens = lens_perspective(0.6, 0.45);
    const vkao_ssao_method first = VKAO_SSAO_HBAO; /* point methods fade with depth, see above */
    for (int i = (int)first; i < METHODS * 2; ++i) {
        struct picture p;
        if (i % METHODS < (int)first)
            continue;
        make(&p, i % METHODS, VKAO_STAGE_SSAO, 80, 60, &wall, &lens);
        p.ssao.radius = 0.2f;
        for (size_t t = 0; t < picture_texels(&p); ++t) {
            bool is_hair = t % p.width % 4 != 0 || (i >= METHODS && t / p.width % 3 != 0);
            p.values[SLOT_DEPTH][t] = is_hair ? 1.0 : p.values[SLOT_DEPTH][t];
        }
        picture_run(&p);
        double worst = 1.0;
        for (size_t t = 0; t < picture_texels(&p); ++t)
            worst = p.values[SLOT_DEPTH][t] > 1.5 ? fmin(worst, p.values[SLOT_AO][t]) : worst;
        print_message("    %-10s %s: darkest texel of the wall %.4f\n", names[i % METHODS],
                      i < METHODS ? "slits" : "holes", worst);
        assert_true(worst >= 0.998);
        picture_free(&p);
    }
}

/* The sky is open, and a wall before it has an open edge. */
static void the_sky_is_open_and_hides_nothing(void **state)
{
    (void)state;
    const struct scene wall = scene_tilted_plane(0.0, 0.0);
    struct lens lens = lens_perspective(0.6, 0.45);
    for (int i = 0; i < METHODS * 3; ++i) {
        struct picture p;
        make(&p, i % METHODS, VKAO_STAGE_SSAO | VKAO_STAGE_BLUR, 80, 60, &wall, &lens);
        p.half_resolution = i / METHODS == 1;
        p.blur.intensity = 2.0f;
        for (size_t t = 0; t < picture_texels(&p); ++t) {
            bool sky = (t % p.width / 9 + t / p.width / 7) % 2;
            p.values[SLOT_DEPTH][t] =
                sky ? (i / METHODS == 2 ? (double)NAN : (double)INFINITY) : p.values[SLOT_DEPTH][t];
        }
        picture_run(&p);
        for (size_t t = 0; t < picture_texels(&p); ++t) {
            bool sky = (t % p.width / 9 + t / p.width / 7) % 2;
            double ao = p.values[SLOT_AO][t];
            if (!(sky ? ao == 1.0 : ao >= 0.998))
                fail_msg("%s: texel %zu,%zu is %g", names[i % METHODS], t % p.width, t / p.width,
                         ao);
        }
        picture_free(&p);
    }
}

/* Bars of one texel in one plane, before the sky: depth alone says how they face, though none has a
 * neighbour beside it. */
static void lone_columns_face_as_their_rows_do(void **state)
{
    (void)state;
    enum { BARS_EVERY = 4 };
    const struct scene scene = {{{SHAPE_PLANE, {0.0, 0.0, 5.0}, {0.0, 0.0, -1.0}}}};
    const struct lens lens = lens_perspective(0.6, 0.45);
    for (int method = 0; method < METHODS; ++method) {
        struct picture p;
        make(&p, method, VKAO_STAGE_SSAO, 80, 60, &scene, &lens);
        p.view.normal_encoding = VKAO_NORMALS_FROM_DEPTH;
        p.formats[SLOT_NORMALS] = VK_FORMAT_UNDEFINED;
        for (size_t t = 0; t < picture_texels(&p); ++t)
            if (t % p.width % BARS_EVERY != 0)
                p.values[SLOT_DEPTH][t] = (double)INFINITY;
        picture_run(&p);
        double darkest = 1.0;
        for (size_t t = 0; t < picture_texels(&p); ++t)
            darkest = fmin(darkest, p.values[SLOT_AO][t]);
        print_message("    %-10s darkest %.4f\n", names[method], darkest);
        assert_true(darkest >= 0.998);
        picture_free(&p);
    }
}

/* A camera that moves by fractions of a texel must not make the picture breathe. */
static void subpixel_motion_does_not_flicker(void **state)
{
    (void)state;
    static const double limits[METHODS] = {0.004, 0.005, 0.004, 0.004, 0.004, 0.004};
    const struct scene scene = scene_corner();
    for (int method = 0; method < METHODS; ++method) {
        double first = 0.0, worst = 0.0;
        for (int i = 0; i < 5; ++i) {
            struct picture p;
            struct lens lens = lens_perspective(0.6, 0.45);
            double dx = 0.23 * i * 1.2 / 80.0, dy = 0.17 * i * 0.9 / 60.0;
            lens.x0 += dx;
            lens.x1 += dx;
            lens.y0 += dy;
            lens.y1 += dy;
            make(&p, method, VKAO_STAGE_SSAO | VKAO_STAGE_BLUR, 80, 60, &scene, &lens);
            picture_run(&p);
            /* the same part of the scene, to a texel: the mean of the middle */
            double mean = 0.0;
            for (uint32_t y = 10; y < 50; ++y)
                mean += mean_of(&p.values[SLOT_AO][y * 80 + 10], 60) / 40.0;
            first = i ? first : mean;
            worst = fmax(worst, fabs(mean - first));
            picture_free(&p);
        }
        print_message("    %-10s mean AO changes by up to %.5f\n", names[method], worst);
        assert_true(worst < limits[method]);
    }
}

enum { WINDOW = 64 };

/* Power at the frequencies above 8 of 64, of a window of the image in its middle. */
static void spectrum(const double *image, uint32_t width, uint32_t height, double *peak,
                     double *mean)
{
    double real[WINDOW][WINDOW], imaginary[WINDOW][WINDOW];
    uint32_t x0 = (width - WINDOW) / 2, y0 = (height - WINDOW) / 2;
    size_t count = 0;
    for (int v = 0; v < WINDOW; ++v) {
        for (int k = 0; k < WINDOW; ++k) {
            real[v][k] = imaginary[v][k] = 0.0;
            for (int x = 0; x < WINDOW; ++x) {
                /* a raised cosine against the edges of the window */
                double w = (0.5 - 0.5 * cos(2.0 * pi * (x + 0.5) / WINDOW)) *
                           (0.5 - 0.5 * cos(2.0 * pi * (v + 0.5) / WINDOW));
                double s = w * image[(y0 + (uint32_t)v) * width + x0 + (uint32_t)x];
                real[v][k] += s * cos(2.0 * pi * k * x / WINDOW);
                imaginary[v][k] -= s * sin(2.0 * pi * k * x / WINDOW);
            }
        }
    }
    *peak = *mean = 0.0;
    for (int j = 0; j < WINDOW; ++j) {
        for (int k = 0; k < WINDOW; ++k) {
            double re = 0.0, im = 0.0;
            int fx = k <= WINDOW / 2 ? k : WINDOW - k, fy = j <= WINDOW / 2 ? j : WINDOW - j;
            if (fx * fx + fy * fy <= 8 * 8)
                continue;
            for (int y = 0; y < WINDOW; ++y) {
                double c = cos(2.0 * pi * j * y / WINDOW), s = sin(2.0 * pi * j * y / WINDOW);
                re += real[y][k] * c + imaginary[y][k] * s;
                im += imaginary[y][k] * c - real[y][k] * s;
            }
            *peak = fmax(*peak, re * re + im * im);
            *mean += re * re + im * im;
            ++count;
        }
    }
    *mean /= (double)count;
}

/* Noise has a pattern, and the blur must remove it: what it leaves at high frequencies is little,
 * and the largest of them less than half a step of an 8-bit image. The groove's shade varies along
 * y only; its rows' means are taken out. */
static void no_pattern_of_the_noise_is_left(void **state)
{
    (void)state;
    const struct scene groove = scene_groove();
    struct lens lens = lens_orthographic(1.6, 1.2);
    for (int method = 0; method < METHODS; ++method) {
        double peak[2], mean[2];
        for (int blurred = 0; blurred < 2; ++blurred) {
            struct picture p;
            make(&p, method, blurred ? VKAO_STAGE_SSAO | VKAO_STAGE_BLUR : VKAO_STAGE_SSAO, 128, 96,
                 &groove, &lens);
            p.ssao.radius = 0.8f;
            picture_run(&p);
            for (uint32_t y = 0; y < 96; ++y) {
                double row = mean_of(&p.values[SLOT_AO][y * 128], 128);
                for (uint32_t x = 0; x < 128; ++x)
                    p.values[SLOT_AO][y * 128 + x] -= row;
            }
            spectrum(p.values[SLOT_AO], 128, 96, &peak[blurred], &mean[blurred]);
            picture_free(&p);
        }
        /* amplitude of a sine wave whose power under the window is the peak's */
        double amplitude = sqrt(peak[1]) * 2.0 / (WINDOW * WINDOW / 4.0);
        print_message("    %-10s high frequencies: power falls to %.4f, peak to mean %.1f (noisy "
                      "%.1f), amplitude %.4f\n",
                      names[method], mean[1] / mean[0], peak[1] / mean[1], peak[0] / mean[0],
                      amplitude);
        assert_true(peak[0] > 50.0 * mean[0]); /* there is a pattern */
        assert_true(mean[1] < 0.002 * mean[0]);
        assert_true(amplitude < 0.5 / 255.0);
    }
}

/* One slice per texel may lose more than there is. Cutting that off before the blur would brighten
 * the mean. */
static void ao_is_not_clamped_before_the_blur(void **state)
{
    (void)state;
    static const vkao_ssao_method methods[] = {VKAO_SSAO_GTAO, VKAO_SSAO_VBAO};
    const struct scene scene = {{
        {SHAPE_PLANE, {0.0, 0.3, 4.0}, {0.0, -1.0, -0.4}},
        {SHAPE_BOX, {-0.9, 0.0, 4.0}, {0.6, 9.0, 9.0}},
        {SHAPE_BOX, {0.9, 0.0, 4.0}, {0.6, 9.0, 9.0}},
    }};
    struct lens lens = lens_perspective(0.1, 0.075);
    for (int i = 0; i < 2; ++i) {
        struct picture noisy, p;
        struct ref_scene reference;
        make(&noisy, (int)methods[i], VKAO_STAGE_SSAO, 80, 60, &scene, &lens);
        make(&p, (int)methods[i], VKAO_STAGE_SSAO | VKAO_STAGE_BLUR, 80, 60, &scene, &lens);
        p.ssao.radius = noisy.ssao.radius = 4.0f;
        p.ssao.thickness = noisy.ssao.thickness = 8.0f;
        p.ssao.falloff = noisy.ssao.falloff = VKAO_FALLOFF_THRESHOLD;
        picture_run(&noisy);
        picture_run(&p);
        double *want = test_alloc(4800, sizeof *want), *clamped = test_alloc(4800, sizeof *clamped),
               least = 1.0;
        picture_reference_scene(&p, &reference);
        double bias = (double)p.ssao.bias * (double)p.ssao.radius;
        ref_blur(&reference, &p.blur, p.view.normal_encoding, p.values[SLOT_NORMALS],
                 noisy.values[SLOT_AO], bias, want);
        for (size_t t = 0; t < 4800; ++t) {
            least = fmin(least, noisy.values[SLOT_AO][t]);
            noisy.values[SLOT_AO][t] = fmax(0.0, noisy.values[SLOT_AO][t]);
        }
        ref_blur(&reference, &p.blur, p.view.normal_encoding, p.values[SLOT_NORMALS],
                 noisy.values[SLOT_AO], bias, clamped);
        double clamping = difference_of(want, clamped, 4800).mean;
        print_message("    %s: least %.3f, clamping would brighten by %.4f\n", names[methods[i]],
                      least, clamping);
        check_close("blurred", p.values[SLOT_AO], want, 4800, 6e-4, 2e-3,
                    7e-3); /* codes of 1/100 in between */
        assert_true(clamping > 1e-3);
        ref_scene_free(&reference);
        free(want);
        free(clamped);
        picture_free(&noisy);
        picture_free(&p);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        gpu_test(objects_far_in_front_cast_no_halo),
        gpu_test(shades_have_no_bands),
        gpu_test(thin_rods_do_not_darken_what_is_behind),
        gpu_test(far_walls_are_open),
        gpu_test(facets_under_smooth_normals_hardly_show),
        gpu_test(normals_past_the_outline_do_not_darken),
        gpu_test(walls_behind_thin_things_are_open),
        gpu_test(the_sky_is_open_and_hides_nothing),
        gpu_test(lone_columns_face_as_their_rows_do),
        gpu_test(subpixel_motion_does_not_flicker),
        gpu_test(no_pattern_of_the_noise_is_left),
        gpu_test(ao_is_not_clamped_before_the_blur),
    };
    return fixture_run(tests);
}
