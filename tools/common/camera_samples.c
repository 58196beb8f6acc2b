/* SPDX-License-Identifier: MIT
 *
 * Which texels tell of the camera: smooth ones, spread over the image and over all directions. */
#include "camera_fit_internal.h"

#include "median.h"

#include <stdlib.h>
#include <string.h>

/* Texels that are looked at, and those that are kept. */
enum { MOST_CANDIDATES = 1 << 18, MOST_SAMPLES = 4000, LEAST_SAMPLES = 200 };

static const int stencil[5][2] = {{0, 0}, {-1, 0}, {1, 0}, {0, 1}, {0, -1}};
static const int corners[4][2] = {{-1, -1}, {1, -1}, {-1, 1}, {1, 1}};

/* --- Values --- */

struct field {
    const struct fit_input *input;
    bool *valid;                /* of texels, as is_valid() has it */
    double sign;                /* -1 where depth is negative throughout */
    double least, most;         /* of valid depth */
    bool drop_least, drop_most; /* values held by so many texels that they are background */
    int step, reach;            /* of candidates, and how far their neighbours reach */
    int baseline, blur;
    double quantum; /* relative step of stored values */
};

static bool same(double a, double b)
{
    return !(a < b) && !(a > b);
}

static bool is_number(double d)
{
    return fabs(d) > 0 && fabs(d) < 9.9e6; /* no scene is larger and 0 is background */
}

static double depth_at(const struct field *f, int x, int y)
{
    return f->sign * (double)f->input->depth[(size_t)y * f->input->width + (size_t)x];
}

static const float *normal_at(const struct field *f, int x, int y)
{
    return f->input->normals + ((size_t)y * f->input->width + (size_t)x) * 4;
}

static double length_of(const float *n)
{
    const double x = (double)n[0], y = (double)n[1], z = (double)n[2];
    return sqrt(x * x + y * y + z * z);
}

static bool valid_depth(const struct field *f, double d)
{
    return is_number(d) && !(f->drop_least && same(d, f->least)) &&
           !(f->drop_most && same(d, f->most));
}

static bool is_valid(const struct field *f, int x, int y)
{
    const double length = length_of(normal_at(f, x, y));
    return valid_depth(f, depth_at(f, x, y)) && length > 0.5 && length < 1.5;
}

/* Once, since each is asked for many times as a neighbour. */
static void find_valid(const struct field *f)
{
    const int width = (int)f->input->width, height = (int)f->input->height;
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++)
            f->valid[(size_t)y * f->input->width + (size_t)x] = is_valid(f, x, y);
}

static bool valid_at(const struct field *f, int x, int y)
{
    return f->valid[(size_t)y * f->input->width + (size_t)x];
}

/* A constant that more than 5 % of the texels hold at an end of the range is background. */
static void find_range(struct field *f)
{
    const size_t texels = (size_t)f->input->width * f->input->height;
    size_t count = 0, at_least = 0, at_most = 0, negative = 0;
    f->sign = 1;
    for (size_t i = 0; i < texels; i++) {
        const double d = (double)f->input->depth[i];
        if (!is_number(d))
            continue;
        negative += d < 0;
        if (count == 0 || d < f->least)
            at_least = 0, f->least = d;
        if (count == 0 || d > f->most)
            at_most = 0, f->most = d;
        at_least += same(d, f->least);
        at_most += same(d, f->most);
        count++;
    }
    const bool usual = same(f->most, 1.0) || same(f->most, 65504.0);
    f->drop_least = at_least * 20 > count;
    f->drop_most = at_most * 20 > count || (usual && at_most > 50);
    /* Background of -1 turns nothing round, however much of it there is. */
    const size_t aside = f->drop_least && f->least < 0 ? at_least : 0;
    if ((negative - aside) * 2 > count - aside) {
        const double least = f->least;
        const bool drop = f->drop_least;
        f->sign = -1;
        f->least = -f->most;
        f->most = -least;
        f->drop_least = f->drop_most;
        f->drop_most = drop;
    }
}

