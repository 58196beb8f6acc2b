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

layout(local_size_x = VKAO_GROUP_WIDTH, local_size_y = VKAO_GROUP_HEIGHT) in;
layout(push_constant) uniform Block { vkao_strip here; };
#include "settings.glsl"
layout(binding = VKAO_BINDING_Z4, rgba32f) uniform readonly imageBuffer view_z4;
layout(binding = VKAO_BINDING_PACKED_READ4, r32ui) uniform readonly uimageBuffer packed_ao;
layout(binding = VKAO_BINDING_RING_NORMALS_READ4, rgba32ui) uniform readonly uimageBuffer normals;
layout(binding = VKAO_BINDING_HALFWAY_WORDS) writeonly buffer Halfway { uint halfway[]; };
#include "view.glsl"
#include "blur_window.glsl"

const int REACH = (RADIUS + MARGIN + 3) & ~3; /* windows begin and end at whole words */
const int WINDOW = VKAO_BLUR_X_WIDTH + 2 * REACH;

void blur(ivec2 texel, out float result[VKAO_BLUR_X_WIDTH])
{
    float z[WINDOW], code[WINDOW], slope[WINDOW];
    vec4 normal[WINDOW];
    bool use_normals = NORMAL_POWER > 0.0;
    int z_word = (z_row(texel.y) + texel.x - REACH) >> 2,
        code_word = (buffer_row(texel.y) + texel.x - REACH) >> 2,
        normal_word = (place_of(texel) - REACH) >> 2;
    [[unroll]] for (int j = 0; j < WINDOW / 4; ++j) {
        vec4 z4 = imageLoad(view_z4, z_word + j);
        int word = int(imageLoad(packed_ao, code_word + j).x);
        uvec4 normals4 = use_normals ? imageLoad(normals, normal_word + j) : uvec4(0u);
        [[unroll]] for (int i = 0; i < 4; ++i) {
            z[4 * j + i] = surface_z(z4[i]);
            code[4 * j + i] = float((word >> (8 * i)) & 255);
            if (use_normals)
                normal[4 * j + i] = unpack_normal(normals4[i]);
        }
    }
    /* Those that nothing uses cost nothing. */
    [[unroll]] for (int i = 1; i < WINDOW - 1; ++i)
        slope[i] = local_slope(z[i - 1], z[i], z[i + 1]);
    [[unroll]] for (int i = 0; i < VKAO_BLUR_X_WIDTH; ++i) {
        int c = REACH + i;
        float edge = edge_stop(z[c], params.sharpness, params.reference_z);
        float sum = code[c], weights = 1.0, near = 0.0, all = 0.0, all_weights = 0.0;
        [[unroll]] for (int k = -RADIUS; k <= RADIUS; ++k) {
            if (k == 0)
                continue;
            float off = off_surface(z[c], slope[c], z[c + k], slope[c + k], float(k));
            float full = blur_weight(k, RADIUS), w = full * max(0.0, 1.0 - edge * off);
            if (use_normals) {
                near += w;
                w *= normal_weight(normal[c], normal[c + k], NORMAL_POWER);
            }
            sum += w * code[c + k];
            weights += w;
            full *= is_surface(z[c + k]);
            all += full * code[c + k];
            all_weights += full;
        }
        float leak = leak_of(use_normals ? near : weights - 1.0, weights - 1.0, RADIUS);
        result[i] = (sum + leak * all) / (weights + leak * all_weights);
    }
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
