/* SPDX-License-Identifier: MIT */
#include "gbuffer_internal.h"
#include "median.h"
#include "text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* --- From what is stored --- */

static bool is_invalid(const struct gbuffer *g, float depth)
{
    const bool has_end = g->depth_type == DEPTH_DEVICE || g->depth_type == DEPTH_NORMALIZED;
    return isnan(depth) || depth < 0 || (has_end && depth > 1);
}

static bool is_zero_normal(const float *n)
{
    return !(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] > 0);
}

/* Whether one invalid value is what some program writes where there is nothing: nothing else says
 * so, normals and alpha have nothing there, and it comes in areas. */
static bool is_convention(const struct gbuffer *g)
{
    static const double nearly_all = 0.9, few = 0.02, least_share = 0.002;
    const size_t width = g->width, texels = gbuffer_texels(g);
    size_t count = 0, numbers = 0, equal = 0, bare = 0, transparent = 0, lonely = 0;
    float first = 0;
    for (size_t i = 0; i < texels; i++) {
        if (!is_invalid(g, g->depth[i])) {
            if (!gbuffer_is_measurable(gbuffer_distance(g, g->depth[i])))
                return false;
            continue;
        }
        first = numbers || isnan(g->depth[i]) ? first : g->depth[i];
        numbers += isnan(g->depth[i]) ? 0 : 1;
        equal += g->depth[i] <= first && g->depth[i] >= first;
        bare += g->normals && is_zero_normal(g->normals + i * 4);
        transparent += g->alpha && !(g->alpha[i] > 0);
        lonely += !(i % width > 0 && is_invalid(g, g->depth[i - 1])) &&
                  !(i % width + 1 < width && is_invalid(g, g->depth[i + 1])) &&
                  !(i >= width && is_invalid(g, g->depth[i - width])) &&
                  !(i + width < texels && is_invalid(g, g->depth[i + width]));
        count++;
    }
    const double all = (double)count;
    return all >= least_share * (double)texels && (numbers == 0 || equal == count) &&
           (!g->normals || (double)bare >= nearly_all * all) &&
           (!g->alpha || (double)transparent >= nearly_all * all) && (double)lonely <= few * all;
}

/* Depth of any layer as stored becomes one of the library's encodings; what is no distance becomes
 * what the library takes for background. Returns how many values are invalid. */
static size_t clean(const struct gbuffer *g, float *values, bool is_half)
{
    const struct background *b = &g->background;
    size_t invalid = 0;
    for (size_t i = 0; i < gbuffer_texels(g); i++) {
        const double distance = gbuffer_distance(g, values[i]);
        /* The largest half is where a far background saturates. */
        const bool is_saturated =
            is_half && g->depth_type != DEPTH_INVERSE && values[i] >= 65504.0f;
        invalid += is_invalid(g, values[i]);
        if (!gbuffer_is_measurable(distance) || distance >= b->limit || is_saturated ||
            (b->is_transparent && !(g->alpha[i] > 0)) ||
            (b->has_point && values[i] <= b->point && values[i] >= b->point))
            values[i] = g->background_depth;
        else if (g->depth_type == DEPTH_NORMALIZED)
            values[i] =
                (float)(g->depth_range.is_radial ? distance / gbuffer_ray_length(g, i) : distance);
        /* Rays of Mitsuba start at the near plane; in double, since the result is compared with
         * that of planar files. */
        else if (g->depth_type == DEPTH_RADIAL_NEAR)
            values[i] = (float)(distance / gbuffer_ray_length(g, i) + g->camera.near_plane);
    }
    return invalid;
}

/* Lengths: 0 is unknown. */
static void clean_lengths(float *values, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (!gbuffer_is_measurable((double)values[i]))
            values[i] = 0;
}

/* What no scene measures, after all: the library would compute with it. */
static void drop_immeasurable(const struct gbuffer *g, float *values)
{
    for (size_t i = 0; i < gbuffer_texels(g); i++) {
        double z = gbuffer_view_z(g, values[i], i);
        if (!gbuffer_is_in_range(z))
            values[i] = g->background_depth;
    }
}

/* Thickness and second depth, when the projection is known. */
static void prepare_behind(struct gbuffer *g)
{
    const struct role *roles = g->roles.kind;
    const bool is_given = roles[ROLE_THICKNESS].found;
    const enum role_kind kinds[] = {is_given ? ROLE_THICKNESS : ROLE_BACK_DEPTH, ROLE_LAYER2};
    float *const images[] = {g->thickness, g->second_depth};
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        if (!images[i])
            continue;
        if (kinds[i] == ROLE_THICKNESS) {
            clean_lengths(images[i], gbuffer_texels(g));
            continue;
        }
        for (size_t k = 0; g->depth_is_negated && k < gbuffer_texels(g); k++)
            images[i][k] = -images[i][k];
        (void)clean(g, images[i], roles[kinds[i]].channels[0]->type == EXR_HALF);
        drop_immeasurable(g, images[i]);
    }
}