/* Bits of the mantissa that are really used: half depth in a float channel is found by them. */
static int mantissa_bits(const struct field *f)
{
    static const int bits[] = {7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 20};
    enum { MANTISSA = 23 };
    size_t counts[MANTISSA + 1] = {0}, count = 0; /* by the place of the last bit that is set */
    const int width = (int)f->input->width, height = (int)f->input->height;
    for (int y = 0; y < height; y += f->step)
        for (int x = 0; x < width; x += f->step) {
            if (!valid_at(f, x, y))
                continue;
            uint32_t word;
            memcpy(&word, &f->input->depth[(size_t)y * f->input->width + (size_t)x], sizeof word);
            int used = MANTISSA;
            while (used > 0 && !(word >> (MANTISSA - used) & 1u))
                used--;
            counts[used]++;
            count++;
        }
    for (size_t i = 0; i < sizeof bits / sizeof *bits; i++) {
        size_t longer = 0;
        for (int used = bits[i] + 1; used <= MANTISSA; used++)
            longer += counts[used];
        if (longer * 1000 <= count)
            return bits[i];
    }
    return MANTISSA;
}

/* --- Candidates --- */

struct candidate {
    int x, y;
    double d[5];
    struct vec3 m;
    double agreement; /* least cosine between the normal and those of the neighbours */
    double length;
    uint16_t cell;
    uint8_t tile;
};

/* The normal at a texel, normalised; of bump maps, the mean over a patch follows the surface. */
static struct vec3 normal_of(const struct field *f, int x, int y)
{
    struct vec3 sum = {0, 0, 0};
    const int step = f->blur > 4 ? f->blur / 4 : 1; /* some dozen are a mean as good */
    for (int j = y - f->blur; j <= y + f->blur; j += step)
        for (int i = x - f->blur; i <= x + f->blur; i += step) {
            if (!valid_at(f, i, j))
                continue;
            const float *n = normal_at(f, i, j);
            sum = mad(vec3((double)n[0], (double)n[1], (double)n[2]), 1.0 / length_of(n), sum);
        }
    const double size = length(sum);
    return size > 1e-9 ? scale(sum, 1.0 / size) : sum;
}

static bool all_valid(const struct field *f, int x, int y)
{
    for (int j = -1; j <= 1; j++)
        for (int i = -1; i <= 1; i++)
            if (!valid_at(f, x + i * f->baseline, y + j * f->baseline))
                return false;
    return true;
}

static int cube_cell(struct vec3 m)
{
    const double v[3] = {m.x, m.y, m.z};
    int axis = 0;
    for (int i = 1; i < 3; i++)
        if (fabs(v[i]) > fabs(v[axis]))
            axis = i;
    int at[2];
    for (int i = 0; i < 2; i++) {
        const double t = atan(v[(axis + 1 + i) % 3] / fabs(v[axis])) * 4.0 / PI;
        at[i] = (int)((t + 1.0) * 0.5 * FIT_CUBE);
        at[i] = at[i] < 0 ? 0 : at[i] >= FIT_CUBE ? FIT_CUBE - 1 : at[i];
    }
    return ((axis * 2 + (v[axis] < 0)) * FIT_CUBE + at[0]) * FIT_CUBE + at[1];
}

/* Half the difference of the two neighbours on either axis. */
static double slope_x(const double d[5])
{
    return fabs(d[2] - d[1]) / 2.0;
}

static double slope_y(const double d[5])
{
    return fabs(d[4] - d[3]) / 2.0;
}

/* A step is none of a surface: the second differences are small beside the first. Those of the
 * diagonals find what the axes miss. */
static bool is_smooth(const struct field *f, const struct candidate *c, double median_slope)
{
    const double *d = c->d;
    const double sx = slope_x(d), sy = slope_y(d);
    const double limit = 0.1 * (sx + sy + median_slope) + 2.0 * f->quantum * fabs(d[0]);
    if (fabs(d[1] + d[2] - 2.0 * d[0]) > limit || fabs(d[3] + d[4] - 2.0 * d[0]) > limit)
        return false;
    for (int k = 0; k < 4; k += 2) {
        double sum = -2.0 * d[0];
        for (int i = 0; i < 2; i++) {
            const int *c0 = corners[k == 0 ? i * 3 : 1 + i];
            sum += depth_at(f, c->x + c0[0] * f->baseline, c->y + c0[1] * f->baseline);
        }
        if (fabs(sum) > 2.0 * limit)
            return false;
    }
    return true;
}

