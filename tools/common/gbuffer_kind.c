/* SPDX-License-Identifier: MIT
 *
 * What the values of a depth channel measure. Names seldom tell; the picture often does. What
 * neither decides is refused or said, with the option that does. */
#include "gbuffer_internal.h"
#include "text.h"

#include <math.h>
#include <string.h>

/* Of the finite values. */
struct value_facts {
    size_t count, negative, zero, one;
    double low, high, below_one;        /* the largest below 1 */
    double high_negative, low_positive; /* of either sign, those nearest to 0 */
    bool is_endless;                    /* with infinities, or with numbers that stand for them */
};

static struct value_facts look_at_values(const struct gbuffer *g)
{
    struct value_facts f = {
        .low = INFINITY, .high = -INFINITY, .high_negative = -INFINITY, .low_positive = INFINITY};
    for (size_t i = 0; i < gbuffer_texels(g); i++) {
        const double d = (double)g->depth[i];
        const bool is_zero = !(d < 0) && !(d > 0) && !isnan(d);
        if (isnan(d) || (!is_zero && !gbuffer_is_measurable(fabs(d)))) {
            f.is_endless |= !isnan(d);
            continue;
        }
        f.count++;
        f.zero += is_zero;
        f.one += !(d < 1) && !(d > 1);
        f.negative += d < 0;
        f.low = fmin(f.low, d);
        f.high = fmax(f.high, d);
        f.high_negative = d < 0 ? fmax(f.high_negative, d) : f.high_negative;
        f.low_positive = d > 0 ? fmin(f.low_positive, d) : f.low_positive;
        f.below_one = d < 1 ? fmax(f.below_one, d) : f.below_one;
    }
    return f;
}

/* View space looks along -z: its z is negative wherever there is something. Where there is nothing
 * some programs write one number all the same, the largest half or the far plane. */
static bool is_view_z(const struct value_facts *f)
{
    static const double same_value = 0.99;
    const bool is_varied = f->low < f->high_negative;
    const bool is_sky = f->low_positive >= f->high * same_value && f->high >= -f->low;
    return f->negative > 0 && (f->negative + f->zero == f->count || (is_varied && is_sky));
}

static bool is_constant(const struct value_facts *f)
{
    return !(f->low < f->high);
}

/* --- What the planes say --- */

enum planes_say { SAY_NOTHING, SAY_PLANAR, SAY_RADIAL, SAY_LINEAR, SAY_OFFSET, SAY_INVERSE };

/* Without perspective distances are linear themselves, and 1/z is what they are with it: flat
 * things cannot tell the two apart, but a camera that is known does. */
static bool is_parallel(const struct gbuffer *g)
{
    return g->camera.source[0] && g->camera.type == CAMERA_ORTHOGRAPHIC;
}

static bool sees_rays(const struct gbuffer *g)
{
    return g->camera.source[0] && g->camera.type == CAMERA_PERSPECTIVE;
}

static enum planes_say listen(const struct gbuffer *g, const struct depth_planes *p)
{
    enum { MODELS = 3 };
    const double least = 0.2, more = 1.5;
    const double shares[MODELS] = {p->planar, sees_rays(g) ? p->radial : 0, p->linear};
    int best = 0;
    for (int i = 1; i < MODELS; i++)
        best = shares[i] > shares[best] ? i : best;
    if (p->offset_share >= least && p->offset_share > more * shares[best])
        return SAY_OFFSET;
    for (int i = 0; i < MODELS; i++)
        if (i != best && shares[best] < more * shares[i])
            return SAY_NOTHING;
    if (shares[best] < least)
        return SAY_NOTHING;
    return best == 0 && is_parallel(g) ? SAY_INVERSE : SAY_PLANAR + best;
}

/* --- Programs --- */

/* Nuke's own renderer writes 1/z into depth.Z; what others wrote passes through it as it was. */
static bool is_of_nuke(const struct exr_info *info, const struct role *depth)
{
    const char *name = depth->channels[0]->name;
    bool is_nuke = false;
    for (size_t p = 0; p < info->part_count; p++)
        for (size_t i = 0; i < info->parts[p].attribute_count; i++)
            is_nuke |= text_starts_with(info->parts[p].attributes[i].name, "nuke/version");
    return is_nuke &&
           (text_ends_with(name, "depth.Z") ||
            (strcmp(name, "Z") == 0 && text_starts_with(info->parts[depth->part].name, "depth")));
}

