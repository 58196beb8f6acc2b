/* SPDX-License-Identifier: MIT
 *
 * Normals come in world or camera space, signed or as colours, and no header says which. Names and
 * the pixels do: what the camera sees faces it. */
#include "gbuffer_internal.h"
#include "median.h"
#include "text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const float identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
static const float flipped_z[9] = {1, 0, 0, 0, 1, 0, 0, 0, -1};

static double length3(const float *n)
{
    double x = (double)n[0], y = (double)n[1], z = (double)n[2];
    return sqrt(x * x + y * y + z * z);
}

static bool finite3(const float *n)
{
    return isfinite(n[0]) && isfinite(n[1]) && isfinite(n[2]);
}

/* --- Encoding --- */

/* Of normals that are there: neither zero nor, in colours, grey. */
struct encoding_facts {
    size_t count;
    double negative;                       /* share with a component clearly below zero */
    double signed_share, unsigned_share;   /* of |n| and of |2n - 1| that are 1 */
    double signed_length, unsigned_length; /* medians of the same */
    double linear_share;                   /* of those that are 1 once colours are no more linear */
    float low[3], high[3];
};

/* A picture of normals that was read as colours, whose curve was taken off. */
static double length_of_linear(const float *n)
{
    static const float curve = 1.0f / 2.2f;
    float decoded[3];
    for (int c = 0; c < 3; c++)
        decoded[c] = 2.0f * powf(fmaxf(n[c], 0.0f), curve) - 1.0f;
    return length3(decoded);
}

static bool is_one(double length)
{
    return length > 0.97 && length < 1.03;
}

static bool measure_encoding(const struct gbuffer *g, struct encoding_facts *facts)
{
    const size_t step = gbuffer_sample_step(g), room = gbuffer_texels(g) / step + 1;
    double *as_signed = malloc(room * sizeof *as_signed),
           *as_unsigned = malloc(room * sizeof *as_unsigned);
    const bool ok = as_signed && as_unsigned;
    size_t negative = 0, signed_ones = 0, unsigned_ones = 0, linear_ones = 0;
    *facts = (struct encoding_facts){.low = {INFINITY, INFINITY, INFINITY},
                                     .high = {-INFINITY, -INFINITY, -INFINITY}};
    for (size_t i = 0; ok && i < gbuffer_texels(g); i += step) {
        const float *n = g->normals + i * 4;
        const float decoded[3] = {2.0f * n[0] - 1.0f, 2.0f * n[1] - 1.0f, 2.0f * n[2] - 1.0f};
        if (!finite3(n) || !(length3(n) > 0) || length3(decoded) < 0.02 ||
            length_of_linear(n) < 0.02)
            continue;
        negative += n[0] < -0.02f || n[1] < -0.02f || n[2] < -0.02f;
        as_signed[facts->count] = length3(n);
        as_unsigned[facts->count] = length3(decoded);
        signed_ones += is_one(as_signed[facts->count]);
        unsigned_ones += is_one(as_unsigned[facts->count++]);
        linear_ones += is_one(length_of_linear(n));
        for (int c = 0; c < 3; c++) {
            facts->low[c] = fminf(facts->low[c], n[c]);
            facts->high[c] = fmaxf(facts->high[c], n[c]);
        }
    }
    if (ok && facts->count > 0) {
        const double count = (double)facts->count;
        facts->negative = (double)negative / count;
        facts->signed_share = (double)signed_ones / count;
        facts->unsigned_share = (double)unsigned_ones / count;
        facts->linear_share = (double)linear_ones / count;
        facts->signed_length = median_of(as_signed, facts->count);
        facts->unsigned_length = median_of(as_unsigned, facts->count);
    }
    free(as_signed);
    free(as_unsigned);
    return ok;
}

static bool unit_length(double length)
{
    return length > 0.9 && length < 1.1;
}

