/* SPDX-License-Identifier: MIT
 *
 * The upsampling that upsample.comp describes, of two by two texels to an invocation: an even one,
 * which is of half resolution itself, and those in the middle of two or four. They share four
 * texels of half resolution, and beside their own depths two more give the slopes of the last. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#extension GL_EXT_control_flow_attributes : require
#define VKAO_GLSL
#include "params.h"

layout(local_size_x = VKAO_GROUP_WIDTH, local_size_y = VKAO_GROUP_HEIGHT) in;
layout(push_constant) uniform Block { vkao_dispatch here; };
#include "settings.glsl"
layout(binding = VKAO_BINDING_SOURCE) uniform texture2D half_image;
#include "view.glsl"
#include "depth.glsl"
#include "gathered.glsl"
#include "surface.glsl"
#include "finish.glsl"

/* Of a lone texel before the sky: open, towards the eye. */
const vec4 OPEN = vec4(0.0, 0.0, -1.0, 0.0);

/* Of half resolution; z of background is BACKGROUND_Z, which weighs nothing. */
struct Corner {
    float z;
    vec4 v; /* bent normal, visibility less 1: exactly 0 where all is open */
    vec4 normal;
};

void load_corners(ivec2 first, out Corner corners[2][2])
{
    vec2 middle = vec2(first) + 1.0;
    vec4 left = gather_view_z(vec2(first)), right = gather_view_z(vec2(first) + vec2(1.0, 0.0));
    vec4 z = vec4(left.x, right.xw, left.w); /* as a gather of neighbours has them */
    vec4 open = vec4(0.0);
    if (!BENT_NORMALS)
        open = textureGather(sampler2D(half_image, nearest), middle);
    [[unroll]] for (int y = 0; y < 2; ++y) {
        [[unroll]] for (int x = 0; x < 2; ++x) {
            ivec2 at = first + ivec2(x, y);
            Corner c = Corner(surface_z(z[GATHERED[y][x]]), vec4(open[GATHERED[y][x]]), vec4(0.0));
            if (BENT_NORMALS)
                c.v = textureLod(sampler2D(half_image, nearest), vec2(at) + 0.5, 0.0);
            c.v.w -= 1.0;
            c.v = z[GATHERED[y][x]] > 0.0 ? c.v : OPEN; /* nobody has written there */
            if (NORMAL_POWER > 0.0)
                c.normal =
                    stored_normal(min(2 * at, unpack_texel(params.image_valid.y) - 1));
            corners[y][x] = c;
        }
    }
}

/* A texel in the middle of two corners. Its slope is that to the nearer one in depth, which so lies
 * on its surface; the other one is off it by as much as the two slopes differ. */
vec4 between_two(Corner a, Corner b, ivec2 texel, float z)
{
    float edge = edge_stop(z, params.sharpness, params.reference_z);
    float to_a = z - a.z, to_b = b.z - z;
    bool on_a = abs(to_a) < abs(to_b);
    float off = edge * abs(to_a - to_b), other = max(0.0, 1.0 - off);
    vec2 w = on_a ? vec2(1.0, other) : vec2(other, 1.0);
    if (NORMAL_POWER > 0.0) {
        /* Normals may have neither: see below. */
        vec4 normal = stored_normal(texel);
        float least = 1.0e-6 / (1.0 + off * off);
        w *= vec2(normal_weight(normal, a.normal, NORMAL_POWER),
                  normal_weight(normal, b.normal, NORMAL_POWER));
        w += on_a ? vec2(1.0e-6, least) : vec2(least, 1.0e-6);
    }
    return (w.x * a.v + w.y * b.v) / (w.x + w.y);
}

/* A texel in the middle of all. */
vec4 between_four(Corner corners[2][2], ivec2 texel, float z, vec2 slope)
{
    float edge = edge_stop(z, params.sharpness, params.reference_z);
    vec4 normal = NORMAL_POWER > 0.0 ? stored_normal(texel) : vec4(0.0);
    vec4 sum = vec4(0.0);
    float weights = 0.0;
    [[unroll]] for (int y = 0; y < 2; ++y) {
        [[unroll]] for (int x = 0; x < 2; ++x) {
            Corner c = corners[y][x];
            float off = edge * abs(c.z - z - dot(slope, vec2(2 * ivec2(x, y) - 1)));
            float w = max(0.0, 1.0 - off);
            if (NORMAL_POWER > 0.0)
                w *= normal_weight(normal, c.normal, NORMAL_POWER);
            /* Far below any honest weight: decides only if there is none. */
            w += 1.0e-6 / (1.0 + off * off);
            sum += w * c.v;
            weights += w;
        }
    }
    return weights > 0.0 ? sum / weights : OPEN;
}

void put(ivec2 texel, bool background, vec4 v)
{
    if (in_rect(texel, here.rect))
        finish(texel, vec4(v.xyz, v.w + 1.0), background);
}

void main()
{
    ivec2 first = (unpack_texel(here.rect.x) >> 1) + ivec2(gl_GlobalInvocationID.xy);
    ivec2 texel = 2 * first, right = texel + ivec2(1, 0), below = texel + ivec2(0, 1),
          last = texel + 1;
    Corner corners[2][2];
    load_corners(first, corners);
    vec2 at = vec2(texel); /* texels to come are constants away from it */
    vec4 depth = textureGather(sampler2D(depth_image, nearest), at + 1.0);
    float right_z = view_z_of(depth[GATHERED[0][1]], right),
          below_z = view_z_of(depth[GATHERED[1][0]], below),
          last_z = view_z_of(depth[GATHERED[1][1]], last);
    /* Beside the last: what is not valid is background. */
    ivec2 far_x = last + ivec2(1, 0), far_y = last + ivec2(0, 1);
    float far_x_depth = textureLod(sampler2D(depth_image, nearest), at + vec2(2.5, 1.5), 0.0).x,
          far_y_depth = textureLod(sampler2D(depth_image, nearest), at + vec2(1.5, 2.5), 0.0).x,
          far_x_z = in_rect(far_x, params.image_valid) ? view_z_of(far_x_depth, far_x) : 0.0,
          far_y_z = in_rect(far_y, params.image_valid) ? view_z_of(far_y_depth, far_y) : 0.0;

    put(texel, corners[0][0].z == BACKGROUND_Z, corners[0][0].v);
    put(right, right_z == 0.0, between_two(corners[0][0], corners[0][1], right, right_z));
    put(below, below_z == 0.0, between_two(corners[0][0], corners[1][0], below, below_z));
    vec2 slopes = vec2(local_slope(surface_z(below_z), last_z, surface_z(far_x_z)),
                       local_slope(surface_z(right_z), last_z, surface_z(far_y_z)));
    put(last, last_z == 0.0, between_four(corners, last, last_z, slopes));
}
