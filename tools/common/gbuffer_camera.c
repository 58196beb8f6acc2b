/* SPDX-License-Identifier: MIT
 *
 * What neither options nor file nor header say of the camera, depth and normals may tell. */
#include "camera_fit.h"
#include "gbuffer_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Of buffers and parts of a range, the options know more than the image. */
static void take_depth_type(struct gbuffer *g, const struct fit *fit)
{
    if (g->depth_type == DEPTH_DEVICE || g->depth_type == DEPTH_NORMALIZED)
        return;
    /* Not to see the near plane that is known is no proof of none. */
    if (fit->model == FIT_RADIAL && g->depth_type == DEPTH_RADIAL_NEAR &&
        g->camera.near_plane > 0 && !fit->near_known)
        return;
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
    c->half_height = fit->half_width / gbuffer_aspect(g);
    c->shift_x = fit->shift_x;
    c->shift_y = fit->shift_y;
    c->bound = fit->bound;
    snprintf(c->source, sizeof c->source,
             fit->bound < 0.095 ? "estimated, +-%.1g %%" : "estimated, +-%.0f %%",
             fit->bound * 100.0);
}

static void take_rotation(struct gbuffer *g, const struct fit *fit)
{
    if (g->camera.has_rotation || !fit->rotation_known)
        return;
    if (gbuffer_is_camera_rotation(fit->rotation)) {
        g->roles.kind[ROLE_NORMAL].normal_space = NORMAL_SPACE_CAMERA;
        return;
    }
    memcpy(g->camera.world_to_view, fit->rotation, sizeof g->camera.world_to_view);
    g->camera.has_rotation = g->camera.axis_certain = true;
    snprintf(g->camera.rotation_source, sizeof g->camera.rotation_source, "estimated");
}

/* What the normals have to say, whatever a header or a file tells. */
static void see_rotation(struct gbuffer *g, const struct fit *fit)
{
    if (!fit->is_sure || !fit->rotation_known)
        return;
    memcpy(g->seen_rotation, fit->rotation, sizeof g->seen_rotation);
    memcpy(g->seen_weakest, fit->weakest, sizeof g->seen_weakest);
    g->has_seen_rotation = true;
}

/* --- From frame to frame --- */

static void take_remembered(struct gbuffer *g, const struct frame_memory *memory)
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
                     struct frame_memory *memory, struct report *report)
{
    const struct camera *c = &g->camera, *before = &memory->camera;
    const bool is_same_camera =
        memory->is_known && before->type == c->type &&
        fabs(log(before->half_width / c->half_width)) <= before->bound + c->bound;
    if (is_same_camera && memory->depth_type == g->depth_type) {
        take_remembered(g, memory);
        return;
    }
    if (memory->is_known && !is_same_camera)
        report_warn(report, "camera change",
                    "%s: another camera than that of the frames before: half the width at distance "
                    "1 is %.4g, was %.4g",
                    path, c->half_width, before->half_width);
    memory->is_known = true;
    memory->camera = *c;
    memory->depth_type = g->depth_type;
    memory->models = 1u << fit->model;
}

/* --- Estimates --- */

/* Near what it was in the frames before, and everywhere if it is not there. */
static bool estimate(const struct gbuffer *g, const struct gbuffer_options *options,
                     struct fit *fit, struct tool_error *err)
{
    const struct frame_memory *memory = options->memory;
    *fit = (struct fit){0};
    if (memory && memory->is_known) {
        const struct camera_search near = {.models = memory->models,
                                           .near_half_width = memory->camera.half_width};
        if (!gbuffer_estimate(g, &near, fit, err))
            return false;
    }
    return fit->is_sure || gbuffer_estimate_anywhere(g, options, fit, err);
}

/* --- A camera that nobody tells --- */

enum { VIEW_BYTES = 64 };

static void describe(enum camera_type type, double half_width, char view[VIEW_BYTES])
{
    const struct camera camera = {.type = type, .half_width = half_width};
    if (type == CAMERA_ORTHOGRAPHIC)
        snprintf(view, VIEW_BYTES, "orthographic, width %.5g", half_width * 2.0);
    else
        snprintf(view, VIEW_BYTES, "%.4g degrees horizontal field of view",
                 camera_fov_x_deg(&camera));
}