static void fill_normals(const struct field *f, struct candidate *c)
{
    c->m = normal_of(f, c->x, c->y);
    c->length = length_of(normal_at(f, c->x, c->y));
    c->agreement = 1.0;
    for (int i = 1; i < 5; i++) {
        const struct vec3 other =
            normal_of(f, c->x + stencil[i][0] * f->baseline, c->y + stencil[i][1] * f->baseline);
        c->agreement = fmin(c->agreement, dot(other, c->m));
    }
    const int inner_x = (int)f->input->width - 2 * f->baseline;
    const int inner_y = (int)f->input->height - 2 * f->baseline;
    const int column = (c->x - f->baseline) * FIT_TILES_X / inner_x;
    const int row = (c->y - f->baseline) * FIT_TILES_Y / inner_y;
    c->tile = (uint8_t)(row * FIT_TILES_X + column);
    c->cell = (uint16_t)cube_cell(c->m);
}

/* Smooth texels at every step-th place. *list is malloc'ed; false if memory runs out. */
static bool list_candidates(const struct field *f, struct candidate **list, size_t *count)
{
    const int width = (int)f->input->width, height = (int)f->input->height;
    const size_t across = ((size_t)width - 1) / (size_t)f->step + 1,
                 down = ((size_t)height - 1) / (size_t)f->step + 1;
    struct candidate *all = malloc(across * down * sizeof *all);
    double *slopes = malloc(across * down * sizeof *slopes);
    *list = all;
    *count = 0;
    if (!all || !slopes) {
        free(slopes);
        return false;
    }
    size_t found = 0;
    for (int y = f->reach; y < height - f->reach; y += f->step)
        for (int x = f->reach; x < width - f->reach; x += f->step) {
            if (!all_valid(f, x, y))
                continue;
            struct candidate *c = &all[found];
            *c = (struct candidate){.x = x, .y = y};
            for (int i = 0; i < 5; i++)
                c->d[i] =
                    depth_at(f, x + stencil[i][0] * f->baseline, y + stencil[i][1] * f->baseline);
            slopes[found++] = hypot(slope_x(c->d), slope_y(c->d));
        }
    const double median = median_of(slopes, found);
    for (size_t i = 0; i < found; i++)
        if (is_smooth(f, &all[i], median))
            all[(*count)++] = all[i];
    for (size_t i = 0; i < *count; i++)
        fill_normals(f, &all[i]);
    free(slopes);
    return true;
}

/* Where the stored normals of all five agree; less strictly if too little is left. */
static void keep_agreeing(struct candidate *list, size_t *count)
{
    static const double cosines[] = {0.995, 0.97, 0.85, -2.0};
    const double share = 0.15 * (double)*count;
    const size_t enough = share > 1000 ? (size_t)share : 1000;
    size_t kept = 0;
    for (size_t k = 0; k < 4 && kept < enough; k++) {
        kept = 0;
        for (size_t i = 0; i < *count; i++)
            kept += list[i].agreement > cosines[k] && fabs(list[i].length - 1.0) < 0.02;
        if (kept < enough && k < 3)
            continue;
        if (kept < LEAST_SAMPLES)
            return; /* blurred normals, say: any will do */
        kept = 0;
        for (size_t i = 0; i < *count; i++)
            if (list[i].agreement > cosines[k] && fabs(list[i].length - 1.0) < 0.02)
                list[kept++] = list[i];
        *count = kept;
        return;
    }
}

/* --- Samples --- */

static size_t bucket(const struct candidate *c)
{
    return (size_t)c->cell * FIT_TILES + c->tile;
}

/* The largest number of each direction in each tile that keeps the whole within bounds. */
static size_t find_cap(const size_t *counts)
{
    size_t low = 1, high = 1;
    for (size_t i = 0; i < FIT_CELLS * FIT_TILES; i++)
        high = counts[i] > high ? counts[i] : high;
    while (low < high) {
        const size_t cap = (low + high + 1) / 2;
        size_t sum = 0;
        for (size_t i = 0; i < FIT_CELLS * FIT_TILES; i++)
            sum += counts[i] < cap ? counts[i] : cap;
        if (sum <= MOST_SAMPLES)
            low = cap;
        else
            high = cap - 1;
    }
    return low;
}

