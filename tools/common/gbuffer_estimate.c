/* SPDX-License-Identifier: MIT
 *
 * What depth and normals are asked for: a camera, and what depth measures, among those that are
 * left by options, header and names. */
#include "gbuffer_internal.h"

#include <stdio.h>
#include <stdlib.h>

bool gbuffer_type_is_auto(const struct gbuffer *g, const struct gbuffer_options *options)
{
    return options->depth_type == DEPTH_AUTO && g->roles.kind[ROLE_DEPTH].depth_type == DEPTH_AUTO;
}

/* At a texel, by alpha or normals. */
static bool is_nothing(const struct gbuffer *g, size_t texel)
{
    static const double least_length = 0.5;
    return (g->alpha && !(g->alpha[texel] > 0)) ||
           (g->normals && !(gbuffer_length(g->normals + texel * 4) > least_length));
}

/* Sky at a value far above all else, as renderers write 1e10 or infinity. The largest of 1/z is
 * what is nearest, and nothing is at 0. */
static bool has_sky_at_largest(const struct gbuffer *g)
{
    static const double same_value = 0.99, clear_gap = 20.0;
    static const double least_share = 0.002, nearly_all = 0.9, half = 0.5, hardly_any = 0.02;
    enum { FEW = 16 };
    const size_t step = gbuffer_sample_step(g), samples = gbuffer_texels(g) / step;
    size_t sky = 0, nothing = 0, between = 0, rest = 0;
    double largest = 0;
    for (size_t i = 0; i < gbuffer_texels(g); i += step)
        largest = fmax(largest, (double)g->depth[i]);
    for (size_t i = 0; largest > 0 && i < gbuffer_texels(g); i += step) {
        const double d = (double)g->depth[i];
        if (d >= largest * same_value) {
            sky++;
            nothing += is_nothing(g, i);
        } else {
            between += d * clear_gap > largest;
            rest++;
        }
    }
    /* Alpha may be of another frame; no thing is at such a value in any unit. */
    const double least_nothing = gbuffer_is_measurable(largest) ? nearly_all : half;
    return sky >= FEW && (double)sky >= least_share * (double)samples &&
           (double)nothing >= least_nothing * (double)sky &&
           (double)between <= hardly_any * (double)rest;
}

/* As role and options have it, what the depth may be; known: through the camera that is known. 0:
 * nothing that an image tells. */
static unsigned possible_models(const struct gbuffer *g, const struct gbuffer_options *options,
                                bool known)
{
    enum {
        ALL_RADIAL = 1 << FIT_RADIAL | 1 << FIT_RADIAL_NEAR,
        NORMALIZED =
            1 << FIT_PLANAR_NORMALIZED | 1 << FIT_PLANAR_REVERSED | 1 << FIT_RADIAL_NORMALIZED,
        UNSCALED = 1 << FIT_DEVICE | NORMALIZED | 1 << FIT_ORTHO_REVERSED
    };
    const bool ortho = g->camera.type == CAMERA_ORTHOGRAPHIC;
    const unsigned parallel = known && !ortho ? 0 : 1u << FIT_ORTHO;
    if (known && ortho)
        return g->depth_type == DEPTH_PLANAR || g->depth_type == DEPTH_RADIAL_NEAR ? parallel : 0;
    if (gbuffer_type_is_auto(g, options) && g->depth_type == DEPTH_PLANAR)
        return 1u << FIT_PLANAR | (known ? ALL_RADIAL : 1u << FIT_RADIAL) |
               (has_sky_at_largest(g) ? 0 : 1u << FIT_INVERSE) | parallel | UNSCALED;
    switch (g->depth_type) {
    case DEPTH_PLANAR:
        return 1u << FIT_PLANAR | parallel;
    case DEPTH_RADIAL:
        return 1u << FIT_RADIAL | parallel;
    case DEPTH_RADIAL_NEAR:
        return ALL_RADIAL | parallel;
    case DEPTH_INVERSE:
        return 1u << FIT_INVERSE;
    case DEPTH_DEVICE:
        return 1u << FIT_DEVICE;
    case DEPTH_NORMALIZED:
        return NORMALIZED;
    default:
        return 0;
    }
}