static void describe_option(enum camera_type type, double half_width, char option[VIEW_BYTES])
{
    const struct camera camera = {.type = type, .half_width = half_width};
    if (type == CAMERA_ORTHOGRAPHIC)
        snprintf(option, VIEW_BYTES, "--ortho %.5g", half_width * 2.0);
    else
        snprintf(option, VIEW_BYTES, "--fov %.4g", camera_fov_x_deg(&camera));
}

/* More than rounding. */
static bool is_shift(double x, double y)
{
    return fabs(x) + fabs(y) > 0.01;
}

/* Of a lens, and never as -0. */
static void describe_shift(bool is_wanted, double x, double y, char shift[VIEW_BYTES])
{
    shift[0] = '\0';
    if (is_wanted)
        snprintf(shift, VIEW_BYTES, ", shift %.3g %.3g", fabs(x) < 1e-4 ? 0.0 : x,
                 fabs(y) < 1e-4 ? 0.0 : y);
}

static void tell_unknown(struct gbuffer *g, const struct fit *fit, const char *path,
                         struct report *report)
{
    report_warn(report, "camera",
                "%s: no camera in the header%s%s; assuming 40 degrees horizontal field of view "
                "(--fov or --camera sets it)",
                path, fit->why[0] ? ", and the image does not tell it: " : "", fit->why);
    if (fit->why[0] && !g->camera.remark[0])
        snprintf(g->camera.remark, sizeof g->camera.remark, "the image does not tell it: %s",
                 fit->why);
}

static void tell_estimate(struct gbuffer *g, const struct fit *fit, const char *path,
                          struct report *report)
{
    char view[VIEW_BYTES], shift[VIEW_BYTES];
    describe(g->camera.type, g->camera.half_width, view);
    describe_shift(is_shift(fit->shift_x, fit->shift_y), fit->shift_x, fit->shift_y, shift);
    report_warn(report, "camera",
                "%s: no camera in the header; by depth and normals it is %s%s%s (%s%s%s), depth %s "
                "(--fov or --camera overrides)",
                path, fit->is_sure ? "" : "perhaps ", view, shift, g->camera.source,
                fit->is_sure ? "" : ": ", fit->is_sure ? "" : fit->why,
                depth_type_name(g->depth_type));
    if (!fit->is_sure && !g->camera.remark[0])
        snprintf(g->camera.remark, sizeof g->camera.remark, "uncertain: %s", fit->why);
}

/* No kind of depth is measured from a near plane along the view axis. */
static void tell_offset(const struct gbuffer *g, const struct fit *fit, const char *path,
                        struct report *report)
{
    const char *label = g->roles.kind[ROLE_DEPTH].label;
    if (fit->model != FIT_PLANAR || fit->tone > 0)
        return;
    if (fit->near_plane > 0)
        report_warn(report, "offset depth",
                    "%s: depth '%s' looks measured from a near plane, or a lens distorts the "
                    "image: its normals are those that are stored only if %.3g is added, which no "
                    "option does: write distances from the eye",
                    path, label, fit->near_plane);
    else if (fit->near_plane < 0)
        report_warn(report, "offset depth",
                    "%s: normals of depth '%s' are not quite those that are stored, through any "
                    "field of view: does a lens distort the image? AO is a little off; render it "
                    "undistorted",
                    path, label);
}

/* What is told is believed, as a field of view is. AO shows a hundredth of the distances. */
static void tell_near(const struct gbuffer *g, const struct fit *fit, const char *path,
                      struct report *report)
{
    const bool is_from_eye = g->depth_type == DEPTH_RADIAL && fit->near_known;
    const double told = is_from_eye ? 0 : g->camera.near_plane, seen = fmax(fit->seen_near, 0);
    const double least = 0.01 * fit->median + 3.0 * fit->near_bound;
    if (!(fit->near_bound > 0) || !(fabs(told - seen) > least))
        return;
    if (is_from_eye)
        report_warn(report, "doubted near plane",
                    "%s: depth '%s' is said to be %s, but depth and normals are those of "
                    "distances from a near plane at %.4g: %s is taken (--depth-type %s with --near "
                    "%.4g overrides)",
                    path, g->roles.kind[ROLE_DEPTH].label, depth_type_name(DEPTH_RADIAL), seen,
                    depth_type_name(DEPTH_RADIAL), depth_type_name(DEPTH_RADIAL_NEAR), seen);
    else if (g->depth_type == DEPTH_RADIAL_NEAR)
        report_warn(report, "doubted near plane",
                    "%s: the near plane that depth '%s' is measured from is said to be at %.4g, "
                    "but depth and normals are those of one at %.4g: %.4g is taken (--near, or a "
                    "camera file without \"near\", overrides)",
                    path, g->roles.kind[ROLE_DEPTH].label, told, seen, told);
}

