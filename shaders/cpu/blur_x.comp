/* SPDX-License-Identifier: MIT
 *
 * blur.comp, horizontally, from packed noisy AO to the ring: VKAO_BLUR_X_WIDTH texels of a row per
 * invocation, from one window of them and their neighbours. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_EXT_samplerless_texture_functions : require
#define VKAO_GLSL
#include "layout.h"

layout(local_size_x = VKAO_GROUP_OF(VKAO_BLUR_X_WIDTH)) in;
layout(push_constant) uniform Block { vkao_strip here; };
#include "settings.glsl"
layout(binding = VKAO_BINDING_Z4, rgba32f) uniform readonly imageBuffer view_z4;
layout(binding = VKAO_BINDING_PACKED_READ4, r32ui) uniform readonly uimageBuffer packed_ao;
layout(binding = VKAO_BINDING_RING_NORMALS_READ4, rgba32ui) uniform readonly uimageBuffer normals;
layout(binding = VKAO_BINDING_HALFWAY_WORDS) writeonly buffer Halfway { uint halfway[]; };
#include "view.glsl"
#define VKAO_BLUR_COUNT VKAO_BLUR_X_WIDTH
/* windows begin and end at whole words */
#define VKAO_BLUR_REACH ((RADIUS + MARGIN + 3) & ~3)
#include "blur_window.glsl"

void blur(ivec2 texel, out float result[VKAO_BLUR_X_WIDTH])
{
    float z[WINDOW], code[WINDOW];
    vec4 normal[WINDOW];
    int z_word = (z_row(texel.y) + texel.x - REACH) >> 2,
        code_word = (buffer_row(texel.y) + texel.x - REACH) >> 2,
        normal_word = (place_of(texel) - REACH) >> 2;
    [[unroll]] for (int j = 0; j < WINDOW / 4; ++j) {
        vec4 z4 = imageLoad(view_z4, z_word + j);
        int word = int(imageLoad(packed_ao, code_word + j).x);
        uvec4 normals4 = USES_NORMALS ? imageLoad(normals, normal_word + j) : uvec4(0u);
        [[unroll]] for (int i = 0; i < 4; ++i) {
            z[4 * j + i] = surface_z(z4[i]);
            code[4 * j + i] = float((word >> (8 * i)) & 255);
            normal[4 * j + i] = USES_NORMALS ? unpack_normal(normals4[i]) : vec4(0.0);
        }
    }
    blur(z, code, normal, params.unproject.x, result);
}

void main()
{
    ivec2 low = unpack_texel(here.rect.x), high = unpack_texel(here.rect.y);
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy) * ivec2(VKAO_BLUR_X_WIDTH, 1);
    texel += ivec2(round_down(low.x, VKAO_BLUR_X_WIDTH), low.y);
    if (any(greaterThanEqual(texel, high)))
        return;
    float result[VKAO_BLUR_X_WIDTH];
    blur(texel, result);
    int word = place_of(texel) >> 1;
    [[unroll]] for (int i = 0; i < VKAO_BLUR_X_WIDTH / 2; ++i) {
        ivec2 fine = ivec2(vec2(result[2 * i], result[2 * i + 1]) * VKAO_CODE_FINE + 0.5);
        halfway[word + i] = uint(fine.x | fine.y << 16);
    }
}
