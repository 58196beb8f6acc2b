/* SPDX-License-Identifier: MIT
 *
 * View-space normals of the texels of lanes.glsl: those that the caller gives, and where there is none to trust, those
 * of the depth image. */
#ifndef VKAO_NORMALS_GLSL_
#define VKAO_NORMALS_GLSL_

#include "lanes.glsl"
#include "view.glsl"

/* Positions of the texels at texel + offset and beside it, of any view z. */
Real3 view_positions(ivec2 texel, Real2 offset, real z)
{
    real x = (float(texel.x) + BESIDE + offset.x) * params.unproject.x + params.unproject.z;
    real y = (float(texel.y) + offset.y) * params.unproject.y + params.unproject.w;
    return orthographic() ? Real3(x, y, z) : Real3(x * z, y * z, z);
}

Real3 view_positions(ivec2 texel, real z)
{
    return view_positions(texel, Real2(real(0.0), real(0.0)), z);
}

real load_view_zs(ivec2 texel)
{
    float z[TEXELS];
    [[unroll]] for (int i = 0; i < TEXELS; ++i)
        z[i] = load_view_z(texel + ivec2(i, 0));
    return join(z);
}

/* Surface tangent along one screen axis. Of the two neighbour pairs, the one whose straight continuation meets the
 * centre better lies on the centre's surface. 1/z is what continues straight on screen in perspective; both misses are
 * fractions there, compared without dividing. */
Real3 tangent_from_depth(ivec2 texel, ivec2 axis, Real3 center)
{
    reals far_z = reals(load_view_zs(texel - 2 * axis), load_view_zs(texel + 2 * axis));
    reals near_z = reals(load_view_zs(texel - axis), load_view_zs(texel + axis)), z = both(center.z);
    reals line = near_z - z, curve = 2.0 * near_z - far_z - z;
    reals line_scale = reals(1.0), curve_scale = reals(1.0);
    if (!orthographic()) {
        reals inverse = both(1.0 / center.z), n = near_z * inverse, f = far_z * inverse;
        line = 1.0 - n;
        line_scale = n;
        curve = 2.0 * f - n * (1.0 + f);
        curve_scale = n * f;
    }
    /* Without a second neighbour the first one alone decides, by how far it is off; without both, none is chosen. */
    bools curved = greaterThan(far_z, reals(0.0)), there = greaterThan(near_z, reals(0.0));
    reals miss = mix(reals(1.0e30), abs(mix(line, curve, curved)), there);
    reals scale = mix(reals(1.0), mix(line_scale, curve_scale, curved), there);
    near_z = mix(z, near_z, there);
    real before = first_side(miss) * other_side(scale), after = other_side(miss) * first_side(scale);
    real side = choose(real(1.0), real(-1.0), above(after, before));
    real side_z = choose(other_side(near_z), first_side(near_z), above(after, before));
    Real3 neighbour = view_positions(texel, Real2(side * float(axis.x), side * float(axis.y)), side_z);
    return times(plus(neighbour, times(center, real(-1.0))), side);
}

Real3 normal_from_depth(ivec2 texel, Real3 center)
{
    Real3 a = tangent_from_depth(texel, ivec2(1, 0), center), b = tangent_from_depth(texel, ivec2(0, 1), center);
    Real3 n = Real3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
    return times(n, inversesqrt(dot3(n, n)));
}

/* Unit vectors that face the eye, of texels of the grid. */
Real3 view_normals(ivec2 texel, Real3 center)
{
    vec3 stored[TEXELS];
    [[unroll]] for (int i = 0; i < TEXELS; ++i)
        stored[i] = to_view(decode_normal((texel + ivec2(i, 0)) << grid_shift()));
    Real3 n = join3(stored);
    real given = dot3(n, n);
    /* Always computed, seldom taken: costs a driver in software less than the branch. */
    Real3 own = normal_from_depth(texel, center);
    n.x = choose(own.x, n.x, above(given, real(0.0)));
    n.y = choose(own.y, n.y, above(given, real(0.0)));
    n.z = choose(own.z, n.z, above(given, real(0.0)));
    real away = orthographic() ? n.z : dot3(n, center);
    return times(n, choose(real(1.0), real(-1.0), above(away, real(0.0))));
}

#endif