/* Neither name nor camera says that depth begins at a near plane, and what was normalised looks the
 * same through a narrow lens. */
static void tell_found_near(const struct gbuffer *g, const char *path, struct report *report)
{
    report_warn(report, "found near plane",
                "%s: depth '%s' is taken for distances from a near plane at %.4g, which normals "
                "alone tell: if it is normalised, --depth-type normalized --depth-range NEAR,FAR",
                path, g->roles.kind[ROLE_DEPTH].label, g->camera.near_plane);
}

/* Nothing else makes all of a scene wider or higher. */
static void tell_pixels(const struct gbuffer *g, const struct fit *fit, const char *path,
                        struct report *report)
{
    if (fit->pixel_aspect > 0)
        report_warn(
            report, "pixel aspect",
            "%s: by depth and normals a pixel is %.3g times as wide as high, and the header "
            "says %.3g: camera and AO are wrong; write the attribute pixelAspectRatio, or "
            "the image without squeeze",
            path, fit->pixel_aspect, (double)g->pixel_aspect);
}

/* One image, two causes: the camera that is taken has the first. */
static void tell_shift(const struct gbuffer *g, const struct fit *fit, const char *path,
                       struct report *report)
{
    if (fit->other_aspect > 0)
        report_warn(report, "lens shift",
                    "%s: depth and normals are those of a lens shift of %.3g %.3g, which is taken, "
                    "and as well of pixels that are %.3g times as wide as high, where the header "
                    "says %.3g: if the image is squeezed, camera and AO are wrong; write the "
                    "attribute pixelAspectRatio then, else the shift in a camera file (--camera)",
                    path, fit->shift_x, fit->shift_y, fit->other_aspect, (double)g->pixel_aspect);
}

static void tell_tone(const struct gbuffer *g, const struct fit *fit, const char *path,
                      struct report *report)
{
    const bool is_fraction = fit->curve == FIT_TONED || fit->curve == FIT_ORTHO_TONED;
    if (fit->tone > 0)
        report_warn(report, "toned depth",
                    "%s: depth '%s' looks squeezed, as %s with a = %.3g is: its normals are those "
                    "of '%s' only if that is undone; camera and AO are wrong; write it as a "
                    "distance, without any curve",
                    path, g->roles.kind[ROLE_DEPTH].label,
                    is_fraction ? "a z / (a + z)" : "a (1 - exp(-z / a))", fit->tone,
                    g->roles.kind[ROLE_NORMAL].label);
}

/* A frame that does not tell, of a sequence whose others did. */
static void keep_remembered(struct gbuffer *g, const struct gbuffer_options *options,
                            const char *path, struct report *report)
{
    take_remembered(g, options->memory);
    report_warn(report, "camera kept",
                "%s: this frame does not tell the camera: that of the frames before is taken",
                path);
}

/* 1/z without perspective looks like planar depth with it, of a field of view that fits badly. */
static bool find_parallel(const struct gbuffer *g, const struct gbuffer_options *options,
                          bool is_known, struct fit *fit, bool *is_inverse, struct tool_error *err)
{
    static const double least_gain = 0.02;
    struct fit inverse = {0};
    *is_inverse = false;
    if (!g->normals || g->camera.is_assumed || (fit->is_sure && !is_known))
        return true;
    if (!gbuffer_estimate_parallel(g, options, is_known, &inverse, err))
        return false;
    *is_inverse = inverse.is_sure && inverse.agreement > fit->agreement + least_gain;
    if (*is_inverse)
        *fit = inverse;
    return true;
}