/* Some texels are negative in any encoding: filters overshoot. */
static enum normal_encoding encoding_of(const struct encoding_facts *f)
{
    if (f->count == 0 || f->negative > 0.005 || f->signed_share > f->unsigned_share + 0.2)
        return NORMAL_ENCODING_SIGNED;
    if (f->unsigned_share > f->signed_share + 0.2)
        return NORMAL_ENCODING_UNSIGNED;
    return unit_length(f->signed_length)     ? NORMAL_ENCODING_SIGNED
           : unit_length(f->unsigned_length) ? NORMAL_ENCODING_UNSIGNED
                                             : NORMAL_ENCODING_AUTO;
}

/* One component says nothing, and the other two are no normals without it. */
static bool has_two_components(const struct encoding_facts *f)
{
    static const float varies = 0.2f;
    int constant = 0, varying = 0;
    for (int c = 0; c < 3; c++) {
        constant += f->high[c] - f->low[c] < 1e-3f;
        varying += f->high[c] - f->low[c] > varies;
    }
    return constant == 1 && varying == 2 && fmax(f->signed_share, f->unsigned_share) < 0.9;
}

void gbuffer_drop_normals(struct gbuffer *g)
{
    free(g->normals);
    g->normals = NULL;
    g->normal_space = NORMAL_SPACE_AUTO;
    g->view.normal_encoding = VKAO_NORMALS_FROM_DEPTH;
}

/* What cannot be normals in any encoding is left out. */
static void drop_what_is_none(struct gbuffer *g, const struct encoding_facts *f, const char *path,
                              struct report *report)
{
    const char *label = g->roles.kind[ROLE_NORMAL].label;
    if (f->count == 0)
        report_warn(report, "empty normals",
                    "%s: normals '%s' are zero or no numbers wherever one looks: deriving them "
                    "from depth",
                    path, label);
    else if (has_two_components(f))
        report_warn(report, "packed normals",
                    "%s: normals '%s' have two components and a third that is %.3g everywhere: "
                    "octahedral, or without z; they cannot be read: deriving them from depth",
                    path, label,
                    f->high[0] - f->low[0] < 1e-3f   ? (double)f->low[0]
                    : f->high[1] - f->low[1] < 1e-3f ? (double)f->low[1]
                                                     : (double)f->low[2]);
    else
        return;
    gbuffer_drop_normals(g);
}

static bool fail_linear(const struct gbuffer *g, const char *path, struct tool_error *err)
{
    fail_hint(err, "write them as data (raw, non-colour); or --normal none");
    return fail(err, EXIT_CHANNELS,
                "%s: normals '%s' look like a picture of normals that was made linear, as colours "
                "are: they are 0..1 encoded only with the curve put back",
                path, g->roles.kind[ROLE_NORMAL].label);
}

static bool resolve_encoding(struct gbuffer *g, enum normal_encoding wanted, const char *path,
                             struct report *report, struct tool_error *err)
{
    struct encoding_facts facts;
    g->normal_encoding = wanted;
    if (wanted != NORMAL_ENCODING_AUTO)
        return true;
    if (!measure_encoding(g, &facts))
        return fail(err, EXIT_MEMORY, "%s: out of memory", path);
    drop_what_is_none(g, &facts, path, report);
    if (!g->normals)
        return true;
    g->normal_encoding = encoding_of(&facts);
    if (facts.linear_share > fmax(facts.signed_share, facts.unsigned_share) + 0.2)
        return fail_linear(g, path, err);
    g->normals_lack_negative =
        g->normal_encoding == NORMAL_ENCODING_SIGNED && !(facts.negative > 0);
    if (g->normal_encoding == NORMAL_ENCODING_AUTO) {
        fail_hint(err, "add --normal-encoding signed or unsigned, or --normal none");
        return fail(
            err, EXIT_CHANNELS,
            "%s: normals '%s' are neither signed nor 0..1 encoded: median length %.3g and %.3g",
            path, g->roles.kind[ROLE_NORMAL].label, facts.signed_length, facts.unsigned_length);
    }
    if (g->normal_encoding == NORMAL_ENCODING_UNSIGNED)
        report_warn(
            report, "unsigned normals",
            "%s: normals '%s' look 0..1 encoded: decoded as 2n-1 (--normal-encoding overrides)",
            path, g->roles.kind[ROLE_NORMAL].label);
    return true;
}

