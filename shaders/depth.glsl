/* SPDX-License-Identifier: MIT
 *
 * The caller's depth, of any encoding, to positive view z; 0 is background. The includer's params have unproject,
 * linearize and far_z. */
#ifndef VKAO_DEPTH_GLSL_
#define VKAO_DEPTH_GLSL_

#include "flags.glsl"

layout(binding = VKAO_BINDING_DEPTH) uniform texture2D depth_image;

/* z/w beyond 0 or 1 cannot have been rasterised; what is at or past the far plane is background. */
float view_z_from_projected(float depth)
{
    bool far = flag(VKAO_FLAG_FAR_IS_ONE) ? depth >= 1.0 : depth <= 0.0;
    float z = orthographic() ? params.linearize.x + params.linearize.y * depth
                                        : params.linearize.x / (params.linearize.y - depth);
    return far ? 0.0 : z;
}

float view_z_from_depth(ivec2 texel)
{
    float depth = texelFetch(depth_image, texel, 0).x;
    float z = depth;
    if (depth_encoding() == VKAO_GLSL_DEPTH_PROJECTED) {
        z = view_z_from_projected(depth);
    } else if (depth_encoding() == VKAO_GLSL_DEPTH_INVERSE_Z) {
        z = 1.0 / depth;
    } else if (depth_encoding() == VKAO_GLSL_DEPTH_DISTANCE && !orthographic()) {
        vec2 xy = vec2(texel) * params.unproject.xy + params.unproject.zw;
        z = depth * inversesqrt(1.0 + dot(xy, xy));
    }
    /* Comparisons with NaN are false, so NaN is background too. */
    return z > VKAO_NEAREST_Z && z < params.far_z ? z : 0.0;
}

#endif
