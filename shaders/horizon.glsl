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
    vec2 step;           /* direction on screen, in texels that one scene unit has at unit distance */
    float per_texel;     /* 1 / its length */
    float scale;         /* scene units -> the same at the shaded point */
    vec2 to_x, to_y;     /* texels off the shaded point -> x and y, per unit of view z in perspective */
    float eye, origin;   /* y is origin - eye * view z, and what to_y adds */
    vec3 outward;        /* O: unit, in the slice, at right angles to V */
    float normal_length; /* L */
    float cos_n, sin_n;  /* of the projected normal's angle from V, towards O */
};

/* Unit vector to the eye. It does not depend on view z: all that is made of it is ready before that is loaded. */
vec3 eye_direction(ivec2 texel)
{
    return direction_to_eye(view_position(vec2(texel), 1.0));
}

/* turn in [0,1) is half the circle. */
Slice make_slice(float turn, vec3 position, vec3 normal, vec3 to_eye)
{
    Slice s;
    vec2 d = half_turn(turn);
    s.step = d * params.inverse_unproject;
    s.per_texel = inversesqrt(dot(s.step, s.step));
    s.scale = orthographic() ? 1.0 : 1.0 / position.z;
    float along = dot(d, to_eye.xy), inverse_o = inversesqrt(1.0 - along * along);
    s.outward = (vec3(d, 0.0) - along * to_eye) * inverse_o;
    vec3 across = vec3(d.y * to_eye.z, -d.x * to_eye.z, d.x * to_eye.y - d.y * to_eye.x) * inverse_o;
    float off = dot(normal, across), facing = dot(normal, to_eye), out_n = dot(normal, s.outward);
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
    s.sin_n = out_n * inverse;
    return s;
}

/* Texels off the shaded point of step t on the first side, at least 1 + t/2. Steps crowd near the point. */
vec2 step_offset(Slice s, uint t, float jitter, float reach)
{
    float q = (float(t) + jitter) * (1.0 / float(step_count()));
    float far = (s.scale * reach) * (q * (VKAO_STEP_LINEAR + (1.0 - VKAO_STEP_LINEAR) * q));
    return roundEven(s.step * max(far, s.per_texel * (1.0 + 0.5 * float(t))));
}

/* View z of the texels at +offset and -offset. */
vec2 load_sides(ivec2 texel, vec2 offset)
{
    ivec2 o = ivec2(offset);
    return vec2(load_view_z(texel + o), load_view_z(texel - o));
}

/* Their coordinates in the slice. */
void slice_points(Slice s, vec2 offset, vec2 z, out vec2 x, out vec2 y)
{
    float dx = dot(s.to_x, offset), dy = dot(s.to_y, offset);
    x = orthographic() ? vec2(dx) : z * dx;
    y = orthographic() ? s.origin + dy * SIDES - z : s.origin + z * (dy * SIDES - s.eye);
}

/* max() and min() of numbers: those may have to look for NaN, which takes three instructions instead of one. */
vec2 greater(vec2 a, vec2 b)
{
    return mix(b, a, greaterThan(a, b));
}

vec2 lesser(vec2 a, vec2 b)
{
    return mix(b, a, lessThan(a, b));
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