bool gbuffer_fit_camera(const struct gbuffer *g, const struct camera_search *search,
                        struct fit *fit, struct tool_error *err)
{
    const struct fit_input input = {
        .depth = g->depth,
        .normals = g->normals,
        .width = g->width,
        .height = g->height,
        .data_window = g->data_window,
        .display_window = g->display_window,
        .pixel_aspect = (double)g->pixel_aspect,
        .models = search->models,
        .half_width = search->is_known ? g->camera.half_width : 0,
        .shift_x = search->is_known ? g->camera.shift_x : 0,
        .shift_y = search->is_known ? g->camera.shift_y : 0,
        .near_half_width = search->near_half_width,
        .patch = search->patch,
    };
    *fit = (struct fit){0};
    return !search->models || camera_fit(&input, fit, err);
}

static bool is_unscaled(enum fit_model model)
{
    return model >= FIT_DEVICE;
}

bool gbuffer_estimate(const struct gbuffer *g, const struct camera_search *search, struct fit *fit,
                      struct tool_error *err)
{
    const bool has_scale = g->depth_type != DEPTH_DEVICE && g->depth_type != DEPTH_NORMALIZED;
    if (!gbuffer_fit_camera(g, search, fit, err))
        return false;
    if (!search->models)
        snprintf(fit->why, sizeof fit->why, "depth is of type %s", depth_type_name(g->depth_type));
    if (fit->model == FIT_PLANAR_NORMALIZED && !fit->in_unit_range) {
        fit->model = FIT_PLANAR;
    } else if (has_scale && is_unscaled(fit->model)) {
        fit->is_usable = false;
        if (fit->is_sure)
            snprintf(fit->why, sizeof fit->why, "depth looks normalized");
        fit->is_sure = false;
    }
    return true;
}

bool gbuffer_estimate_anywhere(const struct gbuffer *g, const struct gbuffer_options *options,
                               struct fit *fit, struct tool_error *err)
{
    const struct camera_search search = {.models = possible_models(g, options, false)};
    return gbuffer_estimate(g, &search, fit, err);
}

bool gbuffer_estimate_single(const struct gbuffer *g, const struct gbuffer_options *options,
                             struct fit *fit, struct tool_error *err)
{
    const struct camera_search search = {.models = possible_models(g, options, false),
                                         .patch = FIT_PATCH_NONE};
    return gbuffer_estimate(g, &search, fit, err);
}

bool gbuffer_estimate_known(const struct gbuffer *g, const struct gbuffer_options *options,
                            enum fit_patch patch, struct fit *fit, struct tool_error *err)
{
    const struct camera_search search = {
        .models = possible_models(g, options, true), .is_known = true, .patch = patch};
    return gbuffer_estimate(g, &search, fit, err);
}

bool gbuffer_estimate_parallel(const struct gbuffer *g, const struct gbuffer_options *options,
                               bool is_known, struct fit *fit, struct tool_error *err)
{
    const struct camera_search search = {.models = 1u << FIT_ORTHO, .is_known = is_known};
    struct gbuffer other = *g;
    *fit = (struct fit){0};
    if (!gbuffer_type_is_auto(g, options) || g->depth_type != DEPTH_PLANAR ||
        (is_known && g->camera.type != CAMERA_ORTHOGRAPHIC) || has_sky_at_largest(g))
        return true;
    other.depth = malloc(gbuffer_texels(g) * sizeof *other.depth);
    if (!other.depth)
        return fail(err, EXIT_MEMORY, "out of memory for the camera");
    for (size_t i = 0; i < gbuffer_texels(g); i++)
        other.depth[i] = 1.0f / g->depth[i];
    const bool ok = gbuffer_estimate(&other, &search, fit, err);
    free(other.depth);
    return ok;
}
