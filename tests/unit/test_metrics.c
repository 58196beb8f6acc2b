/* SPDX-License-Identifier: MIT
 *
 * The measures of error, against numbers worked out by hand and against SSIM as it is defined; and
 * what is made of the times of many runs. */
#include "metrics.h"
#include "runs.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

enum { WIDTH = 11, HEIGHT = 9, TEXELS = WIDTH * HEIGHT };

static void expect_near(double value, double wanted)
{
    if (fabs(value - wanted) > 1e-6)
        fail_msg("%.9g, want %.9g", value, wanted);
}

static struct error_scores compare(const struct image_pair *pair)
{
    struct error_scores scores;
    struct tool_error err = {0};
    assert_true(metrics_compare(pair, &scores, &err));
    return scores;
}

/* Something without symmetries, in [0,1]. */
static void fill(float *image, unsigned seed)
{
    uint32_t state = seed;
    for (size_t i = 0; i < TEXELS; i++) {
        state = state * 1664525u + 1013904223u;
        image[i] = (float)(state >> 8) / 16777216.0f;
    }
}

/* One window, texel by texel, with means first and variances around them. */
static double window(const float *x, const float *y, int column, int row)
{
    double mx = 0, my = 0, vx = 0, vy = 0, cov = 0;
    for (int pass = 0; pass < 2; pass++) {
        for (int j = row - 3; j <= row + 3; j++) {
            for (int i = column - 3; i <= column + 3; i++) {
                int u = i < 0 ? 0 : i >= WIDTH ? WIDTH - 1 : i;
                int v = j < 0 ? 0 : j >= HEIGHT ? HEIGHT - 1 : j;
                double a = (double)x[v * WIDTH + u], b = (double)y[v * WIDTH + u];
                if (pass == 0) {
                    mx += a / 49;
                    my += b / 49;
                } else {
                    vx += (a - mx) * (a - mx) / 49;
                    vy += (b - my) * (b - my) / 49;
                    cov += (a - mx) * (b - my) / 49;
                }
            }
        }
    }
    return (2 * mx * my + 1e-4) * (2 * cov + 9e-4) /
           ((mx * mx + my * my + 1e-4) * (vx + vy + 9e-4));
}

static void errors_of_four_texels_are_those_worked_out_by_hand(void **state)
{
    static const float result[] = {0.5f, 0.25f, 1.0f, 0.0f}, truth[] = {0.25f, 0.5f, 0.5f, 0.0f};
    const struct image_pair pair = {.width = 4, .height = 1, .result = result, .truth = truth};
    (void)state;
    struct error_scores s = compare(&pair); /* errors .25, -.25, .5, 0 */
    expect_near(s.rmse, sqrt(0.375 / 4));
    expect_near(s.mae, 0.25);
    expect_near(s.bias, 0.125);
    expect_near(s.p99, 0.25 + 0.25 * 0.97); /* rank 2.97 of 0 .25 .25 .5 */
    assert_int_equal(s.texels, 4);
    expect_near(metrics_rmse(&pair), s.rmse);
}

static void equal_images_have_no_error_and_ssim_one(void **state)
{
    float image[TEXELS];
    (void)state;
    fill(image, 1);
    struct error_scores s = compare(
        &(struct image_pair){.width = WIDTH, .height = HEIGHT, .result = image, .truth = image});
    expect_near(s.rmse, 0);
    expect_near(s.mae, 0);
    expect_near(s.p99, 0);
    expect_near(s.ssim, 1);
}

static void ssim_of_two_constants_follows_from_their_means(void **state)
{
    float a[TEXELS], b[TEXELS];
    (void)state;
    for (size_t i = 0; i < TEXELS; i++) {
        a[i] = 0.5f;
        b[i] = 1.0f;
    }
    struct error_scores s =
        compare(&(struct image_pair){.width = WIDTH, .height = HEIGHT, .result = a, .truth = b});
    expect_near(s.ssim, (1.0 + 1e-4) / (1.25 + 1e-4));
    expect_near(s.bias, -0.5);
}

