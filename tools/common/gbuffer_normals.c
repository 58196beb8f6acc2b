/* SPDX-License-Identifier: MIT
 *
 * Normals come in world or camera space, and no header says which. Names and the pixels do: what
 * the camera sees faces it, and they agree with the depth. */
#include "gbuffer_internal.h"
#include "text.h"

#include <math.h>
#include <string.h>

static const float identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
static const float flipped_z[9] = {1, 0, 0, 0, 1, 0, 0, 0, -1};

/* --- Space --- */

/* Camera space: as OpenGL has it, or with z away from the eye (RenderMan, pbrt). */
static bool camera_matrix(const struct gbuffer *g, float matrix[9], struct normal_facing *facing)
{
    struct normal_facing away;
    if (!gbuffer_measure_facing(g, identity, facing) ||
        !gbuffer_measure_facing(g, flipped_z, &away))
        return false;
    bool flip = away.share > facing->share;
    memcpy(matrix, flip ? flipped_z : identity, sizeof identity);
    if (flip)
        *facing = away;
    return true;
}

/* World space: where the header leaves open which way the camera looks, the normals know. */
static bool world_matrix(const struct gbuffer *g, float matrix[9], struct normal_facing *facing)
{
    camera_normal_to_view(&g->camera, matrix);
    if (!gbuffer_measure_facing(g, matrix, facing))
        return false;
    if (g->camera.axis_certain)
        return true;
    float turned[9];
    struct normal_facing other;
    memcpy(turned, matrix, sizeof turned);
    for (int column = 0; column < 3; column++)
        turned[column * 3 + 2] = -turned[column * 3 + 2];
    if (!gbuffer_measure_facing(g, turned, &other))
        return false;
    if (other.share > facing->share) {
        memcpy(matrix, turned, sizeof turned);
        *facing = other;
    }
    return true;
}

static bool fail_without_rotation(const char *path, struct tool_error *err)
{
    fail_hint(err, "add --camera FILE.json with \"world_to_view\", or --normal none");
    return fail(err, EXIT_CHANNELS, "%s: world-space normals need the rotation of the camera",
                path);
}

/* --- By agreement with the depth --- */

/* Ways to turn stored normals into view space: out of the world by the rotation that is told, with
 * camera axes either way, or out of the world by the rotation that the image shows. */
enum { WAY_WORLD, WAY_CAMERA, FLIPS = 4, WAY_SEEN = WAY_CAMERA + FLIPS, WAYS };

static enum normal_space space_of(int way)
{
    return way == WAY_WORLD || way == WAY_SEEN ? NORMAL_SPACE_WORLD : NORMAL_SPACE_CAMERA;
}

struct way {
    bool is_known;
    float matrix[9];
    struct agreement agreement;
};

/* What agrees comes before names and looks if it does so for this share of the normals, and for
 * this much more than what they say. Below the last nothing agrees. Below the last but one it is
 * asked why: faces with pores and fur agree by 17 to 35 %, and no share tells them from wrong
 * cameras. */
static const double least_agreement = 0.35, clear_agreement = 0.15, poor_agreement = 0.25,
                    no_agreement = 0.12;
/* Planes agree nearly all over. */
static const double least_of_planes = 0.8;
enum { FEW_PAIRS = 200 };

/* Of what points away from the eye all three axes are the other way round. */
static void judge_way(struct way *way, const struct normal_pairs *pairs)
{
    way->is_known = true;
    way->agreement = gbuffer_agreement(pairs, way->matrix);
    if (way->agreement.facing < 0.3 && way->agreement.share > least_agreement)
        gbuffer_turn_round(way->matrix);
}

static void judge_ways(struct way ways[WAYS], const struct normal_pairs *pairs,
                       const struct gbuffer *g, const float world[9])
{
    static const float flips[FLIPS][3] = {{1, 1, 1}, {1, 1, -1}, {1, -1, 1}, {-1, 1, 1}};
    memset(ways, 0, WAYS * sizeof *ways);
    if (g->camera.has_rotation) {
        memcpy(ways[WAY_WORLD].matrix, world, sizeof ways->matrix);
        judge_way(&ways[WAY_WORLD], pairs);
    }
    for (int i = 0; g->has_seen_rotation && i < 9; i++)
        ways[WAY_SEEN].matrix[i % 3 * 3 + i / 3] = (float)g->seen_rotation[i];
    if (g->has_seen_rotation)
        judge_way(&ways[WAY_SEEN], pairs);
    for (int f = 0; f < FLIPS; f++) {
        struct way *way = &ways[WAY_CAMERA + f];
        for (int c = 0; c < 3; c++)
            way->matrix[c * 4] = flips[f][c];
        judge_way(way, pairs);
    }
}

