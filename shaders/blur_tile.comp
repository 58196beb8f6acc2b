/* SPDX-License-Identifier: MIT
 *
 * Both directions of the blur that blur.comp describes at once, for radii up to
 * VKAO_BLUR_TILE_RADIUS: a group reads a tile of texels and what lies around it into shared memory,
 * blurs its rows there in place, and then its columns. An invocation takes several texels of a row
 * or of a column, whose windows overlap. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#extension GL_EXT_control_flow_attributes : require
#define VKAO_GLSL
#include "params.h"

layout(local_size_x = VKAO_BLUR_TILE_THREADS) in;
layout(push_constant) uniform Block { vkao_dispatch here; };
#include "settings.glsl"
layout(binding = VKAO_BINDING_SOURCE) uniform texture2D source_image;
layout(binding = VKAO_BINDING_BENT_SOURCE) uniform texture2D bent_image;
#include "view.glsl"
#include "surface.glsl"
#include "bent_code.glsl"
#include "visibility_code.glsl"
#ifdef VKAO_LAST
#include "finish.glsl"
#else
#include "half.glsl"
layout(binding = VKAO_BINDING_TARGET) uniform writeonly image2D target_image;
#endif

/* The tile, and the texels around it: as far as the blur reaches, and one more for slopes. An odd
 * pitch keeps columns in different banks. */
const int REACH = VKAO_BLUR_TILE_RADIUS, AROUND = REACH + 1, WIDTH = VKAO_BLUR_TILE_WIDTH;
const int ROWS = VKAO_BLUR_TILE_ROWS(TILE_WORDS);
const int PITCH = WIDTH + 2 * AROUND + 1, TEXELS = ROWS * PITCH;
/* Texels of a row, and of a column, that an invocation blurs in a turn. */
const int ALONG_X = 4, TURNS = ROWS * WIDTH / ALONG_X / VKAO_BLUR_TILE_THREADS;
const int ALONG_Y = (ROWS - 2 * AROUND) * WIDTH / VKAO_BLUR_TILE_THREADS;
#define HAS_NORMALS (NORMAL_POWER > 0.0)

/* The first word of a texel is its view z, below 0 where there is no normal. The second is
 * .w of v, or half floats of it and of the last coordinate of the normal or the bent normal. */
shared uint tile[TILE_WORDS * TEXELS];

struct Texel {
    float z;
    vec4 v; /* bent normal, decode_hidden of visibility */
    vec4 normal;
};

/* at: of whole texels. */
Texel load_texel(vec2 at)
{
    Texel t;
    float z = load_view_z_at(at);
    t.z = surface_z(z);
    vec2 middle = at + 0.5;
    t.v = vec4(decode_hidden(textureLod(sampler2D(source_image, nearest), middle, 0.0).x));
    if (BENT_NORMALS)
        t.v.xyz = decode_bent(textureLod(sampler2D(bent_image, nearest), middle, 0.0));
    t.v = z > 0.0 ? t.v : vec4(0.0);
    t.normal = vec4(0.0);
    if (HAS_NORMALS) {
        ivec2 low = unpack_texel(params.valid.x), last = unpack_texel(params.valid.y) - 1;
        ivec2 inside = clamp(ivec2(at), low, last);
        t.normal = stored_normal(inside << GRID_SHIFT);
    }
    return t;
}

void write_visibility(int at, Texel t)
{
    if (BENT_NORMALS) {
        if (HAS_NORMALS)
            tile[4 * TEXELS + at] = packHalf2x16(vec2(t.v.z, 0.0));
        tile[(HAS_NORMALS ? 3 : 2) * TEXELS + at] = packHalf2x16(t.v.xy);
    }
    float beside = HAS_NORMALS ? t.normal.z : t.v.z;
    tile[TEXELS + at] =
        BENT_NORMALS || HAS_NORMALS ? packHalf2x16(vec2(t.v.w, beside)) : floatBitsToUint(t.v.w);
}

void write_texel(int at, Texel t)
{
    tile[at] = floatBitsToUint(t.normal.w > 0.0 ? -t.z : t.z);
    if (HAS_NORMALS)
        tile[2 * TEXELS + at] = packHalf2x16(t.normal.xy);
    write_visibility(at, t);
}

Texel read_texel(int at)
{
    Texel t = Texel(uintBitsToFloat(tile[at]), vec4(0.0), vec4(0.0));
    if (BENT_NORMALS || HAS_NORMALS) {
        vec2 both = unpackHalf2x16(tile[TEXELS + at]);
        t.v = vec4(0.0, 0.0, both.y, both.x);
        t.normal.z = both.y;
    } else {
        t.v.w = uintBitsToFloat(tile[TEXELS + at]);
    }
    if (HAS_NORMALS) {
        t.normal.xy = unpackHalf2x16(tile[2 * TEXELS + at]);
        t.normal.w = t.z < 0.0 ? 1.0 : 0.0;
        t.z = abs(t.z);
    }
    if (BENT_NORMALS) {
        t.v.xy = unpackHalf2x16(tile[(HAS_NORMALS ? 3 : 2) * TEXELS + at]);
        if (HAS_NORMALS)
            t.v.z = unpackHalf2x16(tile[4 * TEXELS + at]).x;
    }
    return t;
}

/* What the window of a texel gives it; the first and the last are there for slopes. unproject: see
 * bend_stop. */