static bool measure(struct gbuffer *g)
{
    size_t step = gbuffer_sample_step(g), count = 0, foreground = 0;
    double *values = malloc((gbuffer_texels(g) / step + 1) * sizeof *values);
    if (!values)
        return false;
    for (size_t i = 0; i < gbuffer_texels(g); i++) {
        if (!gbuffer_is_foreground(g, i))
            continue;
        double z = gbuffer_view_z(g, g->depth[i], i);
        if (!gbuffer_is_in_range(z)) {
            g->depth[i] = g->background_depth;
            continue;
        }
        if (foreground++ == 0)
            g->min_z = g->max_z = z;
        g->min_z = z < g->min_z ? z : g->min_z;
        g->max_z = z > g->max_z ? z : g->max_z;
        if (i % step == 0)
            values[count++] = z;
    }
    g->median_z = count ? median_of(values, count) : g->min_z;
    g->background_share = 1.0 - (double)foreground / (double)gbuffer_texels(g);
    free(values);
    return true;
}

/* Depth that is no device depth needs no exact planes, only ones that leave all of the scene
 * between them. */
static struct camera_planes enclosing_planes(const struct gbuffer *g)
{
    struct camera_planes planes = {.near_plane = 0.1, .far_plane = INFINITY};
    if (g->min_z > 0)
        planes.near_plane = g->min_z * 0.5;
    if (g->camera.near_plane > 0 && g->camera.near_plane < planes.near_plane)
        planes.near_plane = g->camera.near_plane;
    if (g->camera.type == CAMERA_ORTHOGRAPHIC) {
        planes.near_plane = 0;
        planes.far_plane = g->max_z > 0 ? g->max_z * 2.0 : 1.0;
    }
    return planes;
}

/* Normalised depth needs what its ends stand for. */
static bool check_range(const struct gbuffer *g, const char *path, struct tool_error *err)
{
    const struct depth_range *r = &g->depth_range;
    if (g->depth_type != DEPTH_NORMALIZED || r->is_given)
        return true;
    fail_hint(err, "add --depth-range NEAR,FAR, the distances of black and white; NEAR,FAR,inverted"
                   " if white is near");
    return fail(err, EXIT_CHANNELS, "%s: normalised depth '%s' needs its range", path,
                g->roles.kind[ROLE_DEPTH].label);
}

static bool check_planes(const struct gbuffer *g, const char *path, struct tool_error *err)
{
    double n = g->camera.near_plane, f = g->camera.far_plane;
    if (g->depth_type == DEPTH_RADIAL_NEAR && !(n > 0 && isfinite(n))) {
        fail_hint(err, "add --near DISTANCE (the renderer's near clip), or --camera with \"near\"; "
                       "--depth-type radial if distances start at the eye");
        return fail(err, EXIT_CHANNELS,
                    "%s: depth '%s' is measured from the near plane: its distance is needed", path,
                    g->roles.kind[ROLE_DEPTH].label);
    }
    if (g->depth_type != DEPTH_DEVICE)
        return true;
    if (!(n > 0) || !(f > 0)) {
        fail_hint(err, "add --near and --far; near > far for a reversed depth buffer");
        return fail(err, EXIT_CHANNELS, "%s: device depth needs both planes", path);
    }
    bool infinite = isinf(n) || isinf(f);
    if (!(n < f || n > f) || !gbuffer_is_in_range(fmin(n, f)) ||
        (!infinite && !gbuffer_is_in_range(fmax(n, f))) ||
        (infinite && (g->camera.type == CAMERA_ORTHOGRAPHIC)))
        return fail(err, EXIT_CHANNELS, "%s: planes at %g and %g give no projection", path, n, f);
    return true;
}

static bool fail_projection(const struct gbuffer *g, const char *path,
                            const struct camera_planes *planes, struct tool_error *err)
{
    fail_hint(err, "--fov or --ortho, and --near and --far, take the place of the header's");
    return fail(err, EXIT_CHANNELS,
                "%s: the camera (%s) gives no usable projection: half sizes %g and %g, shift %g "
                "and %g, planes at %g and %g",
                path, g->camera.source[0] ? g->camera.source : "assumed", g->camera.half_width,
                g->camera.half_height, g->camera.shift_x, g->camera.shift_y, planes->near_plane,
                planes->far_plane);
}

