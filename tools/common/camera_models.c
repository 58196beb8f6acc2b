/* SPDX-License-Identifier: MIT
 *
 * Models of depth: the normals that samples have by them. Most of the time of an estimate is spent
 * here, so that samples are taken by chunks. */
#include "camera_fit_internal.h"

#include <string.h>

/* --- Kinds --- */

bool fit_model_is_ortho(enum fit_model model)
{
    return model == FIT_ORTHO || model == FIT_ORTHO_REVERSED || model == FIT_ORTHO_TONED ||
           model == FIT_ORTHO_EXPONENTIAL;
}

enum fit_model fit_model_without_offset(enum fit_model model)
{
    return model == FIT_RADIAL_NEAR || model == FIT_RADIAL_NORMALIZED ? FIT_RADIAL
           : model == FIT_PLANAR_NORMALIZED                           ? FIT_PLANAR
           : model == FIT_DEVICE                                      ? FIT_INVERSE
                                                                      : model;
}

const char *fit_model_name(enum fit_model model)
{
    static const char *const names[FIT_MODELS] = {
        [FIT_PLANAR] = "planar",
        [FIT_RADIAL] = "radial",
        [FIT_RADIAL_NEAR] = "radial from a near plane",
        [FIT_INVERSE] = "inverse",
        [FIT_INVERSE_RADIAL] = "inverse radial",
        [FIT_ORTHO] = "orthographic",
        [FIT_DEVICE] = "device",
        [FIT_PLANAR_NORMALIZED] = "normalized planar",
        [FIT_PLANAR_REVERSED] = "reversed planar",
        [FIT_RADIAL_NORMALIZED] = "normalized radial",
        [FIT_ORTHO_REVERSED] = "reversed orthographic",
        [FIT_TONED] = "toned",
        [FIT_EXPONENTIAL] = "exponential",
        [FIT_ORTHO_TONED] = "toned orthographic",
        [FIT_ORTHO_EXPONENTIAL] = "exponential orthographic",
    };
    return names[model];
}

void fit_model_range(const struct fit_samples *s, enum fit_model model, double *low, double *high)
{
    const bool ortho = fit_model_is_ortho(model);
    *low = ortho ? s->log_slope - 4.0 : log(tan(PI / 180.0));
    *high = ortho ? s->log_slope + 4.0 : log(tan(80.0 * PI / 180.0));
}

/* --- Distances --- */

/* What of a model's parameters all samples share. */
struct shape {
    enum fit_model model;
    double k, height, step_y, c;
};

static struct shape shape_of(const struct fit_samples *s, const struct fit_solution *at)
{
    const double height = fabs(at->p[FIT_LN_A]) > 0 ? exp(at->p[FIT_LN_A]) : 1.0;
    return (struct shape){.model = at->model,
                          .k = exp(at->p[FIT_LN_K]),
                          .height = height,
                          .step_y = s->step_y * height,
                          .c = at->p[FIT_C]};
}

/* As fmax, which is a call. */
static double at_least(double x, double least)
{
    return x > least ? x : least;
}

/* z of what was squeezed; c: median of depth over the value that it nears far away. */
static void unsqueeze(const struct fit_samples *s, const struct shape *shape,
                      const double d[FIT_CHUNK], double z[FIT_CHUNK])
{
    const bool is_toned = shape->model == FIT_TONED || shape->model == FIT_ORTHO_TONED;
    const double c = shape->c;
    for (int i = 0; i < FIT_CHUNK; i++) {
        const double left = at_least(1.0 - c * d[i] / s->median, 1e-3);
        z[i] = is_toned ? d[i] / left : fabs(c) > 1e-9 ? -log(left) / c * s->median : d[i];
    }
}

static bool is_radial(enum fit_model model)
{
    return model == FIT_RADIAL || model == FIT_RADIAL_NEAR || model == FIT_RADIAL_NORMALIZED ||
           model == FIT_INVERSE_RADIAL;
}

