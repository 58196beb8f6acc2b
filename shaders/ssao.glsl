/* SPDX-License-Identifier: MIT
 *
 * The frame of every SSAO method: one invocation per texel of the rect, background exactly 1. The includer defines
 *     float visibility(ivec2 texel, vec3 position, vec3 normal) */
#ifndef VKAO_SSAO_GLSL_
#define VKAO_SSAO_GLSL_

layout(local_size_x = VKAO_GROUP_WIDTH, local_size_y = VKAO_GROUP_HEIGHT) in;
layout(push_constant) uniform Block { vkao_ssao_block params; };
layout(binding = VKAO_BINDING_NOISY_WRITE) uniform writeonly image2D noisy_image;
#define VKAO_UNPROJECT
#include "view.glsl"
#include "noise.glsl"

float visibility(ivec2 texel, vec3 position, vec3 normal);

/* How far a view z may be off through the precision of the depth that it came from. */
float depth_error(float z)
{
    return z * (params.depth_error.x + params.depth_error.y * z);
}

/* Weight of an occluder at squared distance d2 from the shaded point: what the two ray-traced truths use. */
float falloff_weight(float d2, float radius)
{
    float x = d2 / (radius * radius);
    return params.falloff == VKAO_GLSL_FALLOFF_SMOOTH ? max(0.0, 1.0 - x) : (x <= 1.0 ? 1.0 : 0.0);
}

/* Is the point at height point_height over the tangent plane behind the scene at occluder? Heights are compared, not
 * depths: the depth image knows the scene at texel centres only, and on a tilted wall half a texel sideways moves z,
 * but not the height, which is 0 all over the wall. A wall is open at any tilt that way. */
bool stands_in_front(vec3 occluder, vec3 position, vec3 normal, float point_height)
{
    return dot(normal, occluder - position) > point_height;
}

void main()
{
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy) + unpack_texel(params.rect.x);
    if (any(greaterThanEqual(texel, unpack_texel(params.rect.y))))
        return;
    float z = load_view_z(texel);
    float ao = 1.0;
    if (z > 0.0) {
        vec3 position = view_position(vec2(texel), z);
        ao = visibility(texel, position, view_normal(texel, position));
    }
    imageStore(noisy_image, texel, vec4(ao));
}

#endif
