/* SPDX-License-Identifier: MIT
 *
 * blur.comp, vertically, from the ring to the AO image, or at half resolution to the buffer that
 * upsampling reads: VKAO_BLUR_Y_WIDTH columns of VKAO_BLUR_Y_HEIGHT rows per invocation. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_EXT_samplerless_texture_functions : require
#define VKAO_GLSL
#include "layout.h"

layout(local_size_x = VKAO_GROUP_OF(VKAO_BLUR_Y_WIDTH)) in;
layout(push_constant) uniform Block { vkao_strip here; };
#include "settings.glsl"
layout(binding = VKAO_BINDING_Z4, rgba32f) uniform readonly imageBuffer view_z4;
layout(binding = VKAO_BINDING_HALFWAY_READ2, r32ui) uniform readonly uimageBuffer halfway;
layout(binding = VKAO_BINDING_RING_NORMALS_READ4, rgba32ui) uniform readonly uimageBuffer normals;
layout(binding = VKAO_BINDING_BLURRED_WORDS) writeonly buffer Blurred { uvec2 blurred_ao[]; };
#include "view.glsl"
#define VKAO_BLUR_COUNT VKAO_BLUR_Y_HEIGHT
#define VKAO_BLUR_REACH (RADIUS + MARGIN)
#include "blur_window.glsl"
#include "staged.glsl"

vec4 load_z(ivec2 texel)
{
    int low = int(params.valid.x >> 16), high = int(params.valid.y >> 16);
    vec4 z = imageLoad(view_z4, (z_row(clamp(texel.y, low - 1, high)) + texel.x) >> 2);
    return mix(vec4(BACKGROUND_Z), z, greaterThan(z, vec4(0.0)));
}

/* Relative to what is open. */
vec4 load_codes(ivec2 texel)
{
    int at = place_of(texel) >> 1;
    ivec2 word = ivec2(imageLoad(halfway, at).x, imageLoad(halfway, at + 1).x);
    return vec4(
        ivec4(word.x & 0xffff, (word.x >> 16) & 0xffff, word.y & 0xffff, (word.y >> 16) & 0xffff) -
        VKAO_CODE_OPEN);
}

/* Four texels of a row. */
void put(ivec2 texel, vec4 z, vec4 fine)
{
    if (GRID_SHIFT > 0u) {
        ivec4 v = ivec4(fine + (float(VKAO_CODE_OPEN) + 0.5));
        if (texel.y < int(here.rect.y >> 16))
            blurred_ao[(buffer_row(texel.y) + texel.x) >> 2] = uvec2(v.xz | v.yw << 16);
        return;
    }
    put_ao(texel, fine * (1.0 / (VKAO_CODE_SCALE * VKAO_CODE_FINE)) + 1.0,
           greaterThanEqual(z, vec4(BACKGROUND_Z)));
}

/* Columns come one after the other: side by side they take four times the registers. */
void blur(ivec2 texel)
{
    vec4 z[WINDOW], fine[WINDOW], blurred[VKAO_BLUR_Y_HEIGHT];
    uvec4 words[WINDOW];
    [[unroll]] for (int j = 0; j < WINDOW; ++j) {
        ivec2 at = texel + ivec2(0, j - REACH);
        bool counts = j >= MARGIN && j < WINDOW - MARGIN;
        z[j] = load_z(at);
        fine[j] = counts ? load_codes(at) : vec4(0.0);
        words[j] = USES_NORMALS && counts ? imageLoad(normals, place_of(at) >> 2) : uvec4(0u);
    }
    [[unroll]] for (int i = 0; i < VKAO_BLUR_Y_WIDTH; ++i) {
        float column_z[WINDOW], column[WINDOW], result[VKAO_BLUR_Y_HEIGHT];
        vec4 normal[WINDOW];
        [[unroll]] for (int j = 0; j < WINDOW; ++j) {
            column_z[j] = z[j][i];
            column[j] = fine[j][i];
            normal[j] = USES_NORMALS ? unpack_normal(words[j][i]) : vec4(0.0);
        }
        blur(column_z, column, normal, params.unproject.y, result);
        [[unroll]] for (int row = 0; row < VKAO_BLUR_Y_HEIGHT; ++row)
            blurred[row][i] = result[row];
    }
    [[unroll]] for (int row = 0; row < VKAO_BLUR_Y_HEIGHT; ++row)
        put(texel + ivec2(0, row), z[REACH + row], blurred[row]);
}

void main()
{
    ivec2 low = unpack_texel(here.rect.x), high = unpack_texel(here.rect.y);
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy) * ivec2(VKAO_BLUR_Y_WIDTH, VKAO_BLUR_Y_HEIGHT);
    texel += ivec2(round_down(low.x, VKAO_BLUR_Y_WIDTH), low.y);
    if (any(greaterThanEqual(texel, high)))
        return;
    blur(texel);
}
