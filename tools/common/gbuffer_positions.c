/* SPDX-License-Identifier: MIT
 *
 * Where all points are, the camera and depth are too. */
#include "camera_positions.h"
#include "gbuffer_internal.h"
#include "median.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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
 * are. *least: by how many texels it misses them, INFINITY without one; by no more than most, if it
 * does. */
static bool find_known_camera(const struct gbuffer *g, const struct positions *p, double most,
                              struct position_camera *camera, bool *found, double *least,
                              struct tool_error *err)
{
    *least = INFINITY;
    for (int guess = 0; guess < 4; guess++) {
        struct position_camera known;
        double miss;
        if (!known_camera(&g->camera, guess, &known))
            continue;
        if (!positions_miss(p, &known, &miss))
            return fail(err, EXIT_MEMORY, "out of memory for the camera of the positions");
        if (miss < *least) {
            *least = miss;
            *camera = known;
        }
    }
    *found = *least < most;
    return true;
}

static void take_position_projection(struct gbuffer *g, const struct position_camera *camera,
                                     const char *path, struct report *report)
{
    struct camera *c = &g->camera;
    const double apart = c->source[0] ? fabs(log(c->half_width / camera->half_width)) : 0;
    const bool keep = gbuffer_camera_is_explicit(c);
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
    c->half_height = camera->half_width / gbuffer_aspect(g);
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
    const bool in_camera_space = gbuffer_is_camera_rotation(camera->rotation);
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

/* A type of depth against the positions, as medians over the image. */
struct comparison {
    double unit;  /* ln of how many times as long it is */
    double apart; /* from that, as ln */
    double lack;  /* of it, scene units */
};

/* near: added to what depth says. False if memory runs out. */
static bool hold_against_positions(const struct gbuffer *g, enum depth_type type, double near,
                                   const struct position_camera *camera, const float *positions,
                                   struct comparison *c)
{
    const size_t step = gbuffer_sample_step(g), room = gbuffer_texels(g) / step + 1;
    double *logs = malloc(room * sizeof *logs), *lacks = malloc(room * sizeof *lacks);
    size_t count = 0;
    for (size_t i = 0; logs && lacks && i < gbuffer_texels(g); i += step) {
        const double z = position_depth(camera, positions + i * 4);
        const double own = planar_by(g, type, i) + near;
        if (!positions_are_there(positions + i * 4) || !(z > 0 && gbuffer_is_measurable(own)))
            continue;
        logs[count] = log(own / z);
        lacks[count++] = z - own;
    }
    const bool ok = logs && lacks;
    *c = (struct comparison){.apart = HUGE_VAL};
    if (ok && count) {
        c->unit = median_of(logs, count);
        for (size_t i = 0; i < count; i++)
            logs[i] = fabs(logs[i] - c->unit);
        c->apart = median_of(logs, count);
        c->lack = median_of(lacks, count);
    }
    free(logs);
    free(lacks);
    return ok;
}

static bool fail_memory(struct tool_error *err)
{
    return fail(err, EXIT_MEMORY, "out of memory for the camera of the positions");
}

/* The near plane that depth starts from, where its name says that there is one. */
static bool settle_near_plane(struct gbuffer *g, const struct position_camera *camera,
                              const float *positions, struct tool_error *err)
{
    struct comparison c;
    if (g->camera.near_plane > 0)
        return true;
    if (!hold_against_positions(g, DEPTH_RADIAL, 0, camera, positions, &c))
        return fail_memory(err);
    if (isfinite(c.apart)) {
        g->camera.near_plane = c.lack > 0 ? c.lack : 0;
        g->depth_type = c.lack > 0 ? DEPTH_RADIAL_NEAR : DEPTH_RADIAL;
        g->depth_source = DEPTH_BY_POSITIONS;
    }
    return true;
}

static void fill_depth(struct gbuffer *g, const struct position_camera *camera,
                       const float *positions)
{
    for (size_t i = 0; i < gbuffer_texels(g); i++) {
        const float *position = positions + i * 4;
        g->depth[i] = positions_are_there(position) ? (float)position_depth(camera, position) : 0;
    }
    g->depth_type = DEPTH_PLANAR;
}

/* Of the same shape, but longer: centimetres beside metres. */
static void warn_about_unit(const struct gbuffer *g, double ratio, const char *path,
                            struct report *report)
{
    /* Rounding of halves leaves a thousandth. */
    if (fabs(ratio) > 0.01)
        report_warn(report, "unit of depth",
                    "%s: depth '%s' is %.4g times what the positions '%s' say: another unit? "
                    "a --radius in scene units is in that of the depth (--depth '%s' takes depth "
                    "from the positions)",
                    path, g->roles.kind[ROLE_DEPTH].label, exp(ratio),
                    g->roles.kind[ROLE_POSITION].label, g->roles.kind[ROLE_POSITION].label);
}

/* Radial from a near plane, where that is not to be seen in a name: at the distance that the camera
 * tells, or that positions show. Halves leave a thousandth. */
static bool find_near_plane(struct gbuffer *g, const struct position_camera *camera,
                            const float *positions, bool *is_found, struct tool_error *err)
{
    static const double exact = 0.002;
    struct comparison c;
    *is_found = false;
    if (!hold_against_positions(g, DEPTH_RADIAL, 0, camera, positions, &c))
        return fail_memory(err);
    const double near = g->camera.near_plane > 0 ? g->camera.near_plane : c.lack;
    if (!isfinite(c.apart) || !(near > 0))
        return true;
    if (!hold_against_positions(g, DEPTH_RADIAL, near, camera, positions, &c))
        return fail_memory(err);
    *is_found = c.apart < exact && fabs(c.unit) < exact;
    if (*is_found) {
        g->camera.near_plane = near;
        g->depth_type = DEPTH_RADIAL_NEAR;
        g->depth_source = DEPTH_BY_POSITIONS;
    }
    return true;
}

/* What the depth beside the positions is, where nobody says so. What they do not explain, they
 * replace. */
static bool settle_depth_type(struct gbuffer *g, const struct position_camera *camera,
                              const float *positions, const char *path, struct report *report,
                              struct tool_error *err)
{
    static const enum depth_type types[] = {DEPTH_PLANAR, DEPTH_RADIAL, DEPTH_INVERSE};
    struct role *depth = &g->roles.kind[ROLE_DEPTH];
    struct comparison best = {.apart = HUGE_VAL}, c;
    enum depth_type type = DEPTH_PLANAR;
    for (size_t i = 0; i < sizeof types / sizeof *types; i++) {
        if (!hold_against_positions(g, types[i], 0, camera, positions, &c))
            return fail_memory(err);
        if (c.apart + 0.1 * fabs(c.unit) < best.apart + 0.1 * fabs(best.unit)) {
            best = c;
            type = types[i];
        }
    }
    /* Smaller numbers of the same kind are parts of a range more often than kilometres. */
    if (best.apart < 0.01 && best.unit > -0.01) {
        g->depth_type = type;
        g->depth_source = DEPTH_BY_POSITIONS;
        warn_about_unit(g, best.unit, path, report);
        return true;
    }
    bool is_near;
    if (!find_near_plane(g, camera, positions, &is_near, err))
        return false;
    if (is_near)
        return true;
    report_warn(report, "depth beside positions",
                "%s: depth '%s' is not that of the positions '%s', neither planar nor radial nor "
                "1/z: depth is taken from them (--depth '%s' takes it all the same)",
                path, depth->label, g->roles.kind[ROLE_POSITION].label, depth->label);
    fill_depth(g, camera, positions);
    *depth = g->roles.kind[ROLE_POSITION];
    depth->depth_type = DEPTH_POSITION;
    return true;
}

/* --- Background --- */

static int compare_points(const void *a, const void *b)
{
    const float *p = a, *q = b;
    for (int c = 0; c < 3; c++)
        if (p[c] < q[c] || p[c] > q[c])
            return p[c] < q[c] ? -1 : 1;
    return 0;
}

/* The most frequent of sorted points, if it is that by far: no camera sees one point in many
 * texels. Steps of halves, and enlarging, repeat all points alike. */
static bool find_repeated(const float *points, size_t count, float repeated[3])
{
    static const double least_share = 0.002;
    enum { FEW = 16, BY_FAR = 10 };
    size_t most = 0, second = 0;
    for (size_t i = 0, run; i < count; i += run) {
        for (run = 1;
             i + run < count && compare_points(points + i * 3, points + (i + run) * 3) == 0;)
            run++;
        if (run > most) {
            second = most;
            most = run;
            memcpy(repeated, points + i * 3, 3 * sizeof *repeated);
        } else if (run > second) {
            second = run;
        }
    }
    return most >= FEW && (double)most >= least_share * (double)count && most >= BY_FAR * second;
}

/* Of a value that some program writes where there is nothing, as -1, it becomes 0. False if memory
 * ran out. */
static bool clear_background(const struct gbuffer *g, float *positions)
{
    enum { MOST = 1 << 16 };
    const size_t step = gbuffer_texels(g) / MOST + 1;
    float *points = malloc((gbuffer_texels(g) / step + 1) * 3 * sizeof *points), repeated[3];
    size_t count = 0;
    if (!points)
        return false;
    for (size_t i = 0; i < gbuffer_texels(g); i += step)
        if (positions_are_there(positions + i * 4))
            memcpy(points + 3 * count++, positions + i * 4, 3 * sizeof *points);
    qsort(points, count, 3 * sizeof *points, compare_points);
    const bool is_found = find_repeated(points, count, repeated);
    for (size_t i = 0; is_found && i < gbuffer_texels(g); i++)
        if (compare_points(positions + i * 4, repeated) == 0)
            memset(positions + i * 4, 0, 3 * sizeof *positions);
    free(points);
    return true;
}

static bool knows_placement(const struct gbuffer *g)
{
    return g->camera.source[0] && g->camera.has_rotation && g->camera.has_translation;
}

/* miss: of the camera that is known, texels; INFINITY: it does not see them. */
static bool fail_positions(const struct gbuffer *g, const char *why, double miss, const char *path,
                           struct tool_error *err)
{
    const char *label = g->roles.kind[ROLE_DEPTH].label;
    if (!knows_placement(g)) {
        fail_hint(err, "add --camera FILE.json with \"world_to_view\", or --depth NAME");
        return fail(err, EXIT_CHANNELS,
                    "%s: no depth, and positions '%s' do not give it: %s, and no camera that is "
                    "known sees them where they are",
                    path, label, why);
    }
    fail_hint(err, "render depth too and name it, --depth NAME; or give the camera of this image, "
                   "if that was no fisheye or panorama");
    if (!isfinite(miss))
        return fail(err, EXIT_CHANNELS,
                    "%s: no depth, and positions '%s' do not give it: %s, and the camera that is "
                    "known (%s) does not see them",
                    path, label, why, g->camera.source);
    return fail(err, EXIT_CHANNELS,
                "%s: no depth, and positions '%s' do not give it: %s, and the camera that is known "
                "(%s) sees them %.3g pixels from where they are",
                path, label, why, g->camera.source, miss);
}

/* Texels, of rounding; and a lens moves what is seen by some hundredths of the image's width, and
 * not how far it is. */
static const double most_of_rounding = 2.0, most_of_lens = 0.03;

static double most_missed(const struct gbuffer *g, const char *why)
{
    const double width = (double)g->display_window.x_max - g->display_window.x_min + 1.0;
    const bool is_bent = strcmp(why, "they fit no camera") == 0 && knows_placement(g);
    return fmax(most_of_rounding, is_bent ? most_of_lens * width : 0);
}

static void warn_of_lens(const struct gbuffer *g, double miss, const char *path,
                         struct report *report)
{
    report_warn(report, "bent positions",
                "%s: positions '%s' are seen by no camera without a lens that distorts: depth is "
                "along the axis of the one that is known (%s), %.3g pixels from where it sees "
                "them; write the image undistorted for exact AO",
                path, g->roles.kind[ROLE_DEPTH].label, g->camera.source, miss);
}

bool gbuffer_use_positions(struct gbuffer *g, const struct gbuffer_options *options,
                           float *positions, const char *path, struct report *report,
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
    if (!clear_background(g, positions))
        return fail_memory(err);
    if (!camera_from_positions(&p, &camera, err))
        return false;
    found = camera.is_sure;
    if (found) {
        take_position_projection(g, &camera, path, report);
        take_position_rotation(g, &camera);
    }
    if (g->depth_type != DEPTH_POSITION) {
        const bool is_auto = options->depth_type == DEPTH_AUTO;
        if (!found || camera.is_orthographic || options->roles.name[ROLE_DEPTH])
            return true;
        if (g->depth_type == DEPTH_RADIAL_NEAR)
            return settle_near_plane(g, &camera, positions, err);
        return !is_auto || g->roles.kind[ROLE_DEPTH].depth_type != DEPTH_AUTO ||
               settle_depth_type(g, &camera, positions, path, report, err);
    }
    char why[sizeof camera.why];
    memcpy(why, camera.why, sizeof why);
    double miss = 0;
    if (!found && !find_known_camera(g, &p, most_missed(g, why), &camera, &found, &miss, err))
        return false;
    if (!found)
        return fail_positions(g, why, miss, path, err);
    if (miss >= most_of_rounding)
        warn_of_lens(g, miss, path, report);
    fill_depth(g, &camera, positions);
    return true;
}
