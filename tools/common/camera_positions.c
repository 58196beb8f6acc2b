/* SPDX-License-Identifier: MIT
 *
 * Hartley and Zisserman, Multiple View Geometry, 7.1: p1.Q - x p3.Q = 0 and p2.Q - y p3.Q = 0 for
 * the rows p of the camera and points Q at (x, y), by the smallest eigenvector; trimmed, since
 * filtered edges lie on no surface. Image plane as in camera_fit_internal.h. */
#include "camera_positions.h"

#include "median.h"
#include "vec3.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_POINTS = 20000, LEAST_POINTS = 20, ROUNDS = 6, UNKNOWNS = 12 };

struct point {
    double q[4]; /* centred and scaled, 1 */
    double x, y;
    double perspective, parallel; /* residuals, in the unit of x */
    bool is_in;
};

struct cloud {
    struct point *points;
    size_t count;
    double centre[3], size;
    double texel; /* in the unit of x */
};

bool positions_are_there(const float position[3])
{
    const double x = (double)position[0], y = (double)position[1], z = (double)position[2];
    const double sum = fabs(x) + fabs(y) + fabs(z);
    return sum > 0 && sum < 9.9e6;
}

/* --- Points --- */

static void place(const struct positions *p, uint32_t column, uint32_t row, double *x, double *y)
{
    const double width = (double)p->display_window.x_max - p->display_window.x_min + 1.0;
    const double height = (double)p->display_window.y_max - p->display_window.y_min + 1.0;
    const double left = (double)p->data_window.x_min - p->display_window.x_min;
    const double top = (double)p->data_window.y_min - p->display_window.y_min;
    *x = (column + left + 0.5) * 2.0 / width - 1.0;
    *y = (height / 2.0 - (row + top + 0.5)) * 2.0 / width / p->pixel_aspect;
}

static uint32_t step_of(const struct positions *p)
{
    uint32_t step = 1;
    while ((uint64_t)(p->width / step + 1) * (p->height / step + 1) > MOST_POINTS)
        step++;
    return step;
}

static void normalise(struct cloud *c)
{
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        for (size_t i = 0; i < c->count; i++)
            c->centre[k] += c->points[i].q[k] / (double)c->count;
        for (size_t i = 0; i < c->count; i++) {
            c->points[i].q[k] -= c->centre[k];
            sum += c->points[i].q[k] * c->points[i].q[k];
        }
    }
    c->size = sqrt(sum / (double)(c->count ? c->count : 1));
    for (size_t i = 0; i < c->count; i++)
        for (int k = 0; k < 3; k++)
            c->points[i].q[k] /= fmax(c->size, 1e-30);
}

static bool collect(const struct positions *p, struct cloud *c)
{
    const uint32_t step = step_of(p);
    const size_t most = (size_t)(p->width / step + 1) * (p->height / step + 1);
    *c = (struct cloud){.points = malloc(most * sizeof *c->points)};
    if (!c->points)
        return false;
    c->texel = 2.0 / ((double)p->display_window.x_max - p->display_window.x_min + 1.0);
    for (uint32_t row = 0; row < p->height; row += step)
        for (uint32_t column = 0; column < p->width; column += step) {
            const float *v = p->values + ((size_t)row * p->width + column) * 4;
            if (!positions_are_there(v))
                continue;
            struct point *point = &c->points[c->count++];
            *point =
                (struct point){.q = {(double)v[0], (double)v[1], (double)v[2], 1.0}, .is_in = true};
            place(p, column, row, &point->x, &point->y);
        }
    normalise(c);
    return true;
}

/* --- Linear algebra --- */