static void ssim_equals_its_definition_window_by_window(void **state)
{
    float x[TEXELS], y[TEXELS];
    uint8_t mask[TEXELS];
    double sum = 0;
    size_t counted = 0;
    (void)state;
    fill(x, 7);
    fill(y, 12);
    for (size_t i = 0; i < TEXELS; i++) {
        y[i] = 0.5f * (x[i] + y[i]); /* some likeness */
        mask[i] = i % 5 != 0;
    }
    for (int row = 0; row < HEIGHT; row++) {
        for (int column = 0; column < WIDTH; column++) {
            if (!mask[row * WIDTH + column])
                continue;
            sum += window(x, y, column, row);
            counted++;
        }
    }
    struct error_scores s = compare(&(struct image_pair){
        .width = WIDTH, .height = HEIGHT, .result = x, .truth = y, .mask = mask});
    assert_int_equal(s.texels, counted);
    expect_near(s.ssim, sum / (double)counted);
    assert_true(s.ssim > 0.1 && s.ssim < 0.99);
}

static void masked_texels_do_not_count(void **state)
{
    static const float result[] = {0.5f, 0.0f, 0.75f}, truth[] = {0.25f, 1.0f, 0.5f};
    static const uint8_t mask[] = {1, 0, 1}, none[] = {0, 0, 0};
    struct image_pair pair = {
        .width = 3, .height = 1, .result = result, .truth = truth, .mask = mask};
    (void)state;
    struct error_scores s = compare(&pair);
    expect_near(s.rmse, 0.25);
    expect_near(s.bias, 0.25);
    expect_near(s.p99, 0.25);
    assert_int_equal(s.texels, 2);
    pair.mask = none;
    s = compare(&pair);
    assert_int_equal(s.texels, 0);
    expect_near(s.rmse, 0);
    expect_near(s.ssim, 0);
}

static void not_a_number_is_an_error_of_its_own_size(void **state)
{
    static const float result[] = {NAN, 1.0f}, truth[] = {1.0f, 1.0f};
    (void)state;
    struct error_scores s =
        compare(&(struct image_pair){.width = 2, .height = 1, .result = result, .truth = truth});
    expect_near(s.mae, 4);
    assert_true(isfinite(s.ssim));
}

static void quantiles_lie_between_ranks(void **state)
{
    float values[] = {4, 1, 3, 2};
    (void)state;
    expect_near(metrics_quantile(values, 4, 0.5), 2.5);
    expect_near(metrics_quantile(values, 4, 0), 1);
    expect_near(metrics_quantile(values, 4, 1), 4);
    expect_near(metrics_quantile(values, 1, 0.99), 1);
    expect_near(metrics_quantile(values, 0, 0.5), 0);
}

static void medians_leave_out_what_is_no_number(void **state)
{
    static const float some[] = {NAN, 3, 1, NAN, 2}, none[] = {NAN, NAN};
    (void)state;
    expect_near(runs_median(some, 5), 2);
    expect_near(runs_median(some, 3), 2);
    assert_true(isnan(runs_median(none, 2)));
    assert_true(isnan(runs_median(some, 0)));
}

static void ratios_are_of_the_same_run(void **state)
{
    static const float ours[] = {2, 9, 12, 5}, theirs[] = {1, 3, 3, 0},
                       missing[] = {NAN, 0, NAN, 1};
    (void)state;
    expect_near(runs_ratio(ours, theirs, 4),
                3); /* of 2, 3 and 4; the ratio of the medians is 3.5 */
    expect_near(runs_ratio(ours, missing, 4), 5);
    assert_true(isnan(runs_ratio(ours, missing, 3)));
}

static void times_are_printed_with_four_digits(void **state)
{
    static const struct {
        double ms;
        const char *text;
    } rows[] = {{0.01234, "0.0123"}, {0.5, "0.500"}, {12.345, "12.35"}, {123.45, "123.5"},
                {1234.5, "1234"},    {0, "-"},       {NAN, "-"}};
    char text[32];
    (void)state;
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        runs_format_ms(rows[i].ms, text, sizeof text);
        assert_string_equal(text, rows[i].text);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(errors_of_four_texels_are_those_worked_out_by_hand),
        cmocka_unit_test(equal_images_have_no_error_and_ssim_one),
        cmocka_unit_test(ssim_of_two_constants_follows_from_their_means),
        cmocka_unit_test(ssim_equals_its_definition_window_by_window),
        cmocka_unit_test(masked_texels_do_not_count),
        cmocka_unit_test(not_a_number_is_an_error_of_its_own_size),
        cmocka_unit_test(quantiles_lie_between_ranks),
        cmocka_unit_test(medians_leave_out_what_is_no_number),
        cmocka_unit_test(ratios_are_of_the_same_run),
        cmocka_unit_test(times_are_printed_with_four_digits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