static struct fit_sample make_sample(const struct field *f, const struct candidate *c)
{
    const struct fit_input *in = f->input;
    const double width = (double)in->display_window.x_max - in->display_window.x_min + 1.0;
    const double height = (double)in->display_window.y_max - in->display_window.y_min + 1.0;
    const double left = (double)in->data_window.x_min - in->display_window.x_min;
    const double top = (double)in->data_window.y_min - in->display_window.y_min;
    const double turn = sqrt(fmax(2.0 - 2.0 * c->agreement, 0.0)) * (180.0 / PI) / f->baseline;
    struct fit_sample s = {
        .x = (c->x + left + 0.5) * 2.0 / width - 1.0,
        .y = (height / 2.0 - (c->y + top + 0.5)) * 2.0 / width / in->pixel_aspect,
        .m = c->m,
        /* Flat faces are exact; smooth shading and bumps are not. */
        .weight = fmax(1.0 / (1.0 + (turn / 0.1) * (turn / 0.1)), 0.02),
        .flat = turn < 0.05,
        .tile = c->tile,
        .cell = (uint8_t)c->cell,
    };
    memcpy(s.d, c->d, sizeof s.d);
    return s;
}

/* A floor must not outvote everything, and no direction may hold more than a quarter. */
static void balance_weights(struct fit_samples *s)
{
    size_t counts[FIT_CELLS] = {0};
    double weights[FIT_CELLS], sum = 0;
    for (size_t i = 0; i < s->count; i++)
        counts[s->list[i].cell]++;
    for (size_t i = 0; i < s->count; i++)
        s->list[i].weight /= sqrt((double)counts[s->list[i].cell]);
    for (int round = 0; round < 4; round++) {
        memset(weights, 0, sizeof weights);
        sum = 0;
        for (size_t i = 0; i < s->count; i++) {
            weights[s->list[i].cell] += s->list[i].weight;
            sum += s->list[i].weight;
        }
        for (size_t i = 0; i < s->count; i++)
            s->list[i].weight *= fmin(1.0, 0.25 * sum / weights[s->list[i].cell]);
    }
    sum = 0;
    for (size_t i = 0; i < s->count; i++)
        sum += s->list[i].weight;
    for (size_t i = 0; i < s->count; i++)
        s->list[i].weight *= (double)s->count / sum;
    s->total_weight = (double)s->count;
}

/* The columns of the list, and room for what is computed of it. */
static bool arrange(struct fit_samples *s)
{
    const size_t chunks = (s->count + FIT_CHUNK - 1) / FIT_CHUNK;
    s->columns = malloc((chunks + 1) * sizeof *s->columns);
    s->normals = malloc((1 + FIT_SHAPE) * (s->count + 1) * sizeof *s->normals);
    s->residuals = malloc((s->count + 1) * sizeof *s->residuals);
    if (!s->columns || !s->normals || !s->residuals)
        return false;
    for (size_t i = 0; s->count > 0 && i < chunks * FIT_CHUNK; i++) {
        const struct fit_sample *from = &s->list[i < s->count ? i : s->count - 1];
        struct fit_columns *to = &s->columns[i / FIT_CHUNK];
        to->x[i % FIT_CHUNK] = from->x;
        to->y[i % FIT_CHUNK] = from->y;
        for (int k = 0; k < 5; k++)
            to->d[k][i % FIT_CHUNK] = from->d[k];
    }
    return true;
}

static bool measure(struct fit_samples *s)
{
    double *values = malloc(s->count * sizeof *values);
    if (!values)
        return false;
    for (size_t i = 0; i < s->count; i++)
        values[i] = fabs(s->list[i].d[0]);
    s->median = median_of(values, s->count);
    for (size_t i = 0; i < s->count; i++)
        values[i] = hypot(slope_x(s->list[i].d) / s->step_x, slope_y(s->list[i].d) / s->step_y);
    s->log_slope = log(median_of(values, s->count) + 1e-12);
    free(values);
    return true;
}

