/* SPDX-License-Identifier: MIT */
#include "gbuffer_internal.h"
#include "median.h"

#include <math.h>
#include <stdlib.h>

/* No scene measures more or less than this, in whatever unit. Within, squares are finite and not
 * 0. */
static const double least_z = 1e-18, largest_z = 1e18;

/* What renderers write where there is nothing: Falcor, Cycles, clip ranges. No scene measures
 * exactly this. Arnold's is beyond the largest. */
static bool is_sentinel(float z)
{
    static const float values[] = {1e8f, 1e10f, 1e12f};
    for (size_t i = 0; i < sizeof values / sizeof *values; i++)
        if (!(z < values[i]) && !(z > values[i]))
            return true;
    return false;
}

static bool is_valid(float z)
{
    return (double)z >= least_z && (double)z <= largest_z && !is_sentinel(z);
}

/* The median of the values as stored, without what is certainly background. */
static bool stored_median(const struct gbuffer *g, double *median)
{
    size_t step = gbuffer_sample_step(g), count = 0;
    double *values = malloc((gbuffer_texels(g) / step + 1) * sizeof *values);
    if (!values)
        return false;
    for (size_t i = 0; i < gbuffer_texels(g); i += step)
        if (is_valid(g->depth[i]))
            values[count++] = (double)g->depth[i];
    *median = median_of(values, count);
    free(values);
    return true;
}

/* An image of one number per texel, and the median of the depth beside it, which tells what is too
 * far away to belong to the scene. */
struct plane {
    float *values;
    size_t count;
    bool is_half;
    double median;
};

/* Distances of any kind: what is no distance becomes 0, which the library takes for background. All
 * of these return how many values are invalid. */
static size_t clean_distances(const struct plane *p)
{
    double limit = p->median * 1e7;
    size_t invalid = 0;
    for (size_t i = 0; i < p->count; i++) {
        float z = p->values[i];
        invalid += isnan(z) || z < 0;
        /* 65504 is the largest half, where a far background saturates. */
        bool saturated = p->is_half && z >= 65504.0f && p->median < 6550.4;
        if (!is_valid(z) || (double)z >= limit || saturated)
            p->values[i] = 0;
    }
    return invalid;
}

static size_t clean_inverse(const struct plane *p)
{
    size_t invalid = 0;
    for (size_t i = 0; i < p->count; i++) {
        invalid += isnan(p->values[i]) || p->values[i] < 0;
        if (!isfinite(p->values[i]) || p->values[i] <= 0)
            p->values[i] = 0;
    }
    return invalid;
}

static size_t clean_device(const struct plane *p, float background)
{
    size_t invalid = 0;
    for (size_t i = 0; i < p->count; i++) {
        bool inside = p->values[i] >= 0 && p->values[i] <= 1;
        invalid += !inside;
        if (!inside)
            p->values[i] = background;
    }
    return invalid;
}

/* How much longer the ray of a texel is than its way along the view axis. */
static double ray_length(const struct gbuffer *g, size_t texel)
{
    double x, y;
    if (g->camera.type == CAMERA_ORTHOGRAPHIC)
        return 1.0;
    camera_ray(&g->camera, &g->display_window, &g->data_window, (double)(texel % g->width),
               (double)(texel / g->width), &x, &y);
    return sqrt(1.0 + x * x + y * y);
}

/* Rays of Mitsuba start at the near plane; in double, since the result is compared with that of
 * planar files. */
static void near_ray_to_planar(const struct gbuffer *g, const struct plane *p)
{
    for (size_t i = 0; i < p->count; i++)
        if (p->values[i] > 0)
            p->values[i] = (float)((double)p->values[i] / ray_length(g, i) + g->camera.near_plane);
}

/* A depth of any layer as read becomes one of the library's encodings. */
static size_t clean_depth(const struct gbuffer *g, const struct plane *p)
{
    size_t invalid;
    switch (g->depth_type) {
    case DEPTH_INVERSE:
        return clean_inverse(p);
    case DEPTH_DEVICE:
        return clean_device(p, g->background_depth);
    default:
        invalid = clean_distances(p);
        if (g->depth_type == DEPTH_RADIAL_NEAR)
            near_ray_to_planar(g, p);
        return invalid;
    }
}

