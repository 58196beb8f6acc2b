/* SPDX-License-Identifier: MIT */
#include "lens.h"

#include <math.h>
#include <string.h>

struct lens lens_perspective(double half_width, double half_height)
{
    return (struct lens){false, -half_width, half_width, -half_height, half_height, 0.1,
                         100.0, false,       -1.0,       0.0,          0.0};
}

struct lens lens_orthographic(double half_width, double half_height)
{
    return (struct lens){true,  -half_width, half_width, -half_height, half_height, 0.1,
                         100.0, false,       -1.0,       0.0,          0.0};
}

/* Device depth is a + b / z in perspective, a + b z in orthographic views: 0 and 1 at the two
 * planes. */
static void plane_terms(const struct lens *lens, double *a, double *b)
{
    double n = lens->reversed ? lens->far : lens->near, f = lens->reversed ? lens->near : lens->far;
    if (lens->orthographic) {
        *b = 1.0 / (f - n);
        *a = -n * *b;
    } else if (isinf(f)) {
        *a = 1.0;
        *b = -n;
    } else if (isinf(n)) {
        *a = 0.0;
        *b = f;
    } else {
        *a = f / (f - n);
        *b = -n * f / (f - n);
    }
}

/* The same in the viewport's range. */
static void depth_terms(const struct lens *lens, double *a, double *b)
{
    plane_terms(lens, a, b);
    if (lens->depth_min != 0.0 || lens->depth_max != 0.0) {
        *a = lens->depth_min + *a * (lens->depth_max - lens->depth_min);
        *b *= lens->depth_max - lens->depth_min;
    }
}

void lens_matrix(const struct lens *lens, float matrix[16])
{
    double a, b, m[16] = {0.0};
    double x_scale = 2.0 / (lens->x1 - lens->x0), y_scale = 2.0 / (lens->y1 - lens->y0);
    double x_offset = -(lens->x1 + lens->x0) / (lens->x1 - lens->x0);
    double y_offset = -(lens->y1 + lens->y0) / (lens->y1 - lens->y0);
    depth_terms(lens, &a, &b);
    m[0] = x_scale;
    m[5] = y_scale;
    if (lens->orthographic) {
        m[10] = b * lens->forward;
        m[12] = x_offset;
        m[13] = y_offset;
        m[14] = a;
        m[15] = 1.0;
    } else {
        m[8] = x_offset * lens->forward;
        m[9] = y_offset * lens->forward;
        m[10] = a * lens->forward;
        m[11] = lens->forward;
        m[14] = b;
    }
    for (int i = 0; i < 16; ++i)
        matrix[i] = (float)m[i];
}

double lens_encode(const struct lens *lens, vkao_depth_encoding encoding, double x, double y,
                   double z)
{
    double a, b;
    double ray_x = lens->x0 + (lens->x1 - lens->x0) * (x + 1.0) / 2.0;
    double ray_y = lens->y0 + (lens->y1 - lens->y0) * (y + 1.0) / 2.0;
    switch (encoding) {
    case VKAO_DEPTH_VIEW_Z:
        return z;
    case VKAO_DEPTH_INVERSE_Z:
        return 1.0 / z;
    case VKAO_DEPTH_DISTANCE:
        return lens->orthographic ? z : z * sqrt(1.0 + ray_x * ray_x + ray_y * ray_y);
    default:
        depth_terms(lens, &a, &b);
        if (isinf(z))
            return lens->reversed != (lens->depth_min > lens->depth_max) ? 0.0 : 1.0;
        return lens->orthographic ? a + b * z : a + b / z;
    }
}
