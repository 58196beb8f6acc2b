/* SPDX-License-Identifier: MIT
 *
 * SSAO of a GPU: groups are near squares, as their lanes share caches; one texel per invocation,
 * into an image. */
#include "bent_code.glsl"
#include "visibility_code.glsl"

layout(local_size_x = VKAO_GROUP_WIDTH, local_size_y = VKAO_GROUP_HEIGHT) in;
layout(binding = VKAO_BINDING_TARGET) uniform writeonly image2D noisy_image;
layout(binding = VKAO_BINDING_BENT_TARGET) uniform writeonly image2D bent_image;

void main()
{
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy) + unpack_texel(here.rect.x);
    if (any(greaterThanEqual(texel, unpack_texel(here.rect.y))))
        return;
    Visibility v = shade(texel);
    imageStore(noisy_image, texel, vec4(encode_visibility(v.open)));
    if (BENT_NORMALS)
        imageStore(bent_image, texel, encode_bent(v.bent));
}
