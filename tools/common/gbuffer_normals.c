/* SPDX-License-Identifier: MIT
 *
 * Normals come in world or camera space, signed or as colours, and no header says which. Names and
 * the pixels do: what the camera sees faces it. */
#include "gbuffer_internal.h"
#include "median.h"

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

struct encoding_facts {
    bool any_negative;
    double signed_length,
        unsigned_length; /* medians of |n| and of |2n - 1|, over what is not zero */
    size_t count;
};

static bool measure_encoding(const struct gbuffer *g, struct encoding_facts *facts)
{
    size_t step = gbuffer_sample_step(g), room = gbuffer_texels(g) / step + 1;
    double *as_signed = malloc(room * sizeof *as_signed),
           *as_unsigned = malloc(room * sizeof *as_unsigned);
    *facts = (struct encoding_facts){0};
    for (size_t i = 0; as_signed && as_unsigned && i < gbuffer_texels(g); i += step) {
        const float *n = g->normals + i * 4;
        if (!gbuffer_is_foreground(g, i) || !finite3(n) || !(length3(n) > 0))
            continue;
        facts->any_negative |= n[0] < -0.02f || n[1] < -0.02f || n[2] < -0.02f;
        float decoded[3] = {2.0f * n[0] - 1.0f, 2.0f * n[1] - 1.0f, 2.0f * n[2] - 1.0f};
        as_signed[facts->count] = length3(n);
        as_unsigned[facts->count++] = length3(decoded);
    }
    if (as_signed && as_unsigned) {
        facts->signed_length = median_of(as_signed, facts->count);
        facts->unsigned_length = median_of(as_unsigned, facts->count);
    }
    bool ok = as_signed && as_unsigned;
    free(as_signed);
    free(as_unsigned);
    return ok;
}

static bool unit_length(double length)
{
    return length > 0.9 && length < 1.1;
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
    g->normal_encoding = NORMAL_ENCODING_SIGNED;
    if (facts.any_negative || facts.count == 0 || unit_length(facts.signed_length))
        return true;
    if (!unit_length(facts.unsigned_length)) {
        fail_hint(err, "add --normal-encoding signed or unsigned, or --normal none");
        return fail(
            err, EXIT_CHANNELS,
            "%s: normals '%s' are neither signed nor 0..1 encoded: median length %.3g and %.3g",
            path, g->roles.kind[ROLE_NORMAL].label, facts.signed_length, facts.unsigned_length);
    }
    g->normal_encoding = NORMAL_ENCODING_UNSIGNED;
    report_warn(report, "unsigned normals",
                "%s: normals '%s' look 0..1 encoded: decoded as 2n-1 (--normal-encoding overrides)",
                path, g->roles.kind[ROLE_NORMAL].label);
    return true;
}

/* The library replaces zero normals by those of the depth. What lies outside the part's data window
 * is zero too, and must not be decoded. */
static void decode(struct gbuffer *g)
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

static void drop_normals(struct gbuffer *g)
{
    free(g->normals);
    g->normals = NULL;
    g->normal_space = NORMAL_SPACE_AUTO;
    g->view.normal_encoding = VKAO_NORMALS_FROM_DEPTH;
}

static bool fail_without_rotation(const char *path, struct tool_error *err)
{
    fail_hint(err, "add --camera FILE.json with \"world_to_view\", or --normal none");
    return fail(err, EXIT_CHANNELS, "%s: world-space normals need the rotation of the camera",
                path);
}

/* World and camera matrices and how well they fit, then the choice. */
static bool resolve_space(struct gbuffer *g, enum normal_space wanted, const char *path,
                          struct report *report, struct tool_error *err)
{
    float world[9], camera[9];
    struct facing by_world = {0}, by_camera;
    const struct role *role = &g->roles.kind[ROLE_NORMAL];
    enum normal_space space = wanted != NORMAL_SPACE_AUTO ? wanted : role->normal_space;
    bool rotation = g->camera.has_rotation;
    if (wanted == NORMAL_SPACE_WORLD && !rotation)
        return fail_without_rotation(path, err);
    if (!camera_matrix(g, camera, &by_camera) || (rotation && !world_matrix(g, world, &by_world)))
        return fail(err, EXIT_MEMORY, "%s: out of memory", path);

    bool camera_fits = by_camera.share > 0.98 && by_camera.median_z > 0.25;
    if (space == NORMAL_SPACE_AUTO)
        space = rotation ? NORMAL_SPACE_WORLD : camera_fits ? NORMAL_SPACE_CAMERA : space;
    if (wanted == NORMAL_SPACE_AUTO && space == NORMAL_SPACE_WORLD && rotation && camera_fits &&
        by_world.share < 0.9) {
        space = NORMAL_SPACE_CAMERA;
        report_warn(report, "camera normals",
                    "%s: normals '%s' are camera-space by their looks (--normal-space overrides)",
                    path, role->label);
    }
    if (space == NORMAL_SPACE_AUTO || (space == NORMAL_SPACE_WORLD && !rotation)) {
        report_warn(
            report, "world normals",
            "%s: normals '%s' need the rotation of the camera, which is unknown: deriving them "
            "from depth (--camera FILE.json gives it)",
            path, role->label);
        drop_normals(g);
        return true;
    }
    bool in_world = space == NORMAL_SPACE_WORLD;
    const struct facing *chosen = in_world ? &by_world : &by_camera;
    memcpy(g->view.normal_to_view, in_world ? world : camera, sizeof world);
    if (chosen->share < 0.6)
        report_warn(
            report, "facing normals",
            "%s: %.0f %% of the normals face away from the camera: is --normal-space or the "
            "camera wrong?",
            path, (1.0 - chosen->share) * 100.0);
    g->normal_space = space;
    return true;
}

bool gbuffer_prepare_normals(struct gbuffer *g, const struct gbuffer_options *options,
                             const char *path, struct report *report, struct tool_error *err)
{
    if (!g->normals) {
        if (!options->roles.no_normals)
            report_warn(report, "no normals",
                        "%s: no normals; deriving them from depth (edges less accurate)", path);
        drop_normals(g);
        return true;
    }
    if (!resolve_encoding(g, options->normal_encoding, path, report, err))
        return false;
    decode(g);
    g->view.normal_encoding = VKAO_NORMALS_XYZ_SNORM;
    return resolve_space(g, options->normal_space, path, report, err);
}
