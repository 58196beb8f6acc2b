/* SPDX-License-Identifier: MIT
 *
 * Pictures that no camera with a view plane took, by their shape and by what surrounds them: a
 * panorama over all directions is twice as wide as high, meets itself at its sides and is one point
 * along its top and bottom; a fisheye ends at a circle. */
#include "gbuffer_internal.h"

#include <math.h>

static bool shows_all(const struct gbuffer *g)
{
    return gbuffer_same_box(&g->data_window, &g->display_window) && g->height >= 36;
}

/* Along a row or a column. */
struct line {
    double least, most, inverse; /* inverse: mean of 1/d */
    size_t count;
};

static struct line look_along(const struct gbuffer *g, size_t first, size_t step, size_t count)
{
    struct line l = {.least = INFINITY};
    for (size_t i = 0; i < count; i++) {
        const double d = (double)g->depth[first + i * step];
        if (!gbuffer_is_measurable(d))
            continue;
        l.least = fmin(l.least, d);
        l.most = fmax(l.most, d);
        l.inverse += 1.0 / d;
        l.count++;
    }
    l.inverse /= fmax((double)l.count, 1.0);
    return l;
}

/* The first row sees one direction. Of a plane the mean of 1/distance round a circle is that in its
 * centre times the cosine of its radius: here, at 5 degrees, nearly the same. A view plane that has
 * a floor along its first row sees much more of it there. */
static bool is_pole(const struct gbuffer *g, size_t row, size_t inner_row)
{
    static const double same_point = 1.05, same_mean = 0.01;
    const struct line at = look_along(g, row * g->width, 1, g->width);
    const struct line round = look_along(g, inner_row * g->width, 1, g->width);
    return at.count == g->width && round.count == g->width && at.most < same_point * at.least &&
           fabs(round.inverse / at.inverse - 1.0) < same_mean;
}

static bool is_panorama(const struct gbuffer *g)
{
    static const double differs = 1.3;
    const size_t width = g->width, height = g->height, last = height - 1, rows = height / 36;
    size_t meets = 0, looked = 0;
    if (width != 2 * height)
        return false;
    for (size_t y = 0; y < height; y++) {
        const double a = (double)g->depth[y * width], b = (double)g->depth[y * width + width - 1];
        if (!gbuffer_is_measurable(a) && !gbuffer_is_measurable(b))
            continue;
        looked++;
        meets += fabs(a - b) < 0.1 * fmin(fabs(a), fabs(b));
    }
    /* A wall straight ahead meets itself too, and is as far all along. */
    const struct line side = look_along(g, 0, width, height);
    return looked * 3 > height && meets * 10 > looked * 9 && side.most > differs * side.least &&
           (is_pole(g, 0, rows) || is_pole(g, last, last - rows));
}

static bool is_fisheye(const struct gbuffer *g)
{
    const double half = (double)g->width / 2.0;
    size_t inside = 0, near_it = 0;
    if (g->width != g->height)
        return false;
    for (size_t i = 0; i < gbuffer_texels(g); i++) {
        const double x = (double)(i % g->width) + 0.5 - half;
        const double y = (double)(i / g->width) + 0.5 - half, r = sqrt(x * x + y * y) / half;
        const bool is_there = gbuffer_is_foreground(g, i);
        if (r > 1.02 && is_there)
            return false;
        if (r > 0.93 && r < 0.99) {
            near_it++;
            inside += is_there;
        }
    }
    return inside * 3 > near_it;
}

void gbuffer_warn_of_panorama(const struct gbuffer *g, const char *path, struct report *report)
{
    if (gbuffer_camera_is_explicit(&g->camera) || !shows_all(g))
        return;
    if (is_panorama(g))
        report_warn(report, "panorama",
                    "%s: this looks like a panorama over all directions (latlong): no perspective "
                    "and no orthographic camera took it, and AO is wrong; render a perspective",
                    path);
    else if (is_fisheye(g))
        report_warn(report, "fisheye",
                    "%s: this looks like a fisheye: all there is lies in the circle that fills the "
                    "image; AO of a perspective is wrong in it, so render one",
                    path);
}