/* Between neighbouring half values at the median distance, in scene units. */
static double half_step(const struct gbuffer *g)
{
    const double z = g->median_z;
    const float *m = g->view.projection;
    double stored = z, slope = 1.0;
    if (g->depth_type == DEPTH_INVERSE) {
        stored = 1.0 / z;
        slope = z * z;
    } else if (g->depth_type == DEPTH_NORMALIZED) {
        slope = fabs(g->depth_range.one - g->depth_range.zero);
        stored = fabs(z - g->depth_range.zero) / slope;
    } else if (g->depth_type == DEPTH_DEVICE && g->camera.type == CAMERA_PERSPECTIVE) {
        stored = (double)m[14] / z - (double)m[10];
        slope = z * z / fabs((double)m[14]);
    } else if (g->depth_type == DEPTH_DEVICE) {
        slope = 1.0 / fabs((double)m[10]);
        stored = fabs((double)m[14] - z * (double)m[10]);
    }
    /* The least half that has all digits. */
    return ldexp(1.0, (int)floor(log2(fmax(stored, 6.1e-5))) - 10) * slope;
}

static int compare_floats(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return x < y ? -1 : x > y;
}

/* Stairs of this height, two texels a step or more: what is smooth has none, and what lies along
 * the rows of the image, as floors do, changes with each. */
static bool has_stairs(const struct gbuffer *g, double height)
{
    const size_t steps[2] = {1, g->width}, texels = gbuffer_texels(g);
    size_t count = 0;
    for (size_t i = 0; i + 3 * g->width < texels; i++)
        for (int k = 0; k < 2; k++) {
            const float *d = g->depth + i;
            const size_t s = steps[k];
            const double rise = fabs((double)d[2 * s] - (double)d[s]);
            const double treads =
                fabs((double)d[s] - (double)d[0]) + fabs((double)d[3 * s] - (double)d[2 * s]);
            count += !(treads > 0) && fabs(rise - height) < 0.01 * height;
        }
    return count > texels / 200;
}

/* Of distances that were whole numbers once: the least difference of any two, if that is one that
 * no surface has, else 0. False if memory runs out. */
static bool find_steps(const struct gbuffer *g, double *least)
{
    enum { MOST = 1 << 14, FEW = 24 };
    const size_t step = gbuffer_texels(g) / MOST + 1;
    float *values = malloc((gbuffer_texels(g) / step + 1) * sizeof *values);
    size_t count = 0, different = 0;
    if (!values)
        return false;
    for (size_t i = 0; i < gbuffer_texels(g); i += step)
        if (gbuffer_is_foreground(g, i))
            values[count++] = g->depth[i];
    qsort(values, count, sizeof *values, compare_floats);
    *least = INFINITY;
    for (size_t i = 1; i < count; i++) {
        const double gap = (double)values[i] - (double)values[i - 1];
        different += gap > 0;
        *least = gap > 0 ? fmin(*least, gap) : *least;
    }
    /* Of many values of a surface some are nearly the same, but for rounding. */
    if (different < FEW || *least < 2e-4 * g->median_z || !has_stairs(g, *least))
        *least = 0;
    free(values);
    return true;
}

/* Of the values as stored, background and all. */
struct stored_range {
    float low, high;
};

static void warn_about_background(const struct gbuffer *g, const char *path, struct report *report)
{
    /* Of the surface; less is what lies at a horizon. */
    static const double much = 0.05;
    const struct background *b = &g->background;
    char share[PERCENT_BYTES];
    text_percent(share, b->cut_share);
    if (b->is_amid_surface && b->cut_share > much)
        report_warn(report, "cut depth",
                    "%s: --background %.6g lies amid surfaces, and %s of what depth '%s' shows is "
                    "that far or farther: too near, or in another unit? AO is 1 there; give the "
                    "distance of the background, or --background off",
                    path, b->value, share, g->roles.kind[ROLE_DEPTH].label);
    text_percent(share, b->share);
    if (b->reason == BACKGROUND_FAR && b->is_doubtful)
        report_warn(report, "far background",
                    "%s: %s of the depth are at %.6g, %.2g times as far as all else: taken for "
                    "background (--background off or DISTANCE overrides)",
                    path, share, b->value, b->gap);
    if (b->reason == BACKGROUND_DOUBT)
        report_warn(report, "far wall",
                    "%s: %s of the depth are at %.6g: taken for a wall (--background %.6g if there "
                    "is nothing)",
                    path, share, b->value, b->value);
}

