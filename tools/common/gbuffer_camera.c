/* SPDX-License-Identifier: MIT
 *
 * What neither options nor file nor header say of the camera, depth and normals may tell. */
#include "camera_fit.h"
#include "camera_positions.h"
#include "gbuffer_internal.h"
#include "median.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* --- From positions --- */

static double display_aspect(const struct gbuffer *g)
{
    const double width = (double)g->display_window.x_max - g->display_window.x_min + 1.0;
    const double height = (double)g->display_window.y_max - g->display_window.y_min + 1.0;
    return width * (double)g->pixel_aspect / height;
}

/* Of normals in camera space, with z towards the eye or away from it. */
static bool is_camera_rotation(const double r[9])
{
    return r[0] > 0.9999 && r[4] > 0.9999 && fabs(r[8]) > 0.9999;
}

static bool is_explicit(const struct camera *camera)
{
    return camera->source[0] == '-' || strcmp(camera->source, "camera file") == 0;
}

/* The camera that is known, with positions in the world (0: looking along -z, 1: along +z) or in
 * camera space (2, 3). */
static bool known_camera(const struct camera *camera, int guess, struct position_camera *out)
{
    static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, nowhere[3] = {0};
    const bool world = guess < 2;
    if (!camera->source[0] || (world && !(camera->has_rotation && camera->has_translation)))
        return false;
    *out = (struct position_camera){
        .is_orthographic = camera->type == CAMERA_ORTHOGRAPHIC,
        .half_width = camera->half_width,
        .shift_x = camera->shift_x,
        .shift_y = camera->shift_y,
    };
    memcpy(out->rotation, world ? camera->world_to_view : identity, sizeof out->rotation);
    memcpy(out->translation, world ? camera->translation : nowhere, sizeof out->translation);
    for (int i = 6; guess % 2 == 1 && i < 9; i++)
        out->rotation[i] = -out->rotation[i];
    if (guess % 2 == 1)
        out->translation[2] = -out->translation[2];
    return true;
}

/* Where positions fix no camera, as those of a plane, the one that is known may see them where they
 * are. */
static bool find_known_camera(const struct gbuffer *g, const struct positions *p,
                              struct position_camera *camera, bool *found, struct tool_error *err)
{
    double least = 2.0; /* texels */
    *found = false;
    for (int guess = 0; guess < 4; guess++) {
        struct position_camera known;
        double miss;
        if (!known_camera(&g->camera, guess, &known))
            continue;
        if (!positions_miss(p, &known, &miss))
            return fail(err, EXIT_MEMORY, "out of memory for the camera of the positions");
        if (miss < least) {
            least = miss;
            *camera = known;
            *found = true;
        }
    }
    return true;
}

static void take_position_projection(struct gbuffer *g, const struct position_camera *camera,
                                     const char *path, struct report *report)
{
    struct camera *c = &g->camera;
    const double apart = c->source[0] ? fabs(log(c->half_width / camera->half_width)) : 0;
    const bool keep = is_explicit(c);
    if (apart > 0.01)
        report_warn(report, "camera positions",
                    "%s: half the width at distance 1 is %.4g by %s and %.4g by the positions: "
                    "that of %s is taken",
                    path, c->half_width, c->source, camera->half_width,
                    keep ? c->source : "the positions");
    if (keep)
        return;
    c->type = camera->is_orthographic ? CAMERA_ORTHOGRAPHIC : CAMERA_PERSPECTIVE;
    c->half_width = camera->half_width;
    c->half_height = camera->half_width / display_aspect(g);
    c->shift_x = camera->shift_x;
    c->shift_y = camera->shift_y;
    snprintf(c->source, sizeof c->source, "positions");
}

/* Normals are in the space of the positions more often than not; if not, what is known of the
 * rotation stays. */
static void take_position_rotation(struct gbuffer *g, const struct position_camera *camera)
{
    struct camera *c = &g->camera;
    struct role *normal = &g->roles.kind[ROLE_NORMAL];
    const bool in_camera_space = is_camera_rotation(camera->rotation);
    /* pbrt's are, in either space. */
    if (!in_camera_space && normal->follows_positions)
        normal->normal_space = NORMAL_SPACE_WORLD;
    if (c->has_rotation)
        return;
    if (in_camera_space) {
        if (normal->normal_space == NORMAL_SPACE_AUTO)
            normal->normal_space = NORMAL_SPACE_CAMERA;
        return;
    }
    memcpy(c->world_to_view, camera->rotation, sizeof c->world_to_view);
    memcpy(c->translation, camera->translation, sizeof c->translation);
    c->has_rotation = c->axis_certain = c->has_translation = true;
    snprintf(c->rotation_source, sizeof c->rotation_source, "positions");
}