static bool find_unknown(struct gbuffer *g, const struct gbuffer_options *options, const char *path,
                         struct report *report, struct tool_error *err)
{
    struct fit fit = {0};
    bool is_inverse;
    if (g->normals && !g->camera.is_assumed && !estimate(g, options, &fit, err))
        return false;
    if (!find_parallel(g, options, false, &fit, &is_inverse, err) ||
        (g->normals && !gbuffer_find_flip(g, options, false, &fit, path, report, err)))
        return false;
    tell_pixels(g, &fit, path, report);
    tell_tone(g, &fit, path, report);
    if (!fit.is_sure && options->memory && options->memory->is_known && !g->camera.is_assumed) {
        keep_remembered(g, options, path, report);
        if (g->normals && !gbuffer_estimate_known(g, options, FIT_PATCH_ANY, &fit, err))
            return false;
        if (fit.is_sure)
            take_rotation(g, &fit);
        return true;
    }
    if (!fit.is_sure && !fit.is_usable) {
        tell_unknown(g, &fit, path, report);
        return true;
    }
    take_rotation(g, &fit);
    see_rotation(g, &fit);
    take_depth_type(g, &fit);
    if (is_inverse)
        g->depth_type = DEPTH_INVERSE;
    take_projection(g, &fit);
    if (options->memory)
        remember(g, &fit, path, options->memory, report);
    tell_estimate(g, &fit, path, report);
    tell_shift(g, &fit, path, report);
    tell_offset(g, &fit, path, report);
    return true;
}

/* --- A camera that somebody tells --- */

/* Below this share of agreeing normals the image is asked for another camera. By so much more must
 * agree with that, if it is sure or all agree with it, and else; and by so much as ln of half
 * widths, or of shifts, cameras are others. A median error of half a degree, which AO shows, leaves
 * 0.997 agreeing. */
static const double doubtful_agreement = 0.998, sure_gain = 0.002, clear_gain = 0.15,
                    other_view = 0.03, same_width = 0.01;

static double needed_gain(const struct fit *seen)
{
    const bool is_exact = seen->agreement >= doubtful_agreement;
    return seen->is_sure || is_exact ? sure_gain : clear_gain;
}

static bool is_other_width(const struct camera *c, const struct fit *fit, double tolerance)
{
    return (c->type == CAMERA_ORTHOGRAPHIC) != (fit->model == FIT_ORTHO) ||
           fabs(log(c->half_width / fit->half_width)) > tolerance;
}

static bool is_other_view(const struct camera *c, const struct fit *fit)
{
    return is_other_width(c, fit, other_view + 3.0 * fit->bound) ||
           fabs(c->shift_x - fit->shift_x) > other_view ||
           fabs(c->shift_y - fit->shift_y) > other_view;
}

static bool is_same_view(const struct camera *a, const struct camera *b)
{
    return a->type == b->type && fabs(a->half_width - b->half_width) <= 0 &&
           fabs(a->shift_x - b->shift_x) <= 0 && fabs(a->shift_y - b->shift_y) <= 0;
}

static bool is_doubtful(const struct camera *c, const struct fit *told, const struct fit *seen)
{
    const double gain = seen->agreement - told->agreement;
    return seen->is_usable && gain >= needed_gain(seen) && is_other_view(c, seen);
}

/* The option that gives what is seen; there is none of a shift. */
static void describe_way_out(const struct camera *c, const struct fit *seen,
                             char way_out[2 * VIEW_BYTES])
{
    char option[VIEW_BYTES];
    describe_option(seen->model == FIT_ORTHO ? CAMERA_ORTHOGRAPHIC : CAMERA_PERSPECTIVE,
                    seen->half_width, option);
    const bool is_shifted = is_shift(seen->shift_x - c->shift_x, seen->shift_y - c->shift_y);
    if (!is_other_width(c, seen, same_width))
        snprintf(way_out, 2 * VIEW_BYTES,
                 "\"shift_x\" and \"shift_y\" in a camera file override its shift");
    else if (is_shifted)
        snprintf(way_out, 2 * VIEW_BYTES,
                 "a camera file with \"shift_x\" and \"shift_y\", "
                 "--camera, overrides");
    else
        snprintf(way_out, 2 * VIEW_BYTES, "%s or --camera overrides", option);
}

