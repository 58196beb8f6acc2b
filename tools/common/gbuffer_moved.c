/* SPDX-License-Identifier: MIT
 *
 * Whether normals are of the places that depth is of. Passes of two windows, or of two filters, are
 * moved against each other. Then the normals of depth are not those that are stored at the same
 * texel, but those that are stored some texels away. */
#include "gbuffer_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum {
    FARTHEST = 16,  /* texels, either way */
    ROUNDS = 2,     /* each along x, then along y */
    FEW_GAINS = 16, /* texels that agree there and not here */
    NEIGHBOURS = 4,
    /* Another neighbour of each. */
    STRIDE = NEIGHBOURS + 1,
    WORDS = 48
};

/* Squares of sines: 10 degrees are the same normal, 20 are another. */
static const double same = 0.03, other = 0.117;

/* A normal of depth, turned to the space of the stored ones. */
struct place {
    ptrdiff_t x, y;
    double normal[3];
};

struct places {
    struct place *list;
    size_t count;
};

struct move {
    ptrdiff_t x, y;
};

/* The square of the sine between the two, whichever way they point; 1 where nothing is stored. */
static double disagreement(const struct gbuffer *g, const struct place *p, struct move by)
{
    const ptrdiff_t x = p->x + by.x, y = p->y + by.y;
    if (x < 0 || y < 0 || x >= (ptrdiff_t)g->width || y >= (ptrdiff_t)g->height)
        return NAN;
    const float *n = g->normals + (y * (ptrdiff_t)g->width + x) * 4;
    double dot = 0, square = 0;
    for (int c = 0; c < 3; c++) {
        dot += p->normal[c] * (double)n[c];
        square += (double)n[c] * (double)n[c];
    }
    return square > 0.25 ? fmax(1.0 - dot * dot / square, 0) : 1.0;
}

/* Or infinity, as soon as it is certain to be no less than that. */
static double mean_disagreement(const struct gbuffer *g, const struct places *places,
                                struct move by, double least)
{
    const double enough = least * (double)((places->count + STRIDE - 1) / STRIDE);
    double sum = 0;
    size_t count = 0;
    for (size_t i = 0; i < places->count; i += STRIDE) {
        if (sum > enough)
            return INFINITY;
        const double e = disagreement(g, &places->list[i], by);
        if (isnan(e))
            continue;
        sum += e / (e + same);
        count++;
    }
    return count ? sum / (double)count : 1.0;
}

static struct move find_best(const struct gbuffer *g, const struct places *places)
{
    struct move best = {0, 0};
    double least = mean_disagreement(g, places, best, INFINITY);
    for (int round = 0; round < 2 * ROUNDS; round++) {
        const struct move from = best;
        for (ptrdiff_t k = -FARTHEST; k <= FARTHEST; k++) {
            const struct move at = round % 2 ? (struct move){from.x, k} : (struct move){k, from.y};
            const double mean = mean_disagreement(g, places, at, least);
            if (mean < least) {
                least = mean;
                best = at;
            }
        }
        /* From here on the same rows and columns would be looked along again. */
        if (round % 2 && best.y == from.y)
            break;
    }
    return best;
}

/* Of clean renders no texel agrees there and not here. Of passes that are moved by one texel dozens
 * do, by more hundreds, and a third of that at most agrees no more. */
static bool is_better(const struct gbuffer *g, const struct places *places, struct move there)
{
    size_t gains = 0, losses = 0;
    for (size_t i = 0; i < places->count; i++) {
        const double here = disagreement(g, &places->list[i], (struct move){0, 0});
        const double e = disagreement(g, &places->list[i], there);
        gains += e < same && here > other;
        losses += e > other && here < same;
    }
    return gains >= FEW_GAINS && gains > 2 * losses;
}

/* Where depth has normals of its own: those of a plane that the neighbours lie on as well, and they
 * are what a border is beside. */
static bool find_places(const struct gbuffer *g, struct places *places)
{
    const float *m = g->view.normal_to_view;
    struct normal_pairs pairs;
    if (!gbuffer_pair_normals(g, GBUFFER_MOST_PAIRS, &pairs))
        return false;
    const ptrdiff_t reach = (ptrdiff_t)pairs.reach;
    const struct move to[NEIGHBOURS] = {{-reach, 0}, {reach, 0}, {0, -reach}, {0, reach}};
    *places = (struct places){malloc((pairs.count * NEIGHBOURS + 1) * sizeof *places->list), 0};
    for (size_t i = 0; places->list && i < pairs.count; i++) {
        const double *depth = pairs.pair[i].depth;
        const ptrdiff_t x = (ptrdiff_t)(pairs.pair[i].texel % g->width);
        const ptrdiff_t y = (ptrdiff_t)(pairs.pair[i].texel / g->width);
        double n[3];
        for (int c = 0; c < 3; c++)
            n[c] = depth[0] * (double)m[c * 3] + depth[1] * (double)m[c * 3 + 1] +
                   depth[2] * (double)m[c * 3 + 2];
        for (int k = 0; k < NEIGHBOURS; k++)
            places->list[places->count++] =
                (struct place){x + to[k].x, y + to[k].y, {n[0], n[1], n[2]}};
    }
    gbuffer_free_pairs(&pairs);
    return places->list != NULL;
}

/* Where depth lies, seen from the normals: as "a texel to the right" or "3 texels above". */
static void describe(ptrdiff_t texels, const char *where, char text[WORDS])
{
    if (texels == 1)
        snprintf(text, WORDS, "a texel %s", where);
    else if (texels > 1)
        snprintf(text, WORDS, "%td texels %s", texels, where);
}

bool gbuffer_warn_of_move(const struct gbuffer *g, const char *path, struct report *report)
{
    struct places places;
    char across[WORDS] = "", down[WORDS] = "";
    if (!g->normals || g->block_size > 1)
        return true;
    if (!find_places(g, &places))
        return false;
    const struct move normals = find_best(g, &places);
    const bool is_moved = is_better(g, &places, normals);
    free(places.list);
    if (!is_moved)
        return true;
    describe(normals.x < 0 ? -normals.x : normals.x, normals.x < 0 ? "to the right" : "to the left",
             across);
    describe(normals.y < 0 ? -normals.y : normals.y, normals.y < 0 ? "below" : "above", down);
    report_warn(report, "moved depth",
                "%s: depth and normals '%s' are of different places: depth lies about %s%s%s; AO "
                "is wrong at borders; write both in one size and one window, from the same samples",
                path, g->roles.kind[ROLE_NORMAL].label, across, across[0] && down[0] ? " and " : "",
                down);
    return true;
}
