/* SPDX-License-Identifier: MIT
 *
 * What neither options nor file nor header say of the camera, depth and normals may tell. */
#include "camera_fit.h"
#include "gbuffer_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* As role and options have it, what the depth may be. 0: nothing that an image tells. */
static unsigned possible_models(const struct gbuffer *g, const struct gbuffer_options *options)
{
    enum {
        ALL_RADIAL = 1 << FIT_RADIAL | 1 << FIT_RADIAL_NEAR,
        UNSCALED = 1 << FIT_DEVICE | 1 << FIT_PLANAR_NORMALIZED | 1 << FIT_PLANAR_REVERSED |
                   1 << FIT_RADIAL_NORMALIZED | 1 << FIT_ORTHO_REVERSED
    };
    const bool ortho = g->camera.type == CAMERA_ORTHOGRAPHIC;
    const bool known = g->camera.source[0] != '\0';
    const unsigned parallel = known && !ortho ? 0 : 1u << FIT_ORTHO;
    const bool is_auto =
        options->depth_type == DEPTH_AUTO && g->roles.kind[ROLE_DEPTH].depth_type == DEPTH_AUTO;
    if (known && ortho)
        return g->depth_type == DEPTH_PLANAR || g->depth_type == DEPTH_RADIAL_NEAR ? parallel : 0;
    if (is_auto && g->depth_type == DEPTH_PLANAR)
        return 1u << FIT_PLANAR | 1u << FIT_RADIAL | 1u << FIT_INVERSE | parallel | UNSCALED;
    switch (g->depth_type) {
    case DEPTH_PLANAR:
        return 1u << FIT_PLANAR | parallel;
    case DEPTH_RADIAL:
        return 1u << FIT_RADIAL | parallel;
    case DEPTH_RADIAL_NEAR:
        return ALL_RADIAL | parallel;
    case DEPTH_INVERSE:
        return 1u << FIT_INVERSE;
    default:
        return 0;
    }
}

static void take_depth_type(struct gbuffer *g, const struct fit *fit)
{
    switch (fit->model) {
    case FIT_INVERSE:
        g->depth_type = DEPTH_INVERSE;
        break;
    case FIT_RADIAL:
        g->depth_type = DEPTH_RADIAL;
        break;
    case FIT_RADIAL_NEAR:
        g->depth_type = DEPTH_RADIAL_NEAR;
        if (!(g->camera.near_plane > 0))
            g->camera.near_plane = fit->near_plane;
        break;
    default:
        g->depth_type = DEPTH_PLANAR;
    }
}

static void take_projection(struct gbuffer *g, const struct fit *fit)
{
    struct camera *c = &g->camera;
    const double width = (double)g->display_window.x_max - g->display_window.x_min + 1.0;
    const double height = (double)g->display_window.y_max - g->display_window.y_min + 1.0;
    c->type = fit->model == FIT_ORTHO ? CAMERA_ORTHOGRAPHIC : CAMERA_PERSPECTIVE;
    c->half_width = fit->half_width;
    c->half_height = fit->half_width * height / width / (double)g->pixel_aspect;
    c->shift_x = fit->shift_x;
    c->shift_y = fit->shift_y;
    snprintf(c->source, sizeof c->source, "estimated, +-%.1g %%", fit->bound * 100.0);
}

/* Normals in camera space need no rotation. */
static bool is_camera_space(const struct fit *fit)
{
    const double *r = fit->rotation;
    return r[0] > 0.9999 && r[4] > 0.9999 && fabs(r[8]) > 0.9999;
}

static void take_rotation(struct gbuffer *g, const struct fit *fit)
{
    if (g->camera.has_rotation || !fit->rotation_known)
        return;
    if (is_camera_space(fit)) {
        g->roles.kind[ROLE_NORMAL].normal_space = NORMAL_SPACE_CAMERA;
        return;
    }
    memcpy(g->camera.world_to_view, fit->rotation, sizeof g->camera.world_to_view);
    g->camera.has_rotation = g->camera.axis_certain = true;
    snprintf(g->camera.rotation_source, sizeof g->camera.rotation_source, "estimated");
}

static bool is_unscaled(enum fit_model model)
{
    return model >= FIT_DEVICE;
}

/* False only if memory runs out. */
static bool estimate(struct gbuffer *g, const struct gbuffer_options *options, struct fit *fit,
                     struct tool_error *err)
{
    const bool known = g->camera.source[0] != '\0';
    const struct fit_input input = {
        .depth = g->depth,
        .normals = g->normals,
        .width = g->width,
        .height = g->height,
        .data_window = g->data_window,
        .display_window = g->display_window,
        .pixel_aspect = (double)g->pixel_aspect,
        .models = possible_models(g, options),
        .half_width = known ? g->camera.half_width : 0,
    };
    *fit = (struct fit){0};
    snprintf(fit->why, sizeof fit->why, "depth is of type %s", depth_type_name(g->depth_type));
    if (input.models && !camera_fit(&input, fit, err))
        return false;
    if (fit->is_sure && is_unscaled(fit->model)) {
        fit->is_sure = false;
        snprintf(fit->why, sizeof fit->why, "depth looks normalized");
    }
    return true;
}

static void tell(const struct gbuffer *g, const struct fit *fit, const char *path,
                 struct report *report)
{
    char view[64];
    if (!fit->is_sure) {
        report_warn(report, "camera",
                    "%s: no camera in the header%s%s; assuming 40 degrees horizontal field of view "
                    "(--fov or --camera sets it)",
                    path, fit->why[0] ? ", and the image does not tell it: " : "", fit->why);
        return;
    }
    if (g->camera.type == CAMERA_ORTHOGRAPHIC)
        snprintf(view, sizeof view, "orthographic, width %.5g", g->camera.half_width * 2.0);
    else
        snprintf(view, sizeof view, "%.4g degrees horizontal field of view",
                 camera_fov_x_deg(&g->camera));
    report_warn(report, "camera",
                "%s: no camera in the header; by depth and normals it is %s (%s), depth %s (--fov "
                "or --camera overrides)",
                path, view, g->camera.source, depth_type_name(g->depth_type));
}

bool gbuffer_find_camera(struct gbuffer *g, const struct gbuffer_options *options, const char *path,
                         struct report *report, struct tool_error *err)
{
    const bool known = g->camera.source[0] != '\0';
    const enum normal_space space = options->normal_space != NORMAL_SPACE_AUTO
                                        ? options->normal_space
                                        : g->roles.kind[ROLE_NORMAL].normal_space;
    struct fit fit = {0};
    if (known && (g->camera.has_rotation || space == NORMAL_SPACE_CAMERA || !g->normals))
        return true;
    if (g->normals && !estimate(g, options, &fit, err))
        return false;
    if (fit.is_sure) {
        take_rotation(g, &fit);
        if (!known) {
            take_depth_type(g, &fit);
            take_projection(g, &fit);
        }
    }
    if (!known)
        tell(g, &fit, path, report);
    return true;
}
