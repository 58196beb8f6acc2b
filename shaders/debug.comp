/* SPDX-License-Identifier: MIT
 *
 * What the stages saw, at their own resolution, as pictures: the composite modes to debug with. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#extension GL_EXT_control_flow_attributes : require
#define VKAO_GLSL
#include "params.h"

layout(local_size_x = VKAO_GROUP_WIDTH, local_size_y = VKAO_GROUP_HEIGHT) in;
layout(push_constant) uniform Block { vkao_dispatch here; };
#include "settings.glsl"
layout(binding = VKAO_BINDING_BENT_READ) uniform texture2D bent_image;
layout(binding = VKAO_BINDING_OUTPUT) uniform writeonly image2D output_image;
#include "view.glsl"
#include "normals.glsl"
#include "noisy.glsl"

vec4 debug_view(ivec2 texel)
{
    ivec2 at = texel >> GRID_SHIFT;
    float z = load_view_z(at);
    if (COMPOSITE_MODE == VKAO_GLSL_COMPOSITE_VIEW_Z)
        /* what a 16-bit float holds */
        return vec4(vec3(min(z / params.debug_distance, 65504.0)), 1.0);
    if (COMPOSITE_MODE == VKAO_GLSL_COMPOSITE_NOISY_AO)
        return vec4(vec3(z > 0.0 ? noisy_ao(at) : 1.0), 1.0);
    vec3 n = vec3(0.0);
    if (z > 0.0 && COMPOSITE_MODE == VKAO_GLSL_COMPOSITE_NORMALS)
        n = view_normal(at, view_position(vec2(at), z));
    if (COMPOSITE_MODE == VKAO_GLSL_COMPOSITE_BENT_NORMALS)
        n = to_view(decode_direction(texelFetch(bent_image, texel, 0).xyz, BENT_ENCODING));
    n.z = -n.z; /* towards the eye is what pictures of normals show as blue */
    return vec4(clamp(n * 0.5 + 0.5, 0.0, 1.0), 1.0);
}

void main()
{
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy) + unpack_texel(here.rect.x);
    if (any(greaterThanEqual(texel, unpack_texel(here.rect.y))))
        return;
    imageStore(output_image, texel, debug_view(texel));
}
