/* SPDX-License-Identifier: MIT
 *
 * Whether depth was filtered, as colour is. A renderer that averages the samples of a texel puts
 * surfaces between the silhouette of a thing and what lies behind it where there are none. */
#include "gbuffer_internal.h"

#include <math.h>

enum { FEW_EDGES = 40 };

struct edges {
    size_t sharp, filtered;
};

/* Five texels in a row, with something flat on either side of the one in the middle. */
static void look(struct edges *edges, const double d[5])
{
    const double step = d[3] - d[1], nearer = fmin(fabs(d[1]), fabs(d[3]));
    if (!(fabs(step) > 0.2 * nearer) || !isfinite(step) ||
        !(fabs(d[1] - d[0]) < 0.05 * fabs(step)) || !(fabs(d[4] - d[3]) < 0.05 * fabs(step)))
        return;
    const double place = (d[2] - d[1]) / step;
    if (place > 0.08 && place < 0.92)
        edges->filtered++;
    else if (place > -0.08 && place < 1.08)
        edges->sharp++;
}

double gbuffer_filtered_share(const struct gbuffer *g)
{
    struct edges edges = {0};
    const size_t step[2] = {1, g->width};
    for (size_t i = 0; i < gbuffer_texels(g); i++) {
        const bool fits[2] = {i % g->width >= 2 && i % g->width + 2 < g->width,
                              i / g->width >= 2 && i / g->width + 2 < g->height};
        for (int axis = 0; axis < 2; axis++) {
            double d[5];
            for (size_t k = 0; fits[axis] && k < 5; k++)
                d[k] = (double)g->depth[i + k * step[axis] - 2 * step[axis]];
            if (fits[axis])
                look(&edges, d);
        }
    }
    /* A sharp edge is seen from the texels on both sides of it. */
    const double all = (double)edges.filtered + (double)edges.sharp / 2.0;
    return all >= FEW_EDGES ? (double)edges.filtered / all : 0;
}