vec4 blurred(Texel window[2 * REACH + 3], float unproject)
{
    Texel center = window[AROUND];
    float slope = local_slope(window[AROUND - 1].z, center.z, window[AROUND + 1].z);
    float edge = edge_stop(center.z, params.sharpness, ORTHOGRAPHIC ? params.reference_z : 0.0);
    float bend = bend_stop(center.z, slope, unproject);
    vec4 sums[2] = vec4[](vec4(0.0), vec4(0.0));
    vec2 weights = vec2(0.0);
    float near = 0.0, all = 0.0, all_weights = 0.0;
    [[unroll]] for (int k = -REACH; k <= REACH; ++k) {
        if (k == 0 || abs(k) > RADIUS)
            continue;
        Texel tap = window[AROUND + k];
        float off = off_surface(center.z, slope, tap.z, float(k));
        float alone = weight_alone(k, RADIUS), w = clamp(alone - alone * edge * off, 0.0, 1.0);
        float tap_slope = local_slope(window[AROUND + k - 1].z, tap.z, window[AROUND + k + 1].z);
        if (HAS_NORMALS) {
            near += w;
            w *= normal_weight(center.normal, tap.normal, NORMAL_POWER);
        } else {
            w *= bend_weight(center.z, tap.z, tap_slope, float(k), bend);
        }
        sums[int(k > 0)] += w * tap.v;
        weights[int(k > 0)] += w;
        float full = blur_weight(k, RADIUS);
        all += full * tap.v.w;
        all_weights += full * is_surface(tap.z);
    }
    float own = weights.x + weights.y;
    float leak = leak_of(HAS_NORMALS ? near : own, own, RADIUS);
    leak *= is_surface(center.z); /* v of background stays 0 */
    vec2 gain = 1.0 + more_across(weights, RADIUS);
    vec4 sum = center.v + gain.x * sums[0] + gain.y * sums[1];
    sum.w += leak * all;
    float total = 1.0 + dot(gain, weights);
    sum /= vec4(vec3(total), total + leak * all_weights);
    /* an ao_noisy of the caller's may hold anything */
    if (!NOISY_CODES)
        sum.w = is_sane(sum.w) ? sum.w : 0.0;
    return sum;
}

/* The window of the texel that is the i-th of a turn. */
#define WINDOW(t, i)                                                                               \
    Texel[](t[i], t[i + 1], t[i + 2], t[i + 3], t[i + 4], t[i + 5], t[i + 6], t[i + 7], t[i + 8])

/* Rows, in place: all are read before any is written. */
void blur_rows(int lane)
{
    const int LANES = WIDTH / ALONG_X;
    Texel results[TURNS][ALONG_X];
    int first = lane / LANES * PITCH + lane % LANES * ALONG_X;
    const int TURN = VKAO_BLUR_TILE_THREADS / LANES * PITCH;
    [[unroll]] for (int turn = 0; turn < TURNS; ++turn) {
        Texel t[ALONG_X + 2 * AROUND];
        [[unroll]] for (int i = 0; i < ALONG_X + 2 * AROUND; ++i)
            t[i] = read_texel(first + turn * TURN + i);
        [[unroll]] for (int i = 0; i < ALONG_X; ++i) {
            results[turn][i] = t[AROUND + i];
            results[turn][i].v = blurred(WINDOW(t, i), params.unproject.x);
        }
    }
    barrier();
    [[unroll]] for (int turn = 0; turn < TURNS; ++turn) {
        [[unroll]] for (int i = 0; i < ALONG_X; ++i)
            write_visibility(first + turn * TURN + AROUND + i, results[turn][i]);
    }
    barrier();
}

void store(ivec2 texel, Texel t, vec4 v)
{
    vec4 result = vec4(v.xyz, v.w * VISIBILITY_UNIT + 1.0);
    bool is_background = t.z == BACKGROUND_Z;
#ifdef VKAO_LAST
    finish(texel, result, is_background);
#else
    result = is_background ? vec4(0.0, 0.0, 0.0, 1.0) : result;
    imageStore(target_image, texel, nearest_half(BENT_NORMALS ? result : result.wwww));
#endif
}

void blur_columns(int lane, ivec2 origin)
{
    int x = lane % WIDTH, y = lane / WIDTH * ALONG_Y;
    Texel t[ALONG_Y + 2 * AROUND];
    [[unroll]] for (int i = 0; i < ALONG_Y + 2 * AROUND; ++i)
        t[i] = read_texel((y + i) * PITCH + AROUND + x);
    [[unroll]] for (int i = 0; i < ALONG_Y; ++i) {
        ivec2 texel = origin + ivec2(x, y + i);
        vec4 v = blurred(WINDOW(t, i), params.unproject.y);
        if (all(lessThan(texel, unpack_texel(here.rect.y))))
            store(texel, t[AROUND + i], v);
    }
}

void main()
{
    int lane = int(gl_LocalInvocationIndex);
    ivec2 size = ivec2(WIDTH, ROWS - 2 * AROUND);
    ivec2 origin = ivec2(gl_WorkGroupID.xy) * size + unpack_texel(here.rect.x);
    /* The tile is as wide as half the group's lanes, twice; what is beside it, as an eighth. */
    const int BESIDE = 2 * AROUND;
    ivec2 first = origin - ivec2(AROUND, AROUND);
    ivec2 at = ivec2(lane % WIDTH, lane / WIDTH);
    int place = at.y * PITCH + at.x;
    vec2 texel = vec2(first + at);
    [[unroll]] for (int row = 0; row < ROWS; row += VKAO_BLUR_TILE_THREADS / WIDTH)
        write_texel(place + row * PITCH, load_texel(texel + vec2(0.0, row)));
    at = ivec2(WIDTH + lane % BESIDE, lane / BESIDE);
    place = at.y * PITCH + at.x;
    texel = vec2(first + at);
    [[unroll]] for (int row = 0; row < ROWS; row += VKAO_BLUR_TILE_THREADS / BESIDE)
        write_texel(place + row * PITCH, load_texel(texel + vec2(0.0, row)));
    barrier();
    blur_rows(lane);
    blur_columns(lane, origin);
}