/* The earlier of those that agree as well; NULL if none may be. */
static const struct way *best_way(const struct way ways[WAYS], enum normal_space wanted)
{
    const struct way *best = NULL;
    for (int w = 0; w < WAYS; w++) {
        if (ways[w].is_known && (wanted == NORMAL_SPACE_AUTO || wanted == space_of(w)) &&
            (!best || ways[w].agreement.share > best->agreement.share + 0.02))
            best = &ways[w];
    }
    return best;
}

static void tell_way(const struct gbuffer *g, double before, bool is_seen, const char *path,
                     struct report *report)
{
    const float *m = g->view.normal_to_view;
    const char *label = g->roles.kind[ROLE_NORMAL].label;
    if (is_seen)
        report_warn(report, "agreeing normals",
                    "%s: normals '%s' hardly agree with the depth (%.0f %%) by the rotation of %s: "
                    "that of the image is taken (%.0f %%)",
                    path, label, before * 100.0, g->camera.rotation_source,
                    g->normal_agreement * 100.0);
    else if (g->normal_space == NORMAL_SPACE_WORLD)
        report_warn(report, "agreeing normals",
                    "%s: normals '%s' are in world space by agreement with the depth "
                    "(--normal-space overrides)",
                    path, label);
    else
        report_warn(report, "agreeing normals",
                    "%s: normals '%s' are in camera space (%cx%cy%cz) by agreement with the depth "
                    "(--normal-space overrides)",
                    path, label, m[0] < 0 ? '-' : '+', m[4] < 0 ? '-' : '+', m[8] < 0 ? '-' : '+');
}

/* Changes what names and looks have chosen, which may be nothing, if the depth knows better. */
static void ask_depth(struct gbuffer *g, const struct way ways[WAYS],
                      const struct normal_pairs *pairs, bool is_plane, enum normal_space wanted,
                      const char *path, struct report *report)
{
    const double least = is_plane ? least_of_planes : least_agreement;
    const bool has_chosen = g->normal_space != NORMAL_SPACE_AUTO;
    const struct way *best = best_way(ways, wanted);
    if (pairs->count < FEW_PAIRS || !best)
        return;
    g->normal_agreement = has_chosen ? gbuffer_agreement(pairs, g->view.normal_to_view).share : 0;
    if (best->agreement.share >= least &&
        best->agreement.share > g->normal_agreement + clear_agreement) {
        const enum normal_space before = g->normal_space;
        const double by_before = g->normal_agreement;
        const bool is_seen = best == &ways[WAY_SEEN];
        g->normal_space = space_of((int)(best - ways));
        g->normal_agreement = best->agreement.share;
        memcpy(g->view.normal_to_view, best->matrix, sizeof best->matrix);
        if (is_seen || before != g->normal_space || g->normal_space == NORMAL_SPACE_CAMERA)
            tell_way(g, by_before, is_seen, path, report);
    }
}

/* --- The choice --- */

/* By name, camera and looks; AUTO: none of them tells. */
static bool choose_space(struct gbuffer *g, enum normal_space wanted, float world[9],
                         struct tool_error *err, const char *path)
{
    float camera[9];
    struct normal_facing by_world = {0}, by_camera;
    const enum normal_space named = g->roles.kind[ROLE_NORMAL].normal_space;
    const bool rotation = g->camera.has_rotation;
    if (!camera_matrix(g, camera, &by_camera) || (rotation && !world_matrix(g, world, &by_world)))
        return fail(err, EXIT_MEMORY, "%s: out of memory", path);
    const bool camera_fits = by_camera.share > 0.98 && by_camera.median_z > 0.25;
    enum normal_space space = wanted != NORMAL_SPACE_AUTO ? wanted : named;
    if (space == NORMAL_SPACE_AUTO)
        space = rotation ? NORMAL_SPACE_WORLD : camera_fits ? NORMAL_SPACE_CAMERA : space;
    if (wanted == NORMAL_SPACE_AUTO && space == NORMAL_SPACE_WORLD && rotation && camera_fits &&
        by_world.share < 0.9)
        space = NORMAL_SPACE_CAMERA;
    if (space == NORMAL_SPACE_WORLD && !rotation)
        space = NORMAL_SPACE_AUTO;
    g->normal_space = space;
    if (space != NORMAL_SPACE_AUTO)
        memcpy(g->view.normal_to_view, space == NORMAL_SPACE_WORLD ? world : camera,
               sizeof g->view.normal_to_view);
    return true;
}

