/* SPDX-License-Identifier: MIT
 *
 * The frame of every SSAO method: a texel of the rect per invocation, background exactly 1. The
 * includer defines
 *     Visibility visibility(ivec2 texel, vec3 position, vec3 normal)
 * in view space, or with VKAO_PLANE one that gets the depth image's plane as well. Which texel an
 * invocation has and where its result goes, invocation.glsl says. */
#ifndef VKAO_SSAO_GLSL_
#define VKAO_SSAO_GLSL_

layout(push_constant) uniform Block { vkao_dispatch here; };
#include "settings.glsl"
#include "view.glsl"
#include "normals.glsl"
#include "noise.glsl"
#include "falloff.glsl"

struct Noise {
    float turn, jitter;
};

/* slices: 1 in methods that have none. */
Noise texel_noise(ivec2 texel, uint slices)
{
    vec2 noise = tile_noise(uvec2(texel), slices, params.noise_index);
    return Noise(noise.x, noise.y);
}

struct Visibility {
    vec3 bent; /* if BENT_NORMALS: mean visible direction, of any length */
    float open;
};

/* Any two unit vectors that make an orthonormal basis with n (Duff et al., JCGT 6(1), 2017). */
void tangents(vec3 n, out vec3 t, out vec3 b)
{
    float s = n.z < 0.0 ? -1.0 : 1.0, a = -1.0 / (s + n.z), c = n.x * n.y * a;
    t = vec3(1.0 + s * n.x * n.x * a, s * c, -s * n.x);
    b = vec3(c, s + n.y * n.y * a, -n.y);
}

/* The texel that the position is seen in; may lie outside. */
ivec2 nearest_texel(vec3 position)
{
    return ivec2(floor(project_to_texel(position) + 0.5));
}

/* Is the point at height point_height over the tangent plane behind the scene at occluder? Heights
 * are compared, not depths: the depth image knows the scene at texel centres only, and on a tilted
 * wall half a texel sideways moves z, but not the height, which is 0 all over the wall. A wall is
 * open at any tilt that way. */
bool stands_in_front(vec3 occluder, vec3 position, vec3 normal, float point_height)
{
    return dot(normal, occluder - position) > point_height;
}

#ifdef VKAO_PLANE
Visibility visibility(ivec2 texel, vec3 position, vec3 normal, Plane plane);
#else
Visibility visibility(ivec2 texel, vec3 position, vec3 normal);
#endif

/* What is not seen, background, is open. */
Visibility shade(ivec2 texel)
{
    Visibility v = Visibility(vec3(0.0), 1.0);
    float z = view_z_beside(texel, ivec2(0));
    if (z == 0.0)
        return v;
    vec3 position = view_position(vec2(texel), z);
#ifdef VKAO_PLANE
    Facet own = facet_of(texel, z);
    vec3 normal = trusted_normal(stored_view_normal(texel), own.normal,
                                 view_position(vec2(texel), 1.0));
    v = visibility(texel, position, normal, plane_of(own, normal));
#else
    v = visibility(texel, position, view_normal(texel, position));
#endif
    /* Where numbers fail, by a radius of 1e-9 of the distance for one, nothing is known to
     * occlude. */
    v.open = is_sane(v.open) ? v.open : 1.0;
    bvec3 sane = bvec3(is_sane(v.bent.x), is_sane(v.bent.y), is_sane(v.bent.z));
    v.bent = mix(vec3(0.0), v.bent, sane);
    return v;
}

#include "invocation.glsl"

#endif
