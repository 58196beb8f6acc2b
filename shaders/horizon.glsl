/* SPDX-License-Identifier: MIT
 *
 * What hbao, gtao and vbao share. A slice is the half plane pair through the direction to the eye V and a direction on
 * screen; inside it, points have coordinates x along O, away from the shaded point, and y along V. Both sides are
 * marched outwards. The cosine-weighted visibility of the hemisphere is the mean over slices of
 *     L * integral of cos(theta - n) |sin theta| over the visible theta,
 * theta being the angle to V, n that of the normal projected into the slice, L the projection's length
 * (Jimenez et al., 'Practical Real-Time Strategies for Accurate Indirect Occlusion', 2016). */
#ifndef VKAO_HORIZON_GLSL_
#define VKAO_HORIZON_GLSL_

const float PI = 3.14159265358979324;

struct Slice {
    vec2 texels_per_unit; /* along the slice, on screen */
    vec3 outward;         /* O: unit, in the slice, at right angles to V */
    vec3 across;          /* A: unit normal of the slice */
    float normal_length;  /* L */
    float cos_n, sin_n;   /* of the projected normal's angle from V, towards O */
    float across_to_y;    /* what one unit off the slice is worth in y: see slice_point */
};

uint slice_count()
{
    return params.slices_and_steps & 0xffffu;
}

uint step_count()
{
    return params.slices_and_steps >> 16;
}

Slice make_slice(float angle, vec3 position, vec3 normal, vec3 to_eye)
{
    Slice s;
    vec2 direction = vec2(cos(angle), sin(angle));
    /* Texels per scene unit at the shaded point, of a step along V's image of that direction */
    s.texels_per_unit = direction / (params.unproject.xy * (params.orthographic != 0u ? 1.0 : position.z));
    vec3 o = vec3(direction, 0.0) - dot(direction, to_eye.xy) * to_eye;
    s.outward = normalize(o);
    s.across = normalize(cross(o, to_eye));
    vec3 projected = normal - dot(normal, s.across) * s.across;
    s.normal_length = length(projected);
    float inverse = 1.0 / max(s.normal_length, 1.0e-6);
    s.cos_n = clamp(dot(projected, to_eye) * inverse, 0.0, 1.0);
    s.sin_n = dot(projected, s.outward) * inverse;
    s.across_to_y = dot(normal, s.across) / max(dot(normal, to_eye), 0.02);
    return s;
}

/* The texel that step t of n samples on one side, at least 1 + t/2 texels out. Steps crowd near the point. */
ivec2 step_texel(Slice s, ivec2 texel, float side, uint t, float jitter, float reach)
{
    float q = (float(t) + jitter) / float(step_count());
    vec2 offset = s.texels_per_unit * (reach * q * (VKAO_STEP_LINEAR + (1.0 - VKAO_STEP_LINEAR) * q));
    float texels = length(offset);
    offset *= max(1.0, (1.0 + 0.5 * float(t)) / max(texels, 1.0e-6));
    return ivec2(floor(vec2(texel) + side * offset + 0.5));
}

/* In-slice coordinates of a sample. Rounding to texels moves it out of the slice by u; u is taken out along the tangent
 * plane, which keeps its height over that plane, so that a tilted wall still lies flat in the slice. It is taken to lie
 * as deep as its depth may be wrong: a wall must not occlude itself by the steps of a depth format. */
vec2 slice_point(Slice s, vec3 v, vec3 to_eye, float side, float guard)
{
    return vec2(side * dot(v, s.outward), dot(v, to_eye) + dot(v, s.across) * s.across_to_y - guard);
}

/* How an occluder at squared distance d2 counts: the definition of both ray-traced truths. */
float falloff_weight(float d2, float radius)
{
    float x = d2 / (radius * radius);
    return params.falloff == VKAO_GLSL_FALLOFF_SMOOTH ? max(0.0, 1.0 - x) : (x <= 1.0 ? 1.0 : 0.0);
}

vec2 slice_noise(ivec2 texel)
{
    return vec2(interleaved_gradient_noise(uvec2(texel), params.noise_index),
                r2_noise(uvec2(texel), params.noise_index));
}

#endif
