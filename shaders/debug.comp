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
layout(push_constant) uniform Block { vkao_composite_block params; };
layout(binding = VKAO_BINDING_NOISY_READ) uniform texture2D noisy_image;
layout(binding = VKAO_BINDING_BENT_READ) uniform texture2D bent_image;
layout(binding = VKAO_BINDING_OUTPUT) uniform writeonly image2D output_image;
#define VKAO_UNPROJECT
#include "view.glsl"
#include "normals.glsl"
#ifdef VKAO_BUFFERS
layout(binding = VKAO_BINDING_PACKED_READ4, r32ui) uniform readonly uimageBuffer packed_ao;
#endif

float noisy_ao(ivec2 texel)
{
#ifdef VKAO_BUFFERS
    if (flag(VKAO_FLAG_PACKED)) {
        int i = buffer_row(texel.y) + texel.x;
        return float((imageLoad(packed_ao, i >> 2).x >> ((i & 3) << 3)) & 255u) / VKAO_CODE_SCALE - VKAO_CODE_OFFSET;
    }
#endif
    return texelFetch(noisy_image, texel, 0).x;
}

vec4 debug_view(ivec2 texel)
{
    ivec2 at = texel >> grid_shift();
    float z = load_view_z(at);
    if (params.mode == VKAO_GLSL_COMPOSITE_VIEW_Z)
        return vec4(vec3(min(z / params.normal_x.w, 65504.0)), 1.0); /* what a 16-bit float holds */
    if (params.mode == VKAO_GLSL_COMPOSITE_NOISY_AO)
        return vec4(vec3(z > 0.0 ? noisy_ao(at) : 1.0), 1.0);
    vec3 n = vec3(0.0);
    if (z > 0.0 && params.mode == VKAO_GLSL_COMPOSITE_NORMALS)
        n = lane3(view_normals(at, view_positions(at, real(z))), 0);
    if (params.mode == VKAO_GLSL_COMPOSITE_BENT_NORMALS)
        n = to_view(decode_direction(texelFetch(bent_image, texel, 0).xyz, bent_encoding()));
    n.z = -n.z; /* towards the eye is what pictures of normals show as blue */
    return vec4(clamp(n * 0.5 + 0.5, 0.0, 1.0), 1.0);
}

void main()
{
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy) + unpack_texel(params.rect.x);
    if (any(greaterThanEqual(texel, unpack_texel(params.rect.y))))
        return;
    imageStore(output_image, texel, debug_view(texel));
}