static void warn_about_depth(const struct gbuffer *g, const char *path, struct report *report)
{
    char share[PERCENT_BYTES];
    warn_about_background(g, path, report);
    text_percent(share, g->invalid_share);
    if (g->invalid_share > 0 && !g->invalid_is_meant)
        report_warn(
            report, "invalid depth",
            "%s: %s of depth values are NaN, negative or out of range: treated as background", path,
            share);
    if (g->depth_step > 0)
        report_warn(report, "half depth",
                    "%s: depth is %s; at the median distance %.4g the step is %.2g: expect banding",
                    path, g->depth_is_half ? "HALF" : "in steps", g->median_z, g->depth_step);
    text_percent(share, g->filtered_share);
    if (g->filtered_share > GBUFFER_MOST_FILTERED)
        report_warn(report, "filtered depth",
                    "%s: depth is filtered over edges (antialiased) or blurred: %s of them have "
                    "texels in between, where AO is wrong; render it unfiltered",
                    path, share);
}

/* A quarter of a texel's width is more than roundness makes, and less than AO shows. */
static const double most_noise = 0.25;
/* Of rough ground beside normals in steps of half a degree. */
static const double most_noise_of_bytes = 0.5;

static void warn_about_grain(const struct gbuffer *g, const char *path, struct report *report)
{
    const unsigned width = g->ridge_width;
    const bool is_coarse = g->noise > most_noise && gbuffer_are_normals_of_bytes(g);
    if (g->block_size > 1)
        report_warn(report, "enlarged depth",
                    "%s: depth is enlarged %u times without interpolation: AO shows its blocks; "
                    "render it at full size",
                    path, g->block_size);
    else if (width > 1 && !(g->depth_step > 0))
        report_warn(report, "nearest depth",
                    "%s: depth is that of the nearest or the farthest of %u x %u pixels: nothing "
                    "is narrower than that; AO is wrong at borders; render it unfiltered",
                    path, width, width);
    else if (g->noise > (is_coarse ? most_noise_of_bytes : most_noise))
        report_warn(report, "noisy depth",
                    "%s: depth is noisy: where normals say that it is flat it bends by %.2g widths "
                    "of a texel; AO shows that; take one sample, in the centre of the pixel",
                    path, g->noise);
}

/* A pass without any shape is no depth, unless somebody says that it is. */
static bool check_shape(const struct gbuffer *g, const struct gbuffer_options *options,
                        const struct stored_range *stored, const char *path, struct report *report,
                        struct tool_error *err)
{
    enum { FEW = 16 };
    const struct role *role = &g->roles.kind[ROLE_DEPTH];
    const bool is_flat = !(stored->low < stored->high), is_empty = !(g->median_z > 0);
    char what[96];
    if (!is_empty && (!is_flat || g->background_share > 0 || gbuffer_texels(g) < FEW)) {
        if (is_flat && g->background_share > 0)
            report_warn(report, "flat depth",
                        "%s: depth '%s' is %g wherever there is something: a matte?", path,
                        role->label, (double)stored->low);
        return true;
    }
    if (!is_flat)
        snprintf(what, sizeof what, "all background");
    else
        snprintf(what, sizeof what, "%g everywhere",
                 stored->low <= stored->high ? (double)stored->low : NAN);
    if (options->depth_type != DEPTH_AUTO) {
        report_warn(report, "no depth", "%s: depth '%s' is %s: AO is 1 everywhere", path,
                    role->label, what);
        return true;
    }
    if (g->background.cut > 0)
        fail_hint(err,
                  "all of it is as far as --background %.6g or farther: give the distance of "
                  "the background, in the unit of depth, or --background off",
                  g->background.value);
    fail_hint(err, "is it the right channel (--depth NAME)? If it is meant, say what it measures: "
                   "--depth-type planar");
    return fail(err, EXIT_CHANNELS, "%s: depth '%s' is %s: no picture of anything", path,
                role->label, what);
}

/* Before anything is changed. */
static struct stored_range look_at_range(const struct gbuffer *g)
{
    struct stored_range r = {.low = INFINITY, .high = -INFINITY};
    for (size_t i = 0; i < gbuffer_texels(g); i++) {
        r.low = g->depth[i] < r.low ? g->depth[i] : r.low;
        r.high = g->depth[i] > r.high ? g->depth[i] : r.high;
    }
    return r;
}

