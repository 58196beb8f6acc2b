/* SPDX-License-Identifier: MIT
 *
 * upsample.comp for AO in buffers: VKAO_UPSAMPLE_WIDTH by VKAO_UPSAMPLE_HEIGHT texels of the image
 * at once. A texel of an even column and row is one of half resolution; the others lie between two
 * or four of them. Their weights are those of the blur; where no neighbour lies on the texel's
 * surface, the least wrong ones decide. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_EXT_samplerless_texture_functions : require
#define VKAO_GLSL
#include "layout.h"

layout(local_size_x = VKAO_GROUP_WIDTH, local_size_y = VKAO_GROUP_HEIGHT) in;
layout(push_constant) uniform Block { vkao_dispatch here; };
#include "settings.glsl"
layout(binding = VKAO_BINDING_Z4, rgba32f) uniform readonly imageBuffer view_z4;
layout(binding = VKAO_BINDING_BLURRED_READ2, r32ui) uniform readonly uimageBuffer blurred_ao;
#include "view.glsl"
#include "depth.glsl"
#include "staged.glsl"
#include "surface.glsl"

/* One more of each than there are columns, so that the last odd one has a neighbour. */
const int COLUMNS = VKAO_UPSAMPLE_WIDTH + 1;
const int HALF_COLUMNS = VKAO_UPSAMPLE_WIDTH / 2 + 1;

/* Relative to what is open. */
vec4 unpack_codes(uvec2 words)
{
    ivec2 w = ivec2(words);
    return vec4(ivec4(w.x & 0xffff, (w.x >> 16) & 0xffff, w.y & 0xffff, (w.y >> 16) & 0xffff) -
                VKAO_CODE_OPEN);
}

/* Of half-resolution row y: view z and AO in a window that begins at x, a multiple of 4. */
void load_half_row(ivec2 texel, out float z[HALF_COLUMNS], out float fine[HALF_COLUMNS])
{
    int y = clamp(texel.y, int(params.valid.x >> 16) - 1, int(params.valid.y >> 16));
    int z_word = (z_row(y) + texel.x) >> 2;
    int code_word = (buffer_row(min(y, int(params.valid.y >> 16) - 1)) + texel.x) >> 1;
    vec4 z4 = imageLoad(view_z4, z_word);
    vec4 codes = unpack_codes(
        uvec2(imageLoad(blurred_ao, code_word).x, imageLoad(blurred_ao, code_word + 1).x));
    [[unroll]] for (int i = 0; i < HALF_COLUMNS - 1; ++i) {
        z[i] = surface_z(z4[i]);
        fine[i] = codes[i];
    }
    z[HALF_COLUMNS - 1] = surface_z(fetch_view_z(ivec2(texel.x + HALF_COLUMNS - 1, y)));
    fine[HALF_COLUMNS - 1] =
        float((int(imageLoad(blurred_ao, code_word + 2).x) & 0xffff) - VKAO_CODE_OPEN);
}

float full_z(ivec2 texel)
{
    ivec2 low = unpack_texel(params.image_valid.x), high = unpack_texel(params.image_valid.y);
    ivec2 inside = clamp(texel, low, high - 1);
    float z = view_z_from_depth(inside);
    return inside == texel ? surface_z(z) : BACKGROUND_Z;
}

vec4 full_normal(ivec2 texel)
{
    ivec2 low = unpack_texel(params.image_valid.x), high = unpack_texel(params.image_valid.y);
    return stored_normal(clamp(texel, low, high - 1));
}

struct Mean {
    float sum, weights;
};

/* off: how far the neighbour lies off the texel's surface. */
void add(inout Mean mean, float off, float normals, float fine)
{
    /* The second term is far below any honest weight: it decides only if there is none. */
    float w = max(0.0, 1.0 - off) * normals + 1.0e-6 / (1.0 + off * off);
    mean.sum += w * fine;
    mean.weights += w;
}

/* One of the neighbours at (+-dx, +-dy) of a texel. */
struct Neighbour {
    float z, fine;
    vec4 normal;
};