static void take(struct gbuffer *g, enum depth_type type, enum depth_source source)
{
    g->depth_type = type;
    g->depth_source = source;
}

static void take_from_nuke(struct gbuffer *g, const struct value_facts *f, enum planes_say say,
                           const char *path, struct report *report)
{
    const char *label = g->roles.kind[ROLE_DEPTH].label;
    /* As an image behind 1: what is nearer than a unit is rare. */
    const bool is_seen = say == SAY_LINEAR || say == SAY_PLANAR || say == SAY_INVERSE;
    const bool is_inverse = say == SAY_INVERSE || (say == SAY_LINEAR && !is_parallel(g)) ||
                            (!is_seen && f->high <= 1.0);
    take(g, is_inverse ? DEPTH_INVERSE : DEPTH_PLANAR,
         is_seen ? DEPTH_BY_PLANES : DEPTH_BY_CONVENTION);
    report_warn(report, "nuke depth",
                is_inverse ? "%s: depth '%s' is taken as 1/z, as Nuke writes it%s (--depth-type "
                             "overrides)"
                           : "%s: depth '%s' of Nuke is taken as distances, not as 1/z, by its "
                             "values%s (--depth-type overrides)",
                path, label, is_seen ? "; flat things agree" : "");
}

/* --- Deciding --- */

static bool fail_unknown(const struct gbuffer *g, const struct gbuffer_options *options,
                         const struct value_facts *f, enum planes_say say, const char *path,
                         struct tool_error *err)
{
    const char *label = g->roles.kind[ROLE_DEPTH].label;
    struct role other;
    const bool has_other = roles_other_depth(&options->roles, &g->roles, &other);
    const char *before = has_other ? "; or --depth '" : "", *name = has_other ? other.label : "",
               *after = has_other ? "', which is called depth too" : "";
    if (say == SAY_LINEAR) {
        fail_hint(err,
                  "--depth-type device with --near and --far (near > far if it is reversed), "
                  "or --depth-type inverse%s%s%s",
                  before, name, after);
        return fail(err, EXIT_CHANNELS,
                    "%s: depth '%s' is from %.4g to %.4g and no distance: a depth buffer or 1/z",
                    path, label, f->low, f->high);
    }
    const struct role *position = &g->roles.kind[ROLE_POSITION];
    fail_hint(err,
              "--depth-type normalized --depth-range NEAR,FAR[,inverted]; device with --near and "
              "--far; inverse; or planar or radial if these are scene units%s%s%s%s%s%s",
              position->found ? "; or --depth '" : "", position->found ? position->label : "",
              position->found ? "', which are positions" : "", before, name, after);
    return fail(err, EXIT_CHANNELS,
                "%s: depth '%s' is from %.4g to %.4g: normalised%s, not in scene units?", path,
                label, f->low, f->high, say == SAY_OFFSET ? " by its looks" : "");
}

static bool is_within_one(const struct value_facts *f)
{
    return f->low >= 0 && f->high <= 1.0 && !f->is_endless;
}

double gbuffer_full_range(double most)
{
    static const double full[] = {255.0, 65535.0, 16777215.0, 4294967295.0};
    size_t k = 0;
    while (most > full[k] && k < 3)
        k++;
    return full[k];
}

double gbuffer_all_bits(double most, double least)
{
    while (least < most)
        least = 2.0 * least + 1.0;
    return least;
}

/* Whole numbers that are no distances by what they show, or that nothing shows to be and that end
 * where some bits do: as values from 0 to 1 are. */
static bool are_parts(const struct gbuffer *g, const struct value_facts *f, enum planes_say say)
{
    const bool is_linear = say == SAY_LINEAR && g->camera.type == CAMERA_PERSPECTIVE;
    const double bits = gbuffer_all_bits(f->high, 255.0);
    return g->roles.kind[ROLE_DEPTH].channels[0]->type == EXR_UINT && !is_constant(f) &&
           (say == SAY_OFFSET || is_linear || (say == SAY_NOTHING && !(f->high < bits)));
}

