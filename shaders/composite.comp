/* SPDX-License-Identifier: MIT
 *
 * AO onto colour, in linear light; alpha is passed on. AO belongs on indirect light; multiplying
 * all of it is the approximation for pictures that come in one piece.
 *
 * Multi-bounce (Jimenez et al. 2016): light that leaves an occluded place by further bounces, by
 * albedo p per channel,
 *     max(ao, ((a ao + b) ao + c) ao), a = 2.0404 p - 0.3324, b = -4.7951 p + 0.6417, c = 2.7552 p
 *     + 0.6903.
 * The polynomial is the paper's fit to path-traced scenes, over ao and p in [0, 1]. At ao 1 it is
 * within .0004 of 1. Specular occlusion, either from AO and roughness r (Lagarde and de Rousiers,
 * 'Moving Frostbite to PBR', 2014),
 *     saturate((n.v + ao)^exp2(-16 r - 1) - 1 + ao),
 * or from the cone around the bent normal that AO opens, cut by the cone of the specular lobe (Oat
 * and Sander, 'Ambient Aperture Lighting', 2007).
 *
 * What light is multiplied by is finite whatever the images hold; the light itself is the
 * caller's. */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#define VKAO_GLSL
#include "params.h"

layout(local_size_x = VKAO_GROUP_WIDTH, local_size_y = VKAO_GROUP_HEIGHT) in;
layout(push_constant) uniform Block { vkao_dispatch here; };
#include "settings.glsl"
layout(binding = VKAO_BINDING_SOURCE) uniform texture2D ao_image;
layout(binding = VKAO_BINDING_COLOR) uniform texture2D color_image;
layout(binding = VKAO_BINDING_DIRECT) uniform texture2D direct_image;
layout(binding = VKAO_BINDING_ALBEDO) uniform texture2D albedo_image;
layout(binding = VKAO_BINDING_SPECULAR) uniform texture2D specular_image;
layout(binding = VKAO_BINDING_BENT_READ) uniform texture2D bent_image;
layout(binding = VKAO_BINDING_OUTPUT) uniform writeonly image2D output_image;
#include "view.glsl"

/* Shares: AO, reflectance, roughness. What is no number is the second. */
float share(float v, float otherwise)
{
    return is_sane(v) ? clamp(v, 0.0, 1.0) : otherwise;
}

vec3 multi_bounce(float ao, vec3 albedo)
{
    vec3 a = 2.0404 * albedo - 0.3324, b = -4.7951 * albedo + 0.6417, c = 2.7552 * albedo + 0.6903;
    return max(vec3(ao), ((a * ao + b) * ao + c) * ao);
}

/* Solid angle of two cones' intersection over that of the second. The smoothstep of Oat and Sander
 * stands for a formula with many arc cosines. For half angles up to 90 degrees it is off by .17 of
 * the smaller cone at most. */
float cone_overlap(float cos_open, float cos_lobe, float cos_between)
{
    float open = acos(cos_open), lobe = acos(cos_lobe),
          between = acos(clamp(cos_between, -1.0, 1.0));
    float smaller = 1.0 - max(cos_open, cos_lobe), difference = abs(open - lobe);
    float x = 1.0 - clamp((between - difference) / max(open + lobe - difference, 1.0e-4), 0.0, 1.0);
    return smaller * x * x * (3.0 - 2.0 * x) / max(1.0 - cos_lobe, 1.0e-6);
}

float specular_occlusion(ivec2 texel, float ao, float roughness)
{
    vec3 n = to_view(decode_normal(texel));
    vec3 v = direction_to_eye(view_position(vec2(texel) / float(1 << GRID_SHIFT), 1.0));
    n = dot(n, v) < 0.0 ? -n : n; /* as the SSAO stage turned it */
    if (n == vec3(0.0))
        return ao; /* background, or a normal that is not to be trusted */
    if (SPECULAR == VKAO_GLSL_SPECULAR_FROM_AO) {
        float exponent = exp2(-16.0 * roughness - 1.0);
        return clamp(pow(max(dot(n, v), 0.0) + ao, exponent) - 1.0 + ao, 0.0, 1.0);
    }
    vec3 bent = to_view(decode_direction(texelFetch(bent_image, texel, 0).xyz, BENT_ENCODING));
    if (bent == vec3(0.0))
        return ao;
    /* AO is 1 - cos^2 of the cone that is open. The cosine of the lobe's is 10^-r^2: of a GGX lobe
     * with alpha = r^2, seen from above, it holds 99 % at r = .1, 75 % at .6 and 45 % at 1. */
    /* a mirror's cone has no solid angle */
    float cos_lobe = min(exp2(-3.32193 * roughness * roughness), 0.9999);
    return clamp(cone_overlap(sqrt(max(0.0, 1.0 - ao)), cos_lobe, dot(bent, reflect(-v, n))), 0.0,
                 1.0);
}

vec4 lit(ivec2 texel, vec3 factor, float ao)
{
    vec4 color = texelFetch(color_image, texel, 0);
    vec3 rgb = color.rgb * factor;
    if (COMPOSITE_MODE == VKAO_GLSL_COMPOSITE_INDIRECT)
        rgb += texelFetch(direct_image, texel, 0).rgb;
    if (SPECULAR != VKAO_GLSL_SPECULAR_NONE) {
        vec4 specular = texelFetch(specular_image, texel, 0);
        rgb += specular.rgb *
               mix(1.0, specular_occlusion(texel, ao, share(specular.a, 1.0)), params.strength);
    }
    return vec4(rgb, color.a);
}

void main()
{
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy) + unpack_texel(here.rect.x);
    if (any(greaterThanEqual(texel, unpack_texel(here.rect.y))))
        return;
    float ao = share(texelFetch(ao_image, texel, 0).x, 1.0);
    vec3 open = vec3(mix(1.0, ao, params.strength));
    if (MULTI_BOUNCE) {
        vec3 albedo = texelFetch(albedo_image, texel, 0).rgb;
        albedo = vec3(share(albedo.r, 0.0), share(albedo.g, 0.0), share(albedo.b, 0.0));
        open = mix(vec3(1.0), multi_bounce(ao, albedo), params.strength);
    }
    vec3 factor = mix(params.tint.rgb, vec3(1.0), open);
    vec4 result = vec4(factor, 1.0);
    if (COMPOSITE_MODE != VKAO_GLSL_COMPOSITE_AO_ONLY)
        result = lit(texel, factor, ao);
    imageStore(output_image, texel, result);
}
