/* SPDX-License-Identifier: MIT
 *
 * The caller's depth, of any encoding, to positive view z; 0 is background. */
#ifndef VKAO_DEPTH_GLSL_
#define VKAO_DEPTH_GLSL_

#include "settings.glsl"

layout(binding = VKAO_BINDING_DEPTH) uniform texture2D depth_image;

/* z/w beyond 0 or 1 cannot have been rasterised; what is at or past the far plane is background. */
float view_z_from_projected(float depth)
{
    bool far = depth * params.far_test.x >= params.far_test.y;
    float z = ORTHOGRAPHIC ? params.linearize.x + params.linearize.y * depth
                           : params.linearize.x / (params.linearize.y - depth);
    return far ? 0.0 : z;
}

/* texel: of the image, where the depth lies. */
float view_z_of(float depth, ivec2 texel)
{
    float z = depth;
    if (DEPTH_ENCODING == VKAO_GLSL_DEPTH_PROJECTED) {
        z = view_z_from_projected(depth);
    } else if (DEPTH_ENCODING == VKAO_GLSL_DEPTH_INVERSE_Z) {
        z = 1.0 / depth;
    } else if (DEPTH_ENCODING == VKAO_GLSL_DEPTH_DISTANCE && !ORTHOGRAPHIC) {
        vec2 xy = vec2(texel) * params.image_unproject.xy + params.image_unproject.zw;
        z = depth * inversesqrt(1.0 + dot(xy, xy));
    }
    /* Comparisons with NaN are false, so NaN is background too. */
    return z > VKAO_NEAREST_Z && z < params.far_z ? z : 0.0;
}

float view_z_from_depth(ivec2 texel)
{
    return view_z_of(texelFetch(depth_image, texel, 0).x, texel);
}

#endif
