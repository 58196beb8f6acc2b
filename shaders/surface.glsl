/* SPDX-License-Identifier: MIT
 *
 * How alike two texels of a surface are, for blur and upsampling: depths continued by their slope,
 * and normals. */
#ifndef VKAO_SURFACE_GLSL_
#define VKAO_SURFACE_GLSL_

#include "view.glsl"

/* What stands for the z of background: no slope leads there, and it is so far off any surface that
 * the square of the distance times the least edge_stop is no float: background weighs exactly
 * nothing, in the blur and in upsampling. What it holds is often not even written. */
const float BACKGROUND_Z = 1.0e38;

float surface_z(float z)
{
    return z > 0.0 ? z : BACKGROUND_Z;
}

/* The smaller of the two neighbour differences, per texel. */
float local_slope(float before, float z, float after)
{
    float a = z - before, b = after - z;
    float slope = abs(a) < abs(b) ? a : b;
    return abs(slope) < 0.1 * BACKGROUND_Z ? slope : 0.0;
}

/* How far a tap k texels away lies off the surface that goes on from the centre by its slope. */
float off_surface(float z, float slope, float tap_z, float k)
{
    return abs(tap_z - z - slope * k);
}

/* Where the blur compares no normals: 1 / the distance off a tap's surface at which a tap counts
 * nothing, but for BEND_LEAST; next to 0 where depth is ignored. unproject: the grid's, along the
 * blur. */
float bend_stop(float z, float slope, float unproject)
{
    float size = abs(unproject) * (ORTHOGRAPHIC ? 1.0 : z);
    float distance = abs(slope) + VKAO_BLUR_BEND_TEXELS * size +
                     VKAO_BLUR_BEND_BIASES * (params.bias + depth_error(z));
    return params.sharpness > 0.0 ? 1.0 / distance : 1.0e-30;
}

/* What is left of a tap off whose own surface the centre lies. */
float bend_weight(float z, float tap_z, float tap_slope, float k, float stop)
{
    return max(VKAO_BLUR_BEND_LEAST, 1.0 - stop * off_surface(tap_z, tap_slope, z, -k));
}

/* 1 / the distance off the continued slope at which a tap counts nothing; never 0, so that
 * background never counts. */
float edge_stop(float z, float sharpness, float reference_z)
{
    return max(sharpness / (reference_z > 0.0 ? reference_z : z), 1.0e-18);
}

/* What tap k counts on a flat surface. Falling to 0 over 4 texels, or over 2 of a small blur, it
 * makes the blur the mean of tiles as long as that (see tile_noise), whatever the radius: 1 2 1, 1
 * 2 2 2 1, 1 2 3 4 3 2 1, 1 2 3 4 4 4 3 2 1. */
float blur_weight(int k, int radius)
{
    return min(1.0, float(radius + 1 - abs(k)) * (radius < 3 ? 0.5 : 0.25));
}

/* What all taps count on a flat surface, without the centre's 1. */
float blur_weights(int radius)
{
    float sum = 0.0;
    for (int k = 1; k <= radius; ++k)
        sum += 2.0 * blur_weight(k, radius);
    return sum;
}

/* Beside an edge AO is steep, and the mean of one side of the window alone is that of a place
 * farther in. So a side counts more the more of the other one lies on the surface as well: in the
 * middle of a surface by 1 + across. */
float across()
{
    return NORMAL_POWER > 0.0 ? VKAO_BLUR_ACROSS_NORMALS : VKAO_BLUR_ACROSS;
}

/* What tap k counts alone; what it gains in the middle of a surface makes blur_weight of it. */
float weight_alone(int k, int radius)
{
    return blur_weight(k, radius) * (1.0 / (1.0 + across()));
}

/* By how much more either side counts. weights: what the sides count alone. */
vec2 more_across(vec2 weights, int radius)
{
    float of_a_side = 2.0 * across() * (1.0 + across());
    return radius == 0 ? vec2(0.0) : weights.yx * (of_a_side / blur_weights(radius));
}

/* Is there a surface? As a number. */
float is_surface(float z)
{
    return clamp(2.0 - z * (2.0 / BACKGROUND_Z), 0.0, 1.0);
}

/* What all of the window but background counts besides, as a share of blur_weight. The mean of a
 * few texels alone, as of a bar or a leaf, is noise, which is seen as speckles that crawl when
 * things move. Beside the straight edge of anything wider half a window is left, and that is
 * enough. near: what the taps count alone by depth; weights: by their normals as well, which
 * in a small blur may leave none. */
float leak_of(float near, float weights, int radius)
{
    const float LEAK = VKAO_BLUR_LEAK;
    if (radius == 0)
        return 0.0;
    float few = LEAK * (1.0 + across()) / (VKAO_BLUR_LEAK_BELOW * blur_weights(radius));
    return clamp(LEAK - few * (radius < 3 ? weights : near), 0.0, 1.0);
}

/* A stored normal of the image; w is 1 where there is none to trust: then depths decide. */
vec4 stored_normal(ivec2 texel)
{
    vec3 n = decode_normal(texel);
    return vec4(n, n == vec3(0.0) ? 1.0 : 0.0);
}

float normal_weight(vec4 normal, vec4 other, float power)
{
    float c = max(max(dot(normal.xyz, other.xyz), 1.0e-6), max(normal.w, other.w));
    if (NORMAL_POWER == 8.0) {
        float c2 = c * c, c4 = c2 * c2;
        return c4 * c4;
    }
    return pow(c, power);
}

#endif