static void warn_about_compression(const struct gbuffer *g, const struct exr_part *part,
                                   const char *path, struct report *report)
{
    const struct exr_channel *channel = g->roles.kind[ROLE_DEPTH].channels[0];
    const char *dot = strrchr(channel->name, '.');
    const bool is_color = strchr("RGBY", dot ? dot[1] : channel->name[0]) &&
                          strlen(dot ? dot + 1 : channel->name) == 1;
    const bool is_b44 = strncmp(part->compression, "b44", 3) == 0 && channel->type == EXR_HALF;
    const bool is_dwa = strncmp(part->compression, "dwa", 3) == 0 && is_color;
    if (is_b44 || is_dwa)
        report_warn(
            report, "lossy depth",
            "%s: depth '%s' is compressed with %s, which is lossy: expect dark outlines and "
            "stains (write depth as float, with zip or piz)",
            path, g->roles.kind[ROLE_DEPTH].label, part->compression);
}

bool gbuffer_prepare_depth(struct gbuffer *g, const struct exr_info *info,
                           const struct gbuffer_options *options, struct report *report,
                           struct tool_error *err)
{
    const char *path = info->path;
    const struct role *role = &g->roles.kind[ROLE_DEPTH];
    g->depth_is_half = role->channels[0]->type == EXR_HALF || gbuffer_holds_halves(g);
    g->block_size = gbuffer_block_size(g);
    g->ridge_width = gbuffer_ridge_width(g);
    const struct stored_range stored = look_at_range(g);
    if (!gbuffer_resolve_depth_type(g, info, options, report, err) || !check_range(g, path, err) ||
        !check_planes(g, path, err))
        return false;
    if (g->depth_range.is_given && g->depth_type != DEPTH_NORMALIZED)
        report_warn(report, "unused range",
                    "%s: --depth-range is left aside: depth '%s' is taken for %s (--depth-type "
                    "normalized overrides)",
                    path, role->label, depth_type_name(g->depth_type));
    if (g->depth_type != DEPTH_NORMALIZED && !options->is_type_recorded &&
        g->depth_source != DEPTH_BY_POSITIONS && !gbuffer_warn_of_curve(g, path, report))
        return fail(err, EXIT_MEMORY, "%s: out of memory", path);
    g->filtered_share = gbuffer_filtered_share(g);
    struct camera_planes planes = {g->camera.near_plane, g->camera.far_plane};
    g->view.depth_encoding = g->depth_type == DEPTH_INVERSE  ? VKAO_DEPTH_INVERSE_Z
                             : g->depth_type == DEPTH_DEVICE ? VKAO_DEPTH_PROJECTED
                             : g->depth_type == DEPTH_RADIAL ? VKAO_DEPTH_DISTANCE
                                                             : VKAO_DEPTH_VIEW_Z;
    if (g->depth_type == DEPTH_DEVICE) {
        g->background_depth = planes.near_plane > planes.far_plane ? 0.0f : 1.0f;
        camera_project(&g->camera, &planes, &g->display_window, &g->data_window, &g->view);
    }
    if (!gbuffer_find_background(g, options))
        return fail(err, EXIT_MEMORY, "%s: out of memory", path);
    g->invalid_is_meant = is_convention(g);
    g->invalid_share = (double)clean(g, g->depth, g->depth_is_half) / (double)gbuffer_texels(g);
    if (!measure(g))
        return fail(err, EXIT_MEMORY, "%s: out of memory", path);
    if (g->depth_type != DEPTH_DEVICE) {
        planes = enclosing_planes(g);
        camera_project(&g->camera, &planes, &g->display_window, &g->data_window, &g->view);
    }
    if (!camera_can_project(&g->view))
        return fail_projection(g, path, &planes, err);
    if (!check_shape(g, options, &stored, path, report, err))
        return false;
    prepare_behind(g);
    if (g->depth_is_half && g->median_z > 0)
        g->depth_step = half_step(g);
    const bool is_distance = g->view.depth_encoding == VKAO_DEPTH_VIEW_Z ||
                             g->view.depth_encoding == VKAO_DEPTH_DISTANCE;
    if (!g->depth_is_half && is_distance && !find_steps(g, &g->depth_step))
        return fail(err, EXIT_MEMORY, "%s: out of memory", path);
    if (g->normals && !(g->depth_step > 0) && !gbuffer_measure_noise(g, &g->noise))
        return fail(err, EXIT_MEMORY, "%s: out of memory", path);
    warn_about_compression(g, &info->parts[role->part], path, report);
    warn_about_depth(g, path, report);
    warn_about_grain(g, path, report);
    gbuffer_warn_of_panorama(g, path, report);
    return true;
}
