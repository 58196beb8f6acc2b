/* SPDX-License-Identifier: MIT
 *
 * View-space normals: those that the caller gives, and where there is none to trust, those of the
 * depth image. */
#ifndef VKAO_NORMALS_GLSL_
#define VKAO_NORMALS_GLSL_

#include "view.glsl"

/* The neighbour along one screen axis that lies on the texel's surface. */
struct Neighbour {
    float z, rise; /* rise: of view z, a texel on along the axis */
    bool is_there; /* if not, the others are of no use */
};

/* From the neighbour before to the texel, and from there to the one after it. */
vec2 rises_of(vec2 near_z, float z)
{
    return vec2(z - near_z.x, near_z.y - z);
}

/* Does depth go on in a straight line from one neighbour to the other? In perspective it bends by
 * its rise per texel. */
bool is_straight(vec2 rise, float z)
{
    return abs(rise.y - rise.x) <= VKAO_PLANE_BEND * abs(rise.x + rise.y) + 4.0e-6 * z;
}

/* Of the two pairs of neighbours, the one whose straight continuation meets the centre better. 1/z
 * is what continues straight on screen in perspective; both misses are fractions there, compared
 * without dividing. Without a second neighbour the first one alone decides, by how far it is off;
 * without both, none is chosen. */
Neighbour straight_neighbour(vec2 near_z, vec2 far_z, float z)
{
    vec2 line = near_z - z, curve = 2.0 * near_z - far_z - z;
    vec2 line_scale = vec2(1.0), curve_scale = vec2(1.0);
    if (!ORTHOGRAPHIC) {
        vec2 n = near_z / z, f = far_z / z;
        line = 1.0 - n;
        line_scale = n;
        curve = 2.0 * f - n * (1.0 + f);
        curve_scale = n * f;
    }
    bvec2 curved = greaterThan(far_z, vec2(0.0)), there = greaterThan(near_z, vec2(0.0));
    vec2 miss = mix(vec2(1.0e30), abs(mix(line, curve, curved)), there);
    vec2 scale = mix(vec2(1.0), mix(line_scale, curve_scale, curved), there);
    bool before = miss.x * scale.y < miss.y * scale.x;
    vec2 rise = rises_of(near_z, z);
    return Neighbour(before ? near_z.x : near_z.y, before ? rise.x : rise.y, any(there));
}

/* Of the nearest pair, the one whose view z differs less: quickly found, and seldom wrong beside an
 * edge. */
Neighbour nearest_neighbour(vec2 near_z, float center_z)
{
    vec2 rise = rises_of(near_z, center_z);
    bool before = abs(rise.x) < abs(rise.y);
    float z = before ? near_z.x : near_z.y;
    return Neighbour(z, before ? rise.x : rise.y, z > 0.0);
}

/* careful is what a depth image without normals takes; where a stored normal fails now and then,
 * quick will do. */
Neighbour neighbour_in(ivec2 texel, ivec2 axis, float center_z, bool careful, out bool straight)
{
    vec2 near_z = vec2(view_z_beside(texel, -axis), view_z_beside(texel, axis));
    straight = is_straight(rises_of(near_z, center_z), center_z);
    if (!careful)
        return nearest_neighbour(near_z, center_z);
    vec2 far_z = vec2(view_z_beside(texel, -2 * axis), view_z_beside(texel, 2 * axis));
    return straight_neighbour(near_z, far_z, center_z);
}

/* What depth alone says of a texel's surface. */
struct Facet {
    vec3 normal;   /* unit, towards the eye */
    bool straight; /* depth goes on so in row and column */
    bool alone;    /* no neighbour in one of them: the normal is unknown */
    bool edge_on;  /* so steep that it may be no surface, but a break of depth */
};

/* Vectors to the neighbours span the tangent plane. */
Facet facet_of(ivec2 texel, float center_z)
{
    const bool careful = NORMAL_ENCODING == VKAO_GLSL_NORMALS_FROM_DEPTH;
    bool straight_x, straight_y;
    Neighbour beside = neighbour_in(texel, ivec2(1, 0), center_z, careful, straight_x);
    Neighbour below = neighbour_in(texel, ivec2(0, 1), center_z, careful, straight_y);
    /* Slopes of depth over what a texel is wide there: the cross product without its length, whose
     * square leaves the range of floats in scenes that are small or large or seen through a
     * keyhole. */
    vec2 slope = vec2(beside.rise, below.rise) * params.inverse_unproject;
    if (!ORTHOGRAPHIC)
        slope /= vec2(beside.z, below.z);
    slope = vec2(beside.is_there ? slope.x : 0.0, below.is_there ? slope.y : 0.0);
    vec3 n = vec3(clamp(slope, -VKAO_STEEPEST_FACET, VKAO_STEEPEST_FACET), -1.0);
    if (!ORTHOGRAPHIC)
        n.z -= dot(view_position(vec2(texel), 1.0).xy, n.xy);
    float length2 = dot(n, n);
    return Facet(n * inversesqrt(length2), straight_x && straight_y,
                 !(beside.is_there && below.is_there),
                 length2 > VKAO_PLANE_EDGE_ON * VKAO_PLANE_EDGE_ON);
}

/* The plane that a texel's surface lies in. */
struct Plane {
    vec3 normal;
    /* cosine to the eye at which it stops getting steeper */
    float steepest;
};

/* normal: the shading normal. Things a texel wide have no plane in the depth image: there it is
 * steep only if the shading normal agrees. If it stands edge-on, as where they hide what is beside
 * a texel, it is the shading normal's. */
Plane plane_of(Facet own, vec3 normal)
{
    float agreement = own.alone ? 1.0 : dot(own.normal, normal);
    bool holds = own.straight || agreement > VKAO_PLANE_AGREES;
    bool is_own = agreement <= VKAO_PLANE_EQUALS && (holds || !own.edge_on);
    return Plane(is_own ? own.normal : normal,
                 holds ? VKAO_STEEPEST : VKAO_PLANE_STEEPEST);
}

/* The stored normal, or the surface's own; center is any point of the ray from the eye. A normal
 * that points away is turned if the back of its surface is what is seen. Near outlines it is more
 * often one that interpolation over a mesh has carried past the edge: turned, that would stand
 * across the surface, which would then hide itself. There depth decides. */
vec3 trusted_normal(vec3 stored, vec3 own, vec3 center)
{
    bool away = (ORTHOGRAPHIC ? stored.z : dot(stored, center)) > 0.0;
    float trust = away ? -dot(stored, own) : abs(stored.x) + abs(stored.y) + abs(stored.z);
    return trust > 0.0 ? (away ? -stored : stored) : own;
}

/* What is stored for a texel of the grid, in view space. */
vec3 stored_view_normal(ivec2 texel)
{
    return to_view(decode_normal(texel << GRID_SHIFT));
}

/* Unit vector that faces the eye, of a texel of the grid. */
vec3 view_normal(ivec2 texel, vec3 center)
{
    vec3 stored = stored_view_normal(texel);
    bool away = (ORTHOGRAPHIC ? stored.z : dot(stored, center)) > 0.0;
    if (!away && stored != vec3(0.0))
        return stored;
    return trusted_normal(stored, facet_of(texel, center.z).normal, center);
}

#endif