/* Where the image says another thing than header or options, which are believed all the same. */
static void tell_doubt(const struct gbuffer *g, const struct fit *told, const struct fit *seen,
                       const char *path, struct report *report)
{
    const struct camera *c = &g->camera;
    char by_told[VIEW_BYTES], by_seen[VIEW_BYTES], told_shift[VIEW_BYTES], shift[VIEW_BYTES],
        way_out[2 * VIEW_BYTES];
    describe(c->type, c->half_width, by_told);
    describe(seen->model == FIT_ORTHO ? CAMERA_ORTHOGRAPHIC : CAMERA_PERSPECTIVE, seen->half_width,
             by_seen);
    const bool is_shifted =
        is_shift(c->shift_x, c->shift_y) || is_shift(seen->shift_x, seen->shift_y);
    describe_shift(is_shifted, c->shift_x, c->shift_y, told_shift);
    describe_shift(is_shifted, seen->shift_x, seen->shift_y, shift);
    describe_way_out(c, seen, way_out);
    report_warn_of_frame(
        report, "doubted camera",
        "%s: %s says %s%s, but depth and normals %s%s%s (%.0f %% of normals agree then, and "
        "%.0f %% as it says): that of %s is taken (%s)",
        path, c->source, by_told, told_shift, seen->is_sure ? "" : "perhaps ", by_seen, shift,
        seen->agreement * 100.0, told->agreement * 100.0, c->source, way_out);
}

/* The camera was held against a frame before, and of this one as many normals agree with it. To ask
 * for another takes 0.2 s, twice as long as all else of reading a small frame. */
static bool was_asked(struct frame_memory *memory, const struct camera *c, const struct fit *told)
{
    static const double other_agreement = 0.01;
    if (!memory || !is_same_view(&memory->told, c))
        return false;
    const double gain = told->agreement - memory->told_agreement;
    /* Doubts end where more agree, and begin where less do: slowly, too. */
    const bool is_doubted = memory->doubt != DOUBT_NOTHING;
    if (is_doubted ? gain < 0 : gain > 0)
        memory->told_agreement = told->agreement;
    return is_doubted ? gain < other_agreement : gain > -other_agreement;
}

/* A crop far off the axis has a lens shift that is not looked for. If fewer normals agree with what
 * is found, that is no camera, and nothing follows from a curve that betters it. */
static bool is_out_of_sight(const struct camera *c, const struct fit *told, const struct fit *seen)
{
    return fabs(c->shift_x) + fabs(c->shift_y) > 0.5 && told->agreement > seen->agreement;
}

/* A curve betters a camera that is not the right one, as of a crop whose lens shift is not found;
 * it is there if it betters what is told as well. Both are of single normals. */
static bool take_tone(const struct gbuffer *g, const struct gbuffer_options *options,
                      const struct fit *seen, struct fit *told, struct tool_error *err)
{
    struct fit single = *told;
    if (!(seen->tone > 0) || is_out_of_sight(&g->camera, told, seen))
        return true;
    if (told->patch != FIT_PATCH_NONE &&
        !gbuffer_estimate_known(g, options, FIT_PATCH_NONE, &single, err))
        return false;
    if (seen->toned < single.agreement + sure_gain)
        return true;
    told->tone = seen->tone;
    told->curve = seen->curve;
    told->toned = seen->toned;
    return true;
}

/* One thing that is wrong looks like others: it is a wrong field of view if all agree with another
 * one and pixels are square then, and a squeeze if more agree with that. alike: what is told, of
 * the patches that what is seen is of. */
static enum told_doubt choose_cause(const struct camera *c, const struct fit *told,
                                    const struct fit *alike, const struct fit *seen,
                                    const struct fit *other)
{
    const bool is_view = is_doubtful(c, alike, seen);
    if (other->is_sure && !(is_view && seen->agreement > other->agreement))
        return DOUBT_TYPE;
    if (told->tone > 0)
        return DOUBT_NOTHING;
    if (told->pixel_aspect > 0 && told->squeezed > seen->agreement)
        return DOUBT_PIXELS;
    return is_view ? DOUBT_CAMERA : DOUBT_NOTHING;
}

