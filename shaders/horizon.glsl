/* SPDX-License-Identifier: MIT
 *
 * What hbao, gtao and vbao share. A slice is the half plane pair through the direction to the eye V
 * and a direction on screen; inside it, points have coordinates x along O, away from the shaded
 * point, and y along V. Both sides are marched outwards, together: of a vec2, .x is the side along
 * O and .y the other. The cosine-weighted visibility of the hemisphere is the mean over slices of
 *     L * integral of cos(theta - n) |sin theta| over the visible theta,
 * theta being the angle to V, n that of the normal projected into the slice, L the projection's
 * length (Jimenez et al., 'Practical Real-Time Strategies for Accurate Indirect Occlusion',
 * 2016). */
#ifndef VKAO_HORIZON_GLSL_
#define VKAO_HORIZON_GLSL_

#include "product.glsl"

const float PI = 3.14159265358979324;
const vec2 SIDES = vec2(1.0, -1.0);

struct Slice {
    vec2 step;    /* direction on screen: unit, in texels */
    float texels; /* of a scene unit along it, at the shaded point */
    /* texels off the shaded point -> x and y in radii, per unit of view z in perspective */
    vec2 to_x, to_y;
    float eye, origin;   /* y is eye * view z - origin, and what to_y adds */
    vec3 outward;        /* O: unit, in the slice, at right angles to V */
    float fall;          /* of the depth image's plane, against V, per x */
    float normal_length; /* L */
    float cos_n, sin_n;  /* of the projected normal's angle from V, towards O */
};

/* turn in [0,1) is half the circle. to_eye is V. unproject, inverse_unit: texels and scene units in
 * what x and y are in, which is radii but for vbao. */
Slice make_slice(float turn, vec3 position, vec3 normal, Plane plane, vec3 to_eye, vec2 unproject,
                 float inverse_unit)
{
    Slice s;
    vec2 d = vec2(half_turn_x(turn), half_turn_y(turn));
    /* Either direction is the slice's. To the right its samples have one edge to leave by. */
    float right = d.x * params.inverse_unproject.x;
    d = right < 0.0 ? -d : d;
    /* of a scene unit at unit distance */
    vec2 texels = vec2(abs(right), d.y * params.inverse_unproject.y);
    float length2 = dot(texels, texels), per_texel = inversesqrt(length2);
    s.step = product(texels, vec2(per_texel));
    s.texels = length2 * per_texel * (ORTHOGRAPHIC ? 1.0 : 1.0 / position.z);
    /* As long as what is left of d without its share along V; 1 - (d.V)^2 is nothing at the edge of
     * a field of view of nearly 180 degrees. */
    vec3 across = vec3(d.y * to_eye.z, -d.x * to_eye.z, d.x * to_eye.y - d.y * to_eye.x);
    across *= inversesqrt(dot(across, across));
    s.outward = cross(to_eye, across);
    float facing = dot(normal, to_eye), out_n = dot(normal, s.outward);
    /* A sample's texel lies off the slice by rounding. It is moved into it along the plane that the
     * depth image has here, which keeps its height over that plane, so that a tilted wall still
     * lies flat in the slice, whatever its shading normals. */
    float plane_facing = dot(plane.normal, to_eye);
    float moved = dot(plane.normal, across) / max(plane_facing, plane.steepest);
    s.fall = dot(plane.normal, s.outward) / max(plane_facing, VKAO_STEEPEST);
    s.to_x = product(unproject, s.outward.xy);
    s.to_y = product(unproject, to_eye.xy + across.xy * moved);
    s.eye = ORTHOGRAPHIC ? -inverse_unit : inverse_unit / to_eye.z;
    /* It is taken to lie as deep as its depth may be wrong: a wall must not occlude itself by the
     * steps of a format. */
    s.origin = product(vec2(s.eye), vec2(position.z - 2.0 * depth_error(position.z))).x;
    float length2_n = max(facing * facing + out_n * out_n, 1.0e-12);
    float inverse_n = inversesqrt(length2_n);
    s.normal_length = length2_n * inverse_n;
    s.cos_n = clamp(facing * inverse_n, 0.0, 1.0);
    s.sin_n = out_n * inverse_n;
    return s;
}

/* Distance of step t along the slice, a polynomial of t: q (linear + (1 - linear) q) of the reach,
 * with q = (t + jitter) / steps. Steps crowd near the point. */
struct Steps {
    float k0, k1, k2;
};

Steps make_steps(Slice s, float jitter, float reach, float linear)
{
    float most = min(s.texels * reach, params.farthest);
    float n = 1.0 / float(step_count());
    float line = most * (linear * n), square = most * ((1.0 - linear) * n * n);
    vec2 moved = product(vec2(jitter), vec2(line + square * jitter, 2.0 * square));
    return Steps(moved.x, line + moved.y, square);
}

/* Whole texels off the shaded point, on the first side; at least 1 + least t. */
vec2 step_offset(Slice s, Steps steps, uint t, float least)
{
    float far = steps.k0 + float(t) * (steps.k1 + float(t) * steps.k2);
    return roundEven(s.step * max(far, 1.0 + least * float(t)));
}

/* View z of the texels at +offset and -offset. */
vec2 load_sides(vec2 texel, vec2 offset)
{
    return load_sides_from(view_z_image, texel, offset);
}

/* x of them, were they as far away as z. */
vec2 slice_x(Slice s, vec2 offset, vec2 z)
{
    vec2 dx = vec2(dot(s.to_x, offset));
    return ORTHOGRAPHIC ? dx : z * dx;
}

/* Their coordinates in the slice, in radii. */
void slice_points(Slice s, vec2 offset, vec2 z, out vec2 x, out vec2 y)
{
    x = slice_x(s, offset, z);
    if (ORTHOGRAPHIC) {
        y = SIDES * dot(s.to_y, offset) + z * s.eye - s.origin;
    } else {
        float rise = s.eye + s.to_y.x * offset.x + s.to_y.y * offset.y;
        y = z * vec2(rise, 2.0 * s.eye - rise) - s.origin;
    }
}

/* Is anything seen there, and outwards from the shaded point? Far off the axis a slice leans so
 * much that a texel beside it lies behind. Without depth x is 0 in perspective. */
bvec2 is_seen(vec2 x, vec2 z)
{
    return greaterThan(ORTHOGRAPHIC ? z : x, vec2(0.0));
}

#endif
