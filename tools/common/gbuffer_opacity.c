/* SPDX-License-Identifier: MIT
 *
 * Whether normals were multiplied by alpha, as colours are. What is transparent, or fades, leaves
 * them shorter by as much over all that it covers; numbers that are treated like this are mostly so
 * together, depth too. Along silhouettes the filter of the renderer does the same, over a few
 * texels, which says nothing of what lies within.
 */
#include "gbuffer_internal.h"
#include "text.h"

#include <math.h>

enum {
    REACH = 2, /* texels to either side that are as transparent: no silhouette is as wide */
    FEW = 100
};

/* Below and above, normals are too short to tell, or too long. */
static const float least_alpha = 0.1f, most_alpha = 0.9f;

/* Texels within what is transparent, and of them those whose normals are as long as alpha says. How
 * alpha changes from texel to texel, in squares of logarithms, and how depth does so with it. */
struct opacity {
    size_t texels, shortened;
    double alpha_change, both_change;
};

static bool is_partial(const struct gbuffer *g, size_t texel)
{
    return g->alpha[texel] > least_alpha && g->alpha[texel] < most_alpha;
}

/* A surface that goes on behind its borders: alpha changes little by little, if at all. */
static bool is_within(const struct gbuffer *g, size_t texel)
{
    static const float alike = 0.1f;
    const size_t steps[2] = {1, g->width};
    for (int axis = 0; axis < 2; axis++)
        for (size_t k = 0; k <= 2 * REACH; k++) {
            const size_t at = texel + k * steps[axis] - REACH * steps[axis];
            if (!gbuffer_is_foreground(g, at) || !is_partial(g, at) ||
                fabsf(g->alpha[at] - g->alpha[texel]) > alike)
                return false;
        }
    return true;
}

/* Lengths are those of opaque texels, which may be other than 1 where most are transparent. */
static double length_of_opaque(const struct gbuffer *g)
{
    double sum = 0;
    size_t count = 0;
    for (size_t i = 0; i < gbuffer_texels(g); i += gbuffer_sample_step(g)) {
        const double length = gbuffer_length(g->normals + i * 4);
        if (!gbuffer_is_foreground(g, i) || !(g->alpha[i] > most_alpha) || !(length > 0))
            continue;
        sum += length / (double)g->alpha[i];
        count++;
    }
    return count > 0 ? sum / (double)count : 1.0;
}

/* From one side of a texel to the other. */
static void add_change(const struct gbuffer *g, size_t before, size_t after, struct opacity *o)
{
    static const double edge = 0.3;
    const double z[2] = {gbuffer_view_z(g, g->depth[before], before),
                         gbuffer_view_z(g, g->depth[after], after)};
    const double alpha = log((double)g->alpha[after] / (double)g->alpha[before]);
    const double depth = log(z[1] / z[0]);
    if (!(fabs(depth) < edge))
        return;
    o->alpha_change += alpha * alpha;
    o->both_change += alpha * depth;
}

static struct opacity look(const struct gbuffer *g)
{
    static const double same = 0.02;
    const double whole = length_of_opaque(g);
    struct opacity o = {0};
    for (size_t y = REACH; y + REACH < g->height; y++)
        for (size_t x = REACH; x + REACH < g->width; x++) {
            const size_t i = y * g->width + x;
            if (!is_partial(g, i) || !is_within(g, i))
                continue;
            const double length = gbuffer_length(g->normals + i * 4) / whole;
            o.texels++;
            o.shortened += fabs(length - (double)g->alpha[i]) < same;
            add_change(g, i - 1, i + 1, &o);
            add_change(g, i - g->width, i + g->width, &o);
        }
    return o;
}

/* Where alpha is the same all over a thing, depth does not tell. */
enum answer { NO, YES, UNKNOWN };

static enum answer is_depth_multiplied(const struct opacity *o)
{
    static const double least_change = 1e-5; /* 0.3 % from texel to texel */
    if (!(o->alpha_change > least_change * 2.0 * (double)o->texels))
        return UNKNOWN;
    return o->both_change > 0.5 * o->alpha_change ? YES : NO;
}

/* Of normals that are written as they are, none is as long as alpha but where filters made it so,
 * and these leave those of round things shorter. The length alone does no harm. Chosen by hand on
 * three ray-traced scenes; of 192 other views none is said. */
void gbuffer_warn_of_opacity(const struct gbuffer *g, const char *path, struct report *report)
{
    static const double least_share = 0.005, most = 0.8;
    char share[PERCENT_BYTES];
    if (!g->normals || !g->alpha)
        return;
    const struct opacity o = look(g);
    const enum answer depth = is_depth_multiplied(&o);
    if (o.texels < FEW || (double)o.shortened < most * (double)o.texels ||
        (double)o.shortened < least_share * (double)gbuffer_texels(g) || depth == NO)
        return;
    text_percent(share, (double)o.shortened / (double)gbuffer_texels(g));
    report_warn(report, "multiplied normals",
                "%s: normals '%s' are multiplied by alpha, on %s of the image, and depth '%s' is%s "
                "too: %s wrong there; write both as they are (unpremultiplied)",
                path, g->roles.kind[ROLE_NORMAL].label, share, g->roles.kind[ROLE_DEPTH].label,
                depth == YES ? "" : " perhaps",
                depth == YES ? "AO is" : "distances and AO are then");
}