/* Jacobi: the eigenvector of the smallest eigenvalue of a symmetric matrix, which is destroyed. */
static double smallest(double a[UNKNOWNS][UNKNOWNS], int n, double vector[UNKNOWNS])
{
    double v[UNKNOWNS][UNKNOWNS] = {{0}};
    int least = 0;
    for (int i = 0; i < n; i++)
        v[i][i] = 1.0;
    for (int sweep = 0; sweep < 60; sweep++) {
        double off = 0, on = 0;
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++)
                *(i == j ? &on : &off) += a[i][j] * a[i][j];
        if (off <= 1e-30 * on)
            break;
        for (int i = 0; i < n - 1; i++)
            for (int j = i + 1; j < n; j++) {
                if (!(fabs(a[i][j]) > 0))
                    continue;
                const double tau = (a[j][j] - a[i][i]) / (2.0 * a[i][j]);
                const double t = copysign(1.0, tau) / (fabs(tau) + sqrt(1.0 + tau * tau));
                const double c = 1.0 / sqrt(1.0 + t * t), s = c * t;
                for (int k = 0; k < n; k++) {
                    const double x = a[k][i], y = a[k][j];
                    a[k][i] = c * x - s * y;
                    a[k][j] = s * x + c * y;
                }
                for (int k = 0; k < n; k++) {
                    const double x = a[i][k], y = a[j][k];
                    a[i][k] = c * x - s * y;
                    a[j][k] = s * x + c * y;
                }
                for (int k = 0; k < n; k++) {
                    const double x = v[k][i], y = v[k][j];
                    v[k][i] = c * x - s * y;
                    v[k][j] = s * x + c * y;
                }
            }
    }
    for (int i = 1; i < n; i++)
        if (a[i][i] < a[least][least])
            least = i;
    for (int k = 0; k < n; k++)
        vector[k] = v[k][least];
    return a[least][least];
}

static void add_row(double a[UNKNOWNS][UNKNOWNS], const double row[UNKNOWNS])
{
    for (int i = 0; i < UNKNOWNS; i++)
        for (int j = 0; fabs(row[i]) > 0 && j < UNKNOWNS; j++)
            a[i][j] += row[i] * row[j];
}

static double dot4(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

/* Rows of the camera, [3][4]; a point's third coordinate is positive. */
static void solve_perspective(const struct cloud *c, double m[UNKNOWNS])
{
    double a[UNKNOWNS][UNKNOWNS] = {{0}};
    size_t behind = 0;
    for (size_t i = 0; i < c->count; i++) {
        const struct point *p = &c->points[i];
        double x[UNKNOWNS] = {0}, y[UNKNOWNS] = {0};
        if (!p->is_in)
            continue;
        for (int k = 0; k < 4; k++) {
            x[k] = y[4 + k] = p->q[k];
            x[8 + k] = -p->x * p->q[k];
            y[8 + k] = -p->y * p->q[k];
        }
        add_row(a, x);
        add_row(a, y);
    }
    smallest(a, UNKNOWNS, m);
    for (size_t i = 0; i < c->count; i++)
        behind += dot4(m + 8, c->points[i].q) < 0;
    for (int k = 0; behind * 2 > c->count && k < UNKNOWNS; k++)
        m[k] = -m[k];
}

/* x = first.Q, y = second.Q by least squares; false if the points do not fix them. */
static bool solve_parallel(const struct cloud *c, double rows[2][4])
{
    double a[4][6] = {{0}};
    for (size_t i = 0; i < c->count; i++) {
        const struct point *p = &c->points[i];
        for (int j = 0; p->is_in && j < 4; j++) {
            for (int k = 0; k < 4; k++)
                a[j][k] += p->q[j] * p->q[k];
            a[j][4] += p->q[j] * p->x;
            a[j][5] += p->q[j] * p->y;
        }
    }
    for (int pivot = 0; pivot < 4; pivot++) {
        if (!(a[pivot][pivot] > 1e-9))
            return false;
        for (int j = 0; j < 4; j++) {
            const double factor = a[j][pivot] / a[pivot][pivot];
            for (int k = 0; j != pivot && k < 6; k++)
                a[j][k] -= factor * a[pivot][k];
        }
    }
    for (int j = 0; j < 4; j++) {
        rows[0][j] = a[j][4] / a[j][j];
        rows[1][j] = a[j][5] / a[j][j];
    }
    return true;
}

static bool is_plane(const struct cloud *c)
{
    double a[UNKNOWNS][UNKNOWNS] = {{0}}, unused[UNKNOWNS];
    for (size_t i = 0; i < c->count; i++)
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < 3; k++)
                a[j][k] += c->points[i].q[j] * c->points[i].q[k] / (double)c->count;
    return !(smallest(a, 3, unused) > 1e-8);
}

/* --- The camera --- */

struct solution {
    double perspective[UNKNOWNS], parallel[2][4];
    bool is_orthographic;
    double error; /* root mean square of what is in, texels */
    double share; /* that is in */
};

static void find_residuals(const struct cloud *c, const struct solution *s)
{
    for (size_t i = 0; i < c->count; i++) {
        struct point *p = &c->points[i];
        const double w = dot4(s->perspective + 8, p->q);
        p->perspective =
            hypot(dot4(s->perspective, p->q) / w - p->x, dot4(s->perspective + 4, p->q) / w - p->y);
        p->parallel = hypot(dot4(s->parallel[0], p->q) - p->x, dot4(s->parallel[1], p->q) - p->y);
        if (!isfinite(p->perspective))
            p->perspective = HUGE_VAL;
    }
}

