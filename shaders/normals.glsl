/* SPDX-License-Identifier: MIT
 *
 * View-space normals of the texels of lanes.glsl: those that the caller gives, and where there is none to trust, those
 * of the depth image. */
#ifndef VKAO_NORMALS_GLSL_
#define VKAO_NORMALS_GLSL_

#include "lanes.glsl"
#include "view.glsl"

/* Of any view z. */
Real3 view_positions(ivec2 texel, real z)
{
    real x = (float(texel.x) + BESIDE) * params.unproject.x + params.unproject.z;
    real y = real(float(texel.y)) * params.unproject.y + params.unproject.w;
    return ORTHOGRAPHIC ? Real3(x, y, z) : Real3(x * z, y * z, z);
}

real load_view_zs(ivec2 texel)
{
    float z[TEXELS];
    [[unroll]] for (int i = 0; i < TEXELS; ++i)
        z[i] = load_view_z(texel + ivec2(i, 0));
    return join(z);
}

/* From where border_view_z counts. */
reals border_view_zs(ints x, ints y)
{
    reals z;
    [[unroll]] for (int i = 0; i < 2 * TEXELS; ++i)
        z[i] = border_view_z(ivec2(x[i], y[i]));
    return z;
}

/* The neighbour along one screen axis that lies on the texel's surface. */
struct Neighbour {
    real z, side; /* side is -1 or 1: before or after */
};

/* Of the two pairs of neighbours, the one whose straight continuation meets the centre better. 1/z is what continues
 * straight on screen in perspective; both misses are fractions there, compared without dividing. Without a second
 * neighbour the first one alone decides, by how far it is off; without both, none is chosen. */
Neighbour straight_neighbour(reals near_z, reals far_z, real center_z)
{
    reals z = both(center_z);
    reals line = near_z - z, curve = 2.0 * near_z - far_z - z;
    reals line_scale = reals(1.0), curve_scale = reals(1.0);
    if (!ORTHOGRAPHIC) {
        reals inverse = both(1.0 / center_z), n = near_z * inverse, f = far_z * inverse;
        line = 1.0 - n;
        line_scale = n;
        curve = 2.0 * f - n * (1.0 + f);
        curve_scale = n * f;
    }
    bools curved = greaterThan(far_z, reals(0.0)), there = greaterThan(near_z, reals(0.0));
    reals miss = mix(reals(1.0e30), abs(mix(line, curve, curved)), there);
    reals scale = mix(reals(1.0), mix(line_scale, curve_scale, curved), there);
    near_z = mix(z, near_z, there);
    real before = first_side(miss) * other_side(scale), after = other_side(miss) * first_side(scale);
    return Neighbour(choose(other_side(near_z), first_side(near_z), above(after, before)),
                     choose(real(1.0), real(-1.0), above(after, before)));
}

/* Of the nearest pair, the one whose view z differs less: quickly found, and seldom wrong beside an edge. */
Neighbour nearest_neighbour(reals near_z, real center_z)
{
    reals miss = abs(near_z - both(center_z));
    boolean first = above(other_side(miss), first_side(miss));
    real z = choose(other_side(near_z), first_side(near_z), first);
    return Neighbour(choose(center_z, z, above(z, real(0.0))), choose(real(1.0), real(-1.0), first));
}

/* View z before and after each texel of the row. */
reals load_beside(ivec2 texel, real z)
{
    float before[TEXELS], after[TEXELS];
    [[unroll]] for (int i = 0; i < TEXELS; ++i) {
        before[i] = i == 0 ? load_view_z(texel - ivec2(1, 0)) : lane(z, i - 1);
        after[i] = i == TEXELS - 1 ? load_view_z(texel + ivec2(TEXELS, 0)) : lane(z, i + 1);
    }
    return reals(join(before), join(after));
}

/* careful is what a depth image without normals takes; where a stored normal fails now and then, quick will do. */
Neighbour neighbour_in(ivec2 texel, ivec2 axis, real center_z, bool careful)
{
    reals near_z = axis.x != 0 ? load_beside(texel, center_z)
                               : reals(load_view_zs(texel - axis), load_view_zs(texel + axis));
    if (!careful)
        return nearest_neighbour(near_z, center_z);
    return straight_neighbour(near_z, reals(load_view_zs(texel - 2 * axis), load_view_zs(texel + 2 * axis)), center_z);
}

/* Unit vectors towards the eye. Those to the neighbours span the tangent plane. */
Real3 normal_from_depth(ivec2 texel, Real3 center, bool careful)
{
    Neighbour beside = neighbour_in(texel, ivec2(1, 0), center.z, careful);
    Neighbour below = neighbour_in(texel, ivec2(0, 1), center.z, careful);
    /* Slopes of depth over what a texel is wide there: the cross product without its length, whose square leaves the
     * range of floats in scenes that are small or large or seen through a keyhole. */
    reals slope = reals(beside.side * (beside.z - center.z), below.side * (below.z - center.z));
    slope *= reals(real(params.inverse_unproject.x), real(params.inverse_unproject.y));
    if (!ORTHOGRAPHIC)
        slope /= reals(beside.z, below.z);
    slope = lesser(greater(slope, reals(-VKAO_STEEPEST_FACET)), reals(VKAO_STEEPEST_FACET));
    Real3 n = Real3(first_side(slope), other_side(slope), real(-1.0));
    if (!ORTHOGRAPHIC) {
        Real3 sight = view_positions(texel, real(1.0));
        n.z -= sight.x * n.x + sight.y * n.y;
    }
    return times(n, inversesqrt(dot3(n, n)));
}

/* Unit vectors that face the eye, of texels of the grid. A stored normal that points away is turned if the back of its
 * surface is what is seen. Near outlines it is more often one that interpolation over a mesh has carried past the edge:
 * turned, that would stand across the surface, which would then hide itself. There depth decides. */
Real3 view_normals(ivec2 texel, Real3 center)
{
    vec3 stored[TEXELS];
    [[unroll]] for (int i = 0; i < TEXELS; ++i)
        stored[i] = to_view(decode_normal((texel + ivec2(i, 0)) << GRID_SHIFT));
    Real3 n = join3(stored);
    /* Always computed, seldom taken: costs a driver in software less than the branch. */
    Real3 own = normal_from_depth(texel, center, NORMAL_ENCODING == VKAO_GLSL_NORMALS_FROM_DEPTH);
    real away = ORTHOGRAPHIC ? n.z : dot3(n, center);
    real trust = choose(dot3(n, n), -dot3(n, own), above(away, real(0.0)));
    n = times(n, choose(real(1.0), real(-1.0), above(away, real(0.0))));
    n.x = choose(own.x, n.x, above(trust, real(0.0)));
    n.y = choose(own.y, n.y, above(trust, real(0.0)));
    n.z = choose(own.z, n.z, above(trust, real(0.0)));
    return n;
}

#endif
