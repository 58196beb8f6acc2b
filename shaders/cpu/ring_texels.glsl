/* SPDX-License-Identifier: MIT
 *
 * What rows of the ring hold. */
#ifndef VKAO_RING_TEXELS_GLSL_
#define VKAO_RING_TEXELS_GLSL_

#include "ring.glsl"

/* Where the ring holds a texel. */
int place_of(ivec2 texel)
{
    return ring_row(texel.y) * VKAO_STRIDE + VKAO_BUFFER_PAD + texel.x;
}

/* A stored normal as rows of the ring have it: 10 bits of each coordinate, and one if there is none
 * to trust. */
uint pack_normal(vec4 normal)
{
    uvec3 fields = uvec3(normal.xyz * 511.0 + 512.5);
    return fields.x | fields.y << 10 | fields.z << 20 | (normal.w > 0.0 ? 1u << 31 : 0u);
}

vec4 unpack_normal(uint word)
{
    vec3 fields = vec3(ivec3(word, word >> 10, word >> 20) & 1023);
    return vec4(fields * (1.0 / 511.0) - 512.0 / 511.0, float(word >> 31));
}

#endif