static bool fail_parts(const struct gbuffer *g, const struct value_facts *f, const char *path,
                       struct tool_error *err)
{
    fail_hint(err,
              "--depth-type normalized --depth-range NEAR,FAR[,inverted], or device with --near "
              "and --far, take %.10g for 1; planar, radial or inverse if these are scene units",
              gbuffer_full_range(f->high));
    return fail(err, EXIT_CHANNELS,
                "%s: depth '%s' is whole numbers up to %.10g, and nothing shows distances: parts "
                "of a range or a depth buffer, not in scene units?",
                path, g->roles.kind[ROLE_DEPTH].label, f->high);
}

static void warn_about_whole(const struct gbuffer *g, const struct value_facts *f,
                             struct report *report)
{
    const struct role *role = &g->roles.kind[ROLE_DEPTH];
    if (role->channels[0]->type == EXR_UINT)
        report_warn(report, "whole depth",
                    "%s: depth '%s' is whole numbers up to %.10g, taken for scene units "
                    "(--depth-type normalized --depth-range NEAR,FAR, or device with --near and "
                    "--far, take %.10g for 1)",
                    role->info->path, role->label, f->high, gbuffer_full_range(f->high));
}

/* White is where normalised depth is clamped; a far background is far behind all else. */
static bool is_clamped(const struct value_facts *f)
{
    return (double)f->one > 0.002 * (double)f->count && f->below_one > 0.05;
}

static void warn_small(const struct gbuffer *g, const struct value_facts *f, const char *path,
                       struct report *report)
{
    report_warn(report, "small depth",
                "%s: depth '%s' is from %.4g to %.4g, taken for scene units since flat things are "
                "flat (--depth-type normalized --depth-range NEAR,FAR if it is not)",
                path, g->roles.kind[ROLE_DEPTH].label, f->low, f->high);
}

/* Normals tell what depth measures but not in which unit: parts of a far plane and buffers of
 * reversed depth have the same shape as distances and 1/z, and so has k/z. */
static bool check_scale(const struct gbuffer *g, const struct exr_info *info,
                        const struct gbuffer_options *options, const struct value_facts *f,
                        struct report *report, struct tool_error *err)
{
    const struct role *role = &g->roles.kind[ROLE_DEPTH];
    const bool is_inverse = g->depth_type == DEPTH_INVERSE;
    if (is_inverse ? is_of_nuke(info, role) : !is_within_one(f))
        return true;
    if (is_inverse && (is_parallel(g) || !is_within_one(f)))
        report_warn(report, "inverse depth",
                    "%s: depth '%s' is up to %.4g, taken as 1/z; k/z looks the same and is in "
                    "another unit: divide --radius by k then, or write 1/z",
                    info->path, role->label, f->high);
    else if (is_inverse)
        report_warn(report, "inverse depth",
                    "%s: depth '%s' is from %.4g to %.4g, taken as 1/z; a reversed depth buffer "
                    "differs in scale alone (--depth-type device with --near and --far)",
                    info->path, role->label, f->low, f->high);
    else if (is_clamped(f))
        return fail_unknown(g, options, f, SAY_NOTHING, info->path, err);
    else
        warn_small(g, f, info->path, report);
    return true;
}

