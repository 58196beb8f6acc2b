/* SPDX-License-Identifier: MIT
 *
 * Which way round normals point: what the camera sees faces it. */
#include "gbuffer_internal.h"
#include "median.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

bool gbuffer_measure_facing(const struct gbuffer *g, const float matrix[9],
                            struct normal_facing *facing)
{
    size_t step = gbuffer_sample_step(g), count = 0, towards = 0;
    double *z = malloc((gbuffer_texels(g) / step + 1) * sizeof *z);
    if (!z)
        return false;
    for (size_t i = 0; i < gbuffer_texels(g); i += step) {
        if (!gbuffer_is_foreground(g, i) || !(gbuffer_length(g->normals + i * 4) > 0.5))
            continue;
        double n[3], x = 0, y = 0;
        gbuffer_turn_normal(matrix, g->normals + i * 4, n);
        if (g->camera.type == CAMERA_PERSPECTIVE)
            camera_ray(&g->camera, &g->display_window, &g->data_window, (double)(i % g->width),
                       (double)(i / g->width), &x, &y);
        towards += n[0] * x + n[1] * y - n[2] < 0;
        z[count++] = n[2];
    }
    facing->away = count - towards;
    facing->share = count ? (double)towards / (double)count : 1.0;
    facing->median_z = median_of(z, count);
    free(z);
    return true;
}

void gbuffer_turn_round(float m[9])
{
    for (int i = 0; i < 9; i++)
        m[i] = -m[i];
}

/* Along an axis of the stored normals, or along the direction that the fewest of them have: what
 * those of two directions leave open. */
enum { MIRROR_SEEN = 3, MIRRORS };

static void mirror(const struct gbuffer *g, int which, float m[9])
{
    memcpy(m, g->view.normal_to_view, sizeof g->view.normal_to_view);
    for (int c = 0; c < 3; c++) {
        const double *w = g->seen_weakest;
        float *column = m + c * 3;
        const double along =
            (double)column[0] * w[0] + (double)column[1] * w[1] + (double)column[2] * w[2];
        for (int row = 0; row < 3; row++) {
            if (which == MIRROR_SEEN)
                column[row] = (float)((double)column[row] - 2.0 * along * w[row]);
            else if (which == c)
                column[row] = -column[row];
        }
    }
}

/* Of a small image few texels tell, and they do if none is left. */
static bool all_face(const struct normal_facing *as_told, const struct normal_facing *mirrored)
{
    static const double most_facing = 0.98, least_facing = 0.99;
    enum { FEW = 8, TIMES = 8 };
    if (mirrored->share < least_facing)
        return false;
    return as_told->share < most_facing ||
           (as_told->away >= FEW && mirrored->away * TIMES <= as_told->away);
}

/* Agreement does not ask which way round a normal points, as leaves do not either. Of what a
 * renderer turned towards the eye more than 99 of 100 face it; of a world with one axis the other
 * way round, as a left-handed one has, 29 to 99. What faces the eye in a mirror alone was mirrored,
 * and leaves that point anywhere face it in none. */
bool gbuffer_ask_mirrors(struct gbuffer *g, const struct normal_pairs *pairs, const char *path,
                         struct report *report)
{
    static const double half = 0.5, less = 0.02;
    static const char *const axes[MIRRORS] = {"their x is turned round", "their y is turned round",
                                              "their z is turned round",
                                              "one direction of them is"};
    struct normal_facing as_told, mirrored;
    float best[9];
    int axis = -1;
    if (!gbuffer_measure_facing(g, g->view.normal_to_view, &as_told))
        return false;
    double most = 0;
    const bool is_asked =
        as_told.away > 0 && gbuffer_agreement(pairs, g->view.normal_to_view).share > half;
    for (int c = 0; is_asked && c < MIRRORS; c++) {
        float m[9];
        if (c == MIRROR_SEEN && !g->has_seen_rotation)
            continue;
        mirror(g, c, m);
        if (!gbuffer_measure_facing(g, m, &mirrored))
            return false;
        const double agreement = gbuffer_agreement(pairs, m).share;
        if (!all_face(&as_told, &mirrored) || mirrored.share <= most ||
            agreement < g->normal_agreement - less)
            continue;
        most = mirrored.share;
        axis = c;
        memcpy(best, m, sizeof best);
    }
    if (axis < 0)
        return true;
    memcpy(g->view.normal_to_view, best, sizeof best);
    report_warn(report, "mirrored normals",
                "%s: %.2g %% of the normals '%s' face away from the camera, and all face it once "
                "%s: mirrored, as those of a left-handed world are; they are taken so",
                path, (1.0 - as_told.share) * 100.0, g->roles.kind[ROLE_NORMAL].label, axes[axis]);
    return true;
}

/* All of them away from the eye, and along those of depth: inside out, whatever made them so. */
bool gbuffer_ask_whether_inside_out(struct gbuffer *g, const struct normal_pairs *pairs,
                                    const char *path, struct report *report)
{
    static const double least_away = 0.99, half = 0.5;
    struct normal_facing facing;
    if (!gbuffer_measure_facing(g, g->view.normal_to_view, &facing))
        return false;
    if (1.0 - facing.share < least_away ||
        gbuffer_agreement(pairs, g->view.normal_to_view).share < half)
        return true;
    gbuffer_turn_round(g->view.normal_to_view);
    report_warn(report, "mirrored normals",
                "%s: the normals '%s' face away from the camera, %.0f %% of them, and lie along "
                "those of the depth: they point inwards and are turned round",
                path, g->roles.kind[ROLE_NORMAL].label, (1.0 - facing.share) * 100.0);
    return true;
}