/* Planar distance by the depth as stored, if its type is this; a near plane adds to it. */
static double planar_by(const struct gbuffer *g, enum depth_type type, size_t texel)
{
    const double d = fabs((double)g->depth[texel]);
    double x = 0, y = 0;
    if (type == DEPTH_INVERSE)
        return 1.0 / d;
    if (type != DEPTH_PLANAR && g->camera.type == CAMERA_PERSPECTIVE)
        camera_ray(&g->camera, &g->display_window, &g->data_window, (double)(texel % g->width),
                   (double)(texel / g->width), &x, &y);
    return d / sqrt(1.0 + x * x + y * y);
}

/* Medians over the image: how far the type is from the positions, as ln, and what it lacks, in
 * scene units. False if memory runs out. */
static bool hold_against_positions(const struct gbuffer *g, enum depth_type type,
                                   const struct position_camera *camera, const float *positions,
                                   double *apart, double *lack)
{
    const size_t step = gbuffer_sample_step(g), room = gbuffer_texels(g) / step + 1;
    double *logs = malloc(room * sizeof *logs), *lacks = malloc(room * sizeof *lacks);
    size_t count = 0;
    for (size_t i = 0; logs && lacks && i < gbuffer_texels(g); i += step) {
        const double z = position_depth(camera, positions + i * 4), own = planar_by(g, type, i);
        if (!positions_are_there(positions + i * 4) || !(z > 0 && own > 0 && isfinite(own)))
            continue;
        logs[count] = fabs(log(own / z));
        lacks[count++] = z - own;
    }
    const bool ok = logs && lacks;
    *apart = ok && count ? median_of(logs, count) : HUGE_VAL;
    *lack = ok && count ? median_of(lacks, count) : 0;
    free(logs);
    free(lacks);
    return ok;
}

/* What the depth beside the positions is, where only its name or nobody says so, and the near plane
 * that it starts from. */
static bool settle_depth_type(struct gbuffer *g, const struct gbuffer_options *options,
                              const struct position_camera *camera, const float *positions,
                              struct tool_error *err)
{
    static const enum depth_type types[] = {DEPTH_PLANAR, DEPTH_RADIAL, DEPTH_INVERSE};
    double least = 0.01, apart, lack;
    bool ok = true;
    if (g->depth_type == DEPTH_RADIAL_NEAR) {
        ok = hold_against_positions(g, DEPTH_RADIAL, camera, positions, &apart, &lack);
        if (ok && isfinite(apart) && !(g->camera.near_plane > 0)) {
            g->camera.near_plane = lack > 0 ? lack : 0;
            g->depth_type = lack > 0 ? DEPTH_RADIAL_NEAR : DEPTH_RADIAL;
            g->depth_source = DEPTH_BY_POSITIONS;
        }
    } else if (options->depth_type == DEPTH_AUTO &&
               g->roles.kind[ROLE_DEPTH].depth_type == DEPTH_AUTO) {
        for (size_t i = 0; ok && i < sizeof types / sizeof *types; i++) {
            ok = hold_against_positions(g, types[i], camera, positions, &apart, &lack);
            if (ok && apart < least) {
                least = apart;
                g->depth_type = types[i];
                g->depth_source = DEPTH_BY_POSITIONS;
            }
        }
    }
    return ok || fail(err, EXIT_MEMORY, "out of memory for the camera of the positions");
}

static bool fail_positions(const struct gbuffer *g, const char *why, const char *path,
                           struct tool_error *err)
{
    fail_hint(err, "add --camera FILE.json with \"world_to_view\", or --depth NAME");
    return fail(err, EXIT_CHANNELS,
                "%s: no depth, and positions '%s' do not give it: %s, and no camera that is known "
                "sees them where they are",
                path, g->roles.kind[ROLE_DEPTH].label, why);
}

bool gbuffer_use_positions(struct gbuffer *g, const struct gbuffer_options *options,
                           const float *positions, const char *path, struct report *report,
                           struct tool_error *err)
{
    const struct positions p = {
        .values = positions,
        .width = g->width,
        .height = g->height,
        .data_window = g->data_window,
        .display_window = g->display_window,
        .pixel_aspect = (double)g->pixel_aspect,
    };
    struct position_camera camera;
    bool found;
    if (!camera_from_positions(&p, &camera, err))
        return false;
    found = camera.is_sure;
    if (found) {
        take_position_projection(g, &camera, path, report);
        take_position_rotation(g, &camera);
    }
    if (g->depth_type != DEPTH_POSITION)
        return !found || camera.is_orthographic ||
               settle_depth_type(g, options, &camera, positions, err);
    char why[sizeof camera.why];
    memcpy(why, camera.why, sizeof why);
    if (!found && !find_known_camera(g, &p, &camera, &found, err))
        return false;
    if (!found)
        return fail_positions(g, why, path, err);
    for (size_t i = 0; i < gbuffer_texels(g); i++) {
        const float *position = positions + i * 4;
        g->depth[i] = positions_are_there(position) ? (float)position_depth(&camera, position) : 0;
    }
    g->depth_type = DEPTH_PLANAR;
    return true;
}