/* Depth in scene units that no name explains. */
static void take_seen(struct gbuffer *g, const struct value_facts *f, enum planes_say say,
                      const char *path, struct report *report)
{
    const char *label = g->roles.kind[ROLE_DEPTH].label;
    const bool is_perspective = g->camera.type == CAMERA_PERSPECTIVE;
    switch (say) {
    case SAY_RADIAL:
        take(g, DEPTH_RADIAL, DEPTH_BY_PLANES);
        return;
    case SAY_LINEAR:
        if (is_perspective && g->camera.source[0]) {
            take(g, DEPTH_INVERSE, DEPTH_BY_PLANES);
            report_warn(report, "inverse depth",
                        "%s: depth '%s' is taken as 1/z: flat things are flat only then, or if "
                        "the camera is orthographic (--depth-type or --ortho WIDTH overrides)",
                        path, label);
            return;
        }
        if (is_perspective)
            report_warn(report, "orthographic depth",
                        "%s: depth '%s' looks orthographic, or like 1/z (--ortho WIDTH or "
                        "--depth-type inverse)",
                        path, label);
        else
            take(g, DEPTH_PLANAR, DEPTH_BY_PLANES);
        return;
    case SAY_OFFSET:
        if (g->planes.offset < 0 && f->high > 1.0)
            report_warn(report, "offset depth",
                        "%s: depth '%s', from %.4g to %.4g, looks counted down from a far plane: "
                        "flat things are flat only as distances of %.4g less depth; AO is wrong; "
                        "write it as a distance",
                        path, label, f->low, f->high, -g->planes.offset);
        else
            report_warn(
                report, "offset depth",
                "%s: depth '%s', from %.4g to %.4g, looks normalised or measured from the near "
                "plane: flat things are flat only if %.3g is added (--depth-type normalized "
                "--depth-range NEAR,FAR, or radial-near with --near)",
                path, label, f->low, f->high, g->planes.offset);
        break;
    case SAY_PLANAR:
        take(g, DEPTH_PLANAR, DEPTH_BY_PLANES);
        return;
    case SAY_INVERSE:
        take(g, DEPTH_INVERSE, DEPTH_BY_PLANES);
        report_warn(report, "inverse depth",
                    "%s: the camera (%s) is orthographic, and flat things of depth '%s' are flat "
                    "only as 1/z: taken so; if the image is in perspective after all, --fov "
                    "DEGREES (--depth-type overrides)",
                    path, g->camera.source, label);
        return;
    case SAY_NOTHING:
        if (f->high <= 1.5 && !f->is_endless && !is_constant(f))
            report_warn(report, "normalised depth",
                        "%s: depth '%s' is from %.4g to %.4g: normalised? (--depth-type normalized "
                        "--depth-range NEAR,FAR[,inverted])",
                        path, label, f->low, f->high);
        break;
    }
    take(g, DEPTH_PLANAR, DEPTH_ASSUMED);
}

/* What flat things say of a range that is told. */
static bool check_range(const struct gbuffer *g, const struct gbuffer_options *options,
                        const char *path, struct report *report, struct tool_error *err)
{
    const char *label = g->roles.kind[ROLE_DEPTH].label;
    const struct depth_range *r = &g->depth_range;
    const double near_end = fmin(r->zero, r->one), far_end = fmax(r->zero, r->one);
    const double c = g->planes.offset; /* both ends lie on one side of the eye with it */
    const bool is_inverted = r->one < r->zero;
    double gamma;
    if (options->is_type_recorded || g->planes.count < GBUFFER_ENOUGH_TRIPLES)
        return true;
    if (!gbuffer_find_gamma(g, &gamma))
        return fail(err, EXIT_MEMORY, "%s: out of memory", path);
    if (gamma < 1 || gamma > 1)
        report_warn(report, "curved range",
                    "%s: normalised depth '%s' looks like a picture with a gamma: flat things are "
                    "flat only as its power of about %.2g; AO is wrong; write it without any curve",
                    path, label, gamma);
    else if (listen(g, &g->planes) != SAY_OFFSET)
        return true;
    else if (far_end + c <= 0)
        report_warn(report, "told range",
                    "%s: normalised depth '%s' counts the other way than --depth-range says: flat "
                    "things are flat only then, and AO is wrong (--depth-range %.6g,%.6g%s)",
                    path, label, near_end, far_end, is_inverted ? "" : ",inverted");
    else
        report_warn(report, "told range",
                    "%s: --depth-range %.6g,%.6g is not that of normalised depth '%s': flat things "
                    "are flat only if %.3g is added to distances, as if NEAR were %.4g; AO is "
                    "wrong",
                    path, near_end, far_end, label, c, far_end * (near_end + c) / (far_end + c));
    return true;
}

