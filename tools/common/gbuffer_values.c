/* SPDX-License-Identifier: MIT
 *
 * What a stored depth stands for. */
#include "gbuffer_internal.h"

#include <math.h>

const char *depth_type_name(enum depth_type type)
{
    static const char *const names[] = {"auto",    "planar", "radial",     "radial-near",
                                        "inverse", "device", "normalized", "position"};
    return names[type];
}

/* No scene measures exactly this, nor what lossy compression makes of it. Arnold's is beyond the
 * largest. */
static bool is_sentinel(double z)
{
    static const double values[] = {1e8, 1e10, 1e12};
    for (size_t i = 0; i < sizeof values / sizeof *values; i++)
        if (fabs(z - values[i]) < 1e-5 * values[i])
            return true;
    return false;
}

bool gbuffer_is_in_range(double z)
{
    return z >= 1e-18 && z <= 1e18;
}

bool gbuffer_is_measurable(double z)
{
    return gbuffer_is_in_range(z) && !is_sentinel(z);
}

double gbuffer_ray_length(const struct gbuffer *g, size_t texel)
{
    double x, y;
    if (g->camera.type == CAMERA_ORTHOGRAPHIC)
        return 1.0;
    camera_ray(&g->camera, &g->display_window, &g->data_window, (double)(texel % g->width),
               (double)(texel / g->width), &x, &y);
    return sqrt(1.0 + x * x + y * y);
}

double gbuffer_distance(const struct gbuffer *g, float depth)
{
    const double d = (double)depth;
    switch (g->depth_type) {
    case DEPTH_INVERSE:
        return 1.0 / d;
    case DEPTH_DEVICE:
        return d >= 0 && d <= 1 ? gbuffer_view_z(g, depth, 0) : NAN;
    case DEPTH_NORMALIZED:
        /* The ends hold what was clamped: mostly nothing. */
        return d > 0 && d < 1 ? g->depth_range.zero + d * (g->depth_range.one - g->depth_range.zero)
                              : NAN;
    default:
        return d;
    }
}

double gbuffer_view_z(const struct gbuffer *g, float depth, size_t texel)
{
    double d = (double)depth;
    const float *m = g->view.projection;
    switch (g->view.depth_encoding) {
    case VKAO_DEPTH_DISTANCE:
        return d / gbuffer_ray_length(g, texel);
    case VKAO_DEPTH_INVERSE_Z:
        return 1.0 / d;
    case VKAO_DEPTH_PROJECTED:
        return g->camera.type == CAMERA_ORTHOGRAPHIC ? ((double)m[14] - d) / (double)m[10]
                                                     : (double)m[14] / (d + (double)m[10]);
    default:
        return d;
    }
}
