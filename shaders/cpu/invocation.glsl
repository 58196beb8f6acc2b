/* SPDX-License-Identifier: MIT
 *
 * SSAO of a CPU for methods that shade a texel at a time: of a tile from the list, as a code into
 * the buffer or as a texel into an image. */
layout(local_size_x = VKAO_ROW_GROUP_WIDTH) in;
#define VKAO_CODES 1
#include "codes.glsl"
#include "noisy_images.glsl"

void main()
{
    ivec2 texel = tile_texel() + ivec2(gl_LocalInvocationID.x, gl_WorkGroupID.x);
    Visibility v = shade(texel);
    if (any(greaterThanEqual(texel, unpack_texel(here.rect.y))))
        return;
    if ((PATH & VKAO_PATH_PACKED) != 0u)
        store_codes(texel, code_of(v.open));
    else if (in_rect(texel, here.rect))
        store_images(texel, v.bent, v.open);
}