/* 1/z of stored values at x and y. Each loop is one that compilers turn into vectors. */
static void invert(const struct fit_samples *s, const struct shape *shape,
                   const double d[FIT_CHUNK], const double x[FIT_CHUNK], const double y[FIT_CHUNK],
                   double w[FIT_CHUNK])
{
    const double least = 1e-6 * s->median, c = shape->c, offset = c * s->median;
    const double k2 = shape->k * shape->k;
    double stretch[FIT_CHUNK]; /* length of the ray with z = 1 */
    if (is_radial(shape->model))
        for (int i = 0; i < FIT_CHUNK; i++)
            stretch[i] = sqrt(1.0 + k2 * (x[i] * x[i] + y[i] * y[i]));
    switch (shape->model) {
    case FIT_RADIAL:
        for (int i = 0; i < FIT_CHUNK; i++)
            w[i] = stretch[i] / d[i];
        break;
    case FIT_RADIAL_NEAR:
        for (int i = 0; i < FIT_CHUNK; i++)
            w[i] = stretch[i] / at_least(d[i] + offset * stretch[i], least * stretch[i]);
        break;
    case FIT_INVERSE:
        memcpy(w, d, FIT_CHUNK * sizeof *w);
        break;
    case FIT_INVERSE_RADIAL:
        for (int i = 0; i < FIT_CHUNK; i++)
            w[i] = stretch[i] * d[i];
        break;
    case FIT_DEVICE:
        for (int i = 0; i < FIT_CHUNK; i++)
            w[i] = s->median > c ? d[i] - c : c - d[i];
        break;
    case FIT_PLANAR_NORMALIZED:
        for (int i = 0; i < FIT_CHUNK; i++)
            w[i] = 1.0 / at_least(d[i] + offset, least);
        break;
    case FIT_PLANAR_REVERSED:
        for (int i = 0; i < FIT_CHUNK; i++)
            w[i] = 1.0 / at_least(c - d[i], 1e-6);
        break;
    case FIT_RADIAL_NORMALIZED:
        for (int i = 0; i < FIT_CHUNK; i++)
            w[i] = stretch[i] / at_least(d[i] + offset, least * stretch[i]);
        break;
    case FIT_TONED:
        for (int i = 0; i < FIT_CHUNK; i++)
            w[i] = at_least(1.0 / d[i] - c / s->median, 1e-3 / s->median);
        break;
    case FIT_EXPONENTIAL:
        unsqueeze(s, shape, d, w);
        for (int i = 0; i < FIT_CHUNK; i++)
            w[i] = 1.0 / w[i];
        break;
    default:
        for (int i = 0; i < FIT_CHUNK; i++)
            w[i] = 1.0 / d[i];
    }
}

/* --- Normals --- */

struct chunk {
    double x[FIT_CHUNK], y[FIT_CHUNK], z[FIT_CHUNK];
};

static void ortho_normals(const struct fit_samples *s, const struct shape *shape,
                          const struct fit_columns *columns, struct chunk *n)
{
    const bool squeezed = shape->model == FIT_ORTHO_TONED || shape->model == FIT_ORTHO_EXPONENTIAL;
    const double sign = shape->model == FIT_ORTHO_REVERSED ? -1.0 : 1.0;
    const double per_x = sign * 0.5 / s->step_x, per_y = sign * 0.5 / shape->step_y;
    double z[5][FIT_CHUNK];
    for (int k = 1; k < 5; k++) {
        memcpy(z[k], columns->d[k], sizeof z[k]);
        if (squeezed)
            unsqueeze(s, shape, columns->d[k], z[k]);
    }
    for (int i = 0; i < FIT_CHUNK; i++) {
        n->x[i] = (z[2][i] - z[1][i]) * per_x;
        n->y[i] = (z[4][i] - z[3][i]) * per_y;
        n->z[i] = shape->k;
    }
}

