/* SPDX-License-Identifier: MIT
 *
 * Stored normals of the rows that the blur looks at, decoded once: into the ring, where rows and
 * columns read them. 4 texels of a row per invocation. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_EXT_samplerless_texture_functions : require
#define VKAO_GLSL
#include "layout.h"

layout(local_size_x = VKAO_GROUP_OF(4)) in;
layout(push_constant) uniform Block { vkao_strip here; };
#include "settings.glsl"
layout(binding = VKAO_BINDING_RING_NORMALS_WORDS) writeonly buffer Normals { uvec4 normals[]; };
#include "view.glsl"
#include "ring_texels.glsl"
#include "surface.glsl"

void main()
{
    ivec2 low = unpack_texel(here.rect.x), high = unpack_texel(here.rect.y);
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy) * ivec2(4, 1) + ivec2(low.x & ~3, low.y);
    if (any(greaterThanEqual(texel, high)))
        return;
    uvec4 words;
    /* Within the image: a word may reach beyond. */
    int last = int(params.valid.y & 0xffffu) - 1;
    [[unroll]] for (int i = 0; i < 4; ++i)
        words[i] = pack_normal(stored_normal(ivec2(min(texel.x + i, last), texel.y) << GRID_SHIFT));
    normals[place_of(texel) >> 2] = words;
}
