/* SPDX-License-Identifier: MIT
 *
 * What hbao, gtao and vbao share. A slice is the half plane pair through the direction to the eye V and a direction on
 * screen; inside it, points have coordinates x along O, away from the shaded point, and y along V. Both sides are
 * marched outwards, together: in a vec2 that speaks of a slice, .x is the side along O and .y the other one. The
 * cosine-weighted visibility of the hemisphere is the mean over slices of
 *     L * integral of cos(theta - n) |sin theta| over the visible theta,
 * theta being the angle to V, n that of the normal projected into the slice, L the projection's length
 * (Jimenez et al., 'Practical Real-Time Strategies for Accurate Indirect Occlusion', 2016). */
#ifndef VKAO_HORIZON_GLSL_
#define VKAO_HORIZON_GLSL_

const float PI = 3.14159265358979324;
const vec2 SIDES = vec2(1.0, -1.0);

struct Slice {
    vec2 direction;      /* on screen, unit length in texels */
    float texels;        /* how many of them a scene unit has at the shaded point */
    vec2 to_x, to_y;     /* texels off the shaded point -> x and y, per unit of view z in perspective */
    float eye, origin;   /* y is origin - eye * view z, and what to_y adds */
    vec3 outward;        /* O: unit, in the slice, at right angles to V */
    float normal_length; /* L */
    float cos_n, sin_n;  /* of the projected normal's angle from V, towards O */
};

/* cos and sin of pi u, u in [0,1): off by less than 7e-6. */
vec2 half_turn(float u)
{
    float v = u - 0.5, v2 = v * v;
    float s = v * (3.14158202 + v2 * (-5.16714276 + v2 * (2.54189872 - 0.55463536 * v2)));
    float c = 0.99999329 + v2 * (-4.93393798 + v2 * (4.04128334 - 1.22212545 * v2));
    return vec2(-s, c);
}

/* turn in [0,1) is half the circle. */
Slice make_slice(float turn, vec3 position, vec3 normal, vec3 to_eye)
{
    Slice s;
    vec2 d = half_turn(turn);
    vec2 on_screen = d / params.unproject.xy;
    float per_texel = inversesqrt(dot(on_screen, on_screen));
    s.direction = on_screen * per_texel;
    s.texels = orthographic() ? 1.0 / per_texel : 1.0 / (per_texel * position.z);
    vec3 o = vec3(d, 0.0) - dot(d, to_eye.xy) * to_eye;
    s.outward = o * inversesqrt(dot(o, o));
    vec3 across = cross(s.outward, to_eye);
    float off = dot(normal, across), facing = dot(normal, to_eye);
    /* A sample's texel lies off the slice by rounding. It is moved into it along the tangent plane, which keeps its
     * height over that plane, so that a tilted wall still lies flat in the slice. */
    s.to_x = params.unproject.xy * s.outward.xy;
    s.to_y = params.unproject.xy * (to_eye.xy + across.xy * (off / max(facing, 0.02)));
    s.eye = orthographic() ? 1.0 : -1.0 / to_eye.z;
    /* It is taken to lie as deep as its depth may be wrong: a wall must not occlude itself by the steps of a format. */
    s.origin = s.eye * position.z - 2.0 * depth_error(position.z);
    float length2 = max(1.0 - off * off, 1.0e-12), inverse = inversesqrt(length2);
    s.normal_length = length2 * inverse;
    s.cos_n = clamp(facing * inverse, 0.0, 1.0);
    s.sin_n = dot(normal, s.outward) * inverse;
    return s;
}

/* Texels off the shaded point of step t on the first side, at least 1 + t/2. Steps crowd near the point. */
vec2 step_offset(Slice s, uint t, float jitter, float reach)
{
    float q = (float(t) + jitter) * (1.0 / float(step_count()));
    float far = s.texels * reach * q * (VKAO_STEP_LINEAR + (1.0 - VKAO_STEP_LINEAR) * q);
    return roundEven(s.direction * max(far, 1.0 + 0.5 * float(t)));
}

/* View z of the texels at +offset and -offset. */
vec2 load_sides(vec2 texel, vec2 offset)
{
    return vec2(load_view_z_at(texel + offset), load_view_z_at(texel - offset));
}

/* Their coordinates in the slice. */
void slice_points(Slice s, vec2 offset, vec2 z, out vec2 x, out vec2 y)
{
    vec2 scale = orthographic() ? vec2(1.0) : z;
    x = scale * dot(s.to_x, offset);
    y = scale * (dot(s.to_y, offset) * SIDES) + (s.origin - s.eye * z);
}

/* How an occluder at squared distance d2 counts: the definition of both ray-traced truths. */
vec2 falloff_weight(vec2 d2)
{
    vec2 x = d2 * params.inverse_radius2;
    return flag(VKAO_FLAG_THRESHOLD) ? vec2(lessThanEqual(x, vec2(1.0))) : max(vec2(0.0), 1.0 - x);
}

vec2 slice_noise(ivec2 texel)
{
    return vec2(interleaved_gradient_noise(uvec2(texel), params.noise_index),
                r2_noise(uvec2(texel), params.noise_index));
}

#endif