/* Places of a chunk, from the principal point. */
static void place(const struct fit_columns *columns, const struct shape *shape,
                  const double p[FIT_SHAPE], double x[FIT_CHUNK], double y[FIT_CHUNK])
{
    for (int i = 0; i < FIT_CHUNK; i++) {
        x[i] = columns->x[i] - p[FIT_CX];
        y[i] = columns->y[i] * shape->height - p[FIT_CY];
    }
}

static void perspective_normals(const struct fit_samples *s, const struct shape *shape,
                                const double p[FIT_SHAPE], const struct fit_columns *columns,
                                struct chunk *n)
{
    const double per_x = 0.5 / s->step_x, per_y = 0.5 / shape->step_y;
    const double step_x = s->step_x, step_y = shape->step_y;
    double x[FIT_CHUNK], y[FIT_CHUNK], left[FIT_CHUNK], right[FIT_CHUNK], below[FIT_CHUNK],
        above[FIT_CHUNK], w[5][FIT_CHUNK];
    place(columns, shape, p, x, y);
    for (int i = 0; i < FIT_CHUNK; i++) {
        left[i] = x[i] - step_x;
        right[i] = x[i] + step_x;
        below[i] = y[i] - step_y;
        above[i] = y[i] + step_y;
    }
    invert(s, shape, columns->d[0], x, y, w[0]);
    invert(s, shape, columns->d[1], left, y, w[1]);
    invert(s, shape, columns->d[2], right, y, w[2]);
    invert(s, shape, columns->d[3], x, below, w[3]);
    invert(s, shape, columns->d[4], x, above, w[4]);
    for (int i = 0; i < FIT_CHUNK; i++) {
        const double w_x = (w[2][i] - w[1][i]) * per_x, w_y = (w[4][i] - w[3][i]) * per_y;
        n->x[i] = -w_x;
        n->y[i] = -w_y;
        n->z[i] = shape->k * (w[0][i] - x[i] * w_x - y[i] * w_y);
    }
}

/* Samples of a chunk, which has fewer at the end. */
static size_t chunk_size(const struct fit_samples *s, size_t first)
{
    return s->count - first < FIT_CHUNK ? s->count - first : FIT_CHUNK;
}

void fit_find_normals(const struct fit_samples *s, const struct fit_solution *at,
                      struct vec3 *normals)
{
    const struct shape shape = shape_of(s, at);
    for (size_t first = 0; first < s->count; first += FIT_CHUNK) {
        const struct fit_columns *columns = &s->columns[first / FIT_CHUNK];
        const size_t size = chunk_size(s, first);
        struct chunk n;
        double per_length[FIT_CHUNK];
        if (fit_model_is_ortho(at->model))
            ortho_normals(s, &shape, columns, &n);
        else
            perspective_normals(s, &shape, at->p, columns, &n);
        for (int i = 0; i < FIT_CHUNK; i++) {
            const double length2 = n.x[i] * n.x[i] + n.y[i] * n.y[i] + n.z[i] * n.z[i];
            per_length[i] = 1.0 / at_least(sqrt(length2), 1e-30);
        }
        for (size_t i = 0; i < size; i++)
            normals[first + i] = scale(vec3(n.x[i], n.y[i], n.z[i]), per_length[i]);
    }
}

void fit_find_scales(const struct fit_samples *s, const struct fit_solution *at, double *scales)
{
    const struct shape shape = shape_of(s, at);
    for (size_t first = 0; first < s->count; first += FIT_CHUNK) {
        const struct fit_columns *columns = &s->columns[first / FIT_CHUNK];
        const size_t size = chunk_size(s, first);
        double x[FIT_CHUNK], y[FIT_CHUNK], w[FIT_CHUNK];
        place(columns, &shape, at->p, x, y);
        invert(s, &shape, columns->d[0], x, y, w);
        for (size_t i = 0; i < size; i++)
            scales[first + i] =
                fit_model_is_ortho(at->model) ? shape.k : shape.k / at_least(w[i], 1e-30);
    }
}