/* --- From depth and normals --- */

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
    g->depth_source = DEPTH_BY_NORMALS;
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
    c->type = fit->model == FIT_ORTHO ? CAMERA_ORTHOGRAPHIC : CAMERA_PERSPECTIVE;
    c->half_width = fit->half_width;
    c->half_height = fit->half_width / display_aspect(g);
    c->shift_x = fit->shift_x;
    c->shift_y = fit->shift_y;
    c->bound = fit->bound;
    snprintf(c->source, sizeof c->source, "estimated, +-%.1g %%", fit->bound * 100.0);
}

static void take_rotation(struct gbuffer *g, const struct fit *fit)
{
    if (g->camera.has_rotation || !fit->rotation_known)
        return;
    if (is_camera_rotation(fit->rotation)) {
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

/* --- From frame to frame --- */

static void take_remembered(struct gbuffer *g, const struct camera_memory *memory)
{
    struct camera *c = &g->camera;
    const struct camera *from = &memory->camera;
    c->type = from->type;
    c->half_width = from->half_width;
    c->half_height = from->half_height;
    c->shift_x = from->shift_x;
    c->shift_y = from->shift_y;
    c->near_plane = from->near_plane;
    c->bound = from->bound;
    memcpy(c->source, from->source, sizeof c->source);
    g->depth_type = memory->depth_type;
}

/* The camera of the frames before, where this one agrees with it; else this one's from now on. */
static void remember(struct gbuffer *g, const struct fit *fit, const char *path,
                     struct camera_memory *memory, struct report *report)
{
    const struct camera *c = &g->camera, *before = &memory->camera;
    const bool same = memory->is_known && memory->depth_type == g->depth_type &&
                      before->type == c->type &&
                      fabs(log(before->half_width / c->half_width)) <= before->bound + c->bound;
    if (same) {
        take_remembered(g, memory);
        return;
    }
    if (memory->is_known)
        report_warn(report, "camera change",
                    "%s: another camera than that of the frames before: half the width at distance "
                    "1 is %.4g, was %.4g",
                    path, c->half_width, before->half_width);
    *memory = (struct camera_memory){
        .is_known = true, .camera = *c, .depth_type = g->depth_type, .models = 1u << fit->model};
}

/* --- The whole --- */

/* False only if memory runs out. */
static bool estimate_as(struct gbuffer *g, unsigned models, double near_half_width, struct fit *fit,
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
        .models = models,
        .half_width = known ? g->camera.half_width : 0,
        .near_half_width = near_half_width,
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

/* Near what it was in the frames before, and everywhere if it is not there. */
static bool estimate(struct gbuffer *g, const struct gbuffer_options *options, struct fit *fit,
                     struct tool_error *err)
{
    const struct camera_memory *memory = options->memory;
    if (memory && memory->is_known && !g->camera.source[0] &&
        !estimate_as(g, memory->models, memory->camera.half_width, fit, err))
        return false;
    return fit->is_sure || estimate_as(g, possible_models(g, options), 0, fit, err);
}

static void tell(struct gbuffer *g, const struct fit *fit, const char *path, struct report *report)
{
    char view[64];
    if (!fit->is_sure) {
        report_warn(report, "camera",
                    "%s: no camera in the header%s%s; assuming 40 degrees horizontal field of view "
                    "(--fov or --camera sets it)",
                    path, fit->why[0] ? ", and the image does not tell it: " : "", fit->why);
        if (fit->why[0] && !g->camera.remark[0])
            snprintf(g->camera.remark, sizeof g->camera.remark, "the image does not tell it: %s",
                     fit->why);
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

/* A frame that does not tell, of a sequence whose others did. */
static bool keep_remembered(struct gbuffer *g, const struct gbuffer_options *options,
                            const char *path, struct report *report, struct tool_error *err)
{
    struct fit fit = {0};
    take_remembered(g, options->memory);
    report_warn(report, "camera kept",
                "%s: this frame does not tell the camera: that of the frames before is taken",
                path);
    if (g->normals && !estimate(g, options, &fit, err))
        return false;
    if (fit.is_sure)
        take_rotation(g, &fit);
    return true;
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
    if (g->normals && !g->camera.is_assumed && !estimate(g, options, &fit, err))
        return false;
    if (fit.is_sure) {
        take_rotation(g, &fit);
        if (!known) {
            take_depth_type(g, &fit);
            take_projection(g, &fit);
            if (options->memory)
                remember(g, &fit, path, options->memory, report);
        }
    } else if (!known && options->memory && options->memory->is_known && !g->camera.is_assumed) {
        return keep_remembered(g, options, path, report, err);
    }
    if (!known)
        tell(g, &fit, path, report);
    return true;
}