float blend(int dx, int dy, float z, vec4 normal, vec2 slope, Neighbour n[4])
{
    float edge = edge_stop(z, params.sharpness, params.reference_z);
    Mean mean = Mean(0.0, 0.0);
    [[unroll]] for (int i = 0; i < 4; ++i) {
        vec2 side = vec2((i & 1) * 2 - 1, (i >> 1) * 2 - 1) * vec2(dx, dy);
        if ((dx == 0 && (i & 1) == 1) || (dy == 0 && i >= 2))
            continue;
        float off = edge * abs(n[i].z - z - dot(slope, side));
        float w = 1.0;
        if (NORMAL_POWER > 0.0)
            w = normal_weight(normal, n[i].normal, NORMAL_POWER);
        add(mean, off, w, n[i].fine);
    }
    /* A lone texel before the sky is open. */
    return mean.weights > 0.0 ? mean.sum / mean.weights : 0.0;
}

/* A row of the window. */
void put(ivec2 texel, float z[VKAO_UPSAMPLE_WIDTH], float fine[VKAO_UPSAMPLE_WIDTH])
{
    [[unroll]] for (int i = 0; i < VKAO_UPSAMPLE_WIDTH; i += 4) {
        vec4 v = vec4(fine[i], fine[i + 1], fine[i + 2], fine[i + 3]);
        vec4 depths = vec4(z[i], z[i + 1], z[i + 2], z[i + 3]);
        put_ao(texel + ivec2(i, 0), v * (1.0 / (VKAO_CODE_SCALE * VKAO_CODE_FINE)) + 1.0,
               greaterThanEqual(depths, vec4(BACKGROUND_Z)));
    }
}

void main()
{
    ivec2 low = unpack_texel(here.rect.x), high = unpack_texel(here.rect.y);
    ivec2 texel =
        ivec2(gl_GlobalInvocationID.xy) * ivec2(VKAO_UPSAMPLE_WIDTH, VKAO_UPSAMPLE_HEIGHT);
    texel += ivec2(round_down(low.x, VKAO_UPSAMPLE_WIDTH), round_down(low.y, VKAO_UPSAMPLE_HEIGHT));
    if (any(greaterThanEqual(texel, high)))
        return;
    /* Half-resolution rows above and below, the two rows of the image and the one below them, which
     * is half's again. */
    float half_z[2][HALF_COLUMNS], fine[2][HALF_COLUMNS], z[3][COLUMNS];
    vec4 normal[3][COLUMNS];
    load_half_row(texel >> 1, half_z[0], fine[0]);
    load_half_row((texel >> 1) + ivec2(0, 1), half_z[1], fine[1]);
    [[unroll]] for (int i = 0; i < COLUMNS; ++i) {
        [[unroll]] for (int row = 0; row < 3; ++row) {
            bool is_half = (i & 1) == 0 && row != 1;
            z[row][i] = is_half ? half_z[row / 2][i / 2] : full_z(texel + ivec2(i, row));
            normal[row][i] = NORMAL_POWER > 0.0 ? full_normal(texel + ivec2(i, row)) : vec4(0.0);
        }
    }
    float row_z[2][VKAO_UPSAMPLE_WIDTH], row[2][VKAO_UPSAMPLE_WIDTH];
    [[unroll]] for (int i = 0; i < VKAO_UPSAMPLE_WIDTH; ++i) {
        bool even = (i & 1) == 0;
        int left = even ? i : i - 1, right = even ? i : i + 1;
        Neighbour n[4];
        [[unroll]] for (int k = 0; k < 4; ++k) {
            int column = (k & 1) == 0 ? left : right;
            n[k] = Neighbour(half_z[k >> 1][column / 2], fine[k >> 1][column / 2],
                             normal[(k >> 1) * 2][column]);
        }
        vec2 slope = vec2(0.0, local_slope(z[0][i], z[1][i], z[2][i]));
        if (even) {
            row[0][i] = fine[0][i / 2];
            row[1][i] = blend(0, 1, z[1][i], normal[1][i], slope, n);
        } else {
            slope.x = local_slope(z[1][i - 1], z[1][i], z[1][i + 1]);
            vec2 across = vec2(local_slope(z[0][i - 1], z[0][i], z[0][i + 1]), 0.0);
            row[0][i] = blend(1, 0, z[0][i], normal[0][i], across, n);
            row[1][i] = blend(1, 1, z[1][i], normal[1][i], slope, n);
        }
        row_z[0][i] = z[0][i];
        row_z[1][i] = z[1][i];
    }
    put(texel, row_z[0], row[0]);
    put(texel + ivec2(0, 1), row_z[1], row[1]);
}
