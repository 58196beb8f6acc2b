/* SPDX-License-Identifier: MIT
 *
 * Bent normals on their way to the blur, as what an image of four bytes holds: two octahedral
 * coordinates of 11 bits, which have the axes exactly, and 10 bits of length, as the blur weighs by
 * it. That is |x| + |y| + |z|, which is 1 of what octahedral coordinates stand for. */
#ifndef VKAO_BENT_CODE_GLSL_
#define VKAO_BENT_CODE_GLSL_

#include "octahedral.glsl"

/* One slice sees up to twice the share of the hemisphere that is its own. */
const float LONGEST = 3.0;

vec4 encode_bent(vec3 v)
{
    uvec2 e = uvec2(encode_octahedral(v) * 1023.0 + 1023.5);
    uint length = uint(min(dot(abs(v), vec3(1023.0 / LONGEST)), 1023.0) + 0.5);
    return unpackUnorm4x8(e.x | e.y << 11 | length << 22);
}

vec3 decode_bent(vec4 stored)
{
    uint code = packUnorm4x8(stored);
    vec2 e = vec2(code & 0x7ffu, code >> 11 & 0x7ffu) / 1023.0 - 1.0;
    return decode_octahedral(e) * (float(code >> 22) * (LONGEST / 1023.0));
}

#endif