/* Most are as long, and not 1: of a program that scales. Longer ones than 1 of all lengths are of
 * one that does not normalise; shorter ones are those of filters, and say where these mixed. */
static bool make_unit(struct gbuffer *g)
{
    static const double alike = 0.03, most = 0.5;
    const size_t step = gbuffer_sample_step(g), room = gbuffer_texels(g) / step + 1;
    double *lengths = malloc(room * sizeof *lengths);
    size_t count = 0, usual = 0;
    if (!lengths)
        return false;
    for (size_t i = 0; i < gbuffer_texels(g); i += step)
        if (length3(g->normals + i * 4) > 0)
            lengths[count++] = length3(g->normals + i * 4);
    const double length = median_of(lengths, count);
    for (size_t i = 0; i < count; i++)
        usual += fabs(lengths[i] / length - 1.0) < alike;
    free(lengths);
    const bool is_scaled = (double)usual > most * (double)count;
    if (count == 0 || unit_length(length) || !(is_scaled || length > 1))
        return true;
    for (size_t i = 0; i < gbuffer_texels(g); i++) {
        float *n = g->normals + i * 4;
        const double by = is_scaled ? length : length3(n);
        for (int c = 0; c < 3 && by > 0; c++)
            n[c] = (float)((double)n[c] / by);
    }
    return true;
}

/* The library replaces zero normals by those of the depth. What lies outside the part's data window
 * is zero too, and must not be decoded. */
static bool decode(struct gbuffer *g)
{
    for (size_t i = 0; i < gbuffer_texels(g); i++) {
        float *n = g->normals + i * 4;
        if (g->normal_encoding == NORMAL_ENCODING_UNSIGNED && length3(n) > 0)
            for (int c = 0; c < 3; c++)
                n[c] = 2.0f * n[c] - 1.0f;
        /* Afterwards: twice a large number may be none. */
        if (!finite3(n))
            n[0] = n[1] = n[2] = 0;
    }
    return g->normal_encoding != NORMAL_ENCODING_SIGNED || make_unit(g);
}

/* --- Space --- */

static void rotate(const float m[9], const float n[3], double out[3])
{
    for (int row = 0; row < 3; row++)
        out[row] = (double)m[row] * (double)n[0] + (double)m[3 + row] * (double)n[1] +
                   (double)m[6 + row] * (double)n[2];
}

struct facing {
    double share;    /* of normals that face the eye */
    size_t away;     /* that do not */
    double median_z; /* positive: towards the eye */
};

