/* SPDX-License-Identifier: MIT
 *
 * Texels, view space and normals. */
#ifndef VKAO_VIEW_GLSL_
#define VKAO_VIEW_GLSL_

#include "octahedral.glsl"
#include "real.glsl"
#include "settings.glsl"

#include "view_z.glsl"

layout(binding = VKAO_BINDING_NORMALS) uniform texture2D normals_image;

/* A stored direction in its own space, unit length; zero if there is none to trust: none given, not
 * finite, or shorter than 0.5, which is what averaging over an edge leaves. */
vec3 decode_direction(vec3 n, uint encoding)
{
    if (encoding == VKAO_GLSL_NORMALS_XYZ_UNORM || encoding == VKAO_GLSL_NORMALS_OCT_UNORM)
        n = n * 2.0 - 1.0;
    if (encoding >= VKAO_GLSL_NORMALS_OCT_SNORM)
        n = decode_octahedral(n.xy);
    float length2 = dot(n, n);
    return length2 >= 0.25 && length2 < 3.0e38 ? n * inversesqrt(length2) : vec3(0.0);
}

/* texel is the image's, also where the grid is coarser. */
vec3 decode_normal(ivec2 texel)
{
    if (NORMAL_ENCODING == VKAO_GLSL_NORMALS_FROM_DEPTH)
        return vec3(0.0);
    return decode_direction(texelFetch(normals_image, texel, 0).xyz, NORMAL_ENCODING);
}

/* How far a view z may be off through the precision of the depth that it came from. */
real depth_error(real z)
{
    real line = params.depth_error.x + params.depth_error.y * z;
    return ORTHOGRAPHIC ? line : z * line;
}

/* texel may lie between texels; integers are centres. */
vec3 view_position(vec2 texel, float z)
{
    vec2 xy = texel * params.unproject.xy + params.unproject.zw;
    return vec3(ORTHOGRAPHIC ? xy : xy * z, z);
}

vec2 project_to_texel(vec3 position)
{
    vec2 xy = ORTHOGRAPHIC ? position.xy : position.xy / position.z;
    return (xy - params.unproject.zw) / params.unproject.xy;
}

/* Unit vector from the position to the eye. It does not depend on view z: of 1 it is found
 * sooner. */
vec3 direction_to_eye(vec3 position)
{
    return ORTHOGRAPHIC ? vec3(0.0, 0.0, -1.0) : -normalize(position);
}

/* Stored directions to view space. */
vec3 to_view(vec3 stored)
{
    return vec3(dot(params.normal_x.xyz, stored), dot(params.normal_y.xyz, stored),
                dot(params.normal_z.xyz, stored));
}

#endif