/* A range says where depth begins and ends, and not along which way. */
static bool settle_range(struct gbuffer *g, const struct gbuffer_options *options, const char *path,
                         struct report *report, struct tool_error *err)
{
    const bool is_by_normals = g->depth_range.is_radial;
    if (!gbuffer_read_planes(g, &g->planes))
        return fail(err, EXIT_MEMORY, "%s: out of memory", path);
    if (!is_by_normals)
        g->depth_range.is_radial = listen(g, &g->planes) == SAY_RADIAL;
    if (g->depth_range.is_radial)
        report_warn(report, "radial range",
                    "%s: normalised depth '%s' is taken for distances from the eye, not along the "
                    "view axis: %s only then",
                    path, g->roles.kind[ROLE_DEPTH].label,
                    is_by_normals ? "normals agree" : "flat things are flat");
    return g->depth_range.is_radial || check_range(g, options, path, report, err);
}

/* What flat things say of depth that is what it is told to be. */
static bool is_as_told(const struct gbuffer *g, enum planes_say say)
{
    const bool is_straight = say == (is_parallel(g) ? SAY_LINEAR : SAY_PLANAR);
    /* Without rays to divide by, both kinds of distances look much the same. */
    const bool is_round = say == SAY_RADIAL || (is_straight && !sees_rays(g));
    switch (g->depth_type) {
    case DEPTH_PLANAR:
        return is_straight;
    case DEPTH_RADIAL:
        return is_round;
    case DEPTH_RADIAL_NEAR: /* which lacks something */
        return is_round || say == SAY_OFFSET;
    case DEPTH_INVERSE:
        return say == (is_parallel(g) ? SAY_INVERSE : SAY_LINEAR);
    case DEPTH_DEVICE:
        return say == SAY_LINEAR;
    default:
        return true;
    }
}

/* Normals have said more, if there are any. What is told is believed all the same. */
static bool check_told(struct gbuffer *g, const struct gbuffer_options *options, const char *path,
                       struct report *report, struct tool_error *err)
{
    static const struct {
        const char *seen, *remedy;
    } words[] = {
        [SAY_PLANAR] = {"as distances along the view axis", "--depth-type planar"},
        [SAY_RADIAL] = {"as distances from the eye", "--depth-type radial"},
        [SAY_LINEAR] = {"as 1/z or a depth buffer, or without perspective",
                        "--depth-type inverse, device with --near and --far, or --ortho WIDTH"},
        [SAY_OFFSET] = {"if something is added",
                        "--depth-type normalized with --depth-range, or radial-near with --near"},
        [SAY_INVERSE] = {"as 1/z", "--depth-type inverse"},
    };
    if (g->normals || options->is_type_recorded)
        return true;
    if (!gbuffer_read_planes(g, &g->planes))
        return fail(err, EXIT_MEMORY, "%s: out of memory", path);
    const enum planes_say say = listen(g, &g->planes);
    if (g->planes.count >= GBUFFER_ENOUGH_TRIPLES && say != SAY_NOTHING && !is_as_told(g, say))
        report_warn(report, "doubted depth",
                    "%s: %s says that depth '%s' is %s, but flat things are flat only %s: %s is "
                    "taken (%s overrides)",
                    path, gbuffer_teller_of_type(g, options), g->roles.kind[ROLE_DEPTH].label,
                    depth_type_name(g->depth_type), words[say].seen, depth_type_name(g->depth_type),
                    words[say].remedy);
    return true;
}

bool gbuffer_find_told_ends(struct gbuffer *g, const struct gbuffer_options *options,
                            enum depth_type *type, struct report *report, struct tool_error *err)
{
    const struct role *role = &g->roles.kind[ROLE_DEPTH];
    const bool has_planes = options->camera.near_plane > 0 && options->camera.far_plane > 0;
    const bool has_range = options->depth_range.is_given;
    struct depth_planes planes;
    *type = DEPTH_AUTO;
    if (options->depth_type != DEPTH_AUTO || role->depth_type != DEPTH_AUTO ||
        g->depth_source != DEPTH_ASSUMED || has_planes == has_range)
        return true;
    const struct value_facts f = look_at_values(g);
    if (!is_within_one(&f) || is_constant(&f))
        return true;
    g->background.limit = INFINITY;
    if (!gbuffer_read_planes(g, &planes))
        return fail(err, EXIT_MEMORY, "%s: out of memory", role->info->path);
    /* Of a range distances are flat too; planes are told of other depth as well. */
    const enum planes_say say = listen(g, &planes);
    if (has_planes && (say == SAY_PLANAR || say == SAY_RADIAL))
        return true;
    *type = has_planes ? DEPTH_DEVICE : DEPTH_NORMALIZED;
    g->depth_type = *type;
    g->has_told_ends = true;
    report_warn(report, "told ends",
                "%s: depth '%s' is from %.4g to %.4g and %s: taken for %s (--depth-type overrides)",
                role->info->path, role->label, f.low, f.high,
                has_planes ? "--near and --far are given" : "--depth-range is given",
                has_planes ? "a depth buffer" : "parts of that range");
    return true;
}

