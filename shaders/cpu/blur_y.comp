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

layout(local_size_x = VKAO_GROUP_WIDTH, local_size_y = VKAO_GROUP_HEIGHT) in;
layout(push_constant) uniform Block { vkao_strip here; };
#include "settings.glsl"
layout(binding = VKAO_BINDING_Z4, rgba32f) uniform readonly imageBuffer view_z4;
layout(binding = VKAO_BINDING_HALFWAY_READ2, r32ui) uniform readonly uimageBuffer halfway;
layout(binding = VKAO_BINDING_RING_NORMALS_READ4, rgba32ui) uniform readonly uimageBuffer normals;
layout(binding = VKAO_BINDING_BLURRED_WORDS) writeonly buffer Blurred { uvec2 blurred_ao[]; };
#include "view.glsl"
#include "blur_window.glsl"
#include "staged.glsl"

const int WINDOW = VKAO_BLUR_Y_HEIGHT + 2 * (RADIUS + MARGIN);

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

vec4 slopes(vec4 before, vec4 z, vec4 after)
{
    vec4 slope;
    [[unroll]] for (int i = 0; i < VKAO_BLUR_Y_WIDTH; ++i)
        slope[i] = local_slope(before[i], z[i], after[i]);
    return slope;
}

vec4 tap_weights(int k, int radius, vec4 z, vec4 slope, vec4 tap_z, vec4 tap_slope)
{
    vec4 w;
    [[unroll]] for (int i = 0; i < VKAO_BLUR_Y_WIDTH; ++i) {
        float edge = edge_stop(z[i], params.sharpness, params.reference_z);
        float off = off_surface(z[i], slope[i], tap_z[i], tap_slope[i], float(k));
        w[i] = blur_weight(k, radius) * max(0.0, 1.0 - edge * off);
    }
    return w;
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

void blur(ivec2 texel)
{
    vec4 z[WINDOW], slope[WINDOW], fine[WINDOW], normal[WINDOW * VKAO_BLUR_Y_WIDTH];
    bool use_normals = NORMAL_POWER > 0.0;
    [[unroll]] for (int j = 0; j < WINDOW; ++j) {
        ivec2 at = texel + ivec2(0, j - RADIUS - MARGIN);
        z[j] = load_z(at);
        if (j >= MARGIN && j < WINDOW - MARGIN)
            fine[j] = load_codes(at);
        if (use_normals && j >= MARGIN && j < WINDOW - MARGIN) {
            uvec4 words = imageLoad(normals, place_of(at) >> 2);
            [[unroll]] for (int i = 0; i < VKAO_BLUR_Y_WIDTH; ++i)
                normal[VKAO_BLUR_Y_WIDTH * j + i] = unpack_normal(words[i]);
        }
    }
    /* Those that nothing uses cost nothing. */
    [[unroll]] for (int j = 1; j < WINDOW - 1; ++j)
        slope[j] = slopes(z[j - 1], z[j], z[j + 1]);
    [[unroll]] for (int row = 0; row < VKAO_BLUR_Y_HEIGHT; ++row) {
        int c = RADIUS + MARGIN + row;
        vec4 sum = fine[c], weights = vec4(1.0);
        vec4 near = vec4(0.0), all = vec4(0.0), all_weights = vec4(0.0);
        [[unroll]] for (int k = -RADIUS; k <= RADIUS; ++k) {
            if (k == 0)
                continue;
            vec4 w = tap_weights(k, RADIUS, z[c], slope[c], z[c + k], slope[c + k]);
            if (use_normals)
                near += w;
            [[unroll]] for (int i = 0; i < VKAO_BLUR_Y_WIDTH; ++i) if (use_normals) w[i] *=
                normal_weight(normal[VKAO_BLUR_Y_WIDTH * c + i],
                              normal[VKAO_BLUR_Y_WIDTH * (c + k) + i], NORMAL_POWER);
            sum += w * fine[c + k];
            weights += w;
            vec4 full;
            [[unroll]] for (int i = 0; i < VKAO_BLUR_Y_WIDTH; ++i) full[i] =
                blur_weight(k, RADIUS) * is_surface(z[c + k][i]);
            all += full * fine[c + k];
            all_weights += full;
        }
        vec4 leak;
        [[unroll]] for (int i = 0; i < VKAO_BLUR_Y_WIDTH; ++i) leak[i] =
            leak_of(use_normals ? near[i] : weights[i] - 1.0, weights[i] - 1.0, RADIUS);
        put(texel + ivec2(0, row), z[c], (sum + leak * all) / (weights + leak * all_weights));
    }
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