double gbuffer_view_z(const struct gbuffer *g, float depth, size_t texel)
{
    double d = (double)depth;
    const float *m = g->view.projection;
    switch (g->view.depth_encoding) {
    case VKAO_DEPTH_DISTANCE:
        return d / ray_length(g, texel);
    case VKAO_DEPTH_INVERSE_Z:
        return 1.0 / d;
    case VKAO_DEPTH_PROJECTED:
        return g->camera.type == CAMERA_ORTHOGRAPHIC ? ((double)m[14] - d) / (double)m[10]
                                                     : (double)m[14] / (d + (double)m[10]);
    default:
        return d;
    }
}

/* What no scene measures, after all: the library would compute with it. */
static void drop_immeasurable(const struct gbuffer *g, float *values)
{
    for (size_t i = 0; i < gbuffer_texels(g); i++) {
        double z = gbuffer_view_z(g, values[i], i);
        if (!(z >= least_z && z <= largest_z))
            values[i] = g->background_depth;
    }
}

/* Thickness and second depth, when the projection is known. */
static void prepare_behind(struct gbuffer *g, double median)
{
    const struct role *roles = g->roles.kind;
    const bool is_given = roles[ROLE_THICKNESS].found;
    const enum role_kind kinds[] = {is_given ? ROLE_THICKNESS : ROLE_BACK_DEPTH, ROLE_LAYER2};
    float *const images[] = {g->thickness, g->second_depth};
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        if (!images[i])
            continue;
        const struct plane p = {.values = images[i],
                                .count = gbuffer_texels(g),
                                .is_half = roles[kinds[i]].channels[0]->type == EXR_HALF,
                                .median = kinds[i] == ROLE_THICKNESS ? g->median_z : median};
        if (kinds[i] == ROLE_THICKNESS) {
            (void)clean_distances(&p);
            continue;
        }
        (void)clean_depth(g, &p);
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
        if (!(z >= least_z && z <= largest_z)) {
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
    if (!(n < f || n > f) || fmin(n, f) < least_z || (!infinite && fmax(n, f) > largest_z) ||
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

static void warn_about_depth(const struct gbuffer *g, const char *path, struct report *report)
{
    if (g->invalid_share > 0)
        report_warn(
            report, "invalid depth",
            "%s: %.2g %% of depth values are NaN, negative or out of range: treated as background",
            path, g->invalid_share * 100.0);
    if (!(g->median_z > 0))
        report_warn(report, "no depth", "%s: all depth is background: AO is 1 everywhere", path);
    if (g->depth_step > 0)
        report_warn(
            report, "half depth",
            "%s: depth is HALF; at the median distance %.4g the step is %.2g: expect banding", path,
            g->median_z, g->depth_step);
}

bool gbuffer_prepare_depth(struct gbuffer *g, const struct gbuffer_options *options,
                           const char *path, struct report *report, struct tool_error *err)
{
    (void)options;
    struct camera_planes planes = {g->camera.near_plane, g->camera.far_plane};
    double median;
    if (!check_planes(g, path, err))
        return false;
    if (!stored_median(g, &median))
        return fail(err, EXIT_MEMORY, "%s: out of memory", path);
    g->view.depth_encoding = g->depth_type == DEPTH_INVERSE  ? VKAO_DEPTH_INVERSE_Z
                             : g->depth_type == DEPTH_DEVICE ? VKAO_DEPTH_PROJECTED
                             : g->depth_type == DEPTH_RADIAL ? VKAO_DEPTH_DISTANCE
                                                             : VKAO_DEPTH_VIEW_Z;
    if (g->depth_type == DEPTH_DEVICE) {
        g->background_depth = planes.near_plane > planes.far_plane ? 0.0f : 1.0f;
        camera_project(&g->camera, &planes, &g->display_window, &g->data_window, &g->view);
    }
    const struct plane depth = {.values = g->depth,
                                .count = gbuffer_texels(g),
                                .is_half = g->roles.kind[ROLE_DEPTH].channels[0]->type == EXR_HALF,
                                .median = median};
    g->invalid_share = (double)clean_depth(g, &depth) / (double)depth.count;
    if (!measure(g))
        return fail(err, EXIT_MEMORY, "%s: out of memory", path);
    if (g->depth_type != DEPTH_DEVICE) {
        planes = enclosing_planes(g);
        camera_project(&g->camera, &planes, &g->display_window, &g->data_window, &g->view);
    }
    if (!camera_can_project(&g->view))
        return fail_projection(g, path, &planes, err);
    prepare_behind(g, median);
    if (depth.is_half && median > 0)
        g->depth_step = ldexp(1.0, (int)floor(log2(median)) - 10);
    warn_about_depth(g, path, report);
    return true;
}
