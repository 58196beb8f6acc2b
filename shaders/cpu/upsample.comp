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

layout(local_size_x = VKAO_GROUP_OF(VKAO_UPSAMPLE_WIDTH)) in;
layout(push_constant) uniform Block { vkao_dispatch here; };
#include "settings.glsl"
layout(binding = VKAO_BINDING_Z4, rgba32f) uniform readonly imageBuffer view_z4;
layout(binding = VKAO_BINDING_BLURRED_READ2, r32ui) uniform readonly uimageBuffer blurred_ao;
#include "view.glsl"
#include "depths.glsl"
#include "staged.glsl"
#include "surface.glsl"

/* One more than is written, so that the last odd column and row have a neighbour. */
const int COLUMNS = VKAO_UPSAMPLE_WIDTH + 1, ROWS = VKAO_UPSAMPLE_HEIGHT + 1;
const int HALF_COLUMNS = VKAO_UPSAMPLE_WIDTH / 2 + 1, HALF_ROWS = VKAO_UPSAMPLE_HEIGHT / 2 + 1;

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

/* Of a texel of the image; outside of what is valid it is background. */
float full_z(ivec2 texel, float depth)
{
    ivec2 low = unpack_texel(params.image_valid.x), high = unpack_texel(params.image_valid.y);
    float z = view_z_of(depth, texel);
    return texel == clamp(texel, low, high - 1) ? surface_z(z) : BACKGROUND_Z;
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
void put(ivec2 texel, float z[COLUMNS], float fine[VKAO_UPSAMPLE_WIDTH])
{
    [[unroll]] for (int i = 0; i < VKAO_UPSAMPLE_WIDTH; i += 4) {
        vec4 v = vec4(fine[i], fine[i + 1], fine[i + 2], fine[i + 3]);
        vec4 depths = vec4(z[i], z[i + 1], z[i + 2], z[i + 3]);
        put_ao(texel + ivec2(i, 0), v * (1.0 / (VKAO_CODE_SCALE * VKAO_CODE_FINE)) + 1.0,
               greaterThanEqual(depths, vec4(BACKGROUND_Z)));
    }
}

/* What half resolution knows, and of the image the columns and rows between. */
struct Window {
    float half_z[HALF_ROWS][HALF_COLUMNS], fine[HALF_ROWS][HALF_COLUMNS], z[ROWS][COLUMNS];
    vec4 normal[ROWS][COLUMNS];
};

void load_depths(ivec2 texel, inout Window w)
{
    [[unroll]] for (int row = 0; row < ROWS; row += 2) {
        [[unroll]] for (int i = 0; i < COLUMNS; i += 2) {
            ivec2 at = texel + ivec2(i - 1, row);
            vec4 depth = four_depths(at);
            w.z[row][i] = w.half_z[row / 2][i / 2];
            if (i > 0)
                w.z[row][i - 1] = full_z(at, depth.x);
            if (row + 1 == ROWS)
                continue;
            w.z[row + 1][i] = full_z(at + ivec2(1, 1), depth.w);
            if (i > 0)
                w.z[row + 1][i - 1] = full_z(at + ivec2(0, 1), depth.z);
        }
    }
}

/* An even row and the odd one below it, as fine codes. */
void blend_rows(Window w, int even, out float result[2][VKAO_UPSAMPLE_WIDTH])
{
    const int odd = even + 1, below = even + 2;
    [[unroll]] for (int i = 0; i < VKAO_UPSAMPLE_WIDTH; ++i) {
        bool is_half = (i & 1) == 0;
        int left = is_half ? i : i - 1, right = is_half ? i : i + 1;
        Neighbour n[4];
        [[unroll]] for (int k = 0; k < 4; ++k) {
            int row = (k >> 1) == 0 ? even : below, column = (k & 1) == 0 ? left : right;
            n[k] = Neighbour(w.half_z[row / 2][column / 2], w.fine[row / 2][column / 2],
                             w.normal[row][column]);
        }
        vec2 slope = vec2(0.0, local_slope(w.z[even][i], w.z[odd][i], w.z[below][i]));
        if (is_half) {
            result[0][i] = w.fine[even / 2][i / 2];
            result[1][i] = blend(0, 1, w.z[odd][i], w.normal[odd][i], slope, n);
        } else {
            slope.x = local_slope(w.z[odd][left], w.z[odd][i], w.z[odd][right]);
            vec2 across = vec2(local_slope(w.z[even][left], w.z[even][i], w.z[even][right]), 0.0);
            result[0][i] = blend(1, 0, w.z[even][i], w.normal[even][i], across, n);
            result[1][i] = blend(1, 1, w.z[odd][i], w.normal[odd][i], slope, n);
        }
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
    Window w;
    [[unroll]] for (int row = 0; row < HALF_ROWS; ++row)
        load_half_row((texel >> 1) + ivec2(0, row), w.half_z[row], w.fine[row]);
    load_depths(texel, w);
    [[unroll]] for (int row = 0; row < ROWS; ++row) {
        [[unroll]] for (int i = 0; i < COLUMNS; ++i)
            w.normal[row][i] = NORMAL_POWER > 0.0 ? full_normal(texel + ivec2(i, row)) : vec4(0.0);
    }
    [[unroll]] for (int row = 0; row < VKAO_UPSAMPLE_HEIGHT; row += 2) {
        float fine[2][VKAO_UPSAMPLE_WIDTH];
        blend_rows(w, row, fine);
        put(texel + ivec2(0, row), w.z[row], fine[0]);
        put(texel + ivec2(0, row + 1), w.z[row + 1], fine[1]);
    }
}
