/* SPDX-License-Identifier: MIT */
#include "automatic.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* How high a texel is at the median distance. */
static double row_height(const struct gbuffer *g)
{
    const double rows = (double)g->display_window.y_max - g->display_window.y_min + 1;
    const double half = g->camera.half_height;
    return 2 * half / rows * (g->camera.type == CAMERA_ORTHOGRAPHIC ? 1 : g->median_z);
}

float relative_radius_of(const struct relative_radius *relative, const struct gbuffer *gbuffer)
{
    const bool is_auto = !(relative->amount > 0);
    const double percent = is_auto ? 5 : relative->amount;
    char digits[32];
    if (!(gbuffer->median_z > 0))
        return 1.0f;
    snprintf(digits, sizeof digits, "%.*g", is_auto ? 2 : 3,
             relative->in_pixels ? relative->amount * row_height(gbuffer)
                                 : percent / 100 * gbuffer->median_z);
    const float radius = strtof(digits, NULL);
    /* Its square must neither be 0 nor infinite. */
    return radius > 1e-18f ? fminf(radius, 1e18f) : 1e-18f;
}

void check_radius(const struct gbuffer *gbuffer, float radius, struct report *report)
{
    const struct exr_box *window = &gbuffer->display_window;
    const double columns = (double)window->x_max - window->x_min + 1,
                 rows = (double)window->y_max - window->y_min + 1;
    const double pixels = (double)radius / row_height(gbuffer), longer = fmax(columns, rows);
    if (!(gbuffer->median_z > 0) || !isfinite(pixels))
        return;
    if (gbuffer->second_min_z > gbuffer->max_z + (double)radius)
        report_warn(report, "layer2 reach",
                    "--layer2 '%s' begins at %.4g, more than the radius of %.3g behind all of the "
                    "depth, which ends at %.4g: it changes nothing; is it in another unit?",
                    gbuffer->roles.kind[ROLE_LAYER2].label, gbuffer->second_min_z, (double)radius,
                    gbuffer->max_z);
    if (pixels < 0.5)
        report_warn(report, "radius",
                    "radius %.3g is %.2g pixels at the median distance of %.3g: nothing so near is "
                    "seen, and AO is white; is depth in another unit? --radius 5%% follows it",
                    (double)radius, pixels, gbuffer->median_z);
    else if (pixels > 2 * longer)
        report_warn(
            report, "radius",
            "radius %.3g is %.3g times as long as the image at the median distance of %.3g: "
            "what lies beyond the image is not seen, and AO is lighter than in truth; is "
            "depth in another unit? --radius 5%% follows it",
            (double)radius, pixels / longer, gbuffer->median_z);
}

float automatic_bias(const struct gbuffer *gbuffer, float radius, float bias)
{
    float step = (float)(gbuffer->depth_step / (double)radius);
    if (!(step > bias))
        return bias;
    return step < 1.0f ? step : 1.0f;
}

float settled_bias(const struct gbuffer *gbuffer, float radius, float bias, struct report *report)
{
    const float raised = automatic_bias(gbuffer, radius, bias);
    if (raised > bias)
        report_warn(report, "bias", "bias raised to %.2g for the steps of the depth",
                    (double)raised);
    return raised;
}