/* One normal everywhere is that of a plane, or of none: tangent space has it. */
static bool are_alike(const struct normal_pairs *pairs)
{
    static const double same = 0.9999;
    for (size_t i = 1; i < pairs->count; i++) {
        const double *a = pairs->pair[0].stored, *b = pairs->pair[i].stored;
        if (a[0] * b[0] + a[1] * b[1] + a[2] * b[2] < same)
            return false;
    }
    return pairs->count >= FEW_PAIRS;
}

/* Share of depth that faces as the whole does, by its own normals. */
static double share_of_plane(const struct normal_pairs *pairs, double mean[3])
{
    double sum = 0, length = 0;
    memset(mean, 0, 3 * sizeof *mean);
    for (size_t i = 0; i < pairs->count; i++)
        for (int c = 0; c < 3; c++)
            mean[c] += pairs->pair[i].depth[c];
    for (int c = 0; c < 3; c++)
        length += mean[c] * mean[c];
    length = sqrt(length);
    for (int c = 0; c < 3 && length > 0; c++)
        mean[c] /= length;
    for (size_t i = 0; i < pairs->count; i++) {
        const double *n = pairs->pair[i].depth;
        sum += n[0] * mean[0] + n[1] * mean[1] + n[2] * mean[2] > 0.995; /* 6 degrees */
    }
    return pairs->count > 0 ? sum / (double)pairs->count : 0;
}

struct one_normal {
    bool is_all;   /* that there is */
    bool is_plane; /* of depth too */
    bool is_bound; /* to the field of view: what is seen straight on faces the same in any */
};

static struct one_normal look_for_one(const struct normal_pairs *pairs)
{
    static const double nearly_all = 0.95, straight_on = 0.99;
    struct one_normal one = {.is_all = are_alike(pairs)};
    double mean[3];
    if (!one.is_all)
        return one;
    one.is_plane = share_of_plane(pairs, mean) >= nearly_all;
    one.is_bound = fabs(mean[2]) < straight_on;
    return one;
}

/* The normal of a plane is anything in some world, and through some field of view: that it is
 * nearly that of depth by an assumed one is chance. */
static bool tells_no_space(const struct gbuffer *g, const struct one_normal *one,
                           enum normal_space wanted)
{
    return one->is_plane && one->is_bound && !g->camera.source[0] && !g->camera.has_rotation &&
           wanted == NORMAL_SPACE_AUTO &&
           g->roles.kind[ROLE_NORMAL].normal_space == NORMAL_SPACE_AUTO;
}

static void drop_without_space(struct gbuffer *g, const char *path, struct report *report)
{
    report_warn(report, "constant normals",
                "%s: normals '%s' are the same everywhere, and depth is of one plane: without a "
                "field of view nothing tells which space they are in; deriving them from depth "
                "(--fov and --normal-space, or --camera, tell)",
                path, g->roles.kind[ROLE_NORMAL].label);
    gbuffer_drop_normals(g);
}

static void check_values(struct gbuffer *g, const struct one_normal *one, size_t lost_signs,
                         const char *path, struct report *report)
{
    const bool is_other = one->is_all && g->normal_agreement < least_of_planes;
    if (is_other && one->is_plane) {
        report_warn(report, "constant normals",
                    "%s: normals '%s' are the same everywhere, and depth is of one plane that "
                    "faces another way: tangent space, or is the camera (%s) or --normal-space "
                    "wrong? deriving them from depth",
                    path, g->roles.kind[ROLE_NORMAL].label,
                    g->camera.source[0] ? g->camera.source : "assumed");
        gbuffer_drop_normals(g);
    } else if (is_other) {
        report_warn(report, "constant normals",
                    "%s: normals '%s' are the same everywhere, and the depth is of no plane: "
                    "tangent space? deriving them from depth",
                    path, g->roles.kind[ROLE_NORMAL].label);
        gbuffer_drop_normals(g);
    } else {
        gbuffer_warn_of_lost_signs(g, lost_signs, path, report);
    }
}

