/* SPDX-License-Identifier: MIT
 *
 * ../horizon.glsl for two texels side by side. */
#ifndef VKAO_HORIZON_GLSL_
#define VKAO_HORIZON_GLSL_

const float PI = 3.14159265358979324;

struct Slice {
    /* direction on screen, in texels that one scene unit has at unit distance */
    Real2 step;
    real per_texel;      /* 1 / its length */
    real scale;          /* scene units -> the same at the shaded point */
    /* texels off the shaded point -> x and y in radii, per unit of view z in perspective */
    Real2 to_x, to_y;
    real center_z;       /* view z of the shaded point */
    real eye, origin;    /* y is origin - eye * view z, and what to_y adds */
    Real3 outward;       /* O: unit, in the slice, at right angles to V */
    real fall;           /* of the depth image's plane, against V, per x */
    real normal_length;  /* L */
    real cos_n, sin_n;   /* of the projected normal's angle from V, towards O */
};

/* Unit vector to the eye. It does not depend on view z: all that is made of it is ready before that
 * is loaded. */
Real3 eye_direction(ivec2 texel)
{
    if (ORTHOGRAPHIC)
        return Real3(real(0.0), real(0.0), real(-1.0));
    Real3 away = view_positions(texel, real(1.0));
    return times(away, -inversesqrt(dot3(away, away)));
}

/* turn in [0,1) is half the circle. */
Slice make_slice(real turn, Real3 position, Real3 normal, Planes plane, Real3 to_eye)
{
    Slice s;
    Real2 d = Real2(half_turn_x(turn), half_turn_y(turn));
    s.step = Real2(d.x * params.inverse_unproject.x, d.y * params.inverse_unproject.y);
    s.per_texel = inversesqrt(s.step.x * s.step.x + s.step.y * s.step.y);
    s.center_z = position.z;
    s.scale = ORTHOGRAPHIC ? real(1.0) : 1.0 / position.z;
    real along = d.x * to_eye.x + d.y * to_eye.y;
    /* As long as what is left of d without its share along V; 1 - along^2 is nothing at the edge of
     * a field of view of nearly 180 degrees. */
    Real3 across = Real3(d.y * to_eye.z, -d.x * to_eye.z, d.x * to_eye.y - d.y * to_eye.x);
    real inverse_o = inversesqrt(dot3(across, across));
    s.outward =
        times(Real3(d.x - along * to_eye.x, d.y - along * to_eye.y, -along * to_eye.z), inverse_o);
    across = times(across, inverse_o);
    real off = dot3(normal, across), facing = dot3(normal, to_eye), out_n = dot3(normal, s.outward);
    /* A sample's texel lies off the slice by rounding. It is moved into it along the plane that the
     * depth image has here, which keeps its height over that plane, so that a tilted wall still
     * lies flat in the slice, whatever its shading normals. */
    real plane_facing = dot3(plane.normal, to_eye);
    real moved = dot3(plane.normal, across) / max(plane_facing, plane.steepest);
    s.fall = dot3(plane.normal, s.outward) / max(plane_facing, real(VKAO_STEEPEST));
    vec2 radii = params.unproject.xy * params.inverse_radius;
    s.to_x = Real2(radii.x * s.outward.x, radii.y * s.outward.y);
    s.to_y =
        Real2(radii.x * (to_eye.x + across.x * moved), radii.y * (to_eye.y + across.y * moved));
    s.eye = params.inverse_radius * (ORTHOGRAPHIC ? real(1.0) : -1.0 / to_eye.z);
    /* It is taken to lie as deep as its depth may be wrong: a wall must not occlude itself by the
     * steps of a format. */
    s.origin = s.eye * (position.z - 2.0 * depth_error(position.z));
    real length2 = max(1.0 - off * off, real(1.0e-12)), inverse = inversesqrt(length2);
    s.normal_length = length2 * inverse;
    s.cos_n = clamp(facing * inverse, real(0.0), real(1.0));
    s.sin_n = out_n * inverse;
    return s;
}

/* Texels off the shaded point, on the first side. */
struct Offset {
    Rounded x, y;
};

/* Distance of step t along the slice, a polynomial of t. Steps crowd near the point. */
struct Steps {
    real k0, k1, k2;
};

/* q (linear + (1 - linear) q) of the reach, q = (t + jitter) / steps */
Steps make_steps(Slice s, real jitter, float reach, float linear)
{
    float n = 1.0 / float(step_count()), square = (1.0 - linear) * n * n, line = linear * n;
    real most = s.scale * reach, farthest = s.per_texel * params.farthest;
    most = choose(most, farthest, above(most, farthest));
    return Steps(most * (jitter * (line + square * jitter)), most * (line + 2.0 * square * jitter),
                 most * square);
}

/* At least 1 + least_rise t texels. */
Offset step_offset(Slice s, Steps steps, uint t, float least_rise)
{
    real far = steps.k0 + float(t) * (steps.k1 + float(t) * steps.k2);
    real least = s.per_texel * (1.0 + least_rise * float(t));
    far = choose(least, far, above(far, least));
    return Offset(rounded(s.step.x * far), rounded(s.step.y * far));
}

/* View z of the texels at +offset and -offset. */
reals load_sides(ivec2 texel, Offset offset)
{
    ivec2 first = border_texel(texel);
    whole x = first.x + whole(BESIDE), y = whole(first.y);
    ints at_x = ints((x - ROUND_BITS) + offset.x.bits, (x + ROUND_BITS) - offset.x.bits);
    ints at_y = ints((y - ROUND_BITS) + offset.y.bits, (y + ROUND_BITS) - offset.y.bits);
    return border_view_zs(at_x, at_y);
}

/* Their coordinates in the slice, in radii. */
void slice_points(Slice s, Offset offset, reals z, out reals x, out reals y)
{
    reals dx = both(s.to_x.x * offset.x.number + s.to_x.y * offset.y.number);
    real dy = s.to_y.x * offset.x.number + s.to_y.y * offset.y.number;
    if (ORTHOGRAPHIC) {
        x = dx;
        y = both(s.origin) + SIDES * both(dy) - z * params.inverse_radius;
    } else {
        real rise = dy - s.eye;
        x = z * dx;
        y = both(s.origin) + z * reals(rise, -2.0 * s.eye - rise);
    }
}

/* Is anything seen there, and outwards from the shaded point? Far off the axis a slice leans so
 * much that a texel beside it lies behind. Without depth x is 0 in perspective. */
bools is_seen(reals x, reals z)
{
    return greaterThan(ORTHOGRAPHIC ? z : x, reals(0.0));
}

#endif
