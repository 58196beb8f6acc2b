/* SPDX-License-Identifier: MIT
 *
 * How normals are stored: signed or as colours, of unit length or scaled, through a curve, whole or
 * with their signs lost. No header says; the values do. */
#include "gbuffer_internal.h"
#include "median.h"
#include "png_file.h"

#include <math.h>
#include <stdlib.h>

const char *normal_encoding_name(enum normal_encoding encoding)
{
    static const char *const names[] = {"auto", "signed", "unsigned"};
    return names[encoding];
}

static bool finite3(const float *n)
{
    return isfinite(n[0]) && isfinite(n[1]) && isfinite(n[2]);
}

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
    return gbuffer_length(decoded);
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
        if (!finite3(n) || !(gbuffer_length(n) > 0) || gbuffer_length(decoded) < 0.02 ||
            length_of_linear(n) < 0.02)
            continue;
        negative += n[0] < -0.02f || n[1] < -0.02f || n[2] < -0.02f;
        as_signed[facts->count] = gbuffer_length(n);
        as_unsigned[facts->count] = gbuffer_length(decoded);
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
static const double most_of_filters = 0.005;

static enum normal_encoding encoding_of(const struct encoding_facts *f)
{
    if (f->count == 0 || f->negative > most_of_filters || f->signed_share > f->unsigned_share + 0.2)
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

/* What an option says is taken; lengths that are 1 by the other encoding alone contradict it. */
static void doubt_encoding(const struct gbuffer *g, const struct encoding_facts *f,
                           const char *path, struct report *report)
{
    static const double nearly_all = 0.9, few = 0.5;
    const bool is_signed = g->normal_encoding == NORMAL_ENCODING_SIGNED;
    const double told = is_signed ? f->signed_share : f->unsigned_share;
    const double other = is_signed ? f->unsigned_share : f->signed_share;
    if (f->count > 0 && other > nearly_all && told < few)
        report_warn(report, "told encoding",
                    "%s: --normal-encoding says that normals '%s' are %s, but %.0f %% are of "
                    "length 1 as %s, and %.0f %% as it says: %s is taken (--normal-encoding %s "
                    "overrides)",
                    path, g->roles.kind[ROLE_NORMAL].label,
                    normal_encoding_name(g->normal_encoding), other * 100.0,
                    is_signed ? "unsigned" : "signed", told * 100.0,
                    normal_encoding_name(g->normal_encoding), is_signed ? "unsigned" : "signed");
}

static bool resolve_encoding(struct gbuffer *g, enum normal_encoding wanted, const char *path,
                             struct report *report, struct tool_error *err)
{
    struct encoding_facts facts;
    g->normal_encoding = wanted;
    if (!measure_encoding(g, &facts))
        return fail(err, EXIT_MEMORY, "%s: out of memory", path);
    if (wanted != NORMAL_ENCODING_AUTO) {
        doubt_encoding(g, &facts, path, report);
        return true;
    }
    drop_what_is_none(g, &facts, path, report);
    if (!g->normals)
        return true;
    g->normal_encoding = encoding_of(&facts);
    if (facts.negative < most_of_filters &&
        facts.linear_share > fmax(facts.signed_share, facts.unsigned_share) + 0.2)
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
        if (gbuffer_length(g->normals + i * 4) > 0)
            lengths[count++] = gbuffer_length(g->normals + i * 4);
    const double length = median_of(lengths, count);
    for (size_t i = 0; i < count; i++)
        usual += fabs(lengths[i] / length - 1.0) < alike;
    free(lengths);
    const bool is_scaled = (double)usual > most * (double)count;
    if (count == 0 || unit_length(length) || !(is_scaled || length > 1))
        return true;
    for (size_t i = 0; i < gbuffer_texels(g); i++) {
        float *n = g->normals + i * 4;
        const double by = is_scaled ? length : gbuffer_length(n);
        for (int c = 0; c < 3 && by > 0; c++)
            n[c] = (float)((double)n[c] / by);
    }
    return true;
}

/* The library replaces zero normals by those of the depth. What lies outside the part's data window
 * is zero too, and must not be decoded. */
static void decode(struct gbuffer *g)
{
    for (size_t i = 0; i < gbuffer_texels(g); i++) {
        float *n = g->normals + i * 4;
        if (g->normal_encoding == NORMAL_ENCODING_UNSIGNED && gbuffer_length(n) > 0)
            for (int c = 0; c < 3; c++)
                n[c] = 2.0f * n[c] - 1.0f;
        /* Afterwards: twice a large number may be none. */
        if (!finite3(n))
            n[0] = n[1] = n[2] = 0;
    }
}

/* What is written as colours and not as data has the curve of sRGB put on, or taken off, each
 * component on its own: below zero its mirror image, or its straight foot. */
struct curve {
    bool is_on, mirrors;
};

static double linear_of(double srgb)
{
    return srgb <= 0.04045 ? srgb / 12.92 : pow((srgb + 0.055) / 1.055, 2.4);
}

static double without_curve(double component, struct curve curve)
{
    static const double foot = 12.92;
    const double size = fabs(component);
    if (component < 0 && !curve.mirrors)
        return curve.is_on ? component / foot : component * foot;
    return copysign(curve.is_on ? linear_of(size) : srgb_of(size), component);
}

static void take_off(struct curve curve, const float *n, float out[3])
{
    for (int c = 0; c < 3; c++)
        out[c] = (float)without_curve((double)n[c], curve);
}

/* Of how many normals there are, those of length 1 as they are and without the curve. */
struct ones {
    size_t count, as_is, without;
};

/* Chosen by hand: of filtered posts along the axes a curve that is not there explains .31, and of
 * nine G-buffers with four curves, all but one whose normals were filtered, .83 and more. None of
 * 147 files without a curve is said to have one. */
static bool is_explained(const struct ones *o)
{
    static const double few = 0.02, nearly_all = 0.8;
    const double lost = (double)(o->count - o->as_is),
                 found = (double)o->without - (double)o->as_is;
    return lost > few * (double)o->count && found > nearly_all * lost;
}

/* Of all, or of those that are like the texel beside them without the curve: others may be means of
 * a filter. */
static struct ones count_ones(const struct gbuffer *g, struct curve curve)
{
    enum { ENOUGH = 1 << 14, FEW = 1 << 10 };
    static const float most = 0.02f;
    struct ones all = {0}, alike = {0};
    for (size_t i = 0; i + 1 < gbuffer_texels(g); i += gbuffer_texels(g) / ENOUGH + 1) {
        const float *stored = g->normals + i * 4;
        float n[3], next[3];
        if (!(gbuffer_length(stored) > 0))
            continue;
        take_off(curve, stored, n);
        take_off(curve, stored + 4, next);
        const bool is_alike = fabsf(n[0] - next[0]) < most && fabsf(n[1] - next[1]) < most &&
                              fabsf(n[2] - next[2]) < most;
        const bool as_is = is_one(gbuffer_length(stored)), without = is_one(gbuffer_length(n));
        all = (struct ones){all.count + 1, all.as_is + as_is, all.without + without};
        if (is_alike)
            alike = (struct ones){alike.count + 1, alike.as_is + as_is, alike.without + without};
    }
    return alike.count > FEW && is_explained(&alike) ? alike : all;
}

/* Normals along an axis are the same with any curve. Where those that are not of length 1 are so
 * without one, it is taken off; filters leave lengths that no curve explains. */
static void undo_curve(struct gbuffer *g, const char *path, struct report *report)
{
    static const struct curve curves[] = {
        {true, true}, {true, false}, {false, true}, {false, false}};
    const struct curve *curve = NULL;
    double as_is = 0, without = 0;
    for (size_t k = 0; k < sizeof curves / sizeof *curves; k++) {
        const struct ones ones = count_ones(g, curves[k]);
        if (!is_explained(&ones) || (double)ones.without <= without * (double)ones.count)
            continue;
        curve = &curves[k];
        as_is = (double)ones.as_is / (double)ones.count;
        without = (double)ones.without / (double)ones.count;
    }
    if (!curve)
        return;
    for (size_t i = 0; i < gbuffer_texels(g); i++)
        take_off(*curve, g->normals + i * 4, g->normals + i * 4);
    report_warn(report, "curved normals",
                "%s: normals '%s' look as if the curve of sRGB had been %s them: %.0f %% are of "
                "length 1, and %.0f %% with that undone, as it is; write them as data (raw, "
                "non-colour)",
                path, g->roles.kind[ROLE_NORMAL].label, curve->is_on ? "put on" : "taken off",
                as_is * 100.0, without * 100.0);
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
    decode(g);
    if (g->normal_encoding == NORMAL_ENCODING_SIGNED)
        undo_curve(g, path, report);
    gbuffer_warn_of_matrix(g, path, report);
    if (g->normal_encoding == NORMAL_ENCODING_SIGNED && !make_unit(g))
        return fail(err, EXIT_MEMORY, "%s: out of memory", path);
    g->view.normal_encoding = VKAO_NORMALS_XYZ_SNORM;
    return true;
}

/* Normals of depth that have a negative component, where what is stored is those without it, or
 * without its sign, and no such normal. */
size_t gbuffer_count_lost_signs(const struct gbuffer *g, const struct normal_pairs *pairs)
{
    static const double clearly = -0.2, same = 0.985, other = 0.94;
    const float *m = g->view.normal_to_view;
    size_t count = 0;
    for (size_t i = 0; g->normals_lack_negative && i < pairs->count; i++) {
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

/* Of normals that happen to be positive, bumps and round things leave 75 of 100 agreeing, and none
 * lost a sign but by chance. */
void gbuffer_warn_of_lost_signs(const struct gbuffer *g, size_t lost, const char *path,
                                struct report *report)
{
    static const double least_of_positive = 0.7;
    enum { FEW_LOST = 4 };
    if (!g->normals_lack_negative || (g->normal_agreement >= least_of_positive && lost < FEW_LOST))
        return;
    report_warn(report, "positive normals",
                "%s: normals '%s' have no negative component anywhere, and %.0f %% agree with "
                "the depth: was it clamped, or its sign lost? (--normal none)",
                path, g->roles.kind[ROLE_NORMAL].label, g->normal_agreement * 100.0);
}
