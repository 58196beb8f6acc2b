/* SPDX-License-Identifier: MIT
 *
 * blur.comp for texels in a line: a window of them is loaded once, and all of its inner ones are
 * blurred from it. The includer defines how many these are, VKAO_BLUR_COUNT, and how many texels a
 * window has before and after them, VKAO_BLUR_REACH, at least RADIUS + MARGIN. */
#ifndef VKAO_BLUR_WINDOW_GLSL_
#define VKAO_BLUR_WINDOW_GLSL_

#include "ring_texels.glsl"
#include "surface.glsl"

/* Texels beyond the radius, whose depths tell slopes. */
const int MARGIN = 1;
const int REACH = VKAO_BLUR_REACH, WINDOW = VKAO_BLUR_COUNT + 2 * REACH;
#define USES_NORMALS (NORMAL_POWER > 0.0)

/* z: surface_z. unproject: see bend_stop. What nothing uses costs nothing. No constant comes late
 * into a result that is used once: a driver in software then takes lanes apart and goes on with
 * each on its own. */
void blur(float z[WINDOW], float v[WINDOW], vec4 normal[WINDOW], float unproject,
          out float result[VKAO_BLUR_COUNT])
{
    float slope[WINDOW];
    [[unroll]] for (int i = 1; i < WINDOW - 1; ++i)
        slope[i] = local_slope(z[i - 1], z[i], z[i + 1]);
    [[unroll]] for (int i = 0; i < VKAO_BLUR_COUNT; ++i) {
        int c = REACH + i;
        float edge = edge_stop(z[c], params.sharpness, params.reference_z);
        float bend = bend_stop(z[c], slope[c], unproject);
        vec2 sums = vec2(0.0), weights = vec2(0.0);
        float near = 0.0, all = 0.0, all_weights = 0.0;
        [[unroll]] for (int k = -RADIUS; k <= RADIUS; ++k) {
            if (k == 0)
                continue;
            float off = off_surface(z[c], slope[c], z[c + k], float(k));
            float alone = weight_alone(k, RADIUS), w = max(0.0, alone - alone * edge * off);
            if (USES_NORMALS) {
                near += w;
                w *= normal_weight(normal[c], normal[c + k], NORMAL_POWER);
            } else {
                w *= bend_weight(z[c], z[c + k], slope[c + k], float(k), bend);
            }
            sums[int(k > 0)] += w * v[c + k];
            weights[int(k > 0)] += w;
            float full = blur_weight(k, RADIUS) * is_surface(z[c + k]);
            all += full * v[c + k];
            all_weights += full;
        }
        float total = 1.0 + weights.x + weights.y;
        float leak = leak_of(USES_NORMALS ? near : total - 1.0, total - 1.0, RADIUS);
        vec2 more = more_across(weights, RADIUS);
        float sum = v[c] + sums.x + sums.y + dot(sums, more) + leak * all;
        result[i] = sum / (total + dot(weights, more) + leak * all_weights);
    }
}

#endif
