/* SPDX-License-Identifier: MIT
 *
 * AO of every second texel of every second row -> all texels: joint bilateral upsampling (Kopf et
 * al. 2007). A texel takes from the one, two or four half-resolution texels that it coincides with
 * or lies between, by the depth and normal weights of the blur. Depth is continued by the slope at
 * the full-resolution texel. Where no neighbour lies on its surface, the least wrong one
 * decides. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#define VKAO_GLSL
#include "params.h"

layout(local_size_x = VKAO_GROUP_WIDTH, local_size_y = VKAO_GROUP_HEIGHT) in;
layout(push_constant) uniform Block { vkao_dispatch here; };
#include "settings.glsl"
layout(binding = VKAO_BINDING_SOURCE) uniform texture2D half_image;
#include "view.glsl"
#include "depth.glsl"
#include "surface.glsl"
#include "finish.glsl"

float full_view_z(ivec2 texel)
{
    return in_rect(texel, params.image_valid) ? view_z_from_depth(texel) : 0.0;
}

float slope_along(ivec2 texel, ivec2 axis, float z)
{
    return local_slope(surface_z(full_view_z(texel - axis)), z,
                       surface_z(full_view_z(texel + axis)));
}

vec4 upsampled(ivec2 texel, float z)
{
    vec2 slope = vec2(slope_along(texel, ivec2(1, 0), z), slope_along(texel, ivec2(0, 1), z));
    float edge = edge_stop(z, params.sharpness, params.reference_z);
    vec4 normal = NORMAL_POWER > 0.0 ? stored_normal(texel) : vec4(0.0);
    vec4 sum = vec4(0.0);
    float weights = 0.0;
    /* Even texels are of half resolution; the others lie in the middle of two or four. */
    ivec2 odd = texel & 1;
    for (int j = 0; j <= odd.y; ++j) {
        for (int i = 0; i <= odd.x; ++i) {
            ivec2 at = (texel >> 1) + ivec2(i, j);
            float half_z = load_view_z(at);
            if (half_z <= 0.0)
                continue;
            float off = edge * abs(half_z - z - dot(slope, vec2(2 * at - texel)));
            float w = max(0.0, 1.0 - off);
            if (NORMAL_POWER > 0.0)
                w *= normal_weight(normal, stored_normal(2 * at), NORMAL_POWER);
            /* Far below any honest weight: decides only if there is none. */
            w += 1.0e-6 / (1.0 + off * off);
            vec4 v = texelFetch(half_image, at, 0);
            sum += w * (BENT_NORMALS ? v : v.xxxx);
            weights += w;
        }
    }
    /* A lone texel before the sky: open, towards the eye. */
    return weights > 0.0 ? sum / weights : vec4(0.0, 0.0, -1.0, 1.0);
}

void main()
{
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy) + unpack_texel(here.rect.x);
    if (any(greaterThanEqual(texel, unpack_texel(here.rect.y))))
        return;
    float z = view_z_from_depth(texel);
    finish(texel, z > 0.0 ? upsampled(texel, z) : vec4(0.0), z == 0.0);
}