/* *scratch has room for all points. */
static bool solve(struct cloud *c, struct solution *s, double *scratch)
{
    for (int round = 0; round < ROUNDS; round++) {
        if (!solve_parallel(c, s->parallel))
            return false;
        solve_perspective(c, s->perspective);
        find_residuals(c, s);
        for (size_t i = 0; i < c->count; i++)
            scratch[i] = c->points[i].parallel;
        const double parallel = median_of(scratch, c->count);
        for (size_t i = 0; i < c->count; i++)
            scratch[i] = c->points[i].perspective;
        const double perspective = median_of(scratch, c->count);
        s->is_orthographic = parallel < 2.0 * perspective + 1e-3 * c->texel;
        const double limit =
            fmax(3.0 * (s->is_orthographic ? parallel : perspective), 0.02 * c->texel);
        double sum = 0;
        size_t in = 0;
        for (size_t i = 0; i < c->count; i++) {
            struct point *p = &c->points[i];
            const double r = s->is_orthographic ? p->parallel : p->perspective;
            p->is_in = r < limit;
            sum += p->is_in ? r * r : 0;
            in += p->is_in;
        }
        if (in < LEAST_POINTS)
            return false;
        s->error = sqrt(sum / (double)in) / c->texel;
        s->share = (double)in / (double)c->count;
    }
    return true;
}

/* A row of four for positions as they are. */
static struct vec3 uncentred(const struct cloud *c, const double row[4], double *constant)
{
    const struct vec3 v = scale(vec3(row[0], row[1], row[2]), 1.0 / c->size);
    *constant = row[3] - dot(v, vec3(c->centre[0], c->centre[1], c->centre[2]));
    return v;
}

static void set_rotation(struct position_camera *out, struct vec3 x, struct vec3 y, struct vec3 z)
{
    const double rows[9] = {x.x, x.y, x.z, y.x, y.y, y.z, z.x, z.y, z.z};
    memcpy(out->rotation, rows, sizeof rows);
}

/* The axes across, made orthogonal: what is left of it is skew that no camera has. */
static struct vec3 orthogonal(struct vec3 v, struct vec3 to)
{
    return normalize(mad(to, -dot(v, to), v));
}

static void take_perspective(const struct cloud *c, const struct solution *s,
                             const struct positions *p, struct position_camera *out)
{
    double d[3];
    struct vec3 row[3];
    for (int i = 0; i < 3; i++)
        row[i] = uncentred(c, s->perspective + i * 4, &d[i]);
    const double size = length(row[2]);
    const struct vec3 forward = scale(row[2], 1.0 / size);
    const double cx = dot(row[0], forward) / size, cy = dot(row[1], forward) / size;
    const struct vec3 a = sub(scale(row[0], 1.0 / size), scale(forward, cx));
    const struct vec3 b = sub(scale(row[1], 1.0 / size), scale(forward, cy));
    const double fx = length(a), fy = length(b);
    const struct vec3 x = scale(a, 1.0 / fx), y = orthogonal(b, x);
    set_rotation(out, x, y, scale(forward, -1.0));
    out->translation[0] = (d[0] - cx * d[2]) / size / fx;
    out->translation[1] = (d[1] - cy * d[2]) / size / fy;
    out->translation[2] = -d[2] / size;
    out->half_width = 1.0 / fx;
    const double aspect = ((double)p->display_window.x_max - p->display_window.x_min + 1.0) *
                          p->pixel_aspect /
                          ((double)p->display_window.y_max - p->display_window.y_min + 1.0);
    out->shift_x = fabs(cx) > 1e-4 ? -cx / 2.0 : 0;
    out->shift_y = fabs(cy) > 1e-4 ? -cy / 2.0 * aspect : 0;
    if (fabs(log(fy / fx)) > 0.02 || fabs(dot(x, scale(b, 1.0 / fy))) > 0.02) {
        out->is_sure = false;
        snprintf(out->why, sizeof out->why, "they fit no camera without skew");
    }
}

/* Axes across are the same whether space looks along -z or, as OpenEXR's and pbrt's camera space,
 * along +z, which has all there is at positive z. */
