/* SPDX-License-Identifier: MIT
 *
 * One direction of the separable cross-bilateral blur (Petschnigg et al. 2004; Eisemann and Durand
 * 2004). The weight of tap k is blur_weight, times max(0, 1 - sharpness * |z_k - z - slope k| / z),
 * slope being the smaller of the two neighbour differences, times max(0, n.n_k)^normal_power or,
 * without normals, bend_weight, and less where the other side of the window is not on the surface,
 * see more_across. Where next to nothing counts, all does a little, see leak_of; but bent normals
 * of others are wrong.
 * Continuing the slope keeps tilted walls in one piece where a plain depth difference would cut
 * them up. AO is not clamped on the way: one slice per texel often sees more than its share, and a
 * clamp would turn that noise into bias. With VKAO_LAST the result is final. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#define VKAO_GLSL
#include "params.h"

layout(local_size_x = VKAO_GROUP_WIDTH, local_size_y = VKAO_GROUP_HEIGHT) in;
#include "halfway.glsl"
#include "settings.glsl"
layout(binding = VKAO_BINDING_SOURCE) uniform texture2D source_image;
layout(binding = VKAO_BINDING_BENT_SOURCE) uniform texture2D bent_image;
#include "view.glsl"
#include "surface.glsl"
#include "bent_code.glsl"
#include "visibility_code.glsl"
#ifdef VKAO_LAST
#include "finish.glsl"
#else
#include "half.glsl"
layout(binding = VKAO_BINDING_TARGET) uniform writeonly image2D target_image;
#endif

const ivec2 AXIS = VERTICAL ? ivec2(0, 1) : ivec2(1, 0);

/* Visibility less 1: where all is open, sums are exactly 0 and so is what a division makes of
 * them. */
const vec4 ALL_OPEN = vec4(0.0, 0.0, 0.0, 1.0);

vec4 load_source(ivec2 texel)
{
    vec4 v = texelFetch(source_image, VERTICAL ? halfway_texel(texel) : texel, 0);
    if (VERTICAL)
        return BENT_NORMALS ? v : v.xxxx;
    vec3 bent = vec3(0.0);
    if (BENT_NORMALS)
        bent = decode_bent(texelFetch(bent_image, texel, 0));
    return vec4(bent, decode_visibility(v.x));
}

float local_slope(ivec2 texel, float z)
{
    return local_slope(surface_z(load_view_z(texel - AXIS)), z,
                       surface_z(load_view_z(texel + AXIS)));
}

vec4 blurred(ivec2 texel, float z)
{
    float slope = local_slope(texel, z);
    float edge = edge_stop(z, params.sharpness, params.reference_z);
    float bend = bend_stop(z, slope, VERTICAL ? params.unproject.y : params.unproject.x);
    vec4 normal = NORMAL_POWER > 0.0 ? stored_normal(texel << GRID_SHIFT) : vec4(0.0);
    vec4 sums[2] = vec4[](vec4(0.0), vec4(0.0));
    vec2 weights = vec2(0.0);
    float near = 0.0, all = 0.0, all_weights = 0.0;
    int k = -RADIUS;
    for (;;) {
        ivec2 at = texel + k * AXIS;
        float tap_z = k == 0 ? 0.0 : load_view_z(at);
        if (tap_z > 0.0) {
            float off = off_surface(z, slope, tap_z, float(k));
            float w = weight_alone(k, RADIUS) * max(0.0, 1.0 - edge * off);
            if (NORMAL_POWER == 0.0)
                w *= bend_weight(z, tap_z, local_slope(at, tap_z), float(k), bend);
            near += w;
            if (NORMAL_POWER > 0.0)
                w *= normal_weight(normal, stored_normal(at << GRID_SHIFT), NORMAL_POWER);
            vec4 v = load_source(at) - ALL_OPEN;
            int side = int(k > 0);
            sums[side] += w * v;
            weights[side] += w;
            float full = blur_weight(k, RADIUS);
            all += full * v.w;
            all_weights += full;
        }
        if (++k > RADIUS)
            break;
    }
    float leak = leak_of(near, weights.x + weights.y, RADIUS);
    vec2 gain = 1.0 + more_across(weights, RADIUS);
    vec4 sum = load_source(texel) - ALL_OPEN + gain.x * sums[0] + gain.y * sums[1];
    sum.w += leak * all;
    float total = 1.0 + dot(gain, weights);
    return sum / vec4(vec3(total), total + leak * all_weights) + ALL_OPEN;
}

void main()
{
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy) + unpack_texel(here.rect.x);
    if (any(greaterThanEqual(texel, unpack_texel(here.rect.y))))
        return;
    float z = load_view_z(texel);
    vec4 result = z > 0.0 ? blurred(texel, z) : vec4(0.0, 0.0, 0.0, 1.0);
    /* an ao_noisy of the caller's may hold anything */
    result.w = is_sane(result.w) ? result.w : 1.0;
#ifdef VKAO_LAST
    finish(texel, result, z == 0.0);
#else
    imageStore(target_image, VERTICAL ? texel : halfway_texel(texel),
               nearest_half(BENT_NORMALS ? result : result.wwww));
#endif
}