/* Normals that cannot be used, or that fit nothing. */
static bool check_normals(struct gbuffer *g, enum normal_space wanted, size_t pairs,
                          const char *path, struct report *report, struct tool_error *err)
{
    static const double half = 0.5;
    const char *label = g->roles.kind[ROLE_NORMAL].label;
    struct normal_facing facing;
    if (g->normal_space == NORMAL_SPACE_AUTO) {
        if (g->is_camera_doubted)
            report_warn(report, "world normals",
                        "%s: normals '%s' cannot be turned as the camera (%s) that they contradict "
                        "wants them: deriving them from depth",
                        path, label, g->camera.source);
        else
            report_warn(
                report, "world normals",
                "%s: normals '%s' need the rotation of the camera, which is unknown: deriving them "
                "from depth (--camera FILE.json gives it)",
                path, label);
        gbuffer_drop_normals(g);
        return true;
    }
    if (pairs >= FEW_PAIRS && g->normal_agreement < no_agreement) {
        report_warn(
            report, "disagreeing normals",
            "%s: normals '%s' do not agree with the depth%s (is the camera, --depth-type or "
            "--normal-space wrong?)",
            path, label, wanted == NORMAL_SPACE_AUTO ? " in any space: deriving them from it" : "");
        if (wanted == NORMAL_SPACE_AUTO) {
            gbuffer_drop_normals(g);
            return true;
        }
    } else if (pairs >= FEW_PAIRS && g->normal_agreement < poor_agreement) {
        report_warn(report, "disagreeing normals",
                    "%s: normals '%s' hardly agree with the depth (%.0f %%): is the camera (%s), "
                    "--depth-type or --normal-space wrong?",
                    path, label, g->normal_agreement * 100.0,
                    g->camera.source[0] ? g->camera.source : "assumed");
    }
    if (pairs >= FEW_PAIRS && g->normal_agreement > half && !gbuffer_turn_to_eye(g, path, report))
        return fail(err, EXIT_MEMORY, "%s: out of memory", path);
    if (!gbuffer_measure_facing(g, g->view.normal_to_view, &facing))
        return fail(err, EXIT_MEMORY, "%s: out of memory", path);
    if (facing.share < 0.6)
        report_warn(
            report, "facing normals",
            "%s: %.0f %% of the normals face away from the camera: is --normal-space or the "
            "camera wrong?",
            path, (1.0 - facing.share) * 100.0);
    return true;
}

static bool resolve_space(struct gbuffer *g, enum normal_space wanted, const char *path,
                          struct report *report, struct tool_error *err)
{
    float world[9];
    struct way ways[WAYS];
    struct normal_pairs pairs;
    if (wanted == NORMAL_SPACE_WORLD && !g->camera.has_rotation)
        return fail_without_rotation(path, err);
    if (!choose_space(g, wanted, world, err, path))
        return false;
    if (!gbuffer_pair_normals(g, GBUFFER_MOST_PAIRS, &pairs))
        return fail(err, EXIT_MEMORY, "%s: out of memory", path);
    const struct one_normal one = look_for_one(&pairs);
    if (tells_no_space(g, &one, wanted)) {
        gbuffer_free_pairs(&pairs);
        drop_without_space(g, path, report);
        return true;
    }
    judge_ways(ways, &pairs, g, world);
    ask_depth(g, ways, &pairs, one.is_plane, wanted, path, report);
    const size_t count = pairs.count;
    const size_t lost_signs = gbuffer_count_lost_signs(g, &pairs);
    const bool ok = count < FEW_PAIRS || g->normal_space == NORMAL_SPACE_AUTO ||
                    (gbuffer_ask_whether_inside_out(g, &pairs, path, report) &&
                     gbuffer_ask_mirrors(g, &pairs, path, report));
    gbuffer_free_pairs(&pairs);
    if (!ok)
        return fail(err, EXIT_MEMORY, "%s: out of memory", path);
    if (count >= FEW_PAIRS && wanted == NORMAL_SPACE_AUTO && g->normal_space != NORMAL_SPACE_AUTO)
        check_values(g, &one, lost_signs, path, report);
    return !g->normals || check_normals(g, wanted, count, path, report, err);
}

bool gbuffer_prepare_normals(struct gbuffer *g, const struct gbuffer_options *options,
                             const char *path, struct report *report, struct tool_error *err)
{
    if (!g->normals) {
        const struct camera *c = &g->camera;
        /* Planar depth is that of things through any lens. */
        const bool is_unchecked =
            c->source[0] && !gbuffer_camera_is_explicit(c) && strcmp(c->source, "positions") != 0;
        struct text others = {0};
        if (!options->roles.no_normals && !g->roles.kind[ROLE_NORMAL].found)
            roles_list_normals(g->roles.kind[ROLE_DEPTH].info, &options->roles, &others);
        if (!options->roles.no_normals && g->flip == FLIP_NONE)
            report_warn(
                report, "no normals",
                "%s: no normals; deriving them from depth (edges less accurate)%s%s%s%s%s%s", path,
                is_unchecked ? "; nothing checks the field of view of " : "",
                is_unchecked ? c->source : "", is_unchecked ? " either" : "",
                others.data ? "; by their names these may be some: " : "",
                others.data ? others.data : "", others.data ? " (--normal NAME)" : "");
        text_free(&others);
        gbuffer_drop_normals(g);
        return true;
    }
    return resolve_space(g, options->normal_space, path, report, err);
}
