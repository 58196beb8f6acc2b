/* SPDX-License-Identifier: MIT
 *
 * Images to the screen: zoom, pan, the line between A and B, and tone. Magnified texels stay
 * squares; reduced ones are averaged, so that noise does not become a pattern. */
#version 450
#extension GL_GOOGLE_include_directive : require
#include "display.h"

layout(push_constant) uniform Block { display_block params; };
layout(binding = DISPLAY_BINDING_A) uniform sampler2D image_a;
layout(binding = DISPLAY_BINDING_B) uniform sampler2D image_b;
layout(binding = DISPLAY_BINDING_REFERENCE) uniform sampler2D reference;
layout(binding = DISPLAY_BINDING_KEPT) uniform sampler2D kept;
layout(binding = DISPLAY_BINDING_BEFORE) uniform sampler2D before;
layout(location = 0) out vec4 out_color;

const vec3 background = vec3(0.09, 0.10, 0.11);
const vec3 line_color = vec3(1.0, 0.6, 0.1);
const int max_taps = 8; /* on each axis, of a reduced image */

/* IEC 61966-2-1 */
vec3 to_srgb(vec3 c)
{
    c = clamp(c, 0.0, 1.0);
    bvec3 dark = lessThanEqual(c, vec3(0.0031308));
    return mix(1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, c * 12.92, dark);
}

/* As light_finish does it. */
vec3 finish(vec3 value, ivec2 texel, uint mode)
{
    vec4 left = texelFetch(kept, texel, 0);
    if (mode != DISPLAY_LIT)
        return value + (1.0 - value) * left.a;
    value += left.rgb;
    return left.a > 0.0 ? mix(value, texelFetch(before, texel, 0).rgb, left.a) : value;
}

vec3 fetch(bool b, ivec2 texel, uint mode)
{
    vec3 value = b ? texelFetch(image_b, texel, 0).rgb : texelFetch(image_a, texel, 0).rgb;
    bool is_ao = mode == DISPLAY_AO || mode == DISPLAY_DIFFERENCE;
    if (params.is_kept != 0u && (is_ao || mode == DISPLAY_LIT))
        value = finish(value, texel - ivec2(params.offset_x, params.offset_y), mode);
    if (mode == DISPLAY_DIFFERENCE)
        value.x -= texelFetch(reference, texel, 0).x;
    return value;
}

vec3 sample_image(bool b, vec2 at, uint mode)
{
    ivec2 offset = ivec2(params.offset_x, params.offset_y);
    ivec2 last = ivec2(params.width, params.height) - 1;
    if (params.zoom >= 1.0)
        return fetch(b, offset + clamp(ivec2(floor(at)), ivec2(0), last), mode);
    float side = 1.0 / params.zoom;
    int taps = min(max_taps, int(ceil(side)));
    vec3 sum = vec3(0.0);
    for (int y = 0; y < taps; ++y) {
        for (int x = 0; x < taps; ++x) {
            vec2 tap = at + side * ((vec2(x, y) + 0.5) / float(taps) - 0.5);
            sum += fetch(b, offset + clamp(ivec2(floor(tap)), ivec2(0), last), mode);
        }
    }
    return sum / float(taps * taps);
}

vec3 tone(vec3 value, uint mode)
{
    if (mode == DISPLAY_AO)
        return vec3(value.x);
    if (mode == DISPLAY_DEPTH)
        return vec3(value.x > 0.0 ? (value.x - params.low) / (params.high - params.low) : 0.0);
    if (mode == DISPLAY_SRGB || mode == DISPLAY_LIT)
        return to_srgb(value * params.exposure);
    if (mode == DISPLAY_DIFFERENCE) {
        float d = value.x * params.gain;
        return d < 0.0 ? -d * vec3(1.0, 0.35, 0.1) : d * vec3(0.15, 0.6, 1.0);
    }
    return value;
}

void main()
{
    vec2 screen = gl_FragCoord.xy;
    vec2 at = (screen - vec2(params.origin_x, params.origin_y)) / params.zoom;
    bool b = screen.x >= params.wipe;
    uint mode = b ? params.mode_b : params.mode_a;
    vec3 color = background;
    bool inside = all(greaterThanEqual(at, vec2(0.0))) &&
        all(lessThan(at, vec2(params.width, params.height)));
    /* Rounded here, half upwards as in the PNG files of vkao: how an attachment rounds is the
     * device's affair. */
    if (inside && mode != DISPLAY_NOTHING)
        color = floor(clamp(tone(sample_image(b, at, mode), mode), 0.0, 1.0) * 255.0 + 0.5) / 255.0;
    if (params.line != 0u && floor(screen.x) == floor(params.wipe))
        color = line_color;
    out_color = vec4(color, 1.0);
}
