/* SPDX-License-Identifier: MIT
 *
 * SSAO of a GPU: one texel per invocation, into an image. A group has its texels block by block of
 * columns (see columns.glsl), so that invocations side by side read what lies side by side. */
#include "bent_code.glsl"
#include "visibility_code.glsl"

layout(local_size_x = VKAO_GROUP_WIDTH, local_size_y = VKAO_GROUP_HEIGHT) in;
layout(binding = VKAO_BINDING_TARGET) uniform writeonly image2D noisy_image;
layout(binding = VKAO_BINDING_BENT_TARGET) uniform writeonly image2D bent_image;

void main()
{
    uvec2 in_group = gl_LocalInvocationID.xy;
    uint block = in_group.y / VKAO_SSAO_GROUP_HEIGHT, row = in_group.y % VKAO_SSAO_GROUP_HEIGHT;
    uvec2 origin = gl_WorkGroupID.xy * uvec2(VKAO_SSAO_GROUP_WIDTH, VKAO_SSAO_GROUP_HEIGHT);
    origin += uvec2(in_group.x * BLOCKS + block, row);
    ivec2 texel = unpack_texel(here.rect.x) + ivec2(origin);
    if (any(greaterThanEqual(texel, unpack_texel(here.rect.y))))
        return;
    Visibility v = shade(texel);
    imageStore(noisy_image, texel, vec4(encode_visibility(v.open)));
    if (BENT_NORMALS)
        imageStore(bent_image, texel, encode_bent(v.bent));
}