void gbuffer_turn_depth(struct gbuffer *g, const struct gbuffer_options *options,
                        struct report *report)
{
    const struct role *role = &g->roles.kind[ROLE_DEPTH];
    if (role->depth_type == DEPTH_POSITION || options->depth_type == DEPTH_DEVICE)
        return;
    const struct value_facts f = look_at_values(g);
    if (!is_view_z(&f))
        return;
    for (size_t i = 0; i < gbuffer_texels(g); i++)
        g->depth[i] = g->depth[i] < 0 ? -g->depth[i] : INFINITY;
    g->depth_is_negated = true;
    report_warn(report, "negative depth",
                "%s: depth '%s' is negative, as z of view space is: its sign is turned",
                role->info->path, role->label);
}

bool gbuffer_resolve_depth_type(struct gbuffer *g, const struct exr_info *info,
                                const struct gbuffer_options *options, struct report *report,
                                struct tool_error *err)
{
    const struct role *role = &g->roles.kind[ROLE_DEPTH];
    g->background.limit = INFINITY;
    const bool is_auto = options->depth_type == DEPTH_AUTO && role->depth_type == DEPTH_AUTO;
    const bool is_by_normals = g->depth_source == DEPTH_BY_NORMALS && !is_auto;
    if (role->depth_type == DEPTH_POSITION) {
        if (g->depth_source != DEPTH_BY_POSITIONS && !is_by_normals)
            take(g, DEPTH_PLANAR, DEPTH_BY_POSITIONS);
        return true;
    }
    const struct value_facts seen = look_at_values(g);
    const bool is_found = g->depth_source == DEPTH_BY_POSITIONS || is_by_normals;
    if (options->depth_type == DEPTH_AUTO && (is_found || !is_auto))
        warn_about_whole(g, &seen, report);
    if (is_found)
        return true;
    if (options->depth_type != DEPTH_AUTO) {
        take(g, options->depth_type,
             g->camera.depth_type != DEPTH_AUTO ? DEPTH_BY_CAMERA
             : g->has_told_ends                 ? DEPTH_BY_ENDS
                                                : DEPTH_BY_OPTION);
        if (g->depth_type == DEPTH_NORMALIZED)
            return !g->depth_range.is_given || settle_range(g, options, info->path, report, err);
        return check_told(g, options, info->path, report, err);
    }
    if (role->depth_type != DEPTH_AUTO) {
        take(g, role->depth_type, DEPTH_BY_NAME);
        return check_told(g, options, info->path, report, err);
    }
    if (g->depth_source == DEPTH_BY_NORMALS) {
        warn_about_whole(g, &seen, report);
        return check_scale(g, info, options, &seen, report, err);
    }
    if (!gbuffer_read_planes(g, &g->planes))
        return fail(err, EXIT_MEMORY, "%s: out of memory", info->path);
    const enum planes_say say = listen(g, &g->planes);
    if (are_parts(g, &seen, say))
        return fail_parts(g, &seen, info->path, err);
    warn_about_whole(g, &seen, report);
    if (is_of_nuke(info, role)) {
        take_from_nuke(g, &seen, say, info->path, report);
        return gbuffer_doubt_inverse(g, options, info->path, report, err);
    }
    const bool is_seen = (say == SAY_PLANAR || say == SAY_RADIAL) && !is_clamped(&seen);
    if (is_within_one(&seen) && !is_seen && say != SAY_INVERSE && !is_constant(&seen))
        return fail_unknown(g, options, &seen, say, info->path, err);
    if (is_within_one(&seen) && is_seen)
        warn_small(g, &seen, info->path, report);
    take_seen(g, &seen, say, info->path, report);
    return gbuffer_doubt_inverse(g, options, info->path, report, err);
}
