/* SPDX-License-Identifier: MIT
 *
 * Whether depth and normals are the same way up. A depth buffer that was read from the bottom row
 * on, or one of two files that was mirrored, has the normals of other places: those that are stored
 * fit it through no camera, and do once one of the two is turned round. */
#include "gbuffer_internal.h"

#include <stdio.h>
#include <stdlib.h>

static float *turned_depth(const struct gbuffer *g, enum depth_flip flip)
{
    float *depth = malloc(gbuffer_texels(g) * sizeof *depth);
    for (size_t y = 0; depth && y < g->height; y++) {
        const size_t row = flip & FLIP_ROWS ? g->height - 1 - y : y;
        for (size_t x = 0; x < g->width; x++) {
            const size_t column = flip & FLIP_COLUMNS ? g->width - 1 - x : x;
            depth[y * g->width + x] = g->depth[row * g->width + column];
        }
    }
    return depth;
}

/* As though depth were turned round, and with it the lens, if that is what the shift is of. */
static bool estimate_turned(const struct gbuffer *g, const struct gbuffer_options *options,
                            enum depth_flip flip, bool with_lens, bool is_known, struct fit *fit,
                            struct tool_error *err)
{
    struct gbuffer other = *g;
    other.depth = turned_depth(g, flip);
    if (!other.depth)
        return fail(err, EXIT_MEMORY, "out of memory for depth that is turned round");
    if (with_lens && flip & FLIP_ROWS)
        other.camera.shift_y = -g->camera.shift_y;
    if (with_lens && flip & FLIP_COLUMNS)
        other.camera.shift_x = -g->camera.shift_x;
    const bool ok = is_known ? gbuffer_estimate_known(&other, options, FIT_PATCH_NONE, fit, err)
                             : gbuffer_estimate_single(&other, options, fit, err);
    free(other.depth);
    return ok;
}

/* The best of the three, whatever it is worth. */
static bool try_flips(const struct gbuffer *g, const struct gbuffer_options *options, bool is_known,
                      struct fit *best, enum depth_flip *flip, struct tool_error *err)
{
    const bool is_shifted = is_known && fabs(g->camera.shift_x) + fabs(g->camera.shift_y) > 0;
    *best = (struct fit){0};
    for (int way = FLIP_ROWS; way <= FLIP_BOTH; way++)
        for (int with_lens = 0; with_lens <= is_shifted; with_lens++) {
            struct fit fit;
            if (!estimate_turned(g, options, (enum depth_flip)way, with_lens, is_known, &fit, err))
                return false;
            if (fit.agreement <= best->agreement)
                continue;
            *best = fit;
            *flip = (enum depth_flip)way;
        }
    return true;
}

/* Normals that are wrong in themselves, as by an encoding that somebody tells, fit a little better
 * one way round than another, but never well. Of 110 right files, through their cameras and through
 * none, none gains by being turned; of those that are turned the least gains 0.10, an image of
 * 64 x 48, and the next 0.25. */
static bool is_clear(const struct fit *as_is, const struct fit *turned, bool is_known)
{
    static const double sure_gain = 0.05, clear_gain = 0.2, half = 0.5, most = 0.8,
                        nearly_all = 0.9;
    const double gain = turned->agreement - as_is->agreement;
    /* Squeezed pixels, or depth, are another cause; and a camera that is free explains much. */
    if (fmax(as_is->squeezed, as_is->toned) >= turned->agreement || (!is_known && !turned->is_sure))
        return false;
    /* As it is, where there is depth there are no normals. */
    if (!(as_is->agreement > 0))
        return turned->is_sure && turned->agreement > nearly_all;
    return turned->is_sure ? turned->agreement > half && gain > sure_gain
                           : turned->agreement > most && gain > clear_gain;
}

/* A search takes as long as all else of a small frame: frames of one sequence are alike, and are
 * asked again only where fewer normals agree than in the frame that was asked. */
static bool was_asked(const struct frame_memory *memory, double agreement)
{
    static const double other_agreement = 0.1;
    return memory && memory->is_flip_asked && agreement > memory->flip_agreement - other_agreement;
}

/* As the camera that is found is that of normals, its shift is not that of depth. */
static void turn_fit(struct fit *fit, enum depth_flip flip)
{
    if (flip & FLIP_ROWS)
        fit->shift_y = -fit->shift_y;
    if (flip & FLIP_COLUMNS)
        fit->shift_x = -fit->shift_x;
    fit->rotation_known = false;
}

static void tell(const struct gbuffer *g, double as_is, double turned, const char *path,
                 struct report *report)
{
    static const char *const how[] = {[FLIP_ROWS] = "upside down",
                                      [FLIP_COLUMNS] = "mirrored, left to right,",
                                      [FLIP_BOTH] = "turned by 180 degrees"};
    const struct role *depth = &g->roles.kind[ROLE_DEPTH], *normal = &g->roles.kind[ROLE_NORMAL];
    const bool is_elsewhere = normal->info != depth->info;
    report_warn(report, "flipped depth",
                "%s: depth '%s' is %s against normals '%s'%s%s (%.0f %% of them agree with it once "
                "one is turned, and %.0f %% as they are): normals are derived from depth, and AO "
                "is the way up that depth is; write both the same way up",
                path, depth->label, how[g->flip], normal->label, is_elsewhere ? " of " : "",
                is_elsewhere ? normal->info->path : "", turned * 100.0, as_is * 100.0);
}

bool gbuffer_find_flip(struct gbuffer *g, const struct gbuffer_options *options, bool is_known,
                       struct fit *fit, const char *path, struct report *report,
                       struct tool_error *err)
{
    static const double doubtful_agreement = 0.95;
    struct frame_memory *memory = options->memory;
    struct fit as_is = *fit, turned;
    g->flip = FLIP_NONE;
    /* Of patches more normals agree. */
    if (fit->patch == FIT_PATCH_NONE && fit->agreement > doubtful_agreement)
        return true;
    if (was_asked(memory, fit->agreement) && memory->flip == FLIP_NONE)
        return true;
    if (fit->agreement > 0 && fit->patch != FIT_PATCH_NONE &&
        !(is_known ? gbuffer_estimate_known(g, options, FIT_PATCH_NONE, &as_is, err)
                   : gbuffer_estimate_single(g, options, &as_is, err)))
        return false;
    if (!try_flips(g, options, is_known, &turned, &g->flip, err))
        return false;
    if (!is_clear(&as_is, &turned, is_known))
        g->flip = FLIP_NONE;
    if (memory) {
        memory->is_flip_asked = true;
        memory->flip = g->flip;
        memory->flip_agreement = fit->agreement;
    }
    if (g->flip == FLIP_NONE)
        return true;
    tell(g, as_is.agreement, turned.agreement, path, report);
    *fit = turned;
    turn_fit(fit, g->flip);
    return true;
}