static bool measure_facing(const struct gbuffer *g, const float matrix[9], struct facing *facing)
{
    size_t step = gbuffer_sample_step(g), count = 0, towards = 0;
    double *z = malloc((gbuffer_texels(g) / step + 1) * sizeof *z);
    if (!z)
        return false;
    for (size_t i = 0; i < gbuffer_texels(g); i += step) {
        if (!gbuffer_is_foreground(g, i) || !(length3(g->normals + i * 4) > 0.5))
            continue;
        double n[3], x = 0, y = 0;
        rotate(matrix, g->normals + i * 4, n);
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

/* Camera space: as OpenGL has it, or with z away from the eye (RenderMan, pbrt). */
static bool camera_matrix(const struct gbuffer *g, float matrix[9], struct facing *facing)
{
    struct facing away;
    if (!measure_facing(g, identity, facing) || !measure_facing(g, flipped_z, &away))
        return false;
    bool flip = away.share > facing->share;
    memcpy(matrix, flip ? flipped_z : identity, sizeof identity);
    if (flip)
        *facing = away;
    return true;
}

/* World space: where the header leaves open which way the camera looks, the normals know. */
static bool world_matrix(const struct gbuffer *g, float matrix[9], struct facing *facing)
{
    camera_normal_to_view(&g->camera, matrix);
    if (!measure_facing(g, matrix, facing))
        return false;
    if (g->camera.axis_certain)
        return true;
    float turned[9];
    struct facing other;
    memcpy(turned, matrix, sizeof turned);
    for (int column = 0; column < 3; column++)
        turned[column * 3 + 2] = -turned[column * 3 + 2];
    if (!measure_facing(g, turned, &other))
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
enum { FEW_PAIRS = 200 };

static void turn_round(float m[9])
{
    for (int i = 0; i < 9; i++)
        m[i] = -m[i];
}

/* Of what points away from the eye all three axes are the other way round. */
static void judge_way(struct way *way, const struct normal_pairs *pairs)
{
    way->is_known = true;
    way->agreement = gbuffer_agreement(pairs, way->matrix);
    if (way->agreement.facing < 0.3 && way->agreement.share > least_agreement)
        turn_round(way->matrix);
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
                      const struct normal_pairs *pairs, enum normal_space wanted, const char *path,
                      struct report *report)
{
    const bool has_chosen = g->normal_space != NORMAL_SPACE_AUTO;
    const struct way *best = best_way(ways, wanted);
    if (pairs->count < FEW_PAIRS || !best)
        return;
    g->normal_agreement = has_chosen ? gbuffer_agreement(pairs, g->view.normal_to_view).share : 0;
    if (best->agreement.share >= least_agreement &&
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

/* --- Mirrors --- */

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
static bool all_face(const struct facing *as_told, const struct facing *mirrored)
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
static bool ask_mirrors(struct gbuffer *g, const struct normal_pairs *pairs, const char *path,
                        struct report *report)
{
    static const double half = 0.5, less = 0.02;
    static const char *const axes[MIRRORS] = {"their x is turned round", "their y is turned round",
                                              "their z is turned round",
                                              "one direction of them is"};
    struct facing as_told, mirrored;
    float best[9];
    int axis = -1;
    if (!measure_facing(g, g->view.normal_to_view, &as_told))
        return false;
    double most = 0;
    const bool is_asked =
        as_told.away > 0 && gbuffer_agreement(pairs, g->view.normal_to_view).share > half;
    for (int c = 0; is_asked && c < MIRRORS; c++) {
        float m[9];
        if (c == MIRROR_SEEN && !g->has_seen_rotation)
            continue;
        mirror(g, c, m);
        if (!measure_facing(g, m, &mirrored))
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
static bool ask_whether_inside_out(struct gbuffer *g, const struct normal_pairs *pairs,
                                   const char *path, struct report *report)
{
    static const double least_away = 0.99, half = 0.5;
    struct facing facing;
    if (!measure_facing(g, g->view.normal_to_view, &facing))
        return false;
    if (1.0 - facing.share < least_away ||
        gbuffer_agreement(pairs, g->view.normal_to_view).share < half)
        return true;
    turn_round(g->view.normal_to_view);
    report_warn(report, "mirrored normals",
                "%s: the normals '%s' face away from the camera, %.0f %% of them, and lie along "
                "those of the depth: they point inwards and are turned round",
                path, g->roles.kind[ROLE_NORMAL].label, (1.0 - facing.share) * 100.0);
    return true;
}

/* --- The choice --- */

/* By name, camera and looks; AUTO: none of them tells. */
static bool choose_space(struct gbuffer *g, enum normal_space wanted, float world[9],
                         struct tool_error *err, const char *path)
{
    float camera[9];
    struct facing by_world = {0}, by_camera;
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

/* Normals of depth that have a negative component, where what is stored is those without it, or
 * without its sign, and no such normal. */
static size_t count_lost_signs(const struct gbuffer *g, const struct normal_pairs *pairs)
{
    static const double clearly = -0.2, same = 0.985, other = 0.94;
    const float *m = g->view.normal_to_view;
    size_t count = 0;
    for (size_t i = 0; i < pairs->count; i++) {
        const double *depth = pairs->pair[i].depth, *stored = pairs->pair[i].stored;
        double least = 0, dot = 0, by_clamped = 0, by_lost = 0, length = 0;
        for (int c = 0; c < 3; c++) {
            double n = 0;
            for (int row = 0; row < 3; row++)
                n += (double)m[c * 3 + row] * depth[row];
            least = fmin(least, n);
            dot += n * stored[c];
            by_lost += fabs(n) * stored[c];
            by_clamped += fmax(n, 0) * stored[c];
            length += fmax(n, 0) * fmax(n, 0);
        }
        count += least < clearly && fabs(dot) < other &&
                 (by_lost > same || by_clamped > same * sqrt(length));
    }
    return count;
}

/* Planes agree nearly all over. Of normals that happen to be positive, bumps and round things
 * leave 75 of 100 agreeing, and none lost a sign but by chance. */
static const double least_of_planes = 0.8, least_of_positive = 0.7;
enum { FEW_LOST = 4 };

static void check_values(struct gbuffer *g, bool alike, size_t lost_signs, const char *path,
                         struct report *report)
{
    const char *label = g->roles.kind[ROLE_NORMAL].label;
    if (alike && g->normal_agreement < least_of_planes) {
        report_warn(report, "constant normals",
                    "%s: normals '%s' are the same everywhere, and the depth is of no plane: "
                    "tangent space? deriving them from depth",
                    path, label);
        gbuffer_drop_normals(g);
    } else if (g->normals_lack_negative &&
               (g->normal_agreement < least_of_positive || lost_signs >= FEW_LOST)) {
        report_warn(report, "positive normals",
                    "%s: normals '%s' have no negative component anywhere, and %.0f %% agree with "
                    "the depth: was it clamped, or its sign lost? (--normal none)",
                    path, label, g->normal_agreement * 100.0);
    }
}

/* Normals that cannot be used, or that fit nothing. */
static bool check_normals(struct gbuffer *g, enum normal_space wanted, size_t pairs,
                          const char *path, struct report *report, struct tool_error *err)
{
    const char *label = g->roles.kind[ROLE_NORMAL].label;
    struct facing facing;
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
    if (!measure_facing(g, g->view.normal_to_view, &facing))
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
    judge_ways(ways, &pairs, g, world);
    ask_depth(g, ways, &pairs, wanted, path, report);
    const size_t count = pairs.count;
    const bool alike = are_alike(&pairs);
    const size_t lost_signs = g->normals_lack_negative ? count_lost_signs(g, &pairs) : 0;
    const bool ok =
        count < FEW_PAIRS || g->normal_space == NORMAL_SPACE_AUTO ||
        (ask_whether_inside_out(g, &pairs, path, report) && ask_mirrors(g, &pairs, path, report));
    gbuffer_free_pairs(&pairs);
    if (!ok)
        return fail(err, EXIT_MEMORY, "%s: out of memory", path);
    if (count >= FEW_PAIRS && wanted == NORMAL_SPACE_AUTO && g->normal_space != NORMAL_SPACE_AUTO)
        check_values(g, alike, lost_signs, path, report);
    return !g->normals || check_normals(g, wanted, count, path, report, err);
}

bool gbuffer_decode_normals(struct gbuffer *g, enum normal_encoding wanted, const char *path,
                            struct report *report, struct tool_error *err)
{
    if (!g->normals)
        return true;
    if (!resolve_encoding(g, wanted, path, report, err))
        return false;
    if (!g->normals)
        return true;
    if (!decode(g))
        return fail(err, EXIT_MEMORY, "%s: out of memory", path);
    g->view.normal_encoding = VKAO_NORMALS_XYZ_SNORM;
    return true;
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
