/* SPDX-License-Identifier: MIT
 *
 * What options, the name of a channel or the program that wrote it say of depth, held against its
 * normals. Through a camera that is known they are those of one type alone. What is told is
 * believed all the same. */
#include "gbuffer_internal.h"

#include <stdio.h>

enum { REMEDY_BYTES = 96 };

/* Of right types none is bettered by another one that is sure. A narrow view looks much the same
 * as any type, and so does its AO. */
static const double least_gain = 0.02;

/* What is told excludes itself. To see no near plane, or one that nobody tells, is no other type:
 * that is said of the near plane. */
static unsigned other_models(enum depth_type told)
{
    enum {
        RADIAL = 1 << FIT_RADIAL | 1 << FIT_RADIAL_NEAR,
        NORMALIZED =
            1 << FIT_PLANAR_NORMALIZED | 1 << FIT_PLANAR_REVERSED | 1 << FIT_RADIAL_NORMALIZED,
        ALL = 1 << FIT_PLANAR | RADIAL | 1 << FIT_INVERSE | 1 << FIT_DEVICE | NORMALIZED
    };
    switch (told) {
    case DEPTH_PLANAR:
        return ALL & ~(1u << FIT_PLANAR);
    case DEPTH_RADIAL:
    case DEPTH_RADIAL_NEAR:
        return ALL & ~(unsigned)RADIAL;
    case DEPTH_INVERSE:
        return (ALL & ~(1u << FIT_INVERSE)) | 1u << FIT_INVERSE_RADIAL;
    case DEPTH_DEVICE:
        return ALL & ~(1u << FIT_DEVICE | 1u << FIT_INVERSE);
    case DEPTH_NORMALIZED:
        return ALL & ~(1u << FIT_PLANAR | RADIAL | NORMALIZED);
    default:
        return 0;
    }
}

bool gbuffer_find_type(const struct gbuffer *g, const struct gbuffer_options *options,
                       const struct fit *told, struct fit *other, struct tool_error *err)
{
    const bool is_told = !gbuffer_type_is_auto(g, options) && g->depth_source == DEPTH_ASSUMED;
    /* 1/z that planes or a program tell may be that of another distance. */
    const unsigned models = is_told                          ? other_models(g->depth_type)
                            : g->depth_type == DEPTH_INVERSE ? 1u << FIT_INVERSE_RADIAL
                                                             : 0;
    *other = (struct fit){0};
    if (!models || g->camera.type != CAMERA_PERSPECTIVE)
        return true;
    const struct camera_search search = {.models = models, .is_known = true, .patch = told->patch};
    if (!gbuffer_fit_camera(g, &search, other, err))
        return false;
    other->is_sure &= other->agreement - told->agreement >= least_gain;
    return true;
}

static void describe_remedy(const struct gbuffer *g, const struct fit *other,
                            char remedy[REMEDY_BYTES])
{
    const bool lacks_near = !(g->camera.near_plane > 0);
    switch (other->model) {
    case FIT_PLANAR:
        snprintf(remedy, REMEDY_BYTES, "planar");
        break;
    case FIT_RADIAL:
        snprintf(remedy, REMEDY_BYTES, "radial");
        break;
    case FIT_RADIAL_NEAR:
        if (lacks_near)
            snprintf(remedy, REMEDY_BYTES, "radial-near with --near %.4g", other->near_plane);
        else
            snprintf(remedy, REMEDY_BYTES, "radial-near");
        break;
    case FIT_INVERSE:
        snprintf(remedy, REMEDY_BYTES, "inverse");
        break;
    case FIT_DEVICE:
        snprintf(remedy, REMEDY_BYTES, "device with --near and --far");
        break;
    default:
        snprintf(remedy, REMEDY_BYTES, "normalized with --depth-range NEAR,FAR[,inverted]");
    }
}

const char *gbuffer_teller_of_type(const struct gbuffer *g, const struct gbuffer_options *options)
{
    if (g->camera.depth_type != DEPTH_AUTO)
        return "the camera file";
    if (g->has_told_ends)
        return g->depth_type == DEPTH_NORMALIZED ? "--depth-range" : "--far";
    return options->depth_type != DEPTH_AUTO ? "--depth-type" : "its name";
}

void gbuffer_tell_type(const struct gbuffer *g, const struct gbuffer_options *options,
                       const struct fit *told, const struct fit *other, const char *path,
                       struct report *report)
{
    const char *type = depth_type_name(g->depth_type);
    char remedy[REMEDY_BYTES];
    if (other->model == FIT_INVERSE_RADIAL) {
        report_warn_of_frame(
            report, "doubted depth",
            "%s: depth '%s' is taken as 1/z, but by normals '%s' it is 1 over distances from the "
            "eye (%.0f %% of them agree then, and %.0f %% as it is taken): AO is wrong; write 1 "
            "over it, and say --depth-type radial",
            path, g->roles.kind[ROLE_DEPTH].label, g->roles.kind[ROLE_NORMAL].label,
            other->agreement * 100.0, told->agreement * 100.0);
        return;
    }
    describe_remedy(g, other, remedy);
    report_warn_of_frame(
        report, "doubted depth",
        "%s: %s says that depth '%s' is %s, but by normals '%s' it is %.*s (%.0f %% of them agree "
        "then, and %.0f %% as it says): %s is taken (--depth-type %s overrides)",
        path, gbuffer_teller_of_type(g, options), g->roles.kind[ROLE_DEPTH].label, type,
        g->roles.kind[ROLE_NORMAL].label, (int)strcspn(remedy, " "), remedy,
        other->agreement * 100.0, told->agreement * 100.0, type, remedy);
}

bool gbuffer_doubt_inverse(const struct gbuffer *g, const struct gbuffer_options *options,
                           const char *path, struct report *report, struct tool_error *err)
{
    struct fit told, other;
    if (g->depth_type != DEPTH_INVERSE || !g->normals || !g->camera.source[0])
        return true;
    if (!gbuffer_estimate_known(g, options, FIT_PATCH_ANY, &told, err) ||
        !gbuffer_find_type(g, options, &told, &other, err))
        return false;
    if (other.is_sure)
        gbuffer_tell_type(g, options, &told, &other, path, report);
    return true;
}