static bool choose(const struct field *f, const struct candidate *list, size_t count,
                   struct fit_samples *s)
{
    size_t *counts = calloc(2 * FIT_CELLS * FIT_TILES, sizeof *counts);
    s->list = malloc((MOST_SAMPLES + FIT_CELLS * FIT_TILES) * sizeof *s->list);
    if (!counts || !s->list) {
        free(counts);
        return false;
    }
    size_t *seen = counts + FIT_CELLS * FIT_TILES;
    for (size_t i = 0; i < count; i++)
        counts[bucket(&list[i])]++;
    const size_t cap = find_cap(counts);
    for (size_t i = 0; i < count; i++) {
        const size_t b = bucket(&list[i]), rank = seen[b]++;
        if (counts[b] <= cap || (rank + 1) * cap / counts[b] > rank * cap / counts[b])
            s->list[s->count++] = make_sample(f, &list[i]);
    }
    free(counts);
    balance_weights(s);
    return arrange(s) && measure(s);
}

/* Of a field whose valid texels are known. */
static bool take_valid(struct field *f, struct fit_samples *samples)
{
    const struct fit_input *input = f->input;
    const int width = (int)input->width, height = (int)input->height;
    f->quantum = ldexp(1.0, -mantissa_bits(f));
    /* Far enough apart for the rounding of what is stored to be a hundredth of a slope. */
    const double step_x =
        2.0 / ((double)input->display_window.x_max - input->display_window.x_min + 1.0);
    for (f->baseline = 1; f->baseline < 16 && f->quantum * 0.25 / (f->baseline * step_x) > 0.01;)
        f->baseline++;
    if (f->baseline < f->blur)
        f->baseline = f->blur;
    f->reach = f->baseline + f->blur;
    if (width <= 2 * f->reach + 2 || height <= 2 * f->reach + 2)
        return true;
    samples->step_x = f->baseline * step_x;
    samples->step_y = samples->step_x / input->pixel_aspect;
    samples->least = f->least;
    samples->most = f->most;
    struct candidate *list;
    size_t count;
    bool ok = list_candidates(f, &list, &count);
    if (ok) {
        keep_agreeing(list, &count);
        ok = count < LEAST_SAMPLES || choose(f, list, count, samples);
    }
    free(list);
    return ok;
}

bool fit_samples_take(const struct fit_input *input, unsigned blur, struct fit_samples *samples)
{
    struct field f = {.input = input, .step = 1, .blur = (int)blur};
    const int width = (int)input->width, height = (int)input->height;
    const size_t most = blur ? MOST_CANDIDATES / 8 : MOST_CANDIDATES;
    *samples = (struct fit_samples){0};
    while ((size_t)(width / f.step) * (size_t)(height / f.step) > most)
        f.step++;
    find_range(&f);
    f.valid = malloc((size_t)input->width * input->height * sizeof *f.valid);
    if (!f.valid)
        return false;
    find_valid(&f);
    const bool ok = take_valid(&f, samples);
    free(f.valid);
    if (!ok)
        fit_samples_free(samples);
    return ok;
}

bool fit_samples_thin(const struct fit_samples *all, size_t most, struct fit_samples *samples)
{
    *samples = *all;
    samples->columns = NULL;
    samples->normals = NULL;
    samples->residuals = NULL;
    samples->list = malloc((most + 1) * sizeof *samples->list);
    if (!samples->list)
        return false;
    samples->count = 0;
    samples->total_weight = 0;
    for (size_t i = 0; i < all->count; i++) {
        if (all->count > most && (i + 1) * most / all->count == i * most / all->count)
            continue;
        samples->list[samples->count++] = all->list[i];
        samples->total_weight += all->list[i].weight;
    }
    if (arrange(samples))
        return true;
    fit_samples_free(samples);
    return false;
}

void fit_samples_free(struct fit_samples *samples)
{
    free(samples->list);
    free(samples->columns);
    free(samples->normals);
    free(samples->residuals);
    *samples = (struct fit_samples){0};
}