/* Says so where doubts begin; *doubted is what of. */
static bool doubt(struct gbuffer *g, const struct gbuffer_options *options, bool is_exact,
                  struct fit *told, enum told_doubt *doubted, const char *path,
                  struct report *report, struct tool_error *err)
{
    struct frame_memory *memory = options->memory;
    const enum told_doubt before = memory ? memory->doubt : DOUBT_NOTHING;
    enum told_doubt now = DOUBT_NOTHING;
    struct fit seen = {0}, other = {0}, alike = *told;
    if (told->agreement < doubtful_agreement) {
        if (!gbuffer_find_type(g, options, told, &other, err))
            return false;
        if (!is_exact && told->half_width > 0 && !gbuffer_estimate_anywhere(g, options, &seen, err))
            return false;
        if (!take_tone(g, options, &seen, told, err))
            return false;
        /* Patches of normals have no say against single ones. */
        if (seen.is_usable && seen.patch != told->patch && is_other_view(&g->camera, &seen) &&
            !gbuffer_estimate_known(g, options, seen.patch, &alike, err))
            return false;
        now = choose_cause(&g->camera, told, &alike, &seen, &other);
    }
    const bool is_square = (now == DOUBT_CAMERA && !(seen.pixel_aspect > 0)) ||
                           (told->tone > 0 && told->toned > told->squeezed);
    /* Positions that a camera sees tell both sides of a pixel. */
    if (now != DOUBT_TYPE && !is_square && !is_exact)
        tell_pixels(g, told, path, report);
    if (now != DOUBT_TYPE)
        tell_tone(g, told, path, report);
    if (now == DOUBT_CAMERA && now != before)
        tell_doubt(g, &alike, &seen, path, report);
    /* Distances would be taken for 1/z by their planes: without perspective those with it are. */
    if (now == DOUBT_CAMERA && seen.is_sure &&
        (seen.model == FIT_ORTHO) != (g->camera.type == CAMERA_ORTHOGRAPHIC) &&
        gbuffer_type_is_auto(g, options))
        take_depth_type(g, &seen);
    if (now == DOUBT_TYPE && now != before)
        gbuffer_tell_type(g, options, told, &other, path, report);
    *doubted = now;
    g->is_undoubted = now == DOUBT_NOTHING && !is_exact;
    if (memory) {
        memory->told = g->camera;
        memory->told_agreement = told->agreement;
        memory->doubt = now;
    }
    return true;
}

static bool hold_against_image(struct gbuffer *g, const struct gbuffer_options *options,
                               const char *path, struct report *report, struct tool_error *err)
{
    const struct role *depth = &g->roles.kind[ROLE_DEPTH];
    struct fit told;
    bool is_inverse = false;
    if (!gbuffer_estimate_known(g, options, FIT_PATCH_ANY, &told, err))
        return false;
    if (told.agreement < doubtful_agreement &&
        !find_parallel(g, options, true, &told, &is_inverse, err))
        return false;
    if (is_inverse) {
        g->depth_type = DEPTH_INVERSE;
        g->depth_source = DEPTH_BY_NORMALS;
    }
    if (!gbuffer_find_flip(g, options, true, &told, path, report, err))
        return false;
    const bool is_exact = strcmp(g->camera.source, "positions") == 0;
    const bool is_new = told.half_width > 0 && !is_exact &&
                        !(options->memory && is_same_view(&options->memory->told, &g->camera));
    enum told_doubt doubted = options->memory ? options->memory->doubt : DOUBT_NOTHING;
    if (g->flip == FLIP_NONE && !was_asked(options->memory, &g->camera, &told) &&
        !doubt(g, options, is_exact, &told, &doubted, path, report, err))
        return false;
    const bool lacks_near = options->depth_type == DEPTH_AUTO &&
                            depth->depth_type == DEPTH_RADIAL_NEAR && !(g->camera.near_plane > 0);
    g->is_camera_doubted = doubted == DOUBT_CAMERA;
    if (is_new && doubted == DOUBT_NOTHING && !told.tells_view &&
        !gbuffer_camera_is_explicit(&g->camera))
        report_warn(report, "unchecked camera",
                    "%s: the normals are nearly the same in any field of view: nothing checks that "
                    "of %s",
                    path, g->camera.source);
    const bool knows_near = g->camera.near_plane > 0 || depth->depth_type == DEPTH_RADIAL_NEAR;
    if (told.is_sure && g->depth_source == DEPTH_ASSUMED &&
        (gbuffer_type_is_auto(g, options) || lacks_near)) {
        take_depth_type(g, &told);
        if (g->depth_type == DEPTH_RADIAL_NEAR && !knows_near)
            tell_found_near(g, path, report);
    }
    if (told.is_sure) {
        take_rotation(g, &told);
        see_rotation(g, &told);
        g->depth_range.is_radial = told.model == FIT_RADIAL_NORMALIZED;
    }
    /* Through a field of view that is wrong depth seems to begin at a near plane. */
    if (told.is_sure && doubted != DOUBT_CAMERA) {
        tell_offset(g, &told, path, report);
        tell_near(g, &told, path, report);
    }
    return true;
}

