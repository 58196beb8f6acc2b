/* SPDX-License-Identifier: MIT
 *
 * The kernel of hemisphere, whose points come in pairs. Of reals, the first is the near point. */
#ifndef VKAO_KERNEL_GLSL_
#define VKAO_KERNEL_GLSL_

/* Of pair k, in radii. Straight between the ends of its stratum: that saves a root for each. */
reals pair_lengths(uint k, uint pairs, real jitter)
{
    float n = float(pairs), low = golden_sequence(k) * (n - 1.0) / n, high = low + 1.0 / n;
    vec2 near = 0.5 * vec2(low, high), far = near + 0.5;
    vec2 from = vec2(point_length(near.x), point_length(far.x)),
         to = vec2(point_length(near.y), point_length(far.y));
    return reals(from.x + (to.x - from.x) * jitter, from.y + (to.y - from.y) * jitter);
}

#endif