static bool looks_along_plus_z(const struct cloud *c, struct vec3 x, struct vec3 y,
                               const double d[2])
{
    const double away = 1e-3 * c->size;
    bool ahead = x.x > 0.9999 && y.y > 0.9999 && fabs(d[0]) < away && fabs(d[1]) < away;
    for (size_t i = 0; ahead && i < c->count; i++)
        ahead = c->points[i].q[2] * c->size + c->centre[2] > 0;
    return ahead;
}

/* Where depth begins is free: in front of all there is. */
static void take_parallel(const struct cloud *c, const struct solution *s,
                          struct position_camera *out)
{
    double d[2], nearest = -HUGE_VAL;
    const struct vec3 a = uncentred(c, s->parallel[0], &d[0]);
    const struct vec3 b = uncentred(c, s->parallel[1], &d[1]);
    const struct vec3 x = normalize(a), y = orthogonal(b, x);
    out->half_width = 1.0 / length(a);
    out->translation[0] = d[0] * out->half_width;
    out->translation[1] = d[1] / length(b);
    const bool is_turned = looks_along_plus_z(c, x, y, out->translation);
    const struct vec3 z = scale(cross(x, y), is_turned ? -1.0 : 1.0);
    set_rotation(out, x, y, z);
    const struct vec3 centre = vec3(c->centre[0], c->centre[1], c->centre[2]);
    for (size_t i = 0; i < c->count; i++) {
        const double *q = c->points[i].q;
        nearest = fmax(nearest, dot(z, mad(vec3(q[0], q[1], q[2]), c->size, centre)));
    }
    out->translation[2] = -nearest - out->half_width;
}

bool camera_from_positions(const struct positions *positions, struct position_camera *camera,
                           struct tool_error *err)
{
    struct cloud c;
    struct solution s = {.error = HUGE_VAL};
    *camera = (struct position_camera){0};
    double *scratch = NULL;
    bool ok = collect(positions, &c);
    if (ok)
        scratch = malloc((c.count + 1) * sizeof *scratch);
    if (!ok || !scratch) {
        free(c.points);
        return fail(err, EXIT_MEMORY, "out of memory for the camera of the positions");
    }
    if (c.count < LEAST_POINTS) {
        snprintf(camera->why, sizeof camera->why, "they are background");
    } else if (is_plane(&c)) {
        snprintf(camera->why, sizeof camera->why, "they lie in a plane");
    } else if (!solve(&c, &s, scratch) || s.error > 0.5 || s.share < 0.6) {
        snprintf(camera->why, sizeof camera->why, "they fit no camera");
    } else {
        camera->is_sure = true;
        camera->is_orthographic = s.is_orthographic;
        camera->error = s.error;
        if (s.is_orthographic)
            take_parallel(&c, &s, camera);
        else
            take_perspective(&c, &s, positions, camera);
    }
    free(scratch);
    free(c.points);
    return true;
}

/* --- Given a camera --- */

static double component(const struct position_camera *c, int row, const float position[3])
{
    const double *r = c->rotation + row * 3;
    return r[0] * (double)position[0] + r[1] * (double)position[1] + r[2] * (double)position[2] +
           c->translation[row];
}

double position_depth(const struct position_camera *camera, const float position[3])
{
    return -component(camera, 2, position);
}

bool positions_miss(const struct positions *positions, const struct position_camera *camera,
                    double *texels)
{
    const uint32_t step = step_of(positions);
    const double width =
        (double)positions->display_window.x_max - positions->display_window.x_min + 1.0;
    const double height =
        (double)positions->display_window.y_max - positions->display_window.y_min + 1.0;
    double *misses = malloc(
        ((size_t)(positions->width / step + 1) * (positions->height / step + 1)) * sizeof *misses);
    size_t count = 0;
    if (!misses)
        return false;
    for (uint32_t row = 0; row < positions->height; row += step)
        for (uint32_t column = 0; column < positions->width; column += step) {
            const float *v = positions->values + ((size_t)row * positions->width + column) * 4;
            double x, y;
            if (!positions_are_there(v))
                continue;
            place(positions, column, row, &x, &y);
            const double z = camera->is_orthographic ? 1.0 : position_depth(camera, v);
            x += 2.0 * camera->shift_x;
            y += 2.0 * camera->shift_y * height / width / positions->pixel_aspect;
            const double off = hypot(component(camera, 0, v) / z / camera->half_width - x,
                                     component(camera, 1, v) / z / camera->half_width - y);
            misses[count++] = z > 0 && isfinite(off) ? off * width / 2.0 : INFINITY;
        }
    *texels = count ? median_of(misses, count) : INFINITY;
    free(misses);
    return true;
}
