/* SPDX-License-Identifier: MIT
 *
 * AO onto colour. Linear light throughout; alpha is passed on. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#define VKAO_GLSL
#include "params.h"

layout(local_size_x = VKAO_GROUP_WIDTH, local_size_y = VKAO_GROUP_HEIGHT) in;
layout(push_constant) uniform Block { vkao_composite_block params; };
layout(binding = VKAO_BINDING_AO_READ) uniform texture2D ao_image;
layout(binding = VKAO_BINDING_COLOR) uniform texture2D color_image;
layout(binding = VKAO_BINDING_DIRECT) uniform texture2D direct_image;
layout(binding = VKAO_BINDING_OUTPUT) uniform writeonly image2D output_image;

void main()
{
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy) + ivec2(params.rect.x & 0xffffu, params.rect.x >> 16);
    if (texel.x >= int(params.rect.y & 0xffffu) || texel.y >= int(params.rect.y >> 16))
        return;
    float ao = mix(1.0, texelFetch(ao_image, texel, 0).x, params.tint.w);
    vec3 factor = mix(params.tint.rgb, vec3(1.0), ao);
    vec4 result = vec4(factor, 1.0);
    if (params.mode != VKAO_GLSL_COMPOSITE_AO_ONLY) {
        vec4 color = texelFetch(color_image, texel, 0);
        result = vec4(color.rgb * factor, color.a);
    }
    if (params.mode == VKAO_GLSL_COMPOSITE_INDIRECT)
        result.rgb += texelFetch(direct_image, texel, 0).rgb;
    imageStore(output_image, texel, result);
}
