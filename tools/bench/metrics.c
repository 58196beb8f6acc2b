/* SPDX-License-Identifier: MIT */
#include "metrics.h"

#include <math.h>
#include <stdlib.h>

enum { WINDOW_REACH = 3 };

/* What the windows of SSIM sum up. */
enum moment { SUM_X, SUM_Y, SUM_XX, SUM_YY, SUM_XY, MOMENTS };

static int compare_floats(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return x < y ? -1 : x > y;
}

double metrics_quantile(float *values, size_t count, double q)
{
    if (count == 0)
        return 0;
    qsort(values, count, sizeof *values, compare_floats);
    double rank = q * (double)(count - 1);
    size_t low = (size_t)rank;
    size_t high = low + 1 < count ? low + 1 : low;
    double part = rank - (double)low;
    return (double)values[low] * (1.0 - part) + (double)values[high] * part;
}

static double finite_result(const struct image_pair *p, size_t texel)
{
    return isfinite(p->result[texel]) ? (double)p->result[texel] : 9.0;
}

double metrics_error(const struct image_pair *p, size_t texel)
{
    return finite_result(p, texel) - (double)p->truth[texel];
}

static bool counts(const struct image_pair *p, size_t texel)
{
    return !p->mask || p->mask[texel];
}

double metrics_rmse(const struct image_pair *p)
{
    size_t texels = (size_t)p->width * p->height, counted = 0;
    double sum = 0;
    for (size_t i = 0; i < texels; i++) {
        if (!counts(p, i))
            continue;
        double error = metrics_error(p, i);
        sum += error * error;
        counted++;
    }
    return counted ? sqrt(sum / (double)counted) : 0.0;
}

static size_t clamp_index(size_t centre, size_t offset, size_t size)
{
    size_t at = centre + offset;
    if (at < WINDOW_REACH)
        return 0;
    at -= WINDOW_REACH;
    return at < size ? at : size - 1;
}

/* The moments of the seven texels of each column around a row; columns holds width * MOMENTS. */
static void sum_columns(const struct image_pair *p, size_t row, double *columns)
{
    for (size_t x = 0; x < p->width; x++) {
        double *sum = columns + x * MOMENTS;
        for (int m = 0; m < MOMENTS; m++)
            sum[m] = 0;
        for (size_t k = 0; k <= 2 * WINDOW_REACH; k++) {
            size_t texel = clamp_index(row, k, p->height) * p->width + x;
            double a = finite_result(p, texel), b = (double)p->truth[texel];
            sum[SUM_X] += a;
            sum[SUM_Y] += b;
            sum[SUM_XX] += a * a;
            sum[SUM_YY] += b * b;
            sum[SUM_XY] += a * b;
        }
    }
}

static double window_ssim(const double *columns, size_t x, size_t width)
{
    static const double c1 = 0.01 * 0.01, c2 = 0.03 * 0.03;
    const double area = (2 * WINDOW_REACH + 1) * (2 * WINDOW_REACH + 1);
    double m[MOMENTS] = {0};
    for (size_t k = 0; k <= 2 * WINDOW_REACH; k++)
        for (int i = 0; i < MOMENTS; i++)
            m[i] += columns[clamp_index(x, k, width) * MOMENTS + (size_t)i] / area;
    double mean_product = m[SUM_X] * m[SUM_Y];
    double squares = m[SUM_X] * m[SUM_X] + m[SUM_Y] * m[SUM_Y];
    double covariance = m[SUM_XY] - mean_product, variances = m[SUM_XX] + m[SUM_YY] - squares;
    return (2 * mean_product + c1) * (2 * covariance + c2) / ((squares + c1) * (variances + c2));
}

static bool mean_ssim(const struct image_pair *p, double *ssim, struct tool_error *err)
{
    double sum = 0;
    size_t counted = 0;
    double *columns = calloc(p->width, MOMENTS * sizeof *columns);
    if (!columns)
        return fail(err, EXIT_MEMORY, "out of memory for %u texels", p->width);
    for (size_t y = 0; y < p->height; y++) {
        sum_columns(p, y, columns);
        for (size_t x = 0; x < p->width; x++) {
            if (!counts(p, y * p->width + x))
                continue;
            sum += window_ssim(columns, x, p->width);
            counted++;
        }
    }
    free(columns);
    *ssim = counted ? sum / (double)counted : 0.0;
    return true;
}

bool metrics_compare(const struct image_pair *p, struct error_scores *scores,
                     struct tool_error *err)
{
    size_t texels = (size_t)p->width * p->height, counted = 0;
    double sum = 0, absolute = 0;
    *scores = (struct error_scores){0};
    float *errors = malloc((texels ? texels : 1) * sizeof *errors);
    if (!errors)
        return fail(err, EXIT_MEMORY, "out of memory for %zu texels", texels);
    for (size_t i = 0; i < texels; i++) {
        if (!counts(p, i))
            continue;
        double error = metrics_error(p, i);
        sum += error;
        absolute += fabs(error);
        errors[counted++] = (float)fabs(error);
    }
    scores->p99 = metrics_quantile(errors, counted, 0.99);
    free(errors);
    scores->texels = counted;
    if (counted == 0)
        return true;
    scores->rmse = metrics_rmse(p);
    scores->mae = absolute / (double)counted;
    scores->bias = sum / (double)counted;
    return mean_ssim(p, &scores->ssim, err);
}