/* Of the normals, turned as they are, through a field of view that is wider by a factor; below 0 if
 * memory ran out. */
static double agreement_through(const struct gbuffer *g, double factor)
{
    enum { MOST_PAIRS = 1 << 13 };
    struct gbuffer other = *g;
    struct normal_pairs pairs;
    other.camera.half_width *= factor;
    other.camera.half_height *= factor;
    if (!gbuffer_pair_normals(&other, MOST_PAIRS, &pairs))
        return -1;
    const double share = gbuffer_agreement(&pairs, g->view.normal_to_view).share;
    gbuffer_free_pairs(&pairs);
    return share;
}

/* A floor and what stands on it fit several fields of view if they may be turned as well, and the
 * image has nothing to say then. Once it is known which way normals point one view fits best. Of
 * right cameras none gains more than .001; of fields of view that are off by a fifth a quarter. */
bool gbuffer_warn_of_view(const struct gbuffer *g, const char *path, struct report *report)
{
    enum { WAYS = 12 };
    static const double step = 0.05, least_gain = 0.03;
    const struct camera *c = &g->camera;
    char by_told[VIEW_BYTES], by_seen[VIEW_BYTES], option[VIEW_BYTES];
    if (!g->normals || !g->is_undoubted || g->normal_agreement >= doubtful_agreement)
        return true;
    const double told = agreement_through(g, 1.0);
    double best = told, factor = 1.0;
    for (int k = -WAYS; told >= 0 && k <= WAYS; k++) {
        const double wider = exp(step * k), share = k ? agreement_through(g, wider) : told;
        if (share < 0)
            return false;
        if (share > best) {
            best = share;
            factor = wider;
        }
    }
    if (best < told + least_gain)
        return told >= 0;
    describe(c->type, c->half_width, by_told);
    describe(c->type, c->half_width * factor, by_seen);
    describe_option(c->type, c->half_width * factor, option);
    report_warn_of_frame(
        report, "doubted camera",
        "%s: %s says %s, but turned as they are normals fit perhaps %s (%.0f %% of them agree "
        "then, and %.0f %% as it says): that of %s is taken (%s or --camera overrides)",
        path, c->source, by_told, by_seen, best * 100.0, told * 100.0, c->source, option);
    return true;
}

/* A smaller rendering whose display window stayed that of the whole. Windows that were cut to what
 * they hold seldom have the shape of the display, its corner and a whole part of its size; and
 * normals tell that the camera is another. */
static void warn_of_proxy(const struct gbuffer *g, const char *path, struct report *report)
{
    enum { SMALLEST = 8, LEAST_SIDE = 16 };
    const struct exr_box *data = &g->data_window, *display = &g->display_window;
    const int64_t across = (int64_t)display->x_max - display->x_min + 1;
    const int64_t down = (int64_t)display->y_max - display->y_min + 1;
    if (data->x_min != display->x_min || data->y_min != display->y_min || g->width < LEAST_SIDE ||
        g->height < LEAST_SIDE)
        return;
    for (int64_t k = 2; k <= SMALLEST; k++)
        if (llabs(across - k * (int64_t)g->width) < k && llabs(down - k * (int64_t)g->height) < k)
            report_warn(report, "proxy",
                        "%s: the data window begins where the display window does and is 1/%d of "
                        "its size: if all of the view is in it, as in a proxy, camera and AO are "
                        "wrong; write a display window of that size",
                        path, (int)k);
}

bool gbuffer_find_camera(struct gbuffer *g, const struct gbuffer_options *options, const char *path,
                         struct report *report, struct tool_error *err)
{
    if (!g->normals)
        warn_of_proxy(g, path, report);
    const bool ok = !g->camera.source[0]
                        ? find_unknown(g, options, path, report, err)
                        : !g->normals || hold_against_image(g, options, path, report, err);
    if (ok && g->flip != FLIP_NONE)
        gbuffer_drop_normals(g);
    return ok;
}
