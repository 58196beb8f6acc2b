/* SPDX-License-Identifier: MIT
 *
 * How occluders count by distance, for all methods. */
#ifndef VKAO_FALLOFF_GLSL_
#define VKAO_FALLOFF_GLSL_

#include "real.glsl"

/* At squared distance d2, in radii: the definition of both ray-traced truths. */
reals falloff_weight(reals d2)
{
    return THRESHOLD ? reals(lessThanEqual(d2, reals(1.0))) : max(reals(0.0), 1.0 - d2);
}

/* Length of a point of the kernel in radii, u uniform in [0,1). A point at length l is hidden if
 * its ray hits anything within l, so the distribution of l carries the falloff: P(l > t) = 1 - t^2
 * for l = sqrt(u), the smooth one. For the threshold a ray counts alike wherever it hits, so the
 * lengths crowd towards 1. */
float point_length(float u)
{
    return THRESHOLD ? sqrt(sqrt(u)) : sqrt(u);
}

/* How much an occluder counts whose view z is dz off the shaded point's: all within the radius,
 * then less and less, as the surface in front need not reach down to the point behind it. */
reals range_weight(reals dz, float radius)
{
    /* Not max(), which a driver in software makes look for NaN. */
    reals far = abs(dz);
    far = mix(reals(radius), far, greaterThan(far, reals(radius)));
    reals t = radius / far;
    return t * t * (3.0 - 2.0 * t);
}

#endif
