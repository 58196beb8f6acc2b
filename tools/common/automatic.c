/* SPDX-License-Identifier: MIT */
#include "automatic.h"

#include <stdio.h>
#include <stdlib.h>

float automatic_radius(const struct gbuffer *gbuffer)
{
    char digits[32];
    if (!(gbuffer->median_z > 0))
        return 1.0f;
    snprintf(digits, sizeof digits, "%.2g", gbuffer->median_z * 0.05);
    float radius = strtof(digits, NULL);
    return radius > 1e-18f ? radius : 1e-18f; /* its square must not be 0 */
}

float automatic_bias(const struct gbuffer *gbuffer, float radius, float bias)
{
    float step = (float)(gbuffer->depth_step / (double)radius);
    if (!(step > bias))
        return bias;
    return step < 1.0f ? step : 1.0f;
}
