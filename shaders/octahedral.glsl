/* SPDX-License-Identifier: MIT
 *
 * Directions as two numbers from -1 to 1: the octahedron of unit size, unfolded (Cigolle et al.,
 * 'A Survey of Efficient Representations for Independent Unit Vectors', JCGT 3(2), 2014). */
#ifndef VKAO_OCTAHEDRAL_GLSL_
#define VKAO_OCTAHEDRAL_GLSL_

/* The zero vector has no code: it becomes that of +z. */
vec2 encode_octahedral(vec3 n)
{
    vec2 e = n.xy / max(abs(n.x) + abs(n.y) + abs(n.z), 1.0e-30);
    vec2 side = vec2(e.x >= 0.0 ? 1.0 : -1.0, e.y >= 0.0 ? 1.0 : -1.0);
    return n.z >= 0.0 ? e : (1.0 - abs(e.yx)) * side;
}

/* Not of unit length: |x| + |y| + |z| is 1. */
vec3 decode_octahedral(vec2 e)
{
    vec3 n = vec3(e, 1.0 - abs(e.x) - abs(e.y));
    float fold = max(-n.z, 0.0);
    n.x += n.x >= 0.0 ? -fold : fold;
    n.y += n.y >= 0.0 ? -fold : fold;
    return n;
}

#endif
